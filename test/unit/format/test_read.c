/*
 * Reading printed values.
 */
#include "vectors.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "value.h"

/* A stream that yields text; the caller closes it. */
static FILE *stream_of(const char *text)
{
    FILE *stream = tmpfile();
    assert_non_null(stream);
    (void)fwrite(text, 1, strlen(text), stream);
    rewind(stream);
    return stream;
}

static int read_text(const struct format *format, const char *text, void *value)
{
    FILE *stream = stream_of(text);
    int error = format_read(format, stream, value);
    (void)fclose(stream);
    return error;
}

struct reading {
    const char *format;
    const char *text;
    const char *value; /* as JSON */
};

static void assert_reads(const struct reading *readings, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint64_t value[64];
        struct format *format = must_parse(readings[i].format);
        struct json *json = json_parse(readings[i].value);
        void *expected = value_build(format, json);
        assert_true(format_size(format) <= sizeof value);
        if (read_text(format, readings[i].text, value) != 0) {
            fail_msg("%s: cannot be read as %s", readings[i].text, readings[i].format);
        }
        if (!value_same(format, value, expected)) {
            fail_msg("%s: read as another value of %s", readings[i].text, readings[i].format);
        }
        (void)format_release(format, value);
        value_free(format, expected);
        json_free(json);
        format_unref(format);
    }
}

static void primitives_are_read_in_all_their_forms(void **state)
{
    (void)state;
    static const struct reading readings[] = {
        {"int", " \n -12 ", "-12"},
        {"int", "+0x7fffffff", "2147483647"},
        {"int", "-2147483648", "-2147483648"},
        {"int", "010", "10"},
        {"ubyte", "255", "255"},
        {"byte", "0xff", "-1"},
        {"byte", "-128", "-128"},
        {"twobyte", "0xabcd", "43981"},
        {"ushort", "65535", "65535"},
        {"uint", "4294967295", "4294967295"},
        {"boolean", "True", "1"},
        {"boolean", "fALSE", "0"},
        {"boolean", "2", "2"},
        {"double", "-1.25e2", "-125"},
        {"float", "0.5", "0.5"},
        {"char", "A", "65"},
        {"char", "65", "65"},
        {"char", "'A'", "65"},
        {"char", "'\\n'", "10"},
        {"char", "'\\x41'", "65"},
        {"char", "'\\101'", "65"},
        {"char", "','", "44"},
        {"char", "' '", "32"},
        {"char", "'''", "39"},
        {"char", "'", "39"},
        {"{char, char}", "{', a}", "[39, 97]"},
        {"string", "\"a b\"", "\"a b\""},
        {"string", "\"\"", "\"\""},
        {"string", "NULL", "null"},
        {"string", "\"NULL\"", "\"NULL\""},
        {"string", "\"\\\"\\\\\\t\\x7e\"", "\"\\\"\\\\\\t~\""},
        {"{enum A, B-2, C}", "B-2", "1"},
        {"{enum A, B, C}", "7", "7"},
        {"{enum : 3}", "-1", "-1"},
        {"3", "(1, 0xff, -1)", "\"01ffff\""},
    };
    assert_reads(readings, N_ELEMENTS(readings));
}

static void compound_values_are_read_as_printed(void **state)
{
    (void)state;
    static const struct reading readings[] = {
        {"{}", "{ }", "[]"},
        {"{int, {double, string}}", "{1,{2.5 ,\"x\"} }", "[1, [2.5, \"x\"]]"},
        {"[int:2,3]", "[[1, 2, 3], [4, 5, 6]]", "[[1, 2, 3], [4, 5, 6]]"},
        {"[3:int]", "[1, 2, 3]", "[1, 2, 3]"},
        {"{int, <int:1>}", "{3, <1, 2, 3>}", "[3, [1, 2, 3]]"},
        {"{<string:2>, int}", "{<\"a\", NULL>, 2}", "[[\"a\", null], 2]"},
        {"{int, <int:1>}", "{0, <>}", "[0, null]"},
        {"{int, <int:1>}", "{0, NULL}", "[0, null]"},
        {"{int, int, <int:1,2>}", "{2, 3, <<1, 2, 3>, <4, 5, 6>>}", "[2, 3, [1, 2, 3, 4, 5, 6]]"},
        {"{int, int, <int:1,2>}", "{0, 3, <>}", "[0, 3, null]"},
        {"{int, int, <int:1,2>}", "{2, 0, <<>, <>>}", "[2, 0, null]"},
        {"{int, <{int, <string:1>}:1>}", "{2, <{1, <\"p\">}, {2, <\"q\", \"r\">}>}",
         "[2, [[1, [\"p\"]], [2, [\"q\", \"r\"]]]]"},
        {"*int", "NULL", "null"},
        {"**int", "**5", "{\"ptr\": {\"ptr\": 5}}"},
        {"{int, *!}", "{1, *{2, *{3, NULL}}}", "[1, {\"ptr\": [2, {\"ptr\": [3, null]}]}]"},
    };
    assert_reads(readings, N_ELEMENTS(readings));
}

