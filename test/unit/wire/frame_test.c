/*
 * Frame headers against bytes captured from CMU IPC 3.9.1, and what is refused.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "base/limits.h"
#include "wire/frame.h"

/* The publication of one int by a little-endian module. */
static const uint8_t publication[FRAME_HEADER_SIZE] = {
    0, 0,    0,    0, 0, 0,    0,    0x0c, 0xff, 0xff, 0xff, 0xff, 0, 0,
    0, 0x74, 0x22, 0, 0, 0x0f, 0xff, 0xff, 0xff, 0xff, 0,    0,    0, 0x1f};

static void a_captured_header_is_read(void **state)
{
    struct frame frame;
    (void)state;
    frame_read_header(&frame, publication);
    assert_int_equal(frame.class_length, 0);
    assert_int_equal(frame.data_length, 12);
    assert_int_equal(frame.parent, NO_ID);
    assert_int_equal(frame.intent, 116);
    assert_int_equal(frame.class, CLASS_BROADCAST);
    assert_int_equal(frame.class_order, ORDER_LITTLE);
    assert_int_equal(frame.data_order, ORDER_LITTLE);
    assert_int_equal(frame.alignment, 0);
    assert_int_equal(frame.dispatch, NO_ID);
    assert_int_equal(frame.reference, 31);
}

static void a_header_is_written_as_captured(void **state)
{
    struct frame frame;
    uint8_t bytes[FRAME_HEADER_SIZE];
    (void)state;
    frame_init(&frame, CLASS_BROADCAST);
    frame.class_order = frame.data_order = ORDER_LITTLE;
    frame.data_length = 12;
    frame.intent = 116;
    frame.reference = 31;
    frame_write_header(&frame, bytes);
    assert_memory_equal(bytes, publication, sizeof bytes);
}

static void the_two_byte_orders_are_kept_apart(void **state)
{
    struct frame frame;
    uint8_t bytes[FRAME_HEADER_SIZE];
    (void)state;
    frame_init(&frame, CLASS_BROADCAST);
    frame.class_order = ORDER_LITTLE;
    frame.data_order = ORDER_BIG;
    frame_write_header(&frame, bytes);
    assert_int_equal(bytes[16], 0x21);
    frame_read_header(&frame, bytes);
    assert_int_equal(frame.class_order, ORDER_LITTLE);
    assert_int_equal(frame.data_order, ORDER_BIG);
}

static const char *judge(const struct frame *frame, enum frame_origin origin)
{
    return frame_violation(frame, origin, LIMIT_CLASS_DATA, LIMIT_DATA);
}

static void a_good_header_is_accepted(void **state)
{
    struct frame frame;
    (void)state;
    frame_read_header(&frame, publication);
    assert_null(judge(&frame, FROM_MODULE));
    assert_null(judge(&frame, FROM_CENTRAL));
    assert_null(judge(&frame, FROM_PEER));
}

static void classes_are_allowed_by_origin(void **state)
{
    static const int from_module[] = {CLASS_QUERY,   CLASS_INFORM,  CLASS_REPLY,
                                      CLASS_SUCCESS, CLASS_FAILURE, CLASS_BROADCAST};
    (void)state;
    for (int class = 0; class < 40; class ++) {
        struct frame frame;
        int allowed = 0;
        frame_init(&frame, (enum frame_class) class);
        for (size_t i = 0; i < sizeof from_module / sizeof from_module[0]; i++) {
            allowed |= from_module[i] == class;
        }
        assert_int_equal(judge(&frame, FROM_MODULE) == NULL, allowed);
    }
    struct frame acknowledgement;
    frame_init(&acknowledgement, CLASS_SUCCESS);
    assert_string_equal(judge(&acknowledgement, FROM_CENTRAL), "class is not allowed");
    assert_string_equal(judge(&acknowledgement, FROM_PEER), "class is not allowed");
}

static void lengths_beyond_the_limits_are_refused(void **state)
{
    struct frame frame;
    (void)state;
    frame_init(&frame, CLASS_BROADCAST);
    frame.data_length = LIMIT_DATA;
    assert_null(judge(&frame, FROM_MODULE));
    frame.data_length = LIMIT_DATA + 1;
    assert_string_equal(judge(&frame, FROM_MODULE), "data length is negative or above the limit");
    frame.data_length = (uint32_t)-1;
    assert_non_null(judge(&frame, FROM_MODULE));
    frame.data_length = 0;
    frame.class_length = LIMIT_CLASS_DATA + 1;
    assert_string_equal(judge(&frame, FROM_MODULE), "class length is negative or above the limit");
}

static void unpacked_data_and_unknown_orders_are_refused(void **state)
{
    struct frame frame;
    (void)state;
    frame_init(&frame, CLASS_BROADCAST);
    frame.alignment = 1;
    assert_string_equal(judge(&frame, FROM_MODULE), "data is not packed");
    frame_init(&frame, CLASS_BROADCAST);
    frame.data_order = 3;
    assert_null(judge(&frame, FROM_MODULE)); /* there is no data whose order could matter */
    frame.data_length = 1;
    assert_string_equal(judge(&frame, FROM_MODULE), "byte order is unknown");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_captured_header_is_read),
        cmocka_unit_test(a_header_is_written_as_captured),
        cmocka_unit_test(the_two_byte_orders_are_kept_apart),
        cmocka_unit_test(a_good_header_is_accepted),
        cmocka_unit_test(classes_are_allowed_by_origin),
        cmocka_unit_test(lengths_beyond_the_limits_are_refused),
        cmocka_unit_test(unpacked_data_and_unknown_orders_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
