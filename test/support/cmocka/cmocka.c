/*
 * Runs the tests of one program after each other; see cmocka.h.
 */
#include "cmocka.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum end { PASSED, FAILED, SKIPPED };

/* Where a test that fails or does not apply goes; assertions have no other way to it. */
static jmp_buf way_out;

int own_cmocka_run(const struct CMUnitTest *tests, size_t n_tests, int (*setup)(void **state),
                   int (*teardown)(void **state))
{
    static const char *const names[] = {"      OK", "  FAILED", " SKIPPED"};
    void *group_state = NULL;
    unsigned counts[3] = {0, 0, 0};

    if (setup != NULL && setup(&group_state) != 0) {
        printf("[  FAILED  ] setup of all tests\n");
        return 1;
    }
    for (size_t i = 0; i < n_tests; i++) {
        void *state = group_state;
        enum end end = FAILED;
        if (tests[i].setup == NULL || tests[i].setup(&state) == 0) {
            end = (enum end)setjmp(way_out);
            if (end == PASSED) {
                tests[i].run(&state);
            }
            if (tests[i].teardown != NULL && tests[i].teardown(&state) != 0) {
                end = FAILED;
            }
        }
        printf("[ %s ] %s\n", names[end], tests[i].name);
        counts[end]++;
    }
    if (teardown != NULL && teardown(&group_state) != 0) {
        counts[FAILED]++;
    }
    printf("%u passed, %u failed, %u skipped\n", counts[PASSED], counts[FAILED], counts[SKIPPED]);
    return (int)counts[FAILED];
}

void own_cmocka_check(bool truth, const char *file, int line, const char *what)
{
    if (!truth) {
        own_cmocka_fail(file, line, "%s", what);
    }
}

void own_cmocka_compare(uintmax_t one, uintmax_t other, bool equal, const char *file, int line,
                        const char *what)
{
    if ((one == other) != equal) {
        own_cmocka_fail(file, line, "%s: %#jx, %#jx", what, one, other);
    }
}

void own_cmocka_compare_strings(const char *one, const char *other, bool equal, const char *file,
                                int line, const char *what)
{
    if ((strcmp(one, other) == 0) != equal) {
        own_cmocka_fail(file, line, "%s: \"%s\", \"%s\"", what, one, other);
    }
}

void own_cmocka_compare_memory(const void *one, const void *other, size_t size, const char *file,
                               int line, const char *what)
{
    const unsigned char *a = one;
    const unsigned char *b = other;
    for (size_t i = 0; i < size; i++) {
        if (a[i] != b[i]) {
            own_cmocka_fail(file, line, "%s: byte %zu of %zu is %#x, %#x", what, i, size,
                            (unsigned)a[i], (unsigned)b[i]);
        }
    }
}

void own_cmocka_fail(const char *file, int line, const char *form, ...)
{
    va_list rest;
    printf("%s:%d: ", file, line);
    va_start(rest, form);
    vprintf(form, rest);
    va_end(rest);
    putchar('\n');
    longjmp(way_out, FAILED);
}

void own_cmocka_skip(void)
{
    longjmp(way_out, SKIPPED);
}
