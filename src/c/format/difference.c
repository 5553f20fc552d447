/*
 * Where two formats differ first.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "format/format.h"
#include "format/handle.h"
#include "format/page.h"

static char *text_of(const struct type *type)
{
    struct buffer out;
    struct page page;
    if (type == NULL) {
        return mem_copy_string("nothing");
    }
    buffer_init(&out);
    page_begin_endless(&page, &out);
    page_type(&page, type, 0);
    char *text = mem_copy_text((const char *)out.bytes, out.length);
    buffer_fini(&out);
    return text;
}

static const struct type *member(const struct type *structure, uint32_t i)
{
    return i < structure->n_members ? structure->members[i] : NULL;
}

/* Whether the difference of two types lies in their only member. */
static bool lies_within(const struct type *a, const struct type *b)
{
    return a->kind == b->kind && a->n_members == 1 && b->n_members == 1 &&
           a->n_numbers == b->n_numbers &&
           (a->n_numbers == 0 ||
            memcmp(a->numbers, b->numbers, a->n_numbers * sizeof *a->numbers) == 0) &&
           a->members[0]->kind == TYPE_STRUCTURE && b->members[0]->kind == TYPE_STRUCTURE;
}

static void append_part(struct buffer *path, uint32_t i)
{
    char number[16];
    const int length =
        snprintf(number, sizeof number, path->length == 0 ? "%lu" : ".%lu", (unsigned long)i + 1);
    (void)buffer_append(path, number, (size_t)length); /* without memory the path is shorter */
}

/* Goes down to the first part that differs, and notes the way. */
static void descend(const struct type **a, const struct type **b, struct buffer *path)
{
    while (*a != NULL && *b != NULL) {
        if (lies_within(*a, *b)) {
            *a = (*a)->members[0];
            *b = (*b)->members[0];
        } else if ((*a)->kind == TYPE_STRUCTURE && (*b)->kind == TYPE_STRUCTURE) {
            uint32_t i = 0;
            while (i < (*a)->n_members && i < (*b)->n_members &&
                   type_equal((*a)->members[i], (*b)->members[i])) {
                i++;
            }
            append_part(path, i);
            *a = member(*a, i);
            *b = member(*b, i);
        } else {
            return;
        }
    }
}

bool format_difference(const struct format *a, const struct format *b,
                       struct format_difference *difference)
{
    struct buffer path;
    if (format_equal(a, b)) {
        return false;
    }
    const struct type *first = a == NULL ? NULL : a->type;
    const struct type *second = b == NULL ? NULL : b->type;
    buffer_init(&path);
    descend(&first, &second, &path);
    difference->part = mem_copy_text((const char *)path.bytes, path.length);
    difference->first = text_of(first);
    difference->second = text_of(second);
    buffer_fini(&path);
    return true;
}

void format_difference_fini(struct format_difference *difference)
{
    free(difference->part);
    free(difference->first);
    free(difference->second);
}
