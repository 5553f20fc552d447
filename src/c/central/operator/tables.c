/*
 * Tables of what there is and what goes through it, for people.
 */
#include "central/operator/tables.h"

#include <inttypes.h>
#include <string.h>

enum { WIDEST_NAME = 40 };

/* --------------------------------------------------------------------- columns */

/* The width of a column of names, which grows with them. */
static void widen(int *width, const char *name)
{
    const size_t length = strlen(name);
    if (length > (size_t)*width) {
        *width = length > WIDEST_NAME ? WIDEST_NAME : (int)length;
    }
}

static void add_name(struct buffer *out, int width, const char *name)
{
    text_append(out, "%-*s", width, name);
}

static void add_title(struct buffer *out, const char *title)
{
    text_append(out, " %9s", title);
}

/* A number in at most five characters: 999, 1.2k, 35k, 7.1M. */
static void add_amount(struct buffer *out, uint64_t amount)
{
    static const char units[] = "kMGTPE";
    double value = (double)amount;
    char text[16];
    int unit = -1;
    while (value >= 999.5) {
        value /= 1000;
        unit++;
    }
    if (unit < 0) {
        (void)snprintf(text, sizeof text, "%.0f", value);
    } else {
        (void)snprintf(text, sizeof text, value < 9.95 ? "%.1f%c" : "%.0f%c", value, units[unit]);
    }
    text_append(out, " %9s", text);
}

static void end_row(struct buffer *out)
{
    text_append(out, "\n");
}

/* Titles of what add_meter appends. */
static void add_meter_titles(struct buffer *out, const char *what)
{
    add_title(out, what);
    add_title(out, "per s");
    add_title(out, "bytes");
    add_title(out, "bytes/s");
}

static void add_meter(const struct server *server, struct buffer *out, const struct meter *meter)
{
    const struct amount rate = meter_rate(meter, server->now_ns);
    add_amount(out, meter->total.messages);
    add_amount(out, rate.messages);
    add_amount(out, meter->total.bytes);
    add_amount(out, rate.bytes);
}

/* -------------------------------------------------------------------- modules */

static const char *state_of(const struct module *module)
{
    if (module_waits(module)) {
        return "held back"; /* what it publishes is too much for somebody */
    }
    switch (module->state) {
    case MODULE_GREETED:
        return "unknown";
    case MODULE_INTRODUCED:
        return "starting";
    case MODULE_WAITING:
        return "waiting";
    case MODULE_READY:
        return "ready";
    case MODULE_ENDED:
        break;
    }
    return "ended";
}

void tables_modules(const struct server *server, struct buffer *out)
{
    static const char name_title[] = "Module", host_title[] = "Host";
    int name_width = (int)sizeof name_title - 1, host_width = (int)sizeof host_title - 1;
    struct list *at, *following;
    LIST_EACH (at, following, &server->modules) {
        const struct module *module = LIST_OWNER(at, struct module, in_server);
        widen(&name_width, module->name);
        widen(&host_width, module->host);
    }
    add_name(out, name_width, name_title);
    text_append(out, " ");
    add_name(out, host_width, host_title);
    add_title(out, "State");
    add_meter_titles(out, "Sends");
    add_meter_titles(out, "Gets");
    add_title(out, "Unread");
    end_row(out);
    LIST_EACH (at, following, &server->modules) {
        const struct module *module = LIST_OWNER(at, struct module, in_server);
        add_name(out, name_width, module->name);
        text_append(out, " ");
        add_name(out, host_width, module->host);
        add_title(out, state_of(module));
        add_meter(server, out, &module->sends);
        add_meter(server, out, &module->gets);
        add_amount(out, link_waiting(&module->link));
        end_row(out);
    }
}

/* ------------------------------------------------------------------- messages */

static const struct message *message_of(const struct table_entry *entry, bool all)
{
    const struct message *message = entry->value;
    return all || message->kind == MESSAGE_USER ? message : NULL;
}

static uint64_t waiting_of(const struct message *message)
{
    uint64_t count = message->n_waiting;
    struct list *at, *following;
    LIST_EACH (at, following, &message->subject.flows) {
        count += LIST_OWNER(at, struct pending_flow, of_subject)->count;
    }
    return count;
}

