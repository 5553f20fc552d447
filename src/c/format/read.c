/*
 * Reading values: the inverse of printing.
 *
 * A walk over the type, one piece of the printed value after the other.  The
 * lengths of arrays come from the text and are compared with the dimensions at
 * the end of the structure, when those have been read too.
 */
#include "format/format.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "format/counts.h"
#include "format/handle.h"
#include "format/release.h"
#include "format/scanner.h"
#include "format/walk.h"

/* Values are read by recursion; what is printed is never nested nearly as deep as this. */
enum { MOST_LEVELS = 1000 };

struct value_reader {
    struct scanner scanner;
    struct buffer word;
    unsigned levels;
    struct counts arrays; /* lengths of the arrays that may hold pointers, in order */
    struct counts shapes; /* dimensions that the arrays of the open structures have in the text */
};

static int read_value(struct value_reader *r, const struct type *type, const struct type *structure,
                      uint8_t *at);

static const char *word_of(const struct value_reader *r)
{
    return (const char *)r->word.bytes;
}

/* Reads a decimal or hexadecimal number within bounds; the upper one is of an unsigned type. */
static int read_number(struct value_reader *r, int64_t least, uint64_t most, uint64_t *number)
{
    int error = scanner_word(&r->scanner, &r->word);
    if (error != 0) {
        return error;
    }
    const char *digits = word_of(r);
    const bool negative = *digits == '-';
    if (*digits == '-' || *digits == '+') {
        digits++;
    }
    const int base = digits[0] == '0' && (digits[1] == 'x' || digits[1] == 'X') ? 16 : 10;
    if (*digits < '0' || *digits > '9') { /* strtoull would take a second sign */
        return ERR_CONTENT;
    }
    char *end;
    errno = 0;
    const unsigned long long magnitude = strtoull(digits, &end, base);
    if (errno != 0 || *end != '\0') {
        return ERR_CONTENT;
    }
    if (!negative && magnitude > most) {
        return ERR_CONTENT;
    }
    if (negative && magnitude > (least == 0 ? 0 : (uint64_t) - (least + 1) + 1)) {
        return ERR_CONTENT;
    }
    *number = negative ? 0 - (uint64_t)magnitude : magnitude;
    return 0;
}

static void store_number(uint8_t *at, uint32_t size, uint64_t number)
{
    const uint8_t one = (uint8_t)number;
    const uint16_t two = (uint16_t)number;
    const uint32_t four = (uint32_t)number;
    switch (size) {
    case 1:
        memcpy(at, &one, sizeof one);
        break;
    case 2:
        memcpy(at, &two, sizeof two);
        break;
    case 4:
        memcpy(at, &four, sizeof four);
        break;
    default:
        memcpy(at, &number, sizeof number);
    }
}

static int read_integer(struct value_reader *r, const struct type *type, uint8_t *at)
{
    const struct primitive_info *info = &primitive_table[type->primitive];
    const unsigned bits = info->size * 8;
    uint64_t most = UINT64_MAX >> (64 - bits);
    int64_t least = 0;
    if (info->is_signed) {
        least = -(int64_t)(most >> 1) - 1;
        if (type->primitive != PRIMITIVE_BYTE) { /* which is printed as its bit pattern */
            most >>= 1;
        }
    }
    uint64_t number;
    int error = read_number(r, least, most, &number);
    if (error == 0) {
        store_number(at, info->size, number);
    }
    return error;
}

/* Whether the word is the text, whatever the case of its letters. */
static bool same_word(const char *word, const char *text)
{
    for (; *word != '\0' && *text != '\0'; word++, text++) {
        if ((*word | 0x20) != (*text | 0x20)) {
            return false;
        }
    }
    return *word == *text;
}

static int read_boolean(struct value_reader *r, const struct type *type, uint8_t *at)
{
    const int first = scanner_peek(&r->scanner) | 0x20;
    if (first != 't' && first != 'f') {
        return read_integer(r, type, at);
    }
    int error = scanner_word(&r->scanner, &r->word);
    if (error != 0) {
        return error;
    }
    const bool truth = same_word(word_of(r), "true");
    if (!truth && !same_word(word_of(r), "false")) {
        return ERR_CONTENT;
    }
    store_number(at, type->size, truth ? 1 : 0);
    return 0;
}

