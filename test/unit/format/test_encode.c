/*
 * What cannot be encoded, and what must not disturb encoding.
 */
#include "unit.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/limits.h"
#include "format/format.h"

static struct format *parse(const char *text)
{
    struct format *format;
    assert_int_equal(format_parse(text, NULL, &format, NULL), 0);
    return format;
}

/* Encoding and measuring fail alike, and what the buffer held before stays. */
static void assert_refused(const struct format *format, const void *value, int expected)
{
    struct buffer out;
    size_t length = 7;
    buffer_init(&out);
    assert_int_equal(buffer_append(&out, "abc", 3), 0);
    assert_int_equal(format_encode(format, value, ORDER_LITTLE, &out), expected);
    assert_int_equal(out.length, 3);
    assert_memory_equal(out.bytes, "abc", 3);
    assert_int_equal(format_encode(format, value, ORDER_BIG, &out), expected);
    assert_int_equal(out.length, 3);
    assert_int_equal(format_measure(format, value, &length), expected);
    buffer_fini(&out);
}

static void nothing_is_encoded_without_a_format(void **state)
{
    (void)state;
    struct buffer out;
    size_t length = 7;
    buffer_init(&out);
    assert_int_equal(format_encode(NULL, NULL, ORDER_BIG, &out), 0);
    assert_int_equal(out.length, 0);
    assert_int_equal(format_measure(NULL, NULL, &length), 0);
    assert_int_equal(length, 0);
    struct format *empty = parse("{{}, [int:0]}");
    assert_int_equal(format_encode(empty, NULL, ORDER_BIG, &out), 0);
    assert_int_equal(out.length, 0);
    format_unref(empty);
    buffer_fini(&out);
}

static void a_missing_value_is_refused(void **state)
{
    (void)state;
    struct format *format = parse("int");
    assert_refused(format, NULL, ERR_NULL);
    format_unref(format);
}

static void the_bad_format_fits_no_value(void **state)
{
    (void)state;
    int value = 1;
    assert_refused(format_bad(), &value, ERR_FORMAT);
}

static void a_missing_array_with_a_count_is_refused(void **state)
{
    (void)state;
    struct counted {
        int count;
        void *elements;
    } value = {2, NULL};
    static const char *const texts[] = {"{int, <int:1>}", "{int, <string:1>}", "{int, <{}:1>}"};
    for (size_t i = 0; i < N_ELEMENTS(texts); i++) {
        struct format *format = parse(texts[i]);
        assert_refused(format, &value, ERR_NULL);
        format_unref(format);
    }
}

static void impossible_dimensions_are_refused(void **state)
{
    (void)state;
    struct grid {
        int rows;
        int columns;
        char *elements;
    };
    static const int sizes[][2] = {{-1, 3}, {3, -1}, {-2, -3}, {65536, 65536}, {2147483647, 2}};
    char element = 0;
    struct format *format = parse("{int, int, <char:1,2>}");
    for (size_t i = 0; i < N_ELEMENTS(sizes); i++) {
        const struct grid value = {sizes[i][0], sizes[i][1], &element};
        assert_refused(format, &value, ERR_RANGE);
    }
    format_unref(format);
}

static void dimensions_are_read_with_the_type_of_their_field(void **state)
{
    (void)state;
    static const uint8_t elements[3] = {1, 2, 3};
    struct {
        signed char count;
        char noise[7];
        const uint8_t *elements;
    } in_byte = {3, {99, 99, 99, 99, 99, 99, 99}, elements};
    struct {
        unsigned short count;
        char noise[6];
        const uint8_t *elements;
    } in_short = {3, {99, 99, 99, 99, 99, 99}, elements};
    struct {
        unsigned long count;
        const uint8_t *elements;
    } in_long = {3, elements};
    size_t length;
    struct format *format = parse("{byte, <ubyte:1>}");
    assert_int_equal(format_measure(format, &in_byte, &length), 0);
    assert_int_equal(length, 1 + 4 + 3);
    in_byte.count = -1;
    assert_refused(format, &in_byte, ERR_RANGE);
    format_unref(format);
    format = parse("{ushort, <ubyte:1>}");
    assert_int_equal(format_measure(format, &in_short, &length), 0);
    assert_int_equal(length, 2 + 4 + 3);
    format_unref(format);
    format = parse("{ulong, <ubyte:1>}");
    assert_int_equal(format_measure(format, &in_long, &length), 0);
    assert_int_equal(length, sizeof(long) + 4 + 3);
    in_long.count = (unsigned long)-1;
    assert_refused(format, &in_long, ERR_RANGE);
    format_unref(format);
}

struct node {
    struct node *left;
    struct node *next;
};

