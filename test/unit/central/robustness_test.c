/*
 * A bad peer costs itself only: what the protocol's section 13.1 lists, sent
 * while a healthy module is served.
 */
#include "station.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct fixture {
    struct station station;
    struct peer healthy;
    struct peer bad;
};

static void open_fixture(struct fixture *f)
{
    station_open(&f->station, NULL);
    peer_connect(&f->station, &f->healthy, "Healthy");
    peer_connect(&f->station, &f->bad, "Bad");
    peer_define(&f->healthy, "M", "int");
    peer_subscribe(&f->healthy, "M", 5);
    (void)station_log(&f->station);
}

/* The healthy module is served, and nothing is left over in the end. */
static void close_fixture(struct fixture *f)
{
    peer_publish(&f->healthy, "M", 7);
    peer_expect(&f->healthy, "5 M 7");
    station_close(&f->station);
}

/* The bad peer's connection has ended, with one line that names it and the reason. */
static void assert_ended_because(struct fixture *f, const char *reason)
{
    char line[200];
    station_run(&f->station);
    assert_true(peer_is_closed(&f->bad));
    (void)snprintf(line, sizeof line, "WARNING: Bad on robot: %s", reason);
    const char *found = strstr(station_log(&f->station), line);
    assert_non_null(found);
    assert_null(strstr(found + 1, "WARNING"));
}

/* --------------------------------------------------------------------- headers */

struct bad_header {
    uint32_t fields[7];
    const char *reason;
};

static void bad_headers_end_that_connection(void **state)
{
    static const struct bad_header headers[] = {
        {{0, 0x7ffffff0, 0, 5, 0x2200000f, 0, 0}, "data length is negative or above the limit"},
        {{0x7ffffff0, 0, 0, 5, 0x2200000f, 0, 0}, "class length is negative or above the limit"},
        {{0, 0xffffffff, 0, 5, 0x2200000f, 0, 0}, "data length is negative or above the limit"},
        {{0xffffffff, 0, 0, 5, 0x2200000f, 0, 0}, "class length is negative or above the limit"},
        {{16, 0xfffffff8, 0, 5, 0x2200000f, 0, 0}, "data length is negative or above the limit"},
        {{0, 4, 0, 5, 0x2201000f, 0, 0}, "data is not packed"},
        {{0x47455420, 0x2f204854, 0x54502f31, 0x2e310d0a, 0x486f7374, 0x3a20780d, 0x0a0d0a00},
         "data is not packed"}, /* GET / HTTP/1.1 */
        {{0, 0, 0, 5, 0x22000000, 0, 0}, "class is not allowed"},
        {{0, 0, 0, 5, 0x22000001, 0, 0}, "class is not allowed"},
        {{0, 0, 0, 5, 0x22000002, 0, 0}, "class is not allowed"},
        {{0, 0, 0, 5, 0x22000004, 0, 0}, "class is not allowed"},
        {{0, 0, 0, 5, 0x2200000a, 0, 0}, "class is not allowed"},
        {{0, 0, 0, 5, 0x2200000e, 0, 0}, "class is not allowed"},
        {{0, 0, 0, 5, 0x22000010, 0, 0}, "class is not allowed"},
        {{0, 0, 0, 5, 0x2200ffff, 0, 0}, "class is not allowed"},
        {{0, 4, 0, 5, 0x2000000f, 0, 0}, "byte order is unknown"},
        {{0, 4, 0, 5, 0x2300000f, 0, 0}, "byte order is unknown"},
        {{4, 0, 0, 5, 0x3200000f, 0, 0}, "byte order is unknown"},
        {{0, 0, 0, 0, 0x22000003, 0xffffffff, 1}, "its frame is for a message that does not exist"},
        {{0, 0, 0, 1, 0x22000006, 0xffffffff, 1}, "its frame is for a message that does not exist"},
        {{0, 0, 0, 0xffffffff, 0x2200000f, 0xffffffff, 1},
         "its frame is for a message that does not exist"},
        {{0, 0, 0, 0x7ffffff0, 0x2200000f, 0xffffffff, 1},
         "its frame is for a message that does not exist"},
        {{0, 0, 0, 0x80000000, 0x22000003, 0xffffffff, 1},
         "its frame is for a message that does not exist"},
    };
    (void)state;
    for (size_t i = 0; i < N_ELEMENTS(headers); i++) {
        struct fixture f;
        uint8_t bytes[FRAME_HEADER_SIZE + 4] = {0};
        open_fixture(&f);
        for (size_t j = 0; j < 7; j++) {
            store_be32(bytes + 4 * j, headers[i].fields[j]);
        }
        peer_send_bytes(&f.bad, bytes, sizeof bytes);
        assert_ended_because(&f, headers[i].reason);
        close_fixture(&f);
    }
}

