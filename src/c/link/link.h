/*
 * One connection: bytes in, bytes out, never blocking.
 *
 * Incoming bytes go through a frame reader.  Outgoing frames queue up and leave
 * in as few system calls as possible: short runs are gathered in one buffer,
 * long payloads are shared blocks or the caller's own memory, all written
 * together.  Knows nothing of messages.
 *
 * Without a socket (fd -1) it is the same with memory: tests put bytes into the
 * reader and take queued ones with link_take.
 */
#ifndef IPC_LINK_LINK_H
#define IPC_LINK_LINK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/buffer.h"
#include "wire/reader.h"

struct link_piece; /* one run of outgoing bytes */

struct link {
    int fd;            /* owned; -1: none */
    bool acknowledges; /* until it is found that its socket does not (net_acknowledge) */
    struct reader reader;
    struct link_piece *pieces; /* ring of what waits, owned */
    size_t n_slots;            /* a power of two */
    size_t first;
    size_t n_pieces;
    uint8_t *run; /* the bytes of short pieces, in order, owned */
    size_t run_start;
    size_t run_end;
    size_t run_capacity;
    uint64_t queued;  /* bytes ever queued */
    uint64_t written; /* bytes of these that left */
};

/* Takes over a non-blocking socket. */
void link_init(struct link *link, int fd, enum frame_origin incoming);

/* Closes the socket and drops what is queued. */
void link_fini(struct link *link);

/*
 * Reads once, as much as there is room for: number of bytes, 0 when nothing is
 * there now, ERR_CLOSED at the end of the stream, ERR_IO or ERR_MEMORY.
 * *more (may be NULL) tells whether another read is likely to find bytes.
 */
int link_read(struct link *link, bool *more);

/* Queues a frame.  Its class data and short data are copied, long data in a block is shared. */
void link_queue(struct link *link, const struct frame *frame);

/*
 * Queues a frame whose data is given separately: prefix (at most 16 bytes, copied)
 * and content.  Long content is not copied: it must stay as it is until link->written
 * has reached the returned mark.  frame->data_length counts both.
 */
uint64_t link_queue_borrowed(struct link *link, const struct frame *frame, const void *prefix,
                             size_t prefix_length, const void *content, size_t content_length);

/* Copies what is queued and not written of such content, so that its owners may change it: whether
 * there was memory. */
bool link_keep_borrowed(struct link *link);

/* Queues raw bytes (copied). */
void link_queue_raw(struct link *link, const void *bytes, size_t count);

/* Bytes that wait to leave. */
static inline uint64_t link_waiting(const struct link *link)
{
    return link->queued - link->written;
}

/* Writes what the kernel takes: 0 when all has left, 1 when some waits, ERR_CLOSED or ERR_IO. */
int link_flush(struct link *link);

/* Moves everything that waits in from (none of it borrowed) to the end of what waits in link. */
void link_take_over(struct link *link, struct link *from);

/* Moves everything that waits to the end of out (for links without a socket): 0 or ERR_MEMORY. */
int link_take(struct link *link, struct buffer *out);

#endif
