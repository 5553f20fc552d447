/*
 * The handshake with central.
 *
 * It takes three journeys: central's greeting; the numbers of all messages that it
 * needs, asked for at once; the introduction; and then everything that the context
 * holds - which is nothing when it is new - together with the word that it is ready.
 */
#include "libipc/handshake.h"

#include <stdlib.h>
#include <string.h>

#include "base/limits.h"
#include "libipc/define.h"
#include "libipc/direct.h"
#include "libipc/exchange.h"
#include "libipc/formatter.h"
#include "libipc/handler_watch.h"
#include "libipc/queue.h"
#include "libipc/report.h"
#include "libipc/subscription.h"
#include "libipc/wait.h"

enum {
    OWN_MAJOR = 3,
    OWN_MINOR = 10, /* centrals of this project say 3.10, the original 3.9 */
    HOST_NAME_SIZE = 33
};

#define WATCH_BROADCASTS VARIABLE_WATCH VARIABLE_BROADCASTS
#define GET_BROADCASTS VARIABLE_GET VARIABLE_BROADCASTS

/* ------------------------------------------------------------------ questions */

static void forget_questions(struct handshake *handshake)
{
    for (int i = 0; i < handshake->n_questions; i++) {
        exchange_forget(handshake->context, &handshake->questions[i].awaited);
    }
    handshake->n_questions = 0;
}

static bool is_answered(const struct handshake *handshake)
{
    if (handshake->stage == HANDSHAKE_GREETING) {
        return handshake->context->greeting == GREETING_PARTS;
    }
    for (int i = 0; i < handshake->n_questions; i++) {
        if (!handshake->questions[i].awaited.done) {
            return false;
        }
    }
    return true;
}

static bool ask(struct handshake *handshake, int32_t message_id, const struct format *format,
                const void *payload, int32_t *number)
{
    struct question *question = &handshake->questions[handshake->n_questions];
    question->number = number;
    if (exchange_queue_request(handshake->context, message_id, format, payload,
                               &question->awaited) != IPC_No_Error) {
        return false;
    }
    handshake->n_questions++;
    return true;
}

static bool look_up(struct handshake *handshake, const char *name, int32_t *number)
{
    const struct _X_IPC_CONTEXT *context = handshake->context;
    struct message_info_request request = {(char *)(uintptr_t)name, NULL}; /* only read */
    return ask(handshake, context->library_ids[LM_MESSAGE_INFO],
               context->library->catalogue.request[LM_MESSAGE_INFO], &request, number);
}

/* The number in the answer to a look-up, 0 when there is none. */
static int32_t number_in(const struct handshake *handshake, struct awaited *awaited)
{
    const struct format *format = handshake->context->library->catalogue.reply[LM_MESSAGE_INFO];
    struct optional_message_info reply = {NULL};
    int32_t number = 0;
    if (exchange_decode(awaited, format, &reply) == IPC_No_Error) {
        number = reply.info != NULL ? reply.info->id : 0;
        (void)format_release(format, &reply);
    }
    return number;
}

static void take_numbers(struct handshake *handshake)
{
    for (int i = 0; i < handshake->n_questions; i++) {
        struct question *question = &handshake->questions[i];
        if (question->number != NULL) {
            *question->number = number_in(handshake, &question->awaited);
        }
    }
}

/* -------------------------------------------------------------------- numbers */

/* Messages whose numbers the handshake and nearly every module need. */
static const enum library_message needed[] = {LM_INTRODUCTION,   LM_READY,      LM_SUBSCRIBE,
                                              LM_DEFINE_MESSAGE, LM_CLOSE,      LM_DEFINE_FORMAT,
                                              LM_IS_CONNECTED,   LM_UNSUBSCRIBE};
enum { N_NEEDED = sizeof needed / sizeof needed[0] };

static const char *const abilities[N_ABILITIES] = {ABILITY_IN_ORDER, ABILITY_AHEAD};

static bool is_needed(int which)
{
    for (int i = 0; i < N_NEEDED; i++) {
        if ((int)needed[i] == which) {
            return true;
        }
    }
    return which == LM_MESSAGE_INFO; /* its number comes with the greeting */
}

