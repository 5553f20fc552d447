/*
 * Named formats.
 */
#include "unit.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "format/names.h"

static int make_names(void **state)
{
    *state = format_names_new();
    return 0;
}

static int free_names(void **state)
{
    format_names_free(*state);
    return 0;
}

static void define(struct format_names *names, const char *name, const char *text)
{
    assert_int_equal(format_names_define(names, name, text), 0);
}

static void assert_means(const struct format_names *names, const char *text, const char *expected)
{
    struct format *format;
    assert_int_equal(format_parse(text, names, &format, NULL), 0);
    char *canonical = format_canonical(format);
    assert_string_equal(canonical, expected);
    free(canonical);
    format_unref(format);
}

static void names_may_be_defined_in_any_order(void **state)
{
    struct format_names *names = *state;
    define(names, "outer", "{inner, inner}");
    define(names, "inner", "{int, *!}");
    assert_means(names, "[outer:2]", "[{{int, *!}, {int, *!}} : 2]");
}

static void a_definition_keeps_its_meaning_when_a_name_inside_changes(void **state)
{
    struct format_names *names = *state;
    define(names, "x", "int");
    define(names, "y", "{x, x}");
    assert_means(names, "y", "{int, int}");
    define(names, "x", "double");
    assert_means(names, "{x}", "{double}");
    assert_means(names, "y", "{int, int}");
    define(names, "y", "{x, x}");
    assert_means(names, "y", "{double, double}");
}

static void the_last_definition_before_first_use_counts(void **state)
{
    struct format_names *names = *state;
    define(names, "x", "{int,");
    define(names, "x", "short");
    assert_means(names, "x", "short");
}

static void a_bad_definition_is_noticed_at_use(void **state)
{
    struct format_names *names = *state;
    struct format_diagnosis diagnosis;
    struct format *format;
    define(names, "x", "{int,}");
    assert_int_equal(format_parse("{x}", names, &format, &diagnosis), ERR_FORMAT);
    assert_string_equal(diagnosis.text, "Format Parsing Error: Expected a different token type.\n"
                                        "{int,}\n     ^\n");
    free(diagnosis.text);
    define(names, "x", "int");
    assert_means(names, "{x}", "{int}");
}

static void definitions_in_terms_of_themselves_are_illegal(void **state)
{
    struct format_names *names = *state;
    struct format_diagnosis diagnosis;
    struct format *format;
    define(names, "a", "{int, *b}");
    define(names, "b", "{int, *a}");
    for (int i = 0; i < 2; i++) {
        assert_int_equal(format_parse("a", names, &format, &diagnosis), ERR_FORMAT);
        assert_non_null(strstr(diagnosis.text, "Named Format a is defined in terms of itself\n"));
        free(diagnosis.text);
    }
    define(names, "b", "int");
    assert_means(names, "a", "{int, *int}");
}

static void primitives_and_missing_arguments_are_refused(void **state)
{
    struct format_names *names = *state;
    static const char *const primitives[] = {
        "char",  "byte",    "ubyte", "short",   "ushort", "int",    "uint",   "long",
        "ulong", "twobyte", "float", "boolean", "double", "string", "format", "X_IPC_REF_PTR"};
    for (size_t i = 0; i < N_ELEMENTS(primitives); i++) {
        assert_int_equal(format_names_define(names, primitives[i], "int"), ERR_FORMAT);
        assert_false(format_names_holds(names, primitives[i]));
    }
    assert_int_equal(format_names_define(names, NULL, "int"), ERR_NULL);
    assert_int_equal(format_names_define(names, "", "int"), ERR_NULL);
    assert_int_equal(format_names_define(names, "x", NULL), ERR_NULL);
    assert_false(format_names_holds(names, "x"));
}

static void names_heed_the_case(void **state)
{
    struct format_names *names = *state;
    struct format *format;
    define(names, "Point", "{int, int}");
    assert_true(format_names_holds(names, "Point"));
    assert_false(format_names_holds(names, "point"));
    assert_int_equal(format_parse("point", names, &format, NULL), ERR_UNKNOWN);
}

static void a_chain_of_many_names_is_bounded(void **state)
{
    struct format_names *names = *state;
    char name[16], text[16];
    for (int i = 0; i < 100000; i++) {
        (void)snprintf(name, sizeof name, "n%d", i);
        (void)snprintf(text, sizeof text, "n%d", i + 1);
        define(names, name, text);
    }
    struct format *format;
    assert_int_equal(format_parse("n0", names, &format, NULL), ERR_FORMAT);
}

