/*
 * Connecting: greeting, look-ups, introduction, start.
 */
#include "station.h"

#include <stdlib.h>
#include <string.h>

#include "central/settings/limits.h"
#include "central/routing/lifecycle.h"

/* Sections 3.1 of the protocol, but for the number of the look-up request and the byte order. */
static const uint8_t greeting_after_number[] = {
    0, 0, 0, 0,    0, 0,    0, 0x18, 0, 0, 0, 0, 0, 0, 0,    0, 0x22, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
    0, 2, 0, 0,    0, 3,    0, 0,    0, 0, 0, 0, 0, 7, 0,    0, 0,    0, 0, 0, 0, 7, 0, 0, 0, 0, 0,
    0, 0, 0, 0,    0, 0x35, 0, 0,    0, 0, 0, 0, 0, 0, 0x22, 0, 0,    0, 0, 0, 0, 0, 0, 0, 0, 0, 3,
    0, 0, 0, 0x5a, 2, 0,    0, 0,    6, 0, 0, 0, 0, 0, 0,    0, 1,    0, 0, 0, 0, 0, 0, 0, 7, 0, 0,
    0, 0, 0, 0,    0, 1,    0, 0,    0, 0, 0, 0, 0, 8, 0,    0, 0,    0, 0, 0, 0, 8, 0, 0, 0,
};

static void the_greeting_is_sent_without_waiting(void **state)
{
    struct station station;
    struct buffer bytes;
    (void)state;
    station_open(&station, NULL);
    buffer_init(&bytes);
    struct module *module = server_add_connection(&station.server, -1);
    assert_int_equal(link_take(&module->link, &bytes), 0);
    assert_int_equal(bytes.length, 137);
    assert_int_equal(load_be32(bytes.bytes), station.server.library[LM_MESSAGE_INFO]->id);
    if (byte_order_of_host() == ORDER_LITTLE) {
        assert_memory_equal(bytes.bytes + 4, greeting_after_number, sizeof greeting_after_number);
    }
    buffer_fini(&bytes);
    conversation_end_input(&station.server, module);
    station_run(&station);
    station_close(&station);
}

static void every_library_message_is_found_under_all_its_names(void **state)
{
    struct station station;
    struct peer peer;
    (void)state;
    station_open(&station, NULL);
    peer_greet(&station, &peer, "M");
    for (int i = 0; i < LM_COUNT; i++) {
        assert_true(peer_id_of(&peer, library_messages[i].name) >= 2);
        if (library_messages[i].alias != NULL) {
            assert_true(peer_id_of(&peer, library_messages[i].alias) >= 2);
        }
    }
    assert_int_equal(peer_id_of(&peer, "X_IPC_WAITMSG"), peer_id_of(&peer, "x_ipc_waitMsg"));
    assert_int_equal(peer_id_of(&peer, "unheard of"), 0);
    station_close(&station);
}

static void a_look_up_tells_formats_and_class(void **state)
{
    struct station station;
    struct peer peer;
    struct optional_message_info reply = {NULL};
    const struct message_info_request request = {(char *)(uintptr_t) "point", NULL};
    const struct two_names definition = {(char *)(uintptr_t) "pair",
                                         (char *)(uintptr_t) "{int, int}"};
    (void)state;
    station_open(&station, NULL);
    peer_connect(&station, &peer, "M");
    peer_define(&peer, "Point", "{pair, double}"); /* before the format it uses */
    (void)peer_tell(&peer, LM_DEFINE_FORMAT, &definition);
    assert_true(peer_ask(&peer, LM_MESSAGE_INFO, &request, &reply));
    assert_string_equal(reply.info->name, "Point");
    assert_int_equal(reply.info->class, CLASS_BROADCAST);
    char *wire = format_canonical(reply.info->wire);
    char *content = format_canonical(reply.info->content);
    assert_string_equal(wire, "{int, <byte : 1>}");
    assert_string_equal(content, "{{int, int}, double}");
    free(wire);
    free(content);
    (void)format_release(station.server.catalogue.reply[LM_MESSAGE_INFO], &reply);
    station_close(&station);
}

static void a_bad_format_spoils_only_its_message_and_may_become_good(void **state)
{
    struct station station;
    struct peer peer;
    struct optional_message_info reply = {NULL};
    const struct format *format;
    const struct message_info_request request = {(char *)(uintptr_t) "M", NULL};
    const struct two_names definition = {(char *)(uintptr_t) "late", (char *)(uintptr_t) "int"};
    (void)state;
    station_open(&station, NULL);
    peer_connect(&station, &peer, "M");
    format = station.server.catalogue.reply[LM_MESSAGE_INFO];
    peer_define(&peer, "M", "{late, int}");
    for (int i = 0; i < 2; i++) {
        assert_true(peer_ask(&peer, LM_MESSAGE_INFO, &request, &reply));
        assert_true(format_is_bad(reply.info->content));
        assert_false(format_is_bad(reply.info->wire));
        (void)format_release(format, &reply);
    }
    assert_non_null(strstr(station_log(&station), "WARNING: the format of M is bad\n"));
    (void)peer_tell(&peer, LM_DEFINE_FORMAT, &definition);
    assert_true(peer_ask(&peer, LM_MESSAGE_INFO, &request, &reply));
    assert_false(format_is_bad(reply.info->content));
    (void)format_release(format, &reply);
    station_close(&station);
}

