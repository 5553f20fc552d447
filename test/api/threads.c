/*
 * Several threads in one module (T185 to T190).  What original libraries do by chance is not
 * tested.
 */
#include "check.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef void *thread_function(void *);

static pthread_t thread_start(thread_function *function, void *argument)
{
    pthread_t thread;
    EXPECT_INT(pthread_create(&thread, NULL, function, argument), 0);
    return thread;
}

static void threads_join(const pthread_t *threads, int n_threads)
{
    for (int i = 0; i < n_threads; i++) {
        EXPECT_INT(pthread_join(threads[i], NULL), 0);
    }
}

/* Numbers that threads share, without a word of the library's lock. */
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

static int add(int *number, int more)
{
    pthread_mutex_lock(&lock);
    const int sum = *number += more;
    pthread_mutex_unlock(&lock);
    return sum;
}

static int get(int *number)
{
    return add(number, 0);
}

/* Whether the number becomes at least that, in five seconds. */
static bool becomes(int *number, int wanted)
{
    const long end = now_ms() + 5000;
    while (get(number) < wanted && now_ms() < end) {
        sleep_ms(2);
    }
    return get(number) >= wanted;
}

static int stop;

static void *listen_until_stopped(void *argument)
{
    (void)argument;
    while (!get(&stop)) {
        IPC_listen(20);
    }
    return NULL;
}

/* ------------------------------------------------------------------------------- publishing */

enum { PUBLISHERS = 3, MESSAGES = 2000 };

struct numbered {
    int publisher;
    int number;
};

static int next_number[PUBLISHERS];
static int n_received;
static int n_running;
static int n_concurrent;
static int n_disordered;

static void receive(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    const struct numbered *message = content;
    (void)instance;
    (void)client_data;
    if (add(&n_running, 1) > 1) {
        add(&n_concurrent, 1);
    }
    if (message->number != next_number[message->publisher]) {
        add(&n_disordered, 1);
    }
    next_number[message->publisher] = message->number + 1;
    IPC_freeByteArray(content);
    add(&n_running, -1);
    add(&n_received, 1);
}

static void *publish_many(void *argument)
{
    struct numbered message = {*(int *)argument, 0};
    for (; message.number < MESSAGES; message.number++) {
        EXPECT_OK(IPC_publish("m", sizeof message, &message));
    }
    return NULL;
}

static void expect_all_messages(int n_listeners)
{
    static int numbers[PUBLISHERS] = {0, 1, 2};
    pthread_t publishers[PUBLISHERS];
    pthread_t listeners[2];
    connected();
    IPC_defineMsg("m", IPC_VARIABLE_LENGTH, NULL);
    IPC_setCapacity(50);
    IPC_subscribe("m", receive, NULL);
    settle();
    EXPECT_INT(IPC_isMsgDefined("m"), 1);
    for (int i = 0; i < n_listeners; i++) {
        listeners[i] = thread_start(listen_until_stopped, NULL);
    }
    for (int i = 0; i < PUBLISHERS; i++) {
        publishers[i] = thread_start(publish_many, &numbers[i]);
    }
    const long end = now_ms() + 30000;
    while (get(&n_received) < PUBLISHERS * MESSAGES && now_ms() < end) {
        if (n_listeners == 0) {
            IPC_listen(20);
        } else {
            sleep_ms(5);
        }
    }
    threads_join(publishers, PUBLISHERS);
    add(&stop, 1);
    threads_join(listeners, n_listeners);
    EXPECT_INT(n_received, PUBLISHERS * MESSAGES);
    if (!is_original()) {
        EXPECT_INT(n_disordered, 0);
        EXPECT_INT(n_concurrent, 0);
    }
}

CHECK(three_threads_may_publish_while_the_main_one_listens)
{
    expect_all_messages(0);
}

CHECK(three_threads_may_publish_while_two_others_listen)
{
    expect_all_messages(2);
}

enum { LATE = 300 };

static void late_name(int number, char name[16])
{
    snprintf(name, 16, "late%d", number);
}

/* Two of each message, one after the other. */
PLAYER(late_publisher)
{
    char name[16];
    for (int i = 0; i < 2 * LATE; i++) {
        struct numbered message = {0, i};
        late_name(i / 2, name);
        EXPECT_OK(IPC_defineMsg(name, IPC_VARIABLE_LENGTH, NULL));
        EXPECT_OK(IPC_publish(name, sizeof message, &message));
    }
    player_serve();
}

