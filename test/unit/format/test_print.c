/*
 * Printing beyond the recorded cases.
 */
#include "unit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "format/format.h"

/* What printing a value appends; the caller frees it. */
static char *printed(const char *text, const void *value, unsigned indent)
{
    struct buffer out;
    struct format *format;
    assert_int_equal(format_parse(text, NULL, &format, NULL), 0);
    buffer_init(&out);
    assert_int_equal(format_print(format, value, indent, &out), 0);
    assert_int_equal(buffer_append(&out, "", 1), 0);
    format_unref(format);
    size_t length;
    return (char *)buffer_take(&out, &length);
}

static void assert_prints(const char *text, const void *value, const char *expected)
{
    char *all = printed(text, value, 0);
    assert_string_equal(all, expected);
    free(all);
}

static void no_format_prints_null(void **state)
{
    (void)state;
    struct buffer out;
    buffer_init(&out);
    assert_int_equal(format_print(NULL, NULL, 0, &out), 0);
    assert_int_equal(out.length, 5);
    assert_memory_equal(out.bytes, "NULL\n", 5);
    buffer_fini(&out);
}

static void empty_structures_print_both_braces(void **state)
{
    (void)state;
    const int one = 1;
    assert_prints("{}", NULL, "{}\n");
    assert_prints("{{}, int}", &one, "{{}, 1}\n");
    assert_prints("[int:0]", NULL, "[]\n");
    assert_prints("0", NULL, "()\n");
}

static void bytes_print_as_they_are(void **state)
{
    (void)state;
    static const unsigned char bytes[] = {0x12, 0, 0xff, 0x7f};
    assert_prints("[ubyte:4]", bytes, "[0x12, 0, 0xff, 0x7f]\n");
    assert_prints("[byte:4]", bytes, "[0x12, 0, 0xff, 0x7f]\n");
    assert_prints("4", bytes, "(0x12, 0, 0xff, 0x7f)\n");
}

static void dimensions_are_found_behind_strings(void **state)
{
    (void)state;
    struct value {
        int count;
        const char *name;
        const int *elements;
    };
    static const int elements[] = {7, 8};
    const struct value value = {2, "x", elements};
    assert_prints("{int, string, <int:1>}", &value, "{2, \"x\", <7, 8>}\n");
}

static void rows_of_nothing_print_as_many_as_there_are(void **state)
{
    (void)state;
    struct value {
        int rows;
        int columns;
        const int *elements;
    };
    static const int nothing = 0;
    const struct value no_columns = {2, 0, &nothing}, no_rows = {0, 3, &nothing};
    const struct value missing = {2, 0, NULL};
    assert_prints("{int, int, <int:1,2>}", &no_columns, "{2, 0, <<>, <>>}\n");
    assert_prints("{int, int, <int:1,2>}", &no_rows, "{0, 3, <>}\n");
    assert_prints("{int, int, <int:1,2>}", &missing, "{2, 0, NULL}\n");
}

static void special_numbers_print_with_their_sign(void **state)
{
    (void)state;
    const double numbers[] = {HUGE_VAL, -HUGE_VAL, -0.0, 1e300};
    char *all = printed("[double:3]", numbers, 0);
    assert_string_equal(all, "[inf, -inf, -0.00]\n");
    free(all);
    all = printed("double", &numbers[3], 0); /* longer than a line: whole on the next one */
    assert_int_equal(strlen(all), 1 + 1 + 301 + 3 + 1);
    assert_memory_equal(all, "\n 1000000", 9);
    free(all);
}

/* As central shows it in its log. */
static void every_line_is_indented_at_the_cost_of_its_columns(void **state)
{
    (void)state;
    struct value {
        int count;
        const int *elements;
    };
    int elements[60];
    for (int i = 0; i < 60; i++) {
        elements[i] = i * 1000;
    }
    const struct value value = {60, elements};
    char *all = printed("{int, <int:1>}", &value, 4);
    assert_string_equal(
        all, "    {60, <0, 1000, 2000, 3000, 4000, 5000, 6000, 7000, 8000, 9000, 10000, 11000,\n"
             "     12000, 13000, 14000, 15000, 16000, 17000, 18000, 19000, 20000, 21000, \n"
             "     22000, 23000, 24000, 25000, 26000, 27000, 28000, 29000, 30000, 31000, \n"
             "     32000, 33000, 34000, 35000, 36000, 37000, 38000, 39000, 40000, 41000, \n"
             "     42000, 43000, 44000, 45000, 46000, 47000, 48000, 49000, 50000, 51000, \n"
             "     ...\n");
    free(all);
}

static void formats_and_references_print_as_text(void **state)
{
    (void)state;
    struct format *value;
    static char name[] = "query";
    struct format_reference reference = {12, name};
    struct format_reference *pointer = &reference;
    assert_int_equal(format_parse("{int, <int:1>, *!}", NULL, &value, NULL), 0);
    assert_prints("format", &value, "{int, <int : 1>, *!}\n");
    format_unref(value);
    value = NULL;
    assert_prints("format", &value, "NULLFormat\n");
    assert_prints("X_IPC_REF_PTR", &pointer, "[X_IPC_REF (12, query)]\n");
}

static void impossible_dimensions_leave_no_output(void **state)
{
    (void)state;
    struct value {
        int count;
        int *elements;
    } value = {-1, NULL};
    struct format *format;
    struct buffer out;
    buffer_init(&out);
    assert_int_equal(format_parse("{int, <int:1>}", NULL, &format, NULL), 0);
    assert_int_equal(format_print(format, &value, 0, &out), ERR_RANGE);
    assert_int_equal(out.length, 0);
    assert_int_equal(format_print(format, NULL, 0, &out), ERR_NULL);
    assert_int_equal(format_print(format_bad(), &value, 0, &out), ERR_FORMAT);
    assert_int_equal(out.length, 0);
    format_unref(format);
    buffer_fini(&out);
}

static void huge_values_stop_at_the_end_of_the_page(void **state)
{
    (void)state;
    struct value {
        int count;
        void *elements;
    };
    char nothing = 0;
    const struct value value = {2147483647, &nothing};
    char *all = printed("{int, <{}:1>}", &value, 0);
    assert_non_null(strstr(all, "...\n"));
    free(all);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_format_prints_null),
        cmocka_unit_test(empty_structures_print_both_braces),
        cmocka_unit_test(bytes_print_as_they_are),
        cmocka_unit_test(dimensions_are_found_behind_strings),
        cmocka_unit_test(rows_of_nothing_print_as_many_as_there_are),
        cmocka_unit_test(special_numbers_print_with_their_sign),
        cmocka_unit_test(every_line_is_indented_at_the_cost_of_its_columns),
        cmocka_unit_test(formats_and_references_print_as_text),
        cmocka_unit_test(impossible_dimensions_leave_no_output),
        cmocka_unit_test(huge_values_stop_at_the_end_of_the_page),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