static void a_list_that_bites_its_tail_is_refused(void **state)
{
    (void)state;
    struct format *format = parse("{*!, *!}");
    enum { N_NODES = 1000 };
    static struct node nodes[N_NODES];
    for (int back_to = 0; back_to < N_NODES; back_to += 333) {
        for (int i = 0; i < N_NODES; i++) {
            nodes[i].next = &nodes[i + 1 < N_NODES ? i + 1 : back_to];
        }
        assert_refused(format, &nodes[0], ERR_DEPTH);
    }
    format_unref(format);
}

static void a_cycle_through_other_pointers_is_refused(void **state)
{
    (void)state;
    struct format *format = parse("{*!, *!}");
    struct node a = {NULL, NULL}, b = {&a, NULL};
    a.left = &b;
    assert_refused(format, &a, ERR_DEPTH);
    format_unref(format);
}

static void nesting_is_bounded_but_not_by_the_stack(void **state)
{
    (void)state;
    struct format *format = parse("{*!, *!}");
    enum { N_NODES = LIMIT_DATA_DEPTH + 2 };
    static struct node nodes[N_NODES];
    for (int i = 0; i + 1 < N_NODES; i++) {
        nodes[i].left = &nodes[i + 1];
    }
    assert_refused(format, &nodes[0], ERR_DEPTH);
    size_t length;
    assert_int_equal(format_measure(format, &nodes[2], &length), 0);
    assert_int_equal(length, 2 * LIMIT_DATA_DEPTH);
    format_unref(format);
}

static void content_beyond_the_limit_is_refused_before_it_is_copied(void **state)
{
    (void)state;
    struct arrays {
        int count;
        const double *first;
        const double *second;
    };
    const double one = 1;
    const struct arrays value = {INT32_MAX, &one, &one};
    struct format *format = parse("{int, <double:1>, <double:1>}");
    assert_refused(format, &value, ERR_LIMIT);
    format_unref(format);
}

static void encoding_appends_behind_what_is_there(void **state)
{
    (void)state;
    struct buffer out;
    const int value = 0x01020304;
    struct format *format = parse("int");
    buffer_init(&out);
    assert_int_equal(buffer_append(&out, "ab", 2), 0);
    assert_int_equal(format_encode(format, &value, ORDER_BIG, &out), 0);
    assert_int_equal(format_encode(format, &value, ORDER_LITTLE, &out), 0);
    assert_int_equal(out.length, 10);
    assert_memory_equal(out.bytes, "ab\1\2\3\4\4\3\2\1", 10);
    format_unref(format);
    buffer_fini(&out);
}

static void no_value_fits_an_array_that_refers_to_itself(void **state)
{
    (void)state;
    struct value {
        int *pointer;
        void *elements;
        int kind;
    } value = {NULL, NULL, 0};
    struct format *format = parse("{*int, <{int, float}:2>, {enum A, B}}");
    assert_int_equal(format_size(format), sizeof value);
    assert_refused(format, &value, ERR_RANGE);
    format_unref(format);
}

static void references_travel_as_number_and_name(void **state)
{
    (void)state;
    static char name[] = "go";
    struct format_reference reference = {5, name};
    struct format_reference *value = &reference;
    struct format *format = parse("X_IPC_REF_PTR");
    struct buffer out;
    buffer_init(&out);
    assert_int_equal(format_encode(format, &value, ORDER_BIG, &out), 0);
    assert_int_equal(out.length, 10);
    assert_memory_equal(out.bytes, "\0\0\0\5\0\0\0\2go", 10);
    size_t length;
    assert_int_equal(format_measure(format, &value, &length), 0);
    assert_int_equal(length, 10);

    const struct format_source source = {out.bytes, out.length, ORDER_BIG};
    struct format_reference *decoded;
    assert_int_equal(format_decode(format, &source, &decoded, NULL), 0);
    assert_int_equal(decoded->number, 5);
    assert_string_equal(decoded->name, "go");
    assert_int_equal(format_release(format, &decoded), 0);
    assert_null(decoded);
    value = NULL;
    assert_refused(format, &value, ERR_NULL);
    buffer_fini(&out);
    format_unref(format);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_is_encoded_without_a_format),
        cmocka_unit_test(a_missing_value_is_refused),
        cmocka_unit_test(the_bad_format_fits_no_value),
        cmocka_unit_test(a_missing_array_with_a_count_is_refused),
        cmocka_unit_test(impossible_dimensions_are_refused),
        cmocka_unit_test(dimensions_are_read_with_the_type_of_their_field),
        cmocka_unit_test(a_list_that_bites_its_tail_is_refused),
        cmocka_unit_test(a_cycle_through_other_pointers_is_refused),
        cmocka_unit_test(nesting_is_bounded_but_not_by_the_stack),
        cmocka_unit_test(content_beyond_the_limit_is_refused_before_it_is_copied),
        cmocka_unit_test(encoding_appends_behind_what_is_there),
        cmocka_unit_test(no_value_fits_an_array_that_refers_to_itself),
        cmocka_unit_test(references_travel_as_number_and_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
