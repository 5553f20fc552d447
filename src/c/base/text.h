/*
 * Text into buffers, printf's way.
 */
#ifndef IPC_BASE_TEXT_H
#define IPC_BASE_TEXT_H

#include <stdarg.h>
#include <stdio.h>

#include "base/buffer.h"
#include "base/printf.h"

/* Appends formatted text; when memory is out, or the format fails, nothing is appended. */
void text_append(struct buffer *out, const char *format, ...) LIKE_PRINTF(2, 3);
void text_append_list(struct buffer *out, const char *format, va_list arguments) LIKE_PRINTF(2, 0);

/* Writes a buffer to a stream, and out of it. */
void text_print(FILE *stream, const struct buffer *text);

#endif
