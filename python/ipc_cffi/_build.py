"""Describes the extension module ipc_cffi._ffi, out of line in API mode, for cffi and setuptools.

The library is compiled into the module, from the sources of the project that this file lies in.
If the environment variable IPC_CFFI_LIBRARY is set, the module links with a libipc that is
installed: with the value "system" where the compiler finds it, else below that prefix.
"""
import glob
import os
import re

from cffi import FFI

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
LAYERS = ("base", "platform", "platform/posix", "format", "wire", "link", "libipc")

CDEF = """
typedef int... IPC_RETURN_TYPE;
typedef int... IPC_ERROR_TYPE;
typedef struct _X_IPC_REF *MSG_INSTANCE;
typedef struct _X_IPC_CONTEXT *IPC_CONTEXT_PTR;
typedef ... *FORMATTER_PTR;
typedef void *TIMER_REF;

extern IPC_ERROR_TYPE IPC_errno;
extern const char *ipcErrorStrings[];
void ipcSetError(IPC_ERROR_TYPE error);
void IPC_perror(const char *msg);
IPC_RETURN_TYPE IPC_setVerbosity(int verbosity);

IPC_RETURN_TYPE IPC_initialize(void);
IPC_RETURN_TYPE IPC_connectModule(const char *, const char *);
IPC_RETURN_TYPE IPC_connectModuleNoListen(const char *, const char *);
IPC_RETURN_TYPE IPCx_tryConnect(const char *, const char *);
IPC_RETURN_TYPE IPC_disconnect(void);
int IPC_isConnected(void);
int IPC_isModuleConnected(const char *);
IPC_CONTEXT_PTR IPC_getContext(void);
IPC_RETURN_TYPE IPC_setContext(IPC_CONTEXT_PTR);
void x_ipcCloseInternal(int informServer);

IPC_RETURN_TYPE IPC_defineMsg(const char *, unsigned int, const char *);
int IPC_isMsgDefined(const char *);
int IPC_numHandlers(const char *);
IPC_RETURN_TYPE IPC_publish(const char *, unsigned int, void *);
IPC_RETURN_TYPE IPC_unsubscribe(const char *, void *);
const char *IPC_msgInstanceName(MSG_INSTANCE);
unsigned int IPC_dataLength(MSG_INSTANCE);
IPC_RETURN_TYPE IPC_setCapacity(int);
IPC_RETURN_TYPE IPC_setMsgQueueLength(const char *, int);
IPC_RETURN_TYPE IPC_setMsgPriority(const char *, int);
IPC_RETURN_TYPE IPC_respond(MSG_INSTANCE, const char *, unsigned int, void *);
IPC_RETURN_TYPE IPC_delayResponse(MSG_INSTANCE);

IPC_RETURN_TYPE IPC_listen(unsigned int);
IPC_RETURN_TYPE IPC_listenClear(unsigned int);
IPC_RETURN_TYPE IPC_listenWait(unsigned int);
IPC_RETURN_TYPE IPC_handleMessage(unsigned int);
IPC_RETURN_TYPE IPC_dispatch(void);
IPC_RETURN_TYPE IPCx_process(void);
int IPCx_fd(void);
long IPCx_nextTimeout(void);
IPC_RETURN_TYPE IPCx_setReconnect(int);

FORMATTER_PTR IPC_parseFormat(const char *);
IPC_RETURN_TYPE IPC_defineFormat(const char *, const char *);
IPC_RETURN_TYPE IPC_checkMsgFormats(const char *, const char *);
FORMATTER_PTR IPC_msgFormatter(const char *);
FORMATTER_PTR IPC_msgInstanceFormatter(MSG_INSTANCE);
typedef struct { unsigned int length; void *content; } IPC_VARCONTENT_TYPE;
IPC_RETURN_TYPE IPC_marshall(FORMATTER_PTR, void *, IPC_VARCONTENT_TYPE *);
void IPC_freeByteArray(void *);

IPC_RETURN_TYPE IPC_removeTimerByRef(TIMER_REF);

#define GLUE_LARGE ...
struct text { int kind; char bytes[]; ...; };
void glue_keep_texts(int);
struct text *glue_take_text(void);
void glue_begin(void);
void glue_end(void);
IPC_RETURN_TYPE glue_subscribe(const char *, const char *, uintptr_t);
IPC_RETURN_TYPE glue_unsubscribe(const char *, const char *);
IPC_RETURN_TYPE glue_query_notify(const char *, unsigned int, void *, uintptr_t);
IPC_RETURN_TYPE glue_subscribe_fd(int, uintptr_t);
IPC_RETURN_TYPE glue_unsubscribe_fd(int);
IPC_RETURN_TYPE glue_watch_connect(int, uintptr_t);
IPC_RETURN_TYPE glue_watch_disconnect(int, uintptr_t);
IPC_RETURN_TYPE glue_watch_connection(int, uintptr_t);
IPC_RETURN_TYPE glue_watch_change(const char *, int, uintptr_t);
IPC_RETURN_TYPE glue_add_timer(unsigned long, long, uintptr_t, TIMER_REF *);
struct reply { void *content; unsigned int length; int is_big_endian; FORMATTER_PTR formatter; };
IPC_RETURN_TYPE glue_query(const char *, unsigned int, void *, unsigned int, struct reply *);
IPC_RETURN_TYPE glue_publish_fixed(const char *, unsigned int, void *);
#define GLUE_OTHER_FORMAT ...
int glue_publish_as(const char *, FORMATTER_PTR, unsigned int, void *);
int glue_connections(int *, int);
const char *glue_version(void);
char *glue_print(FORMATTER_PTR, void *, unsigned int);
void glue_free(void *);

extern "Python" {
    void py_message(MSG_INSTANCE, char *, unsigned int, int, uintptr_t);
    void py_descriptor(int, uintptr_t);
    void py_connect(char *, uintptr_t);
    void py_disconnect(char *, uintptr_t);
    void py_connection(int, uintptr_t);
    void py_change(char *, int, uintptr_t);
    void py_timer(uintptr_t, unsigned long, unsigned long);
    int py_give_up(void);
    void py_loss(void);
}
"""


