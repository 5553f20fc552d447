/*
 * Pieces of text that somebody else owns.
 */
#include "text.h"

#include <string.h>

struct text text_of(const char *string)
{
    return (struct text){string, strlen(string)};
}

bool text_equal(struct text a, struct text b)
{
    return a.length == b.length && memcmp(a.bytes, b.bytes, a.length) == 0;
}

struct text text_base_name(struct text path)
{
    size_t start = path.length;
    while (start > 0 && path.bytes[start - 1] != '/') {
        start--;
    }
    return (struct text){path.bytes + start, path.length - start};
}

int64_t text_number(struct text digits)
{
    const bool negative = digits.bytes[0] == '-';
    const uint64_t limit = (uint64_t)INT64_MAX + (negative ? 1 : 0);
    uint64_t value = 0;
    for (size_t i = 0; i < digits.length; i++) {
        if (digits.bytes[i] < '0' || digits.bytes[i] > '9') {
            continue;
        }
        const uint64_t digit = (uint64_t)(digits.bytes[i] - '0');
        value = value > (limit - digit) / 10 ? limit : value * 10 + digit;
    }
    if (!negative) {
        return (int64_t)value;
    }
    return value == limit ? INT64_MIN : -(int64_t)value;
}
