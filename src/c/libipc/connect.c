/*
 * Connecting to central.
 *
 * The handshake takes three journeys: central's greeting; the numbers of all
 * messages that it needs, asked for at once; the introduction; and then what a
 * listening module subscribes to, together with the word that it is ready.
 */
#include "libipc/connect.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/limits.h"
#include "base/memory.h"
#include "libipc/address.h"
#include "libipc/direct.h"
#include "libipc/exchange.h"
#include "libipc/formatter.h"
#include "libipc/report.h"
#include "libipc/subscription.h"
#include "libipc/wait.h"

enum {
    N_TRIES = 5,
    PAUSE_MS = 1000,
    CONNECT_TIMEOUT_MS = 10000,
    OWN_MAJOR = 3,
    OWN_MINOR = 10, /* centrals of this project say 3.10, the original 3.9 */
    HOST_NAME_SIZE = 33
};

#define WATCH_BROADCASTS VARIABLE_WATCH VARIABLE_BROADCASTS
#define GET_BROADCASTS VARIABLE_GET VARIABLE_BROADCASTS

/* How a try to connect ended. */
enum try_result {
    TRY_OK,
    TRY_NOBODY,  /* nobody listens there */
    TRY_BROKEN,  /* somebody does, but the handshake did not come to its end */
    TRY_MISMATCH /* central speaks another major version */
};

/* ------------------------------------------------------------------ handshake */

static bool await_greeting(struct _X_IPC_CONTEXT *context, uint64_t deadline_ns)
{
    bool go_on = true;
    while (go_on && context->greeting < GREETING_PARTS && context_is_open(context) &&
           !wait_is_over(deadline_ns)) {
        go_on = wait_turn(context->library, deadline_ns);
    }
    return context->greeting == GREETING_PARTS && context_is_open(context);
}

/* Messages whose numbers the handshake and nearly every module need. */
static const enum library_message needed[] = {LM_INTRODUCTION,   LM_READY,     LM_SUBSCRIBE,
                                              LM_DEFINE_MESSAGE, LM_CLOSE,     LM_DEFINE_FORMAT,
                                              LM_IS_CONNECTED,   LM_UNSUBSCRIBE};
enum { N_NEEDED = sizeof needed / sizeof needed[0] };

static IPC_ERROR_TYPE queue_look_up(struct _X_IPC_CONTEXT *context, const char *name,
                                    struct awaited *awaited)
{
    struct message_info_request request = {(char *)(uintptr_t)name, NULL};
    return exchange_queue_request(context, context->library_ids[LM_MESSAGE_INFO],
                                  context->library->catalogue.request[LM_MESSAGE_INFO], &request,
                                  awaited);
}

/* The number in the answer to a look-up, 0 when there is none. */
static int32_t await_number(struct _X_IPC_CONTEXT *context, struct awaited *awaited,
                            uint64_t deadline_ns)
{
    const struct format *format = context->library->catalogue.reply[LM_MESSAGE_INFO];
    struct optional_message_info reply = {NULL};
    int32_t number = 0;
    bool timed_out;
    if (exchange_await(context, awaited, deadline_ns, &timed_out) == IPC_No_Error &&
        exchange_decode(awaited, format, &reply) == IPC_No_Error) {
        number = reply.info != NULL ? reply.info->id : 0;
        (void)format_release(format, &reply);
    }
    exchange_forget(context, awaited);
    return number;
}

/* Names that are asked for only to say that this library has the ability. */
static const char *const abilities[] = {ABILITY_IN_ORDER, ABILITY_AHEAD};
enum { N_ABILITIES = sizeof abilities / sizeof abilities[0] };