def read(*path):
    with open(os.path.join(*path), encoding="utf-8") as file:
        return file.read()


#: How C is compiled.  Where Python itself was with -g the package would be five times as large.
FLAGS = ["-std=gnu99", "-g0"]


def versions():
    """What library and server announce, as CMakeLists.txt has it."""
    text = read(ROOT, "CMakeLists.txt")
    patterns = {"IPC_VERSION": r"VERSION (\d+\.\d+\.\d+)",
                "IPC_RELEASE_DATE": r'IPC_RELEASE_DATE "(.*?)"'}
    return {name: '"%s"' % re.findall(pattern, text)[0] for name, pattern in patterns.items()}


def library():
    """How the module comes by the library, as arguments of a setuptools extension."""
    chosen = os.environ.get("IPC_CFFI_LIBRARY")
    if chosen:
        prefix = {} if chosen == "system" else {
            "include_dirs": [os.path.join(chosen, "include")],
            "library_dirs": [os.path.join(chosen, "lib")],
            "runtime_library_dirs": [os.path.join(chosen, "lib")]}
        return {"libraries": ["ipc"], **prefix}
    # Relative to where setuptools runs: it puts the objects in the same places below its own.
    sources = [os.path.relpath(path) for layer in LAYERS
               for path in sorted(glob.glob(os.path.join(ROOT, "src/c", layer, "*.c")))]
    headers = [path for layer in LAYERS
               for path in sorted(glob.glob(os.path.join(ROOT, "src/c", layer, "*.h")))]
    return {"sources": sources, "depends": headers,
            "include_dirs": [os.path.join(ROOT, "include"), os.path.join(ROOT, "src/c")],
            "define_macros": list(versions().items()),
            "extra_compile_args": [*FLAGS, "-fvisibility=hidden"],
            "extra_link_args": ["-pthread"]}


ffibuilder = FFI()
ffibuilder.cdef(CDEF)
ffibuilder.set_source("ipc_cffi._ffi", read(HERE, "_glue.c"), **library())
