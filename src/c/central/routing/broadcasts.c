/*
 * The list of active broadcasts.
 */
#include "central/routing/broadcasts.h"

#include <stdlib.h>

#include "base/memory.h"
#include "central/routing/value.h"

bool broadcasts_put(struct server *server, struct message *message, size_t n_subscriptions)
{
    const bool belongs =
        n_subscriptions > 0 && (!message_is_defined(message) || message->class == CLASS_BROADCAST);
    if (belongs == message->listed) {
        return false;
    }
    message->listed = belongs;
    if (belongs) {
        list_append(&server->active_broadcasts, &message->in_broadcasts);
        server->n_active_broadcasts++;
    } else {
        list_remove(&message->in_broadcasts);
        server->n_active_broadcasts--;
    }
    return true;
}

void broadcasts_tell(struct server *server)
{
    if (server->broadcasts == NULL) {
        return; /* the server is still being made */
    }
    struct name_list list = {0, 0, NULL};
    list.names = mem_new(server->n_active_broadcasts * sizeof *list.names);
    struct list *at, *following;
    LIST_EACH (at, following, &server->active_broadcasts) {
        list.names[list.used++] = LIST_OWNER(at, struct message, in_broadcasts)->name;
    }
    list.room = list.used;
    value_set_own(server, server->broadcasts, &list);
    free(list.names);
}

void broadcasts_update(struct server *server, struct message *message, size_t n_subscriptions)
{
    if (broadcasts_put(server, message, n_subscriptions)) {
        broadcasts_tell(server);
    }
}
