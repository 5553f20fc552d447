/*
 * What the memory command shows.
 */
#include "central/statistics.h"

#include <inttypes.h>

void statistics_append(const struct server *server, struct buffer *out)
{
    const struct statistics *statistics = &server->statistics;
    text_append(out,
                "Cumulative Memory Usage:\n"
                "  Requests: %" PRIu64 " (%" PRIu64 " bytes)\n"
                "Data Msg Buffer Stats:\n"
                "  Total Alloc  : %" PRIu64 "\n"
                "  Total Freed  : %" PRIu64 "\n"
                "  Min Request  : %" PRIu32 "\n"
                "  Max Request  : %" PRIu32 "\n",
                statistics->n_read, statistics->bytes_read, server->dispatches.n_begun,
                server->dispatches.n_ended, statistics->shortest_body, statistics->longest_body);
    text_append(out,
                "Connections: %" PRIu64 " (at most %" PRIu64 ")\n"
                "Dropped    : %" PRIu64 "\n",
                statistics->n_modules, statistics->peak_modules, statistics->n_dropped);
}
