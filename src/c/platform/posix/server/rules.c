/*
 * hosts.allow and hosts.deny by libwrap.
 *
 * Libwrap looks a name up when a rule asks for it; the function that it calls
 * for that only notes the wish here.  In its "dry run", meant for checking rules,
 * options of rules say what they would do and do not do it; one that would
 * replace the process (twist) ends the dry run to tell so.
 */
#include "platform/rules.h"

#include <stddef.h>
#include <syslog.h>
#include <tcpd.h>

/* Libwrap wants these of every program: how the system's log calls what it complains about. */
int allow_severity = LOG_INFO;
int deny_severity = LOG_WARNING;

/* The request is the first member, so that what libwrap hands back leads to the rest. */
struct inquiry {
    struct request_info request;
    bool wants_name;
};

static void note_wish(struct host_info *host)
{
    struct inquiry *inquiry = (struct inquiry *)(void *)host->request;
    if (host == inquiry->request.client) {
        inquiry->wants_name = true;
    }
}

/* Libwrap's interface is older than const: it writes to none of these. */
static char *as_old_text(const char *text)
{
    union {
        const char *text;
        char *old;
    } same = {text};
    return same.old;
}

static void choose_files(const struct rules_question *question)
{
    if (question->allow_file != NULL) {
        hosts_allow_table = as_old_text(question->allow_file);
    }
    if (question->deny_file != NULL) {
        hosts_deny_table = as_old_text(question->deny_file);
    }
}

bool rules_are_known(void)
{
    return true;
}

enum rules_answer rules_ask(const struct rules_question *question)
{
    struct inquiry inquiry = {.wants_name = false};
    const char *name = question->name == NULL      ? ""
                       : question->name[0] == '\0' ? STRING_UNKNOWN
                                                   : question->name;
    choose_files(question);
    request_init(&inquiry.request, RQ_DAEMON, question->service, RQ_CLIENT_ADDR, question->address,
                 RQ_CLIENT_NAME, name, RQ_SERVER_ADDR, question->own_address, RQ_USER,
                 STRING_UNKNOWN, 0);
    inquiry.request.hostname = note_wish;
    resident = 1;
    dry_run = 1;
    const bool allowed = hosts_access(&inquiry.request) != 0 && dry_run != 0;
    if (inquiry.wants_name) {
        return RULES_NEED_NAME;
    }
    return allowed ? RULES_ALLOW : RULES_REFUSE;
}
