/*
 * Named limits.
 *
 * Every queue, length, depth and count that a peer or a user can influence is
 * bounded by one of these.  Those that central lets an operator change are
 * defaults here and members of its options there.
 */
#ifndef IPC_BASE_LIMITS_H
#define IPC_BASE_LIMITS_H

#define LIMIT_DATA (256u * 1024 * 1024)     /* bytes of data in one frame */
#define LIMIT_CLASS_DATA (64u * 1024)       /* bytes of class data in one frame */
#define LIMIT_NAME 1024u                    /* bytes of a message, module or handler name */
#define LIMIT_FORMAT_TEXT (64u * 1024)      /* bytes of a format string from a peer */
#define LIMIT_FORMAT_DEPTH 256              /* nesting of a format */
#define LIMIT_FORMAT_NODES 65536            /* nodes of one format, named formats expanded */
#define LIMIT_DATA_DEPTH 10000              /* nesting of a value (lists do not count) */
#define LIMIT_OUT_QUEUE (64u * 1024 * 1024) /* unsent bytes for one module */
#define LIMIT_KNOWN_ARRAYS 4096             /* byte arrays whose length is remembered */
#define LIMIT_HANDSHAKE_MS 10000            /* patience of a module with a silent central */

#endif
