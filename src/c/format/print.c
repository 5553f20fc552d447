/*
 * Printing values.
 *
 * A walk over the type, as names and structure are wanted.  It ends as soon as
 * the page is full, and every level of nesting writes something, so recursion is
 * bounded by the size of the page.
 */
#include "format/format.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "format/handle.h"
#include "format/page.h"
#include "format/walk.h"

struct printer {
    struct page page;
    int error;
};

/* The structure that a value is a member of. */
struct surroundings {
    const struct type *structure;
    const uint8_t *at;
};

static void print_value(struct printer *p, const struct type *type, const uint8_t *at,
                        const struct surroundings *around, unsigned keep);

/* The bytes of a number as an unsigned value, and as a signed one. */
static unsigned long long load_unsigned(const uint8_t *at, uint32_t size)
{
    uint16_t two;
    uint32_t four;
    uint64_t eight;
    switch (size) {
    case 1:
        return at[0];
    case 2:
        memcpy(&two, at, sizeof two);
        return two;
    case 4:
        memcpy(&four, at, sizeof four);
        return four;
    default:
        memcpy(&eight, at, sizeof eight);
        return eight;
    }
}

static long long load_signed(const uint8_t *at, uint32_t size)
{
    const struct dimension field = {.offset = 0, .size = (uint8_t)size, .is_signed = true};
    return dimension_read(&field, at);
}

static void print_unsigned(struct printer *p, const char *form, unsigned long long number,
                           unsigned keep)
{
    char digits[24];
    (void)snprintf(digits, sizeof digits, form, number);
    page_string(&p->page, digits, keep);
}

static void print_real(struct printer *p, double number, unsigned keep)
{
    char digits[400]; /* the largest double has 309 digits before the point */
    const char *sign = signbit(number) ? "-" : "";
    if (isnan(number)) {
        (void)snprintf(digits, sizeof digits, "%snan", sign);
    } else if (isinf(number)) {
        (void)snprintf(digits, sizeof digits, "%sinf", sign);
    } else {
        (void)snprintf(digits, sizeof digits, "%.2f", number);
    }
    page_string(&p->page, digits, keep);
}

static void print_text(struct printer *p, const char *text, unsigned keep)
{
    page_string(&p->page, "\"", keep);
    page_string_or_null(&p->page, text, keep);
    page_string(&p->page, "\"", keep);
}

static void print_format(struct printer *p, const struct format *format, unsigned keep)
{
    if (format == NULL) {
        page_string(&p->page, "NULLFormat", keep);
    } else if (format_is_bad(format)) {
        page_string(&p->page, "BadFormat", keep);
    } else {
        page_type(&p->page, format->type, keep);
    }
}

static void print_reference(struct printer *p, const struct format_reference *reference,
                            unsigned keep)
{
    if (reference == NULL) {
        page_string(&p->page, "NULL", keep);
        return;
    }
    page_string(&p->page, "[X_IPC_REF (", 5);
    page_number(&p->page, reference->number, 1);
    page_string(&p->page, ", ", 3);
    page_string_or_null(&p->page, reference->name, 10);
    page_string(&p->page, ")]", 5);
}

