/*
 * The page that values and formats are printed on.
 */
#include "format/page.h"

#include <stdio.h>
#include <string.h>

enum { LINE_WIDTH = 80, MOST_LINES = 5 };

static void put(struct page *page, const char *text, size_t length)
{
    int error = buffer_append(page->out, text, length);
    if (error != 0) {
        page->error = error;
    }
}

static void put_spaces(struct page *page, unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        put(page, " ", 1);
    }
    page->column += count;
}

static void begin(struct page *page, struct buffer *out, bool endless, unsigned indent)
{
    *page = (struct page){.out = out, .endless = endless, .indent = indent};
    put_spaces(page, indent);
}

void page_begin(struct page *page, struct buffer *out, unsigned indent)
{
    begin(page, out, false, indent);
}

void page_begin_endless(struct page *page, struct buffer *out)
{
    begin(page, out, true, 0);
}

static void break_line(struct page *page, unsigned indent)
{
    put(page, "\n", 1);
    page->line++;
    page->column = 0;
    put_spaces(page, indent);
}

/* Writes shown, which takes length columns as far as the end of the line is concerned. */
static void write_text(struct page *page, const char *shown, size_t n_shown, size_t length,
                       unsigned keep)
{
    if (page->full) {
        return;
    }
    if (!page->endless && page->column + length + keep > LINE_WIDTH) {
        break_line(page, page->indent + 1);
    }
    if (page->line >= MOST_LINES) {
        page->full = true;
        put(page, "...", 3);
        return;
    }
    put(page, shown, n_shown);
    page->column += n_shown;
}

void page_text(struct page *page, const char *text, size_t length, unsigned keep)
{
    write_text(page, text, length, length, keep);
}

void page_string(struct page *page, const char *text, unsigned keep)
{
    page_text(page, text, strlen(text), keep);
}

void page_string_or_null(struct page *page, const char *text, unsigned keep)
{
    if (text == NULL) {
        write_text(page, "NULL", 4, 0, keep);
    } else {
        page_string(page, text, keep);
    }
}

void page_number(struct page *page, long long number, unsigned keep)
{
    char digits[24];
    (void)snprintf(digits, sizeof digits, "%lld", number);
    page_string(page, digits, keep);
}

void page_comma(struct page *page)
{
    page_string(page, ",", 0);
    if (page->full) {
        return;
    }
    if (!page->endless && page->column == LINE_WIDTH) {
        break_line(page, page->indent);
    }
    put_spaces(page, 1);
}