/* Where a message is not known yet, central is asked before its handler can run: no other thread is
 * faster with the message that comes after it. */
CHECK_NEW(messages_defined_late_keep_their_order_among_threads)
{
    pthread_t listeners[2];
    char name[16];
    struct central *central = connected();
    IPC_setCapacity(50);
    for (int i = 0; i < LATE; i++) {
        late_name(i, name);
        EXPECT_OK(IPC_subscribe(name, receive, NULL));
    }
    for (int i = 0; i < 2; i++) {
        listeners[i] = thread_start(listen_until_stopped, NULL);
    }
    module_start("late_publisher", central);
    EXPECT(becomes(&n_received, 2 * LATE));
    add(&stop, 1);
    threads_join(listeners, 2);
    EXPECT_INT(n_received, 2 * LATE);
    EXPECT_INT(n_disordered, 0);
    EXPECT_INT(n_concurrent, 0);
}

/* ----------------------------------------------------------------------------------- asking */

static void answer(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    int number = *(int *)content + 1000000;
    (void)client_data;
    EXPECT_OK(IPC_respond(instance, "r", sizeof number, &number));
    IPC_freeByteArray(content);
}

PLAYER(answerer)
{
    define_int("q");
    define_int("r");
    IPC_setCapacity(4);
    IPC_subscribe("q", answer, NULL);
    player_serve();
}

enum { QUERIES = 200 };

static void *ask_many(void *argument)
{
    int number = *(int *)argument;
    for (int i = 0; i < QUERIES; i++, number++) {
        void *reply = NULL;
        EXPECT_OK(IPC_queryResponse("q", sizeof number, &number, &reply, 5000));
        EXPECT(reply && *(int *)reply == number + 1000000);
        IPC_freeByteArray(reply);
    }
    return NULL;
}

static void expect_all_replies(int n_listeners)
{
    static int first[2] = {0, 100000};
    pthread_t threads[4];
    struct central *central = connected();
    define_int("q");
    define_int("r");
    module_start("answerer", central);
    for (int i = 0; i < 2; i++) {
        threads[i] = thread_start(ask_many, &first[i]);
    }
    for (int i = 0; i < n_listeners; i++) {
        threads[2 + i] = thread_start(listen_until_stopped, NULL);
    }
    threads_join(threads, 2);
    add(&stop, 1);
    threads_join(&threads[2], n_listeners);
}

CHECK_NEW(two_threads_may_ask_at_a_time)
{
    expect_all_replies(0);
}

CHECK_NEW(two_threads_may_ask_while_two_others_listen)
{
    expect_all_replies(2);
}

static void *ask_central_many(void *argument)
{
    (void)argument;
    for (int i = 0; i < 10 * QUERIES; i++) {
        EXPECT_INT(IPC_isModuleConnected("A"), 1);
    }
    return NULL;
}

static void *look_until_stopped(void *argument)
{
    (void)argument;
    while (!get(&stop)) {
        IPC_listen(0);
    }
    return NULL;
}

/* An answer that another thread reads, just before the one that waits for it begins to wait in the
 * kernel, still ends that wait. */
CHECK_NEW(what_one_thread_reads_ends_the_wait_of_another)
{
    pthread_t asking[2];
    pthread_t looking;
    connected();
    looking = thread_start(look_until_stopped, NULL);
    for (int i = 0; i < 2; i++) {
        asking[i] = thread_start(ask_central_many, NULL);
    }
    threads_join(asking, 2);
    add(&stop, 1);
    pthread_join(looking, NULL);
}

/* --------------------------------------------------------------------- everything at a time */

enum { NAMES = 100 };

static void *use_names(void *argument)
{
    char name[32];
    for (int i = 0; i < NAMES; i++) {
        snprintf(name, sizeof name, "%s%d", (const char *)argument, i);
        EXPECT_OK(define_int(name));
        EXPECT_OK(IPC_subscribe(name, note_a, NULL));
        EXPECT_INT(IPC_numHandlers(name), 1);
        EXPECT_INT(IPC_isMsgDefined(name), 1);
        EXPECT(IPC_msgFormatter(name) != NULL);
        EXPECT_OK(IPC_unsubscribe(name, note_a));
    }
    return NULL;
}

static void *publish_until_stopped(void *argument)
{
    (void)argument;
    while (!get(&stop)) {
        EXPECT_OK(publish_int("m", 1));
        sleep_ms(1);
    }
    return NULL;
}

