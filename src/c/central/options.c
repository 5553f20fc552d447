/*
 * The table of options, what each of them does, and the texts about them.
 */
#include "central/options.h"

#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "central/text.h"
#include "central/version.h"

#define DEFAULT_PORT 1381
#define HIGHEST_PORT 65535

#define LIMIT_PREFIX "--limit-"
#define WHEN_FULL_PREFIX "--when-full="

/* -------------------------------------------------------------------- texts */

void options_show_version(struct buffer *out)
{
    text_append(out, SERVER_TITLE " \n Released : " IPC_RELEASE_DATE
                                  "\n Commited : $Date: " IPC_BUILD_TIME
                                  " $\n Compiled : " IPC_BUILD_TIME "\n");
}

/* ------------------------------------------------------------------ actions */

struct action {
    struct options *options;
    const char *value; /* behind the letter */
    const struct options_output *output;
    bool typed;
};

/* 0, or ERR_RANGE for a value that cannot be (said on errors). */
typedef int (*action_function)(const struct action *action);

/* Whether letters hold a letter, in either case. */
static bool has(const char *letters, char lower)
{
    const char upper = (char)(lower - 'a' + 'A');
    return strchr(letters, lower) != NULL || strchr(letters, upper) != NULL;
}

static void switch_all(struct log_switches *on, bool state)
{
    on->messages = on->status = on->time = on->data = on->summary = state;
    on->ignore = false;
}

static void switch_log(struct log_switches *on, const char *letters)
{
    if (letters[0] == '\0') {
        switch_all(on, true);
        on->references = false;
    } else if (has(letters, 'x')) {
        switch_all(on, false);
    } else {
        on->messages = has(letters, 'm');
        on->status = has(letters, 's');
        on->time = has(letters, 't');
        on->data = has(letters, 'd');
        on->ignore = has(letters, 'i');
        on->summary = has(letters, 'h');
        on->references = has(letters, 'r');
        on->parents = has(letters, 'p');
        on->flush = !has(letters, 'f');
        on->comments = !has(letters, 'n');
    }
}

static int switch_terminal(const struct action *action)
{
    switch_log(&action->options->terminal, action->value);
    if (action->typed) {
        action->options->silent = false;
    }
    return 0;
}

static int switch_file(const struct action *action)
{
    switch_log(&action->options->file, action->value);
    return 0;
}

static int name_file(const struct action *action)
{
    if (action->value[0] != '\0') {
        free(action->options->file_name);
        action->options->file_name = mem_copy_string(action->value);
        text_append(action->output->out, "Logging File Name: %s\n", action->value);
    }
    return 0;
}

static int choose_port(const struct action *action)
{
    if (action->typed) {
        text_append(action->output->out, "The port cannot be changed while running\n");
        return 0;
    }
    char *end;
    const long port = strtol(action->value, &end, 10);
    if (end == action->value) {
        return 0;
    }
    if (port < 0 || port > HIGHEST_PORT) {
        text_append(action->output->errors, "Illegal port %s\n", action->value);
        return ERR_RANGE;
    }
    action->options->port = (int)port;
    return 0;
}

static int choose_direct(const struct action *action)
{
    action->options->direct = true;
    return 0;
}

static int choose_silence(const struct action *action)
{
    action->options->silent = true;
    return 0;
}

static int refuse_commands(const struct action *action)
{
    action->options->read_commands = false;
    return 0;
}

static int choose_resending(const struct action *action)
{
    action->options->resend = true;
    return 0;
}

static int do_nothing(const struct action *action)
{
    (void)action;
    return 0;
}

static void ignore_name(struct options *options, const char *name, size_t length)
{
    struct ignored_name *ignored = mem_new(sizeof *ignored + length + 1);
    memcpy(ignored->name, name, length);
    list_append(&options->ignored, &ignored->in_options);
}

static int ignore_message(const struct action *action)
{
    if (action->value[0] != '\0') {
        ignore_name(action->options, action->value, strlen(action->value));
    }
    return 0;
}

/* Reads one line without its end; false at the end of the file. */
static bool read_line(FILE *file, struct buffer *line)
{
    buffer_clear(line);
    int c = getc(file);
    if (c == EOF) {
        return false;
    }
    for (; c != EOF && c != '\n'; c = getc(file)) {
        const char byte = (char)c;
        if (buffer_append(line, &byte, 1) != 0) {
            return false;
        }
    }
    if (line->length > 0 && line->bytes[line->length - 1] == '\r') {
        line->length--;
    }
    return true;
}

