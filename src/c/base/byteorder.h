/*
 * Byte order: the codes that travel in a class word, and loads and stores.
 */
#ifndef IPC_BASE_BYTEORDER_H
#define IPC_BASE_BYTEORDER_H

#include <stdint.h>
#include <string.h>

enum byte_order { ORDER_BIG = 1, ORDER_LITTLE = 2 };

static inline enum byte_order byte_order_of_host(void)
{
    const uint16_t probe = 1;
    uint8_t first;
    memcpy(&first, &probe, 1);
    return first == 1 ? ORDER_LITTLE : ORDER_BIG;
}

static inline uint16_t swap16(uint16_t v)
{
    return (uint16_t)((v >> 8) | (v << 8));
}

static inline uint32_t swap32(uint32_t v)
{
    return (v >> 24) | ((v >> 8) & 0xff00u) | ((v << 8) & 0xff0000u) | (v << 24);
}

static inline uint64_t swap64(uint64_t v)
{
    return ((uint64_t)swap32((uint32_t)v) << 32) | swap32((uint32_t)(v >> 32));
}

static inline uint32_t load_be32(const uint8_t *at)
{
    return ((uint32_t)at[0] << 24) | ((uint32_t)at[1] << 16) | ((uint32_t)at[2] << 8) | at[3];
}

static inline void store_be32(uint8_t *at, uint32_t v)
{
    at[0] = (uint8_t)(v >> 24);
    at[1] = (uint8_t)(v >> 16);
    at[2] = (uint8_t)(v >> 8);
    at[3] = (uint8_t)v;
}

/* Loads four bytes written in the given order. */
static inline uint32_t load_32(const uint8_t *at, enum byte_order order)
{
    uint32_t v;
    memcpy(&v, at, sizeof v);
    return order == byte_order_of_host() ? v : swap32(v);
}

#endif
