/*
 * Decoding what a peer may send.  That nothing is read beyond the content and
 * nothing leaks is checked by the sanitizers the tests are run under: every
 * content ends where its block ends.
 */
#include "vectors.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/limits.h"
#include "value.h"

/* A copy of bytes that ends where its block ends; the caller frees it. */
static uint8_t *exactly(const void *bytes, size_t length)
{
    uint8_t *copy = malloc(length > 0 ? length : 1);
    assert_non_null(copy);
    if (length > 0) {
        memcpy(copy, bytes, length);
    }
    return copy;
}

static int decode(const struct format *format, const void *bytes, size_t length,
                  enum byte_order order, void *value, size_t *used)
{
    uint8_t *exact = exactly(bytes, length);
    const struct format_source source = {exact, length, order};
    int error = format_decode(format, &source, value, used);
    free(exact);
    return error;
}

static void malformed_content_is_treated_as_required(void **state)
{
    (void)state;
    struct json *vectors = json_read_vectors("malformed.json");
    const struct json *list = json_get(vectors, "cases");
    assert_true(list->length >= 74);
    for (size_t i = 0; i < list->length; i++) {
        const struct json *entry = list->parts[i];
        const char *required = json_get(entry, "required")->text;
        struct format *format = vectors_format(entry);
        size_t length;
        uint8_t *bytes = json_bytes(json_get(json_get(entry, "bytes"), "hex"), &length);
        uint8_t *exact = exactly(bytes, length);
        const struct format_source source = {exact, length, ORDER_LITTLE};
        void *value;
        int error = format_decode_new(format, &source, &value, NULL);
        if (error != (strcmp(required, "IPC_OK") == 0 ? 0 : ERR_CONTENT)) {
            fail_msg("%s, %s: %d", json_get(entry, "format")->text, json_get(entry, "fault")->text,
                     error);
        }
        assert_int_equal(value != NULL, error == 0);
        value_free(format, value);
        free(exact);
        free(bytes);
        format_unref(format);
    }
    json_free(vectors);
}

static void bytes_left_over_are_reported_and_ignored(void **state)
{
    (void)state;
    struct format *format = must_parse("int");
    int value;
    size_t used;
    assert_int_equal(decode(format, "\1\0\0\0junk", 8, ORDER_LITTLE, &value, &used), 0);
    assert_int_equal(value, 1);
    assert_int_equal(used, 4);
    format_unref(format);
}

static void padding_is_zero(void **state)
{
    (void)state;
    struct format *format = must_parse("{char, int}");
    static const uint8_t expected[8] = {'A', 0, 0, 0, 4, 3, 2, 1};
    uint8_t value[8];
    memset(value, 0xee, sizeof value);
    assert_int_equal(decode(format, "A\4\3\2\1", 5, ORDER_LITTLE, value, NULL), 0);
    assert_memory_equal(value, expected, 1);
    assert_memory_equal(value + 1, "\0\0\0", 3);
    format_unref(format);
}

static void a_failure_leaves_the_value_all_zero(void **state)
{
    (void)state;
    static const uint8_t zero[64];
    /* {2, <"a", "b">, then the second array's count is missing */
    static const char bytes[] = "\2\0\0\0\2\0\0\0\1\0\0\0a\1\0\0\0b\2\0";
    struct format *format = must_parse("{int, <string:1>, <int:1>, string}");
    uint8_t value[64];
    assert_true(format_size(format) <= sizeof value);
    for (size_t length = 0; length < sizeof bytes - 1; length++) {
        memset(value, 0xee, sizeof value);
        assert_int_equal(decode(format, bytes, length, ORDER_LITTLE, value, NULL), ERR_CONTENT);
        assert_memory_equal(value, zero, format_size(format));
    }
    format_unref(format);
    format = must_parse("{int, int}");
    memset(value, 0xee, sizeof value);
    assert_int_equal(decode(format, bytes, 7, ORDER_LITTLE, value, NULL), ERR_CONTENT);
    assert_memory_equal(value, zero, 8);
    format_unref(format);
}

