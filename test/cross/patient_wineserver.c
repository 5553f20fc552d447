/* What wineserver is loaded with (LD_PRELOAD) so that it waits for programs to end.
 *
 * It kills a program that takes more than half a second to leave after it has said its exit
 * status, as may happen on a machine with much to do; the status is lost then. */
#define _GNU_SOURCE
#include <signal.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <unistd.h>

int kill(pid_t pid, int number)
{
    return (int) syscall(SYS_kill, pid, number == SIGKILL ? 0 : number);
}
