/*
 * A module that does what it is told.
 *
 * Reads one command a line from standard input, carries it out with the functions of ipc.h
 * and answers with one line "= RESULT".  What handlers see is printed before that, in lines that
 * begin with "@".  One program can so play any module of any test, with any library that has this
 * interface; test/support/driver.py is the other side.
 *
 * A word of a command is percent-encoded; "-" stands for NULL.
 */
#include <ipc.h>

#include <inttypes.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#if defined(_WIN32)
#include <fcntl.h>
#include <io.h>
#define END_AT_ONCE() _exit(9)
#else
#define END_AT_ONCE() raise(SIGKILL)
#endif

enum {
    WORDS = 24,
    LINE = 1 << 17,
    HANDLERS = 4,
    CONTEXTS = 4,
    PUBLISHERS = 8,
    ELEMENTS = 64,
    SHOWN = 512
};

/* What one subscription does with each message, and what it has seen. */
struct subscription {
    struct subscription *next;
    int handler;
    char *words[4]; /* message, action, its arguments */
    unsigned long received;
    unsigned long out_of_order;
    unsigned long corrupt;
    uint32_t expected[PUBLISHERS];
};

struct delayed {
    struct delayed *next;
    MSG_INSTANCE instance;
};

/* C data of the formats that commands can fill in. */
struct sample {
    int number;
    double real;
    char *text;
};
struct link {
    int number;
    struct link *next;
};
struct numbers {
    int count;
    int *items;
};
struct strings {
    int count;
    char **items;
};
struct nested {
    int number;
    struct sample sample;
    int fixed[3];
};

/* The state that handlers and commands share; handlers get no other way to it. */
static struct {
    struct subscription *subscriptions;
    struct delayed *delayed;
    IPC_CONTEXT_PTR contexts[CONTEXTS];
    unsigned long events;
    char line[LINE];
    size_t filled;
} driver;

/* ------------------------------------------------------------------ helpers */

static double seconds_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + (double)now.tv_nsec / 1e9;
}

static void sleep_milliseconds(long milliseconds)
{
    struct timespec rest = {milliseconds / 1000, milliseconds % 1000 * 1000000};
    while (nanosleep(&rest, &rest) != 0) {
    }
}

static char *copy_text(const char *text)
{
    char *copy = text ? malloc(strlen(text) + 1) : NULL;
    return copy ? strcpy(copy, text) : NULL;
}

static void print_hex(const void *bytes, unsigned int length)
{
    const unsigned char *byte = bytes;
    for (unsigned int i = 0; byte && i < length && i < SHOWN; i++) {
        printf("%02x", byte[i]);
    }
    putchar('\n');
}

static void print_escaped(const char *text)
{
    for (; text && *text; text++) {
        if (*text == ' ' || *text == '%' || *text == '\n') {
            printf("%%%02x", (unsigned char)*text);
        } else {
            putchar(*text);
        }
    }
}

static void print_result(IPC_RETURN_TYPE result)
{
    static const char *const names[] = {"Error", "OK", "Timeout"};
    if (result == IPC_Error) {
        printf("= Error %d\n", (int)IPC_errno);
    } else {
        printf("= %s\n", names[result]);
    }
}

/* ----------------------------------------------------------------- sequences */

/*
 * Content of numbered messages: number, publisher, then bytes that depend on both.  What does not
 * fit is left out, so that messages shorter than four bytes are only counted.
 */
static void fill_sequence(unsigned char *content, size_t size, uint32_t number, uint32_t publisher)
{
    uint32_t head[2] = {number, publisher};
    memset(content, (int)((number * 31 + publisher) & 0xff), size);
    memcpy(content, head, size < sizeof head ? size / 4 * 4 : sizeof head);
}

static bool is_intact(const unsigned char *content, size_t size, uint32_t number,
                      uint32_t publisher)
{
    unsigned char expected = (unsigned char)((number * 31 + publisher) & 0xff);
    for (size_t i = 8; i < size; i++) {
        if (content[i] != expected) {
            return false;
        }
    }
    return true;
}

