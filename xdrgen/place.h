/*
 * Places in the input.
 *
 * A place is known twice: physically, as an offset into the input, and
 * logically, as file and line, which line markers of a preprocessor change.
 */
#ifndef XDRGEN_PLACE_H
#define XDRGEN_PLACE_H

#include <stddef.h>

/* Four numbers, as the generated parser expects of what it initialises. */
struct place {
    size_t line;   /* in the origin; the first is 1 */
    size_t column; /* in bytes; the first is 1 */
    size_t offset; /* in the input */
    size_t origin; /* the number of the file; see source.h */
};

#endif
