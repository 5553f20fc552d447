/*
 * Sending user messages: publications, queries and responses.
 */
#ifndef IPC_LIBIPC_PUBLISH_H
#define IPC_LIBIPC_PUBLISH_H

#include "libipc/instance.h"

/* Checks content and its length against the message, with the manual's warnings; IPC_FIXED_LENGTH
 * becomes the message's length. */
IPC_ERROR_TYPE publish_check(const struct message *message, unsigned int *length,
                             const void *content);

/* Publishes so many bytes, which stay the caller's; they are checked. */
IPC_ERROR_TYPE publish(struct _X_IPC_CONTEXT *context, struct message *message, unsigned int length,
                       const void *content);

/* Sends a publication or query to where the message goes: to central, or directly. */
IPC_ERROR_TYPE publish_send(struct _X_IPC_CONTEXT *context, struct frame *frame,
                            struct message *message, const void *content, size_t length);

/* Sends a frame with the message's data to central and waits until it has left. */
IPC_ERROR_TYPE publish_frame(struct _X_IPC_CONTEXT *context, struct frame *frame,
                             const struct message *message, const void *content, size_t length);

/* The same over a direct link, to whose peer the caller holds a reference.  That it breaks meanwhile is of
 * no matter. */
void publish_frame_to(struct peer *peer, struct frame *frame, const struct message *message,
                      const void *content, size_t length);

/* Bytes of a value on its way out. */
struct encoded {
    const void *content; /* the value itself if its format is simple, else scratch */
    size_t length;
    struct buffer buffer; /* the library's scratch while in use */
};

/* Encodes data by the message's format (NULL: no bytes).  The lock is held before and after and
 * given up in between.  Give the bytes back with publish_release, whatever the result. */
IPC_ERROR_TYPE publish_encode(struct library *library, const struct format *format,
                              const void *data, struct encoded *encoded);
void publish_release(struct library *library, struct encoded *encoded);

#endif