static void check_sequence(struct subscription *subscription, const unsigned char *content,
                           size_t size)
{
    uint32_t head[2] = {0, 0};
    if (size < 4) {
        return;
    }
    memcpy(head, content, size < sizeof head ? 4 : sizeof head);
    uint32_t publisher = head[1] % PUBLISHERS;
    if (head[0] != subscription->expected[publisher]) {
        subscription->out_of_order++;
    }
    subscription->expected[publisher] = head[0] + 1;
    if (!is_intact(content, size, head[0], head[1])) {
        subscription->corrupt++;
    }
}

/* ------------------------------------------------------------------ handlers */

static HANDLER_TYPE handler_of(int number);

static void keep_delayed(MSG_INSTANCE instance)
{
    struct delayed *delayed = malloc(sizeof *delayed);
    struct delayed **end = &driver.delayed;
    delayed->instance = instance;
    delayed->next = NULL;
    while (*end) {
        end = &(*end)->next;
    }
    *end = delayed;
    IPC_delayResponse(instance);
}

static void respond_with_double(MSG_INSTANCE instance, const char *message, BYTE_ARRAY content)
{
    int number = 0;
    IPC_unmarshallData(IPC_msgInstanceFormatter(instance), content, &number, sizeof number);
    number *= 2;
    IPC_respondData(instance, message, &number);
}

/* The rest of a handler's work, by the name of the subscription's action. */
static void act(struct subscription *subscription, MSG_INSTANCE instance, BYTE_ARRAY content)
{
    const char *action = subscription->words[1];
    char *first = subscription->words[2];
    char *second = subscription->words[3];

    if (!action || strcmp(action, "print") == 0 || strcmp(action, "sequence") == 0) {
        return;
    }
    if (strcmp(action, "respond") == 0) {
        IPC_respond(instance, first, second ? (unsigned int)strlen(second) + 1 : 0, second);
    } else if (strcmp(action, "echo") == 0) {
        IPC_respond(instance, first, IPC_dataLength(instance), content);
    } else if (strcmp(action, "double") == 0) {
        respond_with_double(instance, first, content);
    } else if (strcmp(action, "delay") == 0) {
        keep_delayed(instance);
    } else if (strcmp(action, "sleep") == 0) {
        sleep_milliseconds(atol(first));
    } else if (strcmp(action, "listen") == 0) {
        IPC_listen((unsigned int)atol(first));
    } else if (strcmp(action, "publish") == 0) {
        IPC_publish(first, second ? (unsigned int)strlen(second) + 1 : 0, second);
    } else if (strcmp(action, "unsubscribe") == 0) {
        IPC_unsubscribe(subscription->words[0], handler_of(subscription->handler));
    } else if (strcmp(action, "disconnect") == 0) {
        IPC_disconnect();
    } else if (strcmp(action, "kill") == 0) {
        fflush(stdout);
        END_AT_ONCE();
    }
}

static void handle_raw(int handler, MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    struct subscription *subscription = client_data;
    unsigned int length = IPC_dataLength(instance);

    driver.events++;
    subscription->received++;
    if (subscription->words[1] && strcmp(subscription->words[1], "sequence") == 0) {
        check_sequence(subscription, content, content ? length : 0);
    } else {
        printf("@ message %d ", handler);
        print_escaped(IPC_msgInstanceName(instance));
        printf(" %u ", length);
        print_hex(content, length);
    }
    act(subscription, instance, content);
    IPC_freeByteArray(content);
}

static void handle_data(MSG_INSTANCE instance, void *data, void *client_data)
{
    struct subscription *subscription = client_data;
    FORMATTER_PTR formatter = IPC_msgInstanceFormatter(instance);

    driver.events++;
    subscription->received++;
    printf("@ data %d ", subscription->handler);
    print_escaped(IPC_msgInstanceName(instance));
    putchar(' ');
    if (formatter && data) {
        IPC_printData(formatter, stdout, data);
        IPC_freeData(formatter, data);
    } else {
        printf("(none)\n");
        IPC_freeByteArray(data);
    }
}