static int ignore_messages_of_file(const struct action *action)
{
    FILE *file = fopen(action->value, "r");
    if (file == NULL) {
        text_append(action->output->errors, "Could not open message ignore file %s\n",
                    action->value);
        return 0;
    }
    struct buffer line;
    buffer_init(&line);
    while (read_line(file, &line)) {
        if (line.length > 0) {
            ignore_name(action->options, (const char *)line.bytes, line.length);
            text_append(action->output->errors, "Ignore logging of %.*s\n", (int)line.length,
                        (const char *)line.bytes);
        }
    }
    buffer_fini(&line);
    fclose(file);
    return 0;
}

static int show_version(const struct action *action)
{
    options_show_version(action->output->errors);
    return 0;
}

static int show_help(const struct action *action)
{
    options_show_help(action->output->out, true);
    return 0;
}

/* -------------------------------------------------------------------- table */

enum option_use {
    USE_ANYWHERE,
    USE_TYPED_OR_ALONE /* on a command line it has to be the first argument */
};

struct option {
    char letter;
    enum option_use use;
    bool listed_when_typed;
    action_function act;
    const char *help; /* whole lines, "" for an option that is not listed */
};

/* In the order of the listing.  Its spelling is as old as the program: scripts compare it. */
static const struct option table[] = {
    {'v', USE_TYPED_OR_ALONE, true, show_version, " -v: display server version info.\n"},
    {'h', USE_TYPED_OR_ALONE, true, show_help, ""},
    {'l', USE_ANYWHERE, true, switch_terminal,
     " -l: logging onto terminal.\n"
     "     options are: m (message traffic)\n"
     "                  s (status of IPC)\n"
     "                  t (time messages are handled)\n"
     "                  d (data associated with message)\n"
     "                  i (ignore logging registration and deregistration messages)\n"
     "                  h (incoming message handle time summary)\n"
     "                  r (log the reference Id as well as the msg name)\n"
     "                  p (log the reference Id of the message's parent)\n"
     "                  x (no logging)\n"
     "     -l is equivalent to -lmstdh; the default is -lmsi\n"},
    {'L', USE_ANYWHERE, true, switch_file,
     " -L: logging into file.\n"
     "     options are the same as above with the addition of F.\n"
     "                  F (don't flush file after each line)\n"
     "                  n (do not prompt the user for comments)\n"
     "     the default is -Lx\n"},
    {'f', USE_ANYWHERE, true, name_file,
     " -f: filename to use for logging.\n"
     "     If not specified, name is automatically generated.\n"},
    {'p', USE_ANYWHERE, false, choose_port,
     " -p<port>: specify the server port - the default port is: 1381\n"},
    {'c', USE_ANYWHERE, true, choose_direct,
     " -c: Use direct (not via central) conntections where possible.\n"},
    {'i', USE_ANYWHERE, true, ignore_message,
     " -i<msgName>: Ignore logging this message (can occur multiple times).\n"},
    {'I', USE_ANYWHERE, true, ignore_messages_of_file,
     " -I<fileName>: File with names of messages to ignore logging.\n"},
    {'s', USE_ANYWHERE, true, choose_silence,
     " -s: silent running, don't print anything to stdout.\n"},
    {'S', USE_ANYWHERE, true, choose_silence, ""},
    {'u', USE_ANYWHERE, true, refuse_commands, " -u: Don't run the user interface (stdin).\n"},
    {'r', USE_ANYWHERE, true, choose_resending,
     " -r: try resending non-completed messages when modules crash\n"},
    {'d', USE_ANYWHERE, true, do_nothing, ""},
};

enum { N_OPTIONS = sizeof table / sizeof table[0] };

void options_show_help(struct buffer *out, bool typed)
{
    for (size_t i = 0; i < N_OPTIONS; i++) {
        if (!typed || table[i].listed_when_typed) {
            text_append(out, "%s", table[i].help);
        }
    }
}

static const struct option *find_option(char letter)
{
    for (size_t i = 0; i < N_OPTIONS; i++) {
        if (table[i].letter == letter) {
            return &table[i];
        }
    }
    return NULL;
}