static void count(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)instance;
    (void)client_data;
    IPC_freeByteArray(content);
    add(&n_received, 1);
}

CHECK_NEW(threads_may_define_and_subscribe_while_others_listen_and_publish)
{
    pthread_t threads[4];
    connected();
    define_int("m");
    IPC_subscribe("m", count, NULL);
    threads[0] = thread_start(use_names, "x");
    threads[1] = thread_start(use_names, "y");
    threads[2] = thread_start(listen_until_stopped, NULL);
    threads[3] = thread_start(publish_until_stopped, NULL);
    threads_join(threads, 2);
    EXPECT(becomes(&n_received, 1));
    add(&stop, 1);
    threads_join(&threads[2], 2);
}

/* ---------------------------------------------------------------- while others are busy */

static int n_busy;
static int n_finished;

static void sleep_in_handler(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)instance;
    (void)client_data;
    IPC_freeByteArray(content);
    add(&n_busy, 1);
    sleep_ms(1500);
    add(&n_finished, 1);
}

static void *listen_once(void *argument)
{
    (void)argument;
    IPC_listen(5000);
    return NULL;
}

CHECK_NEW(a_query_is_answered_while_another_thread_is_in_a_handler)
{
    int number = 4;
    void *reply = NULL;
    struct central *central = connected();
    define_int("m");
    define_int("q");
    module_start("answerer", central);
    IPC_subscribe("m", sleep_in_handler, NULL);
    publish_int("m", 1);
    pthread_t thread = thread_start(listen_once, NULL);
    EXPECT(becomes(&n_busy, 1));
    EXPECT_OK(IPC_queryResponse("q", sizeof number, &number, &reply, 5000));
    EXPECT_INT(get(&n_finished), 0);
    EXPECT(reply && *(int *)reply == 1000004);
    IPC_freeByteArray(reply);
    EXPECT_INT(IPC_numHandlers("m"), 1);
    EXPECT_INT(get(&n_finished), 0);
    pthread_join(thread, NULL);
}

static void sleep_in_timer(void *client_data, unsigned long now, unsigned long scheduled)
{
    (void)client_data;
    (void)now;
    (void)scheduled;
    add(&n_busy, 1);
    sleep_ms(800);
    add(&n_finished, 1);
}

static void *listen_for_a_second(void *argument)
{
    (void)argument;
    listen_for(1000);
    return NULL;
}

CHECK_NEW(a_timer_handler_does_not_block_other_threads)
{
    connected();
    define_int("m");
    EXPECT_INT(IPC_isMsgDefined("m"), 1);
    IPC_addOneShotTimer(10, sleep_in_timer, NULL);
    pthread_t thread = thread_start(listen_for_a_second, NULL);
    EXPECT(becomes(&n_busy, 1));
    EXPECT_OK(publish_int("m", 1));
    EXPECT_INT(IPC_isModuleConnected("A"), 1);
    EXPECT_INT(get(&n_finished), 0);
    pthread_join(thread, NULL);
}

/* ------------------------------------------------- a thread that waits sees what others do */

static int n_events;
static IPC_RETURN_TYPE end_of_listening;
static IPC_ERROR_TYPE error_of_listening;

static void *listen_for_ever(void *argument)
{
    (void)argument;
    end_of_listening = IPC_dispatch();
    error_of_listening = IPC_errno;
    return NULL;
}

static void count_message(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)instance;
    (void)client_data;
    IPC_freeByteArray(content);
    add(&n_events, 1);
}

static void count_timer(void *client_data, unsigned long now, unsigned long scheduled)
{
    (void)client_data;
    (void)now;
    (void)scheduled;
    add(&n_events, 1);
}

static void count_fd(int fd, void *client_data)
{
    char byte;
    (void)client_data;
    EXPECT_INT(read(fd, &byte, 1), 1);
    add(&n_events, 1);
}

