/*
 * Running out of memory at every allocation in turn.
 *
 * The linker leads the allocations of the code under test here (--wrap).  That
 * nothing leaks when one fails is checked by the leak detector the tests are run
 * under.
 */
#include "vectors.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "value.h"

static int allocations_left = -1; /* negative: without end */

static bool may_allocate(void)
{
    if (allocations_left > 0) {
        allocations_left--;
    }
    return allocations_left != 0;
}

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *block, size_t size);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *block, size_t size);

void *__wrap_malloc(size_t size)
{
    return may_allocate() ? __real_malloc(size) : NULL;
}

void *__wrap_calloc(size_t count, size_t size)
{
    return may_allocate() ? __real_calloc(count, size) : NULL;
}

void *__wrap_realloc(void *block, size_t size)
{
    return may_allocate() ? __real_realloc(block, size) : NULL;
}

struct subject {
    const char *format;
    const char *value;
};

static const struct subject subjects[] = {
    {"{int, double, string}", "[1, 2.5, \"abc\"]"},
    {"{int, <{int, string, double}:1>}", "[2, [[1, \"a\", 2], [3, \"bc\", 4]]]"},
    {"{<{<string:2>, int}:2>, int, <*int:2>, <int:2>}",
     "[[[[\"a\", \"b\"], 2], [[\"c\"], 1]], 2, [{\"ptr\": 1}, {\"ptr\": 2}], [7, 8]]"},
    {"{string, *!}", "[\"a\", {\"ptr\": [\"b\", {\"ptr\": [\"c\", null]}]}]"},
    {"{*!, string, *!}", "[{\"ptr\": [{\"ptr\": [null, \"x\", null]}, \"y\", null]}, \"z\", null]"},
    {"[{string, *double}:2]", "[[\"a\", {\"ptr\": 1}], [\"b\", {\"ptr\": 2}]]"},
};

/*
 * Lets every allocation of an action fail in turn: each time it must say that
 * memory is out, and with enough of it it must succeed.
 */
static void fail_in_turn(int (*action)(const struct format *format, const void *argument),
                         const struct format *format, const void *argument)
{
    int result = ERR_MEMORY;
    for (int n = 1; result == ERR_MEMORY; n++) {
        allocations_left = n;
        result = action(format, argument);
        allocations_left = -1;
        assert_true(n < 1000);
    }
    assert_int_equal(result, 0);
}

static void for_each_subject(int (*action)(const struct format *format, const void *argument),
                             bool encoded)
{
    for (size_t i = 0; i < N_ELEMENTS(subjects); i++) {
        struct format *format = must_parse(subjects[i].format);
        struct json *json = json_parse(subjects[i].value);
        void *value = value_build(format, json);
        struct buffer out;
        buffer_init(&out);
        assert_int_equal(format_encode(format, value, ORDER_LITTLE, &out), 0);
        const struct format_source source = {out.bytes, out.length, ORDER_LITTLE};
        fail_in_turn(action, format, encoded ? (const void *)&source : value);
        value_free(format, value);
        buffer_fini(&out);
        json_free(json);
        format_unref(format);
    }
}

static int encode(const struct format *format, const void *value)
{
    struct buffer out;
    buffer_init(&out);
    int error = format_encode(format, value, ORDER_BIG, &out);
    assert_int_equal(out.length > 0, error == 0);
    buffer_fini(&out);
    return error;
}

static int decode(const struct format *format, const void *source)
{
    void *value;
    int error = format_decode_new(format, source, &value, NULL);
    assert_int_equal(value != NULL, error == 0);
    if (error == 0) {
        value_free(format, value);
    }
    return error;
}

static int print(const struct format *format, const void *value)
{
    struct buffer out;
    buffer_init(&out);
    int error = format_print(format, value, 0, &out);
    assert_int_equal(out.length > 0, error == 0);
    buffer_fini(&out);
    return error;
}

static void encoding_survives_every_failure(void **state)
{
    (void)state;
    for_each_subject(encode, false);
}

static void decoding_survives_every_failure(void **state)
{
    (void)state;
    for_each_subject(decode, true);
}

static void printing_survives_every_failure(void **state)
{
    (void)state;
    for_each_subject(print, false);
}

static void decoding_deep_content_survives_every_failure(void **state)
{
    (void)state;
    static uint8_t content[402]; /* 200 levels to the left, and then nothing */
    struct format *format = must_parse("{*!, *!}");
    memset(content, 0x5a, 200);
    const struct format_source source = {content, sizeof content, ORDER_LITTLE};
    for (int n = 1; n < 220; n++) {
        void *value;
        allocations_left = n;
        int error = format_decode_new(format, &source, &value, NULL);
        allocations_left = -1;
        assert_true(error == 0 || error == ERR_MEMORY);
        if (error == 0) {
            value_free(format, value);
        }
    }
    format_unref(format);
}

static void reading_survives_every_failure(void **state)
{
    (void)state;
    struct format *format = must_parse("{<{<string:2>, int}:2>, int, <*int:2>}");
    FILE *stream = tmpfile();
    assert_non_null(stream);
    (void)fputs("{<{<\"a\", \"b\">, 2}, {<\"c\">, 1}>, 2, <*1, *2>}", stream);
    int error = ERR_MEMORY;
    for (int n = 1; error == ERR_MEMORY; n++) {
        uint64_t value[8];
        rewind(stream);
        allocations_left = n;
        error = format_read(format, stream, value);
        allocations_left = -1;
        if (error == 0) {
            assert_int_equal(format_release(format, value), 0);
        }
    }
    assert_int_equal(error, 0);
    (void)fclose(stream);
    format_unref(format);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(encoding_survives_every_failure),
        cmocka_unit_test(decoding_survives_every_failure),
        cmocka_unit_test(printing_survives_every_failure),
        cmocka_unit_test(decoding_deep_content_survives_every_failure),
        cmocka_unit_test(reading_survives_every_failure),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