/* One function each, since a subscription is identified by its function. */
static void handler_0(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    handle_raw(0, instance, content, client_data);
}

static void handler_1(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    handle_raw(1, instance, content, client_data);
}

static void handler_2(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    handle_raw(2, instance, content, client_data);
}

static void handler_3(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    handle_raw(3, instance, content, client_data);
}

static HANDLER_TYPE handler_of(int number)
{
    static const HANDLER_TYPE handlers[HANDLERS] = {handler_0, handler_1, handler_2, handler_3};
    return handlers[number % HANDLERS];
}

/* Prints a reply by the formatter of its message, as text when it has none. */
static void handle_reply(MSG_INSTANCE instance, BYTE_ARRAY content, void *client_data)
{
    FORMATTER_PTR formatter = IPC_msgInstanceFormatter(instance);
    char *tag = client_data;
    void *data = NULL;

    driver.events++;
    printf("@ reply %s ", tag ? tag : "-");
    print_escaped(IPC_msgInstanceName(instance));
    putchar(' ');
    if (formatter && content && IPC_unmarshall(formatter, content, &data) == IPC_OK) {
        IPC_printData(formatter, stdout, data);
        IPC_freeData(formatter, data);
    } else {
        print_escaped(content);
        putchar('\n');
    }
    IPC_freeByteArray(content);
}

static void handle_connect(const char *module, void *client_data)
{
    (void)client_data;
    driver.events++;
    printf("@ connected %s\n", module);
}

static void handle_disconnect(const char *module, void *client_data)
{
    (void)client_data;
    driver.events++;
    printf("@ disconnected %s\n", module);
}

static void handle_change(const char *message, int count, void *client_data)
{
    (void)client_data;
    driver.events++;
    printf("@ handlers %s %d\n", message, count);
}

/* -------------------------------------------------------------------- values */

/* A value of the kind that words[0] names, built from the words after it. */
union value {
    int number;
    long long_number;
    double real;
    char *text;
    struct sample sample;
    struct link links[ELEMENTS];
    struct numbers numbers;
    struct strings strings;
    struct nested nested;
};

static void *value_of_list(char **words, int count, union value *value)
{
    for (int i = 0; i < count && i < ELEMENTS; i++) {
        value->links[i].number = atoi(words[i]);
        value->links[i].next = i + 1 < count && i + 1 < ELEMENTS ? &value->links[i + 1] : NULL;
    }
    return value->links;
}

static void *value_of_numbers(char **words, int count, union value *value, int *items)
{
    for (int i = 0; i < count && i < ELEMENTS; i++) {
        items[i] = atoi(words[i]);
    }
    value->numbers.count = count;
    value->numbers.items = items;
    return &value->numbers;
}

static void fill_sample(char **words, struct sample *sample)
{
    sample->number = atoi(words[0]);
    sample->real = atof(words[1]);
    sample->text = words[2];
}

/* nested NUMBER SAMPLE... FIXED... */
static void *value_of_nested(char **words, int count, union value *value)
{
    value->nested.number = atoi(words[0]);
    fill_sample(words + 1, &value->nested.sample);
    for (int i = 0; i < 3; i++) {
        value->nested.fixed[i] = 4 + i < count ? atoi(words[4 + i]) : 0;
    }
    return value;
}

