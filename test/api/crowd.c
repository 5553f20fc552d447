/*
 * Eight threads that do everything at a time in two contexts, while other modules are killed.
 *
 * Run by test_crowd.py with a library and a program built with ThreadSanitizer, and by test_api.py
 * with the library under test.
 */
#include "check.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { THREADS = 8, MILLISECONDS = 4000, NUMBERED = 1500 };

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static IPC_CONTEXT_PTR contexts[2];
static int stop;
static int n_received[2];
static int next_number[2];
static int n_disordered;
static int n_timers;
static int n_replies;

static int add(int *number, int more)
{
    pthread_mutex_lock(&lock);
    const int sum = *number += more;
    pthread_mutex_unlock(&lock);
    return sum;
}

static bool is_over(void)
{
    return add(&stop, 0) > 0;
}

/* ------------------------------------------------------------------------------ handlers */

static void count_numbered(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    const int which = *(int *)client_data;
    const int number = *(int *)content;
    (void)instance;
    EXPECT(IPC_getContext() == contexts[which]);
    if (number != next_number[which]) {
        add(&n_disordered, 1);
    }
    next_number[which] = number + 1; /* handlers of a context are never concurrent */
    IPC_freeByteArray(content);
    add(&n_received[which], 1);
}

static void answer(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    int number = *(int *)content + 1;
    (void)client_data;
    EXPECT_OK(IPC_respond(instance, "r", sizeof number, &number));
    IPC_freeByteArray(content);
}

static void drop(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)instance;
    (void)client_data;
    IPC_freeByteArray(content);
}

static void count_reply(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)instance;
    (void)client_data;
    IPC_freeByteArray(content);
    add(&n_replies, 1);
}

static void count_timer(void *client_data, unsigned long now, unsigned long scheduled)
{
    (void)client_data;
    (void)now;
    (void)scheduled;
    add(&n_timers, 1);
}

static void read_fd(int fd, void *client_data)
{
    char byte;
    (void)client_data;
    EXPECT_INT(read(fd, &byte, 1), 1);
}

static void watch_module(const char *module, void *client_data)
{
    (void)module;
    (void)client_data;
}

static void watch_handlers(const char *message, int count, void *client_data)
{
    (void)message;
    (void)count;
    (void)client_data;
}

/* ------------------------------------------------------------------------------- threads */

static void *listen_always(void *argument)
{
    (void)argument;
    while (!is_over()) {
        IPC_listen(20);
    }
    return NULL;
}

/* The current context belongs to the process; this is the only thread that sets it. */
static void *publish_numbered(void *argument)
{
    (void)argument;
    for (int i = 0; i < NUMBERED; i++) {
        for (int which = 0; which < 2; which++) {
            IPC_setContext(contexts[which]);
            EXPECT_OK(publish_int("numbered", i));
        }
        if (i % 50 == 0) {
            sleep_ms(10);
        }
    }
    return NULL;
}

static void *ask(void *argument)
{
    int number = *(int *)argument;
    while (!is_over()) {
        void *reply = NULL;
        EXPECT_OK(IPC_queryResponse("q", sizeof number, &number, &reply, 20000));
        EXPECT(reply && *(int *)reply == number + 1);
        IPC_freeByteArray(reply);
        IPC_queryNotify("q", sizeof number, &number, count_reply, NULL);
        number++;
    }
    return NULL;
}

static void *subscribe(void *argument)
{
    char name[32];
    for (int i = 0; !is_over(); i++) {
        snprintf(name, sizeof name, "%s%d", (const char *)argument, i % 40);
        EXPECT_OK(define_int(name));
        EXPECT_OK(IPC_subscribe(name, drop, NULL));
        publish_int(name,
                    i); /* another thread may have set the context in which it is not defined */
        IPC_numHandlers(name);
        IPC_subscribeHandlerChange(name, watch_handlers, NULL);
        IPC_unsubscribeHandlerChange(name, watch_handlers);
        EXPECT_OK(IPC_unsubscribe(name, drop));
    }
    return NULL;
}

static void *use_timers_and_descriptors(void *argument)
{
    int ends[2];
    (void)argument;
    EXPECT_INT(pipe(ends), 0);
    while (!is_over()) {
        TIMER_REF reference;
        EXPECT_OK(IPC_addTimerGetRef(1, 3, count_timer, NULL, &reference));
        IPC_subscribeFD(ends[0], read_fd, NULL);
        EXPECT_INT(write(ends[1], "x", 1), 1);
        IPC_subscribeConnect(watch_module, NULL);
        sleep_ms(3);
        IPC_unsubscribeConnect(watch_module);
        IPC_removeTimerByRef(reference);
        IPC_unsubscribeFD(ends[0], read_fd);
    }
    return NULL;
}

