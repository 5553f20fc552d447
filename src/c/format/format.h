/*
 * Formats: the description of a C value and what can be done with it.
 *
 * A format is parsed once from its string into an immutable type tree, laid out
 * for this host and compiled into flat programs; every other function here runs
 * over the result.  NULL stands for "no format" wherever a format may be absent.
 *
 * A format never changes after it is made, so any thread may use one without a
 * lock.  Its reference count is not atomic: taking and giving references belongs
 * to the owner's lock.
 */
#ifndef IPC_FORMAT_FORMAT_H
#define IPC_FORMAT_FORMAT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "base/buffer.h"
#include "base/byteorder.h"

struct format;
struct format_names;

/* What a parser has to say about a string. */
struct format_diagnosis {
    char *text; /* whole lines to print, newline-ended; NULL: nothing to say; the caller frees it */
    size_t position; /* 0-based offset of the offending token in the string it stands in */
};

/*
 * Parses text into a format.  names resolves named formats and may be NULL.
 * Returns 0 and a reference that the caller gives back with format_unref (also
 * when it accepts with a warning), or ERR_FORMAT, or ERR_UNKNOWN when it needs a
 * named format that nobody knows.  diagnosis may be NULL; otherwise it is always
 * set.  The text of an unknown name is NULL when whoever was asked answered with
 * the bad format, because central reports that itself.
 */
int format_parse(const char *text, const struct format_names *names, struct format **format,
                 struct format_diagnosis *diagnosis);

/* The format that stands for an illegal one: travels as kind 6, fits no value.  Never freed. */
struct format *format_bad(void);
bool format_is_bad(const struct format *format);

struct format *format_ref(struct format *format);

/* Gives one reference back; NULL is fine. */
void format_unref(struct format *format);

/* C sizeof and alignment of the value; 0 and 1 for NULL. */
size_t format_size(const struct format *format);
size_t format_alignment(const struct format *format);

/* Whether the value holds no pointer of any kind. */
bool format_is_flat(const struct format *format);

/* Whether memory image and wire image are identical, so that a copy encodes and decodes. */
bool format_is_simple(const struct format *format);

/* Node-by-node equality of the expanded formats; NULL equals NULL only. */
bool format_equal(const struct format *a, const struct format *b);

/* The first part, in reading order, in which two formats differ. */
struct format_difference {
    char *part;   /* numbers of members from 1 on, outermost first: "2.1"; empty: all of it */
    char *first;  /* that part's canonical text in the one format, "nothing" where it ends before */
    char *second; /* ... and in the other */
};

/* Finds it: false when the formats are equal, and then nothing is set.  NULL is no format; neither
 * may be the bad one. */
bool format_difference(const struct format *a, const struct format *b,
                       struct format_difference *difference);

/* Frees its texts. */
void format_difference_fini(struct format_difference *difference);

/* The canonical text on one line; the caller frees it.  "NULLFormat" for NULL. */
char *format_canonical(const struct format *format);

/*
 * The text as an original peer understands it: uchar becomes ubyte unless names
 * defines it, and !* becomes *!.  The caller frees the result.
 */
char *format_portable_text(const char *text, const struct format_names *names);

/* ------------------------------------------------------------------ values */

/* Exact number of wire bytes of a value: 0 or ERR_NULL, ERR_RANGE, ERR_LIMIT, ERR_DEPTH,
 * ERR_FORMAT. */
int format_measure(const struct format *format, const void *value, size_t *length);

/* Appends the wire image of a value: 0 or as format_measure, or ERR_MEMORY; out is as before on
 * failure. */
int format_encode(const struct format *format, const void *value, enum byte_order order,
                  struct buffer *out);

/* The value of the primitive X_IPC_REF_PTR: a malloc block, as is its name (NULL if empty). */
struct format_reference {
    int number;
    char *name;
};

/*
 * Whether an empty string decodes as "" (true) or, as old programs test for it,
 * as NULL (false, the state at start).  For the whole process; to be set before
 * the first decoding and not while another thread decodes.
 */
void format_set_empty_strings(bool keep);

/* Bytes to decode from. */
struct format_source {
    const uint8_t *bytes;
    size_t length; /* SIZE_MAX: unknown, trust the content */
    enum byte_order order;
};

/*
 * Decodes into value, format_size bytes that the caller provides (padding and
 * all are overwritten).  Every string, pointer target and non-empty variable
 * array is a malloc block of its own.  used (may be NULL) gets the number of
 * bytes consumed; bytes left over are the caller's concern.
 * Returns 0 or ERR_CONTENT, ERR_LIMIT, ERR_DEPTH, ERR_MEMORY, ERR_FORMAT; on
 * failure nothing stays allocated and value is all zero.
 */
int format_decode(const struct format *format, const struct format_source *source, void *value,
                  size_t *used);

/* The same into a new malloc block; *value is NULL on failure and for formats of size 0. */
int format_decode_new(const struct format *format, const struct format_source *source, void **value,
                      size_t *used);

/* Frees everything that the value points to and sets those pointers to NULL; keeps the value
 * itself. */
int format_release(const struct format *format, void *value);

/*
 * Appends the printed value, newline-ended, lines of 80 columns and at most five
 * of them, each indented; 0 or ERR_RANGE, ERR_FORMAT, ERR_MEMORY.
 */
int format_print(const struct format *format, const void *value, unsigned indent,
                 struct buffer *out);

/*
 * Reads the printed form of a value from stream into value (format_size bytes):
 * 0 or ERR_CONTENT, ERR_FORMAT, ERR_MEMORY.  Allocates as format_decode does; on
 * failure nothing stays allocated.
 */
int format_read(const struct format *format, FILE *stream, void *value);

#endif
