/*
 * The primitives: names, codes, sizes.
 *
 * Sizes and alignments are the compiler's.  The alignment is that of a struct
 * member, which on some hosts is less than what _Alignof says.
 */
#include "format/type.h"

#include <limits.h>
#include <string.h>

#define ALIGNMENT(type, name)                                                                      \
    struct name {                                                                                  \
        char first;                                                                                \
        type second;                                                                               \
    }
ALIGNMENT(short, after_short);
ALIGNMENT(int, after_int);
ALIGNMENT(long, after_long);
ALIGNMENT(float, after_float);
ALIGNMENT(double, after_double);
ALIGNMENT(void *, after_pointer);
#undef ALIGNMENT

#define ONE_BYTE 1, 1, 1, true, true
#define TWO_BYTES 2, offsetof(struct after_short, second), 2, true, true
#define FOUR_BYTES 4, offsetof(struct after_int, second), 4, true, true
#define A_LONG sizeof(long), offsetof(struct after_long, second), sizeof(long), true, true
#define A_POINTER sizeof(void *), offsetof(struct after_pointer, second)

const struct primitive_info primitive_table[N_PRIMITIVES] = {
    {"char", 16, ONE_BYTE, CHAR_MIN < 0},
    {"byte", 5, ONE_BYTE, true},
    {"ubyte", 9, ONE_BYTE, false},
    {"short", 17, TWO_BYTES, true},
    {"ushort", 28, TWO_BYTES, false},
    {"twobyte", 6, TWO_BYTES, false},
    {"int", 1, FOUR_BYTES, true},
    {"uint", 29, FOUR_BYTES, false},
    {"boolean", 2, FOUR_BYTES, true},
    {"long", 18, A_LONG, true},
    {"ulong", 30, A_LONG, false},
    {"float", 3, 4, offsetof(struct after_float, second), 4, true, false, true},
    {"double", 4, 8, offsetof(struct after_double, second), 8, true, false, true},
    {"string", 7, A_POINTER, 5, false, false, false},        /* length, filler byte */
    {"format", 8, A_POINTER, 4, false, false, false},        /* kind -1 */
    {"X_IPC_REF_PTR", 20, A_POINTER, 9, false, false, false} /* number, empty string */
};

#undef ONE_BYTE
#undef TWO_BYTES
#undef FOUR_BYTES
#undef A_LONG
#undef A_POINTER

enum primitive primitive_find(const char *name, size_t length)
{
    for (int i = 0; i < N_PRIMITIVES; i++) {
        const char *known = primitive_table[i].name;
        if (strlen(known) == length && memcmp(known, name, length) == 0) {
            return (enum primitive)i;
        }
    }
    return N_PRIMITIVES;
}

enum primitive primitive_find_code(uint32_t code)
{
    for (int i = 0; i < N_PRIMITIVES; i++) {
        if (primitive_table[i].code == code) {
            return (enum primitive)i;
        }
    }
    return N_PRIMITIVES;
}

enum of_one_byte { LARGEST_OF_ONE_BYTE = 255 };
enum of_two_bytes { LARGEST_OF_TWO_BYTES = 65535 };
enum of_four_bytes { LARGEST_OF_FOUR_BYTES = 2147483647 };

uint32_t enumeration_size(int32_t largest)
{
    if (largest <= LARGEST_OF_ONE_BYTE) {
        return sizeof(enum of_one_byte);
    }
    if (largest <= LARGEST_OF_TWO_BYTES) {
        return sizeof(enum of_two_bytes);
    }
    return sizeof(enum of_four_bytes);
}
