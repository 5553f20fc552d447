/*
 * What encoding and decoding cost, beside C written by hand for the same type.
 *
 * Prints nanoseconds for each type of a list: encoding into a buffer of its own,
 * and decoding with the release of the result; ours, by hand, and the ratio.
 * Given the path of a CMU IPC library, its IPC_marshall and IPC_unmarshall are
 * measured too, through its public functions only.
 *
 *     format_bench [libipc.so]
 *
 * Not part of the tests: it judges nothing.
 */
#define _POSIX_C_SOURCE 200809L

#include <dlfcn.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "format/format.h"

/* Bytes as the API's marshalling returns them: a malloc block. */
struct bytes {
    uint8_t *content;
    size_t length;
};

struct subject {
    const char *name;
    const char *format;
    void *value;
    struct bytes (*encode)(const void *value);
    void *(*decode)(const uint8_t *content); /* and release_by_hand frees it */
    void (*release)(void *value);
};

/* Keeps the compiler from leaving out what nobody looks at. */
static void *volatile sink;

/* ---------------------------------------------------------------- by hand */

static uint8_t *put(uint8_t *to, const void *from, size_t size)
{
    memcpy(to, from, size);
    return to + size;
}

static uint8_t *put_string(uint8_t *to, const char *text)
{
    const uint32_t length = text == NULL ? 0 : (uint32_t)strlen(text);
    to = put(to, &length, 4);
    if (length > 0) {
        return put(to, text, length);
    }
    *to = 'Z';
    return to + 1;
}

static size_t string_size(const char *text)
{
    const size_t length = text == NULL ? 0 : strlen(text);
    return 4 + (length > 0 ? length : 1);
}

static const uint8_t *get(const uint8_t *from, void *to, size_t size)
{
    memcpy(to, from, size);
    return from + size;
}

static const uint8_t *get_string(const uint8_t *from, char **text)
{
    uint32_t length;
    from = get(from, &length, 4);
    *text = NULL;
    if (length == 0) {
        return from + 1;
    }
    *text = malloc(length + 1);
    memcpy(*text, from, length);
    (*text)[length] = '\0';
    return from + length;
}

static struct bytes new_bytes(size_t length)
{
    return (struct bytes){malloc(length), length};
}

static struct bytes copy_bytes(const void *from, size_t length)
{
    struct bytes bytes = new_bytes(length);
    memcpy(bytes.content, from, length);
    return bytes;
}

static void *copy_block(const void *from, size_t length)
{
    void *block = malloc(length);
    memcpy(block, from, length);
    return block;
}

struct pose {
    int a, b;
    double x, y, theta;
    float u, v;
};

static struct bytes encode_pose(const void *value)
{
    return copy_bytes(value, sizeof(struct pose));
}

static void *decode_pose(const uint8_t *content)
{
    return copy_block(content, sizeof(struct pose));
}

struct record {
    int number;
    double value;
    char *name;
};

static struct bytes encode_record(const void *value)
{
    const struct record *r = value;
    struct bytes bytes = new_bytes(12 + string_size(r->name));
    uint8_t *to = put(bytes.content, &r->number, 4);
    to = put(to, &r->value, 8);
    (void)put_string(to, r->name);
    return bytes;
}

static void *decode_record(const uint8_t *content)
{
    struct record *r = malloc(sizeof *r);
    content = get(content, &r->number, 4);
    content = get(content, &r->value, 8);
    (void)get_string(content, &r->name);
    return r;
}

static void release_record(void *value)
{
    free(((struct record *)value)->name);
    free(value);
}

enum { N_DOUBLES = 1000, N_MANY = 100000, N_RECORDS = 1000, N_BEAMS = 1081 };

static struct bytes encode_doubles(const void *value)
{
    return copy_bytes(value, N_DOUBLES * sizeof(double));
}

static void *decode_doubles(const uint8_t *content)
{
    return copy_block(content, N_DOUBLES * sizeof(double));
}

struct counted {
    int count;
    void *elements;
};

