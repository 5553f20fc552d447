/*
 * CENTRALHOST: which host and port, and whether the Unix socket comes first.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "libipc/address.h"

static void assert_address(const char *text, const char *host, int port, bool local)
{
    struct address address;
    assert_int_equal(address_parse(text, &address), 0);
    assert_string_equal(address.host, host);
    assert_int_equal(address.port, port);
    assert_int_equal(address.local, local);
}

static void host_and_port_are_split_at_the_first_colon(void **state)
{
    (void)state;
    assert_address("localhost", "localhost", 1381, false);
    assert_address("localhost:21001", "localhost", 21001, false);
    assert_address("127.0.0.1:21001", "127.0.0.1", 21001, false);
    assert_address("7up:21001", "7up", 21001, false);
    assert_address("[::1]:21001", "::1", 21001, false);
    assert_address("localhost:abc", "localhost", 0, false);
}

static void texts_without_a_host_are_refused(void **state)
{
    struct address address;
    char long_name[400];
    (void)state;
    memset(long_name, 'x', sizeof long_name - 1);
    long_name[sizeof long_name - 1] = '\0';
    assert_int_equal(address_parse("", &address), ERR_UNKNOWN);
    assert_int_equal(address_parse(":21001", &address), ERR_UNKNOWN);
    assert_int_equal(address_parse(" localhost", &address), ERR_UNKNOWN);
    assert_int_equal(address_parse(long_name, &address), ERR_UNKNOWN);
}

static void the_own_host_name_means_the_unix_socket_first(void **state)
{
    char own[33];
    char text[64];
    (void)state;
    net_host_name(own, sizeof own);
    assert_address(own, own, 1381, true);
    snprintf(text, sizeof text, "%s:21001", own);
    assert_address(text, own, 21001, true);
    char other[40];
    snprintf(other, sizeof other, "%sx", own);
    assert_address(other, other, 1381, false);
    if (own[0] >= 'a' && own[0] <= 'z') {
        char upper[33];
        memcpy(upper, own, sizeof upper);
        upper[0] = (char)(upper[0] - 'a' + 'A');
        assert_address(upper, upper, 1381, false); /* this comparison is exact */
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(host_and_port_are_split_at_the_first_colon),
        cmocka_unit_test(texts_without_a_host_are_refused),
        cmocka_unit_test(the_own_host_name_means_the_unix_socket_first),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
