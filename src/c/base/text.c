/*
 * Text into buffers, printf's way.
 */
#include "base/text.h"

enum { FIRST_GUESS = 120 };

void text_append_list(struct buffer *out, const char *format, va_list arguments)
{
    va_list again;
    va_copy(again, arguments);
    if (buffer_reserve(out, FIRST_GUESS) == 0) {
        const size_t room = out->capacity - out->length;
        const int length = vsnprintf((char *)out->bytes + out->length, room, format, arguments);
        if (length >= 0 && (size_t)length < room) {
            out->length += (size_t)length;
        } else if (length >= 0 && buffer_reserve(out, (size_t)length + 1) == 0) {
            (void)vsnprintf((char *)out->bytes + out->length, (size_t)length + 1, format, again);
            out->length += (size_t)length;
        }
    }
    va_end(again);
}

void text_append(struct buffer *out, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    text_append_list(out, format, arguments);
    va_end(arguments);
}

void text_print(FILE *stream, const struct buffer *text)
{
    if (text->length > 0) {
        (void)fwrite(text->bytes, 1, text->length, stream); /* nobody can be told of a failure */
        (void)fflush(stream);
    }
}
