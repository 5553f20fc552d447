/*
 * Requests about variables, by the messages that every variable has.
 */
#ifndef IPC_CENTRAL_VARIABLE_SERVICE_H
#define IPC_CENTRAL_VARIABLE_SERVICE_H

#include "central/service/request.h"

/* Carries out a frame to a message of a variable. */
void variable_service(struct request *request, const struct frame *frame);

#endif