static struct bytes encode_many(const void *value)
{
    const struct counted *c = value;
    const size_t size = (size_t)c->count * sizeof(double);
    struct bytes bytes = new_bytes(8 + size);
    uint8_t *to = put(bytes.content, &c->count, 4);
    to = put(to, &c->count, 4);
    (void)put(to, c->elements, size);
    return bytes;
}

static void *decode_many(const uint8_t *content)
{
    struct counted *c = malloc(sizeof *c);
    content = get(content, &c->count, 4);
    c->elements = copy_block(content + 4, (size_t)c->count * sizeof(double));
    return c;
}

static void release_counted(void *value)
{
    free(((struct counted *)value)->elements);
    free(value);
}

struct item {
    int number;
    char *name;
    double value;
};

static struct bytes encode_items(const void *value)
{
    const struct counted *c = value;
    const struct item *items = c->elements;
    size_t size = 8;
    for (int i = 0; i < c->count; i++) {
        size += 12 + string_size(items[i].name);
    }
    struct bytes bytes = new_bytes(size);
    uint8_t *to = put(bytes.content, &c->count, 4);
    to = put(to, &c->count, 4);
    for (int i = 0; i < c->count; i++) {
        to = put(to, &items[i].number, 4);
        to = put_string(to, items[i].name);
        to = put(to, &items[i].value, 8);
    }
    return bytes;
}

static void *decode_items(const uint8_t *content)
{
    struct counted *c = malloc(sizeof *c);
    content = get(content, &c->count, 4);
    struct item *items = malloc((size_t)c->count * sizeof *items);
    c->elements = items;
    content += 4;
    for (int i = 0; i < c->count; i++) {
        content = get(content, &items[i].number, 4);
        content = get_string(content, &items[i].name);
        content = get(content, &items[i].value, 8);
    }
    return c;
}

static void release_items(void *value)
{
    struct counted *c = value;
    struct item *items = c->elements;
    for (int i = 0; i < c->count; i++) {
        free(items[i].name);
    }
    release_counted(c);
}

struct node {
    int number;
    double value;
    struct node *next;
};

static struct bytes encode_list(const void *value)
{
    size_t size = 0;
    for (const struct node *n = value; n != NULL; n = n->next) {
        size += 13;
    }
    struct bytes bytes = new_bytes(size);
    uint8_t *to = bytes.content;
    for (const struct node *n = value; n != NULL; n = n->next) {
        to = put(to, &n->number, 4);
        to = put(to, &n->value, 8);
        *to++ = n->next == NULL ? 0 : 'Z';
    }
    return bytes;
}

static void *decode_list(const uint8_t *content)
{
    struct node *first = NULL, **link = &first;
    bool more = true;
    while (more) {
        struct node *n = malloc(sizeof *n);
        content = get(content, &n->number, 4);
        content = get(content, &n->value, 8);
        more = *content++ != 0;
        *link = n;
        link = &n->next;
    }
    *link = NULL;
    return first;
}

static void release_list(void *value)
{
    for (struct node *n = value, *next; n != NULL; n = next) {
        next = n->next;
        free(n);
    }
}

struct mixed {
    char *name;
    double matrix[4][4];
    struct {
        int a, b;
    } pairs[3];
    struct {
        short s;
        char c;
        double d;
    } last;
};

static struct bytes encode_mixed(const void *value)
{
    const struct mixed *m = value;
    struct bytes bytes = new_bytes(string_size(m->name) + 128 + 24 + 11);
    uint8_t *to = put_string(bytes.content, m->name);
    to = put(to, m->matrix, 128);
    to = put(to, m->pairs, 24);
    to = put(to, &m->last.s, 2);
    to = put(to, &m->last.c, 1);
    (void)put(to, &m->last.d, 8);
    return bytes;
}

