/*
 * What the scanner knows besides its tables: where it is, and whom it tells.
 */
#include "scan.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "base/memory.h"

void scan_init(struct scan *scan, struct source *source, struct diagnostics *diagnostics)
{
    *scan = (struct scan){.source = source, .diagnostics = diagnostics};
    scan->here = (struct place){1, 1, 0, 0};
}

void scan_advance(struct scan *scan, size_t length)
{
    scan->here.offset += length;
    scan->here.column += length;
}

void scan_newline(struct scan *scan)
{
    scan->here.line++;
    scan->here.column = 1;
}

/* ------------------------------------------------------------------ line markers */

struct marker {
    size_t line;
    struct text name; /* with its escapes; bytes NULL: none */
    bool enters;
    bool returns;
};

static size_t skip_blanks(const char *bytes, size_t length, size_t at)
{
    while (at < length && (bytes[at] == ' ' || bytes[at] == '\t')) {
        at++;
    }
    return at;
}

static size_t read_number(const char *bytes, size_t length, size_t at, size_t *number)
{
    const size_t start = at;
    while (at < length && bytes[at] >= '0' && bytes[at] <= '9') {
        at++;
    }
    *number = (size_t)text_number((struct text){bytes + start, at - start});
    return at;
}

static size_t read_name(const char *bytes, size_t length, size_t at, struct text *name)
{
    const size_t start = ++at;
    while (at < length && bytes[at] != '"') {
        at += bytes[at] == '\\' ? 2 : 1;
    }
    *name = (struct text){bytes + start, at - start};
    return at + 1;
}

/* Takes a marker apart, whose form the scanner has checked. */
static struct marker read_marker(const char *bytes, size_t length)
{
    struct marker marker = {0, {NULL, 0}, false, false};
    size_t at = 0;
    while (bytes[at] < '0' || bytes[at] > '9') {
        at++;
    }
    at = skip_blanks(bytes, length, read_number(bytes, length, at, &marker.line));
    if (at < length && bytes[at] == '"') {
        at = read_name(bytes, length, at, &marker.name);
    }
    for (at = skip_blanks(bytes, length, at); at < length && bytes[at] != '\r';
         at = skip_blanks(bytes, length, at)) {
        size_t flag;
        at = read_number(bytes, length, at, &flag);
        marker.enters = marker.enters || flag == 1;
        marker.returns = marker.returns || flag == 2;
    }
    return marker;
}

/* The name without a leading "./" and without escapes. */
static char *marker_name(struct text name)
{
    if (name.length > 2 && memcmp(name.bytes, "./", 2) == 0) {
        name.bytes += 2;
        name.length -= 2;
    }
    char *result = mem_new(name.length + 1);
    size_t length = 0;
    for (size_t i = 0; i < name.length; i++) {
        if (name.bytes[i] == '\\' && i + 1 < name.length) {
            i++;
        }
        result[length++] = name.bytes[i];
    }
    return result;
}

void scan_follow_marker(struct scan *scan, const struct place *place, const char *bytes,
                        size_t length)
{
    const struct marker marker = read_marker(bytes, length);
    const struct origin *origins = scan->source->origins;
    struct origin now = origins[scan->here.origin];
    if (marker.enters) {
        now = (struct origin){NULL, scan->here.origin, place->line};
    } else if (marker.returns && now.includer != SOURCE_NOBODY) {
        now = origins[now.includer];
    }
    if (marker.name.bytes != NULL) {
        scan->here.origin = source_add_origin(scan->source, marker_name(marker.name), now.includer,
                                              now.includer_line);
    }
    scan->here.line = marker.line - 1; /* the newline behind the marker adds the one */
}

/* ------------------------------------------------------------------ single bytes */

void scan_report_byte(struct scan *scan, const struct place *place, unsigned char byte)
{
    if (byte == 0) {
        diagnostics_error(scan->diagnostics, place, 1, "NUL character in input");
    } else if (byte > ' ' && byte < 0x7f) {
        diagnostics_error(scan->diagnostics, place, 1, "unexpected character `%c'", byte);
    } else {
        diagnostics_error(scan->diagnostics, place, 1, "unexpected character \\x%02x", byte);
    }
}

void scan_report_line(struct scan *scan, const struct place *place, const char *bytes)
{
    struct place at = *place;
    const size_t indent = skip_blanks(bytes, SIZE_MAX, 0);
    at.offset += indent;
    at.column += indent;
    scan_report_byte(scan, &at, (unsigned char)bytes[indent]);
    diagnostics_note(scan->diagnostics, &at, 1,
                     "lines for the C compiler stand in code sections: %%{ ... %%}");
}

/* ------------------------------------------------------- comments, code sections */

struct text scan_code_text(const struct scan *scan)
{
    const size_t start = scan->start.offset + 2;
    return (struct text){scan->source->bytes + start, scan->here.offset - 2 - start};
}

int scan_unterminated(struct scan *scan, struct place *place, const char *what)
{
    diagnostics_error(scan->diagnostics, &scan->start, 2, "unterminated %s", what);
    *place = scan->here;
    return 0;
}

/* ----------------------------------------------------------------------- strings */

static const char escape_letters[] = "ntvbrfa'\"\\";
static const char escape_values[] = "\n\t\v\b\r\f\a'\"\\";

static bool is_octal(char c)
{
    return c >= '0' && c <= '7';
}

/* The value of the escape behind a backslash and the bytes it takes there; 0 bytes: there is none.
 */
static size_t read_escape(const char *bytes, size_t length, unsigned char *value)
{
    const char *letter = length == 0 ? NULL : memchr(escape_letters, bytes[0], 10);
    if (letter != NULL) {
        *value = (unsigned char)escape_values[letter - escape_letters];
        return 1;
    }
    if (length < 3 || !is_octal(bytes[0]) || !is_octal(bytes[1]) || !is_octal(bytes[2])) {
        return 0;
    }
    *value = (unsigned char)((bytes[0] - '0') * 64 + (bytes[1] - '0') * 8 + (bytes[2] - '0'));
    return 3;
}

static void check_byte(struct scan *scan, const struct place *place, size_t width, unsigned char c)
{
    if (c == 0) {
        diagnostics_error(scan->diagnostics, place, width, "NUL character in input");
    } else if (c == '\n' || c == '\r') {
        diagnostics_error(scan->diagnostics, place, width, "line break in a format");
    }
}

void scan_check_string(struct scan *scan, const struct place *place, struct text string)
{
    for (size_t i = 1; i + 1 < string.length;) {
        struct place at = *place;
        at.offset += i;
        at.column += i;
        unsigned char value = (unsigned char)string.bytes[i];
        size_t width = 1;
        if (value == '\\') {
            width += read_escape(string.bytes + i + 1, string.length - i - 2, &value);
            if (width == 1) {
                diagnostics_error(scan->diagnostics, &at, 2, "unknown escape sequence in string");
            }
        }
        check_byte(scan, &at, width, value);
        i += width;
    }
}

char *scan_string_value(struct text string)
{
    char *value = mem_new(string.length);
    size_t length = 0;
    for (size_t i = 1; i + 1 < string.length; i++) {
        unsigned char c = (unsigned char)string.bytes[i];
        if (c == '\\') {
            i += read_escape(string.bytes + i + 1, string.length - i - 2, &c);
        }
        value[length++] = (char)c;
    }
    return value;
}
