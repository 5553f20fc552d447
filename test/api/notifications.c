/*
 * Notifications of modules and subscriptions (T160 to T166).
 */
#include "check.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>

static void on_connect(const char *module, void *client_data)
{
    record("%s connects%s; ", module, client_data ? (const char *)client_data : "");
}

static void on_connect_too(const char *module, void *client_data)
{
    on_connect(module, client_data);
}

static void on_disconnect(const char *module, void *client_data)
{
    record("%s leaves%s; ", module, client_data ? (const char *)client_data : "");
}

static void on_disconnect_too(const char *module, void *client_data)
{
    on_disconnect(module, client_data);
}

static void on_change(const char *message, int count, void *client_data)
{
    record("%s has %d%s; ", message, count, client_data ? (const char *)client_data : "");
}

static void on_change_too(const char *message, int count, void *client_data)
{
    on_change(message, count, client_data);
}

static struct central *watching(void)
{
    struct central *central = connected();
    define_int("m");
    EXPECT_OK(IPC_subscribeConnect(on_connect, NULL));
    EXPECT_OK(IPC_subscribeDisconnect(on_disconnect, NULL));
    EXPECT_OK(IPC_subscribeHandlerChange("m", on_change, NULL));
    settle();
    return central;
}

/* Does one thing at a time as it is told. */
PLAYER(B)
{
    player_say(0);
    for (;;) {
        switch (player_wait()) {
        case 1:
            EXPECT_OK(IPC_subscribe("m", note_a, NULL));
            break;
        case 2:
            EXPECT_OK(IPC_subscribe("m", note_b, NULL));
            break;
        case 3:
            EXPECT_OK(IPC_unsubscribe("m", note_a));
            break;
        case 4:
            EXPECT_OK(IPC_subscribe("m", note_a, "other data"));
            break;
        case 5:
            exit(3);
        default:
            EXPECT_OK(IPC_disconnect());
            return;
        }
        player_say(IPC_isConnected());
    }
}

static void expect_event(const char *expected, const char *place)
{
    listen_until(1);
    expect_text(recorded(), expected, place, "the events");
}

CHECK(connecting_subscribing_and_leaving_are_told_in_order)
{
    struct central *central = watching();
    struct module *b = module_start("B", central);
    expect_event("B connects; ", PLACE);
    module_tell(b, 1);
    expect_event("m has 1; ", PLACE);
    module_tell(b, 2);
    expect_event("m has 2; ", PLACE);
    module_tell(b, 3);
    expect_event("m has 1; ", PLACE);
    module_tell(b, 0);
    listen_until(2);
    listen_for(50);
    EXPECT_TEXT(recorded(), "m has 0; B leaves; ");
}

CHECK(a_module_that_is_killed_is_told_of_like_one_that_leaves)
{
    struct central *central = watching();
    struct module *b = module_start("B", central);
    module_tell(b, 1);
    module_tell(b, 2);
    listen_until(3);
    EXPECT_TEXT(recorded(), "B connects; m has 1; m has 2; ");
    module_kill(b);
    listen_until(2);
    listen_for(50);
    EXPECT_TEXT(recorded(), "m has 0; B leaves; ");
}

CHECK(a_module_that_exits_is_told_of)
{
    struct central *central = watching();
    struct module *b = module_start("B", central);
    expect_event("B connects; ", PLACE);
    module_tell(b, 5);
    expect_event("B leaves; ", PLACE);
    EXPECT_INT(module_end(b), 3);
}

CHECK(the_latest_handler_is_called_first)
{
    struct central *central = watching();
    IPC_subscribeConnect(on_connect_too, " too");
    IPC_subscribeDisconnect(on_disconnect_too, " too");
    IPC_subscribeHandlerChange("m", on_change_too, " too");
    settle();
    struct module *b = module_start("B", central);
    module_tell(b, 1);
    module_tell(b, 0);
    listen_until(8);
    listen_for(50);
    EXPECT_TEXT(recorded(), "B connects too; B connects; m has 1 too; m has 1; m has 0 too; "
                            "m has 0; B leaves too; B leaves; ");
}

CHECK(modules_that_are_there_already_are_not_told_of)
{
    struct central *central = central_start(NULL);
    module_start("B", central);
    IPC_setVerbosity(IPC_Silent);
    EXPECT_OK(IPC_connectModule("A", central->address));
    IPC_subscribeConnect(on_connect, NULL);
    listen_for(100);
    EXPECT_TEXT(recorded(), "");
}

