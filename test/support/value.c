/*
 * Values of any format, for tests.
 */
#include "value.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "format/handle.h"
#include "format/walk.h"

enum { PADDING = 0xee };

static void *new_block(size_t size)
{
    void *block = mem_new(size);
    memset(block, PADDING, size);
    return block;
}

static void fill(const struct type *type, const struct type *structure, const struct json *json,
                 uint8_t *at);

/* The bits of a number in the order of this host, from its value or its {"bits": ...}. */
static uint64_t bits_of_integer(const struct json *json)
{
    if (json->kind == JSON_BOOLEAN) {
        return json->truth ? 1 : 0;
    }
    if (json->text[0] == '-') {
        return (uint64_t)strtoll(json->text, NULL, 10);
    }
    return strtoull(json->text, NULL, 10);
}

static void fill_real(bool is_double, const struct json *json, uint8_t *at)
{
    const struct json *bits = json_find(json, "bits");
    const double number = json->real;
    const float single = (float)number;
    if (bits != NULL) {
        enumeration_store(at, 4, (uint32_t)strtoull(bits->text, NULL, 16));
    }
    if (bits != NULL && is_double) {
        const uint64_t image = strtoull(bits->text, NULL, 16);
        memcpy(at, &image, sizeof image);
    } else if (bits == NULL && is_double) {
        memcpy(at, &number, sizeof number);
    } else if (bits == NULL) {
        memcpy(at, &single, sizeof single);
    }
}

static void fill_primitive(const struct type *type, const struct json *json, uint8_t *at)
{
    if (type->primitive == PRIMITIVE_FLOAT || type->primitive == PRIMITIVE_DOUBLE) {
        fill_real(type->primitive == PRIMITIVE_DOUBLE, json, at);
    } else if (type->primitive == PRIMITIVE_STRING) {
        pointer_store(at, json->kind == JSON_NULL ? NULL : mem_copy_text(json->text, json->length));
    } else if (type->size == 8) {
        const uint64_t bits = bits_of_integer(json);
        memcpy(at, &bits, sizeof bits);
    } else {
        enumeration_store(at, type->size, (uint32_t)bits_of_integer(json));
    }
}

static void fill_fixed(const struct type *type, uint32_t dimension, const struct json *json,
                       uint8_t **at)
{
    for (size_t i = 0; i < json->length; i++) {
        if (dimension + 1 < type->n_numbers) {
            fill_fixed(type, dimension + 1, json->parts[i], at);
        } else {
            fill(type->members[0], NULL, json->parts[i], *at);
            *at += type->members[0]->size;
        }
    }
}

static void fill_variable(const struct type *type, const struct json *json, uint8_t *at)
{
    const struct type *element = type->members[0];
    if (json->kind == JSON_NULL) {
        pointer_store(at, NULL);
        return;
    }
    uint8_t *block = new_block(json->length * element->size);
    pointer_store(at, block);
    for (size_t i = 0; i < json->length; i++) {
        fill(element, NULL, json->parts[i], block + i * element->size);
    }
}

static void fill_pointer(const struct type *target, const struct json *json, uint8_t *at)
{
    if (json->kind == JSON_NULL) {
        pointer_store(at, NULL);
        return;
    }
    uint8_t *block = new_block(target->size);
    pointer_store(at, block);
    fill(target, NULL, json_get(json, "ptr"), block);
}

static void fill(const struct type *type, const struct type *structure, const struct json *json,
                 uint8_t *at)
{
    size_t length;
    uint8_t *bytes;
    switch (type->kind) {
    case TYPE_PRIMITIVE:
        fill_primitive(type, json, at);
        break;
    case TYPE_RAW:
        bytes = json_bytes(json, &length);
        memcpy(at, bytes, length);
        free(bytes);
        break;
    case TYPE_ENUMERATION:
        enumeration_store(at, type->size, (uint32_t)bits_of_integer(json));
        break;
    case TYPE_STRUCTURE:
        for (uint32_t i = 0; i < type->n_members; i++) {
            fill(type->members[i], type, json->parts[i], at + type->members[i]->offset);
        }
        break;
    case TYPE_POINTER:
        fill_pointer(type->members[0], json, at);
        break;
    case TYPE_SELF:
        fill_pointer(structure, json, at);
        break;
    case TYPE_FIXED_ARRAY:
        fill_fixed(type, 0, json, &at);
        break;
    case TYPE_VARIABLE_ARRAY:
        fill_variable(type, json, at);
        break;
    }
}

