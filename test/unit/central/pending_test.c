/*
 * The queue of pending deliveries: what the protocol's examples say, and random
 * sequences compared with the simplest queue that there could be.
 */
#include "unit.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "central/model/pending.h"

enum { N_SUBJECTS = 5 };

/* A waiting delivery: its subject is a letter, its number tells it from others. */
struct delivery {
    char letter;
    int number;
    struct pending_item item;
};

struct fixture {
    struct pending_pool pool;
    struct pending queue;
    struct pending_subject subjects[N_SUBJECTS];
    char letters[N_SUBJECTS + 1];
};

static void set_up(struct fixture *fixture, const char *letters)
{
    memset(fixture, 0, sizeof *fixture);
    pending_pool_init(&fixture->pool);
    pending_init(&fixture->queue, &fixture->pool);
    (void)snprintf(fixture->letters, sizeof fixture->letters, "%s", letters);
    for (uint32_t i = 0; i < N_SUBJECTS; i++) {
        pending_subject_init(&fixture->subjects[i], i);
    }
}

static struct pending_subject *subject(struct fixture *fixture, char letter)
{
    return &fixture->subjects[strchr(fixture->letters, letter) - fixture->letters];
}

static struct delivery *delivery_of(struct pending_item *item)
{
    return item == NULL ? NULL : LIST_OWNER(item, struct delivery, item);
}

/* Adds a delivery; returns the one that had to leave, or NULL. */
static struct delivery *add(struct fixture *fixture, char letter, int number)
{
    struct delivery *delivery = mem_new(sizeof *delivery);
    delivery->letter = letter;
    delivery->number = number;
    pending_item_init(&delivery->item);
    return delivery_of(pending_add(&fixture->queue, subject(fixture, letter), &delivery->item, 10));
}

/* Adds what a text like "A0 B1" says, freeing what has to leave. */
static void add_all(struct fixture *fixture, const char *text)
{
    for (; *text != '\0'; text += text[2] == '\0' ? 2 : 3) {
        free(add(fixture, text[0], text[1] - '0'));
    }
}

/* Takes everything and checks that it comes as the text says. */
static void assert_leave(struct fixture *fixture, const char *expected)
{
    char found[200] = "";
    struct delivery *delivery;
    while ((delivery = delivery_of(pending_take(&fixture->queue))) != NULL) {
        (void)snprintf(found + strlen(found), sizeof found - strlen(found), "%s%c%d",
                       found[0] == '\0' ? "" : " ", delivery->letter, delivery->number);
        free(delivery);
    }
    assert_string_equal(found, expected);
    assert_int_equal(fixture->queue.count, 0);
    assert_int_equal(fixture->queue.bytes, 0);
}

static void tear_down(struct fixture *fixture)
{
    pending_fini(&fixture->queue);
    pending_pool_fini(&fixture->pool);
}

/* ------------------------------------------------------------------- examples */

static void deliveries_leave_in_order_of_arrival(void **state)
{
    struct fixture fixture;
    (void)state;
    set_up(&fixture, "AB");
    add_all(&fixture, "A0 B1 A2 B3");
    assert_leave(&fixture, "A0 B1 A2 B3");
    tear_down(&fixture);
}

static void a_limit_drops_the_oldest_and_keeps_the_turn(void **state)
{
    struct fixture fixture;
    (void)state;
    set_up(&fixture, "LM");
    assert_int_equal(pending_set_limit(&fixture.queue, subject(&fixture, 'L'), 2), NO_LIMIT);
    add_all(&fixture, "L1 M2 L3 M4 L5");
    assert_leave(&fixture, "L3 M2 L5 M4");
    add_all(&fixture, "L1 M2 L3 M4 L5 L6");
    assert_leave(&fixture, "L5 M2 L6 M4");
    tear_down(&fixture);
}

static void the_first_observed_sequence(void **state)
{
    struct fixture fixture;
    (void)state;
    set_up(&fixture, "M");
    pending_set_limit(&fixture.queue, subject(&fixture, 'M'), 3);
    add_all(&fixture, "M2 M3 M4 M5 M6 M7 M8"); /* M1 was sent at once */
    assert_leave(&fixture, "M6 M7 M8");
    tear_down(&fixture);
}

static void the_second_observed_sequence(void **state)
{
    struct fixture fixture;
    (void)state;
    set_up(&fixture, "NLH");
    pending_subject_set_priority(subject(&fixture, 'L'), 1);
    pending_subject_set_priority(subject(&fixture, 'H'), 9);
    add_all(&fixture, "N1 L2 H3 N4 L5 H6"); /* N0 was sent at once */
    assert_leave(&fixture, "H3 H6 L2 L5 N1 N4");
    tear_down(&fixture);
}

