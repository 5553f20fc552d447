/*
 * The command line.
 */
#include "unit.h"

#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "central/settings/command_line.h"

struct fixture {
    struct options options;
    struct buffer out;
    struct buffer errors;
};

static void open_fixture(struct fixture *f)
{
    options_init(&f->options);
    buffer_init(&f->out);
    buffer_init(&f->errors);
}

static void close_fixture(struct fixture *f)
{
    options_fini(&f->options);
    buffer_fini(&f->out);
    buffer_fini(&f->errors);
}

/* Parses words that are separated by blanks. */
static enum options_result parse(struct fixture *f, const char *line)
{
    static char words[500];
    char *arguments[20] = {(char *)(uintptr_t) "central"};
    int count = 1;
    const struct options_output output = {&f->out, &f->errors};
    open_fixture(f);
    (void)snprintf(words, sizeof words, "%s", line);
    for (char *word = strtok(words, " "); word != NULL; word = strtok(NULL, " ")) {
        arguments[count++] = word;
    }
    return options_parse(&f->options, count, arguments, &output);
}

static void assert_text(struct buffer *buffer, const char *expected)
{
    assert_int_equal(buffer_append(buffer, "", 1), 0);
    assert_string_equal((char *)buffer->bytes, expected);
}

static void the_defaults(void **state)
{
    struct fixture f;
    (void)state;
    assert_int_equal(parse(&f, ""), OPTIONS_GO);
    assert_int_equal(f.options.port, 1381);
    assert_int_equal(f.options.expected, 1);
    assert_true(f.options.read_commands);
    assert_false(f.options.direct || f.options.silent || f.options.resend);
    assert_true(f.options.terminal.messages && f.options.terminal.status &&
                f.options.terminal.ignore && f.options.terminal.flush);
    assert_false(f.options.terminal.time || f.options.terminal.data);
    assert_true(f.options.file.ignore && f.options.file.flush);
    assert_false(f.options.file.messages || f.options.file.status);
    close_fixture(&f);
}

static void options_are_single_arguments(void **state)
{
    struct fixture f;
    (void)state;
    assert_int_equal(parse(&f, "-p21303xyz -su -c -r nothing 3x 7"), OPTIONS_GO);
    assert_int_equal(f.options.port, 21303);
    assert_int_equal(f.options.expected, 3);
    assert_true(f.options.silent);
    assert_true(f.options.read_commands); /* -su is -s */
    assert_true(f.options.direct && f.options.resend);
    close_fixture(&f);

    assert_int_equal(parse(&f, "-p 1500 -us 0"), OPTIONS_GO);
    assert_int_equal(f.options.port, 1381);
    assert_int_equal(f.options.expected, 1500);
    assert_false(f.options.silent || f.options.read_commands);
    close_fixture(&f);

    assert_int_equal(parse(&f, "0 -pabc -S"), OPTIONS_GO);
    assert_int_equal(f.options.expected, 1);
    assert_int_equal(f.options.port, 1381);
    assert_true(f.options.silent);
    close_fixture(&f);
}

static void what_is_unknown_is_said_and_ignored(void **state)
{
    struct fixture f;
    (void)state;
    assert_int_equal(parse(&f, "-z -u -v - --"), OPTIONS_GO);
    assert_false(f.options.read_commands);
    assert_text(&f.errors, "Ignoring unknown option '-z'\nIgnoring unknown option '-v'\n"
                           "Ignoring unknown option '-'\nIgnoring unknown option '--'\n");
    close_fixture(&f);
}

static void words_do_what_letters_do(void **state)
{
    struct fixture f;
    (void)state;
    assert_int_equal(parse(&f, "--port=2100 --direct --silent --no-console --resend --log=mt "
                               "--file-log=dn --log-file=a.log --ignore=Ping "
                               "--expected-modules=4"),
                     OPTIONS_GO);
    assert_int_equal(f.options.port, 2100);
    assert_int_equal(f.options.expected, 4);
    assert_true(f.options.direct && f.options.silent && f.options.resend);
    assert_false(f.options.read_commands);
    assert_true(f.options.terminal.messages && f.options.terminal.time);
    assert_false(f.options.terminal.status || f.options.terminal.ignore);
    assert_true(f.options.file.data);
    assert_false(f.options.file.messages || f.options.file.comments);
    assert_string_equal(f.options.file_name, "a.log");
    assert_false(list_is_empty(&f.options.ignored));
    close_fixture(&f);
}

