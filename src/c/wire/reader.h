/*
 * Frame reader: any split of a byte stream in, whole frames out.
 *
 * Bytes are put where reader_space says; small frames are then handed out in
 * place, without a copy.  The payload of a large frame is collected in a block
 * of its own that grows with what arrives, not with what the header promises.
 * No system calls here.
 */
#ifndef IPC_WIRE_READER_H
#define IPC_WIRE_READER_H

#include <stddef.h>
#include <stdint.h>

#include "wire/frame.h"

struct reader {
    enum frame_origin origin;
    uint32_t limit_class_data;
    uint32_t limit_data;

    uint8_t *bytes; /* owned */
    size_t capacity;
    size_t start; /* of what is not yet handed out */
    size_t end;

    struct frame large;   /* header of the large frame under way */
    uint8_t *large_bytes; /* its class data and data, owned; NULL: none under way */
    size_t large_capacity;
    size_t large_filled;

    struct block *handed;   /* block of the frame handed out last, one reference */
    const char *violation;  /* why reader_next failed */
    struct frame violating; /* the header that it was */
};

void reader_init(struct reader *reader, enum frame_origin origin);
void reader_fini(struct reader *reader);

/*
 * Where the next bytes of the stream go, and how many fit (at least one); NULL
 * when memory is out.  Frames handed out before are no longer valid.
 */
uint8_t *reader_space(struct reader *reader, size_t *room);

/* Tells that count bytes were put there. */
void reader_filled(struct reader *reader, size_t count);

/* Takes count raw bytes that precede the frames: 1 and where they are, or 0: not yet there. */
int reader_take_raw(struct reader *reader, size_t count, const uint8_t **bytes);

/*
 * The next frame: 1, or 0 when it is not complete yet, or ERR_PROTOCOL (see
 * violation; final), ERR_MEMORY.  The frame's pointers are valid until the
 * next call of reader_space, its block until the next call of reader_next.
 */
int reader_next(struct reader *reader, struct frame *frame);

/* Whether nothing is waiting: no whole frame and no part of one. */
int reader_is_empty(const struct reader *reader);

#endif
