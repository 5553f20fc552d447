/*
 * The parser: recursive descent over the tokens, one token ahead.
 *
 * It stops at the first error.  What comes after a whole format is ignored with
 * a warning, as programs rely on.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/limits.h"
#include "base/memory.h"
#include "format/diagnosis.h"
#include "format/handle.h"
#include "format/names_impl.h"
#include "format/token.h"
#include "format/type.h"

struct parser {
    const char *text;
    const struct format_names *names;
    struct format_diagnosis *diagnosis;
    struct token token; /* the next one */
    uint32_t levels;    /* around what is being parsed, definitions that led here included */
    uint32_t parts;     /* made so far; the tree's own count is checked when it is laid out */
    int error;

    /* Where the references of the open structures stand, for complaints at their ends. */
    size_t *positions;
    size_t n_positions, capacity;
};

static void advance(struct parser *p)
{
    p->token = token_read(p->text, p->token.position + p->token.length);
}

static bool at_mark(const struct parser *p, char mark)
{
    return token_is_mark(&p->token, mark);
}

/* Consumes mark if it is next. */
static bool skip_mark(struct parser *p, char mark)
{
    if (!at_mark(p, mark)) {
        return false;
    }
    advance(p);
    return true;
}

static bool complain_at(struct parser *p, const char *what, size_t position)
{
    diagnose_expected(p->diagnosis, what, p->text, position);
    p->error = ERR_FORMAT;
    return false;
}

static bool complain(struct parser *p, const char *what)
{
    return complain_at(p, what, p->token.position);
}

/* Consumes an integer; otherwise complains that what was expected. */
static bool parse_integer(struct parser *p, const char *what, int32_t *value)
{
    if (p->token.kind != TOKEN_INTEGER) {
        return complain(p, what);
    }
    if (p->token.value > INT32_MAX) {
        return complain(p, "an integer of at most 2147483647");
    }
    *value = (int32_t)p->token.value;
    advance(p);
    return true;
}

/* Completes a node that began at position. */
static bool lay_out(struct parser *p, struct type *type, size_t position)
{
    switch (type_lay_out(type)) {
    case 0:
        return true;
    case ERR_RANGE:
        return complain_at(p, "a data size of at most 2147483647 bytes", position);
    case ERR_DEPTH:
        return complain_at(p, "a format of fewer levels", position);
    default:
        return complain_at(p, "a format of fewer parts", position);
    }
}

/* Bounds the memory of a tree before it is laid out. */
static bool count_part(struct parser *p)
{
    if (++p->parts > LIMIT_FORMAT_NODES) {
        return complain(p, "a format of fewer parts");
    }
    return true;
}

static int parse_type(const char *text, const struct format_names *names, uint32_t levels,
                      struct type **type, struct format_diagnosis *diagnosis);
static struct type *parse_format(struct parser *p);
static struct type *parse_member(struct parser *p);

/* type when ok, otherwise NULL with type freed. */
static struct type *keep_if(bool ok, struct type *type)
{
    if (ok) {
        return type;
    }
    type_free(type);
    return NULL;
}

static struct type *parse_raw(struct parser *p)
{
    size_t start = p->token.position;
    struct type *type = type_new(TYPE_RAW);
    return keep_if(parse_integer(p, "an integer", &type->number) && lay_out(p, type, start), type);
}

/* Appends integer, integer, ... up to the closing mark, which is consumed. */
static bool parse_integers(struct parser *p, struct type *type, char closing, const char *otherwise)
{
    do {
        int32_t number = 0;
        if (!parse_integer(p, "an integer value", &number) || !count_part(p)) {
            return false;
        }
        type_add_number(type, number);
    } while (skip_mark(p, ','));
    return skip_mark(p, closing) || complain(p, otherwise);
}

/* [number : format], the opening bracket being consumed. */
static bool parse_old_array(struct parser *p, struct type *type)
{
    int32_t number = 0;
    if (!parse_integer(p, "an integer", &number)) {
        return false;
    }
    if (!skip_mark(p, ':')) {
        return complain(p, "':'");
    }
    struct type *element = parse_format(p);
    if (element == NULL) {
        return false;
    }
    type_add_member(type, element);
    type_add_number(type, number);
    return skip_mark(p, ']') || complain(p, "']'");
}