static void the_reason_comes_with_the_header(void **state)
{
    struct fixture f;
    struct frame frame;
    (void)state;
    open_fixture(&f);
    frame_init(&frame, CLASS_QUERY);
    frame.alignment = 1;
    frame.intent = 0x1234;
    peer_send(&f.bad, &frame);
    const bool little = byte_order_of_host() == ORDER_LITTLE;
    assert_ended_because(&f, little ? "data is not packed (header 00000000 00000000 ffffffff "
                                      "00001234 22010003 ffffffff ffffffff)\n"
                                    : "data is not packed (header 00000000 00000000 ffffffff "
                                      "00001234 11010003 ffffffff ffffffff)\n");
    close_fixture(&f);
}

static void parts_of_frames_hold_nobody_up(void **state)
{
    (void)state;
    for (size_t length = 1; length < 40; length += 13) {
        struct fixture f;
        uint8_t bytes[FRAME_HEADER_SIZE + 100] = {0};
        struct frame frame;
        open_fixture(&f);
        frame_init(&frame, CLASS_BROADCAST);
        frame.data_length = 100;
        frame_write_header(&frame, bytes);
        peer_send_bytes(&f.bad, bytes, length);
        station_run(&f.station);
        assert_false(peer_is_closed(&f.bad));
        peer_publish(&f.healthy, "M", 1);
        peer_expect(&f.healthy, "5 M 1");
        close_fixture(&f); /* the rest never comes */
    }
}

static void frames_may_come_byte_by_byte(void **state)
{
    struct fixture f;
    struct frame frame;
    uint8_t bytes[FRAME_HEADER_SIZE + 12];
    const uint8_t data[12] = {4, 0, 0, 0, 4, 0, 0, 0, 3, 0, 0, 0};
    (void)state;
    open_fixture(&f);
    peer_frame(&f.bad, &frame, CLASS_BROADCAST, message_find(&f.station.server.messages, "M")->id);
    frame.data_length = sizeof data;
    frame.data_order = ORDER_LITTLE;
    frame_write_header(&frame, bytes);
    memcpy(bytes + FRAME_HEADER_SIZE, data, sizeof data);
    for (size_t i = 0; i < sizeof bytes; i++) {
        peer_send_bytes(&f.bad, bytes + i, 1);
        station_run(&f.station);
    }
    peer_expect(&f.healthy, "5 M 3");
    close_fixture(&f);
}

/* -------------------------------------------------------------------- payloads */

/* Sends a library message with these bytes as data. */
static void tell_bytes(struct fixture *f, enum library_message which, const void *bytes,
                       size_t length)
{
    struct frame frame;
    peer_frame(&f->bad, &frame, (enum frame_class)library_messages[which].class,
               f->station.server.library[which]->id);
    frame.data = bytes;
    frame.data_length = (uint32_t)length;
    frame.data_order = ORDER_LITTLE;
    peer_send(&f->bad, &frame);
}

static void data_that_do_not_fit_their_format_end_that_connection(void **state)
{
    static const struct {
        enum library_message which;
        size_t length;
        uint8_t bytes[16];
    } cases[] = {
        {LM_SUBSCRIBE, 0, {0}},                                        /* none at all */
        {LM_SUBSCRIBE, 1, {1}},                                        /* cut */
        {LM_IS_CONNECTED, 5, {0xe8, 3, 0, 0, 'x'}},                    /* string beyond the data */
        {LM_IS_CONNECTED, 7, {1, 0, 0, 0, 'x', 'y', 'z'}},             /* bytes left over */
        {LM_IS_CONNECTED, 5, {0xff, 0xff, 0xff, 0x7f, 'x'}},           /* largest count */
        {LM_GET_FORMAT, 5, {0xff, 0xff, 0xff, 0xff, 'x'}},             /* negative count */
        {LM_CLASS_INFO, 8, {4, 0, 0, 0, 4, 0, 0, 0}},                  /* one int too many */
        {LM_READY, 4, {0}},                                            /* data where none belong */
        {LM_PROVIDES, 12, {1, 0, 0, 0, 0, 0, 0, 0x40, 0, 0, 0, 0x40}}, /* array beyond the data */
    };
    (void)state;
    for (size_t i = 0; i < N_ELEMENTS(cases); i++) {
        struct fixture f;
        char reason[100];
        open_fixture(&f);
        tell_bytes(&f, cases[i].which, cases[i].bytes, cases[i].length);
        (void)snprintf(reason, sizeof reason, "the data of %s do not fit its format\n",
                       library_messages[cases[i].which].name);
        assert_ended_because(&f, reason);
        close_fixture(&f);
    }
}

