/*
 * What stands between the library and Python: calls that would need several steps there.
 *
 * Handlers in Python are known to the library by a number, which is their client data; so nothing
 * of Python can be used after it was freed.  The functions that begin with py_ are Python's.
 */
#include <ipc/ipcx.h>

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Symbols of the library that are not in its headers. */
IPC_RETURN_TYPE _IPC_subscribe(const char *msgName, const char *hndName, HANDLER_TYPE handler,
                               void *clientData, int autoUnmarshall);
IPC_RETURN_TYPE _IPC_unsubscribe(const char *msgName, const char *hndName);
IPC_RETURN_TYPE _IPC_queryResponse(const char *msgName, unsigned int length, BYTE_ARRAY content,
                                   BYTE_ARRAY *replyHandle, FORMATTER_PTR *replyFormatter,
                                   unsigned int timeoutMsecs);
void x_ipcRegisterExitProc(void (*procedure)(void));
int x_ipcGetMaxConnection(void);
void x_ipcCloseInternal(int informServer);
void ipcSetError(IPC_ERROR_TYPE error);
extern IPC_VERBOSITY_TYPE ipcVerbosity;
extern const char *ipcErrorStrings[NUM_ERRORS];

/* ------------------------------------------------------------------ handlers */

static void py_message(MSG_INSTANCE instance, char *content, unsigned int length, int is_big_endian,
                       uintptr_t number);
static void py_descriptor(int fd, uintptr_t number);
static void py_connect(char *module, uintptr_t number);
static void py_disconnect(char *module, uintptr_t number);
static void py_connection(int connected, uintptr_t number);
static void py_change(char *message, int n_handlers, uintptr_t number);
static void py_timer(uintptr_t number, unsigned long now, unsigned long scheduled);
static int py_give_up(void);
static void py_loss(void);

/* Python copies fewer bytes than these, and takes over what has more. */
enum { GLUE_LARGE = 1 << 14 };

static void on_message(MSG_INSTANCE instance, BYTE_ARRAY content, void *number)
{
    unsigned int length = 0;
    int is_big_endian = 0;
    if (content != NULL) {
        (void)IPCx_arrayInfo(content, &length, &is_big_endian); /* known: it has just come */
    }
    py_message(instance, content, length, is_big_endian, (uintptr_t)number);
    if (content != NULL && length < GLUE_LARGE) {
        IPC_freeByteArray(content);
    }
}

static void on_descriptor(int fd, void *number)
{
    py_descriptor(fd, (uintptr_t)number);
}

static void on_connect(const char *module, void *number)
{
    py_connect((char *)(uintptr_t)module, (uintptr_t)number);
}

static void on_disconnect(const char *module, void *number)
{
    py_disconnect((char *)(uintptr_t)module, (uintptr_t)number);
}

static void on_connection(int connected, void *number)
{
    py_connection(connected, (uintptr_t)number);
}

static void on_change(const char *message, int n_handlers, void *number)
{
    py_change((char *)(uintptr_t)message, n_handlers, (uintptr_t)number);
}

static void on_timer(void *number, unsigned long now, unsigned long scheduled)
{
    py_timer((uintptr_t)number, now, scheduled);
}

/* A process that has lost its central goes on, and calls of Python can be ended. */
static void glue_begin(void)
{
    x_ipcRegisterExitProc(py_loss);
    IPCx_setGiveUp(py_give_up);
}

/* Python is about to end: nothing of it may be called any more. */
static void nothing(void)
{
}

static void glue_end(void)
{
    x_ipcRegisterExitProc(nothing);
    IPCx_setGiveUp(NULL);
}

/* --------------------------------------------------------------------- texts */

enum { MAX_TEXTS = 1000 };

/* A text of the library, until Python fetches it. */
struct text {
    struct text *next;
    int kind; /* IPCX_TEXT */
    char bytes[];
};

/* The library says something in the middle of its work, where nothing of Python must run. */
static struct {
    pthread_mutex_t lock;
    struct text *first;
    struct text *last;
    int count;
} texts = {PTHREAD_MUTEX_INITIALIZER, NULL, NULL, 0};

static void keep_text(IPCX_TEXT kind, const char *bytes)
{
    const size_t size = strlen(bytes) + 1;
    struct text *text = malloc(sizeof *text + size);
    pthread_mutex_lock(&texts.lock);
    const bool is_full = text == NULL || texts.count == MAX_TEXTS;
    if (!is_full) {
        text->next = NULL;
        text->kind = kind;
        memcpy(text->bytes, bytes, size);
        *(texts.first != NULL ? &texts.last->next : &texts.first) = text;
        texts.last = text;
        texts.count++;
    }
    pthread_mutex_unlock(&texts.lock);
    if (is_full) {
        fputs(bytes, stderr); /* rather there than nowhere */
        free(text);
    }
}

static void glue_keep_texts(int on)
{
    IPCx_setTextHandler(on ? keep_text : NULL);
}

/* The oldest text, which the caller frees, and its kind; NULL: there is none. */
static struct text *glue_take_text(void)
{
    pthread_mutex_lock(&texts.lock);
    struct text *text = texts.first;
    if (text != NULL) {
        texts.first = text->next;
        texts.count--;
    }
    pthread_mutex_unlock(&texts.lock);
    return text;
}

/* ------------------------------------------------------------- subscriptions */

static IPC_RETURN_TYPE glue_subscribe(const char *message, const char *handler, uintptr_t number)
{
    return _IPC_subscribe(message, handler, on_message, (void *)number, 0);
}

static IPC_RETURN_TYPE glue_unsubscribe(const char *message, const char *handler)
{
    return _IPC_unsubscribe(message, handler);
}

