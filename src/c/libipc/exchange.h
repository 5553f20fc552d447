/*
 * Frames between this module and central: sending, and asking.
 *
 * Every function returns IPC_Not_Connected when the connection is gone or goes
 * while it waits, and IPC_Communication_Error when a write finds it gone.  Where calls
 * wait for central to come back, asking and notices do, and succeed.
 */
#ifndef IPC_LIBIPC_EXCHANGE_H
#define IPC_LIBIPC_EXCHANGE_H

#include "libipc/context.h"

/* The next number for a frame of class query, inform or broadcast. */
int32_t exchange_reference(struct _X_IPC_CONTEXT *context);

/* A frame with this module's numbers filled in: reference, parent, intent. */
void exchange_frame(struct _X_IPC_CONTEXT *context, struct frame *frame, enum frame_class class,
                    int32_t intent);

/* Whether the context is connected; if its program wants calls to wait, after waiting for that. */
bool exchange_await_central(struct _X_IPC_CONTEXT *context);

/* Whether a call that began over that connection has failed with it and is to be made again: if calls
 * wait, and the connection is there again, after waiting for it. */
bool exchange_again(struct _X_IPC_CONTEXT *context, unsigned connection);

/* Writes what is queued as far as the kernel takes it. */
IPC_ERROR_TYPE exchange_flush(struct _X_IPC_CONTEXT *context);

/* Waits until everything up to mark (of link_queue_borrowed, or link.queued) has been written. */
IPC_ERROR_TYPE exchange_drain(struct _X_IPC_CONTEXT *context, uint64_t mark);

/* Sends a notice.  What it says has been noted in the context before, so that the handshake tells it
 * to a central that comes back. */
IPC_ERROR_TYPE exchange_notice(struct _X_IPC_CONTEXT *context, enum library_message which,
                               const void *payload);

/*
 * Asks central.  reply (size of the reply's format) is zero on failure; what it
 * points to is released with format_release(catalogue.reply[which], reply).
 */
IPC_ERROR_TYPE exchange_ask(struct _X_IPC_CONTEXT *context, enum library_message which,
                            const void *payload, void *reply);

/* Queues a request without waiting, for several at once; awaited is the caller's. */
IPC_ERROR_TYPE exchange_queue_request(struct _X_IPC_CONTEXT *context, int32_t message_id,
                                      const struct format *format, const void *payload,
                                      struct awaited *awaited);

/* Queues a notice if central knows such. */
void exchange_tell(struct _X_IPC_CONTEXT *context, enum library_message which, const void *payload);

/* Queues a notice to a message whose number is known. */
IPC_ERROR_TYPE exchange_queue_notice(struct _X_IPC_CONTEXT *context, int32_t message_id,
                                     const struct format *format, const void *payload);

/* Waits for the answer until the deadline: IPC_No_Error when done, or failed as said above; sets
 * *timed_out (may be NULL for no deadline).  An answer that comes later is dropped. */
IPC_ERROR_TYPE exchange_await(struct _X_IPC_CONTEXT *context, struct awaited *awaited,
                              uint64_t deadline_ns, bool *timed_out);

/* Decodes the answer into reply and releases the answer. */
IPC_ERROR_TYPE exchange_decode(struct awaited *awaited, const struct format *format, void *reply);

/* Forgets a request that is no longer awaited and frees its answer. */
void exchange_forget(struct _X_IPC_CONTEXT *context, struct awaited *awaited);

#endif
