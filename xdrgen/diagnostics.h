/*
 * Errors, warnings and notes about a specification.
 *
 * They are collected, and printed in the order of the places they are about.
 * What the xdrgen of CMU IPC reports is printed in its words first
 * ("FILE:LINE: ..."), since programs read them; the second line has the form
 * of today's compilers ("FILE:LINE:COLUMN: error: ..."), and below it the line
 * of the input with a mark.
 */
#ifndef XDRGEN_DIAGNOSTICS_H
#define XDRGEN_DIAGNOSTICS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "place.h"
#include "source.h"

enum severity { SEVERITY_ERROR, SEVERITY_WARNING, SEVERITY_NOTE };

struct diagnostic {
    enum severity severity;
    struct place place;
    size_t width;  /* bytes of the input that the mark covers */
    size_t number; /* order of collection; a note belongs to what it follows */
    size_t anchor; /* offset by which it is sorted: for a note, that of its error */
    char *classic; /* what CMU IPC prints behind FILE:LINE:, or NULL */
    char *message;
};

struct diagnostics {
    struct diagnostic *items;
    size_t count;
    size_t n_errors;
};

void diagnostics_init(struct diagnostics *diagnostics);
void diagnostics_fini(struct diagnostics *diagnostics);

/* Each takes a format as printf does. */
void diagnostics_error(struct diagnostics *diagnostics, const struct place *place, size_t width,
                       const char *format, ...);
void diagnostics_warning(struct diagnostics *diagnostics, const struct place *place, size_t width,
                         const char *format, ...);

/* A further remark about the latest error or warning. */
void diagnostics_note(struct diagnostics *diagnostics, const struct place *place, size_t width,
                      const char *format, ...);

/* Sets what CMU IPC prints for the latest error or warning. */
void diagnostics_classic(struct diagnostics *diagnostics, const char *format, ...);

/* The latest error or warning is one that CMU IPC words in the same way. */
void diagnostics_same_as_classic(struct diagnostics *diagnostics);

/* Prints all in the order of their places. */
void diagnostics_print(struct diagnostics *diagnostics, const struct source *source, FILE *stream);

#endif