static int read_real(struct value_reader *r, const struct type *type, uint8_t *at)
{
    int error = scanner_word(&r->scanner, &r->word);
    if (error != 0) {
        return error;
    }
    char *end;
    const double number = strtod(word_of(r), &end);
    if (*end != '\0') {
        return ERR_CONTENT;
    }
    if (type->primitive == PRIMITIVE_FLOAT) {
        const float single = (float)number;
        memcpy(at, &single, sizeof single);
    } else {
        memcpy(at, &number, sizeof number);
    }
    return 0;
}

/* Consumes the word NULL. */
static int read_null(struct value_reader *r)
{
    int error = scanner_word(&r->scanner, &r->word);
    if (error == 0 && strcmp(word_of(r), "NULL") != 0) {
        error = ERR_CONTENT;
    }
    return error;
}

static int read_string(struct value_reader *r, uint8_t *at)
{
    if (scanner_peek(&r->scanner) != '"') {
        return read_null(r);
    }
    int error = scanner_text(&r->scanner, &r->word);
    if (error != 0) {
        return error;
    }
    char *text = malloc(r->word.length);
    if (text == NULL) {
        return ERR_MEMORY;
    }
    memcpy(text, r->word.bytes, r->word.length);
    pointer_store(at, text);
    return 0;
}

static int read_primitive(struct value_reader *r, const struct type *type, uint8_t *at)
{
    switch (type->primitive) {
    case PRIMITIVE_CHAR:
        return scanner_character(&r->scanner, at);
    case PRIMITIVE_BOOLEAN:
        return read_boolean(r, type, at);
    case PRIMITIVE_FLOAT:
    case PRIMITIVE_DOUBLE:
        return read_real(r, type, at);
    case PRIMITIVE_STRING:
        return read_string(r, at);
    case PRIMITIVE_FORMAT:
    case PRIMITIVE_REFERENCE:
        return ERR_FORMAT; /* internal to the library: not for reading */
    default:
        return read_integer(r, type, at);
    }
}

static int read_raw(struct value_reader *r, const struct type *type, uint8_t *at)
{
    if (!scanner_skip(&r->scanner, '(')) {
        return ERR_CONTENT;
    }
    for (uint32_t i = 0; i < type->size; i++) {
        uint64_t number;
        if (i > 0 && !scanner_skip(&r->scanner, ',')) {
            return ERR_CONTENT;
        }
        int error = read_number(r, -128, 255, &number);
        if (error != 0) {
            return error;
        }
        at[i] = (uint8_t)number;
    }
    return scanner_skip(&r->scanner, ')') ? 0 : ERR_CONTENT;
}

static int read_enumeration(struct value_reader *r, const struct type *type, uint8_t *at)
{
    const int first = scanner_peek(&r->scanner);
    uint64_t number = 0;
    int error;
    if (first == '-' || first == '+' || (first >= '0' && first <= '9')) {
        error = read_number(r, INT32_MIN, INT32_MAX, &number);
    } else {
        error = scanner_word(&r->scanner, &r->word);
        while (error == 0 && number < type->n_names &&
               strcmp(type->names[number], word_of(r)) != 0) {
            number++;
        }
        if (error == 0 && number == type->n_names) {
            error = ERR_CONTENT;
        }
    }
    if (error == 0) {
        enumeration_store(at, type->size, (uint32_t)number);
    }
    return error;
}

/* ------------------------------------------------------------------ arrays */

static int read_fixed_rows(struct value_reader *r, const struct type *type, uint32_t dimension,
                           uint8_t **at)
{
    const struct type *element = type->members[0];
    if (!scanner_skip(&r->scanner, '[')) {
        return ERR_CONTENT;
    }
    for (int32_t i = 0; i < type->numbers[dimension]; i++) {
        if (i > 0 && !scanner_skip(&r->scanner, ',')) {
            return ERR_CONTENT;
        }
        int error;
        if (dimension + 1 < type->n_numbers) {
            error = read_fixed_rows(r, type, dimension + 1, at);
        } else {
            error = read_value(r, element, NULL, *at);
            *at += element->size;
        }
        if (error != 0) {
            return error;
        }
    }
    return scanner_skip(&r->scanner, ']') ? 0 : ERR_CONTENT;
}

