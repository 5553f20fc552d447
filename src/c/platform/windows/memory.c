/*
 * Questions to the system's allocator, on Windows.
 */
#include "platform/platform.h"

#include <malloc.h>

size_t memory_usable_size(void *block)
{
    return block == NULL ? 0 : _msize(block);
}
