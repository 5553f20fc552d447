/*
 * The machine's rules about who may use which service: hosts.allow and
 * hosts.deny, as hosts_access(5) describes them.
 *
 * The files are read anew for each question, and nothing else is waited for: no
 * name is looked up, and no rule runs a command or changes this process.  Where
 * a rule speaks of names and the client's is not known yet, that is the answer.
 */
#ifndef IPC_PLATFORM_RULES_H
#define IPC_PLATFORM_RULES_H

#include <stdbool.h>

struct rules_question {
    const char *service;
    const char *allow_file; /* NULL: the system's */
    const char *deny_file;
    const char *address;     /* of the client, as a number */
    const char *name;        /* of the client; "" if it has none, NULL: not looked up */
    const char *own_address; /* to which it has connected */
};

enum rules_answer { RULES_ALLOW, RULES_REFUSE, RULES_NEED_NAME };

/* Whether this build knows the rules: without them everybody is allowed. */
bool rules_are_known(void);

enum rules_answer rules_ask(const struct rules_question *question);

#endif
