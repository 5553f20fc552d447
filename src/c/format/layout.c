/*
 * Layout: sizes, alignments and offsets as the C compiler of this host has
 * them, and the properties that follow from them.
 */
#include "format/type.h"

#include "base/error.h"
#include "base/limits.h"

static const uint64_t largest_size = INT32_MAX;

static uint64_t round_up(uint64_t offset, uint32_t alignment)
{
    return (offset + alignment - 1) / alignment * alignment;
}

static uint32_t larger(uint32_t a, uint32_t b)
{
    return a > b ? a : b;
}

static int lay_out_flat(struct type *type, uint32_t size, uint32_t alignment, uint32_t wire)
{
    type->size = size;
    type->alignment = alignment;
    type->wire_least = wire;
    type->flat = true;
    type->simple = size == wire;
    type->unit = type->simple ? size : 0;
    return 0;
}

static int lay_out_pointer(struct type *type, uint32_t wire_least)
{
    type->size = primitive_table[PRIMITIVE_STRING].size;
    type->alignment = primitive_table[PRIMITIVE_STRING].alignment;
    type->wire_least = wire_least;
    return 0;
}

static int lay_out_primitive(struct type *type)
{
    const struct primitive_info *info = &primitive_table[type->primitive];
    if (!info->flat) {
        return lay_out_pointer(type, info->wire_least);
    }
    return lay_out_flat(type, info->size, info->alignment, info->wire_least);
}

/* Raw bytes are aligned to their own number, unlike an array of characters in C. */
static int lay_out_raw(struct type *type)
{
    uint32_t size = (uint32_t)type->number;
    (void)lay_out_flat(type, size, size == 0 ? 1 : size, size);
    type->unit = 1;
    return 0;
}

static int lay_out_enumeration(struct type *type)
{
    uint32_t size = enumeration_size(type->number);
    enum primitive alike = size == 1   ? PRIMITIVE_UBYTE
                           : size == 2 ? PRIMITIVE_USHORT
                                       : PRIMITIVE_INT;
    return lay_out_flat(type, size, primitive_table[alike].alignment, 4);
}

static int lay_out_fixed_array(struct type *type)
{
    const struct type *element = type->members[0];
    uint64_t count = 1;
    bool empty = false, too_many = false;
    for (uint32_t i = 0; i < type->n_numbers; i++) {
        empty = empty || type->numbers[i] == 0;
        if (!too_many) {
            count *= (uint64_t)type->numbers[i];
        }
        too_many = too_many || count > largest_size;
    }
    if (empty) {
        count = 0;
    } else if (too_many) {
        return ERR_RANGE;
    }
    if (count * element->size > largest_size || count * element->wire_least > largest_size) {
        return ERR_RANGE;
    }
    type->count = (uint32_t)count;
    type->size = (uint32_t)(count * element->size);
    type->alignment = element->alignment;
    type->wire_least = (uint32_t)(count * element->wire_least);
    type->flat = element->flat;
    type->simple = element->simple;
    type->unit = element->unit;
    return 0;
}

/* Takes one member at offset into the properties of its structure. */
static void add_to_structure(struct type *type, const struct type *member)
{
    type->alignment = larger(type->alignment, member->alignment);
    type->flat = type->flat && member->flat;
    type->simple = type->simple && member->simple;
    type->has_self = type->has_self || member->kind == TYPE_SELF;
    if (member->size > 0) {
        if (type->unit == UINT32_MAX) {
            type->unit = member->unit;
        } else if (type->unit != member->unit) {
            type->unit = 0;
        }
    }
}

static int lay_out_structure(struct type *type)
{
    uint64_t end = 0, wire = 0;
    type->alignment = 1;
    type->flat = type->simple = true;
    type->unit = UINT32_MAX; /* no member with a size seen yet */
    for (uint32_t i = 0; i < type->n_members; i++) {
        struct type *member = type->members[i];
        uint64_t offset = round_up(end, member->alignment);
        if (offset + member->size > largest_size) {
            return ERR_RANGE;
        }
        if (offset != end) {
            type->simple = false;
        }
        member->offset = (uint32_t)offset;
        end = offset + member->size;
        wire += member->wire_least;
        add_to_structure(type, member);
    }
    uint64_t size = round_up(end, type->alignment);
    if (size > largest_size || wire > largest_size) {
        return ERR_RANGE;
    }
    if (size != end) {
        type->simple = false;
    }
    if (type->unit == UINT32_MAX) {
        type->unit = 1;
    }
    if (!type->simple) {
        type->unit = 0;
    }
    type->size = (uint32_t)size;
    type->wire_least = (uint32_t)wire;
    return 0;
}

static int lay_out_kind(struct type *type)
{
    switch (type->kind) {
    case TYPE_PRIMITIVE:
        return lay_out_primitive(type);
    case TYPE_RAW:
        return lay_out_raw(type);
    case TYPE_ENUMERATION:
        return lay_out_enumeration(type);
    case TYPE_STRUCTURE:
        return lay_out_structure(type);
    case TYPE_FIXED_ARRAY:
        return lay_out_fixed_array(type);
    case TYPE_VARIABLE_ARRAY:
        return lay_out_pointer(type, 4);
    case TYPE_POINTER:
    case TYPE_SELF:
        break;
    }
    return lay_out_pointer(type, 1);
}

int type_lay_out(struct type *type)
{
    uint64_t parts = (uint64_t)1 + type->n_numbers + type->n_names;
    uint32_t height = 0;
    for (uint32_t i = 0; i < type->n_members; i++) {
        parts += type->members[i]->parts;
        height = larger(height, type->members[i]->height);
    }
    if (parts > LIMIT_FORMAT_NODES) {
        return ERR_LIMIT;
    }
    if (height >= LIMIT_FORMAT_DEPTH) {
        return ERR_DEPTH;
    }
    type->parts = (uint32_t)parts;
    type->height = height + 1;
    return lay_out_kind(type);
}

const struct type *type_first_part(const struct type *type)
{
    while (type->kind == TYPE_STRUCTURE || type->kind == TYPE_FIXED_ARRAY) {
        if (type->n_members == 0 || (type->kind == TYPE_FIXED_ARRAY && type->count == 0)) {
            return NULL;
        }
        type = type->members[0];
    }
    return type;
}

static bool holds_integer(const struct type *type)
{
    const struct type *first = type_first_part(type);
    if (first == NULL) {
        return false;
    }
    if (first->kind == TYPE_PRIMITIVE) {
        return primitive_table[first->primitive].integer;
    }
    return first->kind == TYPE_ENUMERATION;
}

/*
 * An array that refers to itself is a slip, and refused.  Only where the next
 * field holds an integer it passes for a reference that was counted from 0: the
 * original accepts every reference, and its own test programs compare such
 * formats.  No value fits them.
 */
static bool is_tolerable_slip(const struct type *structure, uint32_t index)
{
    return index + 1 < structure->n_members && holds_integer(structure->members[index + 1]);
}

enum reference_fault type_check_reference(const struct type *structure, uint32_t index,
                                          int32_t reference)
{
    if (reference < 0 || (uint32_t)reference > structure->n_members) {
        return REFERENCE_OUTSIDE;
    }
    if (reference_index(reference) == index) {
        return is_tolerable_slip(structure, index) ? REFERENCE_FINE : REFERENCE_TO_ITSELF;
    }
    if (!holds_integer(structure->members[reference_index(reference)])) {
        return REFERENCE_NO_INTEGER;
    }
    return REFERENCE_FINE;
}
