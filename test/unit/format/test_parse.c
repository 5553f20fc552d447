/*
 * The parser: what it refuses, with which words, and what it tolerates.
 */
#include "vectors.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/limits.h"
#include "base/memory.h"

/* Whether the first line of a diagnosis is the message. */
static bool says(const struct format_diagnosis *diagnosis, const char *message)
{
    const size_t length = strlen(message);
    return diagnosis->text != NULL && strncmp(diagnosis->text, message, length) == 0 &&
           diagnosis->text[length] == '\n';
}

static void check_illegal(const struct json *entry)
{
    const char *text = json_get(entry, "format")->text;
    const struct json *required = json_get(entry, "required");
    const struct json *position = json_find(required, "position");
    struct format_names *names = vectors_names(entry);
    struct format_diagnosis diagnosis;
    struct format *format;
    int error = format_parse(text, names, &format, &diagnosis);
    if (error != ERR_FORMAT && error != ERR_UNKNOWN) {
        fail_msg("%s: result %d", text, error);
    }
    assert_null(format);
    if (!says(&diagnosis, json_get(required, "message")->text)) {
        fail_msg("%s: said %s", text, diagnosis.text);
    }
    if (position != NULL && diagnosis.position != (size_t)position->integer) {
        fail_msg("%s: position %zu", text, diagnosis.position);
    }
    free(diagnosis.text);
    format_names_free(names);
}

static void check_accepted(const struct json *entry)
{
    const char *text = json_get(entry, "format")->text;
    const struct json *required = json_get(entry, "required");
    const bool warned = strcmp(json_get(required, "outcome")->text, "accept_with_warning") == 0;
    const struct json *position = json_find(required, "position");
    struct format_names *names = vectors_names(entry);
    struct format_diagnosis diagnosis;
    struct format *format;
    if (format_parse(text, names, &format, &diagnosis) != 0) {
        fail_msg("%s: said %s", text, diagnosis.text);
    }
    char *canonical = format_canonical(format);
    assert_string_equal(canonical, json_get(required, "canonical")->text);
    if (vectors_fit_host()) {
        assert_int_equal(format_size(format), json_get(required, "sizeof")->integer);
    }
    if (warned != (diagnosis.text != NULL)) {
        fail_msg("%s: said %s", text, diagnosis.text);
    }
    if (warned) {
        assert_true(says(&diagnosis, "Warning: Extra text after the format is ignored."));
    }
    if (position != NULL) {
        assert_int_equal(diagnosis.position, position->integer);
    }
    free(canonical);
    free(diagnosis.text);
    format_unref(format);
    format_names_free(names);
}

static void illegal_formats_are_refused_with_the_recorded_words(void **state)
{
    (void)state;
    struct json *vectors = json_read_vectors("errors.json");
    const struct json *list = json_get(vectors, "illegal");
    assert_true(list->length >= 119);
    for (size_t i = 0; i < list->length; i++) {
        check_illegal(list->parts[i]);
    }
    json_free(vectors);
}

static void odd_formats_are_treated_as_required(void **state)
{
    (void)state;
    struct json *vectors = json_read_vectors("errors.json");
    const struct json *list = json_get(vectors, "odd");
    assert_true(list->length >= 53);
    for (size_t i = 0; i < list->length; i++) {
        const struct json *required = json_get(list->parts[i], "required");
        if (strcmp(json_get(required, "outcome")->text, "error") == 0) {
            check_illegal(list->parts[i]);
        } else {
            check_accepted(list->parts[i]);
        }
    }
    json_free(vectors);
}

struct complaint {
    const char *text;
    const char *diagnosis;
};

static void check_complaints(const struct complaint *complaints, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        struct format_diagnosis diagnosis;
        struct format *format;
        (void)format_parse(complaints[i].text, NULL, &format, &diagnosis);
        assert_string_equal(diagnosis.text, complaints[i].diagnosis);
        free(diagnosis.text);
        format_unref(format);
    }
}

static void a_diagnosis_shows_the_string_and_points_into_it(void **state)
{
    (void)state;
    static const struct complaint complaints[] = {
        {"{int,}", "Format Parsing Error: Expected a different token type.\n"
                   "{int,}\n"
                   "     ^\n"},
        {"}", "Format Parsing Error: Expected a different token type.\n"
              "}\n"
              "^\n"},
        {"{int", "Format Parsing Error: Expected ','.\n"
                 "{int\n"
                 "    ^\n"},
        {"int int", "Warning: Extra text after the format is ignored.\n"
                    "int int\n"
                    "    ^\n"},
        {"{foo, bar}", "Warning: Named Format foo is not registered\n"
                       "{foo, bar}\n"},
    };
    check_complaints(complaints, N_ELEMENTS(complaints));
}

static void a_reference_is_complained_of_where_it_stands(void **state)
{
    (void)state;
    struct format_diagnosis diagnosis;
    struct format *format;
    const char *text = "{int, {int, <int:1>}, <int:1,7>}";
    assert_int_equal(format_parse(text, NULL, &format, &diagnosis), ERR_FORMAT);
    assert_int_equal(diagnosis.position, 29);
    assert_true(says(&diagnosis, "Format Parsing Error: Expected a reference to one of the 3 "
                                 "fields of the structure."));
    free(diagnosis.text);
}

