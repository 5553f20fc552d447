/*
 * The recorded cases: a format and a value, its bytes in both orders, its size
 * and layout, its printed text, and the value after a round trip.
 */
#include "vectors.h"

#include <stdlib.h>
#include <string.h>

#include "format/handle.h"
#include "sha256.h"
#include "value.h"

struct recorded {
    const struct json *entry;
    const char *name;
    struct format *format;
    void *value;
};

static struct json *vectors;

static int read_vectors(void **state)
{
    (void)state;
    vectors = json_read_vectors("cases.json");
    return 0;
}

static int free_vectors(void **state)
{
    (void)state;
    json_free(vectors);
    return 0;
}

static void *build(const struct format *format, const struct json *json)
{
    if (json->kind == JSON_OBJECT && json_find(json, "generator") != NULL) {
        void *value = value_generate(format, json_get(json, "generator")->text);
        assert_non_null(value);
        return value;
    }
    return value_build(format, json);
}

static void for_each_case(void (*check)(const struct recorded *recorded))
{
    const struct json *cases = json_get(vectors, "cases");
    size_t n_checked = 0;
    for (size_t i = 0; i < cases->length; i++) {
        struct recorded recorded = {.entry = cases->parts[i]};
        if (!vectors_bytes_fit_host(recorded.entry)) {
            continue;
        }
        n_checked++;
        recorded.name = json_get(recorded.entry, "name")->text;
        recorded.format = vectors_format(recorded.entry);
        recorded.value = build(recorded.format, json_get(recorded.entry, "value"));
        check(&recorded);
        value_free(recorded.format, recorded.value);
        format_unref(recorded.format);
    }
    assert_true(n_checked >= (sizeof(long) == 8 ? 312 : 260));
}

/* The recorded bytes, or those encoded when only their digest is recorded. */
static void encode(const struct recorded *recorded, enum byte_order order, struct buffer *out)
{
    buffer_init(out);
    if (format_encode(recorded->format, recorded->value, order, out) != 0) {
        fail_msg("%s: cannot be encoded", recorded->name);
    }
}

static void check_bytes(const struct recorded *recorded, enum byte_order order, const char *key)
{
    const struct json *expected = json_get(recorded->entry, key);
    struct buffer out;
    encode(recorded, order, &out);
    if (out.length != (size_t)json_get(expected, "length")->integer) {
        fail_msg("%s: %zu bytes in %s", recorded->name, out.length, key);
    }
    const struct json *hex = json_find(expected, "hex");
    if (hex != NULL) {
        size_t length;
        uint8_t *bytes = json_bytes(hex, &length);
        if (length > 0 && memcmp(out.bytes, bytes, length) != 0) {
            fail_msg("%s: other bytes in %s", recorded->name, key);
        }
        free(bytes);
    } else {
        char digest[65];
        sha256_hex(out.bytes, out.length, digest);
        assert_string_equal(digest, json_get(expected, "sha256")->text);
    }
    buffer_fini(&out);
}

static void check_encoding(const struct recorded *recorded)
{
    check_bytes(recorded, ORDER_LITTLE, "little_endian");
    check_bytes(recorded, ORDER_BIG, "big_endian");
}

static void every_value_encodes_to_the_recorded_bytes_in_both_orders(void **state)
{
    (void)state;
    for_each_case(check_encoding);
}

static void check_measure(const struct recorded *recorded)
{
    size_t length = 0;
    assert_int_equal(format_measure(recorded->format, recorded->value, &length), 0);
    const struct json *expected = json_get(recorded->entry, "little_endian");
    if (length != (size_t)json_get(expected, "length")->integer) {
        fail_msg("%s: measured %zu bytes", recorded->name, length);
    }
}

static void every_value_measures_what_it_encodes_to(void **state)
{
    (void)state;
    for_each_case(check_measure);
}

/* Decodes the bytes, which end at the end of their block, and compares with what is expected. */
static void check_decoded(const struct recorded *recorded, enum byte_order order,
                          const void *expected)
{
    struct buffer out;
    encode(recorded, order, &out);
    uint8_t *exact = malloc(out.length > 0 ? out.length : 1);
    assert_non_null(exact);
    if (out.length > 0) {
        memcpy(exact, out.bytes, out.length);
    }
    const struct format_source source = {exact, out.length, order};
    void *decoded;
    size_t used;
    if (format_decode_new(recorded->format, &source, &decoded, &used) != 0) {
        fail_msg("%s: cannot be decoded", recorded->name);
    }
    assert_int_equal(used, out.length);
    if (!value_same(recorded->format, decoded, expected)) {
        fail_msg("%s: decoded to another value", recorded->name);
    }
    value_free(recorded->format, decoded);
    free(exact);
    buffer_fini(&out);
}

static void check_decoding(const struct recorded *recorded)
{
    const struct json *after = json_find(recorded->entry, "value_after");
    void *expected = after == NULL ? recorded->value : build(recorded->format, after);
    check_decoded(recorded, ORDER_LITTLE, expected);
    check_decoded(recorded, ORDER_BIG, expected);
    if (after != NULL) {
        value_free(recorded->format, expected);
    }
}

static void every_value_survives_encoding_and_decoding_in_both_orders(void **state)
{
    (void)state;
    for_each_case(check_decoding);
}

