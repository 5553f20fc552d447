/*
 * Pieces of text that somebody else owns.
 *
 * Every name, number and code section of a specification is a piece of the
 * input, which stays in memory as long as the tree does; so nothing is copied.
 */
#ifndef XDRGEN_TEXT_H
#define XDRGEN_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct text {
    const char *bytes; /* not terminated by a NUL */
    size_t length;
};

/* The text of a string, which must live as long as the result is used. */
struct text text_of(const char *string);

bool text_equal(struct text a, struct text b);

/* What follows the last slash. */
struct text text_base_name(struct text path);

/* The value of decimal digits behind an optional sign, kept within the range of int64_t. */
int64_t text_number(struct text digits);

#endif
