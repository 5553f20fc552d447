/*
 * Damaged content and damaged formats: whatever happens to their bytes, nothing
 * crashes, nothing is read beyond the end, nothing leaks.  The damage is the same
 * in every run.
 */
#include "vectors.h"

#include <stdlib.h>
#include <string.h>

#include "value.h"

enum { MUTATIONS_PER_CASE = 800, LARGEST_CASE = 2000 };

static uint32_t next_random(uint32_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    return *state;
}

/* Damages a copy of content in one to three places and returns its new length. */
static size_t damage(uint8_t *copy, const uint8_t *content, size_t length, uint32_t *random)
{
    static const uint8_t special[] = {0x00, 0x01, 0x7f, 0x80, 0xff, 0x5a};
    memcpy(copy, content, length);
    for (uint32_t n = next_random(random) % 3 + 1; n > 0 && length > 0; n--) {
        const size_t at = next_random(random) % length;
        switch (next_random(random) % 5) {
        case 0:
            copy[at] ^= (uint8_t)(1u << next_random(random) % 8);
            break;
        case 1:
            copy[at] = special[next_random(random) % sizeof special];
            break;
        case 2:
            copy[at] = (uint8_t)(copy[at] + (next_random(random) % 2 == 0 ? 1 : 255));
            break;
        case 3:
            memmove(copy + at, copy + at + 1, length - at - 1);
            length--;
            break;
        default:
            length = at;
        }
    }
    return length;
}

/* Decodes the bytes from a block that ends with them and uses the result in every way. */
static bool try_to_decode(const struct format *format, const uint8_t *bytes, size_t length,
                          enum byte_order order)
{
    uint8_t *exact = malloc(length > 0 ? length : 1);
    assert_non_null(exact);
    if (length > 0) {
        memcpy(exact, bytes, length);
    }
    const struct format_source source = {exact, length, order};
    void *value;
    size_t used = 0;
    const bool decoded = format_decode_new(format, &source, &value, &used) == 0;
    free(exact);
    if (decoded) {
        struct buffer out;
        size_t measured;
        buffer_init(&out);
        assert_true(used <= length);
        assert_int_equal(format_print(format, value, 0, &out), 0);
        buffer_clear(&out);
        assert_int_equal(format_encode(format, value, order, &out), 0);
        assert_true(out.length <= used); /* strings end at a NUL inside them */
        assert_int_equal(format_measure(format, value, &measured), 0);
        assert_int_equal(measured, out.length);
        buffer_fini(&out);
    }
    value_free(format, value);
    return decoded;
}

static void damaged_content_never_crashes(void **state)
{
    (void)state;
    struct json *vectors = json_read_vectors("cases.json");
    const struct json *list = json_get(vectors, "cases");
    uint32_t random = 20240229;
    unsigned n_decoded = 0, n_refused = 0;
    for (size_t i = 0; i < list->length; i++) {
        const struct json *entry = list->parts[i];
        const struct json *hex = json_find(json_get(entry, "little_endian"), "hex");
        if (hex == NULL || hex->length / 2 > LARGEST_CASE || !vectors_bytes_fit_host(entry)) {
            continue;
        }
        size_t length;
        uint8_t *content = json_bytes(hex, &length);
        uint8_t copy[LARGEST_CASE];
        struct format *format = vectors_format(entry);
        for (int k = 0; k < MUTATIONS_PER_CASE; k++) {
            const size_t damaged = damage(copy, content, length, &random);
            const enum byte_order order = k % 8 == 0 ? ORDER_BIG : ORDER_LITTLE;
            if (try_to_decode(format, copy, damaged, order)) {
                n_decoded++;
            } else {
                n_refused++;
            }
        }
        format_unref(format);
        free(content);
    }
    assert_true(n_decoded > 10000);
    assert_true(n_refused > 10000);
    json_free(vectors);
}

static void damaged_images_of_formats_never_crash(void **state)
{
    (void)state;
    struct json *vectors = json_read_vectors("format_encoding.json");
    const struct json *list = json_get(vectors, "cases");
    struct format *carrier = must_parse("format");
    uint32_t random = 77;
    for (size_t i = 0; i < list->length; i++) {
        size_t length;
        uint8_t *content =
            json_bytes(json_get(json_get(list->parts[i], "little_endian"), "hex"), &length);
        uint8_t copy[LARGEST_CASE];
        assert_true(length <= sizeof copy);
        for (int k = 0; k < MUTATIONS_PER_CASE; k++) {
            const size_t damaged = damage(copy, content, length, &random);
            struct format_source source = {copy, damaged, ORDER_LITTLE};
            struct format *format;
            if (format_decode(carrier, &source, &format, NULL) != 0) {
                continue;
            }
            char *canonical = format_canonical(format);
            assert_non_null(canonical);
            free(canonical);
            format_unref(format);
        }
        free(content);
    }
    format_unref(carrier);
    json_free(vectors);
}

static void damaged_format_strings_never_crash(void **state)
{
    (void)state;
    static const char pieces[] = "{}[]<>,:*!0123 intcharenum\t\n";
    struct json *vectors = json_read_vectors("corpus.json");
    const struct json *list = json_get(vectors, "formats");
    uint32_t random = 1;
    for (int k = 0; k < 40000; k++) {
        const struct json *text =
            json_get(list->parts[next_random(&random) % list->length], "format");
        if (text->length == 0 || text->length > LARGEST_CASE) {
            continue;
        }
        char copy[LARGEST_CASE + 1];
        memcpy(copy, text->text, text->length + 1);
        for (uint32_t n = next_random(&random) % 4; n > 0; n--) {
            copy[next_random(&random) % text->length] =
                pieces[next_random(&random) % (sizeof pieces - 1)];
        }
        struct format *format;
        struct format_diagnosis diagnosis;
        int error = format_parse(copy, NULL, &format, &diagnosis);
        if (error != 0) {
            assert_non_null(diagnosis.text);
        } else {
            assert_non_null(format);
        }
        assert_true(diagnosis.position <= text->length);
        free(diagnosis.text);
        format_unref(format);
    }
    json_free(vectors);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(damaged_content_never_crashes),
        cmocka_unit_test(damaged_images_of_formats_never_crash),
        cmocka_unit_test(damaged_format_strings_never_crash),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