static IPC_RETURN_TYPE glue_query_notify(const char *message, unsigned int length, void *content,
                                         uintptr_t number)
{
    return IPC_queryNotify(message, length, content, on_message, (void *)number);
}

static IPC_RETURN_TYPE glue_subscribe_fd(int fd, uintptr_t number)
{
    return IPC_subscribeFD(fd, on_descriptor, (void *)number);
}

static IPC_RETURN_TYPE glue_unsubscribe_fd(int fd)
{
    return IPC_unsubscribeFD(fd, on_descriptor);
}

/* Watching modules come and go, and subscriptions: one C handler each, which Python spreads. */
static IPC_RETURN_TYPE glue_watch_connect(int on, uintptr_t number)
{
    return on ? IPC_subscribeConnect(on_connect, (void *)number)
              : IPC_unsubscribeConnect(on_connect);
}

static IPC_RETURN_TYPE glue_watch_disconnect(int on, uintptr_t number)
{
    return on ? IPC_subscribeDisconnect(on_disconnect, (void *)number)
              : IPC_unsubscribeDisconnect(on_disconnect);
}

static IPC_RETURN_TYPE glue_watch_connection(int on, uintptr_t number)
{
    return on ? IPCx_subscribeConnection(on_connection, (void *)number)
              : IPCx_unsubscribeConnection(on_connection);
}

static IPC_RETURN_TYPE glue_watch_change(const char *message, int on, uintptr_t number)
{
    return on ? IPC_subscribeHandlerChange(message, on_change, (void *)number)
              : IPC_unsubscribeHandlerChange(message, on_change);
}

static IPC_RETURN_TYPE glue_add_timer(unsigned long delay, long count, uintptr_t number,
                                      TIMER_REF *reference)
{
    return IPC_addTimerGetRef(delay, count, on_timer, (void *)number, reference);
}

/* ------------------------------------------------------------------- queries */

struct reply {
    BYTE_ARRAY content; /* the caller frees it */
    unsigned int length;
    int is_big_endian;
    FORMATTER_PTR formatter;
};

static IPC_RETURN_TYPE glue_query(const char *message, unsigned int length, void *content,
                                  unsigned int timeout, struct reply *reply)
{
    memset(reply, 0, sizeof *reply);
    const IPC_RETURN_TYPE result =
        _IPC_queryResponse(message, length, content, &reply->content, &reply->formatter, timeout);
    if (result == IPC_OK && reply->content != NULL) {
        (void)IPCx_arrayInfo(reply->content, &reply->length, &reply->is_big_endian);
    }
    return result;
}

/* ------------------------------------------------------------ small services */

/*
 * Publishes a message of fixed length from so many bytes.  The library would read as many as the
 * message has, so it is asked first, with none, whether the message has a fixed length at all.
 */
static IPC_RETURN_TYPE glue_publish_fixed(const char *message, unsigned int length, void *content)
{
    const IPC_VERBOSITY_TYPE verbosity = ipcVerbosity;
    const IPC_ERROR_TYPE error_before = IPC_errno;
    IPC_RETURN_TYPE result;
    ipcVerbosity = IPC_Silent;
    IPC_errno = IPC_No_Error;
    result = IPC_publishFixed(message, NULL);
    ipcVerbosity = verbosity;
    if (result == IPC_OK) {
        IPC_errno = error_before;
        return IPC_OK; /* it has no bytes */
    }
    if (IPC_errno != IPC_Null_Argument || content == NULL) {
        ipcSetError(IPC_errno);
        return IPC_Error;
    }
    return IPC_publish(message, length, content);
}

/* Publishes bytes that were encoded in that format, if it is still the message's: the library's result,
 * or GLUE_OTHER_FORMAT. */
enum { GLUE_OTHER_FORMAT = -1 };

static int glue_publish_as(const char *message, FORMATTER_PTR formatter, unsigned int length,
                           void *content)
{
    IPC_errno = IPC_No_Error;
    const FORMATTER_PTR present = IPC_msgFormatter(message);
    if (present == NULL && IPC_errno != IPC_No_Error) {
        return IPC_Error;
    }
    return present == formatter ? (int)IPC_publish(message, length, content) : GLUE_OTHER_FORMAT;
}

/* Writes the descriptors of IPC_getConnections to fds; returns how many there are. */
static int glue_connections(int *fds, int room)
{
    const fd_set set = IPC_getConnections();
    const int max_fd = x_ipcGetMaxConnection();
    int n_fds = 0;
    for (int fd = 0; fd <= max_fd && fd < FD_SETSIZE; fd++) {
        if (FD_ISSET(fd, &set)) {
            if (n_fds < room) {
                fds[n_fds] = fd;
            }
            n_fds++;
        }
    }
    return n_fds;
}

/* The version of the library, if it is compiled into this module. */
static const char *glue_version(void)
{
#ifdef IPC_VERSION
    return IPC_VERSION;
#else
    return NULL;
#endif
}

/* The text that IPC_printData writes for encoded bytes; the caller frees it.  NULL on error. */
static char *glue_print(FORMATTER_PTR formatter, void *bytes, unsigned int length)
{
    void *value = NULL;
    char *text = NULL;
    size_t text_length = 0;
    if (IPCx_unmarshallN(formatter, bytes, length, &value) != IPC_OK) {
        return NULL;
    }
    FILE *stream = open_memstream(&text, &text_length);
    if (stream != NULL) {
        /* A value of no size is nowhere. */
        const IPC_RETURN_TYPE result =
            IPC_printData(formatter, stream, value != NULL ? value : (void *)&text);
        fclose(stream);
        if (result != IPC_OK) {
            free(text);
            text = NULL;
        }
    }
    if (value != NULL) {
        (void)IPC_freeData(formatter, value);
    }
    return text;
}

static void glue_free(void *block)
{
    free(block);
}
