/*
 * The server's options: what can be chosen.
 */
#ifndef IPC_CENTRAL_OPTIONS_H
#define IPC_CENTRAL_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/buffer.h"
#include "base/list.h"
#include "central/settings/limits.h"
#include "central/settings/when_full.h"

/* What one of the logs shows. */
struct log_switches {
    bool messages;
    bool status;
    bool time;
    bool data;
    bool ignore; /* leave out the messages of the ignore set */
    bool summary;
    bool references;
    bool parents;
    bool flush;    /* after every line */
    bool comments; /* ask for comments when the file is opened and closed */
};

/* A name given with -i or read from a file of -I. */
struct ignored_name {
    struct list in_options;
    char name[];
};

/* Whose programs may connect: any but the first leave only the Unix socket, which tells users. */
enum allowed_users { USERS_ALL, USERS_OWNER, USERS_GROUP };

struct options {
    int port;     /* 0: any free one */
    int expected; /* modules that have to ask before the first one is let go */
    bool direct;
    bool silent;
    bool read_commands;
    bool prompt; /* ask even where standard input is no terminal */
    bool resend;
    struct log_switches terminal;
    struct log_switches file;
    struct log_switches json;
    char *file_name;     /* owned; NULL: generated */
    char *json_name;     /* owned; NULL: generated */
    uint64_t file_bytes; /* of the log file, where a new one begins; 0: never */
    int kept_files;      /* older ones that stay */
    struct list ignored; /* of struct ignored_name, in the order given */
    struct central_limits limits;
    struct full_policies when_full;

    /* Who may connect, and how; all texts are owned. */
    char *address;   /* of the TCP socket; NULL: all */
    bool local_only; /* there is no TCP socket */
    enum allowed_users users;
    int64_t group;    /* with USERS_GROUP */
    char *allow_file; /* instead of the system's hosts.allow; NULL: that */
    char *deny_file;

    /* What scripts and operators see; NULL: none. */
    char *pid_file;
    char *port_file;
    char *metrics; /* address that numbers are shown at */
};

/* Whether they are of any use only with a file. */
bool switches_want_file(const struct log_switches *on);

void options_init(struct options *options);
void options_fini(struct options *options);

#endif
