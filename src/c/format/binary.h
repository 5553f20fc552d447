/*
 * Formats as data: the wire image of a compiled format.
 *
 * A node is its kind and what belongs to it, every number in 4 bytes:
 *
 *     no format         -1
 *     primitive          0  code
 *     raw bytes          1  length
 *     structure          2  members + 1   the members
 *     pointer            3  a byte: 0 for a self pointer, else 5a and the target
 *     fixed array        4  dimensions + 2  the element  the dimensions
 *     variable array     5  references + 2  the element  the references
 *     bad format         6
 *     named, unresolved  7  name                      (never sent; refused)
 *     enumeration        8  names + 2  largest value  the names
 */
#ifndef IPC_FORMAT_BINARY_H
#define IPC_FORMAT_BINARY_H

#include <stddef.h>
#include <stdint.h>

#include "format/format.h"

/* Number of bytes of a format (NULL: no format); at most a few for each of its parts. */
size_t binary_measure(const struct format *format);

/* Writes as many bytes as measured and returns the end of them. */
uint8_t *binary_encode(const struct format *format, uint8_t *to, bool swap);

/* Bytes to read from; limit is the address of the first byte behind, UINTPTR_MAX if unknown. */
struct binary_source {
    const uint8_t *at;
    uintptr_t limit;
    bool swap;
};

/*
 * Reads a format and moves at behind it: 0 and a reference for the caller (NULL
 * for no format, the bad format if any part is), or ERR_CONTENT.
 */
int binary_decode(struct binary_source *source, struct format **format);

#endif