static void *value_of(char **words, int count, union value *value, int *items)
{
    const char *kind = words[0];

    if (strcmp(kind, "int") == 0) {
        value->number = atoi(words[1]);
    } else if (strcmp(kind, "long") == 0) {
        value->long_number = atol(words[1]);
    } else if (strcmp(kind, "double") == 0) {
        value->real = atof(words[1]);
    } else if (strcmp(kind, "string") == 0) {
        value->text = words[1];
    } else if (strcmp(kind, "sample") == 0) {
        fill_sample(words + 1, &value->sample);
    } else if (strcmp(kind, "nested") == 0) {
        return value_of_nested(words + 1, count - 1, value);
    } else if (strcmp(kind, "strings") == 0) {
        value->strings.count = count - 1;
        value->strings.items = words + 1;
    } else if (strcmp(kind, "list") == 0) {
        return value_of_list(words + 1, count - 1, value);
    } else if (strcmp(kind, "numbers") == 0) {
        return value_of_numbers(words + 1, count - 1, value, items);
    } else {
        return NULL;
    }
    return value;
}

/* ------------------------------------------------------------------ commands */

typedef void command_function(char **words, int count);

static struct subscription *subscription_new(char **words, int count)
{
    struct subscription *subscription = calloc(1, sizeof *subscription);
    subscription->handler = count > 2 ? atoi(words[2]) : 0;
    subscription->words[0] = copy_text(words[1]);
    for (int i = 3; i < count && i < 6; i++) {
        subscription->words[i - 2] = copy_text(words[i]);
    }
    subscription->next = driver.subscriptions;
    driver.subscriptions = subscription;
    return subscription;
}

static void command_verbosity(char **words, int count)
{
    (void)count;
    print_result(IPC_setVerbosity((IPC_VERBOSITY_TYPE)atoi(words[1])));
}

static void command_connect(char **words, int count)
{
    print_result(IPC_connectModule(words[1], count > 2 ? words[2] : NULL));
}

static void command_connect_no_listen(char **words, int count)
{
    print_result(IPC_connectModuleNoListen(words[1], count > 2 ? words[2] : NULL));
}

static void command_disconnect(char **words, int count)
{
    (void)words;
    (void)count;
    print_result(IPC_disconnect());
}

static void command_keep_context(char **words, int count)
{
    (void)count;
    driver.contexts[atoi(words[1]) % CONTEXTS] = IPC_getContext();
    print_result(IPC_OK);
}

static void command_use_context(char **words, int count)
{
    (void)count;
    print_result(IPC_setContext(driver.contexts[atoi(words[1]) % CONTEXTS]));
}

static void command_is_connected(char **words, int count)
{
    (void)words;
    (void)count;
    printf("= %d\n", IPC_isConnected());
}

static void command_module_connected(char **words, int count)
{
    (void)count;
    printf("= %d\n", IPC_isModuleConnected(words[1]));
}

static void command_define(char **words, int count)
{
    unsigned int length = IPC_VARIABLE_LENGTH;
    if (strcmp(words[2], "variable") != 0) {
        length = (unsigned int)strtoul(words[2], NULL, 10);
    }
    print_result(IPC_defineMsg(words[1], length, count > 3 ? words[3] : NULL));
}

static void command_is_defined(char **words, int count)
{
    (void)count;
    printf("= %d\n", IPC_isMsgDefined(words[1]));
}

static void command_format(char **words, int count)
{
    (void)count;
    print_result(IPC_defineFormat(words[1], words[2]));
}

static void command_check_formats(char **words, int count)
{
    (void)count;
    print_result(IPC_checkMsgFormats(words[1], words[2]));
}

static void command_subscribe(char **words, int count)
{
    struct subscription *subscription = subscription_new(words, count);
    print_result(IPC_subscribe(words[1], handler_of(subscription->handler), subscription));
}

static void command_subscribe_data(char **words, int count)
{
    print_result(IPC_subscribeData(words[1], handle_data, subscription_new(words, count)));
}

static void command_unsubscribe(char **words, int count)
{
    print_result(IPC_unsubscribe(words[1], handler_of(count > 2 ? atoi(words[2]) : 0)));
}

static void command_unsubscribe_data(char **words, int count)
{
    (void)count;
    print_result(IPC_unsubscribe(words[1], (HANDLER_TYPE)handle_data));
}

static void command_publish(char **words, int count)
{
    char *text = count > 2 ? words[2] : NULL;
    print_result(IPC_publish(words[1], text ? (unsigned int)strlen(text) + 1 : 0, text));
}

