/*
 * Definitions of one message by several modules: the last one counts, and the
 * log says who disagrees with whom.
 */
#include "station.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct fixture {
    struct station station;
    struct peer first, second;
};

static void open_fixture(struct fixture *f)
{
    const char *const arguments[] = {"-lms", NULL};
    station_open(&f->station, arguments);
    peer_connect(&f->station, &f->first, "First");
    peer_connect(&f->station, &f->second, "Second");
}

/* A definition by wire and content format; returns what the log says. */
static const char *define(struct peer *peer, const char *wire, const char *content)
{
    const struct message_definition definition = {(char *)(uintptr_t) "M", CLASS_BROADCAST,
                                                  (char *)(uintptr_t)wire,
                                                  (char *)(uintptr_t)content};
    (void)station_log(peer->station);
    (void)peer_tell(peer, LM_DEFINE_MESSAGE, &definition);
    station_run(peer->station);
    return station_log(peer->station);
}

#define VARIABLE "{int, <byte:1>}"

struct conflict {
    const char *wire[2];
    const char *content[2];
    const char *line; /* behind the name of the message */
};

static void the_log_names_both_modules_both_formats_and_the_first_difference(void **state)
{
    static const struct conflict conflicts[] = {
        {{VARIABLE, VARIABLE},
         {"{int, int, char}", "{int, double, byte}"},
         "{int, double, byte} (variable length), but First as {int, int, char} (variable length): "
         "part 2 is double instead of int\n"},
        {{"[byte:8]", "[byte:16]"},
         {"{int, int}", "{int, double}"},
         "{int, double} (16 bytes), but First as {int, int} (8 bytes): "
         "16 bytes instead of 8 bytes\n"},
        {{"[byte:8]", VARIABLE},
         {NULL, NULL},
         "no format (variable length), but First as no format (8 bytes): "
         "variable length instead of 8 bytes\n"},
        {{NULL, "[byte:8]"},
         {NULL, NULL},
         "no format (8 bytes), but First as no format (0 bytes): 8 bytes instead of 0 bytes\n"},
        {{VARIABLE, VARIABLE},
         {"int", NULL},
         "no format (variable length), but First as int (variable length): "
         "it is nothing instead of int\n"},
        {{VARIABLE, VARIABLE},
         {"{int, {char, int}}", "{int, {char}}"},
         "{int, {char}} (variable length), but First as {int, {char, int}} (variable length): "
         "part 2.2 is nothing instead of int\n"},
        {{VARIABLE, VARIABLE},
         {"unheard_of", "{int,\n"},
         "{int,  (variable length), but First as unheard_of (variable length): "
         "one of them is not understood\n"},
    };
    (void)state;
    for (size_t i = 0; i < N_ELEMENTS(conflicts); i++) {
        const struct conflict *conflict = &conflicts[i];
        char expected[500];
        struct fixture f;
        open_fixture(&f);
        (void)define(&f.first, conflict->wire[0], conflict->content[0]);
        const char *log = define(&f.second, conflict->wire[1], conflict->content[1]);
        (void)snprintf(expected, sizeof expected, "WARNING: Second on robot: it defines M as %s",
                       conflict->line);
        const char *line = strstr(log, "WARNING");
        assert_non_null(line);
        assert_memory_equal(line, expected, strlen(expected));
        assert_null(strstr(line + 1, "WARNING"));
        station_close(&f.station);
    }
}

static void definitions_that_mean_the_same_are_no_conflict(void **state)
{
    static const char *const same[] = {"{int,{int, <char:1>}}", "{ int, {int,<char : 1>} }",
                                       "{int, {int, <char: 1>}}"};
    struct fixture f;
    (void)state;
    open_fixture(&f);
    for (size_t i = 0; i < N_ELEMENTS(same); i++) {
        assert_null(strstr(define(&f.first, VARIABLE, same[i]), "WARNING"));
        const char *log = define(&f.second, i == 1 ? "{int,<byte:1>}" : VARIABLE, same[i]);
        assert_null(strstr(log, "WARNING"));
        assert_non_null(strstr(log, "Registration: Message M Found. Updating.\n"));
    }
    station_close(&f.station);
}

static void the_last_definition_counts_and_names_its_definer_after_its_end(void **state)
{
    struct fixture f;
    struct peer third;
    struct optional_message_info reply = {NULL};
    const struct message_info_request request = {(char *)(uintptr_t) "M", NULL};
    (void)state;
    open_fixture(&f);
    (void)define(&f.first, VARIABLE, "int");
    (void)define(&f.second, VARIABLE, "double");
    peer_lose(&f.second);
    peer_connect(&f.station, &third, "Third");
    assert_non_null(strstr(define(&third, VARIABLE, "char"), "but Second as double"));
    const struct format *format = f.station.server.catalogue.reply[LM_MESSAGE_INFO];
    assert_true(peer_ask(&f.first, LM_MESSAGE_INFO, &request, &reply));
    char *text = format_canonical(reply.info->content);
    assert_string_equal(text, "char");
    free(text);
    (void)format_release(format, &reply);
    station_close(&f.station);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_log_names_both_modules_both_formats_and_the_first_difference),
        cmocka_unit_test(definitions_that_mean_the_same_are_no_conflict),
        cmocka_unit_test(the_last_definition_counts_and_names_its_definer_after_its_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