static void *decode_mixed(const uint8_t *content)
{
    struct mixed *m = malloc(sizeof *m);
    content = get_string(content, &m->name);
    content = get(content, m->matrix, 128);
    content = get(content, m->pairs, 24);
    content = get(content, &m->last.s, 2);
    content = get(content, &m->last.c, 1);
    (void)get(content, &m->last.d, 8);
    return m;
}

static void release_mixed(void *value)
{
    free(((struct mixed *)value)->name);
    free(value);
}

struct scan {
    double time;
    int count;
    float *ranges;
    char *host;
};

static struct bytes encode_scan(const void *value)
{
    const struct scan *s = value;
    struct bytes bytes = new_bytes(16 + (size_t)s->count * 4 + string_size(s->host));
    uint8_t *to = put(bytes.content, &s->time, 8);
    to = put(to, &s->count, 4);
    to = put(to, &s->count, 4);
    to = put(to, s->ranges, (size_t)s->count * 4);
    (void)put_string(to, s->host);
    return bytes;
}

static void *decode_scan(const uint8_t *content)
{
    struct scan *s = malloc(sizeof *s);
    content = get(content, &s->time, 8);
    content = get(content, &s->count, 4);
    s->ranges = copy_block(content + 4, (size_t)s->count * 4);
    (void)get_string(content + 4 + (size_t)s->count * 4, &s->host);
    return s;
}

static void release_scan(void *value)
{
    struct scan *s = value;
    free(s->ranges);
    free(s->host);
    free(s);
}

enum { ROWS = 640, COLUMNS = 480 * 3 };

struct image {
    int rows, columns;
    uint8_t *pixels;
};

static struct bytes encode_image(const void *value)
{
    const struct image *m = value;
    const int count = m->rows * m->columns;
    struct bytes bytes = new_bytes(12 + (size_t)count);
    uint8_t *to = put(bytes.content, &m->rows, 4);
    to = put(to, &m->columns, 4);
    to = put(to, &count, 4);
    (void)put(to, m->pixels, (size_t)count);
    return bytes;
}

static void *decode_image(const uint8_t *content)
{
    struct image *m = malloc(sizeof *m);
    content = get(content, &m->rows, 4);
    content = get(content, &m->columns, 4);
    m->pixels = copy_block(content + 4, (size_t)m->rows * (size_t)m->columns);
    return m;
}

static void release_image(void *value)
{
    free(((struct image *)value)->pixels);
    free(value);
}

/* ----------------------------------------------------------------- values */

static char *copy_text(const char *text)
{
    char *copy = malloc(strlen(text) + 1);
    strcpy(copy, text);
    return copy;
}

static void *zeroed(size_t size)
{
    void *block = calloc(1, size);
    if (block == NULL) {
        abort();
    }
    return block;
}

static void *make_record(void)
{
    struct record *r = zeroed(sizeof *r);
    r->number = 7;
    r->value = 2.5;
    r->name = copy_text("twenty letters of it");
    return r;
}

static void *make_many(void)
{
    struct counted *c = zeroed(sizeof *c);
    c->count = N_MANY;
    c->elements = zeroed(N_MANY * sizeof(double));
    return c;
}

static void *make_items(void)
{
    struct counted *c = zeroed(sizeof *c);
    struct item *items = zeroed(N_RECORDS * sizeof *items);
    c->count = N_RECORDS;
    c->elements = items;
    for (int i = 0; i < N_RECORDS; i++) {
        items[i] = (struct item){i, copy_text("name 12345"), i * 0.5};
    }
    return c;
}

static void *make_list(void)
{
    struct node *first = NULL;
    for (int i = N_RECORDS; i > 0; i--) {
        struct node *n = zeroed(sizeof *n);
        n->number = i;
        n->next = first;
        first = n;
    }
    return first;
}

static void *make_mixed(void)
{
    struct mixed *m = zeroed(sizeof *m);
    m->name = copy_text("a mixed bag");
    return m;
}

static void *make_scan(void)
{
    struct scan *s = zeroed(sizeof *s);
    s->count = N_BEAMS;
    s->ranges = zeroed(N_BEAMS * sizeof(float));
    s->host = copy_text("robot.local");
    return s;
}

