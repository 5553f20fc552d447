/*
 * What the options of the command line do.
 */
#include "central/settings/actions.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "base/text.h"
#include "platform/process.h"
#include "platform/rules.h"

#define MOST_KEPT 1000
#define LEAST_FILE 1024 /* so that a file holds more than its header */
#define HIGHEST_PORT 65535

/* ------------------------------------------------------------------ any member */

static void *place_of(const struct action *action)
{
    return (char *)action->options + action->place;
}

int action_set_flag(const struct action *action)
{
    *(bool *)place_of(action) = true;
    return 0;
}

int action_clear_flag(const struct action *action)
{
    *(bool *)place_of(action) = false;
    return 0;
}

int action_keep_text(const struct action *action)
{
    char **place = place_of(action);
    free(*place);
    *place = mem_copy_string(action->value);
    return 0;
}

/* ------------------------------------------------------------------------ logs */

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

int action_switch_terminal(const struct action *action)
{
    switch_log(&action->options->terminal, action->value);
    if (action->typed) {
        action->options->silent = false;
    }
    return 0;
}

int action_switch_file(const struct action *action)
{
    switch_log(&action->options->file, action->value);
    return 0;
}

int action_switch_json(const struct action *action)
{
    switch_log(&action->options->json, action->value);
    return 0;
}

int action_name_json(const struct action *action)
{
    free(action->options->json_name);
    action->options->json_name = mem_copy_string(action->value);
    if (!switches_want_file(&action->options->json)) {
        switch_log(&action->options->json, "msdi");
    }
    return 0;
}

int action_name_file(const struct action *action)
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

int action_choose_file_size(const struct action *action)
{
    long bytes;
    if (!read_number(action, "size of a log file", LEAST_FILE, LONG_MAX, &bytes)) {
        return ERR_RANGE;
    }
    action->options->file_bytes = (uint64_t)bytes;
    return 0;
}

int action_choose_kept_files(const struct action *action)
{
    long number;
    if (!read_number(action, "number of log files", 0, MOST_KEPT, &number)) {
        return ERR_RANGE;
    }
    action->options->kept_files = (int)number;
    return 0;
}

int action_choose_port(const struct action *action)
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

int action_choose_expected(const struct action *action)
{
    long number;
    if (!read_number(action, "number of modules", 1, INT_MAX, &number)) {
        return ERR_RANGE;
    }
    action->options->expected = (int)number;
    return 0;
}

int action_choose_when_full(const struct action *action)
{
    if (full_policies_set(&action->options->when_full, action->value) != 0) {
        text_append(action->output->errors, "No such policy: %s (--help lists them)\n",
                    action->value);
        return ERR_RANGE;
    }
    return 0;
}

static void ignore_name(struct options *options, const char *name, size_t length)
{
    struct ignored_name *ignored = mem_new(sizeof *ignored + length + 1);
    memcpy(ignored->name, name, length);
    list_append(&options->ignored, &ignored->in_options);
}

int action_ignore_message(const struct action *action)
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

int action_ignore_messages_of_file(const struct action *action)
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

int action_choose_address(const struct action *action)
{
    struct options *options = action->options;
    options->local_only = strcmp(action->value, "local") == 0;
    if (!options->local_only) {
        (void)action_keep_text(action); /* it cannot fail */
        return check_ways(action);
    }
    free(options->address);
    options->address = NULL;
    return 0;
}

#define GROUP_PREFIX "group="

int action_choose_users(const struct action *action)
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

int action_keep_rules(const struct action *action)
{
    if (!rules_are_known()) {
        text_append(action->output->errors,
                    "This central was built without libwrap: there are no rules of access\n");
        return ERR_RANGE;
    }
    return action_keep_text(action);
}