void *value_build(const struct format *format, const struct json *json)
{
    void *value = new_block(format->type->size);
    fill(format->type, NULL, json, value);
    return value;
}

void value_free(const struct format *format, void *value)
{
    if (value != NULL) {
        (void)format_release(format, value);
    }
    free(value);
}

/* ------------------------------------------------------------ large values */

/* The generator of the vector files: one number per step. */
static uint32_t step(uint32_t *state)
{
    *state = (*state * 1103515245u + 12345u) & 0x7fffffffu;
    return *state >> 8;
}

/* {count, <element : 1>} as it lies in memory. */
struct counted {
    int count;
    void *elements;
};

static void *counted_value(int count, size_t size, uint8_t **elements)
{
    struct counted *value = new_block(sizeof *value);
    value->count = count;
    value->elements = *elements = new_block((size_t)count * size);
    return value;
}

static void *generate_bytes(uint32_t *state)
{
    uint8_t *elements;
    void *value = counted_value(1000000, 1, &elements);
    for (int i = 0; i < 1000000; i++) {
        elements[i] = (uint8_t)((step(state) & 255) - 128);
    }
    return value;
}

static void *generate_doubles(uint32_t *state)
{
    uint8_t *elements;
    void *value = counted_value(100000, sizeof(double), &elements);
    for (size_t i = 0; i < 100000; i++) {
        const double number = step(state) / 1024.0;
        memcpy(elements + i * sizeof number, &number, sizeof number);
    }
    return value;
}

static void *generate_padded(uint32_t *state)
{
    struct padded {
        char c;
        int i;
        short s;
    };
    uint8_t *elements;
    void *value = counted_value(20000, sizeof(struct padded), &elements);
    for (size_t i = 0; i < 20000; i++) {
        const uint32_t r = step(state);
        const struct padded one = {(char)(r & 127), (int)r, (short)((r >> 3) & 32767)};
        uint8_t *at = elements + i * sizeof one;
        memcpy(at + offsetof(struct padded, c), &one.c, sizeof one.c);
        memcpy(at + offsetof(struct padded, i), &one.i, sizeof one.i);
        memcpy(at + offsetof(struct padded, s), &one.s, sizeof one.s);
    }
    return value;
}

static void *generate_strings(uint32_t *state)
{
    uint8_t *elements;
    void *value = counted_value(5000, sizeof(char *), &elements);
    for (size_t i = 0; i < 5000; i++) {
        const uint32_t r = step(state);
        char letters[40] = "";
        for (uint32_t k = 0; k < r % 37 + 1; k++) {
            letters[k] = (char)(97 + (r + k) % 26);
        }
        pointer_store(elements + i * sizeof(char *),
                      r % 10 == 0 ? NULL : mem_copy_text(letters, r % 37 + 1));
    }
    return value;
}

static void *generate_image(uint32_t *state)
{
    uint8_t *value = new_block(480 * 640);
    for (size_t i = 0; i < 480 * 640; i++) {
        value[i] = (uint8_t)step(state);
    }
    return value;
}

static void *generate_list(uint32_t *state)
{
    struct node {
        int number;
        struct node *next;
    };
    struct node *first = NULL;
    struct node **link = &first;
    for (int i = 0; i < 10000; i++) {
        struct node *node = new_block(sizeof *node);
        node->number = (int)step(state);
        *link = node;
        link = &node->next;
    }
    *link = NULL;
    return first;
}