static void command_publish_fixed(char **words, int count)
{
    (void)count;
    print_result(IPC_publishFixed(words[1], words[2]));
}

static void command_publish_bytes(char **words, int count)
{
    unsigned char bytes[SHOWN];
    unsigned int length = 0;
    unsigned int byte;
    for (; count > 2 && sscanf(words[2] + length * 2, "%2x", &byte) == 1 && length < SHOWN;) {
        bytes[length++] = (unsigned char)byte;
    }
    print_result(IPC_publish(words[1], length, bytes));
}

static void command_publish_data(char **words, int count)
{
    union value value;
    int items[ELEMENTS];
    print_result(IPC_publishData(words[1], value_of(words + 2, count - 2, &value, items)));
}

/* publish_text MESSAGE TEXT: the value that the text, as IPC_printData() writes it, describes. */
static void command_publish_text(char **words, int count)
{
    FORMATTER_PTR formatter = IPC_msgFormatter(words[1]);
    FILE *stream = tmpfile(); /* there is no fmemopen on Windows */
    void *data = NULL;
    fputs(words[2], stream);
    rewind(stream);
    IPC_RETURN_TYPE result = IPC_readData(formatter, stream, &data);
    (void)count;

    if (result == IPC_OK) {
        result = IPC_publishData(words[1], data);
        IPC_freeData(formatter, data);
    }
    fclose(stream);
    print_result(result);
}

/* burst MESSAGE COUNT SIZE PUBLISHER [FIRST]: numbered messages as fast as they go. */
static void command_burst(char **words, int count)
{
    uint32_t number = (uint32_t)strtoul(words[2], NULL, 10);
    size_t size = strtoul(words[3], NULL, 10);
    uint32_t publisher = (uint32_t)strtoul(words[4], NULL, 10);
    uint32_t first = count > 5 ? (uint32_t)strtoul(words[5], NULL, 10) : 0;
    unsigned char *content = malloc(size + 1);
    IPC_RETURN_TYPE result = IPC_OK;

    for (uint32_t i = first; i < first + number && result == IPC_OK; i++) {
        fill_sequence(content, size, i, publisher);
        result = IPC_publish(words[1], (unsigned int)size, size ? content : NULL);
    }
    free(content);
    print_result(result);
}

static void command_query(char **words, int count)
{
    char *text = words[2];
    unsigned int limit = count > 3 ? (unsigned int)strtoul(words[3], NULL, 10) : 5000;
    void *reply = NULL;
    IPC_RETURN_TYPE result =
        IPC_queryResponse(words[1], text ? (unsigned int)strlen(text) + 1 : 0, text, &reply, limit);

    if (result == IPC_OK) {
        printf("= OK ");
        print_escaped(reply);
        putchar('\n');
        IPC_freeByteArray(reply);
    } else {
        print_result(result);
    }
}

/* query_data MESSAGE RESPONSE MILLISECONDS KIND VALUE... */
static void command_query_data(char **words, int count)
{
    union value value;
    int items[ELEMENTS];
    void *reply = NULL;
    IPC_RETURN_TYPE result =
        IPC_queryResponseData(words[1], value_of(words + 4, count - 4, &value, items), &reply,
                              (unsigned int)strtoul(words[3], NULL, 10));

    if (result == IPC_OK && reply) {
        FORMATTER_PTR formatter = IPC_msgFormatter(words[2]);
        printf("= OK ");
        IPC_printData(formatter, stdout, reply);
        IPC_freeData(formatter, reply);
    } else {
        print_result(result);
    }
}

static void command_notify(char **words, int count)
{
    char *text = words[2];
    print_result(IPC_queryNotify(words[1], text ? (unsigned int)strlen(text) + 1 : 0, text,
                                 handle_reply, count > 3 ? copy_text(words[3]) : NULL));
}

