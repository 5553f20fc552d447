/*
 * The tokens of a format string.
 *
 * There are no lexical errors: whatever is neither white space nor punctuation
 * nor a number is a name.  White space is space, tab and form feed only; inside
 * a name only a space ends it.
 */
#ifndef IPC_FORMAT_TOKEN_H
#define IPC_FORMAT_TOKEN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum token_kind { TOKEN_END, TOKEN_MARK, TOKEN_INTEGER, TOKEN_NAME };

struct token {
    enum token_kind kind;
    char mark; /* one of { } [ ] < > , : * ! */
    size_t position;
    size_t length;
    int64_t value; /* of an integer; INT64_MAX when it is above INT32_MAX */
};

/* The first token of text at or behind position. */
struct token token_read(const char *text, size_t position);

bool token_is_mark(const struct token *token, char mark);
bool token_is_name(const struct token *token, const char *text, const char *name);

#endif
