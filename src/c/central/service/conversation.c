/*
 * The conversation with modules.
 */
#include "central/service/conversation.h"

#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "central/routing/backpressure.h"
#include "central/routing/completion.h"
#include "central/routing/ending.h"
#include "central/routing/flow.h"
#include "central/routing/route.h"
#include "central/service/service.h"
#include "central/routing/watch.h"

/* What one connection may say before the others are heard. */
enum { TURN_FRAMES = 64, TURN_BYTES = 256 * 1024 };

/* ---------------------------------------------------------------------- input */

static void wants_to_be_heard(struct server *server, struct module *module)
{
    if (list_is_empty(&module->in_input) && !module_waits(module)) {
        list_append(&server->input, &module->in_input);
    }
}

void conversation_end_input(struct server *server, struct module *module)
{
    module->input_ended = true;
    backpressure_let_go(server, module);
    wants_to_be_heard(server, module);
}

void conversation_read(struct server *server, struct module *module)
{
    if (module->state == MODULE_ENDED || module->input_ended || module_waits(module) ||
        !list_is_empty(&module->in_input)) {
        return;
    }
    const int n = link_read(&module->link, NULL);
    if (n > 0) {
        wants_to_be_heard(server, module);
    } else if (n < 0) {
        conversation_end_input(server, module);
    }
}

void conversation_hung_up(struct server *server, struct module *module)
{
    module->deaf = true;
    backpressure_let_go(server, module);
    conversation_read(server, module);
}

size_t conversation_feed(struct server *server, struct module *module, const void *bytes,
                         size_t count)
{
    size_t room;
    uint8_t *space = reader_space(&module->link.reader, &room);
    if (space == NULL) {
        conversation_end_input(server, module);
        return count;
    }
    const size_t taken = count < room ? count : room;
    memcpy(space, bytes, taken);
    reader_filled(&module->link.reader, taken);
    wants_to_be_heard(server, module);
    return taken;
}

/* --------------------------------------------------------------------- frames */

static bool is_routed(const struct message *message)
{
    return message->kind == MESSAGE_USER;
}

static bool is_request(const struct message *message)
{
    return message->kind == MESSAGE_SERVICE || message->kind == MESSAGE_SET ||
           message->kind == MESSAGE_GET || message->kind == MESSAGE_GET_SET;
}

static void say_misused(struct server *server, const struct module *module,
                        const struct frame *frame, const struct message *message)
{
    log_warning(&server->log, module, "a frame of class %d to %s is ignored", (int)frame->class,
                message->name);
}

/* A frame of class query, inform or broadcast. */
static void handle_message(struct server *server, struct module *module, const struct frame *frame)
{
    /* Modules in direct mode use the negative number where a message goes through central. */
    const int64_t id = frame->intent < 0 ? -(int64_t)frame->intent : frame->intent;
    struct message *message = message_by_id(&server->messages, id);
    if (message == NULL) {
        ending_for_violation(server, module, "its frame is for a message that does not exist");
    } else if (is_request(message) && frame->class != CLASS_BROADCAST) {
        meter_add(&message->published, server->now_ns, frame->data_length);
        service(server, module, frame, message);
    } else if (!is_routed(message)) {
        say_misused(server, module, frame, message);
    } else if (module->state == MODULE_GREETED) {
        ending_for_violation(server, module, "a message comes before the introduction");
    } else if (frame->class == CLASS_BROADCAST) {
        route_broadcast(server, module, frame, message);
    } else {
        route_to_one(server, module, frame, message);
    }
}

static void count(struct statistics *statistics, uint64_t now_ns, const struct frame *frame)
{
    const uint32_t body = frame->class_length + frame->data_length;
    if (statistics->read.total.messages == 0 || body < statistics->shortest_body) {
        statistics->shortest_body = body;
    }
    if (body > statistics->longest_body) {
        statistics->longest_body = body;
    }
    meter_add(&statistics->read, now_ns, body);
}

static void handle_frame(struct server *server, struct module *module, const struct frame *frame)
{
    count(&server->statistics, server->now_ns, frame);
    meter_add(&module->sends, server->now_ns, (uint64_t)frame->class_length + frame->data_length);
    switch (frame->class) {
    case CLASS_REPLY:
    case CLASS_SUCCESS:
    case CLASS_FAILURE:
        completion(server, module, frame);
        break;
    default: /* the reader lets no other classes through than those of messages */
        handle_message(server, module, frame);
        break;
    }
}

