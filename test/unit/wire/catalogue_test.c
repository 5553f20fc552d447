/*
 * The catalogue: every format compiles to its struct, and payloads survive the wire.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/error.h"
#include "wire/catalogue.h"

static int set_up(void **state)
{
    struct catalogue *catalogue = malloc(sizeof *catalogue);
    *state = catalogue;
    return catalogue_init(catalogue);
}

static int tear_down(void **state)
{
    catalogue_fini(*state);
    free(*state);
    return 0;
}

static void formats_have_the_size_of_their_structs(void **state)
{
    const struct catalogue *catalogue = *state;
    assert_int_equal(format_size(catalogue->request[LM_MESSAGE_INFO]),
                     sizeof(struct message_info_request));
    assert_int_equal(format_size(catalogue->reply[LM_MESSAGE_INFO]),
                     sizeof(struct optional_message_info));
    assert_int_equal(format_size(catalogue->reply[LM_INTRODUCTION]),
                     sizeof(struct introduction_reply));
    assert_int_equal(format_size(catalogue->request[LM_DEFINE_MESSAGE]),
                     sizeof(struct message_definition));
    assert_int_equal(format_size(catalogue->request[LM_SUBSCRIBE]),
                     sizeof(struct subscription_notice));
    assert_int_equal(format_size(catalogue->request[LM_RESOURCE]), sizeof(struct number_and_name));
    assert_int_equal(format_size(catalogue->request[LM_PRIORITY]), sizeof(struct name_and_number));
    assert_int_equal(format_size(catalogue->request[LM_LIMIT_PENDING]),
                     sizeof(struct pending_limit));
    assert_int_equal(format_size(catalogue->reply[LM_HANDLERS]), sizeof(struct handler_list));
    assert_int_equal(format_size(catalogue->reply[LM_DIRECT_INFO]), sizeof(struct handler_address));
    assert_int_equal(format_size(catalogue->reply[LM_MESSAGE_DETAILS]),
                     sizeof(struct message_details));
    assert_int_equal(format_size(catalogue->request[LM_TAP_MESSAGE]), sizeof(struct tap));
    assert_int_equal(format_size(catalogue->name_list), sizeof(struct name_list));
}

static void names_and_aliases_are_found_in_any_case(void **state)
{
    (void)state;
    assert_int_equal(catalogue_find("x_ipc_waitMsg"), LM_READY);
    assert_int_equal(catalogue_find("WAITMSG"), LM_READY);
    assert_int_equal(catalogue_find("x_ipcCloseMsg"), LM_CLOSE);
    assert_int_equal(catalogue_find("ipc_setMsgPriority"), LM_PRIORITY);
    assert_int_equal(catalogue_find("x_ipc_nosuch"), LM_COUNT);
}

static void a_definition_is_encoded_as_captured(void **state)
{
    const struct catalogue *catalogue = *state;
    static const uint8_t captured[] = {2,    0,    0,    0,    0x4d, 0x31, 0x0f, 0,    0,
                                       0,    0x0f, 0,    0,    0,    0x7b, 0x69, 0x6e, 0x74,
                                       0x2c, 0x20, 0x3c, 0x62, 0x79, 0x74, 0x65, 0x3a, 0x31,
                                       0x3e, 0x7d, 3,    0,    0,    0,    0x69, 0x6e, 0x74};
    char name[] = "M1";
    char wire[] = "{int, <byte:1>}";
    char content[] = "int";
    const struct message_definition definition = {name, CLASS_BROADCAST, wire, content};
    struct buffer out;
    if (byte_order_of_host() != ORDER_LITTLE) {
        skip();
    }
    buffer_init(&out);
    assert_int_equal(payload_encode(catalogue->request[LM_DEFINE_MESSAGE], &definition, &out), 0);
    assert_int_equal(out.length, sizeof captured);
    assert_memory_equal(out.bytes, captured, sizeof captured);
    struct message_definition back;
    assert_int_equal(payload_decode(catalogue->request[LM_DEFINE_MESSAGE], captured,
                                    sizeof captured, ORDER_LITTLE, &back),
                     0);
    assert_string_equal(back.name, "M1");
    assert_int_equal(back.class, CLASS_BROADCAST);
    assert_string_equal(back.wire, wire);
    assert_string_equal(back.content, "int");
    assert_int_equal(format_release(catalogue->request[LM_DEFINE_MESSAGE], &back), 0);
    buffer_fini(&out);
}

static void payloads_with_too_many_or_too_few_bytes_are_refused(void **state)
{
    const struct catalogue *catalogue = *state;
    static const uint8_t bytes[] = {1, 0, 0, 0, 'Q', 0};
    char *name = NULL;
    assert_int_equal(payload_decode(catalogue->request[LM_HANDLERS], bytes, 5, ORDER_LITTLE, &name),
                     0);
    assert_string_equal(name, "Q");
    assert_int_equal(format_release(catalogue->request[LM_HANDLERS], &name), 0);
    assert_int_equal(payload_decode(catalogue->request[LM_HANDLERS], bytes, 6, ORDER_LITTLE, &name),
                     ERR_CONTENT);
    assert_null(name);
    assert_int_equal(payload_decode(catalogue->request[LM_HANDLERS], bytes, 4, ORDER_LITTLE, &name),
                     ERR_CONTENT);
    assert_int_equal(payload_decode(NULL, bytes, 1, ORDER_LITTLE, NULL), ERR_CONTENT);
    assert_int_equal(payload_decode(NULL, bytes, 0, ORDER_LITTLE, NULL), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(formats_have_the_size_of_their_structs, set_up, tear_down),
        cmocka_unit_test(names_and_aliases_are_found_in_any_case),
        cmocka_unit_test_setup_teardown(a_definition_is_encoded_as_captured, set_up, tear_down),
        cmocka_unit_test_setup_teardown(payloads_with_too_many_or_too_few_bytes_are_refused, set_up,
                                        tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