static void names_that_multiply_are_bounded(void **state)
{
    struct format_names *names = *state;
    char name[16], text[64];
    define(names, "n0", "int");
    for (int i = 1; i < 40; i++) {
        (void)snprintf(name, sizeof name, "n%d", i);
        (void)snprintf(text, sizeof text, "{n%d, n%d}", i - 1, i - 1);
        define(names, name, text);
    }
    struct format *format;
    assert_int_equal(format_parse("n10", names, &format, NULL), 0);
    assert_int_equal(format_size(format), 1024 * sizeof(int));
    format_unref(format);
    assert_int_equal(format_parse("n39", names, &format, NULL), ERR_FORMAT);
}

static void append_definition(void *context, const char *name, const char *text)
{
    char *all = context;
    strcat(strcat(strcat(strcat(all, name), "="), text), ";");
}

static void definitions_are_listed_in_the_order_of_their_first_definition(void **state)
{
    struct format_names *names = *state;
    char all[200] = "";
    define(names, "z", "int");
    define(names, "a", "{z}");
    define(names, "z", "{double");
    format_names_each(names, append_definition, all);
    assert_string_equal(all, "z={double;a={z};");
}

struct answers {
    int asked;
    char last[20];
};

static struct format *answer(void *asked, const char *name)
{
    struct answers *answers = asked;
    struct format *format = NULL;
    answers->asked++;
    strcpy(answers->last, name);
    if (strcmp(name, "bad") == 0) {
        return format_bad();
    }
    if (strcmp(name, "known") == 0) {
        (void)format_parse("{int, int}", NULL, &format, NULL);
    }
    return format;
}

static void unknown_names_are_asked_for_every_time(void **state)
{
    struct format_names *names = *state;
    struct answers answers = {0, ""};
    format_names_set_ask(names, answer, &answers);
    define(names, "own", "int");
    assert_means(names, "{own, int}", "{int, int}");
    assert_int_equal(answers.asked, 0);
    assert_means(names, "{known, int, known}", "{{int, int}, int, {int, int}}");
    assert_string_equal(answers.last, "known");
    assert_int_equal(answers.asked, 2);
    assert_means(names, "known", "{int, int}");
    assert_int_equal(answers.asked, 3);
    assert_false(format_names_holds(names, "known"));
}

static void who_answers_with_the_bad_format_has_said_it(void **state)
{
    struct format_names *names = *state;
    struct answers answers = {0, ""};
    struct format_diagnosis diagnosis;
    struct format *format;
    format_names_set_ask(names, answer, &answers);
    assert_int_equal(format_parse("{int, bad}", names, &format, &diagnosis), ERR_UNKNOWN);
    assert_null(diagnosis.text);
    assert_int_equal(diagnosis.position, 6);
    assert_int_equal(format_parse("{int, other}", names, &format, &diagnosis), ERR_UNKNOWN);
    assert_string_equal(diagnosis.text,
                        "Warning: Named Format other is not registered\n{int, other}\n");
    free(diagnosis.text);
}

static void formats_outlive_the_names_they_came_from(void **state)
{
    (void)state;
    struct format_names *names = format_names_new();
    struct format *format;
    define(names, "x", "{int, string}");
    assert_int_equal(format_parse("{x}", names, &format, NULL), 0);
    format_names_free(names);
    char *canonical = format_canonical(format);
    assert_string_equal(canonical, "{{int, string}}");
    free(canonical);
    format_unref(format);
}

int main(void)
{
#define WITH_NAMES(test) cmocka_unit_test_setup_teardown(test, make_names, free_names)
    const struct CMUnitTest tests[] = {
        WITH_NAMES(names_may_be_defined_in_any_order),
        WITH_NAMES(a_definition_keeps_its_meaning_when_a_name_inside_changes),
        WITH_NAMES(the_last_definition_before_first_use_counts),
        WITH_NAMES(a_bad_definition_is_noticed_at_use),
        WITH_NAMES(definitions_in_terms_of_themselves_are_illegal),
        WITH_NAMES(primitives_and_missing_arguments_are_refused),
        WITH_NAMES(names_heed_the_case),
        WITH_NAMES(a_chain_of_many_names_is_bounded),
        WITH_NAMES(names_that_multiply_are_bounded),
        WITH_NAMES(definitions_are_listed_in_the_order_of_their_first_definition),
        WITH_NAMES(unknown_names_are_asked_for_every_time),
        WITH_NAMES(who_answers_with_the_bad_format_has_said_it),
        WITH_NAMES(formats_outlive_the_names_they_came_from),
    };
#undef WITH_NAMES
    return cmocka_run_group_tests(tests, NULL, NULL);
}
