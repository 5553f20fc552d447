/*
 * Fuzz target: the parser.
 *
 * The input is lines "name=definition", and a last line with the format to be
 * parsed.  What is accepted must be parsed again from its canonical text and
 * read again from its binary form, to an equal format.
 */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "format/format.h"
#include "format/names.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(int condition)
{
    if (!condition) {
        abort();
    }
}

/* Whether a text has an array of raw bytes in it, whose text means the old form when it is read. */
static int is_ambiguous(const char *text)
{
    for (; *text != '\0'; text++) {
        if (text[0] == '[' && text[1] >= '0' && text[1] <= '9') {
            return 1;
        }
    }
    return 0;
}

static void check_text(const struct format *format)
{
    struct format *again = NULL;
    char *canonical = format_canonical(format);
    if (!is_ambiguous(canonical)) {
        require(format_parse(canonical, NULL, &again, NULL) == 0);
        require(format_equal(again, format));
        require(format_size(again) == format_size(format));
    }
    format_unref(again);
    free(canonical);
}

static void check_binary(struct format *format)
{
    struct format *carrier, *again;
    struct buffer out;
    size_t measured;
    buffer_init(&out);
    require(format_parse("format", NULL, &carrier, NULL) == 0);
    require(format_encode(carrier, &format, ORDER_BIG, &out) == 0);
    require(format_measure(carrier, &format, &measured) == 0 && measured == out.length);
    const struct format_source source = {out.bytes, out.length, ORDER_BIG};
    require(format_decode(carrier, &source, &again, NULL) == 0);
    require(format_equal(again, format));
    format_unref(again);
    format_unref(carrier);
    buffer_fini(&out);
}

/* Takes the definitions from the lines and returns the last line. */
static char *define_all(struct format_names *names, char *text)
{
    for (char *end = strchr(text, '\n'); end != NULL; end = strchr(text, '\n')) {
        *end = '\0';
        char *sign = strchr(text, '=');
        if (sign != NULL) {
            *sign = '\0';
            (void)format_names_define(names, text, sign + 1);
        }
        text = end + 1;
    }
    return text;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *text = malloc(size + 1);
    if (text == NULL) {
        return 0;
    }
    memcpy(text, data, size);
    text[size] = '\0';
    struct format_names *names = format_names_new();
    const char *last = define_all(names, text);
    struct format_diagnosis diagnosis;
    struct format *format;
    free(format_portable_text(last, names));
    if (format_parse(last, names, &format, &diagnosis) == 0) {
        check_text(format);
        check_binary(format);
    } else {
        require(diagnosis.text != NULL);
    }
    free(diagnosis.text);
    format_unref(format);
    format_names_free(names);
    free(text);
    return 0;
}
