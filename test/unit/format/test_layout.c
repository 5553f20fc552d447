/*
 * Layout, equality and the corpus of formats in real use.
 */
#include "vectors.h"

#include <stdlib.h>

#include "format/handle.h"

static void structures_are_laid_out_as_the_compiler_does(void **state)
{
    (void)state;
    if (!vectors_fit_host()) {
        skip();
    }
    struct json *vectors = json_read_vectors("layout.json");
    const struct json *list = json_get(vectors, "structs");
    assert_true(list->length >= 216);
    for (size_t i = 0; i < list->length; i++) {
        const struct json *entry = list->parts[i];
        const struct json *offsets = json_get(entry, "offsets");
        struct format *format = vectors_format(entry);
        assert_int_equal(format_size(format), json_get(entry, "sizeof")->integer);
        assert_int_equal(format_alignment(format), json_get(entry, "align")->integer);
        assert_int_equal(format_is_simple(format), json_get(entry, "simple")->truth);
        for (size_t k = 0; k < offsets->length; k++) {
            assert_int_equal(format->type->members[k]->offset, offsets->parts[k]->integer);
        }
        format_unref(format);
    }
    json_free(vectors);
}

static void sizes_are_those_of_the_compiler_of_this_host(void **state)
{
    (void)state;
    struct all {
        char a;
        short b;
        char c;
        int d;
        char e;
        long f;
        char g;
        float h;
        double i;
        char j;
        char *k;
        char l;
    };
    struct format *format = must_parse(
        "{char, short, byte, int, ubyte, long, char, float, double, char, string, char}");
    assert_int_equal(format_size(format), sizeof(struct all));
    assert_int_equal(format->type->members[3]->offset, offsetof(struct all, d));
    assert_int_equal(format->type->members[5]->offset, offsetof(struct all, f));
    assert_int_equal(format->type->members[8]->offset, offsetof(struct all, i));
    assert_int_equal(format->type->members[10]->offset, offsetof(struct all, k));
    assert_false(format_is_flat(format));
    format_unref(format);
}

static void formats_of_size_zero_are_legal_anywhere(void **state)
{
    (void)state;
    static const char *const texts[] = {"{}", "0", "[int:0]", "{{}, 0, {}}", "[{}:5]"};
    for (size_t i = 0; i < N_ELEMENTS(texts); i++) {
        struct format *format = must_parse(texts[i]);
        assert_int_equal(format_size(format), 0);
        assert_true(format_is_simple(format));
        format_unref(format);
    }
}

static void no_format_has_no_size(void **state)
{
    (void)state;
    assert_int_equal(format_size(NULL), 0);
    assert_int_equal(format_alignment(NULL), 1);
    assert_true(format_is_flat(NULL));
    assert_int_equal(format_size(format_bad()), 0);
    assert_true(format_is_bad(format_bad()));
    assert_false(format_is_bad(NULL));
    format_unref(NULL);
    format_unref(format_bad());
    assert_ptr_equal(format_ref(format_bad()), format_bad());
}

static void formats_are_equal_node_by_node(void **state)
{
    (void)state;
    struct json *vectors = json_read_vectors("equality.json");
    struct format_names *names = vectors_names(vectors);
    const struct json *pairs = json_get(vectors, "pairs");
    assert_true(pairs->length >= 46);
    for (size_t i = 0; i < pairs->length; i++) {
        const struct json *pair = pairs->parts[i];
        struct format *a, *b;
        assert_int_equal(format_parse(json_get(pair, "a")->text, names, &a, NULL), 0);
        assert_int_equal(format_parse(json_get(pair, "b")->text, names, &b, NULL), 0);
        const bool equal = json_get(pair, "equal")->truth;
        if (format_equal(a, b) != equal || format_equal(b, a) != equal) {
            fail_msg("%s and %s", json_get(pair, "a")->text, json_get(pair, "b")->text);
        }
        format_unref(a);
        format_unref(b);
    }
    format_names_free(names);
    json_free(vectors);
}

static void no_format_equals_only_itself(void **state)
{
    (void)state;
    struct format *format = must_parse("int");
    assert_true(format_equal(NULL, NULL));
    assert_false(format_equal(format, NULL));
    assert_false(format_equal(NULL, format));
    assert_false(format_equal(format_bad(), NULL));
    assert_false(format_equal(format_bad(), format));
    assert_true(format_equal(format_bad(), format_bad()));
    format_unref(format);
}

static void every_format_in_real_use_is_accepted(void **state)
{
    (void)state;
    struct json *vectors = json_read_vectors("corpus.json");
    const struct json *list = json_get(vectors, "formats");
    assert_true(list->length >= 271);
    for (size_t i = 0; i < list->length; i++) {
        const struct json *entry = list->parts[i];
        const struct json *wire_length = json_get(entry, "wire_length");
        struct format *format = vectors_format(entry);
        char *canonical = format_canonical(format);
        assert_string_equal(canonical, json_get(entry, "canonical")->text);
        if (vectors_fit_host()) {
            assert_int_equal(format_size(format), json_get(entry, "sizeof")->integer);
        }
        if (vectors_fit_host() && wire_length->kind == JSON_NUMBER) {
            assert_true(format_is_flat(format));
            assert_int_equal(format->type->wire_least, wire_length->integer);
        }
        struct format *again = must_parse(canonical);
        assert_true(format_equal(again, format));
        format_unref(again);
        free(canonical);
        format_unref(format);
    }
    json_free(vectors);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(structures_are_laid_out_as_the_compiler_does),
        cmocka_unit_test(sizes_are_those_of_the_compiler_of_this_host),
        cmocka_unit_test(formats_of_size_zero_are_legal_anywhere),
        cmocka_unit_test(no_format_has_no_size),
        cmocka_unit_test(formats_are_equal_node_by_node),
        cmocka_unit_test(no_format_equals_only_itself),
        cmocka_unit_test(every_format_in_real_use_is_accepted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
