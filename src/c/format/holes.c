/*
 * The parts of a value that decoding does not overwrite by itself.
 */
#include "format/holes.h"

#include "format/type.h"

/* What lies between holes closer than this is cleared with them. */
enum { NEAR = 64 };

static uint32_t end_of(const struct hole *hole)
{
    return hole->offset + hole->length;
}

static void add(struct holes *holes, uint32_t from, uint32_t to)
{
    if (from == to) {
        return;
    }
    struct hole *last = holes->count == 0 ? NULL : &holes->items[holes->count - 1];
    if (last != NULL && (from - end_of(last) < NEAR || holes->count == MOST_HOLES)) {
        last->length = to - last->offset;
    } else {
        holes->items[holes->count++] = (struct hole){.offset = from, .length = to - from};
    }
}

/* Adds what lies between end, up to which all is known, and the simple parts of a type. */
static void visit(struct holes *holes, const struct type *type, uint32_t offset, uint32_t *end)
{
    if (type->simple) {
        if (type->size == 0) {
            return;
        }
        add(holes, *end, offset);
        *end = offset + type->size;
    } else if (type->kind == TYPE_STRUCTURE) {
        for (uint32_t i = 0; i < type->n_members; i++) {
            visit(holes, type->members[i], offset + type->members[i]->offset, end);
        }
    }
}

void holes_find(struct holes *holes, const struct type *type)
{
    uint32_t end = 0;
    holes->count = 0;
    visit(holes, type, 0, &end);
    add(holes, end, type->size);
}
