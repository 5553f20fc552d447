/*
 * Questions to the system's allocator.
 */
#include "platform/platform.h"

#if defined(__GLIBC__) || defined(__linux__)
#include <malloc.h>

size_t memory_usable_size(void *block)
{
    return malloc_usable_size(block);
}
#else
size_t memory_usable_size(void *block)
{
    (void)block;
    return 0;
}
#endif