static void an_array_before_its_dimension_is_released_on_failure(void **state)
{
    (void)state;
    uint8_t value[16];
    struct format *format = must_parse("{<string:2>, int}");
    static const char wrong[] = "\2\0\0\0\1\0\0\0a\1\0\0\0b\7\0\0\0";
    assert_int_equal(decode(format, wrong, 18, ORDER_LITTLE, value, NULL), ERR_CONTENT);
    assert_int_equal(decode(format, wrong, 16, ORDER_LITTLE, value, NULL), ERR_CONTENT);
    static const char right[] = "\2\0\0\0\1\0\0\0a\1\0\0\0b\2\0\0\0";
    assert_int_equal(decode(format, right, 18, ORDER_LITTLE, value, NULL), 0);
    assert_int_equal(format_release(format, value), 0);
    format_unref(format);
}

static void nested_arrays_with_late_dimensions_are_told_apart(void **state)
{
    (void)state;
    struct format *format = must_parse("{<{<string:2>, int}:2>, int, <*int:2>, <int:5>, int}");
    struct json *json = json_parse("[[[[\"a\", \"b\"], 2], [[\"c\"], 1], [null, 0]], 3,"
                                   " [{\"ptr\": 1}, null, {\"ptr\": 2}], [7, 8], 2]");
    void *value = value_build(format, json);
    for (enum byte_order order = ORDER_BIG; order <= ORDER_LITTLE; order++) {
        struct buffer out;
        buffer_init(&out);
        assert_int_equal(format_encode(format, value, order, &out), 0);
        uint8_t decoded[64];
        size_t used;
        assert_int_equal(decode(format, out.bytes, out.length, order, decoded, &used), 0);
        assert_int_equal(used, out.length);
        assert_true(value_same(format, value, decoded));
        assert_int_equal(format_release(format, decoded), 0);
        out.bytes[out.length - 1] ^= 1; /* the last dimension, whatever the order */
        out.bytes[out.length - 4] ^= 1;
        assert_int_equal(decode(format, out.bytes, out.length, order, decoded, NULL), ERR_CONTENT);
        for (size_t length = 0; length < out.length; length++) {
            assert_int_equal(decode(format, out.bytes, length, order, decoded, NULL), ERR_CONTENT);
        }
        buffer_fini(&out);
    }
    value_free(format, value);
    json_free(json);
    format_unref(format);
}

static void counts_are_checked_before_memory_is_asked_for(void **state)
{
    (void)state;
    static const struct {
        const char *format;
        const char *bytes;
        size_t length;
    } cases[] = {
        {"{int, <[double:100000]:1>}", "\1\0\0\0\1\0\0\0........", 16},
        {"*[double:200000000]", "\1", 1},
        {"{int, *[double:200000000]}", "\1\0\0\0\1", 5},
        {"{int, <string:1>}", "\xff\xff\xff\x0f\xff\xff\xff\x0f.....", 13},
        {"{int, <*int:1>}", "\x40\x42\x0f\0\x40\x42\x0f\0\0\0\0\0\0", 13},
    };
    uint8_t value[64];
    for (size_t i = 0; i < N_ELEMENTS(cases); i++) {
        struct format *format = must_parse(cases[i].format);
        assert_int_equal(decode(format, cases[i].bytes, cases[i].length, ORDER_LITTLE, value, NULL),
                         ERR_CONTENT);
        format_unref(format);
    }
}

static void without_a_known_length_impossible_numbers_are_still_refused(void **state)
{
    (void)state;
    static const struct {
        const char *format;
        const char *bytes;
    } cases[] = {
        {"string", "\xff\xff\xff\xff....."},
        {"{int, <int:1>}", "\xff\xff\xff\xff\xff\xff\xff\xff...."},
        {"{int, <int:1>}", "\3\0\0\0\2\0\0\0........"},
        {"{int, <double:1>}", "\xff\xff\xff\x7f\xff\xff\xff\x7f...."},
    };
    for (size_t i = 0; i < N_ELEMENTS(cases); i++) {
        struct format *format = must_parse(cases[i].format);
        const struct format_source source = {(const uint8_t *)cases[i].bytes, SIZE_MAX,
                                             ORDER_LITTLE};
        void *value;
        assert_int_equal(format_decode_new(format, &source, &value, NULL), ERR_CONTENT);
        assert_null(value);
        format_unref(format);
    }
}

static void nesting_beyond_the_limit_is_refused(void **state)
{
    (void)state;
    struct format *format = must_parse("{*!, *!}");
    enum { N_LEVELS = LIMIT_DATA_DEPTH + 10 };
    uint8_t *bytes = malloc(3 * N_LEVELS);
    assert_non_null(bytes);
    memset(bytes, 0x5a, 3 * N_LEVELS);
    uint8_t value[16];
    assert_int_equal(decode(format, bytes, 3 * N_LEVELS, ORDER_LITTLE, value, NULL), ERR_DEPTH);
    /* As deep as allowed, and then back to the top. */
    memset(bytes + LIMIT_DATA_DEPTH - 1, 0, 2 * N_LEVELS);
    assert_int_equal(decode(format, bytes, 3 * N_LEVELS, ORDER_LITTLE, value, NULL), 0);
    assert_int_equal(format_release(format, value), 0);
    free(bytes);
    format_unref(format);
}