static void white_space_is_space_tab_and_form_feed_before_a_token(void **state)
{
    (void)state;
    struct format *format = must_parse(" \t\f{ int ,\f<\tint : 1 > } \t");
    char *canonical = format_canonical(format);
    assert_string_equal(canonical, "{int, <int : 1>}");
    free(canonical);
    format_unref(format);
}

static void the_diagnosis_is_optional(void **state)
{
    (void)state;
    struct format *format;
    assert_int_equal(format_parse("{int,}", NULL, &format, NULL), ERR_FORMAT);
    assert_int_equal(format_parse("foo", NULL, &format, NULL), ERR_UNKNOWN);
    assert_int_equal(format_parse("int int", NULL, &format, NULL), 0);
    format_unref(format);
}

/* count times piece, between before and after; the caller frees it. */
static char *repeat(const char *before, const char *piece, size_t count, const char *after)
{
    const size_t length = strlen(piece);
    char *text = mem_new(strlen(before) + count * length + strlen(after) + 1);
    strcpy(text, before);
    for (size_t i = 0; i < count; i++) {
        memcpy(text + strlen(before) + i * length, piece, length);
    }
    strcat(text, after);
    return text;
}

static int result_of(char *text)
{
    struct format *format;
    int error = format_parse(text, NULL, &format, NULL);
    format_unref(format);
    free(text);
    return error;
}

static void nesting_is_bounded(void **state)
{
    (void)state;
    assert_int_equal(result_of(repeat("", "*", LIMIT_FORMAT_DEPTH - 1, "int")), 0);
    assert_int_equal(result_of(repeat("", "*", LIMIT_FORMAT_DEPTH, "int")), ERR_FORMAT);
    assert_int_equal(result_of(repeat("", "{", 100000, "")), ERR_FORMAT);
    assert_int_equal(result_of(repeat("", "[3:", 100000, "")), ERR_FORMAT);
}

static void the_number_of_parts_is_bounded(void **state)
{
    (void)state;
    assert_int_equal(result_of(repeat("{", "int,", LIMIT_FORMAT_NODES - 2, "int}")), 0);
    assert_int_equal(result_of(repeat("{", "int,", LIMIT_FORMAT_NODES, "int}")), ERR_FORMAT);
    assert_int_equal(result_of(repeat("{enum ", "a,", LIMIT_FORMAT_NODES, "a}")), ERR_FORMAT);
    assert_int_equal(result_of(repeat("[int:", "1,", LIMIT_FORMAT_NODES, "1]")), ERR_FORMAT);
}

static void uchar_is_ubyte_unless_it_is_defined(void **state)
{
    (void)state;
    struct format *format = must_parse("{uchar, [uchar:2]}");
    char *canonical = format_canonical(format);
    assert_string_equal(canonical, "{ubyte, [ubyte : 2]}");
    free(canonical);
    format_unref(format);

    struct format_names *names = format_names_new();
    assert_int_equal(format_names_define(names, "uchar", "char"), 0);
    assert_int_equal(format_parse("uchar", names, &format, NULL), 0);
    canonical = format_canonical(format);
    assert_string_equal(canonical, "char");
    free(canonical);
    format_unref(format);
    format_names_free(names);
}

static void the_portable_text_has_no_uchar_of_ours(void **state)
{
    (void)state;
    static const char *const pairs[][2] = {
        {"{uchar, <uchar:1>}", "{ubyte, <ubyte:1>}"},
        {"{enum uchar, b}", "{enum uchar, b}"},
        {"{{enum uchar}, uchar}", "{{enum uchar}, ubyte}"},
        {"{my-uchar, uchar2}", "{my-uchar, uchar2}"},
        {"", ""},
        {"{int, !*}", "{int, *!}"},
        {"{int,! *,uchar}", "{int,* !,ubyte}"},
    };
    for (size_t i = 0; i < N_ELEMENTS(pairs); i++) {
        char *text = format_portable_text(pairs[i][0], NULL);
        assert_string_equal(text, pairs[i][1]);
        free(text);
    }
    struct format_names *names = format_names_new();
    char *text = format_portable_text("uchar", names);
    assert_string_equal(text, "ubyte");
    free(text);
    assert_int_equal(format_names_define(names, "uchar", "char"), 0);
    text = format_portable_text("uchar", names);
    assert_string_equal(text, "uchar");
    free(text);
    format_names_free(names);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(illegal_formats_are_refused_with_the_recorded_words),
        cmocka_unit_test(odd_formats_are_treated_as_required),
        cmocka_unit_test(a_diagnosis_shows_the_string_and_points_into_it),
        cmocka_unit_test(a_reference_is_complained_of_where_it_stands),
        cmocka_unit_test(white_space_is_space_tab_and_form_feed_before_a_token),
        cmocka_unit_test(the_diagnosis_is_optional),
        cmocka_unit_test(nesting_is_bounded),
        cmocka_unit_test(the_number_of_parts_is_bounded),
        cmocka_unit_test(uchar_is_ubyte_unless_it_is_defined),
        cmocka_unit_test(the_portable_text_has_no_uchar_of_ours),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
