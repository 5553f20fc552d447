/*
 * One connection: the out-queue and the system calls around a frame reader.
 *
 * Short bytes are gathered in the run, a plain buffer whose front moves up as it
 * is written.  A piece says where the next bytes to write are: so many from the
 * run, or a stretch of a shared block, or of the caller's memory.
 */
#include "link/link.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "platform/platform.h"

enum {
    LONG_CONTENT = 4096, /* from here on sharing is cheaper than copying */
    FIRST_RUN = 1024,
    KEPT_RUN = 64 * 1024, /* more is given back once it has been written */
    MAX_SLICES = 64       /* per system call */
};

struct link_piece {
    const uint8_t *bytes; /* NULL: they are in the run */
    size_t length;
    struct block *block; /* keeps bytes alive; NULL: the caller does */
};

void link_init(struct link *link, int fd, enum frame_origin incoming)
{
    memset(link, 0, sizeof *link);
    link->fd = fd;
    link->acknowledges = true;
    reader_init(&link->reader, incoming);
}

static struct link_piece *piece_at(const struct link *link, size_t i)
{
    return &link->pieces[(link->first + i) & (link->n_slots - 1)];
}

void link_fini(struct link *link)
{
    for (size_t i = 0; i < link->n_pieces; i++) {
        block_unref(piece_at(link, i)->block);
    }
    free(link->pieces);
    free(link->run);
    reader_fini(&link->reader);
    if (link->fd >= 0) {
        net_close(link->fd);
    }
    link->fd = -1;
    link->pieces = NULL;
    link->run = NULL;
    link->n_pieces = 0;
}

int link_read(struct link *link, bool *more)
{
    size_t room;
    if (more != NULL) {
        *more = false;
    }
    uint8_t *space = reader_space(&link->reader, &room);
    if (space == NULL) {
        return ERR_MEMORY;
    }
    const ptrdiff_t n = net_read(link->fd, space, room);
    if (n > 0) {
        reader_filled(&link->reader, (size_t)n);
        if (link->reader.large_bytes != NULL && link->acknowledges) {
            link->acknowledges = net_acknowledge(link->fd);
        }
        if (more != NULL) {
            *more = (size_t)n == room;
        }
    }
    return (int)n;
}

/* ------------------------------------------------------------------ queueing */

static struct link_piece *add_piece(struct link *link)
{
    if (link->n_pieces == link->n_slots) {
        const size_t n_slots = link->n_slots == 0 ? 8 : link->n_slots * 2;
        struct link_piece *pieces = mem_resize(NULL, n_slots, sizeof *pieces);
        for (size_t i = 0; i < link->n_pieces; i++) {
            pieces[i] = *piece_at(link, i);
        }
        free(link->pieces);
        link->pieces = pieces;
        link->n_slots = n_slots;
        link->first = 0;
    }
    struct link_piece *piece = piece_at(link, link->n_pieces++);
    memset(piece, 0, sizeof *piece);
    return piece;
}

/* Room for count more bytes at the end of the run. */
static uint8_t *extend_run(struct link *link, size_t count)
{
    if (link->run_capacity - link->run_end < count && link->run_start > 0) {
        memmove(link->run, link->run + link->run_start, link->run_end - link->run_start);
        link->run_end -= link->run_start;
        link->run_start = 0;
    }
    if (link->run_capacity - link->run_end < count) {
        size_t capacity = link->run_capacity == 0 ? FIRST_RUN : link->run_capacity * 2;
        while (capacity - link->run_end < count) {
            capacity *= 2;
        }
        link->run = mem_resize(link->run, capacity, 1);
        link->run_capacity = capacity;
    }
    struct link_piece *last = link->n_pieces > 0 ? piece_at(link, link->n_pieces - 1) : NULL;
    if (last == NULL || last->bytes != NULL) {
        last = add_piece(link);
    }
    uint8_t *at = link->run + link->run_end;
    last->length += count;
    link->run_end += count;
    link->queued += count;
    return at;
}

static void append(struct link *link, const void *bytes, size_t count)
{
    if (count > 0) {
        memcpy(extend_run(link, count), bytes, count);
    }
}

static void append_shared(struct link *link, const uint8_t *bytes, size_t count,
                          struct block *block)
{
    struct link_piece *piece = add_piece(link);
    piece->bytes = bytes;
    piece->length = count;
    piece->block = block == NULL ? NULL : block_ref(block);
    link->queued += count;
}

