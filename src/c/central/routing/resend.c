/*
 * Sending again what modules did not finish before they ended.
 */
#include "central/routing/resend.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "central/routing/flow.h"
#include "central/routing/route.h"

/* What one resource has lost, while somebody is asked about it. */
struct loss {
    struct list in_server;
    char *resource;         /* owned */
    struct list dispatches; /* those that are not decided yet */
    bool wanted;            /* the first question was answered: now each message's turn has come */
};

static struct dispatch *first_of(const struct list *dispatches)
{
    return LIST_OWNER(dispatches->next, struct dispatch, link);
}

static void give_up(struct server *server, struct list *dispatches)
{
    while (!list_is_empty(dispatches)) {
        dispatch_free(&server->dispatches, first_of(dispatches));
    }
}

static void send_again(struct server *server, struct dispatch *dispatch)
{
    struct message *message = dispatch->message;
    flow_wait_again(server, dispatch);
    struct handler *handler = route_choose(server, message, dispatch->sender);
    if (dispatch->lost_by == NULL && handler != NULL) {
        flow_adopt(server, message, handler);
    }
}

static void send_all_again(struct server *server, struct list *dispatches)
{
    while (!list_is_empty(dispatches)) {
        send_again(server, first_of(dispatches));
    }
}

/* ------------------------------------------------------------------ questions */

static struct loss *first_loss(const struct server *server)
{
    return list_is_empty(&server->losses) ? NULL
                                          : LIST_OWNER(server->losses.next, struct loss, in_server);
}

static void free_loss(struct server *server, struct loss *loss)
{
    list_remove(&loss->in_server);
    server->n_losses--;
    free(loss->resource);
    free(loss);
}

static void ask(struct server *server)
{
    const struct loss *loss = first_loss(server);
    if (loss == NULL) {
        return;
    }
    if (loss->wanted) {
        log_question(&server->log, "Resend %s message?",
                     first_of(&loss->dispatches)->message->name);
    } else {
        log_question(&server->log, "\a\aResend active and/or pending messages for the %s resource?",
                     loss->resource);
    }
}

static bool is_yes(const char *line)
{
    const size_t length = strlen(line);
    return length > 0 && (line[length - 1] == 'y' || line[length - 1] == 'Y');
}

static void decide_message(struct server *server, struct dispatch *dispatch, bool yes)
{
    if (yes) {
        send_again(server, dispatch);
    } else {
        log_always(&server->log, "Not resending message: %s\n", dispatch->message->name);
        dispatch_free(&server->dispatches, dispatch);
    }
}

static void decide_loss(struct server *server, struct loss *loss, bool yes)
{
    if (yes) {
        loss->wanted = true;
    } else {
        log_always(&server->log, "Not resending messages.\n");
        give_up(server, &loss->dispatches);
    }
}

bool resend_asks(const struct server *server)
{
    return first_loss(server) != NULL;
}

void resend_answer(struct server *server, const char *line)
{
    struct loss *loss = first_loss(server);
    if (loss->wanted) {
        decide_message(server, first_of(&loss->dispatches), is_yes(line));
    } else {
        decide_loss(server, loss, is_yes(line));
    }
    if (list_is_empty(&loss->dispatches)) {
        free_loss(server, loss);
    }
    ask(server);
}

static void put_question(struct server *server, const char *resource, struct list *lost)
{
    struct loss *loss = mem_new(sizeof *loss);
    loss->resource = mem_copy_string(resource);
    list_init(&loss->dispatches);
    while (!list_is_empty(lost)) {
        struct list *link = lost->next;
        list_remove(link);
        list_append(&loss->dispatches, link);
    }
    list_append(&server->losses, &loss->in_server);
    if (++server->n_losses == 1) {
        ask(server);
    }
}

void resend(struct server *server, const char *resource, struct list *lost)
{
    if (list_is_empty(lost)) {
        return;
    }
    if (server->asks_before_resending && server->n_losses < LIMIT_QUESTIONS) {
        put_question(server, resource, lost);
    } else {
        send_all_again(server, lost);
    }
}

void resend_set_asking(struct server *server, bool asking)
{
    struct loss *loss;
    server->asks_before_resending = asking;
    while (!asking && (loss = first_loss(server)) != NULL) {
        send_all_again(server, &loss->dispatches);
        free_loss(server, loss);
    }
}

void resend_fini(struct server *server)
{
    struct loss *loss;
    while ((loss = first_loss(server)) != NULL) {
        give_up(server, &loss->dispatches);
        free_loss(server, loss);
    }
}
