# The options of the build and their defaults.

option(BUILD_SHARED_LIBS "Target ipc is the shared library; the static one is built beside it" ON)
option(IPC_BUILD_EXAMPLES "Build the manual's example programs" ${IPC_TOP_LEVEL})
option(IPC_BUILD_XDRGEN "Build the program xdrgen (needs bison and flex)" ${IPC_TOP_LEVEL})
option(IPC_INSTALL "Add what is built to the install target" ${IPC_TOP_LEVEL})
set(IPC_SYSTEMD_UNIT_DIR lib/systemd/system CACHE STRING "Where units for systemd are installed")
option(IPC_WERROR "Treat warnings as errors" OFF)
# Access control by hosts.allow and hosts.deny needs libwrap; it is there where that is.
find_path(IPC_LIBWRAP_INCLUDE_DIR tcpd.h)
find_library(IPC_LIBWRAP_LIBRARY wrap)
mark_as_advanced(IPC_LIBWRAP_INCLUDE_DIR IPC_LIBWRAP_LIBRARY)
set(ipc_libwrap_found OFF)
if(IPC_LIBWRAP_INCLUDE_DIR AND IPC_LIBWRAP_LIBRARY)
    set(ipc_libwrap_found ON)
endif()
option(IPC_ACCESS_CONTROL "central honours hosts.allow and hosts.deny (needs libwrap)"
    ${ipc_libwrap_found})
if(IPC_ACCESS_CONTROL AND NOT ipc_libwrap_found)
    message(FATAL_ERROR "IPC_ACCESS_CONTROL needs libwrap (tcpd.h and libwrap were not found)")
endif()
set(IPC_SANITIZE "" CACHE STRING "Sanitizers to build with, e.g. address,undefined")

# Builds of CMU IPC set these two.  BUILD_TESTS is another name of
# IPC_BUILD_TESTS; a project that contains this one means its own tests by it.
# THREADED chose a thread-safe library, which this one always is.
if(IPC_TOP_LEVEL AND DEFINED BUILD_TESTS)
    set(IPC_BUILD_TESTS ${BUILD_TESTS} CACHE BOOL "Build the unit tests (needs cmocka)" FORCE)
endif()
option(IPC_BUILD_TESTS "Build the unit tests (needs cmocka)" OFF)
option(THREADED "Has no effect: the library is always thread-safe" ON)

if(IPC_TOP_LEVEL AND NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
    set(CMAKE_BUILD_TYPE Release CACHE STRING "Debug, Release, RelWithDebInfo or MinSizeRel" FORCE)
endif()
