/*
 * What the options of the command line do, one function for each, or for several alike.
 */
#ifndef IPC_CENTRAL_ACTIONS_H
#define IPC_CENTRAL_ACTIONS_H

#include "central/settings/options.h"

/* Where options write what they have to say: standard output, standard error. */
struct options_output {
    struct buffer *out;
    struct buffer *errors;
};

struct action {
    struct options *options;
    const char *value; /* behind the letter or the sign; "" if there is none */
    bool is_long;      /* spelled out: nothing is passed over in silence */
    bool typed;
    size_t place; /* of the member of the options that the generic actions set */
    const struct options_output *output;
};

/* 0, or ERR_RANGE for a value that cannot be (said on errors). */
typedef int (*action_function)(const struct action *action);

/* Set or clear a bool, or set a char * (owned) to a copy of the value, at the action's place. */
int action_set_flag(const struct action *action);
int action_clear_flag(const struct action *action);
int action_keep_text(const struct action *action);

/* The same for a file with rules of access, if those are known here. */
int action_keep_rules(const struct action *action);

int action_switch_terminal(const struct action *action);
int action_switch_file(const struct action *action);
int action_switch_json(const struct action *action);
int action_name_file(const struct action *action);
int action_name_json(const struct action *action);
int action_choose_file_size(const struct action *action);
int action_choose_kept_files(const struct action *action);
int action_choose_port(const struct action *action);
int action_choose_expected(const struct action *action);
int action_choose_when_full(const struct action *action);
int action_ignore_message(const struct action *action);
int action_ignore_messages_of_file(const struct action *action);
int action_choose_address(const struct action *action); /* place: of the address */
int action_choose_users(const struct action *action);

#endif
