/*
 * The server's numbers, for programs that watch over it.
 */
#include "central/operator/metrics.h"

#include <inttypes.h>

#define COUNTER "counter"
#define GAUGE "gauge"

static void describe(struct buffer *out, const char *name, const char *type, const char *help)
{
    text_append(out, "# HELP ipc_central_%s %s\n# TYPE ipc_central_%s %s\n", name, help, name,
                type);
}

static void show(struct buffer *out, const char *name, const char *type, const char *help,
                 uint64_t number)
{
    describe(out, name, type, help);
    text_append(out, "ipc_central_%s %" PRIu64 "\n", name, number);
}

static void show_uptime(const struct server *server, struct buffer *out)
{
    const uint64_t ms = (server->now_ns - server->start_ns) / 1000000u;
    describe(out, "uptime_seconds", GAUGE, "Time since the start.");
    text_append(out, "ipc_central_uptime_seconds %" PRIu64 ".%03u\n", ms / 1000,
                (unsigned)(ms % 1000));
}

static void show_connections(const struct server *server, struct buffer *out)
{
    const struct statistics *statistics = &server->statistics;
    show(out, "modules", GAUGE, "Modules that are connected.",
         statistics->n_modules - server->n_greeted);
    show(out, "connections", GAUGE, "Connections, those without a name included.",
         statistics->n_modules);
    show(out, "connections_peak", GAUGE, "The most connections that there have been at a time.",
         statistics->peak_modules);
    show(out, "connections_total", COUNTER, "Connections that were accepted.",
         statistics->n_accepted);
    describe(out, "refused_total", COUNTER, "Newcomers that were refused.");
    text_append(out,
                "ipc_central_refused_total{reason=\"access\"} %" PRIu64 "\n"
                "ipc_central_refused_total{reason=\"descriptors\"} %" PRIu64 "\n",
                statistics->n_refused, statistics->n_without_descriptor);
}

static void show_messages(const struct server *server, struct buffer *out)
{
    const struct statistics *statistics = &server->statistics;
    const struct dispatch_pool *dispatches = &server->dispatches;
    const struct amount *read = &statistics->read.total;
    show(out, "messages_total", COUNTER, "Messages that modules have sent.", read->messages);
    show(out, "message_bytes_total", COUNTER, "Bytes of these, headers not counted.", read->bytes);
    show(out, "deliveries_total", COUNTER, "Deliveries begun: one for each handler of a message.",
         dispatches->n_begun);
    show(out, "deliveries", GAUGE, "Deliveries that are under way or wait.",
         dispatches->n_begun - dispatches->n_ended);
    show(out, "queued_messages", GAUGE, "Deliveries that wait in the queues of modules.",
         server->places.count);
    show(out, "queued_bytes", GAUGE, "Data of these.", server->places.bytes);
    show(out, "dropped_total", COUNTER, "Deliveries given up because a queue was full.",
         statistics->n_dropped);
}

void metrics_append(const struct server *server, struct buffer *out)
{
    show_uptime(server, out);
    show_connections(server, out);
    show_messages(server, out);
}
