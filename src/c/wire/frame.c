/*
 * Frame headers: to bytes, from bytes, and whether they are acceptable.
 */
#include "wire/frame.h"

#include <stdbool.h>
#include <string.h>

void frame_init(struct frame *frame, enum frame_class class)
{
    memset(frame, 0, sizeof *frame);
    frame->class = (uint16_t) class;
    frame->class_order = (uint8_t)byte_order_of_host();
    frame->data_order = (uint8_t)byte_order_of_host();
    frame->parent = NO_ID;
    frame->intent = NO_ID;
    frame->dispatch = NO_ID;
    frame->reference = NO_ID;
}

void frame_write_header(const struct frame *frame, uint8_t bytes[FRAME_HEADER_SIZE])
{
    const uint32_t class_word = ((uint32_t)frame->class_order << 28) |
                                ((uint32_t)(frame->data_order & 0xfu) << 24) |
                                ((uint32_t)frame->alignment << 16) | frame->class;
    store_be32(bytes, frame->class_length);
    store_be32(bytes + 4, frame->data_length);
    store_be32(bytes + 8, (uint32_t)frame->parent);
    store_be32(bytes + 12, (uint32_t)frame->intent);
    store_be32(bytes + 16, class_word);
    store_be32(bytes + 20, (uint32_t)frame->dispatch);
    store_be32(bytes + 24, (uint32_t)frame->reference);
}

void frame_read_header(struct frame *frame, const uint8_t bytes[FRAME_HEADER_SIZE])
{
    const uint32_t class_word = load_be32(bytes + 16);
    frame->class_length = load_be32(bytes);
    frame->data_length = load_be32(bytes + 4);
    frame->parent = (int32_t)load_be32(bytes + 8);
    frame->intent = (int32_t)load_be32(bytes + 12);
    frame->class_order = (uint8_t)(class_word >> 28);
    frame->data_order = (uint8_t)((class_word >> 24) & 0xfu);
    frame->alignment = (uint8_t)(class_word >> 16);
    frame->class = (uint16_t)class_word;
    frame->dispatch = (int32_t)load_be32(bytes + 20);
    frame->reference = (int32_t)load_be32(bytes + 24);
    frame->class_data = NULL;
    frame->data = NULL;
    frame->block = NULL;
}

/* Bit c of a row is set when frames of class c are allowed from that origin. */
static bool class_is_allowed(uint16_t class, enum frame_origin origin)
{
    static const uint32_t allowed[] = {
        [FROM_MODULE] = 1u << CLASS_QUERY | 1u << CLASS_INFORM | 1u << CLASS_REPLY |
                        1u << CLASS_SUCCESS | 1u << CLASS_FAILURE | 1u << CLASS_BROADCAST,
        [FROM_CENTRAL] = 1u << CLASS_NONE | 1u << CLASS_QUERY | 1u << CLASS_INFORM |
                         1u << CLASS_REPLY | 1u << CLASS_BROADCAST,
        [FROM_PEER] =
            1u << CLASS_QUERY | 1u << CLASS_INFORM | 1u << CLASS_REPLY | 1u << CLASS_BROADCAST,
    };
    return class < 32 && (allowed[origin] >> class & 1u) != 0;
}

static bool order_is_known(uint8_t order)
{
    return order == ORDER_BIG || order == ORDER_LITTLE;
}

const char *frame_violation(const struct frame *frame, enum frame_origin origin,
                            uint32_t limit_class_data, uint32_t limit_data)
{
    if (frame->alignment != 0) {
        return "data is not packed";
    }
    if (!class_is_allowed(frame->class, origin)) {
        return "class is not allowed";
    }
    if (frame->class_length > limit_class_data) {
        return "class length is negative or above the limit";
    }
    if (frame->data_length > limit_data) {
        return "data length is negative or above the limit";
    }
    if ((frame->class_length > 0 && !order_is_known(frame->class_order)) ||
        (frame->data_length > 0 && !order_is_known(frame->data_order))) {
        return "byte order is unknown";
    }
    return NULL;
}