void *value_generate(const struct format *format, const char *generator)
{
    static const struct {
        const char *name;
        void *(*generate)(uint32_t *state);
    } generators[] = {{"LCG_i8", generate_bytes},    {"LCG_f64", generate_doubles},
                      {"LCG_cis", generate_padded},  {"LCG_str", generate_strings},
                      {"LCG_u8_2d", generate_image}, {"LIST_10k", generate_list}};
    uint32_t state = 1;
    (void)format;
    for (size_t i = 0; i < sizeof generators / sizeof *generators; i++) {
        if (strcmp(generators[i].name, generator) == 0) {
            return generators[i].generate(&state);
        }
    }
    return NULL;
}

/* -------------------------------------------------------------- comparison */

static bool same(const struct type *type, const struct type *structure, const uint8_t *a,
                 const uint8_t *b);

static bool same_elements(const struct type *element, uint64_t count, const uint8_t *a,
                          const uint8_t *b)
{
    for (uint64_t i = 0; i < count; i++) {
        if (!same(element, NULL, a + i * element->size, b + i * element->size)) {
            return false;
        }
    }
    return true;
}

static bool same_strings(const uint8_t *a, const uint8_t *b)
{
    const char *first = (const char *)pointer_load(a);
    const char *second = (const char *)pointer_load(b);
    if (first == NULL || second == NULL) {
        return first == second;
    }
    return strcmp(first, second) == 0;
}

/* Whether two structures agree; a list is compared node by node without recursion. */
static bool same_structure(const struct type *type, const uint8_t *a, const uint8_t *b)
{
    for (;;) {
        const struct type *last = type->n_members == 0 ? NULL : type->members[type->n_members - 1];
        for (uint32_t i = 0; i < type->n_members; i++) {
            const struct type *member = type->members[i];
            if (member == last && member->kind == TYPE_SELF) {
                break;
            }
            const uint8_t *first = a + member->offset, *second = b + member->offset;
            if (member->kind != TYPE_VARIABLE_ARRAY) {
                if (!same(member, type, first, second)) {
                    return false;
                }
                continue;
            }
            uint64_t count = 1;
            for (uint32_t k = 0; k < member->n_numbers; k++) {
                const struct type *field = type->members[reference_index(member->numbers[k])];
                const struct dimension dimension = dimension_of(field, field->offset);
                count *= (uint64_t)dimension_read(&dimension, a);
            }
            const uint8_t *one = pointer_load(first), *other = pointer_load(second);
            if ((one == NULL) != (other == NULL)) {
                return false;
            }
            if (one != NULL && !same_elements(member->members[0], count, one, other)) {
                return false;
            }
        }
        if (last == NULL || last->kind != TYPE_SELF) {
            return true;
        }
        a = pointer_load(a + last->offset);
        b = pointer_load(b + last->offset);
        if (a == NULL || b == NULL) {
            return a == b;
        }
    }
}

static bool same_targets(const struct type *target, const uint8_t *a, const uint8_t *b)
{
    const uint8_t *first = pointer_load(a), *second = pointer_load(b);
    if (first == NULL || second == NULL) {
        return first == second;
    }
    return same(target, NULL, first, second);
}

static bool same(const struct type *type, const struct type *structure, const uint8_t *a,
                 const uint8_t *b)
{
    switch (type->kind) {
    case TYPE_PRIMITIVE:
        return type->primitive == PRIMITIVE_STRING ? same_strings(a, b)
                                                   : memcmp(a, b, type->size) == 0;
    case TYPE_RAW:
    case TYPE_ENUMERATION:
        return memcmp(a, b, type->size) == 0;
    case TYPE_STRUCTURE:
        return same_structure(type, a, b);
    case TYPE_POINTER:
        return same_targets(type->members[0], a, b);
    case TYPE_SELF:
        return same_targets(structure, a, b);
    case TYPE_FIXED_ARRAY:
        return same_elements(type->members[0], type->count, a, b);
    case TYPE_VARIABLE_ARRAY:
        break; /* structures compare their own */
    }
    return false;
}

bool value_same(const struct format *format, const void *a, const void *b)
{
    return format->type->size == 0 || same(format->type, NULL, a, b);
}
