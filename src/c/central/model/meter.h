/*
 * How much goes through a place: in all, and lately.
 *
 * Counting costs a few additions and needs no timer: seconds begin when
 * something is counted.
 */
#ifndef IPC_CENTRAL_METER_H
#define IPC_CENTRAL_METER_H

#include <stdint.h>

struct amount {
    uint64_t messages;
    uint64_t bytes;
};

struct meter {
    struct amount total;
    struct amount second; /* the one that began at second_ns */
    struct amount before; /* the one before; nothing if it was not right before */
    uint64_t second_ns;
};

#define METER_SECOND_NS UINT64_C(1000000000)

static inline void meter_add(struct meter *meter, uint64_t now_ns, uint64_t bytes)
{
    const uint64_t age = now_ns - meter->second_ns;
    if (age >= METER_SECOND_NS) {
        const struct amount nothing = {0, 0};
        meter->before = age < 2 * METER_SECOND_NS ? meter->second : nothing;
        meter->second = nothing;
        meter->second_ns = now_ns;
    }
    meter->total.messages++;
    meter->total.bytes += bytes;
    meter->second.messages++;
    meter->second.bytes += bytes;
}

/* What came in the last whole second, or in the one that has begun if that is more. */
static inline struct amount meter_rate(const struct meter *meter, uint64_t now_ns)
{
    const struct amount nothing = {0, 0};
    const uint64_t age = now_ns - meter->second_ns;
    if (age < METER_SECOND_NS && meter->before.messages > meter->second.messages) {
        return meter->before;
    }
    return age < 2 * METER_SECOND_NS ? meter->second : nothing;
}

#endif