static void a_name_that_is_only_subscribed_to_has_number_0_and_class_1(void **state)
{
    struct station station;
    struct peer peer;
    struct optional_message_info reply = {NULL};
    const struct message_info_request request = {(char *)(uintptr_t) "Early", NULL};
    (void)state;
    station_open(&station, NULL);
    peer_connect(&station, &peer, "M");
    peer_subscribe(&peer, "Early", 5);
    assert_true(peer_ask(&peer, LM_MESSAGE_INFO, &request, &reply));
    assert_int_equal(reply.info->id, 0);
    assert_int_equal(reply.info->class, CLASS_SUBSCRIBED);
    assert_null(reply.info->wire);
    (void)format_release(station.server.catalogue.reply[LM_MESSAGE_INFO], &reply);
    station_close(&station);
}

static void class_formats_are_told(void **state)
{
    static const char *const expected[17] = {
        [2] = "string",
        [4] = "int",
        [5] = "{int, int}",
        [7] = "int",
        [8] = "{{int, {int, int}}, {int, {int, int}}, *{int, int, int, int, int}}",
        [9] = "int",
        [10] = "{{int, {int, int}}, {int, {int, int}}, *{int, int, int, int, int}}",
        [13] = "string",
        [14] = "int",
        [16] = "{int, int}"};
    struct station station;
    struct peer peer;
    (void)state;
    station_open(&station, NULL);
    peer_greet(&station, &peer, "M");
    for (int class = -1; class < 17; class ++) {
        struct optional_class_info reply = {NULL};
        assert_true(peer_ask(&peer, LM_CLASS_INFO, &class, &reply));
        const char *wanted = class < 0 ? NULL : expected[class];
        assert_int_equal(reply.info == NULL, wanted == NULL);
        if (wanted != NULL) {
            char *text = format_canonical(reply.info->format);
            assert_string_equal(text, wanted);
            free(text);
        }
        (void)format_release(station.server.catalogue.reply[LM_CLASS_INFO], &reply);
    }
    station_close(&station);
}

static void the_introduction_is_logged_and_told_before_it_is_answered(void **state)
{
    struct station station;
    struct peer watcher, peer;
    struct frame frame;
    const struct subscription_notice notice = {7, (char *)(uintptr_t) "x_ipc_connectNotify",
                                               (char *)(uintptr_t) "x_ipc_connectNotify"};
    (void)state;
    station_open(&station, NULL);
    peer_connect(&station, &watcher, "Watcher");
    (void)peer_tell(&watcher, LM_SUBSCRIBE, &notice);
    (void)station_log(&station);
    peer_greet(&station, &peer, "Arm");
    const struct introduction introduction = {(char *)(uintptr_t) "Arm",
                                              (char *)(uintptr_t) "robot1"};
    (void)peer_tell(&peer, LM_INTRODUCTION, &introduction);
    station_run(&station);
    assert_string_equal(station_log(&station),
                        " Received a new connection: -1\n   modName : Arm\n   hostName: robot1\n");
    assert_true(peer_receive(&watcher, &frame));
    assert_int_equal(frame.class, CLASS_BROADCAST);
    assert_int_equal(frame.intent, 7);
    assert_int_equal(frame.parent, NO_ID);
    assert_memory_equal(frame.data + 4, "Arm", 3);
    station_close(&station);
}

static void a_second_introduction_changes_nothing(void **state)
{
    struct station station;
    struct peer peer;
    const struct introduction again = {(char *)(uintptr_t) "Other", (char *)(uintptr_t) "robot"};
    (void)state;
    station_open(&station, NULL);
    peer_connect(&station, &peer, "M");
    (void)peer_tell(&peer, LM_INTRODUCTION, &again);
    peer_expect_nothing(&peer);
    assert_string_equal(peer.module->name, "M");
    assert_false(peer_is_closed(&peer));
    station_close(&station);
}

static void nothing_but_look_ups_may_come_before_the_introduction(void **state)
{
    struct station station;
    struct peer peer;
    (void)state;
    station_open(&station, NULL);
    peer_greet(&station, &peer, "M");
    peer_define(&peer, "Msg", "int");
    station_run(&station);
    assert_true(peer_is_closed(&peer));
    assert_non_null(strstr(station_log(&station),
                           "WARNING: **NEWMOD** on **UNKNOWN**: a request comes before the "
                           "introduction\n"));
    assert_null(message_find(&station.server.messages, "Msg"));
    station_close(&station);
}

static void a_connection_that_does_not_introduce_itself_is_closed_in_time(void **state)
{
    struct station station;
    struct peer silent, talker;
    (void)state;
    station_open(&station, NULL);
    peer_greet(&station, &silent, "silent");
    station_pass_time(&station, 20);
    peer_connect(&station, &talker, "Talker");
    assert_false(peer_is_closed(&silent));
    station_pass_time(&station, 11);
    assert_true(peer_is_closed(&silent));
    station_pass_time(&station, 1000);
    assert_false(peer_is_closed(&talker));
    station_close(&station);
}

