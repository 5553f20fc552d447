/*
 * Formats as data: the primitive "format".
 */
#include "vectors.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/limits.h"

static struct format *carrier; /* the format "format" */

static int make_carrier(void **state)
{
    (void)state;
    carrier = must_parse("format");
    return 0;
}

static int free_carrier(void **state)
{
    (void)state;
    format_unref(carrier);
    return 0;
}

static int decode(const uint8_t *bytes, size_t length, enum byte_order order,
                  struct format **format, size_t *used)
{
    uint8_t *exact = malloc(length > 0 ? length : 1);
    assert_non_null(exact);
    if (length > 0) {
        memcpy(exact, bytes, length);
    }
    const struct format_source source = {exact, length, order};
    int error = format_decode(carrier, &source, format, used);
    free(exact);
    return error;
}

static void check_image(struct format *format, enum byte_order order, const struct json *image)
{
    struct buffer out;
    size_t length, measured;
    uint8_t *bytes = json_bytes(json_get(image, "hex"), &length);
    buffer_init(&out);
    assert_int_equal(format_encode(carrier, &format, order, &out), 0);
    assert_int_equal(out.length, length);
    assert_memory_equal(out.bytes, bytes, length);
    assert_int_equal(format_measure(carrier, &format, &measured), 0);
    assert_int_equal(measured, length);

    struct format *decoded;
    size_t used;
    assert_int_equal(decode(bytes, length, order, &decoded, &used), 0);
    assert_int_equal(used, length);
    assert_true(format_equal(decoded, format));
    assert_int_equal(format_release(carrier, &decoded), 0);
    assert_null(decoded);
    for (size_t shorter = 0; shorter < length; shorter++) {
        assert_int_equal(decode(bytes, shorter, order, &decoded, NULL), ERR_CONTENT);
        assert_null(decoded);
    }
    buffer_fini(&out);
    free(bytes);
}

/* The canonical texts of the vectors were printed: without the line breaks they are on one line. */
static void check_canonical(const struct format *format, const struct json *printed)
{
    struct buffer out;
    buffer_init(&out);
    assert_int_equal(format_print(carrier, &format, 0, &out), 0);
    assert_int_equal(buffer_append(&out, "", 1), 0);
    const bool is_empty_structure = strcmp(printed->text, "{\n") == 0; /* "{" in the original */
    assert_string_equal(out.bytes, is_empty_structure ? "{}\n" : printed->text);
    buffer_fini(&out);
}

static void every_format_has_the_recorded_image_in_both_orders(void **state)
{
    (void)state;
    struct json *vectors = json_read_vectors("format_encoding.json");
    const struct json *list = json_get(vectors, "cases");
    assert_true(list->length >= 41);
    for (size_t i = 0; i < list->length; i++) {
        const struct json *entry = list->parts[i];
        const char *text = json_text(json_get(entry, "format"));
        struct format *format = text == NULL ? NULL : must_parse(text);
        check_image(format, ORDER_LITTLE, json_get(entry, "little_endian"));
        check_image(format, ORDER_BIG, json_get(entry, "big_endian"));
        check_canonical(format, json_get(entry, "canonical"));
        format_unref(format);
    }
    json_free(vectors);
}

static void every_format_in_real_use_survives_a_round_trip(void **state)
{
    (void)state;
    struct json *vectors = json_read_vectors("corpus.json");
    const struct json *list = json_get(vectors, "formats");
    for (size_t i = 0; i < list->length; i++) {
        struct format *format = vectors_format(list->parts[i]);
        struct format *decoded;
        struct buffer out;
        buffer_init(&out);
        assert_int_equal(format_encode(carrier, &format, ORDER_BIG, &out), 0);
        assert_int_equal(decode(out.bytes, out.length, ORDER_BIG, &decoded, NULL), 0);
        assert_true(format_equal(decoded, format));
        assert_int_equal(format_size(decoded), format_size(format));
        format_unref(decoded);
        format_unref(format);
        buffer_fini(&out);
    }
    json_free(vectors);
}

/* Big-endian numbers from a list. */
static void build(struct buffer *out, const int32_t *numbers, size_t count)
{
    buffer_init(out);
    for (size_t i = 0; i < count; i++) {
        uint8_t bytes[4];
        store_be32(bytes, (uint32_t)numbers[i]);
        assert_int_equal(buffer_append(out, bytes, 4), 0);
    }
}

