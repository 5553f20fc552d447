/*
 * Ending central, and modules, from a shell [manual 4.49, 4.50].
 *
 * The process is found and asked to end as by the kill command, so whoever may do that
 * may do this; nothing on the wire ends anybody.
 */
#ifndef IPC_LIBIPC_SHELL_H
#define IPC_LIBIPC_SHELL_H

#include "libipc/library.h"

enum shell_result {
    SHELL_ENDED,
    SHELL_NONE,      /* nobody of that name, or no central there */
    SHELL_ELSEWHERE, /* it runs on another machine, or as something that cannot be found */
    SHELL_REFUSED,   /* not allowed */
    SHELL_STAYS,     /* it was asked and has not ended in time */
    SHELL_CANNOT_ASK /* central does not tell where its modules run */
};

/* server NULL or empty: as IPC_connect. */
enum shell_result shell_end_central(const char *server);
enum shell_result shell_end_module(const char *module, const char *server);

#endif
