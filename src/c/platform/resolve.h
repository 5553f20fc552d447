/*
 * Names of addresses, looked up without waiting for them.
 *
 * The system's look-up takes as long as it takes, so each runs in a thread of its
 * own and wakes who asked for it.  A name counts only if it leads back to the
 * address: whoever owns an address may call it what he likes.
 */
#ifndef IPC_PLATFORM_RESOLVE_H
#define IPC_PLATFORM_RESOLVE_H

#include <stdbool.h>
#include <stdint.h>

#include "platform/platform.h"

struct resolver;
struct look_up;

/* The waker is woken whenever a look-up is done. */
struct resolver *resolver_new(const struct waker *waker);

/* Nobody is woken any more; all look-ups have to be forgotten before.  NULL is fine. */
void resolver_free(struct resolver *resolver);

/* Begins to look up the name of a numeric address; NULL when as many as may are under way. */
struct look_up *resolver_ask(struct resolver *resolver, const char *address);

/* How many look-ups have ended so far: it changes whenever one is done. */
uint64_t resolver_n_done(struct resolver *resolver);

bool look_up_is_done(struct look_up *look_up);

/* The name, once it is done; "" if the address has none. */
const char *look_up_name(const struct look_up *look_up);

/* Lets go of it, done or not. */
void look_up_forget(struct look_up *look_up);

#endif
