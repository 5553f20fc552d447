/*
 * Comments in the log file: asked for when it is opened and closed, typed
 * line by line up to an empty one, and written as a box.  Nothing waits for
 * them; lines of the log that come meanwhile stand in front of the box.
 */
#ifndef IPC_CENTRAL_COMMENTS_H
#define IPC_CENTRAL_COMMENTS_H

#include "central/log/log.h"

struct comments {
    bool asking;
    struct buffer lines; /* of the box, as far as they have been typed */
};

void comments_init(struct comments *comments);
void comments_fini(struct comments *comments);

/* Asks on the terminal. */
void comments_ask(struct comments *comments, struct log *log);

/* Takes a line; the empty one ends the comments. */
void comments_take(struct comments *comments, struct log *log, const char *line);

/* Writes what there is. */
void comments_end(struct comments *comments, struct log *log);

#endif
