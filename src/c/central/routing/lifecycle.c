/*
 * How a server begins and ends, and how connections join it.
 */
#include "central/routing/lifecycle.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "central/routing/ending.h"
#include "central/routing/log_variables.h"
#include "central/routing/outbox.h"
#include "central/routing/resend.h"
#include "central/routing/tap.h"
#include "central/routing/value.h"
#include "platform/platform.h"

/* ------------------------------------------------------------ what it begins with */

static void define_library_message(struct server *server, enum library_message which,
                                   const char *name)
{
    const struct library_message_entry *entry = &library_messages[which];
    struct message *message = message_get(&server->messages, name);
    const enum message_kind kind =
        entry->class == CLASS_BROADCAST ? MESSAGE_NOTICE : MESSAGE_SERVICE;
    message_define_internal(&server->messages, message, kind, entry->class,
                            server->catalogue.request[which], server->catalogue.reply[which]);
    message->service = which;
    message->ignored = !entry->logged;
}

static void define_library_messages(struct server *server)
{
    for (int i = 0; i < LM_COUNT; i++) {
        const struct library_message_entry *entry = &library_messages[i];
        define_library_message(server, (enum library_message)i, entry->name);
        server->library[i] = message_find(&server->messages, entry->name);
        if (entry->alias != NULL) {
            define_library_message(server, (enum library_message)i, entry->alias);
        }
    }
}

/* Named formats that modules of all ages expect to be there. */
static void define_formats(struct server *server)
{
    static const struct two_names formats[] = {
        {"X_IPC_POINT_CLASS_TYPE", "int"},
        {"X_IPC_INTERVAL_CLASS_TYPE", "int"},
        {"X_IPC_INTERVAL_TYPE", "{X_IPC_INTERVAL_CLASS_TYPE, int}"},
        {"X_IPC_TIME_POINT_TYPE", "{X_IPC_POINT_CLASS_TYPE, X_IPC_INTERVAL_TYPE}"},
        {"INTERVAL_MONITOR_OPTIONS_PTR", "*{int, int, int, int, int}"},
        {"INT_MON_CLASS_TYPE",
         "{X_IPC_TIME_POINT_TYPE, X_IPC_TIME_POINT_TYPE, INTERVAL_MONITOR_OPTIONS_PTR}"},
        {"directMsgHandler", "{int, int, int, int, string, string}"},
    };
    server->names = format_names_new();
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++) {
        /* The names are no primitives, so none is refused. */
        (void)format_names_define(server->names, formats[i].first, formats[i].second);
    }
}

static struct variable *define_list_variable(struct server *server, const char *name)
{
    struct name_list none = {0, 0, NULL};
    struct variable *variable =
        variable_define_own(server, name, FORMAT_NAME_LIST, server->catalogue.name_list);
    value_set_own(server, variable, &none);
    return variable;
}

void server_ignore_names(struct server *server)
{
    struct list *at, *following;
    LIST_EACH (at, following, &server->options->ignored) {
        const struct ignored_name *ignored = LIST_OWNER(at, struct ignored_name, in_options);
        struct message *message = message_get(&server->messages, ignored->name);
        if (message != NULL) {
            message->ignored = true;
        }
    }
}

static void init_lists(struct server *server)
{
    list_init(&server->active_broadcasts);
    list_init(&server->modules);
    list_init(&server->greeted);
    list_init(&server->waiting);
    list_init(&server->input);
    list_init(&server->urgent);
    list_init(&server->flush);
    list_init(&server->due);
    list_init(&server->condemned);
    list_init(&server->ended);
    list_init(&server->crowded);
    list_init(&server->losses);
}

