/*
 * Ending central and modules.
 */
#include "libipc/shell.h"


#include "base/error.h"
#include "libipc/address.h"
#include "libipc/closing.h"
#include "libipc/connect.h"
#include "libipc/exchange.h"
#include "platform/owner.h"

enum { PATIENCE_MS = 5000, PAUSE_MS = 20, CONNECT_MS = 2000 };

static enum shell_result end_process(int process)
{
    switch (owner_end(process)) {
    case 0:
        return SHELL_ENDED;
    case ERR_REFUSED:
        return SHELL_REFUSED;
    default:
        return SHELL_ELSEWHERE;
    }
}

/* ---------------------------------------------------------------------- central */

/* The connection ends when central does. */
static bool await_end(int fd)
{
    const uint64_t deadline = clock_ns() + (uint64_t)PATIENCE_MS * 1000000u;
    for (;;) {
        char bytes[256];
        const ptrdiff_t n = net_read(fd, bytes, sizeof bytes);
        const uint64_t now = clock_ns();
        if (n < 0 || now >= deadline) {
            return n < 0;
        }
        struct ready_item item = {fd, READY_READ, 0};
        (void)ready_wait(&item, 1, (int64_t)((deadline - now) / 1000000u) + 1);
    }
}

static enum shell_result end_central_at(const struct address *address)
{
    int fd;
    bool local;
    if (address_connect(address, CONNECT_MS, NULL, &fd, &local) != 0) {
        return SHELL_NONE;
    }
    const int process = local ? owner_of_peer(fd) : owner_of_port(address->port, true);
    enum shell_result result = process > 0 ? end_process(process) : SHELL_ELSEWHERE;
    if (result == SHELL_ENDED && !await_end(fd)) {
        result = SHELL_STAYS;
    }
    net_close(fd);
    return result;
}

/* Whether the other end of a TCP connection to that host is this machine. */
static bool is_this_machine(const struct address *address)
{
    return address->local || address_is_loopback(address);
}

enum shell_result shell_end_central(const char *server)
{
    struct address address;
    char own_host[NET_NAME_SIZE];
    if (address_parse(address_choose(server, own_host), &address) != 0) {
        return SHELL_NONE;
    }
    return is_this_machine(&address) ? end_central_at(&address) : SHELL_ELSEWHERE;
}

/* ---------------------------------------------------------------------- modules */

static enum shell_result end_all(const struct process_list *list)
{
    enum shell_result result = list->count > 0 ? SHELL_ENDED : SHELL_NONE;
    for (int i = 0; i < list->count; i++) {
        const struct module_process *found = &list->processes[i];
        const int process = found->process > 0 ? found->process
                            : found->port > 0  ? owner_of_port(found->port, false)
                                               : 0;
        const enum shell_result one = process > 0 ? end_process(process) : SHELL_ELSEWHERE;
        result = one != SHELL_ENDED ? one : result;
    }
    return result;
}

/* Central notices the end of a module by its connection. */
static enum shell_result await_absence(struct _X_IPC_CONTEXT *context, const char *module)
{
    const uint64_t deadline = clock_ns() + (uint64_t)PATIENCE_MS * 1000000u;
    int connected = 1;
    while (exchange_ask(context, LM_IS_CONNECTED, &module, &connected) == IPC_No_Error &&
           connected != 0 && clock_ns() < deadline) {
        library_leave(context->library);
        (void)ready_wait(NULL, 0, PAUSE_MS);
        mutex_lock(context->library->lock);
    }
    return connected != 0 ? SHELL_STAYS : SHELL_ENDED;
}

static enum shell_result end_module_of(struct _X_IPC_CONTEXT *context, const char *module)
{
    const struct format *format = context->library->catalogue.reply[LM_PROCESSES];
    struct process_list list;
    if (exchange_ask(context, LM_PROCESSES, &module, &list) != IPC_No_Error) {
        return SHELL_CANNOT_ASK;
    }
    enum shell_result result = end_all(&list);
    (void)format_release(format, &list);
    return result == SHELL_ENDED ? await_absence(context, module) : result;
}

enum shell_result shell_end_module(const char *module, const char *server)
{
    struct library *library = library_enter();
    struct _X_IPC_CONTEXT *context = server == NULL ? context_current_connected(library) : NULL;
    const bool own = context == NULL;
    library_leave(library);
    if (own && connect_module("killModule", server, false) != IPC_OK) {
        return SHELL_NONE;
    }
    library = library_enter();
    context = context_current_connected(library);
    enum shell_result result = SHELL_NONE;
    if (context != NULL) {
        result = end_module_of(context, module);
    }
    if (own && context != NULL) {
        closing_disconnect(context, true);
    }
    library_leave(library);
    return result;
}
