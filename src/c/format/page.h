/*
 * The page that values and formats are printed on.
 *
 * Lines have 80 columns and there are at most five of them; a text that does not
 * fit into the rest of its line goes whole to the next one, and what comes
 * behind the fifth line is left out with "...".  Indentation counts as columns.
 */
#ifndef IPC_FORMAT_PAGE_H
#define IPC_FORMAT_PAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/buffer.h"

struct type;

struct page {
    struct buffer *out;
    bool endless; /* one line without an end */
    unsigned indent;
    size_t column;
    unsigned line;
    bool full; /* nothing more is written but the end of the line */
    int error; /* ERR_MEMORY once memory was out */
};

/* Starts a page at the end of out. */
void page_begin(struct page *page, struct buffer *out, unsigned indent);

/* Starts a page of one endless line. */
void page_begin_endless(struct page *page, struct buffer *out);

/* Writes a text behind which keep more columns are wanted. */
void page_text(struct page *page, const char *text, size_t length, unsigned keep);
void page_string(struct page *page, const char *text, unsigned keep);

/* As page_string; NULL is written as NULL but taken for a text without length. */
void page_string_or_null(struct page *page, const char *text, unsigned keep);

/* A printed number. */
void page_number(struct page *page, long long number, unsigned keep);

/* A comma and a space. */
void page_comma(struct page *page);

/* The keep of part index of count: the last one leaves room for what closes the whole. */
static inline unsigned keep_of_part(uint64_t index, uint64_t count, unsigned keep)
{
    return index + 1 == count ? keep + 1 : 1;
}

/* Writes the canonical text of a type. */
void page_type(struct page *page, const struct type *type, unsigned keep);

#endif