static void every_library_message_survives_empty_names_and_strange_numbers(void **state)
{
    (void)state;
    for (int which = 0; which < LM_COUNT; which++) {
        static const int numbers[] = {0, -1, INT32_MIN, INT32_MAX};
        for (size_t i = 0; i < N_ELEMENTS(numbers); i++) {
            struct fixture f;
            union {
                int number;
                uint8_t bytes[128];
            } payload;
            open_fixture(&f);
            /* All pointers NULL; of structs that begin with a number, that number. */
            memset(&payload, 0, sizeof payload);
            const struct format *format = f.station.server.catalogue.request[which];
            const char *text = library_messages[which].request;
            if (text != NULL && (strncmp(text, "int", 3) == 0 || strncmp(text, "{int", 4) == 0) &&
                strstr(text, "<string") == NULL) {
                payload.number = numbers[i];
            }
            /* A reference has to be there to be encoded. */
            if (text == NULL || strstr(text, "REF_PTR") == NULL) {
                assert_true(format == NULL || format_size(format) <= sizeof payload);
                (void)peer_tell(&f.bad, (enum library_message)which, &payload);
            }
            station_run(&f.station);
            close_fixture(&f);
        }
    }
}

/* ------------------------------------------------- requests that make no sense */

static void assert_ignored(struct fixture *f, const char *reason)
{
    station_run(&f->station);
    assert_false(peer_is_closed(&f->bad));
    assert_non_null(strstr(station_log(&f->station), reason));
}

static void internal_messages_cannot_be_taken_over(void **state)
{
    static const char *const names[] = {"x_ipc_msgInfoMsg",
                                        "waitMsg",
                                        "ipc_setMsgPriority",
                                        "X_IPC_CLOSEMSG",
                                        "x_ipc_brand_new",
                                        "V_get_" VARIABLE_BROADCASTS,
                                        "V_watch_" VARIABLE_BROADCASTS,
                                        "x_ipc_connectNotify"};
    (void)state;
    for (size_t i = 0; i < N_ELEMENTS(names); i++) {
        struct fixture f;
        struct peer newcomer;
        char reason[100];
        open_fixture(&f);
        peer_define(&f.bad, names[i], "int");
        (void)snprintf(reason, sizeof reason, "ignored: %s belongs to the server\n", names[i]);
        assert_ignored(&f, reason);
        if (strstr(names[i], "watch") == NULL && strstr(names[i], "Notify") == NULL &&
            strstr(names[i], "brand_new") == NULL) {
            peer_subscribe(&f.bad, names[i], 5);
            assert_ignored(&f, "is handled by the server\n");
        }
        peer_connect(&f.station, &newcomer, "New");
        peer_expect_nothing(&f.bad);
        close_fixture(&f);
    }
}

static void forged_notices_and_variables_are_ignored(void **state)
{
    struct fixture f;
    struct frame frame;
    struct name_list none = {0, 0, NULL};
    struct buffer data;
    (void)state;
    open_fixture(&f);
    peer_frame(&f.bad, &frame, CLASS_BROADCAST, f.station.server.library[LM_CONNECTED]->id);
    peer_send(&f.bad, &frame);
    assert_ignored(&f, "a frame of class 15 to x_ipc_connectNotify is ignored\n");
    buffer_init(&data);
    assert_int_equal(payload_encode(f.station.server.catalogue.name_list, &none, &data), 0);
    peer_frame(&f.bad, &frame, CLASS_INFORM,
               message_find(&f.station.server.messages, VARIABLE_SET VARIABLE_BROADCASTS)->id);
    frame.data = data.bytes;
    frame.data_length = (uint32_t)data.length;
    peer_send(&f.bad, &frame);
    assert_ignored(&f, "the variable belongs to the server\n");
    buffer_fini(&data);
    close_fixture(&f);
}

