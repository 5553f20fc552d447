/*
 * From an input in memory to a tree.
 */
#include "parse.h"

#include <ctype.h>
#include <string.h>

#include "base/memory.h"
#include "grammar.h"
#include "scanner.h"

enum { NAME_SIZE = 40, LIST_SIZE = 400 };

void parse_source(struct source *source, struct tree *tree, struct diagnostics *diagnostics)
{
    struct parse parse = {.tree = tree, .diagnostics = diagnostics};
    yyscan_t scanner;
    scan_init(&parse.scan, source, diagnostics);
    if (xdr_lex_init_extra(&parse.scan, &scanner) != 0) {
        return;
    }
    /* The scanner works in the source itself, so that tokens can be pieces of it. */
    (void)xdr__scan_buffer(source->bytes, source->length + 2, scanner);
    (void)xdr_parse(scanner, &parse);
    (void)xdr_lex_destroy(scanner);
}

void parse_report_depth(struct parse *parse, const struct place *place)
{
    diagnostics_error(parse->diagnostics, place, 1, "structures are nested too deeply");
}

struct type parse_record(struct parse *parse, struct record *record, const struct place *place)
{
    if (record->depth == TREE_MAX_DEPTH + 1) {
        parse_report_depth(parse, place);
    }
    return type_record(record, place);
}

/* ----------------------------------------------------------------- syntax errors */

/* What people call a token, by the name it has in the grammar. */
static void describe(const char *name, char words[NAME_SIZE])
{
    static const char *const known[][2] = {
        {"IDENTIFIER", "a name"},
        {"LONGVAL", "a number"},
        {"STRINGVAL", "a string"},
        {"PASS_THROUGH_CODE", "a code section"},
        {"end of file", "the end of the file"},
    };
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        if (strcmp(name, known[i][0]) == 0) {
            (void)snprintf(words, NAME_SIZE, "%s", known[i][1]);
            return;
        }
    }
    if (name[0] == '\'') {
        (void)snprintf(words, NAME_SIZE, "`%c'", name[1]);
        return;
    }
    (void)snprintf(words, NAME_SIZE, "`%s'", name);
    for (char *c = words; *c != '\0'; c++) {
        *c = (char)tolower((unsigned char)*c);
    }
}

static void append(char list[LIST_SIZE], const char *text)
{
    const size_t length = strlen(list);
    (void)snprintf(list + length, LIST_SIZE - length, "%s", text);
}

/* The text of the token that the scanner has read last. */
static struct text token_text(const struct parse *parse, const struct place *place,
                              const char *found)
{
    if (strcmp(found, "PASS_THROUGH_CODE") == 0) {
        return text_of("%}");
    }
    const size_t length = parse->scan.here.offset - place->offset;
    return (struct text){parse->scan.source->bytes + place->offset, length};
}

/* How much of a long token is worth repeating. */
static int shown(struct text token)
{
    return token.length > 80 ? 80 : (int)token.length;
}

static void report_unsupported(struct parse *parse, const struct place *place, struct text token)
{
    char upper[16] = "";
    for (size_t i = 0; i < token.length && i + 1 < sizeof upper; i++) {
        upper[i] = (char)toupper((unsigned char)token.bytes[i]);
    }
    diagnostics_error(parse->diagnostics, place, token.length, "`%.*s' is not supported",
                      shown(token), token.bytes);
    diagnostics_classic(parse->diagnostics, "before `%.*s': XDR token `%s' not supported.",
                        shown(token), token.bytes, upper);
}

void parse_report_unexpected(struct parse *parse, const struct place *place, const char *found,
                             const char *const *expected, int n_expected)
{
    const struct text token = token_text(parse, place, found);
    if (strcmp(found, "UNSUPPORTED") == 0) {
        report_unsupported(parse, place, token);
        return;
    }
    char classic[LIST_SIZE] = "";
    char modern[LIST_SIZE] = "";
    char words[NAME_SIZE];
    for (int i = 0; i < n_expected; i++) {
        append(classic, i == 0 ? ", expecting " : " or ");
        append(classic, expected[i]);
        describe(expected[i], words);
        append(modern, i == 0 ? ", expected " : " or ");
        append(modern, words);
    }
    if (token.length > 0 && strcmp(found, "PASS_THROUGH_CODE") != 0) {
        diagnostics_error(parse->diagnostics, place, token.length, "unexpected `%.*s'%s",
                          shown(token), token.bytes, modern);
    } else {
        diagnostics_error(parse->diagnostics, place, token.length, "unexpected %s%s",
                          token.length > 0 ? "code section" : "end of the file", modern);
    }
    diagnostics_classic(parse->diagnostics, "before `%.*s': syntax error, unexpected %s%s",
                        shown(token), token.bytes, found, classic);
}
