/*
 * What the memory command shows.
 */
#include "central/operator/statistics.h"

#include <inttypes.h>

/* What waits for all modules together. */
static struct amount waiting(const struct server *server)
{
    const struct table *names = &server->messages.names;
    struct amount sum = {0, 0};
    struct list *outer, *after, *at, *following;
    LIST_EACH (outer, after, &server->modules) {
        const struct module *module = LIST_OWNER(outer, struct module, in_server);
        LIST_EACH (at, following, &module->resources) {
            const struct resource *resource = LIST_OWNER(at, struct resource, in_owner);
            sum.messages +=
                resource->n_ahead + resource->pending.count + resource->holders_own.count;
            sum.bytes +=
                resource->ahead_bytes + resource->pending.bytes + resource->holders_own.bytes;
        }
    }
    for (struct table_entry *entry = table_first(names); entry != NULL;
         entry = table_next(names, entry)) {
        const struct message *message = entry->value;
        sum.messages += message->n_waiting;
        sum.bytes += message->waiting_bytes;
    }
    return sum;
}

void statistics_append(const struct server *server, struct buffer *out)
{
    const struct statistics *statistics = &server->statistics;
    const struct meter *read = &statistics->read;
    text_append(out,
                "Cumulative Memory Usage:\n"
                "  Requests: %" PRIu64 " (%" PRIu64 " bytes)\n"
                "Data Msg Buffer Stats:\n"
                "  Total Alloc  : %" PRIu64 "\n"
                "  Total Freed  : %" PRIu64 "\n"
                "  Min Request  : %" PRIu32 "\n"
                "  Max Request  : %" PRIu32 "\n",
                read->total.messages, read->total.bytes, server->dispatches.n_begun,
                server->dispatches.n_ended, statistics->shortest_body, statistics->longest_body);
    const struct amount sum = waiting(server);
    const struct amount rate = meter_rate(read, server->now_ns);
    text_append(out,
                "Connections: %" PRIu64 " (at most %" PRIu64 ")\n"
                "Per Second : %" PRIu64 " (%" PRIu64 " bytes)\n"
                "Waiting    : %" PRIu64 " (%" PRIu64 " bytes)\n"
                "Dropped    : %" PRIu64 "\n",
                statistics->n_modules, statistics->peak_modules, rate.messages, rate.bytes,
                sum.messages, sum.bytes, statistics->n_dropped);
}
