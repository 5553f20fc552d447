/*
 * Requests to end, and the time of day, on Windows.
 */
#include "platform/process.h"

#include <signal.h>
#include <stdio.h>

#include "base/error.h"
#include "platform/windows/owner.h"
#include "platform/windows/system.h"

/* Windows tells in threads that get no argument of ours, so what they need has to stand here. */
static struct {
    const struct waker *waker;
    volatile LONG interrupted;
    volatile LONG terminated;
} caught;

static BOOL WINAPI note_control(DWORD control)
{
    (void)InterlockedExchange(control == CTRL_C_EVENT ? &caught.interrupted : &caught.terminated,
                              1);
    waker_wake(caught.waker);
    if (control != CTRL_C_EVENT && control != CTRL_BREAK_EVENT) {
        Sleep(INFINITE); /* the process would end as soon as this returns */
    }
    return TRUE;
}

static void CALLBACK note_request(void *unused, BOOLEAN timed_out)
{
    (void)unused;
    (void)timed_out;
    (void)InterlockedExchange(&caught.terminated, 1);
    waker_wake(caught.waker);
}

/* Without the event this process is ended the hard way. */
static void listen_to_requests(void)
{
    char name[OWNER_END_EVENT_SIZE];
    HANDLE wait;
    (void)snprintf(name, sizeof name, OWNER_END_EVENT, (unsigned long)GetCurrentProcessId());
    const HANDLE event = CreateEventA(NULL, FALSE, FALSE, name);
    if (event != NULL) {
        (void)RegisterWaitForSingleObject(&wait, event, note_request, NULL, INFINITE,
                                          WT_EXECUTEDEFAULT);
    }
}

int process_catch_signals(const struct waker *waker)
{
    caught.waker = waker;
    listen_to_requests();
    return SetConsoleCtrlHandler(note_control, TRUE) != 0 ? 0 : ERR_IO;
}

int process_take_signal(void)
{
    if (InterlockedExchange(&caught.interrupted, 0) != 0) {
        return SIGINT;
    }
    return InterlockedExchange(&caught.terminated, 0) != 0 ? SIGTERM : 0;
}

bool process_signal_ends(int number)
{
    return number == SIGINT || number == SIGTERM;
}

int64_t process_number(void)
{
    return (int64_t)GetCurrentProcessId();
}

/* -------------------------------------------------------------- time of day */

/* Since 1970, in units of 100 nanoseconds. */
static uint64_t ticks_of(FILETIME time)
{
    static const uint64_t from_1601_to_1970 = UINT64_C(116444736000000000);
    return ((uint64_t)time.dwHighDateTime << 32 | time.dwLowDateTime) - from_1601_to_1970;
}

enum { TICKS = 10000000 }; /* a second */

void clock_local(struct local_time *local)
{
    FILETIME now;
    SYSTEMTIME universal;
    SYSTEMTIME parts;
    GetSystemTimePreciseAsFileTime(&now);
    (void)FileTimeToSystemTime(&now, &universal); /* it is a time */
    if (SystemTimeToTzSpecificLocalTime(NULL, &universal, &parts) == 0) {
        parts = universal;
    }
    local->year = parts.wYear;
    local->month = parts.wMonth;
    local->day = parts.wDay;
    local->weekday = parts.wDayOfWeek;
    local->hour = parts.wHour;
    local->minute = parts.wMinute;
    local->second = parts.wSecond;
    local->hundredths = parts.wMilliseconds / 10;
    local->epoch = (int64_t)(ticks_of(now) / TICKS);
}

void clock_utc(char text[CLOCK_UTC_SIZE])
{
    FILETIME now;
    SYSTEMTIME parts;
    GetSystemTimePreciseAsFileTime(&now);
    (void)FileTimeToSystemTime(&now, &parts);
    (void)snprintf(text, CLOCK_UTC_SIZE, "%04u-%02u-%02uT%02u:%02u:%02u.%09luZ", parts.wYear,
                   parts.wMonth, parts.wDay, parts.wHour, parts.wMinute, parts.wSecond,
                   (unsigned long)(ticks_of(now) % TICKS) * 100);
}
