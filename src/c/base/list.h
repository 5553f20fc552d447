/*
 * Intrusive doubly linked list.
 *
 * The link stands inside the thing that is listed, so that nothing is allocated
 * and anything can leave its list without a search.  A list is a ring through
 * its head; a link that is in no list points to itself.
 */
#ifndef IPC_BASE_LIST_H
#define IPC_BASE_LIST_H

#include <stdbool.h>
#include <stddef.h>

struct list {
    struct list *next;
    struct list *previous;
};

/* The struct of the given type whose member is the link at pointer. */
#define LIST_OWNER(pointer, type, member)                                                          \
    ((type *)(void *)((char *)(pointer) - offsetof(type, member)))

/* Visits every link; the current one may leave the list while it is visited. */
#define LIST_EACH(position, following, head)                                                       \
    for ((position) = (head)->next, (following) = (position)->next; (position) != (head);          \
         (position) = (following), (following) = (position)->next)

static inline void list_init(struct list *list)
{
    list->next = list;
    list->previous = list;
}

static inline bool list_is_empty(const struct list *list)
{
    return list->next == list;
}

/* Inserts link before position; before the head means at the end. */
static inline void list_insert(struct list *position, struct list *link)
{
    link->previous = position->previous;
    link->next = position;
    position->previous->next = link;
    position->previous = link;
}

static inline void list_append(struct list *head, struct list *link)
{
    list_insert(head, link);
}

static inline void list_prepend(struct list *head, struct list *link)
{
    list_insert(head->next, link);
}

/* Takes link out of its list; harmless for a link that is in none. */
static inline void list_remove(struct list *link)
{
    link->previous->next = link->next;
    link->next->previous = link->previous;
    list_init(link);
}

#endif
