/*
 * The table of options, the texts about them, and reading a command line.
 */
#include "central/settings/command_line.h"

#include <limits.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "base/text.h"
#include "central/settings/actions.h"
#include "central/settings/version.h"

#define LIMIT_PREFIX "--limit-"

/* -------------------------------------------------------------------- texts */

void options_show_version(struct buffer *out)
{
    text_append(out, SERVER_TITLE " \n Released : " IPC_RELEASE_DATE
                                  "\n Commited : $Date: " IPC_BUILD_TIME
                                  " $\n Compiled : " IPC_BUILD_TIME "\n");
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

static int do_nothing(const struct action *action)
{
    (void)action;
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
    size_t place;     /* for the action: AT a member of the options, or NOWHERE */
    const char *help; /* what the listings say, whole lines; NULL: not in them */
};

#define AT(member) offsetof(struct options, member)
#define NOWHERE 0

/* In the order of the listings.  The spelling of what -h lists is as old as the program: scripts
 * compare it. */
static const struct option table[] = {
    {'v', "version", "", "-v", USE_TYPED_OR_ALONE, show_version, NOWHERE,
     "display server version info.\n"},
    {'h', "help", "", NULL, USE_TYPED_OR_ALONE, show_help, NOWHERE, "list the options.\n"},
    {'l', "log", "[=<letters>]", "-l", USE_ANYWHERE, action_switch_terminal, NOWHERE,
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
    {'L', "file-log", "[=<letters>]", "-L", USE_ANYWHERE, action_switch_file, NOWHERE,
     "logging into file.\n"
     "     options are the same as above with the addition of F.\n"
     "                  F (don't flush file after each line)\n"
     "                  n (do not prompt the user for comments)\n"
     "     the default is -Lx\n"},
    {'f', "log-file", "=<file>", "-f", USE_ANYWHERE, action_name_file, NOWHERE,
     "filename to use for logging.\n"
     "     If not specified, name is automatically generated.\n"},
    {'\0', "json-log", "[=<letters>]", NULL, USE_ANYWHERE, action_switch_json, NOWHERE,
     "logging into a file for programs, one JSON object a line;\n"
     "     letters are those of -L, the default is x, and msdi with --json-file\n"},
    {'\0', "json-file", "=<file>", NULL, USE_ANYWHERE, action_name_json, NOWHERE,
     "filename to use for logging JSON.\n"
     "     If not specified, name is automatically generated.\n"},
    {'\0', "log-size", "=<bytes>", NULL, USE_ANYWHERE, action_choose_file_size, NOWHERE,
     "begin a new file, of either kind, when it has at least this size;\n"
     "     the old ones are called <file>.1, <file>.2 and so on - the default is: never\n"},
    {'\0', "log-keep", "=<number>", NULL, USE_ANYWHERE, action_choose_kept_files, NOWHERE,
     "old log files that are kept - the default is: 5\n"},
    {'p', "port", "=<port>", "-p<port>", USE_AT_START, action_choose_port, NOWHERE,
     "specify the server port - the default port is: 1381\n"},
    {'c', "direct", "", "-c", USE_ANYWHERE, action_set_flag, AT(direct),
     "Use direct (not via central) conntections where possible.\n"},
    {'i', "ignore", "=<msgName>", "-i<msgName>", USE_ANYWHERE, action_ignore_message, NOWHERE,
     "Ignore logging this message (can occur multiple times).\n"},
    {'I', "ignore-file", "=<fileName>", "-I<fileName>", USE_ANYWHERE,
     action_ignore_messages_of_file, NOWHERE, "File with names of messages to ignore logging.\n"},
    {'s', "silent", "", "-s", USE_ANYWHERE, action_set_flag, AT(silent),
     "silent running, don't print anything to stdout.\n"},
    {'S', NULL, "", NULL, USE_ANYWHERE, action_set_flag, AT(silent), NULL},
    {'u', "no-console", "", "-u", USE_ANYWHERE, action_clear_flag, AT(read_commands),
     "Don't run the user interface (stdin).\n"},
    {'\0', "prompt", "", NULL, USE_AT_START, action_set_flag, AT(prompt),
     "ask for comments, and what to resend, even if stdin is no terminal\n"},
    {'r', "resend", "", "-r", USE_ANYWHERE, action_set_flag, AT(resend),
     "try resending non-completed messages when modules crash\n"},
    {'d', NULL, "", NULL, USE_ANYWHERE, do_nothing, NOWHERE, NULL},
    {'\0', "expected-modules", "=<number>", NULL, USE_AT_START, action_choose_expected, NOWHERE,
     "modules that have to be there before any may begin;\n"
     "     an argument that begins with a digit says the same - the default is: 1\n"},
    {'\0', "bind", "=<address>", NULL, USE_AT_START, action_choose_address, AT(address),
     "address of the TCP socket, a name or a number (IPv4, IPv6);\n"
     "     local: no TCP, only the Unix socket - the default is: all of IPv4\n"},
    {'\0', "access", "=<users>", NULL, USE_AT_START, action_choose_users, NOWHERE,
     "whose programs may connect: all, owner (who runs this server) or\n"
     "     group=<name>; but for all there is only the Unix socket - the default is: all\n"},
    {'\0', "hosts-allow", "=<file>", NULL, USE_AT_START, action_keep_rules, AT(allow_file),
     "who may connect over TCP, by the service name central;\n"
     "     see hosts_access(5) - the default is: the system's hosts.allow\n"},
    {'\0', "hosts-deny", "=<file>", NULL, USE_AT_START, action_keep_rules, AT(deny_file),
     "who may not - the default is: the system's hosts.deny\n"},
    {'\0', "pid-file", "=<file>", NULL, USE_AT_START, action_keep_text, AT(pid_file),
     "file that holds the number of the process while the server runs\n"},
    {'\0', "port-file", "=<file>", NULL, USE_AT_START, action_keep_text, AT(port_file),
     "file that holds the port while the server runs\n"},
    {'\0', "metrics", "=<address>", NULL, USE_AT_START, action_keep_text, AT(metrics),
     "show numbers to Prometheus at <port> (of this machine only),\n"
     "     <host>:<port> or the Unix socket </path>\n"},
    {'\0', "when-full", "=[<module>:]<policy>", NULL, USE_ANYWHERE, action_choose_when_full,
     NOWHERE,
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
static int act(const struct option *option, struct action *action)
{
    if (action->typed && option->use == USE_AT_START) {
        text_append(action->output->out, "The %s cannot be changed while running\n", option->word);
        return 0;
    }
    action->place = option->place;
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

static int read_expected(const char *argument)
{
    const long number = strtol(argument, NULL, 10);
    return number < 1 ? 1 : number > INT_MAX ? INT_MAX : (int)number;
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
            const struct action action = {options, "",      is_word(arguments[i]),
                                          false,   NOWHERE, output};
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
    struct action action = {options, "", false, next == NULL, NOWHERE, output};
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
