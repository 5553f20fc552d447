/*
 * Fuzz target: the decoder.
 *
 * The input is a byte (its lowest bit says the byte order), a format string, a
 * zero byte and content.  What is decoded must be encoded again, and printed.
 */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "format/format.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(int condition)
{
    if (!condition) {
        abort();
    }
}

static void use(const struct format *format, void *value, enum byte_order order, size_t used)
{
    struct buffer out;
    size_t measured;
    buffer_init(&out);
    require(format_print(format, value, 2, &out) == 0);
    buffer_clear(&out);
    require(format_encode(format, value, order, &out) == 0);
    require(format_measure(format, value, &measured) == 0 && measured == out.length);
    require(out.length <= used); /* strings end at a NUL inside them */
    require(format_release(format, value) == 0);
    buffer_fini(&out);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const uint8_t *text = data + 1;
    const uint8_t *end = size < 2 ? NULL : memchr(text, 0, size - 1);
    struct format *format;
    if (end == NULL || format_parse((const char *)text, NULL, &format, NULL) != 0) {
        return 0;
    }
    const enum byte_order order = (data[0] & 1) != 0 ? ORDER_BIG : ORDER_LITTLE;
    const uint8_t *content = end + 1;
    const struct format_source source = {content, size - (size_t)(content - data), order};
    void *value;
    size_t used;
    if (format_decode_new(format, &source, &value, &used) == 0) {
        use(format, value, order, used);
    }
    free(value);
    format_unref(format);
    return 0;
}
