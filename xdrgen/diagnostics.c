/*
 * Errors, warnings and notes about a specification.
 */
#include "diagnostics.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

enum {
    EXCERPT_WIDTH = 120, /* bytes of a line that are shown */
    EXCERPT_BEFORE = 60  /* of these in front of the mark, if the line is longer */
};

static const char *const severity_names[] = {"error", "warning", "note"};

void diagnostics_init(struct diagnostics *diagnostics)
{
    *diagnostics = (struct diagnostics){NULL, 0, 0};
}

void diagnostics_fini(struct diagnostics *diagnostics)
{
    for (size_t i = 0; i < diagnostics->count; i++) {
        free(diagnostics->items[i].classic);
        free(diagnostics->items[i].message);
    }
    free(diagnostics->items);
}

static char *format_message(const char *format, va_list arguments)
{
    va_list again;
    va_copy(again, arguments);
    const int length = vsnprintf(NULL, 0, format, arguments);
    const size_t size = length < 0 ? 1 : (size_t)length + 1;
    char *message = mem_new(size);
    (void)vsnprintf(message, size, format, again);
    va_end(again);
    return message;
}

static struct diagnostic *add(struct diagnostics *all, enum severity severity,
                              const struct place *place, size_t width)
{
    if ((all->count & (all->count - 1)) == 0) { /* full whenever a power of two is reached */
        all->items =
            mem_resize(all->items, all->count == 0 ? 1 : 2 * all->count, sizeof *all->items);
    }
    struct diagnostic *item = &all->items[all->count];
    *item = (struct diagnostic){.severity = severity,
                                .place = *place,
                                .width = width,
                                .number = all->count,
                                .anchor = place->offset};
    all->count++;
    return item;
}

void diagnostics_error(struct diagnostics *diagnostics, const struct place *place, size_t width,
                       const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    add(diagnostics, SEVERITY_ERROR, place, width)->message = format_message(format, arguments);
    va_end(arguments);
    diagnostics->n_errors++;
}

void diagnostics_warning(struct diagnostics *diagnostics, const struct place *place, size_t width,
                         const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    add(diagnostics, SEVERITY_WARNING, place, width)->message = format_message(format, arguments);
    va_end(arguments);
    diagnostics_same_as_classic(diagnostics);
}

void diagnostics_note(struct diagnostics *diagnostics, const struct place *place, size_t width,
                      const char *format, ...)
{
    const size_t anchor = diagnostics->items[diagnostics->count - 1].anchor;
    va_list arguments;
    va_start(arguments, format);
    struct diagnostic *note = add(diagnostics, SEVERITY_NOTE, place, width);
    note->message = format_message(format, arguments);
    note->anchor = anchor;
    va_end(arguments);
}

void diagnostics_classic(struct diagnostics *diagnostics, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    diagnostics->items[diagnostics->count - 1].classic = format_message(format, arguments);
    va_end(arguments);
}

void diagnostics_same_as_classic(struct diagnostics *diagnostics)
{
    const struct diagnostic *item = &diagnostics->items[diagnostics->count - 1];
    const char *prefix = item->severity == SEVERITY_WARNING ? "warning: " : "";
    diagnostics_classic(diagnostics, "%s%s", prefix, item->message);
}

static int compare(const void *left, const void *right)
{
    const struct diagnostic *a = left;
    const struct diagnostic *b = right;
    if (a->anchor != b->anchor) {
        return a->anchor < b->anchor ? -1 : 1;
    }
    return a->number < b->number ? -1 : a->number > b->number;
}

/* Says by which lines of which files the file of a place was included. */
static void print_trace(const struct source *source, const struct origin *origin, FILE *stream)
{
    const char *lead = "In file included";
    while (origin->includer != SOURCE_NOBODY) {
        const struct origin *includer = &source->origins[origin->includer];
        (void)fprintf(stream, "%s from %s:%zu%s\n", lead, includer->name, origin->includer_line,
                      includer->includer == SOURCE_NOBODY ? ":" : ",");
        lead = "                ";
        origin = includer;
    }
}

static bool is_printable(char c)
{
    return (unsigned char)c >= ' ' && c != 0x7f;
}

/* Shows the line of the input, shortened around the mark if it is long, and the mark below. */
static void print_excerpt(const struct diagnostic *item, const struct source *source, FILE *stream)
{
    struct text line = source_line(source, &item->place);
    size_t mark = item->place.column - 1;
    if (line.length > EXCERPT_WIDTH && mark > EXCERPT_BEFORE) {
        line.bytes += mark - EXCERPT_BEFORE;
        line.length -= mark - EXCERPT_BEFORE;
        mark = EXCERPT_BEFORE;
    }
    if (line.length > EXCERPT_WIDTH) {
        line.length = EXCERPT_WIDTH;
    }
    (void)fputs("    ", stream);
    for (size_t i = 0; i < line.length; i++) {
        (void)fputc(is_printable(line.bytes[i]) ? line.bytes[i] : ' ', stream);
    }
    (void)fprintf(stream, "\n    %*s^", (int)mark, "");
    for (size_t i = 1; i < item->width && mark + i < line.length; i++) {
        (void)fputc('~', stream);
    }
    (void)fputc('\n', stream);
}

static void print_one(const struct diagnostic *item, const struct source *source, FILE *stream)
{
    const struct origin *origin = source_origin(source, &item->place);
    const char *file = origin->name;
    if (item->severity != SEVERITY_NOTE) {
        print_trace(source, origin, stream);
    }
    if (item->classic != NULL) {
        (void)fprintf(stream, "%s:%zu: %s\n", file, item->place.line, item->classic);
    }
    (void)fprintf(stream, "%s:%zu:%zu: %s: %s\n", file, item->place.line, item->place.column,
                  severity_names[item->severity], item->message);
    print_excerpt(item, source, stream);
}

void diagnostics_print(struct diagnostics *diagnostics, const struct source *source, FILE *stream)
{
    if (diagnostics->count == 0) {
        return;
    }
    qsort(diagnostics->items, diagnostics->count, sizeof *diagnostics->items, compare);
    for (size_t i = 0; i < diagnostics->count; i++) {
        print_one(&diagnostics->items[i], source, stream);
    }
}
