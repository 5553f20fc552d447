/*
 * What is said about a string that is not, or not quite, a format.
 */
#include "format/diagnosis.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

/* Joins the pieces and n_spaces spaces behind them. */
static char *join(const char *const *pieces, size_t n_pieces, size_t n_spaces)
{
    size_t length = n_spaces;
    for (size_t i = 0; i < n_pieces; i++) {
        length += strlen(pieces[i]);
    }
    char *text = mem_new(length + 1);
    char *at = text;
    for (size_t i = 0; i < n_pieces; i++) {
        size_t piece = strlen(pieces[i]);
        memcpy(at, pieces[i], piece);
        at += piece;
    }
    memset(at, ' ', n_spaces);
    return text;
}

static void set(struct format_diagnosis *diagnosis, char *text, size_t position)
{
    free(diagnosis->text);
    diagnosis->text = text;
    diagnosis->position = position;
}

/* Message, string, and a caret under position. */
static void point_at(struct format_diagnosis *diagnosis, const char *before, const char *what,
                     const char *after, const char *string, size_t position)
{
    if (diagnosis == NULL) {
        return;
    }
    const char *const lines[] = {before, what, after, "\n", string, "\n"};
    char *spaces = join(lines, sizeof lines / sizeof *lines, position);
    const char *const all[] = {spaces, "^\n"};
    set(diagnosis, join(all, 2, 0), position);
    free(spaces);
}

void diagnose_expected(struct format_diagnosis *diagnosis, const char *what, const char *string,
                       size_t position)
{
    point_at(diagnosis, "Format Parsing Error: Expected ", what, ".", string, position);
}

void diagnose_extra_text(struct format_diagnosis *diagnosis, const char *string, size_t position)
{
    point_at(diagnosis, "Warning: Extra text after the format is ignored.", "", "", string,
             position);
}

void diagnose_name(struct format_diagnosis *diagnosis, const char *name, const char *fault,
                   const char *string, size_t position)
{
    if (diagnosis == NULL) {
        return;
    }
    const char *const lines[] = {"Warning: Named Format ", name, " ", fault, "\n", string, "\n"};
    set(diagnosis, join(lines, sizeof lines / sizeof *lines, 0), position);
}

void diagnose_silently(struct format_diagnosis *diagnosis, size_t position)
{
    if (diagnosis != NULL) {
        set(diagnosis, NULL, position);
    }
}