/* format : integers, the opening mark being consumed. */
static bool parse_array_rest(struct parser *p, struct type *type, char closing,
                             const char *otherwise)
{
    struct type *element = parse_format(p);
    if (element == NULL) {
        return false;
    }
    type_add_member(type, element);
    if (!skip_mark(p, ':')) {
        return complain(p, "':'");
    }
    return parse_integers(p, type, closing, otherwise);
}

static struct type *parse_fixed_array(struct parser *p)
{
    size_t start = p->token.position;
    struct type *type = type_new(TYPE_FIXED_ARRAY);
    advance(p);
    bool ok = p->token.kind == TOKEN_INTEGER ? parse_old_array(p, type)
                                             : parse_array_rest(p, type, ']', "a ',' or ']'");
    return keep_if(ok && lay_out(p, type, start), type);
}

static void push_position(struct parser *p, size_t position)
{
    if (p->n_positions == p->capacity) {
        p->capacity = p->capacity == 0 ? 16 : p->capacity * 2;
        p->positions = mem_resize(p->positions, p->capacity, sizeof *p->positions);
    }
    p->positions[p->n_positions++] = position;
}

/* The references of a variable array, with their positions. */
static bool parse_references(struct parser *p, struct type *type)
{
    do {
        int32_t number = 0;
        push_position(p, p->token.position);
        if (!parse_integer(p, "an integer value", &number) || !count_part(p)) {
            return false;
        }
        type_add_number(type, number);
    } while (skip_mark(p, ','));
    return skip_mark(p, '>') || complain(p, "a ',' or '>'");
}

static struct type *parse_variable_array(struct parser *p)
{
    size_t start = p->token.position;
    struct type *type = type_new(TYPE_VARIABLE_ARRAY);
    advance(p);
    struct type *element = parse_format(p);
    bool ok = element != NULL;
    if (ok) {
        type_add_member(type, element);
    }
    ok = ok && (skip_mark(p, ':') || complain(p, "':'")) && parse_references(p, type);
    return keep_if(ok && lay_out(p, type, start), type);
}

static struct type *new_self(struct parser *p, size_t start)
{
    struct type *self = type_new(TYPE_SELF);
    return keep_if(lay_out(p, self, start), self);
}

/* The manual writes the self pointer both ways round. */
static bool at_reversed_self(const struct parser *p)
{
    const struct token next = token_read(p->text, p->token.position + p->token.length);
    return at_mark(p, '!') && token_is_mark(&next, '*');
}

static struct type *parse_reversed_self(struct parser *p)
{
    size_t start = p->token.position;
    advance(p);
    advance(p);
    return new_self(p, start);
}

/* Pointers, and self pointers where they may stand. */
static struct type *parse_pointer(struct parser *p, bool in_structure)
{
    size_t start = p->token.position;
    advance(p);
    if (at_mark(p, '!')) {
        if (!in_structure) {
            (void)complain(p, "self pointer '*!' embedded within a structure '{..}'");
            return NULL;
        }
        advance(p);
        return new_self(p, start);
    }
    struct type *target = parse_format(p);
    if (target == NULL) {
        return NULL;
    }
    struct type *type = type_new(TYPE_POINTER);
    type_add_member(type, target);
    return keep_if(lay_out(p, type, start), type);
}

/* Names of an enumeration, up to its closing brace. */
static bool parse_enumeration_names(struct parser *p, struct type *type)
{
    do {
        if (p->token.kind != TOKEN_NAME) {
            return complain(p, "a string");
        }
        if (!count_part(p)) {
            return false;
        }
        type_add_name(type, mem_copy_text(p->text + p->token.position, p->token.length));
        advance(p);
    } while (skip_mark(p, ','));
    type->number = (int32_t)type->n_names - 1;
    return skip_mark(p, '}') || complain(p, "'}'");
}