static void add_message(const struct server *server, struct buffer *out, int width,
                        const struct message *message)
{
    add_name(out, width, message->name);
    add_amount(out, message->n_subscriptions);
    add_meter(server, out, &message->published);
    add_amount(out, message->delivered);
    add_amount(out, waiting_of(message));
    add_amount(out, message->dropped);
    end_row(out);
}

void tables_messages(const struct server *server, struct buffer *out, bool all)
{
    static const char title[] = "Message";
    const struct table *names = &server->messages.names;
    int width = (int)sizeof title - 1;
    struct table_entry *at;
    for (at = table_first(names); at != NULL; at = table_next(names, at)) {
        if (message_of(at, all) != NULL) {
            widen(&width, message_of(at, all)->name);
        }
    }
    add_name(out, width, title);
    add_title(out, "Handlers");
    add_meter_titles(out, "Sent");
    add_title(out, "Delivered");
    add_title(out, "Waiting");
    add_title(out, "Dropped");
    end_row(out);
    for (at = table_first(names); at != NULL; at = table_next(names, at)) {
        if (message_of(at, all) != NULL) {
            add_message(server, out, width, message_of(at, all));
        }
    }
}

/* --------------------------------------------------------------------- queues */

static uint64_t length_of(const struct list *list)
{
    uint64_t length = 0;
    struct list *at, *following;
    LIST_EACH (at, following, list) {
        length++;
    }
    return length;
}

static void add_resource(struct buffer *out, int width, const struct resource *resource)
{
    add_name(out, width, resource->name);
    add_title(out, resource_state_name(resource));
    add_amount(out, (uint64_t)resource->capacity);
    add_amount(out, resource->attending);
    add_amount(out, resource->n_ahead + resource->pending.count + resource->holders_own.count);
    add_amount(out, resource->ahead_bytes + resource->pending.bytes + resource->holders_own.bytes);
    add_amount(out, resource->dropped);
    add_amount(out, length_of(&resource->waited_for_by));
    end_row(out);
}

static void add_resources(const struct server *server, struct buffer *out, int width)
{
    struct list *outer, *after, *at, *following;
    LIST_EACH (outer, after, &server->modules) {
        const struct module *module = LIST_OWNER(outer, struct module, in_server);
        LIST_EACH (at, following, &module->resources) {
            add_resource(out, width, LIST_OWNER(at, struct resource, in_owner));
        }
    }
}

/* A message that waits until somebody handles it. */
static void add_stand_in(struct buffer *out, int width, const struct message *message)
{
    add_name(out, width, message->name);
    add_title(out, "no handler");
    add_amount(out, 0);
    add_amount(out, 0);
    add_amount(out, message->n_waiting);
    add_amount(out, message->waiting_bytes);
    add_amount(out, message->dropped);
    add_amount(out, 0);
    end_row(out);
}

static int widest_queue(const struct server *server, int width)
{
    const struct table *names = &server->messages.names;
    struct list *outer, *after, *at, *following;
    LIST_EACH (outer, after, &server->modules) {
        const struct module *module = LIST_OWNER(outer, struct module, in_server);
        LIST_EACH (at, following, &module->resources) {
            widen(&width, LIST_OWNER(at, struct resource, in_owner)->name);
        }
    }
    for (struct table_entry *entry = table_first(names); entry != NULL;
         entry = table_next(names, entry)) {
        const struct message *message = entry->value;
        if (message->n_waiting > 0) {
            widen(&width, message->name);
        }
    }
    return width;
}

void tables_queues(const struct server *server, struct buffer *out)
{
    static const char title[] = "Resource";
    const struct table *names = &server->messages.names;
    const int width = widest_queue(server, (int)sizeof title - 1);
    add_name(out, width, title);
    add_title(out, "State");
    add_title(out, "Capacity");
    add_title(out, "Active");
    add_title(out, "Waiting");
    add_title(out, "bytes");
    add_title(out, "Dropped");
    add_title(out, "Held back"); /* senders */
    end_row(out);
    add_resources(server, out, width);
    for (struct table_entry *entry = table_first(names); entry != NULL;
         entry = table_next(names, entry)) {
        const struct message *message = entry->value;
        if (message->n_waiting > 0) {
            add_stand_in(out, width, message);
        }
    }
}