static void check_unbounded(const struct recorded *recorded)
{
    struct buffer out;
    encode(recorded, ORDER_LITTLE, &out);
    const struct format_source source = {out.bytes, SIZE_MAX, ORDER_LITTLE};
    void *decoded;
    size_t used;
    assert_int_equal(format_decode_new(recorded->format, &source, &decoded, &used), 0);
    assert_int_equal(used, out.length);
    value_free(recorded->format, decoded);
    buffer_fini(&out);
}

static void decoding_without_a_known_length_uses_the_same_bytes(void **state)
{
    (void)state;
    for_each_case(check_unbounded);
}

static void check_truncated(const struct recorded *recorded)
{
    struct buffer out;
    encode(recorded, ORDER_LITTLE, &out);
    const size_t step = out.length / 200 + 1;
    for (size_t length = 0; length < out.length; length += step) {
        uint8_t *exact = malloc(length > 0 ? length : 1);
        assert_non_null(exact);
        memcpy(exact, out.bytes, length);
        const struct format_source source = {exact, length, ORDER_LITTLE};
        void *decoded;
        if (format_decode_new(recorded->format, &source, &decoded, NULL) == 0) {
            fail_msg("%s: decoded from %zu bytes", recorded->name, length);
        }
        assert_null(decoded);
        free(exact);
    }
    buffer_fini(&out);
}

static void no_beginning_of_the_bytes_decodes(void **state)
{
    (void)state;
    for_each_case(check_truncated);
}

static const struct json *find_first(const struct json *entry, const char *key, const char *other)
{
    const struct json *found = json_find(entry, key);
    return found != NULL ? found : json_get(entry, other);
}

static void check_text(const struct recorded *recorded, const void *value,
                       const struct json *expected)
{
    struct buffer out;
    buffer_init(&out);
    assert_int_equal(format_print(recorded->format, value, 0, &out), 0);
    if (out.length != expected->length || memcmp(out.bytes, expected->text, out.length) != 0) {
        fail_msg("%s: printed\n%.*sinstead of\n%s", recorded->name, (int)out.length, out.bytes,
                 expected->text);
    }
    buffer_fini(&out);
}

static void check_print(const struct recorded *recorded)
{
    check_text(recorded, recorded->value, find_first(recorded->entry, "print_required", "print"));
}

static void every_value_prints_as_recorded(void **state)
{
    (void)state;
    for_each_case(check_print);
}

static void check_print_after(const struct recorded *recorded)
{
    const struct json *after = json_find(recorded->entry, "value_after");
    if (after == NULL) {
        return;
    }
    void *value = build(recorded->format, after);
    check_text(recorded, value, find_first(recorded->entry, "print_after_required", "print_after"));
    value_free(recorded->format, value);
}

static void every_value_prints_as_recorded_after_a_round_trip(void **state)
{
    (void)state;
    for_each_case(check_print_after);
}

static void check_release(const struct recorded *recorded)
{
    assert_int_equal(format_release(recorded->format, recorded->value), 0);
    assert_int_equal(format_release(recorded->format, recorded->value), 0);
}

static void every_value_may_be_released_twice(void **state)
{
    (void)state;
    for_each_case(check_release);
}

static void check_size(const struct recorded *recorded)
{
    assert_int_equal(format_size(recorded->format), json_get(recorded->entry, "sizeof")->integer);
    assert_int_equal(format_is_simple(recorded->format),
                     json_get(recorded->entry, "simple")->truth);
}

static void every_format_has_the_recorded_size_and_simplicity(void **state)
{
    (void)state;
    if (!vectors_fit_host()) {
        skip();
    }
    for_each_case(check_size);
}

static void check_structures(const struct recorded *recorded)
{
    const struct json *list = json_get(recorded->entry, "structs");
    for (size_t i = 0; i < list->length; i++) {
        const struct json *entry = list->parts[i];
        struct format *format = must_parse(json_get(entry, "format")->text);
        const struct json *offsets = json_get(entry, "offsets");
        assert_int_equal(format_size(format), json_get(entry, "sizeof")->integer);
        assert_int_equal(format_alignment(format), json_get(entry, "align")->integer);
        assert_int_equal(format->type->n_members, offsets->length);
        for (size_t k = 0; k < offsets->length; k++) {
            assert_int_equal(format->type->members[k]->offset, offsets->parts[k]->integer);
        }
        format_unref(format);
    }
}

static void every_structure_inside_has_the_recorded_layout(void **state)
{
    (void)state;
    if (!vectors_fit_host()) {
        skip();
    }
    for_each_case(check_structures);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_value_encodes_to_the_recorded_bytes_in_both_orders),
        cmocka_unit_test(every_value_measures_what_it_encodes_to),
        cmocka_unit_test(every_value_survives_encoding_and_decoding_in_both_orders),
        cmocka_unit_test(decoding_without_a_known_length_uses_the_same_bytes),
        cmocka_unit_test(no_beginning_of_the_bytes_decodes),
        cmocka_unit_test(every_value_prints_as_recorded),
        cmocka_unit_test(every_value_prints_as_recorded_after_a_round_trip),
        cmocka_unit_test(every_value_may_be_released_twice),
        cmocka_unit_test(every_format_has_the_recorded_size_and_simplicity),
        cmocka_unit_test(every_structure_inside_has_the_recorded_layout),
    };
    return cmocka_run_group_tests(tests, read_vectors, free_vectors);
}
