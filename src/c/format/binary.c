/*
 * Formats as data: the wire image of a compiled format.
 *
 * Nothing that is read is trusted: what is built obeys the same rules and limits
 * as what the parser builds.
 */
#include "format/binary.h"

#include <string.h>

#include "base/error.h"
#include "base/limits.h"
#include "base/memory.h"
#include "format/handle.h"
#include "format/walk.h"

enum node_kind {
    NODE_NONE = -1,
    NODE_PRIMITIVE = 0,
    NODE_RAW = 1,
    NODE_STRUCTURE = 2,
    NODE_POINTER = 3,
    NODE_FIXED_ARRAY = 4,
    NODE_VARIABLE_ARRAY = 5,
    NODE_BAD = 6,
    NODE_ENUMERATION = 8
};

enum { FILLER = 0x5a };

/* ----------------------------------------------------------------- writing */

static size_t measure_string(const char *text)
{
    size_t length = strlen(text);
    return 4 + (length == 0 ? 1 : length);
}

static size_t measure_node(const struct type *type)
{
    size_t length = 8 + (size_t)type->n_numbers * 4;
    for (uint32_t i = 0; i < type->n_members; i++) {
        length += measure_node(type->members[i]);
    }
    for (uint32_t i = 0; i < type->n_names; i++) {
        length += measure_string(type->names[i]);
    }
    if (type->kind == TYPE_ENUMERATION) {
        length += 4;
    } else if (type->kind == TYPE_POINTER || type->kind == TYPE_SELF) {
        length -= 3; /* a flag byte, not a number */
    }
    return length;
}

size_t binary_measure(const struct format *format)
{
    return format == NULL || format_is_bad(format) ? 4 : measure_node(format->type);
}

static uint8_t *write_number(uint8_t *to, uint32_t number, bool swap)
{
    count_store(to, number, swap);
    return to + 4;
}

static uint8_t *write_string(uint8_t *to, const char *text, bool swap)
{
    size_t length = strlen(text);
    to = write_number(to, (uint32_t)length, swap);
    if (length == 0) {
        *to++ = FILLER;
    } else {
        memcpy(to, text, length);
    }
    return to + length;
}

static uint8_t *write_node(uint8_t *to, const struct type *type, bool swap);

/* Kind, count, then members and numbers: structures and arrays. */
static uint8_t *write_compound(uint8_t *to, const struct type *type, enum node_kind kind,
                               uint32_t count, bool swap)
{
    to = write_number(to, (uint32_t)kind, swap);
    to = write_number(to, count, swap);
    for (uint32_t i = 0; i < type->n_members; i++) {
        to = write_node(to, type->members[i], swap);
    }
    for (uint32_t i = 0; i < type->n_numbers; i++) {
        to = write_number(to, (uint32_t)type->numbers[i], swap);
    }
    return to;
}

static uint8_t *write_enumeration(uint8_t *to, const struct type *type, bool swap)
{
    to = write_number(to, NODE_ENUMERATION, swap);
    to = write_number(to, type->n_names + 2, swap);
    to = write_number(to, (uint32_t)type->number, swap);
    for (uint32_t i = 0; i < type->n_names; i++) {
        to = write_string(to, type->names[i], swap);
    }
    return to;
}

static uint8_t *write_node(uint8_t *to, const struct type *type, bool swap)
{
    switch (type->kind) {
    case TYPE_PRIMITIVE:
        to = write_number(to, NODE_PRIMITIVE, swap);
        return write_number(to, primitive_table[type->primitive].code, swap);
    case TYPE_RAW:
        to = write_number(to, NODE_RAW, swap);
        return write_number(to, (uint32_t)type->number, swap);
    case TYPE_STRUCTURE:
        return write_compound(to, type, NODE_STRUCTURE, type->n_members + 1, swap);
    case TYPE_FIXED_ARRAY:
        return write_compound(to, type, NODE_FIXED_ARRAY, type->n_numbers + 2, swap);
    case TYPE_VARIABLE_ARRAY:
        return write_compound(to, type, NODE_VARIABLE_ARRAY, type->n_numbers + 2, swap);
    case TYPE_ENUMERATION:
        return write_enumeration(to, type, swap);
    case TYPE_SELF:
    case TYPE_POINTER:
        break;
    }
    to = write_number(to, NODE_POINTER, swap);
    *to++ = type->kind == TYPE_SELF ? 0 : FILLER;
    return type->kind == TYPE_SELF ? to : write_node(to, type->members[0], swap);
}

uint8_t *binary_encode(const struct format *format, uint8_t *to, bool swap)
{
    if (format == NULL) {
        return write_number(to, (uint32_t)NODE_NONE, swap);
    }
    if (format_is_bad(format)) {
        return write_number(to, NODE_BAD, swap);
    }
    return write_node(to, format->type, swap);
}

/* ----------------------------------------------------------------- reading */

struct reader {
    struct binary_source source;
    uint32_t levels;
    uint32_t parts;
    bool bad; /* a bad format stands somewhere inside */
};

static size_t rest(const struct reader *r)
{
    return (size_t)(r->source.limit - (uintptr_t)r->source.at);
}

static bool read_number(struct reader *r, int32_t *number)
{
    if (rest(r) < 4) {
        return false;
    }
    *number = (int32_t)count_load(r->source.at, r->source.swap);
    r->source.at += 4;
    return true;
}

/* A number of things, least being what stands for none, each of at least size bytes. */
static bool read_count(struct reader *r, int32_t least, size_t size, uint32_t *count)
{
    int32_t number;
    if (!read_number(r, &number) || number < least) {
        return false;
    }
    *count = (uint32_t)(number - least);
    if (*count > LIMIT_FORMAT_NODES - r->parts || *count > rest(r) / size) {
        return false;
    }
    return true;
}

