/*
 * Commands typed while the server runs.
 */
#include "central/operator/console.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "central/routing/claim.h"
#include "central/routing/ending.h"
#include "central/routing/flow.h"
#include "central/routing/lifecycle.h"
#include "central/routing/log_variables.h"
#include "central/routing/resend.h"
#include "central/operator/statistics.h"
#include "central/operator/tables.h"
#include "central/settings/version.h"
#include "central/settings/command_line.h"

enum { LIMIT_LINE = 64 * 1024 };

/* ------------------------------------------------------------------- comments */

static void go_on_after_comments(struct console *console)
{
    const enum console_next next = console->next;
    console->next = CONSOLE_GO_ON;
    if (next == CONSOLE_CLOSE_FILE) {
        log_close_file(&console->server->log, LOG_FILE);
    } else if (next == CONSOLE_QUIT) {
        console->wants_to_quit = true;
    }
}

/* Asks, if comments are wanted and somebody is there; what is next follows in any case. */
static void ask_for_comments(struct console *console, enum console_next next)
{
    const struct options *options = console->server->options;
    console->next = next;
    if (console->server->log.file.is_open && options->file.comments && !options->silent &&
        console->may_ask) {
        comments_ask(&console->comments, &console->server->log);
    } else {
        go_on_after_comments(console);
    }
}

int console_open_log(struct console *console)
{
    const int error = log_open_file(&console->server->log, LOG_FILE);
    if (error == 0) {
        ask_for_comments(console, CONSOLE_GO_ON);
    }
    return error;
}

static void take_comment(struct console *console, const char *line)
{
    comments_take(&console->comments, &console->server->log, line);
    if (!console->comments.asking) {
        go_on_after_comments(console);
    }
}

/* ------------------------------------------------------------------- commands */

/* Writes a buffer to the terminal, also when silent: it answers a command. */
static void show(struct console *console, struct buffer *text)
{
    sink_put(&console->server->log.terminal, text->bytes, text->length);
    buffer_fini(text);
}

static void show_commands(struct console *console, const char *argument);

static void show_resource(struct log *log, const struct resource *resource)
{
    log_always(log, " Resource %s  Attending: %zu  Pending: %zu Resource Status: %s\n",
               resource->name, resource->attending,
               resource->n_ahead + resource->pending.count + resource->holders_own.count,
               resource_state_name(resource));
}

/* Resources of modules, and those that stand in for handlers that nobody has. */
static void show_status(struct console *console, const char *argument)
{
    struct server *server = console->server;
    const struct table *names = &server->messages.names;
    struct list *outer, *after, *at, *following;
    (void)argument;
    log_always(&server->log, "Resource status\n");
    LIST_EACH (outer, after, &server->modules) {
        const struct module *module = LIST_OWNER(outer, struct module, in_server);
        LIST_EACH (at, following, &module->resources) {
            show_resource(&server->log, LIST_OWNER(at, struct resource, in_owner));
        }
    }
    for (struct table_entry *entry = table_first(names); entry != NULL;
         entry = table_next(names, entry)) {
        const struct message *message = entry->value;
        if (message->n_waiting > 0) {
            log_always(&server->log,
                       " Resource %s  Attending: 0  Pending: %zu Resource Status: Active\n",
                       message->name, message->n_waiting);
        }
    }
}

static const char *state_word(const struct dispatch *dispatch)
{
    switch (dispatch->state) {
    case DISPATCH_HELD:
        return "Completed";
    case DISPATCH_WAITING:
    case DISPATCH_PENDING:
    case DISPATCH_AHEAD:
        return "Pending";
    case DISPATCH_SERVED: /* a request that has to wait for its answer */
        return "Pending";
    case DISPATCH_ACTIVE:
        return "Active";
    case DISPATCH_NEW:
        break;
    }
    return "Allocated";
}

static void show_dispatches(struct console *console, const char *argument)
{
    struct server *server = console->server;
    (void)argument;
    log_always(&server->log, "Active and Pending Messages:\n");
    for (uint32_t id = 0; id < server->dispatches.numbers.n_slots; id++) {
        const struct dispatch *dispatch = dispatch_find(&server->dispatches, id);
        if (dispatch != NULL) {
            log_always(&server->log, "  %s {%" PRIu32 "}: %s\n", dispatch->message->name, id,
                       state_word(dispatch));
        }
    }
}

static void show_modules(struct console *console, const char *argument)
{
    struct buffer text;
    (void)argument;
    buffer_init(&text);
    tables_modules(console->server, &text);
    show(console, &text);
}

static void show_messages(struct console *console, const char *argument)
{
    struct buffer text;
    buffer_init(&text);
    tables_messages(console->server, &text, strcmp(argument, "all") == 0);
    show(console, &text);
}

