/*
 * Frames: what follows the greeting on every connection.
 *
 *     offset  size  field
 *          0     4  class length   bytes of class data
 *          4     4  data length    bytes of data
 *          8     4  parent         dispatch whose handler runs in the sender, else -1
 *         12     4  intent         message id, handler id, or INTENT_REPLY
 *         16     4  class word     bits 31-28 order of class data, 27-24 order of data,
 *                                  23-16 alignment (0), 15-0 class
 *         20     4  dispatch       dispatch that this frame acknowledges or answers, else -1
 *         24     4  reference      the sender's number for this frame, else -1
 *         28        class data, then data
 *
 * All header fields are big-endian and signed.  A length that is negative on
 * the wire is huge here and fails the limit check.
 */
#ifndef IPC_WIRE_FRAME_H
#define IPC_WIRE_FRAME_H

#include <stddef.h>
#include <stdint.h>

#include "base/block.h"
#include "base/byteorder.h"

#define FRAME_HEADER_SIZE 28u

enum {
    NO_ID = -1,       /* no parent, dispatch, reference or intent */
    INTENT_REPLY = -4 /* the frame answers the request that reference names */
};

enum frame_class {
    CLASS_NONE = 0,       /* greeting frames, replies of central */
    CLASS_SUBSCRIBED = 1, /* in look-ups only: subscribed to, not defined */
    CLASS_DELIVERY = 2,   /* in class look-ups only: class data of deliveries */
    CLASS_QUERY = 3,
    CLASS_INFORM = 6,
    CLASS_REPLY = 11,
    CLASS_SUCCESS = 12,
    CLASS_FAILURE = 13,
    CLASS_BROADCAST = 15
};

/* Who wrote the frames of a stream; decides which classes are allowed in it. */
enum frame_origin { FROM_MODULE, FROM_CENTRAL, FROM_PEER };

struct frame {
    uint32_t class_length;
    uint32_t data_length;
    int32_t parent;
    int32_t intent;
    uint16_t class; /* enum frame_class, as far as checked */
    uint8_t alignment;
    uint8_t class_order; /* enum byte_order, as far as checked */
    uint8_t data_order;
    int32_t dispatch;
    int32_t reference;
    const uint8_t *class_data;
    const uint8_t *data;
    struct block *block; /* where both are when the frame is large, borrowed; else NULL */
};

/* A frame of that class without content, in this host's byte order, all numbers NO_ID. */
void frame_init(struct frame *frame, enum frame_class class);

/* Writes the header fields. */
void frame_write_header(const struct frame *frame, uint8_t bytes[FRAME_HEADER_SIZE]);

/* Reads the header fields without judging them; class_data, data and block become NULL. */
void frame_read_header(struct frame *frame, const uint8_t bytes[FRAME_HEADER_SIZE]);

/* NULL when the header is acceptable, otherwise what is wrong with it, in static storage. */
const char *frame_violation(const struct frame *frame, enum frame_origin origin,
                            uint32_t limit_class_data, uint32_t limit_data);

#endif