static void numbers_and_names_that_nobody_has_are_ignored(void **state)
{
    struct fixture f;
    const int number = 12345;
    const struct two_names unknown = {(char *)(uintptr_t) "no handler",
                                      (char *)(uintptr_t) "no resource"};
    const struct pending_limit nowhere = {(char *)(uintptr_t) "M", (char *)(uintptr_t) "nowhere",
                                          5};
    const struct number_and_name port = {8000, (char *)(uintptr_t) "Healthy"};
    (void)state;
    open_fixture(&f);
    (void)peer_tell(&f.bad, LM_UNLOCK, &number);
    assert_ignored(&f, "12345 is no lock or reservation of the module\n");
    (void)peer_tell(&f.bad, LM_ADD_TO_RESOURCE, &unknown);
    assert_ignored(&f, "the module has no handler no handler or no resource no resource\n");
    (void)peer_tell(&f.bad, LM_LIMIT_PENDING, &nowhere);
    assert_ignored(&f, "\aERROR: Non-existent resource nowhere; Pending limit not applied\n");
    (void)peer_tell(&f.bad, LM_DIRECT_PORT, &port);
    assert_ignored(&f, "Direct Connection: Not Made: Healthy did not originate call.\n");
    peer_unsubscribe(&f.bad, "M", 77);
    assert_ignored(&f, "HND-M77 does not handle M\n");
    peer_subscribe(&f.bad, "M", -4);
    assert_ignored(&f, "-4 cannot be the number of a handler\n");
    close_fixture(&f);
}

static void names_are_bounded(void **state)
{
    struct fixture f;
    char name[LIMIT_NAME + 2];
    (void)state;
    open_fixture(&f);
    memset(name, 'n', sizeof name);
    name[LIMIT_NAME + 1] = '\0';
    peer_define(&f.bad, name, "int");
    assert_ignored(&f, "a name is longer than 1024 bytes\n");
    name[LIMIT_NAME] = '\0';
    peer_define(&f.bad, name, "int");
    station_run(&f.station);
    assert_non_null(message_find(&f.station.server.messages, name));
    close_fixture(&f);
}

/* ---------------------------------------------------------------- random bytes */

static uint32_t next_random(uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return *seed >> 8;
}

static void damaged_requests_end_their_sender_at_most(void **state)
{
    uint32_t seed = 4711;
    (void)state;
    for (int round = 0; round < 20; round++) {
        struct fixture f;
        open_fixture(&f);
        for (int i = 0; i < 200 && !peer_is_closed(&f.bad); i++) {
            uint8_t bytes[FRAME_HEADER_SIZE + 40];
            struct frame frame;
            const enum library_message which =
                (enum library_message)(next_random(&seed) % LM_COUNT);
            frame_init(&frame, (enum frame_class)library_messages[which].class);
            frame.intent = f.station.server.library[which]->id;
            frame.data_length = next_random(&seed) % 40;
            frame_write_header(&frame, bytes);
            for (size_t at = FRAME_HEADER_SIZE; at < sizeof bytes; at++) {
                bytes[at] = (uint8_t)(next_random(&seed) % 5);
            }
            if (next_random(&seed) % 4 == 0) {
                bytes[8 + next_random(&seed) % 20] = (uint8_t)next_random(&seed);
            }
            peer_send_bytes(&f.bad, bytes, FRAME_HEADER_SIZE + frame.data_length);
            station_run(&f.station);
        }
        close_fixture(&f);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bad_headers_end_that_connection),
        cmocka_unit_test(the_reason_comes_with_the_header),
        cmocka_unit_test(parts_of_frames_hold_nobody_up),
        cmocka_unit_test(frames_may_come_byte_by_byte),
        cmocka_unit_test(data_that_do_not_fit_their_format_end_that_connection),
        cmocka_unit_test(every_library_message_survives_empty_names_and_strange_numbers),
        cmocka_unit_test(internal_messages_cannot_be_taken_over),
        cmocka_unit_test(forged_notices_and_variables_are_ignored),
        cmocka_unit_test(numbers_and_names_that_nobody_has_are_ignored),
        cmocka_unit_test(names_are_bounded),
        cmocka_unit_test(damaged_requests_end_their_sender_at_most),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
