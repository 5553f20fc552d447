/*
 * Connecting to central for the first time.
 */
#include "libipc/connect.h"

#include <string.h>

#include "base/error.h"
#include "libipc/address.h"
#include "libipc/closing.h"
#include "libipc/handshake.h"
#include "libipc/inbox.h"
#include "libipc/receive.h"
#include "libipc/report_result.h"
#include "libipc/wait.h"

enum { N_TRIES = 5, PAUSE_MS = 1000, CONNECT_TIMEOUT_MS = 10000 };

/* How a try to connect ended. */
enum try_result {
    TRY_OK,
    TRY_NOBODY,  /* nobody listens there */
    TRY_BROKEN,  /* somebody does, but the handshake did not come to its end */
    TRY_MISMATCH /* central speaks another major version */
};

/* ------------------------------------------------------------------------ tries */

static enum try_result shake_hands(struct _X_IPC_CONTEXT *context)
{
    struct handshake handshake;
    handshake_init(&handshake, context);
    enum handshake_result result = handshake_step(&handshake);
    while (result == HANDSHAKE_GOES_ON) {
        const bool go_on = wait_turn(context->library, handshake.deadline_ns);
        result = handshake_step(&handshake);
        if (!go_on && result == HANDSHAKE_GOES_ON) {
            result = HANDSHAKE_BROKEN;
        }
    }
    handshake_fini(&handshake);
    return result == HANDSHAKE_DONE       ? TRY_OK
           : result == HANDSHAKE_MISMATCH ? TRY_MISMATCH
                                          : TRY_BROKEN;
}

/* The context becomes the current one, of the process and of the callback that connected. */
static void make_current(struct library *library, struct _X_IPC_CONTEXT *context)
{
    struct running *running = library_running(library);
    context->unseen = false;
    library->current = context;
    if (running != NULL && running->context != NULL) {
        running->context = context;
    }
    context_connected(context);
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
    context->lost = closing_lost;
    context->local = local;
    net_peer_address(fd, context->address, sizeof context->address);
    receive_start(context);
    const enum try_result result = shake_hands(context);
    if (result == TRY_OK) {
        make_current(library, context);
    } else {
        closing_end(context, CONTEXT_CLOSED); /* nobody has seen it */
    }
    inbox_tell(library); /* other connections may have brought something meanwhile */
    library_leave(library);
    return result;
}

enum already {
    ALREADY_NOT,
    ALREADY_CONNECTED,
    ALREADY_AWAY /* and has not come back while this call waited */
};

/* Whether the current context belongs to that server already; its listening kind changes then.  One that
 * is away has so long to come back. */
static enum already look_for_connection(const char *server, bool will_listen, unsigned patience_ms,
                                        int *port)
{
    enum already already = ALREADY_NOT;
    struct library *library = library_enter();
    library_initialise(library);
    struct _X_IPC_CONTEXT *context = context_current_live(library);
    if (context != NULL && strcmp(context->server_name, server) == 0) {
        context->will_listen = will_listen;
        *port = context->port;
        const uint64_t deadline = wait_deadline(patience_ms);
        bool go_on = true;
        while (go_on && context->away != NULL && !wait_is_over(deadline)) {
            go_on = wait_turn(library, deadline);
        }
        already = context_is_connected(context) ? ALREADY_CONNECTED : ALREADY_AWAY;
        inbox_tell(library);
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

static void report_connected(int port)
{
    report_warning("... IPC Connected on port %d\n", port);
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
            report_connected(address.port);
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

/* ------------------------------------------------------------------- connecting */

static void report_version(void)
{
    report_banner("NMP IPC Version %s (%s)\n", IPC_VERSION, IPC_RELEASE_DATE);
}

IPC_RETURN_TYPE connect_module(const char *module, const char *server, bool will_listen)
{
    char own_host[NET_NAME_SIZE];
    int port;
    if (module == NULL || *module == '\0') {
        return report(IPC_Null_Argument);
    }
    report_version();
    server = address_choose(server, own_host);
    const bool by_default = server == own_host;
    if (by_default) {
        report_warning("Warning: CENTRALHOST environment variable not set.\n");
    }
    const enum already already =
        look_for_connection(server, will_listen, N_TRIES * PAUSE_MS, &port);
    if (already == ALREADY_AWAY) {
        return report(IPC_Not_Connected);
    }
    if (already == ALREADY_CONNECTED) {
        report_warning("x_ipcConnectModule: already connected to %s\n", server);
        report_connected(port);
        return IPC_OK;
    }
    return try_often(module, server, by_default, will_listen);
}

IPC_RETURN_TYPE connect_if_there(const char *module, const char *server)
{
    char own_host[NET_NAME_SIZE];
    struct address address;
    int port;
    if (module == NULL || *module == '\0') {
        return report(IPC_Null_Argument);
    }
    server = address_choose(server, own_host);
    const enum already already = look_for_connection(server, true, 0, &port);
    if (already != ALREADY_NOT) {
        return already == ALREADY_CONNECTED ? IPC_OK : IPC_Timeout;
    }
    if (address_parse(server, &address) != 0) {
        return report(IPC_Not_Connected);
    }
    const enum try_result result = try_once(module, server, true, &address);
    if (result == TRY_NOBODY) {
        return IPC_Timeout;
    }
    report_version();
    if (result != TRY_OK) {
        explain(result);
        return report(IPC_Not_Connected);
    }
    report_connected(address.port);
    return IPC_OK;
}
