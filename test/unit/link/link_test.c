/*
 * Links: what is queued leaves in order and unchanged, over memory and over a socket.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "link/link.h"
#include "platform/platform.h"

enum { PATIENCE_MS = 30000 };

static void queue_text(struct link *link, const char *text)
{
    struct frame frame;
    frame_init(&frame, CLASS_BROADCAST);
    frame.data = (const uint8_t *)text;
    frame.data_length = (uint32_t)strlen(text);
    link_queue(link, &frame);
}

static void short_frames_leave_in_order(void **state)
{
    struct link link;
    struct buffer out;
    (void)state;
    link_init(&link, -1, FROM_MODULE);
    buffer_init(&out);
    queue_text(&link, "one");
    queue_text(&link, "second");
    assert_int_equal(link_waiting(&link), 2 * FRAME_HEADER_SIZE + 9);
    assert_int_equal(link_take(&link, &out), 0);
    assert_int_equal(link_waiting(&link), 0);
    assert_int_equal(out.length, 2 * FRAME_HEADER_SIZE + 9);
    assert_memory_equal(out.bytes + FRAME_HEADER_SIZE, "one", 3);
    assert_memory_equal(out.bytes + 2 * FRAME_HEADER_SIZE + 3, "second", 6);
    buffer_fini(&out);
    link_fini(&link);
}

static void a_long_block_is_shared_and_given_back(void **state)
{
    struct link link;
    struct frame frame;
    struct buffer out;
    struct block *block = block_new(10000);
    (void)state;
    memset(block->bytes, 'x', 10000);
    link_init(&link, -1, FROM_MODULE);
    buffer_init(&out);
    frame_init(&frame, CLASS_BROADCAST);
    frame.block = block;
    frame.data = block->bytes;
    frame.data_length = 10000;
    queue_text(&link, "before");
    link_queue(&link, &frame);
    queue_text(&link, "after");
    assert_int_equal(block->references, 2);
    assert_int_equal(link_take(&link, &out), 0);
    assert_int_equal(block->references, 1);
    assert_int_equal(out.length, 3 * FRAME_HEADER_SIZE + 11 + 10000);
    assert_int_equal(out.bytes[2 * FRAME_HEADER_SIZE + 6 + 9999], 'x');
    assert_memory_equal(out.bytes + out.length - 5, "after", 5);
    link_queue(&link, &frame);
    link_fini(&link); /* what never left is given back as well */
    assert_int_equal(block->references, 1);
    block_unref(block);
    buffer_fini(&out);
}

static void borrowed_content_follows_its_prefix(void **state)
{
    struct link link;
    struct frame frame;
    struct buffer out;
    static uint8_t content[5000];
    (void)state;
    memset(content, 'c', sizeof content);
    link_init(&link, -1, FROM_MODULE);
    buffer_init(&out);
    frame_init(&frame, CLASS_BROADCAST);
    frame.data_length = 8 + sizeof content;
    const uint64_t mark =
        link_queue_borrowed(&link, &frame, "12345678", 8, content, sizeof content);
    assert_int_equal(mark, FRAME_HEADER_SIZE + 8 + sizeof content);
    assert_int_equal(link_take(&link, &out), 0);
    assert_int_equal(link.written, mark);
    assert_memory_equal(out.bytes + FRAME_HEADER_SIZE, "12345678c", 9);
    buffer_fini(&out);
    link_fini(&link);
}

/* Waits until there is something to read. */
static void await(int fd)
{
    struct ready_item item = {fd, READY_READ, 0};
    assert_int_equal(ready_wait(&item, 1, PATIENCE_MS), 1);
}

static void open_pair(struct link *a, struct link *b)
{
    int listener;
    int fds[2];
    int port = 0;
    assert_int_equal(net_listen_tcp("127.0.0.1", &port, &listener), 0);
    assert_int_equal(net_connect_tcp("127.0.0.1", port, PATIENCE_MS, NULL, &fds[0]), 0);
    await(listener);
    assert_int_equal(net_accept(listener, &fds[1]), 0);
    net_close(listener);
    link_init(a, fds[0], FROM_MODULE);
    link_init(b, fds[1], FROM_MODULE);
}

/* Reads what is there and checks that frame numbers and contents go on from *n_frames. */
static void take_numbered(struct link *link, uint32_t *n_frames)
{
    struct frame frame;
    bool more = true;
    while (more && link_read(link, &more) > 0) {
        while (reader_next(&link->reader, &frame) > 0) {
            assert_int_equal(frame.reference, (int)*n_frames);
            for (uint32_t i = 0; i < frame.data_length; i += 97) {
                assert_int_equal(frame.data[i], (uint8_t)(*n_frames + i));
            }
            (*n_frames)++;
        }
    }
}

static void a_full_socket_takes_the_rest_later(void **state)
{
    enum { N = 2000 }; /* more than any socket takes at once */
    struct link sender;
    struct link receiver;
    uint32_t n_frames = 0;
    bool was_full = false;
    (void)state;
    open_pair(&sender, &receiver);
    for (uint32_t n = 0; n < N; n++) {
        struct frame frame;
        struct block *block = block_new(n * 53 % 20000);
        for (size_t i = 0; i < block->length; i++) {
            block->bytes[i] = (uint8_t)(n + i);
        }
        frame_init(&frame, CLASS_BROADCAST);
        frame.reference = (int32_t)n;
        frame.block = block;
        frame.data = block->bytes;
        frame.data_length = (uint32_t)block->length;
        link_queue(&sender, &frame);
        block_unref(block);
    }
    while (n_frames < N) {
        const int result = link_flush(&sender);
        assert_true(result == 0 || result == 1);
        was_full = was_full || result == 1;
        await(receiver.fd);
        take_numbered(&receiver, &n_frames);
    }
    assert_true(was_full);
    assert_int_equal(n_frames, N);
    assert_int_equal(link_waiting(&sender), 0);
    link_fini(&sender);
    link_fini(&receiver);
}

static void the_end_of_the_peer_is_told(void **state)
{
    struct link a;
    struct link b;
    (void)state;
    open_pair(&a, &b);
    assert_int_equal(link_read(&a, NULL), 0);
    link_fini(&b);
    await(a.fd);
    assert_int_equal(link_read(&a, NULL), ERR_CLOSED);
    int result = 0;
    const uint64_t deadline = clock_ns() + PATIENCE_MS * UINT64_C(1000000);
    while (result == 0 && clock_ns() < deadline) { /* the peer's system has to refuse it first */
        queue_text(&a, "too late");
        result = link_flush(&a);
    }
    assert_int_equal(result, ERR_CLOSED); /* and no signal has ended the process */
    link_fini(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(short_frames_leave_in_order),
        cmocka_unit_test(a_long_block_is_shared_and_given_back),
        cmocka_unit_test(borrowed_content_follows_its_prefix),
        cmocka_unit_test(a_full_socket_takes_the_rest_later),
        cmocka_unit_test(the_end_of_the_peer_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
