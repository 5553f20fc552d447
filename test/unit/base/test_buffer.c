/*
 * Growing runs of bytes.
 */
#include "unit.h"

#include <stdlib.h>

#include "base/buffer.h"
#include "base/error.h"

static void appended_bytes_follow_each_other(void **state)
{
    (void)state;
    struct buffer buffer;
    buffer_init(&buffer);
    assert_int_equal(buffer_append(&buffer, "abc", 3), 0);
    assert_int_equal(buffer_append(&buffer, "", 0), 0);
    assert_int_equal(buffer_append(&buffer, "defg", 4), 0);
    assert_int_equal(buffer.length, 7);
    assert_memory_equal(buffer.bytes, "abcdefg", 7);
    buffer_fini(&buffer);
    assert_null(buffer.bytes);
    assert_int_equal(buffer.capacity, 0);
}

static void content_survives_growth(void **state)
{
    (void)state;
    struct buffer buffer;
    buffer_init(&buffer);
    for (unsigned i = 0; i < 10000; i++) {
        uint8_t *at = buffer_extend(&buffer, 1);
        assert_non_null(at);
        *at = (uint8_t)(i * 7);
    }
    for (unsigned i = 0; i < 10000; i++) {
        assert_int_equal(buffer.bytes[i], (uint8_t)(i * 7));
    }
    assert_true(buffer.capacity < 4 * buffer.length);
    buffer_fini(&buffer);
}

static void extending_by_nothing_succeeds(void **state)
{
    (void)state;
    struct buffer buffer;
    buffer_init(&buffer);
    assert_non_null(buffer_extend(&buffer, 0));
    assert_int_equal(buffer.length, 0);
    buffer_fini(&buffer);
}

static void reserved_room_is_not_moved_later(void **state)
{
    (void)state;
    struct buffer buffer;
    buffer_init(&buffer);
    assert_int_equal(buffer_reserve(&buffer, 5000), 0);
    const uint8_t *before = buffer.bytes;
    for (unsigned i = 0; i < 5000; i++) {
        assert_int_equal(buffer_append(&buffer, "x", 1), 0);
    }
    assert_ptr_equal(buffer.bytes, before);
    buffer_fini(&buffer);
}

static void an_impossible_size_leaves_the_content_alone(void **state)
{
    (void)state;
    struct buffer buffer;
    buffer_init(&buffer);
    assert_int_equal(buffer_append(&buffer, "abc", 3), 0);
    assert_int_equal(buffer_reserve(&buffer, SIZE_MAX), ERR_MEMORY);
    assert_int_equal(buffer_reserve(&buffer, SIZE_MAX - 3), ERR_MEMORY);
    assert_null(buffer_extend(&buffer, (size_t)PTRDIFF_MAX - 1));
    assert_int_equal(buffer.length, 3);
    assert_memory_equal(buffer.bytes, "abc", 3);
    buffer_fini(&buffer);
}

static void clearing_keeps_the_memory(void **state)
{
    (void)state;
    struct buffer buffer;
    buffer_init(&buffer);
    assert_int_equal(buffer_append(&buffer, "abc", 3), 0);
    size_t capacity = buffer.capacity;
    buffer_clear(&buffer);
    assert_int_equal(buffer.length, 0);
    assert_int_equal(buffer.capacity, capacity);
    buffer_fini(&buffer);
}

static void taking_moves_the_content_out(void **state)
{
    (void)state;
    struct buffer buffer;
    buffer_init(&buffer);
    size_t length = 99;
    assert_null(buffer_take(&buffer, &length));
    assert_int_equal(length, 0);
    assert_int_equal(buffer_append(&buffer, "abc", 3), 0);
    uint8_t *bytes = buffer_take(&buffer, &length);
    assert_int_equal(length, 3);
    assert_memory_equal(bytes, "abc", 3);
    assert_int_equal(buffer.length, 0);
    assert_null(buffer.bytes);
    free(bytes);
    buffer_fini(&buffer);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(appended_bytes_follow_each_other),
        cmocka_unit_test(content_survives_growth),
        cmocka_unit_test(extending_by_nothing_succeeds),
        cmocka_unit_test(reserved_room_is_not_moved_later),
        cmocka_unit_test(an_impossible_size_leaves_the_content_alone),
        cmocka_unit_test(clearing_keeps_the_memory),
        cmocka_unit_test(taking_moves_the_content_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
