/*
 * What all API functions have in common: entering, checking, and leaving.
 */
#ifndef IPC_LIBIPC_API_H
#define IPC_LIBIPC_API_H

#include "libipc/context.h"
#include "libipc/report_result.h"

/* An API call under way: the lock is held from api_enter to api_leave. */
struct api {
    struct library *library;
    struct _X_IPC_CONTEXT *context; /* the current one, NULL on failure */
};

static inline bool api_is_missing(const char *name)
{
    return name == NULL || *name == '\0';
}

/* IPC_No_Error, or IPC_Not_Connected when there is no connection (the call is entered all the same).
 * Where calls wait for central to come back, this is where they do. */
IPC_ERROR_TYPE api_enter(struct api *api);

/* The same for calls that can do with a context that is away (libipc/reconnect.h). */
IPC_ERROR_TYPE api_enter_live(struct api *api);

/* Leaves and reports the result.  If a connection was lost meanwhile, that is reported first. */
IPC_RETURN_TYPE api_leave(struct api *api, IPC_ERROR_TYPE error);

/* Checks of functions that marshall before they send: the library must be initialised. */
IPC_ERROR_TYPE api_enter_to_marshall(struct api *api);

/* Whether the program wants a call to end that would listen once more. */
bool api_is_given_up(void);

#endif