static void *make_image(void)
{
    struct image *m = zeroed(sizeof *m);
    m->rows = ROWS;
    m->columns = COLUMNS;
    m->pixels = zeroed((size_t)ROWS * COLUMNS);
    return m;
}

/* -------------------------------------------------------------- measuring */

enum { ROUNDS = 200, MOST_FUNCTIONS = 7 };

static const double ROUND_NS = 3e5; /* short: some rounds then find the processor idle */

static double now(void)
{
    struct timespec time;
    (void)clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec * 1e9 + (double)time.tv_nsec;
}

/* What is measured: one encoding, or one decoding with its release. */
struct measured {
    const struct subject *subject;
    const struct format *format;
    const uint8_t *content;
    size_t length;
    const void *formatter; /* of the other library */
};

typedef void (*run_function)(const struct measured *measured);

/* One round: nanoseconds of one run. */
static double time_round(const struct measured *measured, run_function run, long *runs)
{
    for (;;) {
        const double start = now();
        for (long i = 0; i < *runs; i++) {
            run(measured);
        }
        const double spent = now() - start;
        if (spent >= ROUND_NS) {
            return spent / (double)*runs;
        }
        *runs *= 2; /* too short to be told from noise */
    }
}

/* The least times of several functions, whose rounds alternate so that all meet the same noise. */
static void least_times(const struct measured *measured, const run_function *functions,
                        size_t n_functions, double *least)
{
    long runs[MOST_FUNCTIONS];
    for (size_t k = 0; k < n_functions; k++) {
        runs[k] = 1;
        least[k] = 1e30;
    }
    for (int round = 0; round < ROUNDS; round++) {
        for (size_t k = 0; k < n_functions; k++) {
            const double each = time_round(measured, functions[k], &runs[k]);
            least[k] = each < least[k] ? each : least[k];
        }
    }
}

static void run_encode(const struct measured *m)
{
    struct buffer out;
    size_t length;
    buffer_init(&out);
    (void)format_encode(m->format, m->subject->value, byte_order_of_host(), &out);
    sink = buffer_take(&out, &length);
    free(sink);
}

static void run_decode(const struct measured *m)
{
    const struct format_source source = {m->content, m->length, byte_order_of_host()};
    void *value;
    (void)format_decode_new(m->format, &source, &value, NULL);
    sink = value;
    (void)format_release(m->format, value);
    free(value);
}

static void run_encode_foreign(const struct measured *m)
{
    struct buffer out;
    size_t length;
    buffer_init(&out);
    (void)format_encode(m->format, m->subject->value,
                        byte_order_of_host() == ORDER_BIG ? ORDER_LITTLE : ORDER_BIG, &out);
    sink = buffer_take(&out, &length);
    free(sink);
}

static void run_encode_by_hand(const struct measured *m)
{
    sink = m->subject->encode(m->subject->value).content;
    free(sink);
}

static void run_decode_by_hand(const struct measured *m)
{
    sink = m->subject->decode(m->content);
    m->subject->release(sink);
}

/* ------------------------------------------------------ the other library */

struct other_bytes {
    unsigned int length;
    void *content;
};

static struct {
    int (*initialize)(void);
    const void *(*parse_format)(const char *format);
    int (*marshall)(const void *formatter, void *value, struct other_bytes *bytes);
    int (*unmarshall)(const void *formatter, const void *content, void **value);
    int (*free_data)(const void *formatter, void *value);
} other;

/* dlsym gives a pointer to an object, which C does not let us cast to a function. */
static void find(void *library, const char *name, void *function)
{
    void *symbol = dlsym(library, name);
    if (symbol == NULL) {
        (void)fprintf(stderr, "%s is missing\n", name);
        exit(EXIT_FAILURE);
    }
    memcpy(function, &symbol, sizeof symbol);
}