/* An array that grows while it is read. */
struct growing {
    const struct type *type;
    uint8_t *field;  /* the pointer in the structure */
    uint32_t count;  /* elements, the one that is being read included */
    size_t capacity; /* elements */
    size_t slot;     /* of its length in the reader's arrays */
    size_t shape;    /* of its first dimension in the reader's shapes */
};

/* Room for more elements, zeroed. */
static int enlarge(struct value_reader *r, struct growing *array)
{
    const size_t size = array->type->members[0]->size;
    const size_t capacity = array->capacity == 0 ? 4 : array->capacity * 2;
    if ((uint64_t)capacity * size > INT32_MAX) {
        return ERR_CONTENT;
    }
    const bool first = array->capacity == 0;
    if (first && counts_reserve(&r->arrays) != 0) {
        return ERR_MEMORY;
    }
    uint8_t *block = realloc(pointer_load(array->field), size == 0 ? 1 : capacity * size);
    if (block == NULL) {
        return ERR_MEMORY;
    }
    memset(block + array->capacity * size, 0, (capacity - array->capacity) * size);
    pointer_store(array->field, block);
    if (first && !array->type->members[0]->flat) {
        array->slot = r->arrays.length;
        counts_push(&r->arrays, 0);
    }
    array->capacity = capacity;
    return 0;
}

static int read_element(struct value_reader *r, struct growing *array)
{
    const struct type *element = array->type->members[0];
    if (array->count == array->capacity) {
        int error = enlarge(r, array);
        if (error != 0) {
            return error;
        }
    }
    array->count++;
    if (!element->flat) {
        r->arrays.items[array->slot] = array->count;
    }
    uint8_t *block = pointer_load(array->field);
    return read_value(r, element, NULL, block + (size_t)(array->count - 1) * element->size);
}

static int read_rows(struct value_reader *r, struct growing *array, uint32_t dimension)
{
    if (!scanner_skip(&r->scanner, '<')) {
        return ERR_CONTENT;
    }
    uint32_t n = 0;
    if (scanner_peek(&r->scanner) != '>') {
        do {
            int error = dimension + 1 < array->type->n_numbers ? read_rows(r, array, dimension + 1)
                                                               : read_element(r, array);
            if (error != 0) {
                return error;
            }
            n++;
        } while (scanner_skip(&r->scanner, ','));
    }
    if (!scanner_skip(&r->scanner, '>')) {
        return ERR_CONTENT;
    }
    uint32_t *shape = &r->shapes.items[array->shape + dimension];
    if (*shape != UINT32_MAX && *shape != n) {
        return ERR_CONTENT; /* rows of different lengths */
    }
    *shape = n;
    return 0;
}

static int read_variable_array(struct value_reader *r, const struct type *type, uint8_t *at)
{
    struct growing array = {.type = type, .field = at, .shape = r->shapes.length};
    for (uint32_t i = 0; i < type->n_numbers; i++) {
        if (counts_reserve(&r->shapes) != 0) {
            return ERR_MEMORY;
        }
        counts_push(&r->shapes, UINT32_MAX); /* not known yet */
    }
    if (scanner_peek(&r->scanner) != '<') {
        r->shapes.items[array.shape] = 0;
        return read_null(r);
    }
    return read_rows(r, &array, 0);
}

/* Compares the shape of an array with its dimensions. */
static bool shape_fits(const struct type *structure, const uint8_t *at, const struct type *array,
                       const uint32_t *shape)
{
    bool is_empty = false, should_be_empty = false, same = true;
    for (uint32_t i = 0; i < array->n_numbers; i++) {
        const struct type *field = structure->members[reference_index(array->numbers[i])];
        const struct dimension dimension = dimension_of(field, field->offset);
        const int64_t size = dimension_read(&dimension, at);
        if (size < 0) {
            return false;
        }
        should_be_empty = should_be_empty || size == 0;
        is_empty = is_empty || shape[i] == 0;
        same = same && size == (int64_t)shape[i];
    }
    return is_empty || should_be_empty ? is_empty && should_be_empty : same;
}