static void show_queues(struct console *console, const char *argument)
{
    struct buffer text;
    (void)argument;
    buffer_init(&text);
    tables_queues(console->server, &text);
    show(console, &text);
}

static void show_memory(struct console *console, const char *argument)
{
    struct buffer text;
    (void)argument;
    buffer_init(&text);
    statistics_append(console->server, &text);
    show(console, &text);
}

/* The connection of that name that came last, or NULL. */
static struct module *find_module(const struct server *server, const char *name)
{
    const struct list *group = namesakes_find(&server->module_names, name);
    return group == NULL ? NULL : LIST_OWNER(group->previous, struct module, same_name);
}

static void close_module(struct console *console, const char *argument)
{
    struct server *server = console->server;
    struct module *module = find_module(server, argument);
    if (module == NULL) {
        log_always(&server->log, "Can not find %s to close.\n", argument);
    } else {
        ending(server, module, ENDING_COMMAND);
    }
}

static void unlock_resource(struct server *server, struct resource *resource)
{
    claim_give_back(server, resource);
    flow_release(server, resource);
}

static void unlock(struct console *console, const char *argument)
{
    struct server *server = console->server;
    const struct list *group = namesakes_find(&server->resource_names, argument);
    struct module *module = find_module(server, argument);
    struct resource *resource =
        group == NULL ? NULL : LIST_OWNER(group->next, struct resource, same_name);
    if (resource != NULL && resource->state != RESOURCE_ACTIVE) {
        unlock_resource(server, resource);
    } else if (module != NULL) {
        while ((resource = claim_give_back_any(server, module)) != NULL) {
            flow_release(server, resource);
        }
    } else if (resource == NULL) {
        log_always(&server->log, "Can not find %s to unlock.\n", argument);
    }
}

static void quit(struct console *console, const char *argument)
{
    (void)argument;
    ask_for_comments(console, CONSOLE_QUIT);
}

static void dump(struct console *console, const char *argument)
{
    (void)console;
    (void)argument;
    (void)fputs(" dump not available, recompile with DBMALLOC\n", stderr);
}

struct command {
    const char *name;
    const char *help; /* NULL: not listed */
    void (*execute)(struct console *console, const char *argument);
};

/* In the order of the listing; of several that an abbreviation fits, the first is meant. */
static const struct command commands[] = {
    {"help", "help: print this message.\n", show_commands},
    {"?", NULL, show_commands},
    {"display", "display : Display active and pending messages.\n", show_dispatches},
    {"status", "status : Display the known modules and their status.\n", show_status},
    {"memory", "memory : Display total memory usage.\n", show_memory},
    {"close", "close <module>: Close a connection to a module.\n", close_module},
    {"unlock", "unlock <resource>: Unlock a locked resouce.\n", unlock},
    {"dump", NULL, dump},
    {"quit", NULL, quit},
    {"modules", "modules : Display what the connected modules send and get.\n", show_modules},
    {"messages", "messages [all]: Display how often messages are sent, and what waits of them.\n",
     show_messages},
    {"queues", "queues : Display what is under way to the modules, and what waits.\n", show_queues},
};

enum { N_COMMANDS = sizeof commands / sizeof commands[0] };

static void show_commands(struct console *console, const char *argument)
{
    struct buffer text;
    (void)argument;
    buffer_init(&text);
    text_append(&text, "\nThe following command are available:\n");
    for (size_t i = 0; i < N_COMMANDS; i++) {
        if (commands[i].help != NULL) {
            text_append(&text, "%s", commands[i].help);
        }
    }
    text_append(&text, "The following command line options can also be used as commands\n");
    options_show_help(&text, true);
    show(console, &text);
}

/* -------------------------------------------------------------------- options */

static bool differ(const struct log_switches *a, const struct log_switches *b)
{
    return memcmp(a, b, sizeof *a) != 0; /* bools only; a difference in padding does no harm */
}

/* Tells those who watch them that switches were changed. */
static void tell_switches(struct server *server, const struct options *before)
{
    const struct options *options = server->options;
    if (differ(&options->terminal, &before->terminal) || options->silent != before->silent) {
        log_variables_set_terminal(server);
    }
    if (differ(&options->file, &before->file)) {
        log_variables_set_file(server);
    }
}

/* Opens the log files that are wanted now, closes those that no longer are. */
static void open_or_close_files(struct console *console)
{
    struct log *log = &console->server->log;
    const bool wants_file = log_wants_file(log, LOG_FILE);
    const bool wants_json = log_wants_file(log, LOG_JSON);
    if (wants_json && !log->json.is_open) {
        (void)log_open_file(log, LOG_JSON); /* a failure has been said */
    } else if (!wants_json && log->json.is_open) {
        log_close_file(log, LOG_JSON);
    }
    if (wants_file && !log->file.is_open) {
        (void)console_open_log(console);
    } else if (!wants_file && log->file.is_open) {
        ask_for_comments(console, CONSOLE_CLOSE_FILE);
    }
}

