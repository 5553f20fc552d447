/*
 * The system's headers, on Windows.
 */
#ifndef IPC_PLATFORM_WINDOWS_SYSTEM_H
#define IPC_PLATFORM_WINDOWS_SYSTEM_H

#ifndef WIN32_LEAN_AND_MEAN
#define WIN32_LEAN_AND_MEAN
#endif
#undef _WIN32_WINNT
#define _WIN32_WINNT 0x0602 /* Windows 8 */

#include <winsock2.h>
#include <ws2tcpip.h>
#include <windows.h>

#endif
