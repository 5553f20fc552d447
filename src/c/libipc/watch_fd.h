/*
 * Descriptors of the user that listening calls watch.
 */
#ifndef IPC_LIBIPC_WATCH_FD_H
#define IPC_LIBIPC_WATCH_FD_H

#include "libipc/source.h"

struct watched_fd {
    struct source source; /* in library->watched_fds, ascending by fd */
    FD_HANDLER_TYPE handler;
    void *client_data;
    struct _X_IPC_CONTEXT *context; /* current at the subscription; NULL: none was */
    bool ready;                     /* found readable, handler not called yet */
    bool broken;                    /* found not open */
};

/* Watches fd, or replaces handler and client data with a warning. */
void watch_fd_add(struct library *library, int fd, FD_HANDLER_TYPE handler, void *client_data);
void watch_fd_remove(struct library *library, int fd);

/* Calls the handlers of ready descriptors in ascending order, at most limit of them; how many it called. */
int watch_fd_run_ready(struct library *library, int limit);

/* Looks without waiting which descriptors are ready. */
void watch_fd_poll(struct library *library);

/* A watched descriptor that is not open, or -1. */
int watch_fd_broken(const struct library *library);

void watch_fd_clear(struct library *library);

#endif