/* Asks for all numbers at once; *get_broadcasts is that of the query for the list of broadcasts. */
static bool look_up_needed(struct _X_IPC_CONTEXT *context, uint64_t deadline_ns,
                           int32_t *get_broadcasts)
{
    struct awaited awaited[N_NEEDED + 1];
    struct awaited unknown[N_ABILITIES];
    bool ok = true;
    for (int i = 0; i < N_NEEDED; i++) {
        ok = queue_look_up(context, library_messages[needed[i]].name, &awaited[i]) ==
                 IPC_No_Error &&
             ok;
    }
    ok = queue_look_up(context, GET_BROADCASTS, &awaited[N_NEEDED]) == IPC_No_Error && ok;
    for (int i = 0; i < N_ABILITIES; i++) {
        ok = queue_look_up(context, abilities[i], &unknown[i]) == IPC_No_Error && ok;
    }
    ok = exchange_flush(context) == IPC_No_Error && ok;
    for (int i = 0; i < N_NEEDED; i++) {
        context->library_ids[needed[i]] = await_number(context, &awaited[i], deadline_ns);
    }
    *get_broadcasts = await_number(context, &awaited[N_NEEDED], deadline_ns);
    for (int i = 0; i < N_ABILITIES; i++) {
        (void)await_number(context, &unknown[i], deadline_ns); /* there is none */
    }
    return ok && context->library_ids[LM_INTRODUCTION] != 0 &&
           context->library_ids[LM_READY] != 0 && context->library_ids[LM_SUBSCRIBE] != 0;
}

static bool introduce(struct _X_IPC_CONTEXT *context, uint64_t deadline_ns,
                      struct introduction_reply *reply)
{
    const struct catalogue *catalogue = &context->library->catalogue;
    char host[HOST_NAME_SIZE];
    struct awaited awaited;
    bool timed_out;
    net_host_name(host, sizeof host);
    struct introduction introduction = {context->module_name, host};
    bool ok = exchange_queue_request(context, context->library_ids[LM_INTRODUCTION],
                                     catalogue->request[LM_INTRODUCTION], &introduction,
                                     &awaited) == IPC_No_Error &&
              exchange_flush(context) == IPC_No_Error &&
              exchange_await(context, &awaited, deadline_ns, &timed_out) == IPC_No_Error &&
              awaited.length > 0 &&
              exchange_decode(&awaited, catalogue->reply[LM_INTRODUCTION], reply) == IPC_No_Error;
    exchange_forget(context, &awaited);
    return ok;
}

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
    if (payload_decode(format, frame->data, frame->data_length,
                       (enum byte_order)frame->data_order, &list) == 0) {
        take_broadcasts(context, &list);
        (void)format_release(format, &list);
    } else {
        context->broadcasts_known = false; /* then everything is sent */
    }
    return true;
}

static IPC_ERROR_TYPE queue_watch_broadcasts(struct _X_IPC_CONTEXT *context)
{
    const struct handler *handler =
        subscription_prepare_internal(context, WATCH_BROADCASTS, broadcasts_changed);
    struct subscription_notice notice = {(int)handler->id, handler->name, handler->name};
    return exchange_queue_notice(context, context->library_ids[LM_SUBSCRIBE],
                                 context->library->catalogue.request[LM_SUBSCRIBE], &notice);
}

/* Formats that were defined before there was a central to tell. */
static void queue_named_format(void *context_pointer, const char *name, const char *text)
{
    struct _X_IPC_CONTEXT *context = context_pointer;
    char *portable = formatter_portable(context->library, text);
    struct two_names definition = {(char *)(uintptr_t)name, portable};
    if (context->library_ids[LM_DEFINE_FORMAT] != 0) {
        (void)exchange_queue_notice(context, context->library_ids[LM_DEFINE_FORMAT],
                                    context->library->catalogue.request[LM_DEFINE_FORMAT],
                                    &definition); /* a loss shows in the context's state */
    }
    free(portable);
}

static void await_broadcasts(struct _X_IPC_CONTEXT *context, struct awaited *awaited)
{
    const struct format *format = context->library->catalogue.name_list;
    struct name_list list;
    if (exchange_await(context, awaited, NO_DEADLINE, NULL) == IPC_No_Error &&
        awaited->length > 0 && exchange_decode(awaited, format, &list) == IPC_No_Error) {
        if (!context->broadcasts_known) { /* else the watch has brought something newer */
            take_broadcasts(context, &list);
        }
        (void)format_release(format, &list);
    }
}

