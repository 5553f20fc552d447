/*
 * Compiles only if ipc.h declares what programs of CMU IPC 3.9.1 were compiled
 * with: the same values, sizes, types, and prototypes.
 *
 * Valid C89 and C++98; the tests compile it as each language standard.
 */
#include <stddef.h>

#include "ipc.h"

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)

/* An array of negative size if the condition does not hold. */
#define CHECK(condition) extern char JOIN(check_, __LINE__)[(condition) ? 1 : -1]

/* A pointer of the expected type, set to the function. */
#define FUNCTION(name, result, arguments)                                                          \
    extern result(*const JOIN(name, _p)) arguments;                                                \
    result(*const JOIN(name, _p)) arguments = name;

/* ------------------------------------------------------------ constants */

CHECK(IPC_WAIT_FOREVER == 0xFFFFFFFFu);
CHECK(IPC_VARIABLE_LENGTH == 0xFFFFFFFFu);
CHECK(IPC_FIXED_LENGTH == 0xFFFFFFFEu);
CHECK(NUM_ERRORS == 12);
CHECK(TRIGGER_FOREVER == -1);

CHECK(sizeof(IPC_RETURN_TYPE) == 4);
CHECK(IPC_Error == 0);
CHECK(IPC_OK == 1);
CHECK(IPC_Timeout == 2);

CHECK(sizeof(IPC_ERROR_TYPE) == 4);
CHECK(IPC_No_Error == 0);
CHECK(IPC_Not_Connected == 1);
CHECK(IPC_Not_Initialized == 2);
CHECK(IPC_Message_Not_Defined == 3);
CHECK(IPC_Not_Fixed_Length == 4);
CHECK(IPC_Message_Lengths_Differ == 5);
CHECK(IPC_Argument_Out_Of_Range == 6);
CHECK(IPC_Null_Argument == 7);
CHECK(IPC_Illegal_Formatter == 8);
CHECK(IPC_Mismatched_Formatter == 9);
CHECK(IPC_Wrong_Buffer_Length == 10);
CHECK(IPC_Communication_Error == 11);

CHECK(sizeof(IPC_VERBOSITY_TYPE) == 4);
CHECK(IPC_Silent == 0);
CHECK(IPC_Print_Warnings == 1);
CHECK(IPC_Print_Errors == 2);
CHECK(IPC_Exit_On_Errors == 3);

/* ---------------------------------------------------------------- types */

CHECK(sizeof(IPC_VARCONTENT_TYPE) == 2 * sizeof(void *));
CHECK(offsetof(IPC_VARCONTENT_TYPE, length) == 0);
CHECK(offsetof(IPC_VARCONTENT_TYPE, content) == sizeof(void *));
CHECK(sizeof(((IPC_VARCONTENT_TYPE *)0)->length) == 4);

/* Types are equal if a pointer to one is a pointer to the other. */
#define SAME_TYPE(name, type)                                                                      \
    extern type *const JOIN(same_, __LINE__);                                                      \
    type *const JOIN(same_, __LINE__) = (name *)0;

struct _X_IPC_REF;
struct _X_IPC_CONTEXT;
struct _FORMAT_TYPE;

typedef void *pointer;
typedef struct _X_IPC_REF *reference;
typedef struct _X_IPC_CONTEXT *context;
typedef const struct _FORMAT_TYPE *formatter;
typedef IPC_VARCONTENT_TYPE *varcontent;
typedef void (*handler)(reference, void *, void *);
typedef void (*fd_handler)(int, void *);
typedef void (*connect_handler)(const char *, void *);
typedef void (*change_handler)(const char *, int, void *);
typedef void (*timer_handler)(void *, unsigned long, unsigned long);

SAME_TYPE(BYTE_ARRAY, pointer)
SAME_TYPE(IPC_VARCONTENT_PTR, varcontent)
SAME_TYPE(MSG_INSTANCE, reference)
SAME_TYPE(IPC_CONTEXT_PTR, context)
SAME_TYPE(FORMATTER_PTR, formatter)
SAME_TYPE(HANDLER_TYPE, handler)
SAME_TYPE(HANDLER_DATA_TYPE, handler)
SAME_TYPE(FD_HANDLER_TYPE, fd_handler)
SAME_TYPE(CONNECT_HANDLE_TYPE, connect_handler)
SAME_TYPE(CHANGE_HANDLE_TYPE, change_handler)
SAME_TYPE(TIMER_HANDLER_TYPE, timer_handler)
SAME_TYPE(TIMER_REF, pointer)

