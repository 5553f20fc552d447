/*
 * Reference-counted bytes.  That the last reference frees is checked by the
 * leak detector the tests are run under.
 */
#include "unit.h"

#include <stdlib.h>
#include <string.h>

#include "base/block.h"

static void a_new_block_has_one_reference_and_its_length(void **state)
{
    (void)state;
    struct block *block = block_new(100);
    assert_non_null(block);
    assert_int_equal(block->references, 1);
    assert_int_equal(block->length, 100);
    memset(block->bytes, 1, 100);
    block_unref(block);
}

static void a_copy_is_independent_of_its_source(void **state)
{
    (void)state;
    char source[] = "hello";
    struct block *block = block_copy(source, 5);
    assert_non_null(block);
    source[0] = 'j';
    assert_int_equal(block->length, 5);
    assert_memory_equal(block->bytes, "hello", 5);
    block_unref(block);
}

static void a_block_may_be_empty(void **state)
{
    (void)state;
    struct block *block = block_copy(NULL, 0);
    assert_non_null(block);
    assert_int_equal(block->length, 0);
    block_unref(block);
    block_unref(NULL);
}

static void an_adopted_block_keeps_the_address(void **state)
{
    (void)state;
    uint8_t *bytes = malloc(3);
    assert_non_null(bytes);
    memcpy(bytes, "abc", 3);
    struct block *block = block_adopt(bytes, 3);
    assert_non_null(block);
    assert_ptr_equal(block->bytes, bytes);
    block_unref(block);
}

static void bytes_of_an_adopted_block_can_be_taken_by_its_only_owner(void **state)
{
    (void)state;
    uint8_t *bytes = malloc(3);
    assert_non_null(bytes);
    struct block *block = block_adopt(bytes, 3);
    assert_non_null(block);
    block_ref(block);
    assert_null(block_take(block));
    block_unref(block);
    assert_ptr_equal(block_take(block), bytes);
    assert_null(block->bytes);
    assert_int_equal(block->length, 0);
    block_unref(block);
    free(bytes);
    block = block_copy("abc", 3);
    assert_null(block_take(block));
    assert_memory_equal(block->bytes, "abc", 3);
    block_unref(block);
}

static void only_the_last_reference_frees(void **state)
{
    (void)state;
    struct block *block = block_copy("abc", 3);
    assert_ptr_equal(block_ref(block), block);
    assert_int_equal(block->references, 2);
    block_unref(block);
    assert_memory_equal(block->bytes, "abc", 3);
    assert_int_equal(block->references, 1);
    block_unref(block);
}

static void an_impossible_length_gives_null(void **state)
{
    (void)state;
    assert_null(block_new(SIZE_MAX));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_new_block_has_one_reference_and_its_length),
        cmocka_unit_test(a_copy_is_independent_of_its_source),
        cmocka_unit_test(a_block_may_be_empty),
        cmocka_unit_test(an_adopted_block_keeps_the_address),
        cmocka_unit_test(bytes_of_an_adopted_block_can_be_taken_by_its_only_owner),
        cmocka_unit_test(only_the_last_reference_frees),
        cmocka_unit_test(an_impossible_length_gives_null),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