static struct type *read_node(struct reader *r, bool in_structure);

/* type when ok, otherwise NULL with type freed. */
static struct type *keep_if(bool ok, struct type *type)
{
    if (ok) {
        return type;
    }
    type_free(type);
    return NULL;
}

static bool read_member(struct reader *r, struct type *type, bool in_structure)
{
    struct type *member = read_node(r, in_structure);
    if (member == NULL) {
        return false;
    }
    type_add_member(type, member);
    return true;
}

static struct type *read_primitive(struct reader *r)
{
    int32_t code;
    if (!read_number(r, &code)) {
        return NULL;
    }
    enum primitive primitive = primitive_find_code((uint32_t)code);
    return primitive == N_PRIMITIVES ? NULL : type_new_primitive(primitive);
}

static struct type *read_raw(struct reader *r)
{
    int32_t length;
    if (!read_number(r, &length) || length < 0) {
        return NULL;
    }
    struct type *type = type_new(TYPE_RAW);
    type->number = length;
    return type;
}

static bool references_are_legal(const struct type *structure)
{
    for (uint32_t i = 0; i < structure->n_members; i++) {
        const struct type *member = structure->members[i];
        if (member->kind != TYPE_VARIABLE_ARRAY) {
            continue;
        }
        for (uint32_t k = 0; k < member->n_numbers; k++) {
            if (type_check_reference(structure, i, member->numbers[k]) != REFERENCE_FINE) {
                return false;
            }
        }
    }
    return true;
}

static struct type *read_structure(struct reader *r)
{
    uint32_t count;
    if (!read_count(r, 1, 4, &count)) {
        return NULL;
    }
    struct type *type = type_new(TYPE_STRUCTURE);
    bool ok = true;
    for (uint32_t i = 0; ok && i < count; i++) {
        ok = read_member(r, type, true);
    }
    return keep_if(ok && (r->bad || references_are_legal(type)), type);
}

static struct type *read_pointer(struct reader *r, bool in_structure)
{
    if (rest(r) < 1) {
        return NULL;
    }
    bool is_self = *r->source.at++ == 0;
    if (is_self) {
        return in_structure ? type_new(TYPE_SELF) : NULL;
    }
    struct type *type = type_new(TYPE_POINTER);
    return keep_if(read_member(r, type, false), type);
}

static struct type *read_array(struct reader *r, enum type_kind kind)
{
    uint32_t count;
    if (!read_count(r, 2, 4, &count) || count == 0) {
        return NULL;
    }
    struct type *type = type_new(kind);
    bool ok = read_member(r, type, false);
    for (uint32_t i = 0; ok && i < count; i++) {
        int32_t number;
        ok = read_number(r, &number) && number >= 0;
        if (ok) {
            type_add_number(type, number);
        }
    }
    r->parts += count;
    return keep_if(ok, type);
}

static bool read_name(struct reader *r, struct type *type)
{
    int32_t length;
    if (!read_number(r, &length) || length < 0 || rest(r) < 1 || (size_t)length > rest(r)) {
        return false;
    }
    type_add_name(type, mem_copy_text((const char *)r->source.at, (size_t)length));
    r->source.at += length == 0 ? 1 : length;
    return true;
}

static struct type *read_enumeration(struct reader *r)
{
    uint32_t count;
    if (!read_count(r, 2, 5, &count)) {
        return NULL;
    }
    struct type *type = type_new(TYPE_ENUMERATION);
    bool ok = read_number(r, &type->number) && type->number >= 0;
    for (uint32_t i = 0; ok && i < count; i++) {
        ok = read_name(r, type);
    }
    r->parts += count;
    return keep_if(ok && (count == 0 || (uint32_t)type->number == count - 1), type);
}

/* A bad format takes the whole format with it; the rest is read all the same. */
static struct type *read_bad(struct reader *r)
{
    r->bad = true;
    return type_new(TYPE_RAW);
}

static struct type *read_kind(struct reader *r, bool in_structure)
{
    int32_t kind;
    if (!read_number(r, &kind)) {
        return NULL;
    }
    switch (kind) {
    case NODE_PRIMITIVE:
        return read_primitive(r);
    case NODE_RAW:
        return read_raw(r);
    case NODE_STRUCTURE:
        return read_structure(r);
    case NODE_POINTER:
        return read_pointer(r, in_structure);
    case NODE_FIXED_ARRAY:
        return read_array(r, TYPE_FIXED_ARRAY);
    case NODE_VARIABLE_ARRAY:
        return in_structure ? read_array(r, TYPE_VARIABLE_ARRAY) : NULL;
    case NODE_BAD:
        return read_bad(r);
    case NODE_ENUMERATION:
        return read_enumeration(r);
    default:
        return NULL;
    }
}

static struct type *read_node(struct reader *r, bool in_structure)
{
    if (r->levels >= LIMIT_FORMAT_DEPTH || r->parts >= LIMIT_FORMAT_NODES) {
        return NULL;
    }
    r->levels++;
    r->parts++;
    struct type *type = read_kind(r, in_structure);
    r->levels--;
    return type == NULL ? NULL : keep_if(type_lay_out(type) == 0, type);
}

int binary_decode(struct binary_source *source, struct format **format)
{
    struct reader reader = {.source = *source};
    *format = NULL;
    if (rest(&reader) >= 4 && (int32_t)count_load(source->at, source->swap) == NODE_NONE) {
        source->at += 4;
        return 0;
    }
    struct type *type = read_node(&reader, false);
    if (type == NULL) {
        return ERR_CONTENT;
    }
    *source = reader.source;
    if (reader.bad) {
        type_free(type);
        *format = format_bad();
    } else {
        *format = format_new(type);
    }
    return 0;
}
