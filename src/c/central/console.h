/*
 * Commands typed while the server runs.
 *
 * One table holds the commands.  A line is a command, in full or shortened as
 * far as it stays unique, or it begins with an option.  Bytes come in any
 * pieces; what they are read from is none of this file's business.
 */
#ifndef IPC_CENTRAL_CONSOLE_H
#define IPC_CENTRAL_CONSOLE_H

#include "central/server.h"

struct console {
    struct server *server;
    struct buffer line; /* what has come of the next line */
    bool line_is_too_long;
    bool wants_to_quit;
};

void console_init(struct console *console, struct server *server);
void console_fini(struct console *console);

/* Writes the prompt, where there is to be one. */
void console_prompt(struct console *console);

/* Takes bytes and executes the lines that are complete. */
void console_feed(struct console *console, const char *bytes, size_t count);

#endif