static void wrong_text_is_refused_and_nothing_stays(void **state)
{
    (void)state;
    static const char *const pairs[][2] = {
        {"int", ""},
        {"int", "x"},
        {"int", "1x"},
        {"int", "2147483648"},
        {"int", "-2147483649"},
        {"int", "--1"},
        {"int", "0x"},
        {"int", "..."},
        {"uint", "-1"},
        {"ubyte", "256"},
        {"byte", "-129"},
        {"boolean", "Truth"},
        {"double", "1.5.2"},
        {"char", "AB"},
        {"char", "256"},
        {"char", ""},
        {"string", "\"abc"},
        {"string", "abc"},
        {"string", "\"\\q\""},
        {"{enum A, B}", "C"},
        {"{enum A, B}", "2147483648"},
        {"2", "(1)"},
        {"2", "(1, 2, 3)"},
        {"{int, int}", "{1}"},
        {"{int, int}", "{1, 2, 3}"},
        {"{int, int}", "{1, 2"},
        {"[int:2]", "[1]"},
        {"{int, <int:1>}", "{3, <1, 2>}"},
        {"{int, <int:1>}", "{2, NULL}"},
        {"{int, <int:1>}", "{-1, NULL}"},
        {"{<string:2>, int}", "{<\"a\", \"b\">, 3}"},
        {"{<string:2>, int}", "{<\"a\", \"b\", 3}"},
        {"{int, int, <string:1,2>}", "{2, 2, <<\"a\", \"b\">, <\"c\">>}"},
        {"{int, int, <string:1,2>}", "{2, 2, <<\"a\", \"b\", \"c\", \"d\">>}"},
        {"{int, <{int, <string:1>}:1>}", "{2, <{1, <\"p\">}, {2, <\"q\", \"r>}>}"},
        {"{string, *!}", "{\"a\", *{\"b\", *{\"c\", ...}}}"},
        {"*string", "*"},
    };
    static const uint64_t zero[64];
    for (size_t i = 0; i < N_ELEMENTS(pairs); i++) {
        uint64_t value[64];
        struct format *format = must_parse(pairs[i][0]);
        memset(value, 0xee, sizeof value);
        if (read_text(format, pairs[i][1], value) != ERR_CONTENT) {
            fail_msg("%s: read as %s", pairs[i][1], pairs[i][0]);
        }
        assert_memory_equal(value, zero, format_size(format));
        format_unref(format);
    }
}

static void endless_nesting_is_refused(void **state)
{
    (void)state;
    FILE *stream = tmpfile();
    assert_non_null(stream);
    for (int i = 0; i < 100000; i++) {
        (void)fputs("{*", stream);
    }
    rewind(stream);
    struct format *format = must_parse("{*!}");
    void *value;
    assert_int_equal(format_read(format, stream, &value), ERR_CONTENT);
    (void)fclose(stream);
    format_unref(format);
}

static void formats_and_references_cannot_be_read(void **state)
{
    (void)state;
    void *value[2];
    struct format *format = must_parse("{string, format}");
    assert_int_equal(read_text(format, "{\"a\", int}", value), ERR_FORMAT);
    format_unref(format);
    assert_int_equal(read_text(format_bad(), "1", value), ERR_FORMAT);
    assert_int_equal(read_text(NULL, "1", NULL), 0);
}

static void the_stream_is_left_behind_the_value(void **state)
{
    (void)state;
    FILE *stream = stream_of("{1, 2}\n 17,x");
    int value[2];
    struct format *format = must_parse("{int, int}");
    assert_int_equal(format_read(format, stream, value), 0);
    format_unref(format);
    format = must_parse("int");
    assert_int_equal(format_read(format, stream, value), 0);
    assert_int_equal(value[0], 17);
    assert_int_equal(getc(stream), ',');
    format_unref(format);
    (void)fclose(stream);
}

/* Whether a printed text reads back as the same value: not if it lost something in printing. */
static bool is_faithful(const char *format, const char *text)
{
    return strstr(format, "char") == NULL && strstr(format, "string") == NULL &&
           strstr(format, "float") == NULL && strstr(format, "double") == NULL &&
           strstr(format, "boolean") == NULL && strstr(text, "...") == NULL;
}

static void recorded_values_read_back_from_their_printed_text(void **state)
{
    (void)state;
    struct json *vectors = json_read_vectors("cases.json");
    const struct json *list = json_get(vectors, "cases");
    int n_read = 0;
    for (size_t i = 0; i < list->length; i++) {
        const struct json *entry = list->parts[i];
        const struct json *required = json_find(entry, "print_required");
        const char *text = (required != NULL ? required : json_get(entry, "print"))->text;
        struct format *format = vectors_format(entry);
        char *canonical = format_canonical(format);
        const struct json *json = json_find(entry, "value_after");
        if (json == NULL) {
            json = json_get(entry, "value");
        }
        if (vectors_bytes_fit_host(entry) && is_faithful(canonical, text) &&
            format_size(format) > 0) {
            void *expected = value_build(format, json);
            void *value = malloc(format_size(format));
            if (read_text(format, text, value) != 0 || !value_same(format, value, expected)) {
                fail_msg("%s: %s", json_get(entry, "name")->text, text);
            }
            value_free(format, value);
            value_free(format, expected);
            n_read++;
        }
        free(canonical);
        format_unref(format);
    }
    assert_true(n_read > 80);
    json_free(vectors);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(primitives_are_read_in_all_their_forms),
        cmocka_unit_test(compound_values_are_read_as_printed),
        cmocka_unit_test(wrong_text_is_refused_and_nothing_stays),
        cmocka_unit_test(endless_nesting_is_refused),
        cmocka_unit_test(formats_and_references_cannot_be_read),
        cmocka_unit_test(the_stream_is_left_behind_the_value),
        cmocka_unit_test(recorded_values_read_back_from_their_printed_text),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
