/*
 * Long lists, on a small stack.
 */
#include "unit.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "format/format.h"

enum { N_NODES = 100000, SMALL_STACK = 256 * 1024 };

struct node {
    int number;
    char *name;
    struct node *next;
};

static struct node *make_list(void)
{
    struct node *first = NULL;
    for (int i = N_NODES; i > 0; i--) {
        struct node *node = malloc(sizeof *node);
        node->number = i;
        node->name = malloc(2);
        strcpy(node->name, "n");
        node->next = first;
        first = node;
    }
    return first;
}

static int length_of(const struct node *node)
{
    int length = 0;
    for (; node != NULL; node = node->next) {
        if (node->number != ++length || strcmp(node->name, "n") != 0) {
            return -1;
        }
    }
    return length;
}

/* What was right, so that the test itself can say it on its own stack. */
struct outcome {
    bool measured, encoded, decoded, same, printed, truncated, released;
};

static void run(struct outcome *outcome, const struct format *format)
{
    struct node *list = make_list();
    struct buffer out, page;
    void *decoded;
    size_t length;
    buffer_init(&out);
    buffer_init(&page);
    outcome->measured = format_measure(format, list, &length) == 0;
    outcome->encoded = format_encode(format, list, ORDER_BIG, &out) == 0 && out.length == length &&
                       length == (4 + 4 + 1 + 1) * (size_t)N_NODES;
    struct format_source source = {out.bytes, out.length, ORDER_BIG};
    outcome->decoded = format_decode_new(format, &source, &decoded, NULL) == 0;
    outcome->same = length_of(decoded) == N_NODES;
    outcome->printed = format_print(format, decoded, 0, &page) == 0 && page.length < 500;
    outcome->released = format_release(format, decoded) == 0 && format_release(format, list) == 0;
    free(decoded);
    free(list);
    source.length--;
    outcome->truncated = format_decode_new(format, &source, &decoded, NULL) != 0;
    buffer_fini(&page);
    buffer_fini(&out);
}

struct task {
    struct outcome outcome;
    struct format *format;
};

static void *run_in_thread(void *argument)
{
    struct task *task = argument;
    run(&task->outcome, task->format);
    return NULL;
}

static void a_list_of_any_length_needs_no_stack(void **state)
{
    (void)state;
    struct task task = {.outcome = {false}};
    pthread_t thread;
    pthread_attr_t attributes;
    assert_int_equal(format_parse("{int, string, *!}", NULL, &task.format, NULL), 0);
    assert_int_equal(pthread_attr_init(&attributes), 0);
    assert_int_equal(pthread_attr_setstacksize(&attributes, SMALL_STACK), 0);
    assert_int_equal(pthread_create(&thread, &attributes, run_in_thread, &task), 0);
    assert_int_equal(pthread_join(thread, NULL), 0);
    (void)pthread_attr_destroy(&attributes);
    assert_true(task.outcome.measured);
    assert_true(task.outcome.encoded);
    assert_true(task.outcome.decoded);
    assert_true(task.outcome.same);
    assert_true(task.outcome.printed);
    assert_true(task.outcome.truncated);
    assert_true(task.outcome.released);
    format_unref(task.format);
}

static void lists_in_arrays_and_structures_are_walked_to_their_ends(void **state)
{
    (void)state;
    struct value {
        struct node inner;
        int count;
        struct node *heads;
    };
    struct format *format;
    assert_int_equal(
        format_parse("{{int, string, *!}, int, <{int, string, *!}:2>}", NULL, &format, NULL), 0);
    struct node *lists[3] = {make_list(), make_list(), make_list()};
    struct node heads[2] = {*lists[1], *lists[2]};
    struct value value = {*lists[0], 2, heads};
    struct buffer out;
    struct value *decoded;
    void *block;
    buffer_init(&out);
    assert_int_equal(format_encode(format, &value, ORDER_LITTLE, &out), 0);
    const struct format_source source = {out.bytes, out.length, ORDER_LITTLE};
    assert_int_equal(format_decode_new(format, &source, &block, NULL), 0);
    decoded = block;
    assert_int_equal(length_of(&decoded->inner), N_NODES);
    assert_int_equal(length_of(&decoded->heads[0]), N_NODES);
    assert_int_equal(length_of(&decoded->heads[1]), N_NODES);
    assert_int_equal(format_release(format, decoded), 0);
    free(decoded);
    value.heads = malloc(sizeof heads);
    memcpy(value.heads, heads, sizeof heads);
    assert_int_equal(format_release(format, &value), 0);
    for (int i = 0; i < 3; i++) {
        free(lists[i]);
    }
    buffer_fini(&out);
    format_unref(format);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_list_of_any_length_needs_no_stack),
        cmocka_unit_test(lists_in_arrays_and_structures_are_walked_to_their_ends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
