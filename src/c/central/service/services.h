/*
 * The functions that carry out requests of modules, one per library message.
 * What each of them does stands in the protocol's description of its message.
 */
#ifndef IPC_CENTRAL_SERVICES_H
#define IPC_CENTRAL_SERVICES_H

struct request;

/* service_handshake.c: connecting and leaving */
void service_message_info(struct request *request);
void service_class_info(struct request *request);
void service_introduction(struct request *request);
void service_ready(struct request *request);
void service_close(struct request *request);

/* service_messages.c: messages, formats, subscriptions */
void service_define_message(struct request *request);
void service_subscribe(struct request *request);
void service_unsubscribe(struct request *request);
void service_define_format(struct request *request);
void service_get_format(struct request *request);
void service_priority(struct request *request);
void service_messages(struct request *request);
void service_message_details(struct request *request);
void service_ignore_logging(struct request *request);
void service_resume_logging(struct request *request);

/* service_modules.c: modules and their handlers */
void service_is_connected(struct request *request);
void service_processes(struct request *request);
void service_handlers(struct request *request);
void service_watch_handlers(struct request *request);
void service_handler_info(struct request *request);
void service_direct_port(struct request *request);
void service_direct_info(struct request *request);
void service_provides(struct request *request);
void service_requires(struct request *request);
void service_available(struct request *request);

/* service_resources.c: capacity, limits, locks and reservations */
void service_resource(struct request *request);
void service_limit_pending(struct request *request);
void service_add_to_resource(struct request *request);
void service_claim(struct request *request);
void service_claim_of_module(struct request *request);
void service_give_back(struct request *request);

/* service_taps.c */
void service_tap_message(struct request *request);
void service_remove_tap(struct request *request);
void service_tap_reference(struct request *request);
void service_find_tapped(struct request *request);

/* variable_service.c */
void service_register_variable(struct request *request);

#endif