/* What follows {enum. */
static struct type *parse_enumeration(struct parser *p, size_t start)
{
    struct type *type = type_new(TYPE_ENUMERATION);
    advance(p);
    bool ok = skip_mark(p, ':') ? parse_integer(p, "an integer", &type->number) &&
                                      (skip_mark(p, '}') || complain(p, "'}'"))
                                : parse_enumeration_names(p, type);
    return keep_if(ok && lay_out(p, type, start), type);
}

/* What is wrong with one reference, as the parser says it. */
static bool complain_of_reference(struct parser *p, const struct type *structure,
                                  enum reference_fault fault, size_t position)
{
    char what[80];
    switch (fault) {
    case REFERENCE_OUTSIDE:
        (void)snprintf(what, sizeof what, "a reference to one of the %u fields of the structure",
                       (unsigned)structure->n_members);
        return complain_at(p, what, position);
    case REFERENCE_TO_ITSELF:
        return complain_at(p, "a reference to another field of the structure", position);
    default:
        return complain_at(p, "a reference to an integer field of the structure", position);
    }
}

/* Checks all references in a structure, whose positions were pushed since first. */
static bool check_references(struct parser *p, const struct type *structure, size_t first)
{
    size_t position = first;
    for (uint32_t i = 0; i < structure->n_members; i++) {
        const struct type *member = structure->members[i];
        if (member->kind != TYPE_VARIABLE_ARRAY) {
            continue;
        }
        for (uint32_t k = 0; k < member->n_numbers; k++, position++) {
            enum reference_fault fault = type_check_reference(structure, i, member->numbers[k]);
            if (fault != REFERENCE_FINE) {
                return complain_of_reference(p, structure, fault, p->positions[position]);
            }
        }
    }
    p->n_positions = first;
    return true;
}

static bool parse_members(struct parser *p, struct type *type)
{
    if (skip_mark(p, '}')) {
        return true;
    }
    do {
        struct type *member = parse_member(p);
        if (member == NULL) {
            return false;
        }
        type_add_member(type, member);
    } while (skip_mark(p, ','));
    return skip_mark(p, '}') || complain(p, "','");
}

static struct type *parse_structure(struct parser *p)
{
    size_t start = p->token.position;
    size_t first_position = p->n_positions;
    advance(p);
    if (token_is_name(&p->token, p->text, "enum")) {
        return parse_enumeration(p, start);
    }
    struct type *type = type_new(TYPE_STRUCTURE);
    return keep_if(parse_members(p, type) && lay_out(p, type, start) &&
                       check_references(p, type, first_position),
                   type);
}

/* Parses a definition at its first use. */
static void parse_definition(struct parser *p, const char *name, struct definition *definition)
{
    struct type *type = NULL;
    if (definition->parsing) {
        diagnose_name(p->diagnosis, name, "is defined in terms of itself", p->text,
                      p->token.position);
        p->error = ERR_FORMAT;
        return;
    }
    definition->parsing = true;
    p->error = parse_type(definition->text, p->names, p->levels, &type, p->diagnosis);
    definition->parsing = false;
    if (p->error == 0) {
        definition->parsed = format_new(type);
    }
}

/* The format of a name that the table does not hold; the answer is used once. */
static struct format *ask(struct parser *p, const char *name)
{
    struct format *answer = names_ask(p->names, name);
    if (answer != NULL && !format_is_bad(answer)) {
        return answer;
    }
    if (answer == NULL) {
        diagnose_name(p->diagnosis, name, "is not registered", p->text, p->token.position);
    } else {
        diagnose_silently(p->diagnosis, p->token.position); /* whoever answered has said it */
    }
    p->error = ERR_UNKNOWN;
    return NULL;
}

/* A reference to the format of a name, NULL with an error and a diagnosis if there is none. */
static struct format *resolve(struct parser *p, const char *name)
{
    struct definition *definition = names_find(p->names, name);
    if (definition == NULL) {
        return ask(p, name);
    }
    if (definition->parsed == NULL) {
        parse_definition(p, name, definition);
    }
    return p->error == 0 ? format_ref(definition->parsed) : NULL;
}

