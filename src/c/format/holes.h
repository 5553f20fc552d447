/*
 * The parts of a value that decoding does not overwrite by itself: padding, and
 * whatever must be zero until it is decoded because it points to something.
 */
#ifndef IPC_FORMAT_HOLES_H
#define IPC_FORMAT_HOLES_H

#include <stddef.h>
#include <stdint.h>

struct type;

enum { MOST_HOLES = 4 };

struct hole {
    uint32_t offset;
    uint32_t length;
};

/* In order of their offsets; neighbours are one hole, and so is what is beyond the last place. */
struct holes {
    uint32_t count;
    struct hole items[MOST_HOLES];
};

void holes_find(struct holes *holes, const struct type *type);

#endif
