/*
 * The three outputs of the log.
 */
#include "central/log/log_output.h"

const struct log_switches *log_switches_of(const struct log *log, enum which_log which)
{
    const struct options *options = log->options;
    return which == LOG_TERMINAL ? &options->terminal
           : which == LOG_FILE   ? &options->file
                                 : &options->json;
}

struct log_file *log_file_of(struct log *log, enum which_log which)
{
    return which == LOG_FILE ? &log->file : &log->json;
}

static struct sink *sink_of(struct log *log, enum which_log which)
{
    return which == LOG_TERMINAL ? &log->terminal : &log_file_of(log, which)->sink;
}

bool log_is_open(const struct log *log, enum which_log which)
{
    const bool is_open = which == LOG_TERMINAL ? !log->options->silent
                         : which == LOG_FILE   ? log->file.is_open
                                               : log->json.is_open;
    return is_open && !log->closed;
}

void log_switched(struct log *log)
{
    log->messages_on = false;
    log->data_on = false;
    log->summary_on = false;
    for (enum which_log which = LOG_TERMINAL; which <= LOG_JSON; which++) {
        if (log_is_open(log, which)) {
            log->messages_on |= log_switches_of(log, which)->messages;
            log->data_on |= log_switches_of(log, which)->data;
            log->summary_on |= log_switches_of(log, which)->summary;
        }
    }
}

void log_put_text(struct log *log, enum which_log which, const struct buffer *text)
{
    const uint8_t *bytes = text->bytes;
    size_t length = text->length;
    while (which == LOG_FILE && length > 1 && (*bytes == '\n' || *bytes == '\a')) {
        bytes++;
        length--;
    }
    sink_put(sink_of(log, which), bytes, length);
}

void log_put_line(struct log *log, enum which_log which)
{
    log_put_text(log, which, &log->line);
}

const char *log_class_name(uint16_t class)
{
    switch (class) {
    case CLASS_QUERY:
        return "Query";
    case CLASS_INFORM:
        return "Inform";
    case CLASS_BROADCAST:
        return "Broadcast";
    default:
        return "UNKNOWN CLASS";
    }
}