static void of_too_many_strangers_the_oldest_has_to_go(void **state)
{
    enum { ALLOWED = 3 };
    struct station station;
    struct peer peers[ALLOWED + 1];
    (void)state;
    station_open(&station, NULL);
    station.options.limits.unintroduced = ALLOWED;
    for (size_t i = 0; i < N_ELEMENTS(peers); i++) {
        peer_greet(&station, &peers[i], "stranger");
    }
    station_pass_time(&station, 0);
    assert_true(peer_is_closed(&peers[0]));
    assert_false(peer_is_closed(&peers[1]));
    station_close(&station);
}

/* ---------------------------------------------------------------------- start */

static void introduce(struct station *station, struct peer *peer, const char *name)
{
    struct introduction_reply version;
    const struct introduction introduction = {(char *)(uintptr_t)name, (char *)(uintptr_t) "robot"};
    peer_greet(station, peer, name);
    assert_true(peer_ask(peer, LM_INTRODUCTION, &introduction, &version));
}

static void nobody_starts_before_all_expected_modules_have_asked(void **state)
{
    static const char *const arguments[] = {"2", NULL};
    struct station station;
    struct peer first, second, third;
    struct frame frame;
    (void)state;
    station_open(&station, arguments);
    introduce(&station, &first, "A");
    introduce(&station, &second, "B");
    const int reference = peer_tell(&first, LM_READY, NULL);
    peer_expect_nothing(&first);
    (void)peer_tell(&second, LM_READY, NULL);
    assert_true(peer_receive(&first, &frame));
    assert_int_equal(frame.reference, reference);
    assert_true(peer_receive(&second, &frame));
    peer_connect(&station, &third, "C"); /* no second group is formed */
    station_close(&station);
}

static void a_module_that_has_gone_is_not_waited_with(void **state)
{
    static const char *const arguments[] = {"2", NULL};
    struct station station;
    struct peer first, second;
    (void)state;
    station_open(&station, arguments);
    introduce(&station, &first, "A");
    (void)peer_tell(&first, LM_READY, NULL);
    peer_expect_nothing(&first);
    peer_lose(&first);
    introduce(&station, &second, "B");
    (void)peer_tell(&second, LM_READY, NULL);
    peer_expect_nothing(&second);
    station_close(&station);
}

static void a_module_waits_for_what_it_requires(void **state)
{
    struct station station;
    struct peer needy, other;
    struct frame frame;
    char *names[] = {(char *)(uintptr_t) "Gripper", (char *)(uintptr_t) "Needy"};
    const struct name_list wanted = {2, 2, names};
    const struct number_and_name resource = {1, (char *)(uintptr_t) "gripper"};
    (void)state;
    station_open(&station, NULL);
    introduce(&station, &needy, "Needy");
    (void)peer_tell(&needy, LM_REQUIRES, &wanted);
    (void)peer_tell(&needy, LM_READY, NULL);
    peer_expect_nothing(&needy);
    peer_connect(&station, &other, "Other");
    peer_expect_nothing(&needy);
    (void)peer_tell(&other, LM_RESOURCE, &resource);
    assert_true(peer_receive(&needy, &frame));
    station_close(&station);
}

static void what_comes_before_the_start_is_kept(void **state)
{
    struct station station;
    struct peer early, sender;
    int yes = 0;
    (void)state;
    station_open(&station, NULL);
    peer_connect(&station, &sender, "S");
    peer_define(&sender, "M", "int");
    introduce(&station, &early, "E");
    peer_subscribe(&early, "M", 5);
    peer_publish(&sender, "M", 1);
    peer_publish(&sender, "M", 2);
    peer_expect_nothing(&early);
    assert_true(peer_ask(&early, LM_READY, NULL, &yes));
    peer_expect(&early, "5 M 1, 5 M 2");
    station_close(&station);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_greeting_is_sent_without_waiting),
        cmocka_unit_test(every_library_message_is_found_under_all_its_names),
        cmocka_unit_test(a_look_up_tells_formats_and_class),
        cmocka_unit_test(a_bad_format_spoils_only_its_message_and_may_become_good),
        cmocka_unit_test(a_name_that_is_only_subscribed_to_has_number_0_and_class_1),
        cmocka_unit_test(class_formats_are_told),
        cmocka_unit_test(the_introduction_is_logged_and_told_before_it_is_answered),
        cmocka_unit_test(a_second_introduction_changes_nothing),
        cmocka_unit_test(nothing_but_look_ups_may_come_before_the_introduction),
        cmocka_unit_test(a_connection_that_does_not_introduce_itself_is_closed_in_time),
        cmocka_unit_test(of_too_many_strangers_the_oldest_has_to_go),
        cmocka_unit_test(nobody_starts_before_all_expected_modules_have_asked),
        cmocka_unit_test(a_module_that_has_gone_is_not_waited_with),
        cmocka_unit_test(a_module_waits_for_what_it_requires),
        cmocka_unit_test(what_comes_before_the_start_is_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
