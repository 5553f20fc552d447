/*
 * What the scanner knows besides its tables: where it is, and whom it tells.
 */
#ifndef XDRGEN_SCAN_H
#define XDRGEN_SCAN_H

#include <stddef.h>

#include "diagnostics.h"
#include "source.h"

struct scan {
    struct source *source;
    struct diagnostics *diagnostics;
    struct place here;  /* behind what has been read */
    struct place start; /* of the comment or code section that is being read */
};

void scan_init(struct scan *scan, struct source *source, struct diagnostics *diagnostics);

/* Moves behind length bytes, which hold no newline, or are one. */
void scan_advance(struct scan *scan, size_t length);
void scan_newline(struct scan *scan);

/* Follows a line marker of a preprocessor, whose form is right. */
void scan_follow_marker(struct scan *scan, const struct place *place, const char *bytes,
                        size_t length);

/* Reports a line that begins with # or %, as preprocessors read them. */
void scan_report_line(struct scan *scan, const struct place *place, const char *bytes);

/* The text of the code section whose end has just been read. */
struct text scan_code_text(const struct scan *scan);

/* Reports what the input has ended in; the token that stands for its end. */
int scan_unterminated(struct scan *scan, struct place *place, const char *what);

/* Reports a byte that begins no token. */
void scan_report_byte(struct scan *scan, const struct place *place, unsigned char byte);

/* Reports what is wrong within a string, given with its quotes. */
void scan_check_string(struct scan *scan, const struct place *place, struct text string);

/* A string without quotes and escapes, of which scan_check_string had nothing to say; the caller
 * frees it. */
char *scan_string_value(struct text string);

#endif