static void a_word_may_have_its_value_in_the_next_argument(void **state)
{
    struct fixture f;
    (void)state;
    assert_int_equal(parse(&f, "--port 2100 3 --log --log-file 5.log"), OPTIONS_GO);
    assert_int_equal(f.options.port, 2100);
    assert_int_equal(f.options.expected, 3); /* the other numbers are values */
    assert_string_equal(f.options.file_name, "5.log");
    assert_true(f.options.terminal.summary); /* the letters of a log stand behind = only */
    close_fixture(&f);
}

static void wrong_words_are_refused(void **state)
{
    static const struct {
        const char *line;
        const char *says;
    } cases[] = {
        {"--what", "Unknown option --what (--help lists all)\n"},
        {"--por=5", "Unknown option --por=5 (--help lists all)\n"},
        {"--direct=yes", "The option --direct takes no value\n"},
        {"--port", "The option --port needs a value\n"},
        {"--log-file= -u", "The option --log-file needs a value\n"},
        {"--port=5x", "Illegal port 5x\n"},
        {"--port=x", "Illegal port x\n"},
        {"--expected-modules=0", "Illegal number of modules 0\n"},
        {"--expected-modules 3x", "Illegal number of modules 3x\n"},
        {"--what --that", "Unknown option --what (--help lists all)\n"}, /* one line is enough */
    };
    (void)state;
    for (size_t i = 0; i < N_ELEMENTS(cases); i++) {
        struct fixture f;
        assert_int_equal(parse(&f, cases[i].line), OPTIONS_WRONG);
        assert_text(&f.errors, cases[i].says);
        close_fixture(&f);
    }
}

static void impossible_ports_are_refused(void **state)
{
    static const char *const lines[] = {"-p70000", "-p-5", "-p99999999999999999999"};
    (void)state;
    for (size_t i = 0; i < N_ELEMENTS(lines); i++) {
        struct fixture f;
        char expected[100];
        assert_int_equal(parse(&f, lines[i]), OPTIONS_WRONG);
        (void)snprintf(expected, sizeof expected, "Illegal port %s\n", lines[i] + 2);
        assert_text(&f.errors, expected);
        close_fixture(&f);
    }
}

static void limits_are_set_by_name(void **state)
{
    struct fixture f;
    (void)state;
    assert_int_equal(parse(&f, "--limit-queue-bytes=5000 -c --limit-stuck-seconds=0.25 "
                               "--limit-message-bytes=1e6"),
                     OPTIONS_GO);
    assert_int_equal(f.options.limits.pending_bytes, 5000);
    assert_int_equal(f.options.limits.stuck_ns, 250000000);
    assert_int_equal(f.options.limits.data, 1000000);
    assert_int_equal(f.options.limits.pending_messages, 2000000);
    assert_true(f.options.direct);
    close_fixture(&f);
}

static void policies_of_full_queues_are_chosen_for_all_and_by_module(void **state)
{
    struct fixture f;
    (void)state;
    assert_int_equal(parse(&f, "--when-full=oldest --when-full=Arm:newest --when-full=a:b:wait "
                               "--when-full=arm:disconnect"),
                     OPTIONS_GO);
    assert_int_equal(full_policies_of(&f.options.when_full, "other"), WHEN_FULL_OLDEST);
    assert_int_equal(full_policies_of(&f.options.when_full, "ARM"), WHEN_FULL_DISCONNECT);
    assert_int_equal(full_policies_of(&f.options.when_full, "a:b"), WHEN_FULL_WAIT);
    assert_int_equal(full_policies_of(&f.options.when_full, "a"), WHEN_FULL_OLDEST);
    close_fixture(&f);
}

static void wrong_policies_are_refused(void **state)
{
    static const char *const lines[] = {"--when-full=latest", "--when-full=:wait",
                                        "--when-full=Arm:", "--when-full=Arm"};
    (void)state;
    for (size_t i = 0; i < N_ELEMENTS(lines); i++) {
        struct fixture f;
        char expected[100];
        assert_int_equal(parse(&f, lines[i]), OPTIONS_WRONG);
        (void)snprintf(expected, sizeof expected, "No such policy: %s (--help lists them)\n",
                       lines[i] + strlen("--when-full="));
        assert_text(&f.errors, expected);
        close_fixture(&f);
    }
}