/* Executes the options among the words of a line, and says what they have to say. */
static void type_options(struct console *console, char *line)
{
    struct buffer out, errors;
    const struct options_output output = {&out, &errors};
    buffer_init(&out);
    buffer_init(&errors);
    for (char *word = strtok(line, " \t"); word != NULL; word = strtok(NULL, " \t")) {
        if (word[0] == '-') {
            (void)options_type(console->server->options, word, &output); /* the unknown is said */
        }
    }
    text_print(stderr, &errors);
    show(console, &out);
    buffer_fini(&errors);
}

static void execute_options(struct console *console, char *line)
{
    struct server *server = console->server;
    const struct options before = *server->options;
    type_options(console, line);
    server_ignore_names(server);
    log_switched(&server->log);
    tell_switches(server, &before);
    open_or_close_files(console);
    log_terminal(&server->log, SERVER_BANNER "\n");
}

/* ---------------------------------------------------------------------- lines */

static char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

static bool begins_with(const char *name, const char *word, size_t length)
{
    for (size_t i = 0; i < length; i++) {
        if (name[i] == '\0' || name[i] != lower(word[i])) {
            return false;
        }
    }
    return true;
}

static const struct command *find_command(const char *word, size_t length)
{
    for (size_t i = 0; i < N_COMMANDS; i++) {
        if (begins_with(commands[i].name, word, length)) {
            return &commands[i];
        }
    }
    return NULL;
}

/* The rest of a line without blanks around it, or what stands between quotes. */
static char *argument_in(char *rest)
{
    while (is_blank(*rest)) {
        rest++;
    }
    size_t length = strlen(rest);
    while (length > 0 && is_blank(rest[length - 1])) {
        length--;
    }
    if (length >= 2 && rest[0] == '"' && rest[length - 1] == '"') {
        rest++;
        length -= 2;
    }
    rest[length] = '\0';
    return rest;
}

static void execute(struct console *console, char *line)
{
    while (is_blank(*line)) {
        line++;
    }
    const size_t length = strcspn(line, " \t");
    if (length == 0) {
        return;
    }
    if (line[0] == '-') {
        execute_options(console, line);
        return;
    }
    const struct command *command = find_command(line, length);
    if (command != NULL) {
        command->execute(console, argument_in(line + length));
        return;
    }
    struct buffer text;
    buffer_init(&text);
    text_append(&text, "Unrecognized Command :%s\n", line);
    show(console, &text);
    show_commands(console, "");
}

void console_init(struct console *console, struct server *server)
{
    memset(console, 0, sizeof *console);
    console->server = server;
    buffer_init(&console->line);
    comments_init(&console->comments);
}

void console_fini(struct console *console)
{
    comments_end(&console->comments, &console->server->log); /* as far as they have come */
    comments_fini(&console->comments);
    buffer_fini(&console->line);
}

bool console_listens(const struct console *console)
{
    return console->server->options->read_commands || console->comments.asking;
}

void console_prompt(struct console *console)
{
    if (console->server->options->read_commands && !console->comments.asking &&
        !resend_asks(console->server)) {
        log_terminal(&console->server->log, "> ");
    }
}

/* Executes a line, or takes it as the answer to what was asked. */
static void take_line(struct console *console, char *line)
{
    if (console->comments.asking) {
        take_comment(console, line);
    } else if (resend_asks(console->server)) {
        resend_answer(console->server, line);
    } else {
        execute(console, line);
    }
}

/* Executes what stands in console->line, which then is empty. */
static void finish_line(struct console *console)
{
    static const char end = '\0';
    if (console->line_is_too_long || buffer_append(&console->line, &end, 1) != 0) {
        (void)fputs("ERROR: the command is too long\n", stderr);
    } else {
        take_line(console, (char *)console->line.bytes);
    }
    console->line_is_too_long = false;
    buffer_clear(&console->line);
    if (!console->wants_to_quit) {
        console_prompt(console);
    }
}

void console_feed(struct console *console, const char *bytes, size_t count)
{
    for (size_t i = 0; i < count && !console->wants_to_quit; i++) {
        if (!console_listens(console)) {
            return; /* -u was typed */
        }
        if (bytes[i] == '\n') {
            finish_line(console);
        } else if (bytes[i] == '\r' || bytes[i] == '\0') {
            continue;
        } else if (console->line.length >= LIMIT_LINE ||
                   buffer_append(&console->line, &bytes[i], 1) != 0) {
            console->line_is_too_long = true;
        }
    }
}

void console_end_input(struct console *console)
{
    if (console->line.length > 0 && console_listens(console)) {
        finish_line(console);
    }
    if (console->comments.asking) {
        take_comment(console, "");
    }
}
