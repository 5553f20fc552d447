/*
 * Marks a function that takes a text and values as printf does: which parameter is the text, and
 * which the first value (0: they are in a va_list).  Compilers check its callers then.
 */
#ifndef IPC_BASE_PRINTF_H
#define IPC_BASE_PRINTF_H

#if defined(__MINGW32__) && !defined(__clang__)
#define LIKE_PRINTF(text, first) __attribute__((format(gnu_printf, text, first))) /* C99's */
#elif defined(__GNUC__)
#define LIKE_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define LIKE_PRINTF(text, first)
#endif

#endif
