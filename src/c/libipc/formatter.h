/*
 * Formatters: formats in the user's hands.
 *
 * There is no call to free one, so each distinct format is kept once for the
 * life of the process and handed out as often as it is asked for.
 */
#ifndef IPC_LIBIPC_FORMATTER_H
#define IPC_LIBIPC_FORMATTER_H

#include "libipc/library.h"

static inline FORMATTER_PTR formatter_of(const struct format *format)
{
    return (FORMATTER_PTR)(const void *)format;
}

static inline const struct format *formatter_format(FORMATTER_PTR formatter)
{
    return (const struct format *)(const void *)formatter;
}

/* The one kept format that equals this; takes over the caller's reference. */
struct format *formatter_keep(struct library *library, struct format *format);

enum formatter_result {
    FORMATTER_OK,
    FORMATTER_ILLEGAL,     /* a syntax error */
    FORMATTER_UNKNOWN_NAME /* legal but for a named format that nobody knows */
};

/*
 * Parses a string, asking central for names that are not known here, and prints
 * the diagnosis.  *format is kept by the library; NULL for a string that is NULL or
 * empty (which is FORMATTER_OK) and on failure.
 */
enum formatter_result formatter_parse(struct library *library, const char *text,
                                      struct format **format);

/* Defines a named format in this process. */
int formatter_define(struct library *library, const char *name, const char *text);

/* The text as peers of the original's kind understand it; the caller frees it. */
char *formatter_portable(struct library *library, const char *text);

#endif
