/*
 * A request or notice of a module to the server, while it is carried out.
 *
 * Whoever carries it out gets the decoded payload, checks it, asks the registries
 * and answers; what is neither answered nor kept ends without an answer.
 */
#ifndef IPC_CENTRAL_REQUEST_H
#define IPC_CENTRAL_REQUEST_H

#include "central/routing/server.h"

/* A payload of any library message. */
union payload {
    int number;
    char *name;
    struct message_info_request message_info;
    struct introduction introduction;
    struct message_definition definition;
    struct subscription_notice subscription;
    struct two_names names;
    struct number_and_name number_and_name;
    struct name_and_number name_and_number;
    struct pending_limit limit;
    struct name_list list;
    struct tap tap;
    double room[8]; /* for payloads that are accepted and not read */
};

struct request {
    struct server *server;
    struct module *module;
    struct dispatch *dispatch;
    union payload *payload;
    bool settled; /* answered, or kept */
};

/* Answers with a value in the message's reply format; NULL: without data. */
void request_answer(struct request *request, const void *value);

/* Somebody else will answer and end the request's dispatch. */
struct dispatch *request_keep(struct request *request);

/* Logs why the request is ignored. */
void request_ignore(const struct request *request, const char *format, ...) LIKE_PRINTF(2, 3);

/* Whether a name is there and not too long; if not, the request is ignored and the log says so. */
bool request_names(const struct request *request, const char *name);

/* The message of that name, made if need be; NULL (and logged) when there are too many. */
struct message *request_get_message(const struct request *request, const char *name);

#endif
