/*
 * Programs: a type compiled into flat operations.
 *
 * A program is an array of operations in bodies.  The first body works on the
 * value itself; the others work on the targets of pointers and on the elements
 * of arrays, and are entered with the number of elements to work through.  A
 * body ends with OP_END, which steps to the next element, or with OP_NEXT, which
 * goes on with the next node of a linked list: lists are loops, not nesting.
 *
 * Inner structures are part of the body that they stand in, so that adjacent
 * members fold into one copy across them.  Only a structure with self pointers
 * has a body of its own (OP_CALL), for those pointers to lead to; it is always
 * entered for one element.
 *
 * Every type has three programs: for bytes in this host's order, for bytes in
 * the other order, and one that visits only what is allocated.
 */
#ifndef IPC_FORMAT_PROGRAM_H
#define IPC_FORMAT_PROGRAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "base/error.h"

struct type;

enum opcode {
    OP_END,    /* next element at size bytes behind this one: go back body operations */
    OP_COPY,   /* length bytes, alike in memory and on the wire */
    OP_COPY_4, /* the same for 4 and 8 bytes, the usual lengths of one member */
    OP_COPY_8,
    OP_SWAP,        /* length numbers of unit bytes each, in the other order */
    OP_ENUMERATION, /* unit bytes in memory, 4 on the wire */
    OP_STRING,
    OP_FORMAT,
    OP_REFERENCE,
    OP_POINTER, /* one target of size bytes */
    OP_BLOCK,   /* variable array of elements of size bytes: one copy, or numbers of unit bytes */
    OP_ARRAY,   /* variable array of other elements */
    OP_LOOP,    /* fixed array of length elements */
    OP_CALL,    /* inner structure with a body of its own */
    OP_CHECK,   /* end of a structure: an array's count against dimensions that followed it */
    OP_NEXT     /* self pointer that ends its structure: go back body operations with its target */
};

struct op {
    uint8_t code; /* enum opcode */
    uint8_t unit;
    bool flat;              /* OP_ARRAY: elements hold no pointers */
    bool dimensions_follow; /* arrays: a dimension stands behind the array on the wire */
    uint32_t offset;        /* in the current element */
    uint32_t length;
    uint32_t size;
    uint32_t least; /* smallest number of wire bytes of one element or target */
    uint32_t body;  /* index of the body's first operation; END and NEXT: how far back it is */
    uint32_t first_dimension;
    uint32_t n_dimensions;
};

/* A field that holds a dimension. */
struct dimension {
    uint32_t offset; /* in the current element */
    uint8_t size;    /* 0: of an array that refers to itself, always negative */
    bool is_signed;
};

struct program {
    struct op *ops;
    struct dimension *dimensions;
};

enum program_purpose { PROGRAM_NATIVE, PROGRAM_FOREIGN, PROGRAM_OWNED, N_PROGRAMS };

void program_compile(struct program *program, const struct type *type,
                     enum program_purpose purpose);
void program_fini(struct program *program);

/* The dimension that a field of a structure holds, the field being at offset. */
struct dimension dimension_of(const struct type *field, uint32_t offset);

/* The value of a dimension field; a number too large for its type gives INT64_MAX. */
int64_t dimension_read(const struct dimension *dimension, const uint8_t *element);

/* The number of elements of an array: 0, or ERR_RANGE for a negative dimension or too large a
 * product. */
static inline int program_count(const struct program *program, const struct op *op,
                                const uint8_t *element, uint32_t *count)
{
    const struct dimension *dimension = &program->dimensions[op->first_dimension];
    uint64_t product = 1;
    bool empty = false, too_many = false;
    for (uint32_t i = 0; i < op->n_dimensions; i++, dimension++) {
        int64_t size;
        if (dimension->size == 4 && dimension->is_signed) {
            int32_t usual;
            memcpy(&usual, element + dimension->offset, sizeof usual);
            size = usual;
        } else {
            size = dimension_read(dimension, element);
        }
        if (size < 0) {
            return ERR_RANGE;
        }
        empty = empty || size == 0;
        too_many = too_many || size > INT32_MAX;
        if (!too_many) {
            product *= (uint64_t)size;
        }
        too_many = too_many || product > INT32_MAX;
    }
    *count = empty ? 0 : (uint32_t)product;
    return too_many && !empty ? ERR_RANGE : 0;
}

#endif