static void print_primitive(struct printer *p, const struct type *type, const uint8_t *at,
                            unsigned keep)
{
    float single;
    double number;
    switch (type->primitive) {
    case PRIMITIVE_CHAR:
        page_text(&p->page, (const char *)at, *at == 0 ? 0 : 1, keep);
        break;
    case PRIMITIVE_BYTE:
    case PRIMITIVE_UBYTE:
    case PRIMITIVE_TWOBYTE:
        print_unsigned(p, "%#llx", load_unsigned(at, type->size), keep);
        break;
    case PRIMITIVE_SHORT:
    case PRIMITIVE_INT:
    case PRIMITIVE_LONG:
        page_number(&p->page, load_signed(at, type->size), keep);
        break;
    case PRIMITIVE_USHORT:
    case PRIMITIVE_UINT:
    case PRIMITIVE_ULONG:
        print_unsigned(p, "%llu", load_unsigned(at, type->size), keep);
        break;
    case PRIMITIVE_BOOLEAN:
        page_string(&p->page, load_unsigned(at, type->size) != 0 ? "True" : "False", keep);
        break;
    case PRIMITIVE_FLOAT:
        memcpy(&single, at, sizeof single);
        print_real(p, (double)single, keep);
        break;
    case PRIMITIVE_DOUBLE:
        memcpy(&number, at, sizeof number);
        print_real(p, number, keep);
        break;
    case PRIMITIVE_STRING:
        print_text(p, (const char *)pointer_load(at), keep);
        break;
    case PRIMITIVE_FORMAT:
        print_format(p, (const void *)pointer_load(at), keep);
        break;
    case PRIMITIVE_REFERENCE:
        print_reference(p, (const void *)pointer_load(at), keep);
        break;
    case N_PRIMITIVES:
        break;
    }
}

static void print_raw(struct printer *p, const struct type *type, const uint8_t *at, unsigned keep)
{
    const uint32_t count = type->size;
    page_string(&p->page, "(", 10);
    for (uint32_t i = 0; i < count && !p->page.full; i++) {
        if (i > 0) {
            page_comma(&p->page);
        }
        print_unsigned(p, "%#llx", at[i], keep_of_part(i, count, keep));
    }
    page_string(&p->page, ")", keep);
}

static void print_enumeration(struct printer *p, const struct type *type, const uint8_t *at,
                              unsigned keep)
{
    const int32_t value = (int32_t)enumeration_load(at, type->size);
    if (value >= 0 && (uint32_t)value < type->n_names) {
        page_string(&p->page, type->names[value], keep);
    } else {
        page_number(&p->page, value, keep);
    }
}

static void print_structure(struct printer *p, const struct type *type, const uint8_t *at,
                            unsigned keep)
{
    const struct surroundings around = {.structure = type, .at = at};
    page_string(&p->page, "{", 10);
    for (uint32_t i = 0; i < type->n_members && !p->page.full; i++) {
        const struct type *member = type->members[i];
        if (i > 0) {
            page_comma(&p->page);
        }
        print_value(p, member, at + member->offset, &around,
                    keep_of_part(i, type->n_members, keep));
    }
    page_string(&p->page, "}", keep);
}

/* One array, or one row of it, whose first dimension is the first of n_dimensions. */
struct rows {
    const struct type *element;
    const int32_t *dimensions;
    uint32_t n_dimensions;
    const char *opening;
    const char *closing;
};

/* The size of one part of the rows: an element, or a row of the next dimension. */
static size_t part_size(const struct rows *rows)
{
    size_t size = rows->element->size;
    for (uint32_t i = 1; i < rows->n_dimensions; i++) {
        size *= (size_t)rows->dimensions[i];
    }
    return size;
}

static void print_rows(struct printer *p, const struct rows *rows, const uint8_t *at, unsigned keep)
{
    struct rows inner = *rows;
    inner.dimensions++;
    inner.n_dimensions--;
    const int32_t count = rows->dimensions[0];
    const size_t size = part_size(rows);
    page_string(&p->page, rows->opening, 10);
    for (int32_t i = 0; i < count && !p->page.full; i++) {
        const uint8_t *part = at + (size_t)i * size;
        const unsigned part_keep = keep_of_part((uint64_t)i, (uint64_t)count, keep);
        if (i > 0) {
            page_comma(&p->page);
        }
        if (inner.n_dimensions > 0) {
            print_rows(p, &inner, part, part_keep);
        } else {
            print_value(p, rows->element, part, NULL, part_keep);
        }
    }
    page_string(&p->page, rows->closing, keep);
}

static void print_fixed_array(struct printer *p, const struct type *type, const uint8_t *at,
                              unsigned keep)
{
    const struct rows rows = {.element = type->members[0],
                              .dimensions = type->numbers,
                              .n_dimensions = type->n_numbers,
                              .opening = "[",
                              .closing = "]"};
    print_rows(p, &rows, at, keep);
}