/* Asks for all numbers at once, also of what has been used over an earlier connection. */
static bool ask_numbers(struct handshake *handshake)
{
    int32_t *ids = handshake->context->library_ids;
    bool ok = true;
    for (int i = 0; i < N_NEEDED; i++) {
        ok = look_up(handshake, library_messages[needed[i]].name, &ids[needed[i]]) && ok;
    }
    for (int i = 0; i < LM_COUNT; i++) {
        if (ids[i] != 0 && !is_needed(i)) {
            ok = look_up(handshake, library_messages[i].name, &ids[i]) && ok;
        }
    }
    ok = look_up(handshake, GET_BROADCASTS, &handshake->get_broadcasts) && ok;
    for (int i = 0; i < N_ABILITIES; i++) {
        ok = look_up(handshake, abilities[i], NULL) && ok; /* there is none */
    }
    return ok;
}

/* --------------------------------------------------------------- introduction */

static bool introduce(struct handshake *handshake)
{
    const struct _X_IPC_CONTEXT *context = handshake->context;
    const int32_t *ids = context->library_ids;
    char host[HOST_NAME_SIZE];
    if (ids[LM_INTRODUCTION] == 0 || ids[LM_READY] == 0 || ids[LM_SUBSCRIBE] == 0) {
        return false;
    }
    net_host_name(host, sizeof host);
    struct introduction introduction = {context->module_name, host};
    return ask(handshake, ids[LM_INTRODUCTION],
               context->library->catalogue.request[LM_INTRODUCTION], &introduction, NULL);
}

static void report_versions(const struct introduction_reply *reply, int port)
{
    report_warning("*** ERROR ***\n");
    report_warning("Major Version Number is different from Task Control Server.\n");
    report_warning("Module Version     : %d.%d\n", OWN_MAJOR, OWN_MINOR);
    report_warning("Task Control Server: %d.%d (port %d)\n", reply->major, reply->minor, port);
}

static enum handshake_result take_introduction(struct handshake *handshake)
{
    struct _X_IPC_CONTEXT *context = handshake->context;
    struct awaited *awaited = &handshake->questions[0].awaited;
    const struct format *format = context->library->catalogue.reply[LM_INTRODUCTION];
    struct introduction_reply reply;
    if (awaited->length == 0 || exchange_decode(awaited, format, &reply) != IPC_No_Error) {
        return HANDSHAKE_BROKEN;
    }
    if (reply.major != OWN_MAJOR) {
        report_versions(&reply, context->port);
        return HANDSHAKE_MISMATCH;
    }
    context->new_central = reply.minor >= OWN_MINOR;
    context->direct = reply.direct != 0;
    return HANDSHAKE_GOES_ON;
}

/* ----------------------------------------------------------------- broadcasts */

/* Central's list of the broadcasts that have subscribers. */
static void take_broadcasts(struct _X_IPC_CONTEXT *context, const struct name_list *list)
{
    table_fini(&context->broadcasts);
    table_init(&context->broadcasts, TABLE_FOLDING);
    for (int i = 0; i < list->used && i < list->room; i++) {
        if (list->names[i] != NULL) {
            (void)table_put(&context->broadcasts, list->names[i], context);
        }
    }
    context->broadcasts_known = true;
}

static bool broadcasts_changed(struct _X_IPC_CONTEXT *context, struct handler *handler,
                               const struct frame *frame)
{
    const struct format *format = context->library->catalogue.name_list;
    struct name_list list;
    (void)handler;
    if (payload_decode(format, frame->data, frame->data_length, (enum byte_order)frame->data_order,
                       &list) == 0) {
        take_broadcasts(context, &list);
        (void)format_release(format, &list);
    } else {
        context->broadcasts_known = false; /* then everything is sent */
    }
    return true;
}

static void take_broadcasts_answer(struct _X_IPC_CONTEXT *context, struct awaited *awaited)
{
    const struct format *format = context->library->catalogue.name_list;
    struct name_list list;
    if (awaited->length > 0 && exchange_decode(awaited, format, &list) == IPC_No_Error) {
        if (!context->broadcasts_known) { /* else the watch has brought something newer */
            take_broadcasts(context, &list);
        }
        (void)format_release(format, &list);
    }
}

/* ---------------------------------------------------------------------- ready */

static void tell_named_format(void *context_pointer, const char *name, const char *text)
{
    struct _X_IPC_CONTEXT *context = context_pointer;
    char *portable = formatter_portable(context->library, text);
    struct two_names definition = {(char *)(uintptr_t)name, portable};
    exchange_tell(context, LM_DEFINE_FORMAT, &definition);
    free(portable);
}

