/*
 * Internal error codes.
 *
 * Every internal function that can fail returns 0 or one of these; results
 * come through pointers.  Only the API layer of the library turns them into
 * IPC_RETURN_TYPE and IPC_errno, and only central's log turns them into text.
 */
#ifndef IPC_BASE_ERROR_H
#define IPC_BASE_ERROR_H

enum error {
    ERR_NONE = 0,
    ERR_MEMORY = -1,   /* an allocation whose size came from a peer or the user failed */
    ERR_NULL = -2,     /* a pointer that the format needs is NULL */
    ERR_RANGE = -3,    /* a count or number lies outside what its type allows */
    ERR_FORMAT = -4,   /* a format is illegal */
    ERR_CONTENT = -5,  /* bytes do not hold what their format promises */
    ERR_LIMIT = -6,    /* a named limit (base/limits.h) was passed */
    ERR_DEPTH = -7,    /* data or a format is nested too deeply, or cyclic */
    ERR_PROTOCOL = -8, /* a peer broke the wire protocol: close it */
    ERR_CLOSED = -9,   /* the peer has closed the connection */
    ERR_IO = -10,      /* the system refused; errno says why */
    ERR_TIMEOUT = -11, /* the deadline passed */
    ERR_UNKNOWN = -12, /* nothing of that name or number exists */
    ERR_REFUSED = -13  /* access denied, or nobody listens there */
};

/* A short English phrase for a code, never NULL; static storage. */
const char *error_text(int code);

#endif
