/*
 * The table of options, what each of them does, and the texts about them.
 */
#include "central/settings/options.h"

#include <errno.h>
#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "base/text.h"
#include "central/settings/version.h"
#include "platform/process.h"
#include "platform/rules.h"

#define DEFAULT_PORT 1381
#define DEFAULT_KEPT 5
#define MOST_KEPT 1000
#define LEAST_FILE 1024 /* so that a file holds more than its header */
#define HIGHEST_PORT 65535

#define LIMIT_PREFIX "--limit-"

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
    const char *value; /* behind the letter or the sign; "" if there is none */
    bool is_long;      /* spelled out: nothing is passed over in silence */
    bool typed;
    const struct options_output *output;
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

bool switches_want_file(const struct log_switches *on)
{
    return on->messages || on->status || on->data || on->time || on->summary;
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

static int switch_json(const struct action *action)
{
    switch_log(&action->options->json, action->value);
    return 0;
}

static int name_json(const struct action *action)
{
    free(action->options->json_name);
    action->options->json_name = mem_copy_string(action->value);
    if (!switches_want_file(&action->options->json)) {
        switch_log(&action->options->json, "msdi");
    }
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

/* Reads a whole number from lowest to highest: false, which is said, for anything else. */
static bool read_number(const struct action *action, const char *what, long lowest, long highest,
                        long *number)
{
    char *end;
    errno = 0;
    *number = strtol(action->value, &end, 10);
    if (end == action->value || *end != '\0' || errno != 0 || *number < lowest ||
        *number > highest) {
        text_append(action->output->errors, "Illegal %s %s\n", what, action->value);
        return false;
    }
    return true;
}

static int choose_file_size(const struct action *action)
{
    long bytes;
    if (!read_number(action, "size of a log file", LEAST_FILE, LONG_MAX, &bytes)) {
        return ERR_RANGE;
    }
    action->options->file_bytes = (uint64_t)bytes;
    return 0;
}

static int choose_kept_files(const struct action *action)
{
    long number;
    if (!read_number(action, "number of log files", 0, MOST_KEPT, &number)) {
        return ERR_RANGE;
    }
    action->options->kept_files = (int)number;
    return 0;
}

static int choose_port(const struct action *action)
{
    char *end;
    const long port = strtol(action->value, &end, 10);
    if (end == action->value && !action->is_long) {
        return 0;
    }
    if (port < 0 || port > HIGHEST_PORT || (*end != '\0' && action->is_long)) {
        text_append(action->output->errors, "Illegal port %s\n", action->value);
        return ERR_RANGE;
    }
    action->options->port = (int)port;
    return 0;
}

static int read_expected(const char *argument)
{
    const long number = strtol(argument, NULL, 10);
    return number < 1 ? 1 : number > INT_MAX ? INT_MAX : (int)number;
}

static int choose_expected(const struct action *action)
{
    long number;
    if (!read_number(action, "number of modules", 1, INT_MAX, &number)) {
        return ERR_RANGE;
    }
    action->options->expected = (int)number;
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

static int choose_prompts(const struct action *action)
{
    action->options->prompt = true;
    return 0;
}

static int choose_resending(const struct action *action)
{
    action->options->resend = true;
    return 0;
}

static int choose_when_full(const struct action *action)
{
    if (full_policies_set(&action->options->when_full, action->value) != 0) {
        text_append(action->output->errors, "No such policy: %s (--help lists them)\n",
                    action->value);
        return ERR_RANGE;
    }
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

/* Keeps a value as text. */
static int keep(char **place, const struct action *action)
{
    free(*place);
    *place = mem_copy_string(action->value);
    return 0;
}

/* Users are told apart on Unix sockets only, so TCP would be a way around them. */
static int check_ways(const struct action *action)
{
    const struct options *options = action->options;
    if (options->address != NULL && options->users != USERS_ALL) {
        text_append(action->output->errors,
                    "With --access there is only the Unix socket: --bind=%s cannot be\n",
                    options->address);
        return ERR_RANGE;
    }
    return 0;
}

static int choose_address(const struct action *action)
{
    struct options *options = action->options;
    options->local_only = strcmp(action->value, "local") == 0;
    if (!options->local_only) {
        (void)keep(&options->address, action); /* it cannot fail */
        return check_ways(action);
    }
    free(options->address);
    options->address = NULL;
    return 0;
}

#define GROUP_PREFIX "group="

static int choose_users(const struct action *action)
{
    struct options *options = action->options;
    const char *group = action->value + strlen(GROUP_PREFIX);
    if (strcmp(action->value, "all") == 0) {
        options->users = USERS_ALL;
    } else if (strcmp(action->value, "owner") == 0) {
        options->users = USERS_OWNER;
    } else if (strncmp(action->value, GROUP_PREFIX, strlen(GROUP_PREFIX)) == 0 &&
               process_find_group(group, &options->group) == 0) {
        options->users = USERS_GROUP;
    } else {
        text_append(action->output->errors, "No such users: %s\n", action->value);
        return ERR_RANGE;
    }
    return check_ways(action);
}

static int keep_rules(char **place, const struct action *action)
{
    if (!rules_are_known()) {
        text_append(action->output->errors,
                    "This central was built without libwrap: there are no rules of access\n");
        return ERR_RANGE;
    }
    return keep(place, action);
}

static int choose_allow_file(const struct action *action)
{
    return keep_rules(&action->options->allow_file, action);
}

static int choose_deny_file(const struct action *action)
{
    return keep_rules(&action->options->deny_file, action);
}

static int choose_pid_file(const struct action *action)
{
    return keep(&action->options->pid_file, action);
}

static int choose_port_file(const struct action *action)
{
    return keep(&action->options->port_file, action);
}

static int choose_metrics(const struct action *action)
{
    return keep(&action->options->metrics, action);
}

static int show_version(const struct action *action)
{
    options_show_version(action->is_long ? action->output->out : action->output->errors);
    return 0;
}

static void show_all_options(struct buffer *out);

static int show_help(const struct action *action)
{
    if (action->is_long) {
        show_all_options(action->output->out);
    } else {
        options_show_help(action->output->out, action->typed);
    }
    return 0;
}

/* -------------------------------------------------------------------- table */

enum option_use {
    USE_ANYWHERE,
    USE_AT_START,      /* not while the server runs */
    USE_TYPED_OR_ALONE /* the letter has to be the first argument of a command line */
};

/*
 * An option is a letter, with its value behind it, or a word: --word=value, or the
 * value as the next argument where the value has to be.  Words are what they
 * seem: where a letter passes over what it does not understand, a word says so.
 */
struct option {
    char letter;       /* '\0': none */
    const char *word;  /* NULL: none */
    const char *value; /* of the word: "" has none, "=<...>" has to be, "[=<...>]" may be */
    const char *old;   /* how the listing of -h and of typed help begins; NULL: not in it */
    enum option_use use;
    action_function act;
    const char *help; /* what the listings say, whole lines; NULL: not in them */
};

/* In the order of the listings.  The spelling of what -h lists is as old as the program: scripts
 * compare it. */
static const struct option table[] = {
    {'v', "version", "", "-v", USE_TYPED_OR_ALONE, show_version, "display server version info.\n"},
    {'h', "help", "", NULL, USE_TYPED_OR_ALONE, show_help, "list the options.\n"},
    {'l', "log", "[=<letters>]", "-l", USE_ANYWHERE, switch_terminal,
     "logging onto terminal.\n"
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
    {'L', "file-log", "[=<letters>]", "-L", USE_ANYWHERE, switch_file,
     "logging into file.\n"
     "     options are the same as above with the addition of F.\n"
     "                  F (don't flush file after each line)\n"
     "                  n (do not prompt the user for comments)\n"
     "     the default is -Lx\n"},
    {'f', "log-file", "=<file>", "-f", USE_ANYWHERE, name_file,
     "filename to use for logging.\n"
     "     If not specified, name is automatically generated.\n"},
    {'\0', "json-log", "[=<letters>]", NULL, USE_ANYWHERE, switch_json,
     "logging into a file for programs, one JSON object a line;\n"
     "     letters are those of -L, the default is x, and msdi with --json-file\n"},
    {'\0', "json-file", "=<file>", NULL, USE_ANYWHERE, name_json,
     "filename to use for logging JSON.\n"
     "     If not specified, name is automatically generated.\n"},
    {'\0', "log-size", "=<bytes>", NULL, USE_ANYWHERE, choose_file_size,
     "begin a new file, of either kind, when it has at least this size;\n"
     "     the old ones are called <file>.1, <file>.2 and so on - the default is: never\n"},
    {'\0', "log-keep", "=<number>", NULL, USE_ANYWHERE, choose_kept_files,
     "old log files that are kept - the default is: 5\n"},
    {'p', "port", "=<port>", "-p<port>", USE_AT_START, choose_port,
     "specify the server port - the default port is: 1381\n"},
    {'c', "direct", "", "-c", USE_ANYWHERE, choose_direct,
     "Use direct (not via central) conntections where possible.\n"},
    {'i', "ignore", "=<msgName>", "-i<msgName>", USE_ANYWHERE, ignore_message,
     "Ignore logging this message (can occur multiple times).\n"},
    {'I', "ignore-file", "=<fileName>", "-I<fileName>", USE_ANYWHERE, ignore_messages_of_file,
     "File with names of messages to ignore logging.\n"},
    {'s', "silent", "", "-s", USE_ANYWHERE, choose_silence,
     "silent running, don't print anything to stdout.\n"},
    {'S', NULL, "", NULL, USE_ANYWHERE, choose_silence, NULL},
    {'u', "no-console", "", "-u", USE_ANYWHERE, refuse_commands,
     "Don't run the user interface (stdin).\n"},
    {'\0', "prompt", "", NULL, USE_AT_START, choose_prompts,
     "ask for comments, and what to resend, even if stdin is no terminal\n"},
    {'r', "resend", "", "-r", USE_ANYWHERE, choose_resending,
     "try resending non-completed messages when modules crash\n"},
    {'d', NULL, "", NULL, USE_ANYWHERE, do_nothing, NULL},
    {'\0', "expected-modules", "=<number>", NULL, USE_AT_START, choose_expected,
     "modules that have to be there before any may begin;\n"
     "     an argument that begins with a digit says the same - the default is: 1\n"},
    {'\0', "bind", "=<address>", NULL, USE_AT_START, choose_address,
     "address of the TCP socket, a name or a number (IPv4, IPv6);\n"
     "     local: no TCP, only the Unix socket - the default is: all of IPv4\n"},
    {'\0', "access", "=<users>", NULL, USE_AT_START, choose_users,
     "whose programs may connect: all, owner (who runs this server) or\n"
     "     group=<name>; but for all there is only the Unix socket - the default is: all\n"},
    {'\0', "hosts-allow", "=<file>", NULL, USE_AT_START, choose_allow_file,
     "who may connect over TCP, by the service name central;\n"
     "     see hosts_access(5) - the default is: the system's hosts.allow\n"},
    {'\0', "hosts-deny", "=<file>", NULL, USE_AT_START, choose_deny_file,
     "who may not - the default is: the system's hosts.deny\n"},
    {'\0', "pid-file", "=<file>", NULL, USE_AT_START, choose_pid_file,
     "file that holds the number of the process while the server runs\n"},
    {'\0', "port-file", "=<file>", NULL, USE_AT_START, choose_port_file,
     "file that holds the port while the server runs\n"},
    {'\0', "metrics", "=<address>", NULL, USE_AT_START, choose_metrics,
     "show numbers to Prometheus at <port> (of this machine only),\n"
     "     <host>:<port> or the Unix socket </path>\n"},
    {'\0', "when-full", "=[<module>:]<policy>", NULL, USE_ANYWHERE, choose_when_full,
     "what becomes of a module's queue that is full.\n"
     "     policies are: wait (senders wait while the module works)\n"
     "                   newest (the newest messages are kept)\n"
     "                   oldest (the oldest messages are kept)\n"
     "                   disconnect (the module's connection ends)\n"
     "     the default is wait; for modules that connect from then on\n"},
};

enum { N_OPTIONS = sizeof table / sizeof table[0] };

void options_show_help(struct buffer *out, bool typed)
{
    for (size_t i = 0; i < N_OPTIONS; i++) {
        const struct option *option = &table[i];
        if (option->old != NULL && !(typed && option->use == USE_AT_START)) {
            text_append(out, " %s: %s", option->old, option->help);
        }
    }
}

/* The value behind a letter: as behind a word, but without the sign. */
static void show_value_of_letter(struct buffer *out, const char *value)
{
    for (; *value != '\0'; value++) {
        if (*value != '=') {
            text_append(out, "%c", *value);
        }
    }
}

/* The listing of --help: all options in all spellings. */
static void show_all_options(struct buffer *out)
{
    for (size_t i = 0; i < N_OPTIONS; i++) {
        const struct option *option = &table[i];
        if (option->help == NULL) {
            continue;
        }
        if (option->letter != '\0') {
            text_append(out, " -%c", option->letter);
            show_value_of_letter(out, option->value);
            text_append(out, ",");
        }
        text_append(out, " --%s%s: %s", option->word, option->value, option->help);
    }
    limits_show_help(out);
}

static const struct option *find_letter(char letter)
{
    for (size_t i = 0; i < N_OPTIONS && letter != '\0'; i++) {
        if (table[i].letter == letter) {
            return &table[i];
        }
    }
    return NULL;
}

static const struct option *find_word(const char *word, size_t length)
{
    for (size_t i = 0; i < N_OPTIONS; i++) {
        const char *candidate = table[i].word;
        if (candidate != NULL && strlen(candidate) == length &&
            memcmp(candidate, word, length) == 0) {
            return &table[i];
        }
    }
    return NULL;
}

static bool is_word(const char *argument)
{
    return argument[0] == '-' && argument[1] == '-' && argument[2] != '\0';
}

/* Carries an option out: 0 or what its action returns. */
static int act(const struct option *option, const struct action *action)
{
    if (action->typed && option->use == USE_AT_START) {
        text_append(action->output->out, "The %s cannot be changed while running\n", option->word);
        return 0;
    }
    return option->act(action);
}

static int execute_letter(struct action *action, const char *argument)
{
    const struct option *option = find_letter(argument[1]);
    if (option == NULL || (option->use == USE_TYPED_OR_ALONE && !action->typed)) {
        text_append(action->output->errors, "Ignoring unknown option '%s'\n", argument);
        return ERR_UNKNOWN;
    }
    action->value = argument + 2;
    return act(option, action);
}

static int set_limit(struct action *action, const char *argument)
{
    if (action->typed) {
        text_append(action->output->out, "The limits cannot be changed while running\n");
        return 0;
    }
    switch (limits_set(&action->options->limits, argument + strlen(LIMIT_PREFIX))) {
    case 0:
        return 0;
    case ERR_UNKNOWN:
        text_append(action->output->errors, "No such limit %s (--help lists them)\n", argument);
        return ERR_RANGE;
    default:
        text_append(action->output->errors, "Illegal number in %s\n", argument);
        return ERR_RANGE;
    }
}

/* *next: the argument behind this one, or NULL; it is set to NULL when it was taken as value.
 * next NULL: nothing can be taken. */
static int execute_word(struct action *action, const char *argument, const char **next)
{
    struct buffer *errors = action->output->errors;
    if (strncmp(argument, LIMIT_PREFIX, strlen(LIMIT_PREFIX)) == 0) {
        return set_limit(action, argument);
    }
    const char *word = argument + 2;
    const size_t length = strcspn(word, "=");
    const struct option *option = find_word(word, length);
    const bool has_value = word[length] == '=';
    if (option == NULL) {
        text_append(errors, "Unknown option %s (--help lists all)\n", argument);
        return ERR_RANGE;
    }
    if (has_value && option->value[0] == '\0') {
        text_append(errors, "The option --%s takes no value\n", option->word);
        return ERR_RANGE;
    }
    action->is_long = true;
    action->value = has_value ? word + length + 1 : "";
    if (option->value[0] == '=' && !has_value && next != NULL && *next != NULL) {
        action->value = *next;
        *next = NULL;
    }
    if (option->value[0] == '=' && action->value[0] == '\0') {
        text_append(errors, "The option --%s needs a value\n", option->word);
        return ERR_RANGE;
    }
    return act(option, action);
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
    options->kept_files = DEFAULT_KEPT;
    options->file.ignore = options->file.flush = true;
    options->json.ignore = options->json.flush = true;
    limits_init(&options->limits);
    full_policies_init(&options->when_full);
    list_init(&options->ignored);
}

void options_fini(struct options *options)
{
    struct list *at, *following;
    LIST_EACH (at, following, &options->ignored) {
        free(LIST_OWNER(at, struct ignored_name, in_options));
    }
    full_policies_fini(&options->when_full);
    free(options->file_name);
    free(options->address);
    free(options->allow_file);
    free(options->deny_file);
    free(options->pid_file);
    free(options->port_file);
    free(options->metrics);
    free(options->json_name);
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* The option of an argument that asks only for a text, or NULL. */
static const struct option *find_question(const char *argument, bool is_first)
{
    const struct option *option = NULL;
    if (is_word(argument)) {
        option = find_word(argument + 2, strlen(argument + 2));
    } else if (is_first && argument[0] == '-' && strlen(argument) == 2) {
        option = find_letter(argument[1]);
    }
    return option != NULL && option->use == USE_TYPED_OR_ALONE ? option : NULL;
}

/* Shows the text that the command line asks for, if it asks for one. */
static bool show_only(struct options *options, int count, char *const *arguments,
                      const struct options_output *output)
{
    for (int i = 1; i < count; i++) {
        const struct option *option = find_question(arguments[i], i == 1);
        if (option != NULL) {
            const struct action action = {options, "", is_word(arguments[i]), false, output};
            if (option->act == show_help) {
                text_append(output->out, "%s command line options:\n", arguments[0]);
            }
            return option->act(&action) == 0;
        }
    }
    return false;
}

/* next as for execute_word; 0, or ERR_UNKNOWN or ERR_RANGE (said on errors). */
static int execute(struct options *options, const char *argument, const char **next,
                   const struct options_output *output)
{
    struct action action = {options, "", false, next == NULL, output};
    return is_word(argument) ? execute_word(&action, argument, next)
                             : execute_letter(&action, argument);
}

enum options_result options_parse(struct options *options, int count, char *const *arguments,
                                  const struct options_output *output)
{
    if (show_only(options, count, arguments, output)) {
        return OPTIONS_SHOWN;
    }
    bool has_number = false;
    for (int i = 1; i < count; i++) {
        const char *argument = arguments[i];
        const char *next = i + 1 < count ? arguments[i + 1] : NULL;
        if (is_digit(argument[0]) && !has_number) {
            options->expected = read_expected(argument);
            has_number = true;
        } else if (argument[0] == '-') {
            const char *before = next;
            if (execute(options, argument, &next, output) == ERR_RANGE) {
                return OPTIONS_WRONG;
            }
            i += next != before; /* it was the value */
        }
    }
    return OPTIONS_GO;
}

int options_type(struct options *options, const char *argument, const struct options_output *output)
{
    return execute(options, argument, NULL, output);
}