static void wrong_limits_are_refused(void **state)
{
    static const char *const illegal[] = {"--limit-queue-bytes=",       "--limit-queue-bytes=0",
                                          "--limit-queue-bytes=-1",     "--limit-queue-bytes=5k",
                                          "--limit-queue-bytes=nan",    "--limit-queue-bytes=1e30",
                                          "--limit-message-bytes=1e10", "--limit-stuck-seconds=0"};
    static const char *const unknown[] = {"--limit-", "--limit-queue-bytes", "--limit-queue=3",
                                          "--limit-queue-bytesx=3"};
    (void)state;
    for (size_t i = 0; i < N_ELEMENTS(illegal) + N_ELEMENTS(unknown); i++) {
        struct fixture f;
        char expected[100];
        const bool known = i < N_ELEMENTS(illegal);
        const char *line = known ? illegal[i] : unknown[i - N_ELEMENTS(illegal)];
        assert_int_equal(parse(&f, line), OPTIONS_WRONG);
        (void)snprintf(expected, sizeof expected,
                       known ? "Illegal number in %s\n" : "No such limit %s (--help lists them)\n",
                       line);
        assert_text(&f.errors, expected);
        assert_int_equal(f.options.limits.pending_bytes, 1073741824);
        close_fixture(&f);
    }
}

static void who_may_connect_and_how(void **state)
{
    static const struct {
        const char *line;
        enum allowed_users users;
        bool local_only;
        const char *address;
    } lines[] = {
        {"", USERS_ALL, false, NULL},
        {"--bind=127.0.0.1", USERS_ALL, false, "127.0.0.1"},
        {"--bind ::1", USERS_ALL, false, "::1"},
        {"--bind=robot --bind=local", USERS_ALL, true, NULL},
        {"--bind=local --bind=robot", USERS_ALL, false, "robot"},
        {"--access=owner", USERS_OWNER, false, NULL},
        {"--access=owner --bind=local", USERS_OWNER, true, NULL},
        {"--access=owner --access=all --bind=robot", USERS_ALL, false, "robot"},
    };
    struct fixture f;
    (void)state;
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        assert_int_equal(parse(&f, lines[i].line), OPTIONS_GO);
        assert_int_equal(f.options.users, lines[i].users);
        assert_int_equal(f.options.local_only, lines[i].local_only);
        if (lines[i].address == NULL) {
            assert_null(f.options.address);
        } else {
            assert_string_equal(f.options.address, lines[i].address);
        }
        close_fixture(&f);
    }
    assert_int_equal(parse(&f, "--access=group=0"), OPTIONS_GO);
    assert_int_equal(f.options.users, USERS_GROUP);
    assert_int_equal(f.options.group, 0);
    close_fixture(&f);
}

static void users_that_tcp_cannot_tell_and_no_users_are_refused(void **state)
{
    static const char *const lines[] = {"--access=owner --bind=robot",
                                        "--bind=robot --access=owner",
                                        "--access=everybody",
                                        "--access=group=",
                                        "--access",
                                        "--access=group=no-such-group"};
    struct fixture f;
    (void)state;
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        assert_int_equal(parse(&f, lines[i]), OPTIONS_WRONG);
        assert_true(f.errors.length > 0);
        close_fixture(&f);
    }
}

static void files_and_addresses_are_kept(void **state)
{
    struct fixture f;
    (void)state;
    assert_int_equal(parse(&f, "--pid-file=a --pid-file=b --port-file=c --metrics=9123"),
                     OPTIONS_GO);
    assert_string_equal(f.options.pid_file, "b");
    assert_string_equal(f.options.port_file, "c");
    assert_string_equal(f.options.metrics, "9123");
    close_fixture(&f);
}

static void log_letters(void **state)
{
    struct fixture f;
    (void)state;
    assert_int_equal(parse(&f, "-l -L"), OPTIONS_GO);
    const struct log_switches *file = &f.options.file;
    assert_true(file->messages && file->status && file->time && file->data && file->summary);
    assert_false(file->ignore || file->references || file->parents || file->comments);
    close_fixture(&f);

    assert_int_equal(parse(&f, "-lx -LMtIrNf"), OPTIONS_GO);
    assert_false(f.options.terminal.messages || f.options.terminal.status ||
                 f.options.terminal.ignore);
    file = &f.options.file;
    assert_true(file->messages && file->time && file->ignore && file->references);
    assert_false(file->status || file->data || file->summary || file->parents);
    assert_false(file->flush || file->comments);
    close_fixture(&f);

    assert_int_equal(parse(&f, "-Lpf -Lm -lmx -lz"), OPTIONS_GO);
    file = &f.options.file;
    assert_true(file->messages && file->flush && file->comments);
    assert_false(file->parents);
    assert_false(f.options.terminal.messages);
    close_fixture(&f);
}

