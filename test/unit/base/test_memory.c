/*
 * Bookkeeping memory and error texts.
 */
#include "unit.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"

static void new_memory_is_zero(void **state)
{
    (void)state;
    unsigned char *block = mem_new(1000);
    for (int i = 0; i < 1000; i++) {
        assert_int_equal(block[i], 0);
    }
    free(block);
}

static void no_bytes_are_a_block_too(void **state)
{
    (void)state;
    void *block = mem_new(0);
    assert_non_null(block);
    block = mem_resize(block, 0, 8);
    assert_non_null(block);
    free(block);
}

static void resizing_keeps_the_content(void **state)
{
    (void)state;
    int *numbers = mem_resize(NULL, 4, sizeof *numbers);
    for (int i = 0; i < 4; i++) {
        numbers[i] = i;
    }
    numbers = mem_resize(numbers, 4000, sizeof *numbers);
    for (int i = 0; i < 4; i++) {
        assert_int_equal(numbers[i], i);
    }
    free(numbers);
}

static void text_is_copied_with_its_end(void **state)
{
    (void)state;
    assert_null(mem_copy_string(NULL));
    char *copy = mem_copy_string("module");
    assert_string_equal(copy, "module");
    free(copy);
    copy = mem_copy_text("module", 3);
    assert_string_equal(copy, "mod");
    free(copy);
    copy = mem_copy_text(NULL, 0);
    assert_string_equal(copy, "");
    free(copy);
}

static void every_error_has_a_text_of_its_own(void **state)
{
    (void)state;
    for (int a = ERR_REFUSED; a <= ERR_NONE; a++) {
        assert_true(strlen(error_text(a)) > 0);
        assert_string_not_equal(error_text(a), error_text(1));
        for (int b = a + 1; b <= ERR_NONE; b++) {
            assert_string_not_equal(error_text(a), error_text(b));
        }
    }
    assert_string_equal(error_text(-1000), error_text(1));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(new_memory_is_zero),
        cmocka_unit_test(no_bytes_are_a_block_too),
        cmocka_unit_test(resizing_keeps_the_content),
        cmocka_unit_test(text_is_copied_with_its_end),
        cmocka_unit_test(every_error_has_a_text_of_its_own),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