/* The last journey.  Central may let it wait until all expected modules are there. */
static bool get_ready(struct _X_IPC_CONTEXT *context, int32_t get_broadcasts)
{
    struct awaited ready;
    struct awaited broadcasts;
    const bool watch = context->will_listen && get_broadcasts != 0;
    bool ok = true;
    memset(&ready, 0, sizeof ready);
    memset(&broadcasts, 0, sizeof broadcasts);
    format_names_each(context->library->names, queue_named_format, context);
    if (watch) {
        ok = queue_watch_broadcasts(context) == IPC_No_Error &&
             exchange_queue_request(context, get_broadcasts, NULL, NULL, &broadcasts) ==
                 IPC_No_Error;
    }
    ok = ok && exchange_queue_request(context, context->library_ids[LM_READY], NULL, NULL,
                                      &ready) == IPC_No_Error;
    ok = ok && exchange_flush(context) == IPC_No_Error;
    if (ok && watch) {
        await_broadcasts(context, &broadcasts);
    }
    ok = ok && exchange_await(context, &ready, NO_DEADLINE, NULL) == IPC_No_Error;
    exchange_forget(context, &broadcasts);
    exchange_forget(context, &ready);
    return ok && context_is_open(context);
}

/* Central wants direct links: others must find this module before it subscribes to anything. */
static bool become_reachable(struct _X_IPC_CONTEXT *context)
{
    return direct_listen(context) == 0 && direct_announce(context) == IPC_No_Error;
}

static void report_versions(const struct introduction_reply *reply, int port)
{
    report_warning("*** ERROR ***\n");
    report_warning("Major Version Number is different from Task Control Server.\n");
    report_warning("Module Version     : %d.%d\n", OWN_MAJOR, OWN_MINOR);
    report_warning("Task Control Server: %d.%d (port %d)\n", reply->major, reply->minor, port);
}

static enum try_result shake_hands(struct _X_IPC_CONTEXT *context)
{
    const uint64_t deadline = clock_ns() + (uint64_t)LIMIT_HANDSHAKE_MS * 1000000u;
    struct introduction_reply reply;
    int32_t get_broadcasts;
    if (!await_greeting(context, deadline) ||
        !look_up_needed(context, deadline, &get_broadcasts) ||
        !introduce(context, deadline, &reply)) {
        return TRY_BROKEN;
    }
    if (reply.major != OWN_MAJOR) {
        report_versions(&reply, context->port);
        return TRY_MISMATCH;
    }
    context->new_central = reply.minor >= OWN_MINOR;
    context->direct = reply.direct != 0;
    if (context->direct && !become_reachable(context)) {
        return TRY_BROKEN;
    }
    return get_ready(context, get_broadcasts) ? TRY_OK : TRY_BROKEN;
}

/* ------------------------------------------------------------------------ tries */

/* The context becomes the current one, of the process and of the callback that connected. */
static void make_current(struct library *library, struct _X_IPC_CONTEXT *context)
{
    struct running *running = library_running(library);
    context->unseen = false;
    context->state = CONTEXT_CONNECTED;
    library->current = context;
    if (running != NULL && running->context != NULL) {
        running->context = context;
    }
    if (context->link.fd > library->max_fd) {
        library->max_fd = context->link.fd;
    }
    library_changed(library);
}

static enum try_result try_once(const char *module, const char *server, bool will_listen,
                                struct address *address)
{
    int fd;
    bool local;
    struct library *library = library_enter();
    int (*const give_up)(void) = library->give_up;
    library_leave(library);
    if (address_connect(address, CONNECT_TIMEOUT_MS, give_up, &fd, &local) != 0) {
        return TRY_NOBODY;
    }
    library = library_enter();
    struct _X_IPC_CONTEXT *context =
        context_new(library, fd, module, server, address->port, will_listen);
    context->local = local;
    const enum try_result result = shake_hands(context);
    if (result == TRY_OK) {
        make_current(library, context);
    } else {
        context_discard(context);
    }
    library_leave(library);
    return result;
}

