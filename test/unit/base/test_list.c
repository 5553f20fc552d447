/*
 * Intrusive lists.
 */
#include "unit.h"

#include "base/list.h"

struct item {
    int number;
    struct list link;
};

/* The numbers in the list as one decimal number, first one leading. */
static int digits(const struct list *head)
{
    int result = 0;
    for (struct list *at = head->next; at != head; at = at->next) {
        result = result * 10 + LIST_OWNER(at, struct item, link)->number;
    }
    return result;
}

static void links_keep_the_order_in_which_they_are_inserted(void **state)
{
    (void)state;
    struct list head;
    struct item items[4] = {{.number = 1}, {.number = 2}, {.number = 3}, {.number = 4}};
    list_init(&head);
    assert_true(list_is_empty(&head));
    list_append(&head, &items[1].link);
    list_append(&head, &items[3].link);
    list_prepend(&head, &items[0].link);
    list_insert(&items[3].link, &items[2].link);
    assert_false(list_is_empty(&head));
    assert_int_equal(digits(&head), 1234);
}

static void a_link_may_leave_twice(void **state)
{
    (void)state;
    struct list head;
    struct item items[3] = {{.number = 1}, {.number = 2}, {.number = 3}};
    list_init(&head);
    for (int i = 0; i < 3; i++) {
        list_append(&head, &items[i].link);
    }
    list_remove(&items[1].link);
    list_remove(&items[1].link);
    assert_int_equal(digits(&head), 13);
    assert_true(list_is_empty(&items[1].link));
}

static void the_visited_link_may_leave(void **state)
{
    (void)state;
    struct list head, *at, *following;
    struct item items[4] = {{.number = 1}, {.number = 2}, {.number = 3}, {.number = 4}};
    list_init(&head);
    for (int i = 0; i < 4; i++) {
        list_append(&head, &items[i].link);
    }
    int visited = 0;
    LIST_EACH (at, following, &head) {
        visited++;
        if (LIST_OWNER(at, struct item, link)->number % 2 == 0) {
            list_remove(at);
        }
    }
    assert_int_equal(visited, 4);
    assert_int_equal(digits(&head), 13);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(links_keep_the_order_in_which_they_are_inserted),
        cmocka_unit_test(a_link_may_leave_twice),
        cmocka_unit_test(the_visited_link_may_leave),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