static void images_that_break_a_rule_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *rule;
        size_t count;
        int32_t numbers[12];
    } cases[] = {
        {"unknown kind", 2, {9, 1}},
        {"named, unresolved", 3, {7, 1, 0x61000000}},
        {"no format inside", 3, {2, 2, -1}},
        {"unknown primitive", 2, {0, 31}},
        {"primitive of an ancestor", 2, {0, 10}},
        {"negative primitive", 2, {0, -1}},
        {"negative length of raw bytes", 2, {1, -1}},
        {"structure of -1 members", 2, {2, 0}},
        {"structure of far too many members", 4, {2, 2147483647, 0, 1}},
        {"structure of INT32_MIN members", 4, {2, -2147483647 - 1, 0, 1}},
        {"fixed array without dimension", 4, {4, 2, 0, 1}},
        {"fixed array of negative dimension", 5, {4, 3, 0, 1, -1}},
        {"fixed array beyond the size limit", 5, {4, 3, 0, 1, 2147483647}},
        {"variable array on its own", 5, {5, 3, 0, 1, 1}},
        {"variable array that refers to itself", 7, {2, 2, 5, 3, 0, 1, 1}},
        {"variable array that refers beyond the structure", 9, {2, 3, 0, 1, 5, 3, 0, 1, 3}},
        {"variable array that refers to a double", 9, {2, 3, 0, 4, 5, 3, 0, 1, 1}},
        {"enumeration of -1 names", 3, {8, 1, 0}},
        {"enumeration with too many names", 4, {8, 1000, 0, 0}},
        {"enumeration with a negative largest value", 3, {8, 2, -1}},
        {"enumeration whose largest value is not its last", 5, {8, 3, 5, 1, 0x61000000}},
    };
    for (size_t i = 0; i < N_ELEMENTS(cases); i++) {
        struct buffer out;
        struct format *format;
        build(&out, cases[i].numbers, cases[i].count);
        if (decode(out.bytes, out.length, ORDER_BIG, &format, NULL) != ERR_CONTENT) {
            fail_msg("%s: accepted", cases[i].rule);
        }
        buffer_fini(&out);
    }
}

static void self_pointers_stand_in_structures_only(void **state)
{
    (void)state;
    static const uint8_t alone[] = {0, 0, 0, 3, 0};
    static const uint8_t behind_pointer[] = {0, 0, 0, 2,    0, 0, 0, 2, 0,
                                             0, 0, 3, 0x5a, 0, 0, 0, 3, 0};
    static const uint8_t in_structure[] = {0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, 3, 0};
    struct format *format;
    assert_int_equal(decode(alone, sizeof alone, ORDER_BIG, &format, NULL), ERR_CONTENT);
    assert_int_equal(decode(behind_pointer, sizeof behind_pointer, ORDER_BIG, &format, NULL),
                     ERR_CONTENT);
    assert_int_equal(decode(in_structure, sizeof in_structure, ORDER_BIG, &format, NULL), 0);
    format_unref(format);
}

static void a_bad_format_anywhere_makes_the_whole_bad(void **state)
{
    (void)state;
    static const int32_t whole[] = {6}, inside[] = {2, 3, 0, 1, 6}, target[] = {4, 3, 6, 2};
    struct buffer out;
    struct format *format;
    build(&out, whole, 1);
    assert_int_equal(decode(out.bytes, out.length, ORDER_BIG, &format, NULL), 0);
    assert_true(format_is_bad(format));
    buffer_fini(&out);
    buffer_init(&out);
    assert_int_equal(format_encode(carrier, &format, ORDER_BIG, &out), 0);
    assert_int_equal(out.length, 4);
    assert_memory_equal(out.bytes, "\0\0\0\6", 4);
    buffer_fini(&out);
    build(&out, inside, 5);
    assert_int_equal(decode(out.bytes, out.length, ORDER_BIG, &format, NULL), 0);
    assert_true(format_is_bad(format));
    buffer_fini(&out);
    build(&out, target, 4);
    assert_int_equal(decode(out.bytes, out.length, ORDER_BIG, &format, NULL), 0);
    assert_true(format_is_bad(format));
    buffer_fini(&out);
}

static void nesting_and_parts_are_bounded(void **state)
{
    (void)state;
    struct buffer out;
    struct format *format;
    buffer_init(&out);
    for (int i = 0; i < LIMIT_FORMAT_DEPTH; i++) {
        assert_int_equal(buffer_append(&out, "\0\0\0\3Z", 5), 0);
    }
    assert_int_equal(buffer_append(&out, "\0\0\0\0\0\0\0\1", 8), 0);
    assert_int_equal(decode(out.bytes, out.length, ORDER_BIG, &format, NULL), ERR_CONTENT);
    assert_int_equal(decode(out.bytes + 5, out.length - 5, ORDER_BIG, &format, NULL), 0);
    format_unref(format);
    buffer_clear(&out);
    uint8_t count[4];
    store_be32(count, LIMIT_FORMAT_NODES + 1);
    assert_int_equal(buffer_append(&out, "\0\0\0\2", 4), 0);
    assert_int_equal(buffer_append(&out, count, 4), 0);
    for (int i = 0; i < LIMIT_FORMAT_NODES; i++) {
        assert_int_equal(buffer_append(&out, "\0\0\0\0\0\0\0\1", 8), 0);
    }
    assert_int_equal(decode(out.bytes, out.length, ORDER_BIG, &format, NULL), ERR_CONTENT);
    buffer_fini(&out);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_format_has_the_recorded_image_in_both_orders),
        cmocka_unit_test(every_format_in_real_use_survives_a_round_trip),
        cmocka_unit_test(images_that_break_a_rule_are_refused),
        cmocka_unit_test(self_pointers_stand_in_structures_only),
        cmocka_unit_test(a_bad_format_anywhere_makes_the_whole_bad),
        cmocka_unit_test(nesting_and_parts_are_bounded),
    };
    return cmocka_run_group_tests(tests, make_carrier, free_carrier);
}
