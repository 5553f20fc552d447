/*
 * The pieces of printed values, read from a stream.
 */
#include "format/scanner.h"

#include <ctype.h>
#include <string.h>

#include "base/error.h"
#include "base/limits.h"

void scanner_begin(struct scanner *scanner, FILE *stream)
{
    scanner->stream = stream;
    scanner->n_ahead = 0;
}

void scanner_end(struct scanner *scanner)
{
    if (scanner->n_ahead > 0 && scanner->ahead[0] != EOF) {
        (void)ungetc(scanner->ahead[0], scanner->stream);
    }
    scanner->n_ahead = 0;
}

/* The character at distance behind the next one. */
static int look(struct scanner *scanner, int distance)
{
    while (scanner->n_ahead <= distance) {
        scanner->ahead[scanner->n_ahead++] = getc(scanner->stream);
    }
    return scanner->ahead[distance];
}

static int take(struct scanner *scanner)
{
    const int c = look(scanner, 0);
    scanner->n_ahead--;
    memmove(scanner->ahead, scanner->ahead + 1, (size_t)scanner->n_ahead * sizeof(int));
    return c;
}

static bool is_space(int c)
{
    return c != EOF && isspace(c) != 0;
}

static bool is_delimiter(int c)
{
    return c == EOF || is_space(c) || c == ',' || c == '}' || c == ']' || c == '>' || c == ')';
}

int scanner_peek(struct scanner *scanner)
{
    while (is_space(look(scanner, 0))) {
        (void)take(scanner);
    }
    return look(scanner, 0);
}

bool scanner_skip(struct scanner *scanner, char mark)
{
    if (scanner_peek(scanner) != (unsigned char)mark) {
        return false;
    }
    (void)take(scanner);
    return true;
}

static int append(struct buffer *buffer, int c)
{
    const uint8_t byte = (uint8_t)c;
    return buffer_append(buffer, &byte, 1);
}

int scanner_word(struct scanner *scanner, struct buffer *word)
{
    buffer_clear(word);
    (void)scanner_peek(scanner);
    while (!is_delimiter(look(scanner, 0))) {
        if (word->length >= LIMIT_FORMAT_TEXT) {
            return ERR_CONTENT;
        }
        if (append(word, take(scanner)) != 0) {
            return ERR_MEMORY;
        }
    }
    if (word->length == 0) {
        return ERR_CONTENT;
    }
    return append(word, '\0');
}

static int digit_value(int c)
{
    if (c >= '0' && c <= '9') {
        return c - '0';
    }
    if (c >= 'a' && c <= 'f') {
        return c - 'a' + 10;
    }
    if (c >= 'A' && c <= 'F') {
        return c - 'A' + 10;
    }
    return 16;
}

/* The value of at most most digits of a base below 17; -1 if there is none or it is above 255. */
static int take_code(struct scanner *scanner, int base, int most)
{
    int value = 0, n = 0;
    while (n < most && digit_value(look(scanner, 0)) < base) {
        value = value * base + digit_value(take(scanner));
        n++;
    }
    return n == 0 || value > 255 ? -1 : value;
}

/* The character of the escape behind a backslash; -1 if there is no such escape. */
static int take_escape(struct scanner *scanner)
{
    static const char letters[] = "abfnrtv\\'\"?";
    static const char meanings[] = "\a\b\f\n\r\t\v\\'\"?";
    const int c = look(scanner, 0);
    if (digit_value(c) < 8) {
        return take_code(scanner, 8, 3);
    }
    if (c == EOF || c == '\0') {
        return -1;
    }
    (void)take(scanner);
    if (c == 'x') {
        return take_code(scanner, 16, 2);
    }
    const char *found = strchr(letters, c);
    return found == NULL ? -1 : (unsigned char)meanings[found - letters];
}

int scanner_text(struct scanner *scanner, struct buffer *text)
{
    buffer_clear(text);
    if (!scanner_skip(scanner, '"')) {
        return ERR_CONTENT;
    }
    for (;;) {
        int c = take(scanner);
        if (c == '"') {
            return append(text, '\0');
        }
        if (c == '\\') {
            c = take_escape(scanner);
        }
        if (c < 0 || text->length >= INT32_MAX) { /* EOF is negative */
            return ERR_CONTENT;
        }
        if (append(text, c) != 0) {
            return ERR_MEMORY;
        }
    }
}

/* The quoted form, of which the opening quote comes next. */
static int quoted_character(struct scanner *scanner, uint8_t *character)
{
    (void)take(scanner);
    int c = take(scanner);
    if (c == '\\') {
        c = take_escape(scanner);
    }
    if (c < 0 || take(scanner) != '\'') {
        return ERR_CONTENT;
    }
    *character = (uint8_t)c;
    return 0;
}

int scanner_character(struct scanner *scanner, uint8_t *character)
{
    const int c = scanner_peek(scanner);
    if (c == '\'' && (look(scanner, 2) == '\'' || look(scanner, 1) == '\\')) {
        return quoted_character(scanner, character);
    }
    if (digit_value(c) < 10) {
        const int code = take_code(scanner, 10, 3);
        *character = (uint8_t)code;
        return code < 0 || !is_delimiter(look(scanner, 0)) ? ERR_CONTENT : 0;
    }
    if (c == EOF || !is_delimiter(look(scanner, 1))) {
        return ERR_CONTENT;
    }
    *character = (uint8_t)take(scanner);
    return 0;
}
