/*
 * The tree of a specification.
 *
 * The grammar builds it, the check resolves its names, the emitters read it.
 * Names and code are pieces of the input.  Both ways to name a structure or an
 * enum (struct T {...}; and typedef struct {...} T;) give the same tree.
 */
#ifndef XDRGEN_TREE_H
#define XDRGEN_TREE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "place.h"
#include "text.h"

enum {
    TREE_MAX_DEPTH = 4000 /* nested structures; the passes over the tree recurse */
};

enum type_kind {
    TYPE_CHAR,
    TYPE_UCHAR,
    TYPE_INT,
    TYPE_UINT,
    TYPE_FLOAT,
    TYPE_DOUBLE,
    TYPE_BOOL,
    TYPE_STRING,
    TYPE_RECORD,
    TYPE_ENUM,
    TYPE_NAMED
};

struct definition;
struct record;
struct enumeration;

struct type {
    enum type_kind kind;
    struct place place;
    struct record *record;           /* TYPE_RECORD */
    struct enumeration *enumeration; /* TYPE_ENUM */
    struct text name;                /* TYPE_NAMED */
    struct definition *target;       /* TYPE_NAMED, set by the check; NULL: undeclared */
};

/* What stands between one pair of brackets. */
struct dimension {
    struct place place;
    bool has_value; /* always true of fixed dimensions */
    int64_t value;  /* the number of elements, or the limit of a variable dimension */
    size_t width;   /* bytes of the number in the input */
};

enum array_kind { ARRAY_NONE, ARRAY_FIXED, ARRAY_VARIABLE };

struct dimensions {
    struct dimension *items;
    size_t count;
};

/* A field, or a definition of a type. */
struct declaration {
    struct type type;
    struct text name;
    struct place place; /* of the name */
    enum array_kind array;
    struct dimensions dimensions; /* of a string: without its own, which is length_limit */
    struct dimension length_limit;
};

/* A code section; length 0 and bytes NULL if there is none. */
struct code {
    struct text text;
    struct place place;
};

struct record {
    struct declaration **fields;
    size_t n_fields;
    struct code code;
    size_t depth;    /* 1: no structure inside */
    bool is_damaged; /* syntax errors have cost it fields */
};

struct enumerator {
    struct text name;
    struct place place;
    bool has_value; /* written in the specification */
    int64_t value;  /* the one written, or one more than that of its predecessor */
};

struct enumeration {
    struct enumerator *items;
    size_t count;
    bool has_values; /* at least one value is written */
};

enum definition_kind { DEFINITION_TYPE, DEFINITION_FORMAT, DEFINITION_CODE };

/* What a type is when all typedefs are followed. */
enum shape { SHAPE_INTEGER, SHAPE_SCALAR, SHAPE_ENUM, SHAPE_RECORD, SHAPE_ARRAY, SHAPE_EXTERNAL };

struct meaning {
    enum shape shape;               /* SHAPE_INTEGER: int or unsigned int */
    bool is_integer_array;          /* SHAPE_ARRAY: fixed, of int or unsigned int */
    const struct type *element;     /* what it is, or is an array of; NULL: something external */
    const struct definition *owner; /* the definition with that element; NULL: an anonymous one */
};

struct definition {
    enum definition_kind kind;
    struct text name;
    struct place place;
    struct declaration *declaration; /* DEFINITION_TYPE */
    char *format;                    /* DEFINITION_FORMAT: the text without its escapes, or NULL */
    struct code code;                /* DEFINITION_CODE */
    struct meaning meaning;          /* DEFINITION_TYPE, set by the check */
    char *expansion;                 /* its format without names of other types; see format.h */
    struct definition *next;
};

struct tree {
    struct definition *first;
    struct definition *last;
};

void tree_init(struct tree *tree);
void tree_fini(struct tree *tree);

/* Each takes over what it is given. */
void tree_add_type(struct tree *tree, struct declaration *declaration);
void tree_add_format(struct tree *tree, struct text name, const struct place *place, char *format);
void tree_add_code(struct tree *tree, struct text text, const struct place *place);

/* Types; those with a body take it over. */
struct type type_simple(enum type_kind kind, const struct place *place);
struct type type_named(struct text name, const struct place *place);
struct type type_record(struct record *record, const struct place *place);
struct type type_enum(struct enumeration *enumeration, const struct place *place);
void type_fini(struct type *type);

struct dimensions *dimensions_new(void);
void dimensions_append(struct dimensions *dimensions, struct dimension dimension);
void dimensions_free(struct dimensions *dimensions);

/* Takes over the type and the dimensions (NULL: none). */
struct declaration *declaration_new(struct type type, struct text name, const struct place *place,
                                    enum array_kind array, struct dimensions *dimensions);

/* A string, whose last dimension is its own. */
struct declaration *declaration_new_string(const struct place *type_place, struct text name,
                                           const struct place *place, enum array_kind array,
                                           struct dimensions *dimensions);
void declaration_free(struct declaration *declaration);

struct record *record_new(void);
void record_append(struct record *record, struct declaration *field); /* NULL: a damaged one */
void record_free(struct record *record);

struct enumeration *enumeration_new(void);
void enumeration_append(struct enumeration *enumeration, struct enumerator enumerator);
void enumeration_free(struct enumeration *enumeration);

/* Whether a definition is a structure or an enum itself, not an array of them. */
bool definition_is_record(const struct definition *definition);
bool definition_is_enum(const struct definition *definition);

/* Follows typedefs; names must have been resolved. */
struct meaning declaration_meaning(const struct declaration *declaration);

#endif