static void the_third_observed_sequence(void **state)
{
    struct fixture fixture;
    (void)state;
    set_up(&fixture, "ABC");
    pending_subject_set_priority(subject(&fixture, 'B'), 0);
    add_all(&fixture, "A1 B2 C3 B4"); /* A0 was sent at once */
    assert_leave(&fixture, "B2 B4 A1 C3");
    tear_down(&fixture);
}

static void a_limit_of_the_whole_queue_drops_the_oldest_of_all(void **state)
{
    struct fixture fixture;
    (void)state;
    set_up(&fixture, "AB");
    fixture.queue.limit = 2;
    add_all(&fixture, "A1 B2 A3 B4");
    assert_leave(&fixture, "A3 B4");
    tear_down(&fixture);
}

static void a_limit_of_0_lets_nothing_wait(void **state)
{
    struct fixture fixture;
    (void)state;
    set_up(&fixture, "AB");
    pending_set_limit(&fixture.queue, subject(&fixture, 'A'), 0);
    struct delivery *refused = add(&fixture, 'A', 1);
    assert_non_null(refused);
    assert_int_equal(refused->number, 1);
    assert_null(refused->item.flow);
    free(refused);
    add_all(&fixture, "B2");
    assert_leave(&fixture, "B2");
    tear_down(&fixture);
}

static void setting_a_priority_moves_nothing_but_counts_from_then_on(void **state)
{
    struct fixture fixture;
    (void)state;
    set_up(&fixture, "AB");
    add_all(&fixture, "A0 A1");
    pending_subject_set_priority(subject(&fixture, 'A'), 5);
    pending_subject_set_priority(subject(&fixture, 'B'), 3);
    add_all(&fixture, "B2 A3 B4");
    assert_leave(&fixture, "A0 A1 A3 B2 B4");
    tear_down(&fixture);
}

static void priorities_hold_in_every_queue_of_a_subject(void **state)
{
    struct fixture fixture;
    struct pending second;
    (void)state;
    set_up(&fixture, "AB");
    pending_init(&second, &fixture.pool);
    add_all(&fixture, "A0");
    struct delivery *elsewhere = mem_new(sizeof *elsewhere);
    pending_item_init(&elsewhere->item);
    assert_null(pending_add(&second, subject(&fixture, 'A'), &elsewhere->item, 1));
    pending_subject_set_priority(subject(&fixture, 'B'), 1);
    add_all(&fixture, "B1");
    assert_leave(&fixture, "B1 A0");
    assert_ptr_equal(delivery_of(pending_take(&second)), elsewhere);
    free(elsewhere);
    pending_fini(&second);
    tear_down(&fixture);
}

static void the_oldest_takes_its_first_place_along_even_if_a_priority_was_raised(void **state)
{
    struct fixture fixture;
    (void)state;
    set_up(&fixture, "AB");
    add_all(&fixture, "A0 B1");
    pending_subject_set_priority(subject(&fixture, 'A'), 5);
    add_all(&fixture, "A2 B3 A4"); /* A A B A B: their turns now */
    free(delivery_of(pending_take_oldest(&fixture.queue)));
    assert_leave(&fixture, "A2 A4 B1 B3");
    tear_down(&fixture);
}

static void any_delivery_can_be_taken_out(void **state)
{
    struct fixture fixture;
    (void)state;
    set_up(&fixture, "AB");
    add_all(&fixture, "A0 B1 A2 A3");
    struct delivery *first =
        delivery_of(LIST_OWNER(fixture.queue.by_age.next, struct pending_item, by_age));
    pending_remove(&first->item);
    free(first);
    struct delivery *last =
        delivery_of(LIST_OWNER(fixture.queue.by_age.previous, struct pending_item, by_age));
    pending_remove(&last->item);
    free(last);
    assert_int_equal(pending_count_of(&fixture.queue, subject(&fixture, 'A')), 1);
    assert_leave(&fixture, "B1 A2");
    tear_down(&fixture);
}

/* --------------------------------------------------------- comparison with a model */

/* The model: an array of letters in the order of their turns, and per letter the numbers that wait.
 */
enum { MODEL_ROOM = 4096 };

struct model {
    char turns[MODEL_ROOM];
    size_t n_turns;
    int numbers[N_SUBJECTS][MODEL_ROOM];
    size_t n_numbers[N_SUBJECTS];
    int priorities[N_SUBJECTS];
    int limits[N_SUBJECTS];
};

static size_t index_of(char letter)
{
    return (size_t)(letter - 'A');
}

static void model_insert(struct model *model, size_t at, char letter)
{
    memmove(model->turns + at + 1, model->turns + at, model->n_turns - at);
    model->turns[at] = letter;
    model->n_turns++;
}