/* -------------------------------------------------------- structures, pointers */

static int read_structure(struct value_reader *r, const struct type *type, uint8_t *at)
{
    const size_t first_shape = r->shapes.length;
    if (!scanner_skip(&r->scanner, '{')) {
        return ERR_CONTENT;
    }
    for (uint32_t i = 0; i < type->n_members; i++) {
        const struct type *member = type->members[i];
        if (i > 0 && !scanner_skip(&r->scanner, ',')) {
            return ERR_CONTENT;
        }
        int error = read_value(r, member, type, at + member->offset);
        if (error != 0) {
            return error;
        }
    }
    if (!scanner_skip(&r->scanner, '}')) {
        return ERR_CONTENT;
    }
    size_t shape = first_shape;
    for (uint32_t i = 0; i < type->n_members; i++) {
        const struct type *member = type->members[i];
        if (member->kind != TYPE_VARIABLE_ARRAY) {
            continue;
        }
        if (!shape_fits(type, at, member, &r->shapes.items[shape])) {
            return ERR_CONTENT;
        }
        shape += member->n_numbers;
    }
    r->shapes.length = first_shape;
    return 0;
}

static int read_pointer(struct value_reader *r, const struct type *target, uint8_t *at)
{
    if (!scanner_skip(&r->scanner, '*')) {
        return read_null(r);
    }
    uint8_t *block = calloc(1, target->size > 0 ? target->size : 1);
    if (block == NULL) {
        return ERR_MEMORY;
    }
    pointer_store(at, block);
    return read_value(r, target, NULL, block);
}

static int read_kind(struct value_reader *r, const struct type *type, const struct type *structure,
                     uint8_t *at)
{
    switch (type->kind) {
    case TYPE_PRIMITIVE:
        return read_primitive(r, type, at);
    case TYPE_RAW:
        return read_raw(r, type, at);
    case TYPE_ENUMERATION:
        return read_enumeration(r, type, at);
    case TYPE_STRUCTURE:
        return read_structure(r, type, at);
    case TYPE_POINTER:
        return read_pointer(r, type->members[0], at);
    case TYPE_SELF:
        return read_pointer(r, structure, at);
    case TYPE_FIXED_ARRAY:
        return read_fixed_rows(r, type, 0, &at);
    case TYPE_VARIABLE_ARRAY:
        break;
    }
    return read_variable_array(r, type, at);
}

static int read_value(struct value_reader *r, const struct type *type, const struct type *structure,
                      uint8_t *at)
{
    if (r->levels >= MOST_LEVELS) {
        return ERR_CONTENT;
    }
    r->levels++;
    int error = read_kind(r, type, structure, at);
    r->levels--;
    return error;
}

/* Frees what a failed reading left, and the value's bytes are zero again. */
static void undo(struct value_reader *r, const struct format *format, void *value)
{
    struct frame_stack stack;
    frame_stack_init(&stack);
    release_partial(format, value, &r->arrays, &stack);
    frame_stack_fini(&stack);
    memset(value, 0, format->type->size);
}

int format_read(const struct format *format, FILE *stream, void *value)
{
    int error = format_check(format, value);
    if (error < 0) {
        return error;
    }
    if (format == NULL) {
        return 0;
    }
    uint8_t nothing = 0; /* a value of size 0 may be NULL */
    if (value == NULL) {
        value = &nothing;
    }
    memset(value, 0, format->type->size);
    struct value_reader reader = {.levels = 0};
    scanner_begin(&reader.scanner, stream);
    buffer_init(&reader.word);
    counts_init(&reader.arrays);
    counts_init(&reader.shapes);
    error = read_value(&reader, format->type, NULL, value);
    if (error != 0) {
        undo(&reader, format, value);
    }
    scanner_end(&reader.scanner);
    counts_fini(&reader.shapes);
    counts_fini(&reader.arrays);
    buffer_fini(&reader.word);
    return error;
}
