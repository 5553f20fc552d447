/*
 * An input in memory, and the files that its line markers name.
 *
 * Files are numbered; number 0 is the input itself.
 */
#ifndef XDRGEN_SOURCE_H
#define XDRGEN_SOURCE_H

#include "place.h"
#include "text.h"

/* A file that text comes from, and the line that included it. */
struct origin {
    char *name;
    size_t includer; /* its number; SOURCE_NOBODY: included by nobody */
    size_t includer_line;
};

#define SOURCE_NOBODY ((size_t) - 1)

struct source {
    char *bytes;   /* two NULs behind them, which the scanner needs */
    size_t length; /* without the two NULs */
    struct origin *origins;
    size_t n_origins;
};

/* Takes over bytes, a malloc block with two NULs behind length bytes.  name is copied. */
void source_init(struct source *source, const char *name, char *bytes, size_t length);
void source_fini(struct source *source);

/* Adds a file, whose name is taken over, and gives its number. */
size_t source_add_origin(struct source *source, char *name, size_t includer, size_t includer_line);

/* The file that a place is in. */
const struct origin *source_origin(const struct source *source, const struct place *place);

/* The whole line of the input around a place, without its end. */
struct text source_line(const struct source *source, const struct place *place);

#endif
