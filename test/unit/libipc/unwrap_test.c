/*
 * The envelope of a message's data: it is believed only if it fits.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/error.h"
#include "libipc/registry.h"

static int unwrap(const struct message *message, const void *data, size_t length,
                  enum byte_order order, size_t *content_length)
{
    const uint8_t *content;
    return registry_unwrap(message, data, length, order, &content, content_length);
}

static void variable_data_has_its_length_twice(void **state)
{
    struct message message = {.wire = WIRE_VARIABLE};
    size_t length;
    (void)state;
    assert_int_equal(unwrap(&message, "\2\0\0\0\2\0\0\0ab", 10, ORDER_LITTLE, &length), 0);
    assert_int_equal(length, 2);
    assert_int_equal(unwrap(&message, "\0\0\0\2\0\0\0\2ab", 10, ORDER_BIG, &length), 0);
    assert_int_equal(length, 2);
    assert_int_equal(unwrap(&message, "\0\0\0\0\0\0\0\0", 8, ORDER_LITTLE, &length), 0);
    assert_int_equal(length, 0);
    assert_int_equal(unwrap(&message, NULL, 0, ORDER_LITTLE, &length), 0);
    assert_int_equal(length, 0);
}

static void variable_data_that_lies_is_refused(void **state)
{
    struct message message = {.wire = WIRE_VARIABLE};
    size_t length;
    (void)state;
    assert_int_equal(unwrap(&message, "\3\0\0\0\3\0\0\0ab", 10, ORDER_LITTLE, &length),
                     ERR_CONTENT);
    assert_int_equal(unwrap(&message, "\2\0\0\0\1\0\0\0ab", 10, ORDER_LITTLE, &length),
                     ERR_CONTENT);
    assert_int_equal(unwrap(&message, "\1\0\0\0\1\0\0\0ab", 10, ORDER_LITTLE, &length),
                     ERR_CONTENT);
    assert_int_equal(
        unwrap(&message, "\377\377\377\377\377\377\377\377ab", 10, ORDER_LITTLE, &length),
        ERR_CONTENT);
    assert_int_equal(unwrap(&message, "\2\0\0\0\2\0\0", 7, ORDER_LITTLE, &length), ERR_CONTENT);
}

static void fixed_data_has_exactly_its_length(void **state)
{
    struct message message = {.wire = WIRE_FIXED, .fixed_length = 4};
    struct message empty = {.wire = WIRE_NONE};
    size_t length;
    (void)state;
    assert_int_equal(unwrap(&message, "abcd", 4, ORDER_LITTLE, &length), 0);
    assert_int_equal(length, 4);
    assert_int_equal(unwrap(&message, "abc", 3, ORDER_LITTLE, &length), ERR_CONTENT);
    assert_int_equal(unwrap(&message, "abcde", 5, ORDER_LITTLE, &length), ERR_CONTENT);
    assert_int_equal(unwrap(&empty, NULL, 0, ORDER_LITTLE, &length), 0);
    assert_int_equal(length, 0);
    assert_int_equal(unwrap(&empty, "a", 1, ORDER_LITTLE, &length), ERR_CONTENT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(variable_data_has_its_length_twice),
        cmocka_unit_test(variable_data_that_lies_is_refused),
        cmocka_unit_test(fixed_data_has_exactly_its_length),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
