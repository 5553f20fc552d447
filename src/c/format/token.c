/*
 * The tokens of a format string.
 */
#include "format/token.h"

#include <string.h>

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static int64_t value_of(const char *digits, size_t length)
{
    int64_t value = 0;
    for (size_t i = 0; i < length; i++) {
        value = value * 10 + (digits[i] - '0');
        if (value > INT32_MAX) {
            return INT64_MAX;
        }
    }
    return value;
}

struct token token_read(const char *text, size_t position)
{
    position += strspn(text + position, " \t\f");
    const char *at = text + position;
    struct token token = {.kind = TOKEN_NAME, .position = position};
    if (*at == '\0') {
        token.kind = TOKEN_END;
    } else if (strchr("{}[]<>,:*!", *at) != NULL) {
        token.kind = TOKEN_MARK;
        token.mark = *at;
        token.length = 1;
    } else if (is_digit(*at)) {
        token.kind = TOKEN_INTEGER;
        token.length = strspn(at, "0123456789");
        token.value = value_of(at, token.length);
    } else {
        token.length = 1 + strcspn(at + 1, ",}{[]:>< ");
    }
    return token;
}

bool token_is_mark(const struct token *token, char mark)
{
    return token->kind == TOKEN_MARK && token->mark == mark;
}

bool token_is_name(const struct token *token, const char *text, const char *name)
{
    return token->kind == TOKEN_NAME && token->length == strlen(name) &&
           memcmp(text + token->position, name, token->length) == 0;
}