CHECK_NEW(a_thread_that_waits_for_ever_takes_up_what_others_add)
{
    int ends[2];
    connected();
    EXPECT_INT(pipe(ends), 0);
    define_int("m");
    pthread_t thread = thread_start(listen_for_ever, NULL);
    sleep_ms(100);
    EXPECT_OK(IPC_subscribe("m", count_message, NULL));
    EXPECT_OK(publish_int("m", 1));
    EXPECT(becomes(&n_events, 1));
    sleep_ms(50);
    EXPECT_OK(IPC_addTimer(10, 1, count_timer, NULL));
    EXPECT(becomes(&n_events, 2));
    sleep_ms(50);
    EXPECT_INT(write(ends[1], "x", 1), 1);
    EXPECT_OK(IPC_subscribeFD(ends[0], count_fd, NULL));
    EXPECT(becomes(&n_events, 3));
    sleep_ms(50);
    EXPECT_OK(IPC_disconnect());
    pthread_join(thread, NULL);
    EXPECT_INT(end_of_listening, IPC_Error);
    EXPECT_INT(error_of_listening, IPC_Not_Connected);
    EXPECT_INT(n_events, 3);
}

static void *ask_without_end(void *argument)
{
    int number = 1;
    void *reply = argument;
    end_of_listening = IPC_queryResponse("q", sizeof number, &number, &reply, IPC_WAIT_FOREVER);
    error_of_listening = IPC_errno;
    EXPECT(reply == NULL);
    return NULL;
}

CHECK_NEW(disconnecting_ends_the_query_of_another_thread)
{
    connected();
    define_int("q");
    pthread_t thread = thread_start(ask_without_end, &n_events);
    sleep_ms(100);
    EXPECT_OK(IPC_disconnect());
    pthread_join(thread, NULL);
    EXPECT_INT(end_of_listening, IPC_Error);
    EXPECT_INT(error_of_listening, IPC_Not_Connected);
}

/* --------------------------------------------------------------------------------- contexts */

static IPC_CONTEXT_PTR contexts[2];

static void set_second_and_wait(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    (void)instance;
    (void)client_data;
    IPC_freeByteArray(content);
    EXPECT(IPC_getContext() == contexts[0]);
    IPC_setContext(contexts[1]);
    add(&n_busy, 1);
    sleep_ms(300);
    EXPECT(IPC_getContext() == contexts[1]);
    add(&n_finished, 1);
}

CHECK_NEW(the_context_that_a_handler_sets_is_its_own)
{
    IPC_setVerbosity(IPC_Silent);
    for (int i = 0; i < 2; i++) {
        EXPECT_OK(IPC_connectModule("A", central_start(NULL)->address));
        contexts[i] = IPC_getContext();
        define_int("m");
    }
    IPC_setContext(contexts[0]);
    IPC_subscribe("m", set_second_and_wait, NULL);
    publish_int("m", 1);
    pthread_t thread = thread_start(listen_once, NULL);
    EXPECT(becomes(&n_busy, 1));
    EXPECT(IPC_getContext() == contexts[0]);
    EXPECT_INT(get(&n_finished), 0);
    pthread_join(thread, NULL);
    EXPECT(IPC_getContext() == contexts[0]);
}

/* ------------------------------------------------------------------------- loss of central */

static int n_losses;

static void count_loss(void)
{
    add(&n_losses, 1);
    EXPECT_INT(IPC_isConnected(), 0);
}

static void *listen_to_the_end(void *argument)
{
    (void)argument;
    while (IPC_listen(5000) != IPC_Error) {
    }
    return NULL;
}

CHECK_NEW(a_loss_is_told_once_however_many_threads_wait)
{
    pthread_t threads[4];
    struct central *central = connected();
    define_int("q");
    x_ipcRegisterExitProc(count_loss);
    for (int i = 0; i < 3; i++) {
        threads[i] = thread_start(listen_to_the_end, NULL);
    }
    threads[3] = thread_start(ask_without_end, &n_events);
    sleep_ms(100);
    central_kill(central);
    threads_join(threads, 4);
    EXPECT_INT(get(&n_losses), 1);
    EXPECT_INT(end_of_listening, IPC_Error);
}

static void *dispatch(void *argument)
{
    (void)argument;
    EXPECT_INT(IPC_dispatch(), IPC_Error);
    return NULL;
}

CHECK_NEW(a_thread_connects_while_another_waits_without_end)
{
    (void)connected();
    struct central *second = central_start(NULL);
    IPC_CONTEXT_PTR first = IPC_getContext();
    pthread_t listener = thread_start(dispatch, NULL);
    sleep_ms(100); /* it waits in the kernel by now, and for one connection only */
    EXPECT_OK(IPC_connectModule("A", second->address));
    EXPECT(IPC_getContext() != first);
    EXPECT_OK(IPC_disconnect());
    EXPECT_OK(IPC_setContext(first));
    EXPECT_OK(IPC_disconnect());
    pthread_join(listener, NULL);
}