/* Handles a frame and writes the summary of it. */
static void handle_frame_timed(struct server *server, struct module *module,
                               const struct frame *frame)
{
    struct statistics *statistics = &server->statistics;
    const uint64_t bytes = (uint64_t)frame->class_length + frame->data_length;
    const uint64_t start = server->clock();
    const double share = statistics->working_ns == 0 ? 0.0
                                                     : 100.0 * (double)statistics->handling_ns /
                                                           (double)statistics->working_ns;
    handle_frame(server, module, frame);
    const uint64_t taken = server->clock() - start;
    statistics->handling_ns += taken;
    const struct amount *read = &statistics->read.total;
    const struct log_summary summary = {
        .count = read->messages,
        .message_share = share > 100.0 ? 100.0 : share,
        .bytes = bytes,
        .milliseconds = taken / 1000000u,
        .average_bytes = read->bytes / read->messages,
        .average_milliseconds = statistics->handling_ns / 1000000u / read->messages,
    };
    log_summarise(&server->log, &summary);
}

/* --------------------------------------------------------------------- a turn */

static void end_for_bad_frame(struct server *server, struct module *module)
{
    const struct reader *reader = &module->link.reader;
    const struct frame *frame = &reader->violating;
    uint8_t header[FRAME_HEADER_SIZE];
    char reason[200];
    frame_write_header(frame, header);
    (void)snprintf(reason, sizeof reason, "%s (header %08lx %08lx %08lx %08lx %08lx %08lx %08lx)",
                   reader->violation, (unsigned long)load_be32(header),
                   (unsigned long)load_be32(header + 4), (unsigned long)load_be32(header + 8),
                   (unsigned long)load_be32(header + 12), (unsigned long)load_be32(header + 16),
                   (unsigned long)load_be32(header + 20), (unsigned long)load_be32(header + 24));
    ending_for_violation(server, module, reason);
}

/* The next frame: true, or false when there is none, because of which the connection may have
 * ended. */
static bool next_frame(struct server *server, struct module *module, struct frame *frame)
{
    const int result = reader_next(&module->link.reader, frame);
    if (result > 0) {
        return true;
    }
    list_remove(&module->in_input);
    if (result == ERR_PROTOCOL) {
        end_for_bad_frame(server, module);
    } else if (result < 0) {
        ending_for_violation(server, module, "there is no memory for its frame");
    } else if (module->input_ended) {
        ending(server, module, ENDING_LOSS);
    }
    return false;
}

/* Not any more when the connection ends, or has to wait. */
static bool is_heard(const struct module *module)
{
    return !list_is_empty(&module->in_input);
}

/* Hears one connection for its share of the turn. */
static void hear(struct server *server, struct module *module)
{
    struct frame frame;
    size_t bytes = 0;
    for (int i = 0; i < TURN_FRAMES && bytes < TURN_BYTES && is_heard(module); i++) {
        if (!next_frame(server, module, &frame)) {
            return;
        }
        bytes += FRAME_HEADER_SIZE + frame.class_length + frame.data_length;
        if (server->log.summary_on) {
            handle_frame_timed(server, module, &frame);
        } else {
            handle_frame(server, module, &frame);
        }
    }
}

void conversation_turn(struct server *server)
{
    struct list *at, *following;
    LIST_EACH (at, following, &server->input) {
        hear(server, LIST_OWNER(at, struct module, in_input));
    }
    ending_carry_out(server);
    (void)watch_settle(server); /* what it sends is flushed with the rest */
}

bool conversation_is_pending(const struct server *server)
{
    return !list_is_empty(&server->input) || !list_is_empty(&server->condemned);
}

/* ------------------------------------------------------------------- patience */

void conversation_flushed(struct server *server, struct module *module)
{
    const struct central_limits *limits = &server->options->limits;
    const uint64_t unsent = link_waiting(&module->link);
    if (unsent <= limits_stuck_bytes(limits)) {
        module->stuck_since_ns = 0;
    } else if (module->stuck_since_ns == 0) {
        module->stuck_since_ns = server->now_ns;
    } else if (server->now_ns - module->stuck_since_ns > limits->stuck_ns) {
        ending_for_violation(server, module, "it does not read, and too much waits for it");
        return;
    }
    if (module->wants_room && unsent < limits->out_queue) {
        module->wants_room = false;
        flow_release_all(server, module);
    }
}

static uint64_t check_introductions(struct server *server)
{
    const struct central_limits *limits = &server->options->limits;
    while (!list_is_empty(&server->greeted)) {
        struct module *oldest = LIST_OWNER(server->greeted.next, struct module, in_state);
        const uint64_t end = oldest->accepted_ns + limits->introduction_ns;
        if (server->n_greeted <= limits->unintroduced && server->now_ns < end) {
            return end;
        }
        ending_for_violation(server, oldest, "it has not introduced itself");
    }
    return UINT64_MAX;
}

uint64_t conversation_check_patience(struct server *server)
{
    const uint64_t introductions = check_introductions(server);
    const uint64_t receivers = backpressure_check(server);
    return introductions < receivers ? introductions : receivers;
}