/* Whether the current context is connected to that server already; its listening kind changes then. */
static bool is_connected_already(const char *server, bool will_listen, int *port)
{
    struct library *library = library_enter();
    library_initialise(library);
    struct _X_IPC_CONTEXT *context = library_connected(library);
    const bool already = context != NULL && strcmp(context->server_name, server) == 0;
    if (already) {
        context->will_listen = will_listen;
        *port = context->port;
    }
    library_leave(library);
    return already;
}

static void explain(enum try_result result)
{
    if (result == TRY_BROKEN) {
        report_internal_error(
            "ERROR: Socket connection broken or access denied to central server\n");
        report_note("ERROR: ConnectModule Query failed.\n");
    } else if (result == TRY_MISMATCH) {
        report_internal_error("%s", "");
    }
}

static IPC_RETURN_TYPE try_often(const char *module, const char *server, bool by_default,
                                 bool will_listen)
{
    struct address address;
    const bool possible = address_parse(server, &address) == 0;
    for (int i = 0; i < N_TRIES; i++) {
        enum try_result result = TRY_NOBODY;
        if (i > 0) {
            report_banner("  Trying again %s to connect with the central server on %s\n", module,
                          server);
        }
        if (by_default) {
            report_warning("Warning: trying to connect to local host %s.\n", server);
        }
        if (possible) {
            result = try_once(module, server, will_listen, &address);
        }
        if (result == TRY_OK) {
            report_warning("... IPC Connected on port %d\n", address.port);
            return IPC_OK;
        }
        explain(result);
        if (by_default && result == TRY_NOBODY) {
            report_internal_error("ERROR: Can not connect to the server on %s.", server);
        }
        if (result == TRY_MISMATCH) {
            break; /* trying again would not change it */
        }
        if (!wait_pause(PAUSE_MS)) {
            break;
        }
    }
    return report(IPC_Not_Connected);
}

IPC_RETURN_TYPE connect_module(const char *module, const char *server, bool will_listen)
{
    char own_host[NET_NAME_SIZE];
    int port;
    if (module == NULL || *module == '\0') {
        return report(IPC_Null_Argument);
    }
    report_banner("NMP IPC Version %s (%s)\n", IPC_VERSION, IPC_RELEASE_DATE);
    if (server == NULL || *server == '\0') {
        server = getenv("CENTRALHOST");
    }
    const bool by_default = server == NULL || *server == '\0';
    if (by_default) {
        report_warning("Warning: CENTRALHOST environment variable not set.\n");
        net_host_name(own_host, sizeof own_host);
        server = own_host;
    }
    if (is_connected_already(server, will_listen, &port)) {
        report_warning("x_ipcConnectModule: already connected to %s\n", server);
        report_warning("... IPC Connected on port %d\n", port);
        return IPC_OK;
    }
    return try_often(module, server, by_default, will_listen);
}

/* ---------------------------------------------------------------------- leaving */

/* Unread bytes would make the kernel reset the connection, and the last words could be lost. */
static void read_rest(struct _X_IPC_CONTEXT *context)
{
    bool more = true;
    while (more && link_read(&context->link, &more) > 0) {
        context->link.reader.start = context->link.reader.end;
    }
}

void disconnect(struct _X_IPC_CONTEXT *context, bool tell_central)
{
    if (context_is_open(context) && tell_central) {
        if (context->library_ids[LM_CLOSE] != 0) {
            (void)exchange_queue_notice(context, context->library_ids[LM_CLOSE], NULL, NULL);
        }
        if (exchange_flush(context) == IPC_No_Error) {
            read_rest(context);
        }
    } else if (context_is_open(context)) {
        net_close_copy(context->link.fd);
        context->link.fd = -1;
    }
    context_close(context, CONTEXT_CLOSED);
}