/* notify_data MESSAGE TAG KIND VALUE... */
static void command_notify_data(char **words, int count)
{
    union value value;
    int items[ELEMENTS];
    print_result(IPC_queryNotifyData(words[1], value_of(words + 3, count - 3, &value, items),
                                     handle_reply, copy_text(words[2])));
}

static MSG_INSTANCE take_delayed(void)
{
    struct delayed *delayed = driver.delayed;
    MSG_INSTANCE instance = NULL;
    if (delayed) {
        instance = delayed->instance;
        driver.delayed = delayed->next;
        free(delayed);
    }
    return instance;
}

static void command_respond(char **words, int count)
{
    char *text = count > 2 ? words[2] : NULL;
    print_result(
        IPC_respond(take_delayed(), words[1], text ? (unsigned int)strlen(text) + 1 : 0, text));
}

static void command_respond_data(char **words, int count)
{
    union value value;
    int items[ELEMENTS];
    print_result(
        IPC_respondData(take_delayed(), words[1], value_of(words + 2, count - 2, &value, items)));
}

static void command_listen(char **words, int count)
{
    (void)count;
    print_result(IPC_listen((unsigned int)strtoul(words[1], NULL, 10)));
}

static void command_listen_clear(char **words, int count)
{
    (void)count;
    print_result(IPC_listenClear((unsigned int)strtoul(words[1], NULL, 10)));
}

static void command_listen_wait(char **words, int count)
{
    (void)count;
    print_result(IPC_listenWait((unsigned int)strtoul(words[1], NULL, 10)));
}

static void command_dispatch(char **words, int count)
{
    (void)words;
    (void)count;
    print_result(IPC_dispatch());
}

/* until COUNT MILLISECONDS: listens until so many events have been handled since the start. */
static void command_until(char **words, int count)
{
    unsigned long wanted = strtoul(words[1], NULL, 10);
    double end = seconds_now() + atof(words[2]) / 1000;
    IPC_RETURN_TYPE result = IPC_OK;
    (void)count;

    while (driver.events < wanted && result != IPC_Error) {
        double left = end - seconds_now();
        if (left <= 0) {
            result = IPC_Timeout;
            break;
        }
        result = IPC_listen((unsigned int)(left * 1000) + 1);
    }
    print_result(driver.events >= wanted ? IPC_OK : result);
}

static void command_events(char **words, int count)
{
    (void)words;
    (void)count;
    printf("= %lu\n", driver.events);
}

/* report MESSAGE: what its first subscription has seen since the last report. */
static void command_report(char **words, int count)
{
    struct subscription *subscription = driver.subscriptions;
    (void)count;
    while (subscription && strcmp(subscription->words[0], words[1]) != 0) {
        subscription = subscription->next;
    }
    if (!subscription) {
        printf("= Error 0\n");
        return;
    }
    printf("= %lu %lu %lu\n", subscription->received, subscription->out_of_order,
           subscription->corrupt);
    subscription->received = subscription->out_of_order = subscription->corrupt = 0;
    memset(subscription->expected, 0, sizeof subscription->expected);
}

static void command_capacity(char **words, int count)
{
    (void)count;
    print_result(IPC_setCapacity(atoi(words[1])));
}

static void command_priority(char **words, int count)
{
    (void)count;
    print_result(IPC_setMsgPriority(words[1], atoi(words[2])));
}

static void command_limit(char **words, int count)
{
    (void)count;
    print_result(IPC_setMsgQueueLength(words[1], atoi(words[2])));
}

static void command_handlers(char **words, int count)
{
    (void)count;
    printf("= %d\n", IPC_numHandlers(words[1]));
}

static void command_watch_connect(char **words, int count)
{
    (void)words;
    (void)count;
    print_result(IPC_subscribeConnect(handle_connect, NULL));
}

static void command_unwatch_connect(char **words, int count)
{
    (void)words;
    (void)count;
    print_result(IPC_unsubscribeConnect(handle_connect));
}

static void command_watch_disconnect(char **words, int count)
{
    (void)words;
    (void)count;
    print_result(IPC_subscribeDisconnect(handle_disconnect, NULL));
}

