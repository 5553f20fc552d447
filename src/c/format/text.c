/*
 * The canonical text of formats.
 */
#include <stdlib.h>

#include "base/memory.h"
#include "format/format.h"
#include "format/handle.h"
#include "format/page.h"

static void write_numbers(struct page *page, const struct type *type, unsigned keep)
{
    for (uint32_t i = 0; i < type->n_numbers && !page->full; i++) {
        if (i > 0) {
            page_comma(page);
        }
        page_number(page, type->numbers[i], keep_of_part(i, type->n_numbers, keep));
    }
}

static void write_array(struct page *page, const struct type *type, const char *opening,
                        const char *closing, unsigned keep)
{
    page_string(page, opening, 10);
    page_type(page, type->members[0], keep);
    page_string(page, " : ", 10);
    write_numbers(page, type, keep);
    page_string(page, closing, keep);
}

static void write_structure(struct page *page, const struct type *type, unsigned keep)
{
    page_string(page, "{", 10);
    for (uint32_t i = 0; i < type->n_members && !page->full; i++) {
        if (i > 0) {
            page_comma(page);
        }
        page_type(page, type->members[i], keep_of_part(i, type->n_members, keep));
    }
    page_string(page, "}", keep);
}

static void write_enumeration(struct page *page, const struct type *type, unsigned keep)
{
    page_string(page, "{enum ", 10);
    for (uint32_t i = 0; i < type->n_names && !page->full; i++) {
        if (i > 0) {
            page_comma(page);
        }
        page_string(page, type->names[i], keep_of_part(i, type->n_names, keep));
    }
    if (type->n_names == 0) {
        page_string(page, ": ", keep);
        page_number(page, type->number, keep);
    }
    page_string(page, "}", keep);
}

void page_type(struct page *page, const struct type *type, unsigned keep)
{
    switch (type->kind) {
    case TYPE_PRIMITIVE:
        page_string(page, primitive_table[type->primitive].name, keep);
        break;
    case TYPE_RAW:
        page_number(page, type->number, keep);
        break;
    case TYPE_STRUCTURE:
        write_structure(page, type, keep);
        break;
    case TYPE_POINTER:
        page_string(page, "*", 10);
        page_type(page, type->members[0], keep);
        break;
    case TYPE_SELF:
        page_string(page, "*", 10);
        page_string(page, "!", keep);
        break;
    case TYPE_FIXED_ARRAY:
        write_array(page, type, "[", "]", keep);
        break;
    case TYPE_VARIABLE_ARRAY:
        write_array(page, type, "<", ">", keep);
        break;
    case TYPE_ENUMERATION:
        write_enumeration(page, type, keep);
        break;
    }
}

char *format_canonical(const struct format *format)
{
    if (format == NULL) {
        return mem_copy_string("NULLFormat");
    }
    if (format_is_bad(format)) {
        return mem_copy_string("BadFormat");
    }
    struct buffer out;
    struct page page;
    buffer_init(&out);
    page_begin_endless(&page, &out);
    page_type(&page, format->type, 0);
    char *text = mem_copy_text((const char *)out.bytes, out.length);
    buffer_fini(&out);
    return text;
}
