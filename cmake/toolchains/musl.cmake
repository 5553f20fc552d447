# This machine with another C library: programs that need no file besides
# themselves, as on Alpine Linux.  Debian: musl-tools.
set(CMAKE_C_COMPILER musl-gcc)
set(CMAKE_EXE_LINKER_FLAGS_INIT -static)
set(BUILD_SHARED_LIBS OFF CACHE BOOL "" FORCE)
set(IPC_OWN_CMOCKA ON CACHE BOOL "")
