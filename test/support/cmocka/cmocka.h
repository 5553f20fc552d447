/*
 * The part of cmocka that the unit tests use, for machines that Debian has no cmocka for: the
 * build takes it with IPC_OWN_CMOCKA=ON.  Same names, same meaning.
 *
 * A test ends where the first assertion fails; its teardown is run.  Assertions evaluate their
 * arguments once.
 */
#ifndef TEST_SUPPORT_CMOCKA_H
#define TEST_SUPPORT_CMOCKA_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct CMUnitTest {
    const char *name;
    void (*run)(void **state);
    int (*setup)(void **state);
    int (*teardown)(void **state);
};

#define cmocka_unit_test_setup_teardown(test, setup, teardown) {#test, test, setup, teardown}
#define cmocka_unit_test(test) cmocka_unit_test_setup_teardown(test, NULL, NULL)

/* Runs the tests of an array, and says how many have failed. */
#define cmocka_run_group_tests(tests, setup, teardown)                                             \
    own_cmocka_run(tests, sizeof(tests) / sizeof *(tests), setup, teardown)

#define assert_true(truth) own_cmocka_check(!!(truth), __FILE__, __LINE__, #truth)
#define assert_false(truth) own_cmocka_check(!(truth), __FILE__, __LINE__, "not " #truth)
#define assert_null(pointer) own_cmocka_check((pointer) == NULL, __FILE__, __LINE__, #pointer)
#define assert_non_null(pointer) own_cmocka_check((pointer) != NULL, __FILE__, __LINE__, #pointer)
#define assert_ptr_equal(one, other)                                                               \
    own_cmocka_check((const void *)(one) == (const void *)(other), __FILE__, __LINE__,             \
                     #one " == " #other)
#define assert_ptr_not_equal(one, other)                                                           \
    own_cmocka_check((const void *)(one) != (const void *)(other), __FILE__, __LINE__,             \
                     #one " != " #other)
#define assert_int_equal(one, other)                                                               \
    own_cmocka_compare((uintmax_t)(one), (uintmax_t)(other), true, __FILE__, __LINE__,             \
                       #one " == " #other)
#define assert_int_not_equal(one, other)                                                           \
    own_cmocka_compare((uintmax_t)(one), (uintmax_t)(other), false, __FILE__, __LINE__,            \
                       #one " != " #other)
#define assert_string_equal(one, other)                                                            \
    own_cmocka_compare_strings((const char *)(one), (const char *)(other), true, __FILE__,         \
                               __LINE__, #one " == " #other)
#define assert_string_not_equal(one, other)                                                        \
    own_cmocka_compare_strings((const char *)(one), (const char *)(other), false, __FILE__,        \
                               __LINE__, #one " != " #other)
#define assert_memory_equal(one, other, size)                                                      \
    own_cmocka_compare_memory(one, other, size, __FILE__, __LINE__, #one " == " #other)

#define fail() own_cmocka_check(false, __FILE__, __LINE__, "fail()")
#define fail_msg(...) own_cmocka_fail(__FILE__, __LINE__, __VA_ARGS__)
#define skip() own_cmocka_skip()

int own_cmocka_run(const struct CMUnitTest *tests, size_t n_tests, int (*setup)(void **state),
                   int (*teardown)(void **state));
void own_cmocka_check(bool truth, const char *file, int line, const char *what);
void own_cmocka_compare(uintmax_t one, uintmax_t other, bool equal, const char *file, int line,
                        const char *what);
void own_cmocka_compare_strings(const char *one, const char *other, bool equal, const char *file,
                                int line, const char *what);
void own_cmocka_compare_memory(const void *one, const void *other, size_t size, const char *file,
                               int line, const char *what);
void own_cmocka_fail(const char *file, int line, const char *form, ...);
void own_cmocka_skip(void);

#endif