void server_init(struct server *server, struct options *options, int terminal_fd, uint64_t now_ns)
{
    memset(server, 0, sizeof *server);
    server->options = options;
    server->start_ns = server->now_ns = now_ns;
    server->clock = clock_ns;
    if (catalogue_init(&server->catalogue) != 0) {
        (void)fputs("ERROR: no memory to start with\n", stderr);
        abort();
    }
    init_lists(server);
    define_formats(server);
    log_init(&server->log, options, terminal_fd);
    server->log.names = server->names;
    message_registry_init(&server->messages);
    table_init(&server->variables, TABLE_FOLDING);
    dispatch_pool_init(&server->dispatches);
    pending_pool_init(&server->places);
    namesakes_init(&server->module_names);
    namesakes_init(&server->resource_names);
    define_library_messages(server);
    log_variables_define(server);
    server->tapped = define_list_variable(server, VARIABLE_TAPPED);
    server->broadcasts = define_list_variable(server, VARIABLE_BROADCASTS);
    server_ignore_names(server);
}

/* -------------------------------------------------------------------- connections */

/* The number of the look-up request, bare, and in two frames the formats of it and of its answer.
 */
static void greet(struct server *server, struct module *module)
{
    const struct format *formats[] = {server->catalogue.request[LM_MESSAGE_INFO],
                                      server->catalogue.reply[LM_MESSAGE_INFO]};
    struct format *format_format = NULL;
    uint8_t number[4];
    store_be32(number, (uint32_t)server->library[LM_MESSAGE_INFO]->id);
    outbox_queue_raw(server, module, number, sizeof number);
    if (format_parse("format", NULL, &format_format, NULL) != 0) {
        return; /* without memory nobody is served */
    }
    for (size_t i = 0; i < 2; i++) {
        struct buffer data;
        struct frame frame;
        buffer_init(&data);
        (void)payload_encode(format_format, &formats[i], &data);
        frame_init(&frame, CLASS_NONE);
        frame.parent = frame.intent = frame.dispatch = frame.reference = 0;
        frame.data = data.bytes;
        frame.data_length = (uint32_t)data.length;
        outbox_queue(server, module, &frame, OUTBOX_NORMAL);
        buffer_fini(&data);
    }
    format_unref(format_format);
}

struct module *server_add_connection(struct server *server, int fd)
{
    struct module *module = module_new(fd, server->now_ns);
    struct statistics *statistics = &server->statistics;
    module->link.reader.limit_data = (uint32_t)server->options->limits.data;
    module->link.reader.limit_class_data = (uint32_t)server->options->limits.class_data;
    list_append(&server->modules, &module->in_server);
    list_append(&server->greeted, &module->in_state);
    server->n_greeted++;
    statistics->n_modules++;
    statistics->n_accepted++;
    if (statistics->n_modules > statistics->peak_modules) {
        statistics->peak_modules = statistics->n_modules;
    }
    greet(server, module);
    return module;
}

/* ---------------------------------------------------------------------- the end */

/* Queries that nobody ever handled. */
static void drop_waiting(struct server *server)
{
    const struct table *names = &server->messages.names;
    for (struct table_entry *entry = table_first(names); entry != NULL;
         entry = table_next(names, entry)) {
        struct message *message = entry->value;
        while (!list_is_empty(&message->waiting)) {
            dispatch_free(&server->dispatches,
                          LIST_OWNER(message->waiting.next, struct dispatch, link));
        }
    }
}

void server_fini(struct server *server)
{
    log_close(&server->log); /* how everything is taken down is of no interest */
    while (!list_is_empty(&server->modules)) {
        ending(server, LIST_OWNER(server->modules.next, struct module, in_server), ENDING_COMMAND);
    }
    drop_waiting(server);
    resend_fini(server);
    ending_sweep(server);
    tap_free_all(server);
    variable_free_all(server);
    message_registry_fini(&server->messages);
    dispatch_pool_fini(&server->dispatches);
    pending_pool_fini(&server->places);
    namesakes_fini(&server->module_names);
    namesakes_fini(&server->resource_names);
    format_names_free(server->names);
    catalogue_fini(&server->catalogue);
    log_fini(&server->log);
}
