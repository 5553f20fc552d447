/*
 * Tables from names to things.
 */
#include "unit.h"

#include <stdio.h>
#include <string.h>

#include "base/table.h"

static int things[5000];

static void an_empty_table_holds_nothing(void **state)
{
    (void)state;
    struct table table;
    table_init(&table, TABLE_EXACT);
    assert_null(table_find(&table, "a"));
    assert_null(table_remove(&table, "a"));
    assert_null(table_first(&table));
    table_fini(&table);
}

static void what_was_put_is_found(void **state)
{
    (void)state;
    struct table table;
    table_init(&table, TABLE_EXACT);
    char name[16];
    for (size_t i = 0; i < N_ELEMENTS(things); i++) {
        (void)snprintf(name, sizeof name, "name%zu", i);
        assert_null(table_put(&table, name, &things[i]));
    }
    assert_int_equal(table.count, N_ELEMENTS(things));
    for (size_t i = 0; i < N_ELEMENTS(things); i++) {
        (void)snprintf(name, sizeof name, "name%zu", i);
        assert_ptr_equal(table_find(&table, name), &things[i]);
    }
    assert_null(table_find(&table, "name"));
    assert_null(table_find(&table, "name5000"));
    table_fini(&table);
}

static void a_table_copies_its_names(void **state)
{
    (void)state;
    struct table table;
    table_init(&table, TABLE_EXACT);
    char name[] = "first";
    (void)table_put(&table, name, &things[0]);
    strcpy(name, "other");
    assert_ptr_equal(table_find(&table, "first"), &things[0]);
    assert_null(table_find(&table, "other"));
    table_fini(&table);
}

static void putting_again_replaces_and_keeps_place_and_spelling(void **state)
{
    (void)state;
    struct table table;
    table_init(&table, TABLE_FOLDING);
    (void)table_put(&table, "Alpha", &things[0]);
    (void)table_put(&table, "beta", &things[1]);
    assert_ptr_equal(table_put(&table, "ALPHA", &things[2]), &things[0]);
    assert_int_equal(table.count, 2);
    assert_string_equal(table_first(&table)->name, "Alpha");
    assert_ptr_equal(table_first(&table)->value, &things[2]);
    table_fini(&table);
}

static void a_folding_table_ignores_the_case_of_letters_only(void **state)
{
    (void)state;
    struct table table;
    table_init(&table, TABLE_FOLDING);
    (void)table_put(&table, "Robot[1]", &things[0]);
    assert_ptr_equal(table_find(&table, "rOBOT[1]"), &things[0]);
    assert_null(table_find(&table, "robot{1}")); /* '{' is '[' with the bit of the case set */
    table_fini(&table);
    assert_true(table_same_name(TABLE_FOLDING, "aZ", "Az"));
    assert_false(table_same_name(TABLE_FOLDING, "@", "`"));
    assert_false(table_same_name(TABLE_FOLDING, "ab", "abc"));
}

static void an_exact_table_heeds_the_case(void **state)
{
    (void)state;
    struct table table;
    table_init(&table, TABLE_EXACT);
    (void)table_put(&table, "point", &things[0]);
    assert_null(table_find(&table, "Point"));
    table_fini(&table);
    assert_false(table_same_name(TABLE_EXACT, "a", "A"));
    assert_true(table_same_name(TABLE_EXACT, "a", "a"));
}

static void a_piece_of_text_can_be_looked_up(void **state)
{
    (void)state;
    struct table table;
    table_init(&table, TABLE_EXACT);
    (void)table_put(&table, "int", &things[0]);
    assert_ptr_equal(table_find_text(&table, "integer", 3), &things[0]);
    assert_null(table_find_text(&table, "integer", 4));
    table_fini(&table);
}

static void entries_come_in_order_of_insertion(void **state)
{
    (void)state;
    static const char *const names[] = {"zebra", "ant", "mole", "bee"};
    struct table table;
    table_init(&table, TABLE_EXACT);
    for (size_t i = 0; i < N_ELEMENTS(names); i++) {
        (void)table_put(&table, names[i], &things[i]);
    }
    assert_ptr_equal(table_remove(&table, "ant"), &things[1]);
    (void)table_put(&table, "ant", &things[1]);
    static const char *const expected[] = {"zebra", "mole", "bee", "ant"};
    size_t n = 0;
    for (struct table_entry *e = table_first(&table); e != NULL; e = table_next(&table, e)) {
        assert_string_equal(e->name, expected[n++]);
    }
    assert_int_equal(n, 4);
    table_fini(&table);
}

static void removed_names_are_gone_and_others_stay(void **state)
{
    (void)state;
    struct table table;
    table_init(&table, TABLE_EXACT);
    char name[16];
    for (size_t i = 0; i < N_ELEMENTS(things); i++) {
        (void)snprintf(name, sizeof name, "%zu", i);
        (void)table_put(&table, name, &things[i]);
    }
    for (size_t i = 0; i < N_ELEMENTS(things); i += 2) {
        (void)snprintf(name, sizeof name, "%zu", i);
        assert_ptr_equal(table_remove(&table, name), &things[i]);
        assert_null(table_remove(&table, name));
    }
    for (size_t i = 0; i < N_ELEMENTS(things); i++) {
        (void)snprintf(name, sizeof name, "%zu", i);
        assert_ptr_equal(table_find(&table, name), i % 2 == 0 ? NULL : (void *)&things[i]);
    }
    assert_int_equal(table.count, N_ELEMENTS(things) / 2);
    table_fini(&table);
}

static void the_empty_name_is_a_name(void **state)
{
    (void)state;
    struct table table;
    table_init(&table, TABLE_EXACT);
    (void)table_put(&table, "", &things[0]);
    assert_ptr_equal(table_find(&table, ""), &things[0]);
    assert_ptr_equal(table_remove(&table, ""), &things[0]);
    table_fini(&table);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_empty_table_holds_nothing),
        cmocka_unit_test(what_was_put_is_found),
        cmocka_unit_test(a_table_copies_its_names),
        cmocka_unit_test(putting_again_replaces_and_keeps_place_and_spelling),
        cmocka_unit_test(a_folding_table_ignores_the_case_of_letters_only),
        cmocka_unit_test(an_exact_table_heeds_the_case),
        cmocka_unit_test(a_piece_of_text_can_be_looked_up),
        cmocka_unit_test(entries_come_in_order_of_insertion),
        cmocka_unit_test(removed_names_are_gone_and_others_stay),
        cmocka_unit_test(the_empty_name_is_a_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