static void command_watch_handlers(char **words, int count)
{
    (void)count;
    print_result(IPC_subscribeHandlerChange(words[1], handle_change, NULL));
}

static void command_unwatch_handlers(char **words, int count)
{
    (void)count;
    print_result(IPC_unsubscribeHandlerChange(words[1], handle_change));
}

static void command_sleep(char **words, int count)
{
    (void)count;
    sleep_milliseconds(atol(words[1]));
    print_result(IPC_OK);
}

/*
 * race_subscribe COUNT FIFO MILLISECONDS: subscribes to race0, race1, ...; as soon as a
 * subscription has returned, one byte in the FIFO tells the publisher, and the message must come.
 */
static void command_race_subscribe(char **words, int count)
{
    int rounds = atoi(words[1]);
    FILE *fifo = fopen(words[2], "w");
    unsigned int limit = (unsigned int)atoi(words[3]);
    int lost = 0;
    char name[32];
    (void)count;

    for (int i = 0; i < rounds && fifo && lost < 5; i++) {
        snprintf(name, sizeof name, "race%d", i);
        char *subscribe[] = {NULL, name, "0", "sequence"};
        unsigned long before = driver.events;
        double end = seconds_now() + limit / 1000.0;
        IPC_subscribe(name, handler_0, subscription_new(subscribe, 4));
        fputc('x', fifo);
        fflush(fifo);
        while (driver.events == before && seconds_now() < end) {
            IPC_listen(limit);
        }
        lost += driver.events == before;
        IPC_unsubscribe(name, handler_0);
    }
    if (fifo) {
        fclose(fifo);
    }
    printf("= %d\n", fifo ? lost : -1);
}

/* race_publish COUNT FIFO: publishes race<n> when the byte for it comes, and never listens. */
static void command_race_publish(char **words, int count)
{
    int rounds = atoi(words[1]);
    FILE *fifo = fopen(words[2], "r");
    int published = 0;
    char name[32];
    (void)count;

    for (int i = 0; i < rounds && fifo; i++) {
        snprintf(name, sizeof name, "race%d", i);
        IPC_defineMsg(name, IPC_VARIABLE_LENGTH, NULL);
        IPC_isMsgDefined(name);
        if (fgetc(fifo) == EOF) {
            break;
        }
        published += IPC_publish(name, 4, "now") == IPC_OK;
    }
    if (fifo) {
        fclose(fifo);
    }
    printf("= %d\n", published);
}

static void command_quit(char **words, int count)
{
    (void)words;
    (void)count;
    print_result(IPC_disconnect());
    exit(0);
}

static void command_serve(char **words, int count);

static const struct command {
    const char *name;
    int fewest; /* words, the command included */
    command_function *run;
} commands[] = {
    {"burst", 5, command_burst},
    {"capacity", 2, command_capacity},
    {"check_formats", 3, command_check_formats},
    {"connect", 2, command_connect},
    {"connect_no_listen", 2, command_connect_no_listen},
    {"define", 3, command_define},
    {"disconnect", 1, command_disconnect},
    {"dispatch", 1, command_dispatch},
    {"events", 1, command_events},
    {"format", 3, command_format},
    {"handlers", 2, command_handlers},
    {"is_connected", 1, command_is_connected},
    {"is_defined", 2, command_is_defined},
    {"keep_context", 2, command_keep_context},
    {"limit", 3, command_limit},
    {"listen", 2, command_listen},
    {"listen_clear", 2, command_listen_clear},
    {"listen_wait", 2, command_listen_wait},
    {"module_connected", 2, command_module_connected},
    {"notify", 3, command_notify},
    {"notify_data", 5, command_notify_data},
    {"priority", 3, command_priority},
    {"publish", 2, command_publish},
    {"publish_bytes", 2, command_publish_bytes},
    {"publish_data", 3, command_publish_data},
    {"publish_fixed", 3, command_publish_fixed},
    {"publish_text", 3, command_publish_text},
    {"query", 3, command_query},
    {"query_data", 6, command_query_data},
    {"quit", 1, command_quit},
    {"race_publish", 3, command_race_publish},
    {"race_subscribe", 4, command_race_subscribe},
    {"report", 2, command_report},
    {"respond", 2, command_respond},
    {"respond_data", 4, command_respond_data},
    {"serve", 1, command_serve},
    {"sleep", 2, command_sleep},
    {"subscribe", 2, command_subscribe},
    {"subscribe_data", 2, command_subscribe_data},
    {"unsubscribe", 2, command_unsubscribe},
    {"unsubscribe_data", 2, command_unsubscribe_data},
    {"until", 3, command_until},
    {"unwatch_connect", 1, command_unwatch_connect},
    {"unwatch_handlers", 2, command_unwatch_handlers},
    {"use_context", 2, command_use_context},
    {"verbosity", 2, command_verbosity},
    {"watch_connect", 1, command_watch_connect},
    {"watch_disconnect", 1, command_watch_disconnect},
    {"watch_handlers", 2, command_watch_handlers},
};

