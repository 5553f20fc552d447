/*
 * Comments in the log file.
 */
#include "central/operator/comments.h"

#include <string.h>

enum { WIDTH = 76, LIMIT_COMMENTS = 1024 * 1024 };

#define TEN_STARS "**********"
#define EDGE TEN_STARS TEN_STARS TEN_STARS TEN_STARS TEN_STARS TEN_STARS TEN_STARS TEN_STARS "\n"
#define EMPTY_LINE "*%78s*\n"

void comments_init(struct comments *comments)
{
    comments->asking = false;
    buffer_init(&comments->lines);
}

void comments_fini(struct comments *comments)
{
    buffer_fini(&comments->lines);
}

void comments_ask(struct comments *comments, struct log *log)
{
    comments->asking = true;
    log_terminal(log, "Enter any comments in the log file (end with blank line)\n");
}

void comments_take(struct comments *comments, struct log *log, const char *line)
{
    if (line[0] == '\0') {
        comments_end(comments, log);
        return;
    }
    for (size_t left = strlen(line); left > 0 && comments->lines.length < LIMIT_COMMENTS;) {
        const size_t length = left < WIDTH ? left : WIDTH;
        text_append(&comments->lines, "* %-77.*s*\n", (int)length, line);
        line += length;
        left -= length;
    }
}

void comments_end(struct comments *comments, struct log *log)
{
    comments->asking = false;
    if (comments->lines.length > 0) {
        log_file(log, "\n" EDGE "*%35sComments%35s*\n" EMPTY_LINE "%.*s" EMPTY_LINE EDGE "\n", "",
                 "", "", (int)comments->lines.length, (const char *)comments->lines.bytes, "");
        buffer_clear(&comments->lines);
    }
}
