/*
 * Taps: a second message that carries the data of each instance of a first one.
 */
#include "central/routing/tap.h"

#include <stdlib.h>

#include "base/error.h"
#include "base/memory.h"
#include "central/routing/value.h"

static struct tap_entry *find(const struct message *tapped, const struct message *listening,
                              int condition, size_t *count)
{
    struct tap_entry *found = NULL;
    struct list *at, *following;
    *count = 0;
    LIST_EACH (at, following, &tapped->taps) {
        struct tap_entry *tap = LIST_OWNER(at, struct tap_entry, in_message);
        if (tap->listening == listening && tap->condition == condition) {
            found = tap;
        }
        ++*count;
    }
    return found;
}

static struct message *message_of(const struct table_entry *entry)
{
    return entry->value;
}

/* Tells everybody which messages are tapped. */
static void tell(struct server *server)
{
    struct name_list list = {0, 0, NULL};
    const struct table *names = &server->messages.names;
    list.names = mem_new(names->count * sizeof *list.names);
    for (struct table_entry *at = table_first(names); at != NULL; at = table_next(names, at)) {
        if (!list_is_empty(&message_of(at)->taps)) {
            list.names[list.used++] = message_of(at)->name;
        }
    }
    list.room = list.used;
    value_set_own(server, server->tapped, &list);
    free(list.names);
}

int tap_add(struct server *server, struct message *tapped, struct message *listening, int condition)
{
    size_t count;
    if (find(tapped, listening, condition, &count) != NULL) {
        return 0;
    }
    if (count >= LIMIT_TAPS) {
        return ERR_LIMIT;
    }
    struct tap_entry *tap = mem_new(sizeof *tap);
    tap->condition = condition;
    tap->listening = listening;
    list_append(&tapped->taps, &tap->in_message);
    if (count == 0) {
        tell(server);
    }
    return 0;
}

int tap_remove(struct server *server, struct message *tapped, const struct message *listening,
               int condition)
{
    size_t count;
    struct tap_entry *tap = find(tapped, listening, condition, &count);
    if (tap == NULL) {
        return ERR_UNKNOWN;
    }
    list_remove(&tap->in_message);
    free(tap);
    if (count == 1) {
        tell(server);
    }
    return 0;
}

void tap_free_all(struct server *server)
{
    const struct table *names = &server->messages.names;
    struct list *inner, *after;
    for (struct table_entry *at = table_first(names); at != NULL; at = table_next(names, at)) {
        LIST_EACH (inner, after, &message_of(at)->taps) {
            free(LIST_OWNER(inner, struct tap_entry, in_message));
        }
    }
}
