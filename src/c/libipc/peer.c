/*
 * Peers.
 */
#include "libipc/peer.h"

#include <stdlib.h>

#include "base/memory.h"
#include "libipc/report.h"
#include "libipc/wait.h"

struct peer *peer_new(struct _X_IPC_CONTEXT *context, const struct source_kind *kind, int fd,
                      bool incoming)
{
    struct peer *peer = mem_new(sizeof *peer);
    peer->context = context;
    peer->incoming = incoming;
    peer->references = 1;
    link_init(&peer->link, fd, FROM_PEER);
    list_append(&context->peers, &peer->in_context);
    if (fd > context->library->max_fd) {
        context->library->max_fd = fd;
    }
    source_init(&peer->source, kind, fd);
    wait_add(context->library, &peer->source);
    return peer;
}

struct peer *peer_ref(struct peer *peer)
{
    peer->references++;
    return peer;
}

void peer_unref(struct peer *peer)
{
    if (peer != NULL && --peer->references == 0) {
        free(peer->host);
        free(peer);
    }
}

void peer_close(struct peer *peer)
{
    if (peer->link.fd >= 0) {
        wait_remove(peer->context->library, &peer->source);
        link_fini(&peer->link);
        list_remove(&peer->in_context);
        wait_wake(peer->context->library); /* for those that wait for it to take bytes */
        peer_unref(peer);
    }
}

void peer_end(struct peer *peer)
{
    if (peer->link.fd >= 0) {
        report_warning("Closed Connection Detected from: Module: sd: %d:\n", peer->link.fd);
        peer_close(peer);
    }
}

void peer_flush(struct peer *peer)
{
    if (peer->link.fd >= 0 && link_flush(&peer->link) < 0) {
        peer_end(peer);
    }
}

void peer_drain(struct peer *peer, uint64_t mark)
{
    struct _X_IPC_CONTEXT *context = peer->context;
    context->draining++;
    const bool broken = peer->link.fd >= 0 && link_flush(&peer->link) < 0;
    bool given_up = false; /* then it leaves later */
    while (!broken && !given_up && peer->link.fd >= 0 && peer->link.written < mark) {
        given_up = !wait_turn(context->library, NO_DEADLINE) && link_keep_borrowed(&peer->link);
    }
    context->draining--;
    if (broken) {
        peer_end(peer);
    }
}