static void the_listing_and_the_version_are_shown_alone(void **state)
{
    struct fixture f;
    (void)state;
    assert_int_equal(parse(&f, "-h -p5"), OPTIONS_SHOWN);
    assert_int_equal(f.options.port, 1381);
    assert_int_equal(buffer_append(&f.out, "", 1), 0);
    const char *text = (char *)f.out.bytes;
    assert_int_equal(strncmp(text,
                             "central command line options:\n"
                             " -v: display server version info.\n"
                             " -l: logging onto terminal.\n",
                             60),
                     0);
    assert_non_null(strstr(text, "\n -p<port>: specify the server port - the default port is: "
                                 "1381\n -c: Use direct (not via central) conntections where "
                                 "possible.\n"));
    assert_non_null(strstr(text, " -r: try resending non-completed messages when modules crash\n"));
    close_fixture(&f);

    assert_int_equal(parse(&f, "-v"), OPTIONS_SHOWN);
    assert_int_equal(strncmp((char *)f.errors.bytes, "Task Control Server 4.", 22), 0);
    close_fixture(&f);

    assert_int_equal(parse(&f, "-p5 --help"), OPTIONS_SHOWN);
    assert_int_equal(buffer_append(&f.out, "", 1), 0);
    assert_non_null(strstr((char *)f.out.bytes,
                           "\n --limit-progress-seconds=<number>: senders wait for a receiver that "
                           "finishes nothing - the default is: 0.25\n"));
    assert_non_null(strstr((char *)f.out.bytes, "\n -p<port>, --port=<port>: specify the server "
                                                "port - the default port is: 1381\n"));
    close_fixture(&f);
    assert_int_equal(parse(&f, "-p5 --version"), OPTIONS_SHOWN);
    assert_int_equal(strncmp((char *)f.out.bytes, "Task Control Server 4.", 22), 0);
    close_fixture(&f);
}

static void names_to_ignore_come_from_options_and_files(void **state)
{
    static const char path[] = "options_test_names";
    struct fixture f;
    FILE *file = fopen(path, "w");
    (void)state;
    assert_non_null(file);
    assert_true(fputs("Foo\r\n\nBar with blanks\nlast", file) >= 0);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(parse(&f, "-iPing -i -Ioptions_test_names -Inowhere/at/all"), OPTIONS_GO);
    static const char *const expected[] = {"Ping", "Foo", "Bar with blanks", "last"};
    size_t i = 0;
    struct list *at, *following;
    LIST_EACH (at, following, &f.options.ignored) {
        assert_string_equal(LIST_OWNER(at, struct ignored_name, in_options)->name, expected[i++]);
    }
    assert_int_equal(i, N_ELEMENTS(expected));
    assert_text(&f.errors, "Ignore logging of Foo\nIgnore logging of Bar with blanks\n"
                           "Ignore logging of last\n"
                           "Could not open message ignore file nowhere/at/all\n");
    close_fixture(&f);
    assert_int_equal(remove(path), 0);
}

static void typed_options(void **state)
{
    struct fixture f;
    (void)state;
    open_fixture(&f);
    const struct options_output output = {&f.out, &f.errors};
    assert_int_equal(options_type(&f.options, "-s", &output), 0);
    assert_true(f.options.silent);
    assert_int_equal(options_type(&f.options, "-lm", &output), 0);
    assert_false(f.options.silent); /* asking for a log ends silence */
    assert_int_equal(options_type(&f.options, "-p99", &output), 0);
    assert_int_equal(f.options.port, 1381);
    assert_int_equal(options_type(&f.options, "--port", &output), ERR_RANGE);
    assert_int_equal(options_type(&f.options, "--log=d", &output), 0);
    assert_true(f.options.terminal.data);
    assert_int_equal(options_type(&f.options, "-fx.log", &output), 0);
    assert_int_equal(options_type(&f.options, "-z", &output), ERR_UNKNOWN);
    assert_text(&f.out, "The port cannot be changed while running\nLogging File Name: x.log\n");
    close_fixture(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_defaults),
        cmocka_unit_test(options_are_single_arguments),
        cmocka_unit_test(what_is_unknown_is_said_and_ignored),
        cmocka_unit_test(words_do_what_letters_do),
        cmocka_unit_test(a_word_may_have_its_value_in_the_next_argument),
        cmocka_unit_test(wrong_words_are_refused),
        cmocka_unit_test(impossible_ports_are_refused),
        cmocka_unit_test(limits_are_set_by_name),
        cmocka_unit_test(policies_of_full_queues_are_chosen_for_all_and_by_module),
        cmocka_unit_test(wrong_policies_are_refused),
        cmocka_unit_test(wrong_limits_are_refused),
        cmocka_unit_test(who_may_connect_and_how),
        cmocka_unit_test(users_that_tcp_cannot_tell_and_no_users_are_refused),
        cmocka_unit_test(files_and_addresses_are_kept),
        cmocka_unit_test(log_letters),
        cmocka_unit_test(the_listing_and_the_version_are_shown_alone),
        cmocka_unit_test(names_to_ignore_come_from_options_and_files),
        cmocka_unit_test(typed_options),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
