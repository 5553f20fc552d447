"""A module that has disconnected has given everything back."""
import shutil

import pytest

from support.processes import Process
from support.waiting import SLOW

SOURCE = r"""
#include <stdlib.h>
#include "ipc.h"

static int n_handled;

static void on_data(MSG_INSTANCE message, void *data, void *client_data)
{
    (void)client_data;
    IPC_freeData(IPC_msgInstanceFormatter(message), data);
    n_handled++;
}

static void on_bytes(MSG_INSTANCE message, BYTE_ARRAY bytes, void *client_data)
{
    (void)message;
    (void)client_data;
    IPC_freeByteArray(bytes);
    n_handled++;
}

static void on_query(MSG_INSTANCE message, void *data, void *client_data)
{
    (void)client_data;
    IPC_respondData(message, "leak_answer", data);
    IPC_freeData(IPC_msgInstanceFormatter(message), data);
}

static void on_change(const char *message, int n_handlers, void *client_data)
{
    (void)message;
    (void)n_handlers;
    (void)client_data;
}

static void on_time(void *client_data, unsigned long now, unsigned long scheduled)
{
    (void)client_data;
    (void)now;
    (void)scheduled;
}

static int live(void)
{
    struct { int n; char *text; int *numbers; } value;
    int numbers[3] = {1, 2, 3};
    void *answer;
    int i;
    value.n = 3;
    value.text = (char *)"text";
    value.numbers = numbers;
    if (IPC_connect("leaks") != IPC_OK) {
        return 2;
    }
    IPC_defineFormat("leak_type", "{int, string, <int:1>}");
    IPC_defineMsg("leak_data", IPC_VARIABLE_LENGTH, "leak_type");
    IPC_defineMsg("leak_query", IPC_VARIABLE_LENGTH, "leak_type");
    IPC_defineMsg("leak_answer", IPC_VARIABLE_LENGTH, "leak_type");
    IPC_setCapacity(4);
    IPC_setMsgQueueLength("leak_data", 2);
    IPC_subscribeData("leak_data", on_data, NULL);
    IPC_subscribe("leak_data", on_bytes, NULL);
    IPC_subscribeData("leak_query", on_query, NULL);
    IPC_subscribeHandlerChange("leak_data", on_change, NULL);
    IPC_addPeriodicTimer(1, on_time, NULL);
    IPC_addOneShotTimer(100000, on_time, NULL);
    for (i = 0; i < 20; i++) {
        IPC_publishData("leak_data", &value);
    }
    IPC_listenClear(200);
    for (i = 0; i < 5; i++) {
        if (IPC_queryResponseData("leak_query", &value, &answer, 20000) != IPC_OK) {
            return 3;
        }
        IPC_freeData(IPC_msgFormatter("leak_answer"), answer);
        IPC_queryNotifyData("leak_query", &value, on_bytes, NULL);
    }
    IPC_publishData("leak_data", &value); /* this and some answers are under way at the end */
    IPC_disconnect();
    return 0;
}

int main(void)
{
    int i;
    IPC_setVerbosity(IPC_Silent);
    for (i = 0; i < 3; i++) {
        const int result = live();
        if (result != 0) {
            return result;
        }
    }
    return n_handled > 0 ? 0 : 4;
}
"""


@pytest.mark.new_library("it leaks")
def test_nothing_is_lost_after_a_module_has_disconnected(compiler, library, start_central, stack,
                                                         tmp_path):
    if not shutil.which("valgrind"):
        pytest.skip("valgrind is not installed")
    if library.link_flags:
        pytest.skip("valgrind does not run sanitized programs")
    source = tmp_path / "leaks.c"
    source.write_text(SOURCE)
    central = start_central()
    program = compiler.program(str(source), library)
    checker = ["valgrind", "-q", "--leak-check=full", "--show-leak-kinds=definite,indirect,possible",
               "--errors-for-leak-kinds=definite,indirect,possible", "--error-exitcode=99"]
    module = stack.enter_context(Process([*checker, program],
                                         env={**library.environment(), "CENTRALHOST": central.address}))
    assert module.wait(120 * SLOW) == 0, module.output()