CHECK(subscribing_a_notification_again_replaces_its_client_data_silently)
{
    struct central *central = connected();
    define_int("m");
    IPC_subscribeConnect(on_connect, " old");
    IPC_subscribeDisconnect(on_disconnect, " old");
    IPC_subscribeHandlerChange("m", on_change, " old");
    IPC_setVerbosity(IPC_Print_Warnings);
    capture();
    EXPECT_OK(IPC_subscribeConnect(on_connect, " new"));
    EXPECT_OK(IPC_subscribeDisconnect(on_disconnect, " new"));
    EXPECT_OK(IPC_subscribeHandlerChange("m", on_change, " new"));
    EXPECT_TEXT(captured_stderr(), "");
    IPC_setVerbosity(IPC_Silent);
    settle();
    struct module *b = module_start("B", central);
    module_tell(b, 1);
    module_tell(b, 0);
    listen_until(4);
    listen_for(50);
    EXPECT_TEXT(recorded(), "B connects new; m has 1 new; m has 0 new; B leaves new; ");
}

CHECK(own_subscriptions_are_told_of)
{
    connected();
    define_int("m");
    IPC_subscribeHandlerChange("m", on_change, NULL);
    IPC_subscribe("m", note_a, NULL);
    IPC_unsubscribe("m", note_a);
    listen_until(2);
    listen_for(50);
    EXPECT_TEXT(recorded(), "m has 1; m has 0; ");
}

CHECK_NEW(replaced_client_data_are_no_change)
{
    struct central *central = watching();
    struct module *b = module_start("B", central);
    module_tell(b, 1);
    module_tell(b, 4);
    module_tell(b, 2);
    listen_until(3);
    IPC_subscribe("m", note_a, NULL);
    IPC_subscribe("m", note_a, "other");
    listen_until(4);
    listen_for(50);
    EXPECT_TEXT(recorded(), "B connects; m has 1; m has 2; m has 3; ");
}

static void ask_for_module(const char *module, void *client_data)
{
    record("%s %d; ", module, IPC_isModuleConnected(module) == *(int *)client_data);
}

CHECK(a_handler_may_ask_for_the_module_it_is_told_of)
{
    int connected_now = 1;
    int disconnected_now = 0;
    struct central *central = connected();
    IPC_subscribeConnect(ask_for_module, &connected_now);
    IPC_subscribeDisconnect(ask_for_module, &disconnected_now);
    settle();
    struct module *b = module_start("B", central);
    listen_until(1);
    module_tell(b, 0);
    listen_until(2);
    EXPECT_TEXT(recorded(), "B 1; B 1; ");
}

CHECK(unsubscribed_notifications_come_no_more)
{
    struct central *central = watching();
    EXPECT_OK(IPC_unsubscribeConnect(on_connect));
    EXPECT_OK(IPC_unsubscribeDisconnect(on_disconnect));
    EXPECT_OK(IPC_unsubscribeHandlerChange("m", on_change));
    EXPECT_OK(IPC_unsubscribeConnect(on_connect));
    EXPECT_OK(IPC_unsubscribeDisconnect(on_disconnect));
    EXPECT_OK(IPC_unsubscribeHandlerChange("m", on_change));
    EXPECT_QUIET(IPC_unsubscribeHandlerChange("undefined", on_change), IPC_OK);
    struct module *b = module_start("B", central);
    module_tell(b, 1);
    EXPECT_INT(module_hear(b), 1);
    module_tell(b, 0);
    EXPECT_INT(module_end(b), 0);
    listen_for(100);
    EXPECT_TEXT(recorded(), "");
}

CHECK(changes_of_an_undefined_message_cannot_be_watched)
{
    connected();
    EXPECT_ERROR(IPC_subscribeHandlerChange("undefined", on_change, NULL), IPC_Message_Not_Defined);
}

/* -------------------------------------------------------------------- modules of one name */

PLAYER(Dup)
{
    player_say(0);
    for (;;) {
        switch (player_wait()) {
        case 1:
            IPC_disconnect();
            return;
        case 2:
            exit(0);
        case 3:
            player_say(IPC_isModuleConnected("A"));
            break;
        default:
            IPC_disconnect();
            return;
        }
    }
}

static void let_older_leave(int how)
{
    struct central *central = connected();
    IPC_subscribeDisconnect(on_disconnect, NULL);
    struct module *older = module_start("Dup", central);
    struct module *newer = module_start("Dup", central);
    module_tell(older, how);
    EXPECT_INT(module_end(older), 0);
    listen_until(1);
    listen_for(50);
    EXPECT_TEXT(recorded(), "Dup leaves; ");
    module_tell(newer, 3);
    EXPECT_INT(module_hear(newer), 1);
    EXPECT_INT(IPC_isModuleConnected("Dup"), 1);
}

CHECK_NEW(the_newer_of_two_modules_of_one_name_stays_when_the_older_disconnects)
{
    let_older_leave(1);
}

CHECK_NEW(the_newer_of_two_modules_of_one_name_stays_when_the_older_exits)
{
    let_older_leave(2);
}

CHECK_NEW(more_than_a_hundred_subscriptions_are_counted)
{
    char name[16];
    connected();
    define_int("m");
    for (int i = 0; i < 101; i++) {
        snprintf(name, sizeof name, "handler%d", i);
        EXPECT_OK(_IPC_subscribe("m", name, note_a, NULL, 0));
    }
    EXPECT_INT(IPC_numHandlers("m"), 101);
}