/* 0, ERR_UNKNOWN (said on errors) or what the option's action returns. */
static int execute(struct options *options, const char *argument,
                   const struct options_output *output, bool typed)
{
    const struct option *option = argument[1] == '\0' ? NULL : find_option(argument[1]);
    if (option == NULL || (option->use == USE_TYPED_OR_ALONE && !typed)) {
        text_append(output->errors, "Ignoring unknown option '%s'\n", argument);
        return ERR_UNKNOWN;
    }
    const struct action action = {options, argument + 2, output, typed};
    return option->act(&action);
}

/* --------------------------------------------------------------- command line */

void options_init(struct options *options)
{
    memset(options, 0, sizeof *options);
    options->port = DEFAULT_PORT;
    options->expected = 1;
    options->read_commands = true;
    options->terminal.messages = options->terminal.status = options->terminal.ignore = true;
    options->terminal.flush = true;
    options->file.ignore = options->file.flush = true;
    limits_init(&options->limits);
    full_policies_init(&options->when_full);
    list_init(&options->ignored);
}

void options_fini(struct options *options)
{
    struct list *at, *following;
    LIST_EACH(at, following, &options->ignored) {
        free(LIST_OWNER(at, struct ignored_name, in_options));
    }
    full_policies_fini(&options->when_full);
    free(options->file_name);
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static int read_expected(const char *argument)
{
    const long number = strtol(argument, NULL, 10);
    return number < 1 ? 1 : number > INT_MAX ? INT_MAX : (int)number;
}

/* Whether an argument asks only for a text, which then has been shown. */
static bool show_only(const char *argument, bool is_first, const char *program,
                      const struct options_output *output)
{
    if (strcmp(argument, "--version") == 0 || (is_first && strcmp(argument, "-v") == 0)) {
        options_show_version(output->errors);
        return true;
    }
    const bool long_form = strcmp(argument, "--help") == 0;
    if (long_form || (is_first && strcmp(argument, "-h") == 0)) {
        text_append(output->out, "%s command line options:\n", program);
        options_show_help(output->out, false);
        if (long_form) {
            limits_show_help(output->out);
            full_policies_show_help(output->out);
        }
        return true;
    }
    return false;
}

/* 0, or ERR_RANGE (said on errors). */
static int set_limit(struct options *options, const char *argument,
                     const struct options_output *output)
{
    switch (limits_set(&options->limits, argument + strlen(LIMIT_PREFIX))) {
    case 0:
        return 0;
    case ERR_UNKNOWN:
        text_append(output->errors, "No such limit %s (--help lists them)\n", argument);
        return ERR_RANGE;
    default:
        text_append(output->errors, "Illegal number in %s\n", argument);
        return ERR_RANGE;
    }
}

/* 0, or ERR_RANGE (said on errors). */
static int choose_when_full(struct options *options, const char *argument,
                            const struct options_output *output)
{
    if (full_policies_set(&options->when_full, argument + strlen(WHEN_FULL_PREFIX)) != 0) {
        text_append(output->errors, "No such policy in %s (--help lists them)\n", argument);
        return ERR_RANGE;
    }
    return 0;
}

/* 0, ERR_UNKNOWN (said on errors) or ERR_RANGE (said on errors). */
static int execute_argument(struct options *options, const char *argument,
                            const struct options_output *output)
{
    if (strncmp(argument, LIMIT_PREFIX, strlen(LIMIT_PREFIX)) == 0) {
        return set_limit(options, argument, output);
    }
    if (strncmp(argument, WHEN_FULL_PREFIX, strlen(WHEN_FULL_PREFIX)) == 0) {
        return choose_when_full(options, argument, output);
    }
    return argument[0] == '-' ? execute(options, argument, output, false) : 0;
}

enum options_result options_parse(struct options *options, int count, char *const *arguments,
                                  const struct options_output *output)
{
    for (int i = 1; i < count; i++) {
        if (show_only(arguments[i], i == 1, arguments[0], output)) {
            return OPTIONS_SHOWN;
        }
    }
    for (int i = 1; i < count; i++) {
        if (is_digit(arguments[i][0])) {
            options->expected = read_expected(arguments[i]);
            break;
        }
    }
    enum options_result result = OPTIONS_GO;
    for (int i = 1; i < count; i++) {
        if (execute_argument(options, arguments[i], output) == ERR_RANGE) {
            result = OPTIONS_WRONG;
        }
    }
    return result;
}

int options_type(struct options *options, const char *argument, const struct options_output *output)
{
    return execute(options, argument, output, true) == ERR_UNKNOWN ? ERR_UNKNOWN : 0;
}