/* The expansion of a name that is neither a primitive nor the alias. */
static struct type *expand_name(struct parser *p, const char *name)
{
    struct format *found = resolve(p, name);
    if (found == NULL) {
        return NULL;
    }
    uint32_t parts = found->type->parts;
    struct type *type = NULL;
    if (found->type->height + p->levels - 1 > LIMIT_FORMAT_DEPTH) {
        (void)complain(p, "a format of fewer levels");
    } else if (parts > LIMIT_FORMAT_NODES - p->parts) {
        (void)complain(p, "a format of fewer parts");
    } else {
        type = type_copy(found->type);
    }
    p->parts += type == NULL ? 0 : parts;
    format_unref(found);
    return type;
}

/* A primitive, the alias uchar of ubyte unless that is defined, or a named format. */
static struct type *parse_name(struct parser *p)
{
    const char *text = p->text + p->token.position;
    struct type *type = NULL;
    enum primitive primitive = primitive_find(text, p->token.length);
    char *name = NULL;
    if (primitive == N_PRIMITIVES) {
        name = mem_copy_text(text, p->token.length);
        bool defined = p->names != NULL && format_names_holds(p->names, name);
        if (!defined && token_is_name(&p->token, p->text, "uchar")) {
            primitive = PRIMITIVE_UBYTE;
        }
    }
    if (primitive == N_PRIMITIVES) {
        type = expand_name(p, name);
    } else {
        type = type_new_primitive(primitive);
        (void)type_lay_out(type);
    }
    free(name);
    if (type != NULL) {
        advance(p);
    }
    return type;
}

static struct type *parse_mark(struct parser *p, bool in_structure)
{
    switch (p->token.mark) {
    case '{':
        return parse_structure(p);
    case '[':
        return parse_fixed_array(p);
    case '*':
        return parse_pointer(p, in_structure);
    case '<':
        if (in_structure) {
            return parse_variable_array(p);
        }
        (void)complain(p, "var array format '<..>' not embedded within a structure '{..}'");
        return NULL;
    case '!':
        if (in_structure && at_reversed_self(p)) {
            return parse_reversed_self(p);
        }
        (void)complain(p, "a different token type");
        return NULL;
    default:
        (void)complain(p, "a different token type");
        return NULL;
    }
}

static struct type *parse_any(struct parser *p, bool in_structure)
{
    if (p->levels >= LIMIT_FORMAT_DEPTH) {
        (void)complain(p, "a format of fewer levels");
        return NULL;
    }
    if (!count_part(p)) {
        return NULL;
    }
    struct type *type = NULL;
    p->levels++;
    switch (p->token.kind) {
    case TOKEN_END:
        (void)complain(p, "additional tokens; premature end of string encountered");
        break;
    case TOKEN_INTEGER:
        type = parse_raw(p);
        break;
    case TOKEN_NAME:
        type = parse_name(p);
        break;
    case TOKEN_MARK:
        type = parse_mark(p, in_structure);
        break;
    }
    p->levels--;
    return type;
}

static struct type *parse_format(struct parser *p)
{
    return parse_any(p, false);
}

static struct type *parse_member(struct parser *p)
{
    return parse_any(p, true);
}

/*
 * Parses text, which stands levels deep in what is being parsed, into a type
 * that the caller frees: 0, or ERR_FORMAT or ERR_UNKNOWN with a diagnosis
 * (which may be NULL).
 */
static int parse_type(const char *text, const struct format_names *names, uint32_t levels,
                      struct type **type, struct format_diagnosis *diagnosis)
{
    struct parser parser = {.text = text, .names = names, .diagnosis = diagnosis, .levels = levels};
    parser.token = token_read(text, 0);
    *type = parse_format(&parser);
    free(parser.positions);
    if (*type != NULL && parser.token.kind != TOKEN_END) {
        diagnose_extra_text(diagnosis, text, parser.token.position);
    }
    return *type == NULL ? parser.error : 0;
}

int format_parse(const char *text, const struct format_names *names, struct format **format,
                 struct format_diagnosis *diagnosis)
{
    if (diagnosis != NULL) {
        *diagnosis = (struct format_diagnosis){NULL, 0};
    }
    *format = NULL;
    struct type *type = NULL;
    int error = parse_type(text, names, 0, &type, diagnosis);
    if (error == 0) {
        *format = format_new(type);
    }
    return error;
}