static void open_other(const char *path)
{
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (library == NULL) {
        (void)fprintf(stderr, "%s\n", dlerror());
        exit(EXIT_FAILURE);
    }
    find(library, "IPC_initialize", &other.initialize);
    find(library, "IPC_parseFormat", &other.parse_format);
    find(library, "IPC_marshall", &other.marshall);
    find(library, "IPC_unmarshall", &other.unmarshall);
    find(library, "IPC_freeData", &other.free_data);
    (void)other.initialize();
}

static void run_other_encode(const struct measured *m)
{
    struct other_bytes bytes;
    (void)other.marshall(m->formatter, m->subject->value, &bytes);
    sink = bytes.content;
    free(sink);
}

static void run_other_decode(const struct measured *m)
{
    void *value;
    (void)other.unmarshall(m->formatter, m->content, &value);
    (void)other.free_data(m->formatter, value);
}

static void measure(const struct subject *subject)
{
    static const run_function functions[MOST_FUNCTIONS] = {
        run_encode,         run_encode_by_hand, run_decode,      run_decode_by_hand,
        run_encode_foreign, run_other_encode,   run_other_decode};
    struct measured m = {.subject = subject};
    double times[MOST_FUNCTIONS];
    struct format *format;
    struct buffer out;
    buffer_init(&out);
    if (format_parse(subject->format, NULL, &format, NULL) != 0 ||
        format_encode(format, subject->value, byte_order_of_host(), &out) != 0) {
        abort();
    }
    m.format = format;
    m.content = out.bytes;
    m.length = out.length;
    if (other.initialize != NULL) {
        m.formatter = other.parse_format(subject->format);
    }
    least_times(&m, functions, m.formatter == NULL ? 5 : 7, times);
    (void)printf("%-13s %7zu | %8.1f %8.1f %5.2f | %8.1f %8.1f %5.2f | %8.1f", subject->name,
                 out.length, times[0], times[1], times[0] / times[1], times[2], times[3],
                 times[2] / times[3], times[4]);
    if (m.formatter != NULL) {
        (void)printf(" | %8.1f %5.1f %8.1f %5.1f", times[5], times[5] / times[0], times[6],
                     times[6] / times[2]);
    }
    (void)printf("\n");
    (void)fflush(stdout);
    format_unref(format);
    buffer_fini(&out);
}

int main(int n_arguments, char **arguments)
{
    const struct subject subjects[] = {
        {"pose", "{int,int,double,double,double,float,float}", zeroed(sizeof(struct pose)),
         encode_pose, decode_pose, free},
        {"record", "{int,double,string}", make_record(), encode_record, decode_record,
         release_record},
        {"doubles", "[double:1000]", zeroed(N_DOUBLES * sizeof(double)), encode_doubles,
         decode_doubles, free},
        {"many doubles", "{int,<double:1>}", make_many(), encode_many, decode_many,
         release_counted},
        {"1000 records", "{int,<{int,string,double}:1>}", make_items(), encode_items, decode_items,
         release_items},
        {"list of 1000", "{int,double,*!}", make_list(), encode_list, decode_list, release_list},
        {"mixed", "{string,[double:4,4],[{int,int}:3],{short,char,double}}", make_mixed(),
         encode_mixed, decode_mixed, release_mixed},
        {"laser scan", "{double,int,<float:2>,string}", make_scan(), encode_scan, decode_scan,
         release_scan},
        {"image", "{int,int,<ubyte:1,2>}", make_image(), encode_image, decode_image, release_image},
    };
    if (n_arguments > 1) {
        open_other(arguments[1]);
    }
    (void)printf("%-13s %7s | %8s %8s %5s | %8s %8s %5s | %8s%s\n", "ns", "bytes", "encode", "hand",
                 "ratio", "decode", "hand", "ratio", "swapped",
                 n_arguments > 1 ? " |   theirs times   theirs times" : "");
    for (size_t i = 0; i < sizeof subjects / sizeof *subjects; i++) {
        measure(&subjects[i]);
    }
    return EXIT_SUCCESS;
}
