/*
 * Format strings as an original peer understands them.
 */
#include <string.h>

#include "base/memory.h"
#include "format/names.h"
#include "format/token.h"

char *format_portable_text(const char *text, const struct format_names *names)
{
    char *portable = mem_copy_string(text);
    const bool own_uchar = names != NULL && format_names_holds(names, "uchar");
    bool in_names = false; /* of an enumeration, where uchar stands for nothing */
    struct token before = {.kind = TOKEN_END};
    struct token token = token_read(text, 0);
    while (token.kind != TOKEN_END) {
        if (token_is_mark(&token, '}')) {
            in_names = false;
        } else if (token_is_name(&token, text, "enum") && token_is_mark(&before, '{')) {
            in_names = true;
        } else if (!in_names && !own_uchar && token_is_name(&token, text, "uchar")) {
            memcpy(portable + token.position, "ubyte", 5);
        } else if (token_is_mark(&token, '*') && token_is_mark(&before, '!')) {
            portable[before.position] = '*';
            portable[token.position] = '!';
        }
        before = token;
        token = token_read(text, token.position + token.length);
    }
    return portable;
}
