/*
 * An input in memory, and the files that its line markers name.
 */
#include "source.h"

#include <stdlib.h>

#include "base/memory.h"

void source_init(struct source *source, const char *name, char *bytes, size_t length)
{
    *source = (struct source){bytes, length, NULL, 0};
    (void)source_add_origin(source, mem_copy_string(name), SOURCE_NOBODY, 0);
}

void source_fini(struct source *source)
{
    for (size_t i = 0; i < source->n_origins; i++) {
        free(source->origins[i].name);
    }
    free(source->origins);
    free(source->bytes);
}

size_t source_add_origin(struct source *source, char *name, size_t includer, size_t includer_line)
{
    const size_t number = source->n_origins++;
    if ((number & (number - 1)) == 0) { /* full whenever a power of two is reached */
        source->origins =
            mem_resize(source->origins, number == 0 ? 1 : 2 * number, sizeof *source->origins);
    }
    source->origins[number] = (struct origin){name, includer, includer_line};
    return number;
}

const struct origin *source_origin(const struct source *source, const struct place *place)
{
    return &source->origins[place->origin];
}

struct text source_line(const struct source *source, const struct place *place)
{
    const size_t start = place->offset - (place->column - 1);
    size_t end = place->offset;
    while (end < source->length && source->bytes[end] != '\n' && source->bytes[end] != '\r') {
        end++;
    }
    return (struct text){source->bytes + start, end - start};
}
