/*
 * Commands typed while the server runs.
 *
 * One table holds the commands.  A line is a command, in full or shortened as
 * far as it stays unique, or it begins with an option.  Bytes come in any
 * pieces; what they are read from is none of this file's business.
 */
#ifndef IPC_CENTRAL_CONSOLE_H
#define IPC_CENTRAL_CONSOLE_H

#include "central/operator/comments.h"
#include "central/routing/server.h"

/* What follows when the comments that were asked for have been typed. */
enum console_next { CONSOLE_GO_ON, CONSOLE_CLOSE_FILE, CONSOLE_QUIT };

struct console {
    struct server *server;
    struct buffer line; /* what has come of the next line */
    bool line_is_too_long;
    bool may_ask; /* somebody is there to answer */
    struct comments comments;
    enum console_next next;
    bool wants_to_quit;
};

void console_init(struct console *console, struct server *server);
void console_fini(struct console *console);

/* Writes the prompt, where there is to be one. */
void console_prompt(struct console *console);

/* Opens the log file, 0 or an error that has been said, and asks for comments where they are wanted.
 */
int console_open_log(struct console *console);

/* Whether typed lines are of any use. */
bool console_listens(const struct console *console);

/* No more lines will come. */
void console_end_input(struct console *console);

/* Takes bytes and executes the lines that are complete. */
void console_feed(struct console *console, const char *bytes, size_t count);

#endif
