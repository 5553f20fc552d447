/*
 * English phrases for the internal error codes.
 */
#include "base/error.h"

const char *error_text(int code)
{
    switch (code) {
    case ERR_NONE:
        return "no error";
    case ERR_MEMORY:
        return "out of memory";
    case ERR_NULL:
        return "a pointer is NULL";
    case ERR_RANGE:
        return "a number is out of range";
    case ERR_FORMAT:
        return "illegal format";
    case ERR_CONTENT:
        return "content does not match its format";
    case ERR_LIMIT:
        return "a limit was exceeded";
    case ERR_DEPTH:
        return "nested too deeply";
    case ERR_PROTOCOL:
        return "protocol violation";
    case ERR_CLOSED:
        return "connection closed";
    case ERR_IO:
        return "input or output failed";
    case ERR_TIMEOUT:
        return "timed out";
    case ERR_UNKNOWN:
        return "unknown name or number";
    case ERR_REFUSED:
        return "refused";
    default:
        return "unknown error";
    }
}