/* ---------------------------------------------------- variable, functions */

extern IPC_ERROR_TYPE *const errno_p;
IPC_ERROR_TYPE *const errno_p = &IPC_errno;

#if defined(__cplusplus)
extern "C" {
#endif

/* Programs use the macro for functions of their own. */
IPC_EXTERN_FUNCTION(int own_function, (int argument));

FUNCTION(IPC_initialize, IPC_RETURN_TYPE, (void))
FUNCTION(IPC_connectModule, IPC_RETURN_TYPE, (const char *, const char *))
FUNCTION(IPC_connect, IPC_RETURN_TYPE, (const char *))
FUNCTION(IPC_connectModuleNoListen, IPC_RETURN_TYPE, (const char *, const char *))
FUNCTION(IPC_connectNoListen, IPC_RETURN_TYPE, (const char *))
FUNCTION(IPC_disconnect, IPC_RETURN_TYPE, (void))
FUNCTION(IPC_isConnected, int, (void))
FUNCTION(IPC_isModuleConnected, int, (const char *))
FUNCTION(IPC_getConnections, fd_set, (void))
FUNCTION(IPC_defineMsg, IPC_RETURN_TYPE, (const char *, unsigned int, const char *))
FUNCTION(IPC_isMsgDefined, int, (const char *))
FUNCTION(IPC_publish, IPC_RETURN_TYPE, (const char *, unsigned int, BYTE_ARRAY))
FUNCTION(IPC_publishVC, IPC_RETURN_TYPE, (const char *, IPC_VARCONTENT_PTR))
FUNCTION(IPC_publishFixed, IPC_RETURN_TYPE, (const char *, BYTE_ARRAY))
FUNCTION(IPC_msgInstanceName, const char *, (MSG_INSTANCE))
FUNCTION(IPC_subscribe, IPC_RETURN_TYPE, (const char *, HANDLER_TYPE, void *))
FUNCTION(IPC_subscribeData, IPC_RETURN_TYPE, (const char *, HANDLER_DATA_TYPE, void *))
FUNCTION(IPC_unsubscribe, IPC_RETURN_TYPE, (const char *, HANDLER_TYPE))
FUNCTION(IPC_subscribeFD, IPC_RETURN_TYPE, (int, FD_HANDLER_TYPE, void *))
FUNCTION(IPC_unsubscribeFD, IPC_RETURN_TYPE, (int, FD_HANDLER_TYPE))
FUNCTION(IPC_listen, IPC_RETURN_TYPE, (unsigned int))
FUNCTION(IPC_listenClear, IPC_RETURN_TYPE, (unsigned int))
FUNCTION(IPC_listenWait, IPC_RETURN_TYPE, (unsigned int))
FUNCTION(IPC_handleMessage, IPC_RETURN_TYPE, (unsigned int))
FUNCTION(IPC_dispatch, IPC_RETURN_TYPE, (void))
FUNCTION(IPC_dataLength, unsigned int, (MSG_INSTANCE))
FUNCTION(IPC_perror, void, (const char *))
FUNCTION(IPC_setCapacity, IPC_RETURN_TYPE, (int))
FUNCTION(IPC_setMsgQueueLength, IPC_RETURN_TYPE, (const char *, int))
FUNCTION(IPC_setMsgPriority, IPC_RETURN_TYPE, (const char *, int))
FUNCTION(IPC_setVerbosity, IPC_RETURN_TYPE, (IPC_VERBOSITY_TYPE))
FUNCTION(IPC_subscribeConnect, IPC_RETURN_TYPE, (CONNECT_HANDLE_TYPE, void *))
FUNCTION(IPC_subscribeDisconnect, IPC_RETURN_TYPE, (CONNECT_HANDLE_TYPE, void *))
FUNCTION(IPC_unsubscribeConnect, IPC_RETURN_TYPE, (CONNECT_HANDLE_TYPE))
FUNCTION(IPC_unsubscribeDisconnect, IPC_RETURN_TYPE, (CONNECT_HANDLE_TYPE))
FUNCTION(IPC_subscribeHandlerChange, IPC_RETURN_TYPE, (const char *, CHANGE_HANDLE_TYPE, void *))
FUNCTION(IPC_unsubscribeHandlerChange, IPC_RETURN_TYPE, (const char *, CHANGE_HANDLE_TYPE))
FUNCTION(IPC_numHandlers, int, (const char *))
FUNCTION(IPC_respond, IPC_RETURN_TYPE, (MSG_INSTANCE, const char *, unsigned int, BYTE_ARRAY))
FUNCTION(IPC_delayResponse, IPC_RETURN_TYPE, (MSG_INSTANCE))
FUNCTION(IPC_queryNotify, IPC_RETURN_TYPE,
         (const char *, unsigned int, BYTE_ARRAY, HANDLER_TYPE, void *))
FUNCTION(IPC_queryResponse, IPC_RETURN_TYPE,
         (const char *, unsigned int, BYTE_ARRAY, BYTE_ARRAY *, unsigned int))
FUNCTION(IPC_respondVC, IPC_RETURN_TYPE, (MSG_INSTANCE, const char *, IPC_VARCONTENT_PTR))
FUNCTION(IPC_queryNotifyVC, IPC_RETURN_TYPE,
         (const char *, IPC_VARCONTENT_PTR, HANDLER_TYPE, void *))
FUNCTION(IPC_queryResponseVC, IPC_RETURN_TYPE,
         (const char *, IPC_VARCONTENT_PTR, BYTE_ARRAY *, unsigned int))
FUNCTION(IPC_parseFormat, FORMATTER_PTR, (const char *))
FUNCTION(IPC_defineFormat, IPC_RETURN_TYPE, (const char *, const char *))
FUNCTION(IPC_checkMsgFormats, IPC_RETURN_TYPE, (const char *, const char *))
FUNCTION(IPC_msgFormatter, FORMATTER_PTR, (const char *))
FUNCTION(IPC_msgInstanceFormatter, FORMATTER_PTR, (MSG_INSTANCE))
FUNCTION(IPC_marshall, IPC_RETURN_TYPE, (FORMATTER_PTR, void *, IPC_VARCONTENT_PTR))
FUNCTION(IPC_unmarshall, IPC_RETURN_TYPE, (FORMATTER_PTR, BYTE_ARRAY, void **))
FUNCTION(IPC_unmarshallData, IPC_RETURN_TYPE, (FORMATTER_PTR, BYTE_ARRAY, void *, int))
FUNCTION(IPC_freeByteArray, void, (BYTE_ARRAY))
FUNCTION(IPC_freeData, IPC_RETURN_TYPE, (FORMATTER_PTR, void *))
FUNCTION(IPC_freeDataElements, IPC_RETURN_TYPE, (FORMATTER_PTR, void *))
FUNCTION(IPC_publishData, IPC_RETURN_TYPE, (const char *, void *))
FUNCTION(IPC_respondData, IPC_RETURN_TYPE, (MSG_INSTANCE, const char *, void *))
FUNCTION(IPC_queryNotifyData, IPC_RETURN_TYPE, (const char *, void *, HANDLER_TYPE, void *))
FUNCTION(IPC_queryResponseData, IPC_RETURN_TYPE, (const char *, void *, void **, unsigned int))
FUNCTION(IPC_printData, IPC_RETURN_TYPE, (FORMATTER_PTR, FILE *, void *))
FUNCTION(IPC_readData, IPC_RETURN_TYPE, (FORMATTER_PTR, FILE *, void **))
FUNCTION(IPC_getContext, IPC_CONTEXT_PTR, (void))
FUNCTION(IPC_setContext, IPC_RETURN_TYPE, (IPC_CONTEXT_PTR))
FUNCTION(IPC_addTimer, IPC_RETURN_TYPE, (unsigned long, long, TIMER_HANDLER_TYPE, void *))
FUNCTION(IPC_addTimerGetRef, IPC_RETURN_TYPE,
         (unsigned long, long, TIMER_HANDLER_TYPE, void *, TIMER_REF *))
FUNCTION(IPC_addOneShotTimer, IPC_RETURN_TYPE, (long, TIMER_HANDLER_TYPE, void *))
FUNCTION(IPC_addPeriodicTimer, IPC_RETURN_TYPE, (long, TIMER_HANDLER_TYPE, void *))
FUNCTION(IPC_removeTimer, IPC_RETURN_TYPE, (TIMER_HANDLER_TYPE))
FUNCTION(IPC_removeTimerByRef, IPC_RETURN_TYPE, (TIMER_REF))

#if defined(__cplusplus)
}
#endif
