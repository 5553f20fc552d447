/*
 * Players that get byte arrays from hand-made modules; test_foreign_data.py is the other side.
 */
#include "check.h"

#include <stdlib.h>
#include <string.h>

struct value {
    int number;
    char *text;
};

static BYTE_ARRAY stored;

static void store(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)instance;
    (void)client_data;
    stored = content;
    record("x");
}

static void forget(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)instance;
    (void)client_data;
    record("x");
    IPC_freeByteArray(content);
}

static void tell(IPC_RETURN_TYPE result, const struct value *value)
{
    if (result == IPC_OK) {
        printf("%d %s\n", value->number, value->text);
    } else {
        printf("error %d\n", (int)IPC_errno);
    }
}

/* Keeps the array of one message until another one has come, and unmarshalls it only then. */
PLAYER(unmarshalls_later)
{
    struct value value;
    struct value *copy = NULL;
    EXPECT_OK(IPC_subscribe("value", store, NULL));
    EXPECT_OK(IPC_subscribe("other", forget, NULL));
    player_say(0);
    listen_until(2);
    FORMATTER_PTR formatter = IPC_msgFormatter("value");
    IPC_errno = IPC_No_Error;
    IPC_RETURN_TYPE result = IPC_unmarshallData(formatter, stored, &value, sizeof value);
    tell(result, &value);
    if (result == IPC_OK) {
        IPC_freeDataElements(formatter, &value);
    }
    result = IPC_unmarshall(formatter, stored, (void **)&copy);
    tell(result, copy);
    if (result == IPC_OK) {
        IPC_freeData(formatter, copy);
    }
    IPC_freeByteArray(stored);
}

static void unmarshall(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    struct value *value = NULL;
    FORMATTER_PTR formatter = IPC_msgInstanceFormatter(instance);
    (void)client_data;
    IPC_errno = IPC_No_Error;
    const IPC_RETURN_TYPE result = IPC_unmarshall(formatter, content, (void **)&value);
    tell(result, value);
    if (result == IPC_OK) {
        IPC_freeData(formatter, value);
    }
    IPC_freeByteArray(content);
    record("x");
}

PLAYER(unmarshalls_at_once)
{
    EXPECT_OK(IPC_subscribe("value", unmarshall, NULL));
    player_say(0);
    listen_until(1);
}

static void print_data(MSG_INSTANCE instance, void *data, void *client_data)
{
    (void)client_data;
    tell(IPC_OK, data);
    IPC_freeData(IPC_msgInstanceFormatter(instance), data);
    record("x");
}

PLAYER(wants_data)
{
    EXPECT_OK(IPC_subscribeData("value", print_data, NULL));
    EXPECT_OK(IPC_subscribe("other", forget, NULL));
    player_say(0);
    IPC_setVerbosity(IPC_Print_Warnings);
    listen_until(1);
}
