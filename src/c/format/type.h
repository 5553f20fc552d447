/*
 * The type tree: what a format string means, laid out for this host.
 *
 * A tree is built bottom-up by the parser or by the reader of binary formats;
 * type_lay_out completes each node once its children are complete.  After that
 * nothing changes.  Every node has one parent: named formats are expanded by
 * copying, so that the members' offsets can stand in the members.
 */
#ifndef IPC_FORMAT_TYPE_H
#define IPC_FORMAT_TYPE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum type_kind {
    TYPE_PRIMITIVE,
    TYPE_RAW,
    TYPE_STRUCTURE,
    TYPE_POINTER,
    TYPE_SELF, /* *!: points to the enclosing structure */
    TYPE_FIXED_ARRAY,
    TYPE_VARIABLE_ARRAY,
    TYPE_ENUMERATION
};

/* In the order of the table in primitive.c. */
enum primitive {
    PRIMITIVE_CHAR,
    PRIMITIVE_BYTE,
    PRIMITIVE_UBYTE,
    PRIMITIVE_SHORT,
    PRIMITIVE_USHORT,
    PRIMITIVE_TWOBYTE,
    PRIMITIVE_INT,
    PRIMITIVE_UINT,
    PRIMITIVE_BOOLEAN,
    PRIMITIVE_LONG,
    PRIMITIVE_ULONG,
    PRIMITIVE_FLOAT,
    PRIMITIVE_DOUBLE,
    PRIMITIVE_STRING,
    PRIMITIVE_FORMAT,
    PRIMITIVE_REFERENCE, /* X_IPC_REF_PTR */
    N_PRIMITIVES
};

struct primitive_info {
    const char *name;
    uint32_t code; /* on the wire */
    uint32_t size;
    uint32_t alignment;
    uint32_t wire_least; /* smallest number of wire bytes; the only one for flat primitives */
    bool flat;           /* not a pointer */
    bool integer;        /* may hold the dimension of an array */
    bool is_signed;      /* of an integer */
};

extern const struct primitive_info primitive_table[N_PRIMITIVES];

/* The primitive of a name or of a wire code, N_PRIMITIVES if there is none. */
enum primitive primitive_find(const char *name, size_t length);
enum primitive primitive_find_code(uint32_t code);

/* Bytes that an enumeration occupies in memory when its largest value is this. */
uint32_t enumeration_size(int32_t largest);

struct type {
    enum type_kind kind;
    enum primitive primitive;
    int32_t number;     /* raw: bytes; enumeration: largest value */
    uint32_t n_members; /* structure: its members; pointer and array: 1, the target or element */
    struct type **members;
    uint32_t n_numbers; /* fixed array: dimensions; variable array: references */
    int32_t *numbers;
    uint32_t n_names; /* enumeration; 0 for the numeric form */
    char **names;

    uint32_t parts;  /* nodes, numbers and names in this tree */
    uint32_t height; /* levels below and with this one */
    uint32_t size;   /* in memory */
    uint32_t alignment;
    uint32_t offset;     /* in the enclosing structure */
    uint32_t count;      /* fixed array: product of the dimensions */
    uint32_t wire_least; /* smallest number of wire bytes; the only one for a flat type */
    uint32_t unit;       /* size of the numbers a simple type consists of; 0 if they differ */
    bool flat;           /* holds no pointer */
    bool simple;         /* memory image and wire image are the same */
    bool has_self;       /* structure: one of its own members is a self pointer */
};

/* New nodes, not laid out yet. */
struct type *type_new(enum type_kind kind);
struct type *type_new_primitive(enum primitive primitive);

/* Append to a node; the type or the name becomes the node's own. */
void type_add_member(struct type *type, struct type *member);
void type_add_number(struct type *type, int32_t number);
void type_add_name(struct type *type, char *name);

/* NULL is fine. */
void type_free(struct type *type);
struct type *type_copy(const struct type *type);

bool type_equal(const struct type *a, const struct type *b);

/* The first field of a reference: references 0 and 1 both mean the first. */
static inline uint32_t reference_index(int32_t reference)
{
    return reference == 0 ? 0 : (uint32_t)reference - 1;
}

/*
 * Completes a node whose children are complete: 0, or ERR_RANGE when the value
 * would pass 2^31-1 bytes, ERR_DEPTH or ERR_LIMIT when the tree is too high or
 * has too many parts.
 */
int type_lay_out(struct type *type);

enum reference_fault {
    REFERENCE_FINE,
    REFERENCE_OUTSIDE,   /* no such field */
    REFERENCE_TO_ITSELF, /* the array's own field */
    REFERENCE_NO_INTEGER /* a field that holds no integer */
};

/* Whether a reference in the variable array that is member index of a structure is legal. */
enum reference_fault type_check_reference(const struct type *structure, uint32_t index,
                                          int32_t reference);

/* Where the integer stands that a field leads to: the field's first primitive or enumeration. */
const struct type *type_first_part(const struct type *type);

#endif
