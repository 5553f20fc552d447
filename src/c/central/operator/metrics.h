/*
 * The server's numbers, for programs that watch over it.
 *
 * The text is Prometheus' exposition format, version 0.0.4.  Every number is kept
 * anyway, so that showing them costs the same however many modules there are.
 */
#ifndef IPC_CENTRAL_METRICS_H
#define IPC_CENTRAL_METRICS_H

#include "central/routing/server.h"

void metrics_append(const struct server *server, struct buffer *out);

#endif
