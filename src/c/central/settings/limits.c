/*
 * The limits that an operator may change.
 */
#include "central/settings/limits.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/text.h"

#define MIB (UINT64_C(1024) * 1024)
#define SECOND_NS UINT64_C(1000000000)

struct limit {
    const char *name;
    const char *help;
    size_t offset; /* of the member, an uint64_t */
    uint64_t unit; /* of the value as it is given */
    uint64_t standard;
    uint64_t highest;
};

#define MEMBER(name) offsetof(struct central_limits, name)

/* In the order of the listing. */
static const struct limit table[] = {
    {"message-bytes", "data of one message", MEMBER(data), 1, LIMIT_DATA, INT32_MAX},
    {"name-bytes", "name that goes with a message", MEMBER(class_data), 1, LIMIT_CLASS_DATA,
     INT32_MAX},
    {"queue-bytes", "data that waits for one resource", MEMBER(pending_bytes), 1, 1024 * MIB,
     INT64_MAX},
    {"queue-messages", "messages that wait for one resource", MEMBER(pending_messages), 1, 2000000,
     INT64_MAX},
    {"unsent-bytes", "bytes that one module has not read yet", MEMBER(out_queue), 1,
     LIMIT_OUT_QUEUE, INT32_MAX},
    {"progress-seconds", "senders wait for a receiver that finishes nothing", MEMBER(progress_ns),
     SECOND_NS, SECOND_NS / 4, 3600 * SECOND_NS},
    {"stuck-seconds", "patience with a module that does not read", MEMBER(stuck_ns), SECOND_NS,
     30 * SECOND_NS, 86400 * SECOND_NS},
    {"introduction-seconds", "patience with a connection without a name", MEMBER(introduction_ns),
     SECOND_NS, 30 * SECOND_NS, 86400 * SECOND_NS},
    {"look-up-seconds", "patience with the look-up of a newcomer's name", MEMBER(look_up_ns),
     SECOND_NS, 2 * SECOND_NS, 86400 * SECOND_NS},
    {"strangers", "connections without a name", MEMBER(unintroduced), 1, 4096, INT32_MAX},
};

enum { N_LIMITS = sizeof table / sizeof table[0] };

static uint64_t *value_of(struct central_limits *limits, const struct limit *limit)
{
    return (uint64_t *)(void *)((char *)limits + limit->offset);
}

void limits_init(struct central_limits *limits)
{
    for (size_t i = 0; i < N_LIMITS; i++) {
        *value_of(limits, &table[i]) = table[i].standard;
    }
}

static const struct limit *find(const char *name, size_t length)
{
    for (size_t i = 0; i < N_LIMITS; i++) {
        if (strlen(table[i].name) == length && memcmp(table[i].name, name, length) == 0) {
            return &table[i];
        }
    }
    return NULL;
}

int limits_set(struct central_limits *limits, const char *assignment)
{
    const char *value = strchr(assignment, '=');
    const struct limit *limit =
        value == NULL ? NULL : find(assignment, (size_t)(value - assignment));
    if (limit == NULL) {
        return ERR_UNKNOWN;
    }
    char *end;
    const double number = strtod(value + 1, &end) * (double)limit->unit;
    if (end == value + 1 || *end != '\0' || !(number >= 1 && number <= (double)limit->highest)) {
        return ERR_RANGE;
    }
    *value_of(limits, limit) = (uint64_t)number;
    return 0;
}

void limits_show_help(struct buffer *out)
{
    for (size_t i = 0; i < N_LIMITS; i++) {
        const struct limit *limit = &table[i];
        text_append(out, " --limit-%s=<number>: %s - the default is: %.15g\n", limit->name,
                    limit->help, (double)limit->standard / (double)limit->unit);
    }
}
