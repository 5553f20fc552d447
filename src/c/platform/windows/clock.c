/*
 * The monotonic clock on Windows.
 */
#include "platform/platform.h"

#include "platform/windows/system.h"

uint64_t clock_ns(void)
{
    LARGE_INTEGER frequency;
    LARGE_INTEGER now;
    (void)QueryPerformanceFrequency(&frequency); /* neither can fail */
    (void)QueryPerformanceCounter(&now);
    const uint64_t a_second = (uint64_t)frequency.QuadPart;
    const uint64_t ticks = (uint64_t)now.QuadPart;
    return ticks / a_second * 1000000000u + ticks % a_second * 1000000000u / a_second;
}