/* --------------------------------------------------------------------- input */

/* Decodes %xx in place; "-" becomes NULL. */
static char *decode_word(char *word)
{
    char *out = word;
    unsigned int byte;

    if (strcmp(word, "-") == 0) {
        return NULL;
    }
    for (const char *in = word; *in; out++) {
        if (in[0] == '%' && sscanf(in + 1, "%2x", &byte) == 1) {
            *out = (char)byte;
            in += 3;
        } else {
            *out = *in++;
        }
    }
    *out = '\0';
    return word;
}

static void execute(char *line)
{
    char *words[WORDS + 1] = {NULL};
    int count = 0;
    char *rest = NULL;

    for (char *word = strtok_r(line, " ", &rest); word && count < WORDS;
         word = strtok_r(NULL, " ", &rest)) {
        words[count++] = decode_word(word);
    }
    for (size_t i = 0; count && words[0] && i < sizeof commands / sizeof *commands; i++) {
        if (strcmp(commands[i].name, words[0]) == 0 && count >= commands[i].fewest) {
            commands[i].run(words, count);
            fflush(stdout);
            return;
        }
    }
    printf("= unknown command\n");
    fflush(stdout);
}

/* Waits for input and executes the lines that are complete: false at the end. */
static bool execute_input(void)
{
    ssize_t got = read(0, driver.line + driver.filled, sizeof driver.line - driver.filled - 1);
    if (got <= 0) {
        return false;
    }
    driver.filled += (size_t)got;
    driver.line[driver.filled] = '\0';
    for (char *end; (end = strchr(driver.line, '\n')) != NULL;) {
        static char line[LINE];
        size_t length = (size_t)(end - driver.line);
        memcpy(line, driver.line, length);
        line[length] = '\0';
        driver.filled -= length + 1;
        memmove(driver.line, end + 1, driver.filled + 1);
        execute(line);
    }
    return true;
}

static void handle_input(int fd, void *client_data)
{
    (void)fd;
    (void)client_data;
    if (!execute_input()) {
        exit(0);
    }
}

/* From here on messages are handled as they come, between the commands. */
static void command_serve(char **words, int count)
{
    (void)words;
    (void)count;
    IPC_subscribeFD(0, handle_input, NULL);
    print_result(IPC_OK);
    fflush(stdout);
    while (IPC_listen(IPC_WAIT_FOREVER) != IPC_Error) {
        fflush(stdout);
    }
    exit(3);
}

int main(void)
{
#if defined(_WIN32)
    _setmode(0, _O_BINARY); /* lines end as they do elsewhere */
    _setmode(1, _O_BINARY);
#endif
    setvbuf(stdout, NULL, _IOLBF, BUFSIZ); /* what a library says in a call is seen at once */
    IPC_initialize();
    while (execute_input()) {
    }
    return 0;
}
