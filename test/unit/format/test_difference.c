/*
 * The first part in which two formats differ.
 */
#include "unit.h"

#include "format/format.h"

struct example {
    const char *first;
    const char *second;
    const char *part;
    const char *in_first;
    const char *in_second;
};

static struct format *parsed(const char *text)
{
    struct format *format = NULL;
    if (text != NULL) {
        assert_int_equal(format_parse(text, NULL, &format, NULL), 0);
    }
    return format;
}

static void assert_difference(const struct example *example)
{
    struct format *first = parsed(example->first);
    struct format *second = parsed(example->second);
    struct format_difference found;
    assert_true(format_difference(first, second, &found));
    assert_string_equal(found.part, example->part);
    assert_string_equal(found.first, example->in_first);
    assert_string_equal(found.second, example->in_second);
    format_difference_fini(&found);
    format_unref(first);
    format_unref(second);
}

static void the_first_part_that_differs_is_found(void **state)
{
    static const struct example examples[] = {
        {"int", "double", "", "int", "double"},
        {"{int, double}", "{int, int}", "2", "double", "int"},
        {"{int, double, char}", "{int, int, byte}", "2", "double", "int"},
        {"{int, {char, [int:3]}}", "{int, {char, [int:4]}}", "2.2", "[int : 3]", "[int : 4]"},
        {"{int}", "{int, double}", "2", "nothing", "double"},
        {"{int, double}", "{int}", "2", "double", "nothing"},
        {"{int, {char, char}}", "{int, {char}}", "2.2", "char", "nothing"},
        {"{int, int}", "int", "", "{int, int}", "int"},
        {"{*int}", "{*double}", "1", "*int", "*double"},
        {"{*{int, int}}", "{*{int, char}}", "1.2", "int", "char"},
        {"[{int, int}:3]", "[{int, char}:3]", "2", "int", "char"},
        {"[{int, int}:3]", "[{int, char}:4]", "", "[{int, int} : 3]", "[{int, char} : 4]"},
        {"{int, <{int, int}:1>}", "{int, <{int, long}:1>}", "2.2", "int", "long"},
        {"{enum A, B}", "{enum A, C}", "", "{enum A, B}", "{enum A, C}"},
        {NULL, "int", "", "nothing", "int"},
        {"{}", "{int}", "1", "nothing", "int"},
    };
    (void)state;
    for (size_t i = 0; i < N_ELEMENTS(examples); i++) {
        assert_difference(&examples[i]);
    }
}

static void equal_formats_do_not_differ(void **state)
{
    struct format_difference found;
    struct format *first = parsed("{int,<double:1>}");
    struct format *second = parsed("{ int, <double : 1> }");
    (void)state;
    assert_false(format_difference(first, second, &found));
    assert_false(format_difference(NULL, NULL, &found));
    format_unref(first);
    format_unref(second);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_first_part_that_differs_is_found),
        cmocka_unit_test(equal_formats_do_not_differ),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
