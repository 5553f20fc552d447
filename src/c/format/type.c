/*
 * Nodes of the type tree: making, copying, comparing, freeing.
 *
 * Recursion is bounded by LIMIT_FORMAT_DEPTH, which whoever builds a tree keeps.
 */
#include "format/type.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

struct type *type_new(enum type_kind kind)
{
    struct type *type = mem_new(sizeof *type);
    type->kind = kind;
    return type;
}

struct type *type_new_primitive(enum primitive primitive)
{
    struct type *type = type_new(TYPE_PRIMITIVE);
    type->primitive = primitive;
    return type;
}

/* Room for one more element: lists have 1, 2, 4, 8, ... places. */
static void *make_room(void *list, uint32_t count, size_t size)
{
    if ((count & (count - 1)) != 0) {
        return list;
    }
    return mem_resize(list, count == 0 ? 1 : (size_t)count * 2, size);
}

void type_add_member(struct type *type, struct type *member)
{
    type->members = make_room(type->members, type->n_members, sizeof(struct type *));
    type->members[type->n_members++] = member;
}

void type_add_number(struct type *type, int32_t number)
{
    type->numbers = make_room(type->numbers, type->n_numbers, sizeof(int32_t));
    type->numbers[type->n_numbers++] = number;
}

void type_add_name(struct type *type, char *name)
{
    type->names = make_room(type->names, type->n_names, sizeof(char *));
    type->names[type->n_names++] = name;
}

void type_free(struct type *type)
{
    if (type == NULL) {
        return;
    }
    for (uint32_t i = 0; i < type->n_members; i++) {
        type_free(type->members[i]);
    }
    for (uint32_t i = 0; i < type->n_names; i++) {
        free(type->names[i]);
    }
    free(type->members);
    free(type->numbers);
    free(type->names);
    free(type);
}

struct type *type_copy(const struct type *type)
{
    struct type *copy = mem_new(sizeof *copy);
    *copy = *type;
    copy->n_members = copy->n_numbers = copy->n_names = 0;
    copy->members = NULL;
    copy->numbers = NULL;
    copy->names = NULL;
    for (uint32_t i = 0; i < type->n_members; i++) {
        type_add_member(copy, type_copy(type->members[i]));
    }
    for (uint32_t i = 0; i < type->n_numbers; i++) {
        type_add_number(copy, type->numbers[i]);
    }
    for (uint32_t i = 0; i < type->n_names; i++) {
        type_add_name(copy, mem_copy_string(type->names[i]));
    }
    return copy;
}

static bool same_lists(const struct type *a, const struct type *b)
{
    for (uint32_t i = 0; i < a->n_numbers; i++) {
        if (a->numbers[i] != b->numbers[i]) {
            return false;
        }
    }
    for (uint32_t i = 0; i < a->n_names; i++) {
        if (strcmp(a->names[i], b->names[i]) != 0) {
            return false;
        }
    }
    return true;
}

bool type_equal(const struct type *a, const struct type *b)
{
    if (a == b) {
        return true;
    }
    if (a->kind != b->kind || a->primitive != b->primitive || a->number != b->number ||
        a->n_members != b->n_members || a->n_numbers != b->n_numbers || a->n_names != b->n_names) {
        return false;
    }
    if (!same_lists(a, b)) {
        return false;
    }
    for (uint32_t i = 0; i < a->n_members; i++) {
        if (!type_equal(a->members[i], b->members[i])) {
            return false;
        }
    }
    return true;
}