static void *use_data(void *argument)
{
    FORMATTER_PTR formatter = IPC_parseFormat("{int, string}");
    struct {
        int number;
        char *text;
    } value = {1, "text"}, *copy;
    (void)argument;
    for (int i = 0; !is_over(); i++) {
        IPC_VARCONTENT_TYPE content;
        char name[32];
        EXPECT_OK(IPC_marshall(formatter, &value, &content));
        EXPECT_OK(IPC_unmarshall(formatter, content.content, (void **)&copy));
        IPC_freeData(formatter, copy);
        IPC_freeByteArray(content.content);
        snprintf(name, sizeof name, "format%d", i % 20);
        IPC_defineFormat(name, "{int, int}");
        IPC_parseFormat(name);
        IPC_publish(NULL, 0, NULL);
        IPC_getConnections();
        sleep_ms(1);
    }
    return NULL;
}

/* --------------------------------------------------------------------------- other modules */

PLAYER(victim)
{
    define_int("q");
    define_int("noise");
    IPC_subscribe("noise", drop, NULL);
    IPC_subscribe("numbered", drop, NULL);
    player_say(0);
    for (int i = 0;; i++) {
        publish_int("noise", i);
        if (IPC_listen(1) == IPC_Error) {
            exit(1);
        }
    }
}

PLAYER(crowd_answerer)
{
    define_int("q");
    define_int("r");
    IPC_setCapacity(4);
    IPC_subscribe("q", answer, NULL);
    player_serve();
}

static void kill_victims(struct central **centrals)
{
    const long end = now_ms() + MILLISECONDS;
    for (int i = 0; now_ms() < end; i++) {
        struct module *victim = module_start("victim", centrals[i % 2]);
        sleep_ms(100 + i * 37 % 150);
        module_kill(victim);
        if (i == 9) {
            break;
        }
    }
    while (now_ms() < end) {
        sleep_ms(20);
    }
}

CHECK_NEW(eight_threads_in_two_contexts_lose_nothing)
{
    static int which[2] = {0, 1};
    static int first = 1000;
    struct central *centrals[2];
    pthread_t threads[THREADS];
    IPC_setVerbosity(IPC_Silent);
    for (int i = 0; i < 2; i++) {
        centrals[i] = central_start(NULL);
        EXPECT_OK(IPC_connectModule("A", centrals[i]->address));
        contexts[i] = IPC_getContext();
        define_int("numbered");
        define_int("q");
        define_int("r");
        define_int("noise");
        IPC_setCapacity(10);
        IPC_subscribe("numbered", count_numbered, &which[i]);
        IPC_subscribe("noise", drop, NULL);
        module_start("crowd_answerer", centrals[i]);
    }
    pthread_create(&threads[0], NULL, listen_always, NULL);
    pthread_create(&threads[1], NULL, listen_always, NULL);
    pthread_create(&threads[2], NULL, publish_numbered, NULL);
    pthread_create(&threads[3], NULL, ask, &first);
    pthread_create(&threads[4], NULL, subscribe, "x");
    pthread_create(&threads[5], NULL, subscribe, "y");
    pthread_create(&threads[6], NULL, use_timers_and_descriptors, NULL);
    pthread_create(&threads[7], NULL, use_data, NULL);
    kill_victims(centrals);
    pthread_join(threads[2], NULL);
    const long end = now_ms() + 30000;
    while ((add(&n_received[0], 0) < NUMBERED || add(&n_received[1], 0) < NUMBERED) &&
           now_ms() < end) {
        sleep_ms(10);
    }
    add(&stop, 1);
    for (int i = 0; i < THREADS; i++) {
        if (i != 2) {
            pthread_join(threads[i], NULL);
        }
    }
    EXPECT_INT(n_received[0], NUMBERED);
    EXPECT_INT(n_received[1], NUMBERED);
    EXPECT_INT(n_disordered, 0);
    EXPECT(n_timers > 0 && n_replies > 0);
    for (int i = 0; i < 2; i++) {
        IPC_setContext(contexts[i]);
        EXPECT_OK(IPC_disconnect());
    }
}