static void append_header(struct link *link, const struct frame *frame)
{
    uint8_t *at = extend_run(link, FRAME_HEADER_SIZE + frame->class_length);
    frame_write_header(frame, at);
    if (frame->class_length > 0) {
        memcpy(at + FRAME_HEADER_SIZE, frame->class_data, frame->class_length);
    }
}

void link_queue(struct link *link, const struct frame *frame)
{
    append_header(link, frame);
    if (frame->block != NULL && frame->data_length >= LONG_CONTENT) {
        append_shared(link, frame->data, frame->data_length, frame->block);
    } else {
        append(link, frame->data, frame->data_length);
    }
}

uint64_t link_queue_borrowed(struct link *link, const struct frame *frame, const void *prefix,
                             size_t prefix_length, const void *content, size_t content_length)
{
    append_header(link, frame);
    append(link, prefix, prefix_length);
    if (content_length >= LONG_CONTENT) {
        append_shared(link, content, content_length, NULL);
    } else {
        append(link, content, content_length);
    }
    return link->queued;
}

bool link_keep_borrowed(struct link *link)
{
    for (size_t i = 0; i < link->n_pieces; i++) {
        struct link_piece *piece = piece_at(link, i);
        if (piece->bytes == NULL || piece->block != NULL) {
            continue;
        }
        piece->block = block_copy(piece->bytes, piece->length);
        if (piece->block == NULL) {
            return false;
        }
        piece->bytes = piece->block->bytes;
    }
    return true;
}

void link_queue_raw(struct link *link, const void *bytes, size_t count)
{
    append(link, bytes, count);
}

/* ------------------------------------------------------------------- leaving */

/* The first pieces as slices of memory; returns how many. */
static size_t gather(const struct link *link, struct net_slice *slices)
{
    size_t from_run = link->run_start;
    const size_t n = link->n_pieces < MAX_SLICES ? link->n_pieces : MAX_SLICES;
    for (size_t i = 0; i < n; i++) {
        const struct link_piece *piece = piece_at(link, i);
        slices[i].length = piece->length;
        slices[i].bytes = piece->bytes;
        if (piece->bytes == NULL) {
            slices[i].bytes = link->run + from_run;
            from_run += piece->length;
        }
    }
    return n;
}

/* Takes count bytes off the front of a piece, and the piece off the ring when nothing is left. */
static void shorten_first(struct link *link, size_t count)
{
    struct link_piece *piece = piece_at(link, 0);
    piece->length -= count;
    if (piece->bytes != NULL) {
        piece->bytes += count;
    } else {
        link->run_start += count;
    }
    if (piece->length == 0) {
        block_unref(piece->block);
        link->first++;
        link->n_pieces--;
    }
}

static void drop_written(struct link *link, size_t count)
{
    link->written += count;
    while (count > 0) {
        const size_t here = piece_at(link, 0)->length;
        const size_t taken = here < count ? here : count;
        shorten_first(link, taken);
        count -= taken;
    }
    if (link->run_start == link->run_end) {
        link->run_start = link->run_end = 0;
        if (link->run_capacity > KEPT_RUN) {
            free(link->run);
            link->run = NULL;
            link->run_capacity = 0;
        }
    }
}

int link_flush(struct link *link)
{
    while (link->n_pieces > 0) {
        struct net_slice slices[MAX_SLICES];
        size_t offered = 0;
        const size_t n_slices = gather(link, slices);
        for (size_t i = 0; i < n_slices; i++) {
            offered += slices[i].length;
        }
        const ptrdiff_t n = link->fd < 0 ? 0 : net_write(link->fd, slices, n_slices);
        if (n < 0) {
            return (int)n;
        }
        drop_written(link, (size_t)n);
        if ((size_t)n < offered) {
            return 1;
        }
    }
    return 0;
}

void link_take_over(struct link *link, struct link *from)
{
    while (from->n_pieces > 0) {
        const struct link_piece *piece = piece_at(from, 0);
        const size_t length = piece->length;
        if (piece->bytes != NULL) {
            append_shared(link, piece->bytes, length, piece->block);
        } else {
            append(link, from->run + from->run_start, length);
        }
        drop_written(from, length);
    }
}

int link_take(struct link *link, struct buffer *out)
{
    while (link->n_pieces > 0) {
        struct net_slice slices[MAX_SLICES];
        (void)gather(link, slices); /* one is enough here */
        if (buffer_append(out, slices[0].bytes, slices[0].length) != 0) {
            return ERR_MEMORY;
        }
        drop_written(link, slices[0].length);
    }
    return 0;
}