/* The dimensions of an array as its structure has them: false if they are impossible. */
static bool read_dimensions(const struct type *type, const struct surroundings *around,
                            int32_t *dimensions)
{
    uint64_t product = 1;
    bool empty = false;
    for (uint32_t i = 0; i < type->n_numbers; i++) {
        const struct type *field = around->structure->members[reference_index(type->numbers[i])];
        const struct dimension dimension = dimension_of(field, field->offset);
        const int64_t size = dimension_read(&dimension, around->at);
        if (size < 0) {
            return false;
        }
        empty = empty || size == 0;
        product = product > INT32_MAX || size > INT32_MAX ? UINT32_MAX : product * (uint64_t)size;
        dimensions[i] = size > INT32_MAX ? INT32_MAX : (int32_t)size;
    }
    return empty || product <= INT32_MAX;
}

static void print_variable_array(struct printer *p, const struct type *type, const uint8_t *at,
                                 const struct surroundings *around, unsigned keep)
{
    int32_t few[8];
    int32_t *dimensions = few;
    if (type->n_numbers > sizeof few / sizeof *few) {
        dimensions = malloc(type->n_numbers * sizeof *dimensions);
    }
    const uint8_t *elements = pointer_load(at);
    const struct rows rows = {.element = type->members[0],
                              .dimensions = dimensions,
                              .n_dimensions = type->n_numbers,
                              .opening = "<",
                              .closing = ">"};
    if (dimensions == NULL) {
        p->error = ERR_MEMORY;
    } else if (!read_dimensions(type, around, dimensions)) {
        p->error = ERR_RANGE;
    } else if (elements == NULL) {
        page_string(&p->page, "NULL", keep);
    } else {
        print_rows(p, &rows, elements, keep);
    }
    if (dimensions != few) {
        free(dimensions);
    }
}

static void print_pointer(struct printer *p, const struct type *target, const uint8_t *at,
                          unsigned keep)
{
    const uint8_t *pointer = pointer_load(at);
    if (pointer == NULL) {
        page_string(&p->page, "NULL", keep);
        return;
    }
    page_string(&p->page, "*", 10);
    print_value(p, target, pointer, NULL, keep);
}

static void print_value(struct printer *p, const struct type *type, const uint8_t *at,
                        const struct surroundings *around, unsigned keep)
{
    if (p->page.full || p->error != 0) {
        return;
    }
    switch (type->kind) {
    case TYPE_PRIMITIVE:
        print_primitive(p, type, at, keep);
        break;
    case TYPE_RAW:
        print_raw(p, type, at, keep);
        break;
    case TYPE_ENUMERATION:
        print_enumeration(p, type, at, keep);
        break;
    case TYPE_STRUCTURE:
        print_structure(p, type, at, keep);
        break;
    case TYPE_POINTER:
        print_pointer(p, type->members[0], at, keep);
        break;
    case TYPE_SELF:
        print_pointer(p, around->structure, at, keep);
        break;
    case TYPE_FIXED_ARRAY:
        print_fixed_array(p, type, at, keep);
        break;
    case TYPE_VARIABLE_ARRAY:
        print_variable_array(p, type, at, around, keep);
        break;
    }
}

int format_print(const struct format *format, const void *value, unsigned indent,
                 struct buffer *out)
{
    const size_t start = out->length;
    struct printer printer = {.error = 0};
    int error = format_check(format, value);
    if (error < 0) {
        return error;
    }
    static const uint8_t nothing = 0; /* a value of size 0 may be NULL */
    page_begin(&printer.page, out, indent);
    if (format == NULL) {
        page_string(&printer.page, "NULL", 0);
    } else {
        print_value(&printer, format->type, value == NULL ? &nothing : value, NULL, 0);
    }
    error = printer.error != 0 ? printer.error : printer.page.error;
    if (error == 0) {
        error = buffer_append(out, "\n", 1);
    }
    if (error != 0) {
        out->length = start;
    }
    return error;
}