static void elements_without_size_cost_nothing(void **state)
{
    (void)state;
    struct format *format = must_parse("{int, <{}:1>, <[int:0]:1>}");
    static const char bytes[] = "\xff\xff\xff\x7f\xff\xff\xff\x7f\xff\xff\xff\x7f";
    uint8_t value[64];
    size_t used;
    assert_int_equal(decode(format, bytes, 12, ORDER_LITTLE, value, &used), 0);
    assert_int_equal(used, 12);
    struct buffer out;
    buffer_init(&out);
    assert_int_equal(format_encode(format, value, ORDER_LITTLE, &out), 0);
    assert_int_equal(out.length, 12);
    assert_memory_equal(out.bytes, bytes, 12);
    buffer_fini(&out);
    assert_int_equal(format_release(format, value), 0);
    format_unref(format);
}

static void empty_strings_decode_as_the_process_wants(void **state)
{
    (void)state;
    struct format *format = must_parse("{string, string}");
    static const char bytes[] = "\0\0\0\0Z\1\0\0\0x";
    char *value[2];
    assert_int_equal(decode(format, bytes, 10, ORDER_LITTLE, value, NULL), 0);
    assert_null(value[0]);
    assert_string_equal(value[1], "x");
    assert_int_equal(format_release(format, value), 0);
    assert_null(value[1]);

    size_t used;
    format_set_empty_strings(true);
    assert_int_equal(decode(format, bytes, 10, ORDER_LITTLE, value, &used), 0);
    format_set_empty_strings(false);
    assert_int_equal(used, 10);
    assert_string_equal(value[0], "");
    assert_int_equal(format_release(format, value), 0);
    format_unref(format);
}

static void no_format_and_formats_of_size_zero_decode_to_nothing(void **state)
{
    (void)state;
    const struct format_source source = {NULL, 0, ORDER_LITTLE};
    struct format *format = must_parse("{{}}");
    void *value = &format;
    size_t used = 7;
    assert_int_equal(format_decode_new(NULL, &source, &value, &used), 0);
    assert_null(value);
    assert_int_equal(used, 0);
    assert_int_equal(format_decode_new(format, &source, &value, &used), 0);
    assert_null(value);
    assert_int_equal(format_decode_new(format_bad(), &source, &value, &used), ERR_FORMAT);
    assert_null(value);
    assert_int_equal(format_release(NULL, NULL), 0);
    assert_int_equal(format_release(format_bad(), &value), ERR_FORMAT);
    format_unref(format);
}

static void releasing_refuses_impossible_dimensions_and_releases_the_rest(void **state)
{
    (void)state;
    struct value {
        int count;
        char **strings;
        char *string;
    };
    struct format *format = must_parse("{int, <string:1>, string}");
    char *strings[1] = {NULL};
    struct value value = {-1, strings, malloc(4)};
    assert_int_equal(format_release(format, &value), ERR_RANGE);
    assert_ptr_equal(value.strings, strings);
    assert_null(value.string);
    format_unref(format);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(malformed_content_is_treated_as_required),
        cmocka_unit_test(bytes_left_over_are_reported_and_ignored),
        cmocka_unit_test(padding_is_zero),
        cmocka_unit_test(a_failure_leaves_the_value_all_zero),
        cmocka_unit_test(an_array_before_its_dimension_is_released_on_failure),
        cmocka_unit_test(nested_arrays_with_late_dimensions_are_told_apart),
        cmocka_unit_test(counts_are_checked_before_memory_is_asked_for),
        cmocka_unit_test(without_a_known_length_impossible_numbers_are_still_refused),
        cmocka_unit_test(nesting_beyond_the_limit_is_refused),
        cmocka_unit_test(elements_without_size_cost_nothing),
        cmocka_unit_test(empty_strings_decode_as_the_process_wants),
        cmocka_unit_test(no_format_and_formats_of_size_zero_decode_to_nothing),
        cmocka_unit_test(releasing_refuses_impossible_dimensions_and_releases_the_rest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