static int model_shift(struct model *model, char letter)
{
    const size_t i = index_of(letter);
    const int number = model->numbers[i][0];
    model->n_numbers[i]--;
    memmove(model->numbers[i], model->numbers[i] + 1, model->n_numbers[i] * sizeof(int));
    return number;
}

static size_t model_place(const struct model *model, char letter)
{
    const int priority = model->priorities[index_of(letter)];
    size_t at = priority < 0 ? model->n_turns : 0;
    while (at < model->n_turns && model->priorities[index_of(model->turns[at])] >= priority) {
        at++;
    }
    return at;
}

/* The number of the delivery that had to leave, -1: none. */
static int model_add(struct model *model, char letter, int number)
{
    const size_t i = index_of(letter);
    int dropped = -1;
    if (model->limits[i] == 0) {
        return number;
    }
    if (model->limits[i] > 0 && model->n_numbers[i] >= (size_t)model->limits[i]) {
        dropped = model_shift(model, letter);
    } else {
        model_insert(model, model_place(model, letter), letter);
    }
    model->numbers[i][model->n_numbers[i]++] = number;
    return dropped;
}

static int model_take(struct model *model, char *letter)
{
    *letter = model->turns[0];
    model->n_turns--;
    memmove(model->turns, model->turns + 1, model->n_turns);
    return model_shift(model, *letter);
}

static uint32_t next_random(uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return *seed >> 8;
}

static void compare_add(struct fixture *fixture, struct model *model, char letter, int number)
{
    struct delivery *dropped = add(fixture, letter, number);
    const int expected = model_add(model, letter, number);
    assert_int_equal(dropped == NULL ? -1 : dropped->number, expected);
    free(dropped);
}

static void compare_take(struct fixture *fixture, struct model *model)
{
    struct delivery *taken = delivery_of(pending_take(&fixture->queue));
    if (model->n_turns == 0) {
        assert_null(taken);
        return;
    }
    char letter;
    const int number = model_take(model, &letter);
    assert_non_null(taken);
    assert_int_equal(taken->letter, letter);
    assert_int_equal(taken->number, number);
    free(taken);
}

static void step(struct fixture *fixture, struct model *model, uint32_t *seed, int number)
{
    const char letter = (char)('A' + (int)(next_random(seed) % N_SUBJECTS));
    const uint32_t choice = next_random(seed) % 100;
    if (choice < 50 && model->n_turns < MODEL_ROOM - 1) {
        compare_add(fixture, model, letter, number);
    } else if (choice < 97) {
        compare_take(fixture, model);
    } else if (choice < 98) {
        model->priorities[index_of(letter)] = (int)(next_random(seed) % 4) - 1;
        pending_subject_set_priority(subject(fixture, letter), model->priorities[index_of(letter)]);
    } else {
        const int limit = (int)(next_random(seed) % 12) - 1;
        assert_int_equal(pending_set_limit(&fixture->queue, subject(fixture, letter), limit),
                         model->limits[index_of(letter)]);
        model->limits[index_of(letter)] = limit;
    }
    assert_int_equal(fixture->queue.count, model->n_turns);
}

static void random_sequences_behave_as_the_simplest_queue(void **state)
{
    enum { STEPS = 300000 };
    static struct model model;
    struct fixture fixture;
    uint32_t seed = 20260102;
    (void)state;
    set_up(&fixture, "ABCDE");
    memset(&model, 0, sizeof model);
    for (size_t i = 0; i < N_SUBJECTS; i++) {
        model.priorities[i] = NO_PRIORITY;
        model.limits[i] = NO_LIMIT;
    }
    for (int number = 0; number < STEPS; number++) {
        step(&fixture, &model, &seed, number);
    }
    while (model.n_turns > 0) {
        compare_take(&fixture, &model);
    }
    assert_int_equal(fixture.queue.bytes, 0);
    tear_down(&fixture);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(deliveries_leave_in_order_of_arrival),
        cmocka_unit_test(a_limit_drops_the_oldest_and_keeps_the_turn),
        cmocka_unit_test(the_first_observed_sequence),
        cmocka_unit_test(the_second_observed_sequence),
        cmocka_unit_test(the_third_observed_sequence),
        cmocka_unit_test(a_limit_of_the_whole_queue_drops_the_oldest_of_all),
        cmocka_unit_test(a_limit_of_0_lets_nothing_wait),
        cmocka_unit_test(setting_a_priority_moves_nothing_but_counts_from_then_on),
        cmocka_unit_test(priorities_hold_in_every_queue_of_a_subject),
        cmocka_unit_test(the_oldest_takes_its_first_place_along_even_if_a_priority_was_raised),
        cmocka_unit_test(any_delivery_can_be_taken_out),
        cmocka_unit_test(random_sequences_behave_as_the_simplest_queue),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
