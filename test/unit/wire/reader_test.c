/*
 * The frame reader: the same frames come out however the stream is split.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/buffer.h"
#include "base/error.h"
#include "base/limits.h"
#include "wire/reader.h"

enum { N_FRAMES = 6 };

/* Small, empty, at both sides of the bound between small and large, and very large. */
static const uint32_t lengths[N_FRAMES] = {12, 0, 16 * 1024, 16 * 1024 + 1, 3000000, 5};

static uint8_t content_byte(size_t frame, size_t i)
{
    return (uint8_t)(frame * 31 + i * 7 + i / 251);
}

static void append_frame(struct buffer *stream, size_t number)
{
    struct frame frame;
    static const char class_data[] = "name";
    frame_init(&frame, CLASS_BROADCAST);
    frame.class_length = number % 2 == 0 ? sizeof class_data : 0;
    frame.data_length = lengths[number];
    frame.reference = (int32_t)number;
    frame_write_header(&frame, buffer_extend(stream, FRAME_HEADER_SIZE));
    assert_int_equal(buffer_append(stream, class_data, frame.class_length), 0);
    uint8_t *data = buffer_extend(stream, frame.data_length);
    for (size_t i = 0; i < frame.data_length; i++) {
        data[i] = content_byte(number, i);
    }
}

static void check_frame(const struct frame *frame, size_t number)
{
    assert_int_equal(frame->reference, (int)number);
    assert_int_equal(frame->data_length, lengths[number]);
    if (number % 2 == 0) {
        assert_int_equal(frame->class_length, 5);
        assert_string_equal((const char *)frame->class_data, "name");
    }
    for (size_t i = 0; i < frame->data_length; i++) {
        if (frame->data[i] != content_byte(number, i)) {
            fail_msg("frame %zu differs at byte %zu", number, i);
        }
    }
}

/* Feeds the stream in pieces of piece bytes at the most; the reader decides where they go. */
static void feed(size_t piece, const struct buffer *stream)
{
    struct reader reader;
    size_t fed = 0;
    size_t n_frames = 0;
    reader_init(&reader, FROM_MODULE);
    while (fed < stream->length) {
        size_t room;
        uint8_t *space = reader_space(&reader, &room);
        assert_non_null(space);
        assert_true(room > 0);
        size_t count = piece < room ? piece : room;
        count = count < stream->length - fed ? count : stream->length - fed;
        memcpy(space, stream->bytes + fed, count);
        reader_filled(&reader, count);
        fed += count;
        struct frame frame;
        while (reader_next(&reader, &frame) > 0) {
            check_frame(&frame, n_frames++);
        }
        assert_null(reader.violation);
    }
    assert_int_equal(n_frames, N_FRAMES);
    assert_true(reader_is_empty(&reader));
    reader_fini(&reader);
}

static void any_split_of_the_stream_gives_the_same_frames(void **state)
{
    static const size_t pieces[] = {1, 2, 7, 27, 28, 29, 1000, 4096, 65536, 1000000, SIZE_MAX};
    struct buffer stream;
    (void)state;
    buffer_init(&stream);
    for (size_t i = 0; i < N_FRAMES; i++) {
        append_frame(&stream, i);
    }
    for (size_t i = 0; i < sizeof pieces / sizeof pieces[0]; i++) {
        feed(pieces[i], &stream);
    }
    buffer_fini(&stream);
}

static void put(struct reader *reader, const void *bytes, size_t count)
{
    size_t room;
    uint8_t *space = reader_space(reader, &room);
    assert_true(room >= count);
    memcpy(space, bytes, count);
    reader_filled(reader, count);
}

static void raw_bytes_come_before_the_frames(void **state)
{
    struct reader reader;
    const uint8_t *raw;
    struct frame frame;
    (void)state;
    reader_init(&reader, FROM_CENTRAL);
    put(&reader, "\0\0", 2);
    assert_int_equal(reader_take_raw(&reader, 4, &raw), 0);
    put(&reader, "\0\xb6", 2);
    assert_int_equal(reader_take_raw(&reader, 4, &raw), 1);
    assert_memory_equal(raw, "\0\0\0\xb6", 4);
    assert_int_equal(reader_next(&reader, &frame), 0);
    reader_fini(&reader);
}

static void a_bad_header_stops_the_reader_before_its_body(void **state)
{
    struct reader reader;
    struct frame frame;
    uint8_t header[FRAME_HEADER_SIZE];
    (void)state;
    reader_init(&reader, FROM_MODULE);
    frame_init(&frame, CLASS_BROADCAST);
    frame.data_length = (uint32_t)-5;
    frame.reference = 77;
    frame_write_header(&frame, header);
    put(&reader, header, sizeof header);
    assert_int_equal(reader_next(&reader, &frame), ERR_PROTOCOL);
    assert_string_equal(reader.violation, "data length is negative or above the limit");
    assert_int_equal(reader.violating.reference, 77);
    reader_fini(&reader);
}

static void a_huge_promise_takes_memory_only_for_what_arrives(void **state)
{
    struct reader reader;
    struct frame frame;
    uint8_t header[FRAME_HEADER_SIZE];
    (void)state;
    reader_init(&reader, FROM_MODULE);
    frame_init(&frame, CLASS_BROADCAST);
    frame.data_length = LIMIT_DATA;
    frame_write_header(&frame, header);
    put(&reader, header, sizeof header);
    assert_int_equal(reader_next(&reader, &frame), 0);
    assert_false(reader_is_empty(&reader));
    assert_true(reader.large_capacity <= 1024 * 1024);
    reader_fini(&reader);
}

static void the_block_of_a_large_frame_can_be_kept(void **state)
{
    struct reader reader;
    struct frame frame;
    struct buffer stream;
    size_t fed = 0;
    (void)state;
    buffer_init(&stream);
    append_frame(&stream, 3);
    reader_init(&reader, FROM_MODULE);
    while (fed < stream.length) {
        size_t room;
        uint8_t *space = reader_space(&reader, &room);
        const size_t count = room < stream.length - fed ? room : stream.length - fed;
        memcpy(space, stream.bytes + fed, count);
        reader_filled(&reader, count);
        fed += count;
        if (fed < stream.length) {
            assert_int_equal(reader_next(&reader, &frame), 0);
        }
    }
    assert_int_equal(reader_next(&reader, &frame), 1);
    assert_non_null(frame.block);
    struct block *kept = block_ref(frame.block);
    const uint8_t *data = frame.data;
    reader_fini(&reader);
    assert_int_equal(data[100], content_byte(3, 100));
    assert_int_equal(kept->references, 1);
    block_unref(kept);
    buffer_fini(&stream);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_split_of_the_stream_gives_the_same_frames),
        cmocka_unit_test(raw_bytes_come_before_the_frames),
        cmocka_unit_test(a_bad_header_stops_the_reader_before_its_body),
        cmocka_unit_test(a_huge_promise_takes_memory_only_for_what_arrives),
        cmocka_unit_test(the_block_of_a_large_frame_can_be_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
