/*
 * A module in C whose types are made by xdrgen: gets robots, changes each a little, and sends it back.
 * Ends when its standard input does.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ipc.h"
#include "robot.h"

static void on_robot(MSG_INSTANCE instance, void *data, void *client_data)
{
    Robot *robot = data;
    (void)client_data;
    robot->number++;
    robot->mode = FAULT;
    robot->active = 'n';
    robot->speeds[2] *= 2;
    robot->home.y = -robot->home.y;
    memcpy(robot->serial, "back", 4);
    robot->levels[1][0] = 255;
    robot->path[robot->n - 1].x += 0.5;
    robot->grid[robot->rows * robot->columns - 1] = 1e300;
    robot->labels[0][0] = 'L';
    IPC_publishData("back", robot);
    IPC_freeData(IPC_msgInstanceFormatter(instance), robot);
}

static void on_end(int fd, void *client_data)
{
    (void)client_data;
    IPC_unsubscribeFD(fd, on_end);
    IPC_disconnect();
    exit(EXIT_SUCCESS);
}

int main(void)
{
    IPC_connect("robot");
    IPC_defineMsg("there", IPC_VARIABLE_LENGTH, Robot_IPC_FORMAT);
    IPC_defineMsg("back", IPC_VARIABLE_LENGTH, Robot_IPC_FORMAT);
    IPC_subscribeData("there", on_robot, NULL);
    IPC_subscribeFD(fileno(stdin), on_end, NULL);
    printf("ready\n");
    fflush(stdout);
    IPC_dispatch();
    return EXIT_FAILURE;
}