/* The last journey.  Central may let it wait until all expected modules are there. */
static bool get_ready(struct handshake *handshake)
{
    struct _X_IPC_CONTEXT *context = handshake->context;
    const bool watch = context->will_listen && handshake->get_broadcasts != 0;
    if (watch) {
        (void)subscription_prepare_internal(context, WATCH_BROADCASTS, broadcasts_changed);
    }
    format_names_each(context->library->names, tell_named_format, context);
    define_tell_all(context);
    handler_watch_tell_all(context);
    subscription_tell_all(context);
    queue_tell_all(context);
    handshake->stage = HANDSHAKE_READY;
    handshake->deadline_ns = NO_DEADLINE;
    return (!watch || ask(handshake, handshake->get_broadcasts, NULL, NULL, NULL)) &&
           ask(handshake, context->library_ids[LM_READY], NULL, NULL, NULL);
}

static void take_ready(struct handshake *handshake)
{
    if (handshake->n_questions > 1) {
        take_broadcasts_answer(handshake->context, &handshake->questions[0].awaited);
    }
}

/* ---------------------------------------------------------------- direct mode */

/* Central wants direct links: others must find this module before it subscribes to anything. */
static bool become_reachable(struct handshake *handshake)
{
    struct _X_IPC_CONTEXT *context = handshake->context;
    if (direct_listen(context) != 0) {
        return false;
    }
    handshake->stage = HANDSHAKE_DIRECT_PORT;
    return look_up(handshake, library_messages[LM_DIRECT_PORT].name,
                   &context->library_ids[LM_DIRECT_PORT]);
}

/* --------------------------------------------------------------------- stages */

/* Takes the answers of one stage and begins the next. */
static enum handshake_result advance(struct handshake *handshake)
{
    struct _X_IPC_CONTEXT *context = handshake->context;
    enum handshake_result result = HANDSHAKE_GOES_ON;
    bool ok = true;
    if (handshake->stage == HANDSHAKE_INTRODUCTION) {
        result = take_introduction(handshake);
    } else if (handshake->stage == HANDSHAKE_READY) {
        take_ready(handshake);
    } else {
        take_numbers(handshake);
    }
    forget_questions(handshake);
    if (result != HANDSHAKE_GOES_ON) {
        return result;
    }
    switch (handshake->stage) {
    case HANDSHAKE_GREETING:
        handshake->stage = HANDSHAKE_NUMBERS;
        ok = ask_numbers(handshake);
        break;
    case HANDSHAKE_NUMBERS:
        handshake->stage = HANDSHAKE_INTRODUCTION;
        ok = introduce(handshake);
        break;
    case HANDSHAKE_INTRODUCTION:
        ok = context->direct ? become_reachable(handshake) : get_ready(handshake);
        break;
    case HANDSHAKE_DIRECT_PORT:
        direct_tell_port(context);
        ok = context->library_ids[LM_DIRECT_PORT] != 0 && get_ready(handshake);
        break;
    case HANDSHAKE_READY:
    case HANDSHAKE_OVER:
    default:
        handshake->stage = HANDSHAKE_OVER;
        return HANDSHAKE_DONE;
    }
    ok = ok && exchange_flush(context) == IPC_No_Error;
    return ok ? HANDSHAKE_GOES_ON : HANDSHAKE_BROKEN;
}

void handshake_init(struct handshake *handshake, struct _X_IPC_CONTEXT *context)
{
    memset(handshake, 0, sizeof *handshake);
    handshake->context = context;
    handshake->deadline_ns = wait_deadline(LIMIT_HANDSHAKE_MS);
}

void handshake_fini(struct handshake *handshake)
{
    forget_questions(handshake);
}

enum handshake_result handshake_step(struct handshake *handshake)
{
    enum handshake_result result = HANDSHAKE_GOES_ON;
    while (result == HANDSHAKE_GOES_ON && context_is_open(handshake->context) &&
           is_answered(handshake)) {
        result = advance(handshake);
    }
    if (result == HANDSHAKE_GOES_ON &&
        (!context_is_open(handshake->context) || wait_is_over(handshake->deadline_ns))) {
        return HANDSHAKE_BROKEN;
    }
    return result;
}
