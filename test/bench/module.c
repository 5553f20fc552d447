/*
 * The module of the benchmarks: one program, several parts to play.
 *
 *     module echo             answers every "ping" with a "pong" of the same bytes
 *     module ping N SIZE      N round trips, one after the other
 *     module sink N SIZE CAP  takes N messages of "flood", at that capacity
 *     module flood N SIZE     publishes N of them as fast as it can
 *     module idle N           N processes that are connected and do nothing
 *
 * Only functions of ipc.h, so that the same binary runs with any library of that
 * interface.  Every message carries its number and a pattern, and both are
 * checked; a wrong or missing one ends the program with status 1.  Prints
 * "ready" when it has subscribed, and its figures as "name value" lines.
 */
#define _POSIX_C_SOURCE 200809L
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "ipc.h"

static unsigned expected; /* number of the next message */
static unsigned size;
static double started;

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + (double)time.tv_nsec * 1e-9;
}

static void fail(const char *what)
{
    fprintf(stderr, "benchmark: %s at message %u\n", what, expected);
    _exit(1);
}

static void fill(unsigned char *bytes, unsigned number)
{
    unsigned i;
    memset(bytes, (int)(number & 0xffu), size);
    for (i = 0; i < sizeof number && i < size; i++) {
        bytes[i] = (unsigned char)(number >> (8 * i));
    }
}

static void check(MSG_INSTANCE instance, const void *data, unsigned number)
{
    const unsigned char *bytes = data;
    unsigned i;
    if (IPC_dataLength(instance) != size) {
        fail("wrong length");
    }
    for (i = 0; i < sizeof number && i < size; i++) {
        if (bytes[i] != (unsigned char)(number >> (8 * i))) {
            fail("wrong number");
        }
    }
    if (size > sizeof number && bytes[size - 1] != (unsigned char)number) {
        fail("wrong content");
    }
}

static void ready(void)
{
    printf("ready\n");
    fflush(stdout);
}

static void echo(MSG_INSTANCE instance, BYTE_ARRAY data, void *client_data)
{
    (void)client_data;
    IPC_publish("pong", IPC_dataLength(instance), data);
    IPC_freeByteArray(data);
}

static void take_pong(MSG_INSTANCE instance, BYTE_ARRAY data, void *client_data)
{
    (void)client_data;
    check(instance, data, expected);
    IPC_freeByteArray(data);
    expected++;
}

static void take_flood(MSG_INSTANCE instance, BYTE_ARRAY data, void *client_data)
{
    (void)client_data;
    if (expected == 0) {
        started = now();
    }
    check(instance, data, expected);
    IPC_freeByteArray(data);
    expected++;
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a;
    const double y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static void run_ping(unsigned n)
{
    double *times = malloc(n * sizeof *times);
    unsigned char *bytes = malloc(size + 1);
    const unsigned warm_up = n / 10;
    unsigned i;
    for (i = 0; i < n; i++) {
        const double start = now();
        fill(bytes, i);
        IPC_publish("ping", size, bytes);
        while (expected <= i) {
            if (IPC_listen(5000) != IPC_OK) {
                fail("no answer");
            }
        }
        times[i] = now() - start;
    }
    qsort(times + warm_up, n - warm_up, sizeof *times, ascending);
    printf("p50_us %.2f\np99_us %.2f\n", times[warm_up + (n - warm_up) / 2] * 1e6,
           times[warm_up + (n - warm_up) * 99 / 100] * 1e6);
    free(times);
    free(bytes);
}

static void run_sink(unsigned n)
{
    while (expected < n) {
        if (IPC_listen(10000) != IPC_OK) {
            fail("nothing came");
        }
    }
    printf("per_second %.0f\n", (double)(n - 1) / (now() - started));
}

static void run_flood(unsigned n)
{
    unsigned char *bytes = malloc(size + 1);
    unsigned i;
    for (i = 0; i < n; i++) {
        fill(bytes, i);
        if (IPC_publish("flood", size, bytes) != IPC_OK) {
            fail("not published");
        }
    }
    free(bytes);
}

static void run_idle(unsigned n)
{
    unsigned i;
    int ends[2];
    char byte = 0;
    if (pipe(ends) != 0) {
        fail("no pipe");
    }
    for (i = 0; i < n; i++) {
        if (fork() == 0) {
            char name[32];
            snprintf(name, sizeof name, "idle%u", i);
            IPC_connect(name);
            if (write(ends[1], &byte, 1) == 1) {
                IPC_dispatch();
            }
            _exit(0);
        }
        if (read(ends[0], &byte, 1) != 1) {
            fail("an idle module did not connect");
        }
    }
    ready();
    while (wait(NULL) > 0) {
    }
}

static unsigned argument(int argc, char **argv, int i)
{
    return argc > i ? (unsigned)atoi(argv[i]) : 0;
}

int main(int argc, char **argv)
{
    const char *part = argc > 1 ? argv[1] : "";
    const unsigned n = argument(argc, argv, 2);
    size = argument(argc, argv, 3);
    IPC_setVerbosity(IPC_Silent);
    if (strcmp(part, "idle") == 0) {
        run_idle(n);
        return 0;
    }
    if (IPC_connect(part) != IPC_OK) {
        fail("no connection");
    }
    IPC_defineMsg("ping", IPC_VARIABLE_LENGTH, NULL);
    IPC_defineMsg("pong", IPC_VARIABLE_LENGTH, NULL);
    IPC_defineMsg("flood", IPC_VARIABLE_LENGTH, NULL);
    if (strcmp(part, "echo") == 0) {
        IPC_subscribe("ping", echo, NULL);
        ready();
        IPC_dispatch();
    } else if (strcmp(part, "ping") == 0) {
        IPC_subscribe("pong", take_pong, NULL);
        IPC_listen(200); /* an original library learns here who subscribes */
        run_ping(n);
    } else if (strcmp(part, "sink") == 0) {
        IPC_setCapacity((int)argument(argc, argv, 4));
        IPC_subscribe("flood", take_flood, NULL);
        ready();
        run_sink(n);
    } else if (strcmp(part, "flood") == 0) {
        IPC_listen(200);
        run_flood(n);
    } else {
        fprintf(stderr, "usage: module echo|ping|sink|flood|idle …\n");
        return 2;
    }
    IPC_disconnect();
    return 0;
}
