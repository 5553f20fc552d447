/*
 * Formatters.
 */
#include "libipc/formatter.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "libipc/context.h"
#include "libipc/exchange.h"
#include "libipc/report.h"

struct format *formatter_keep(struct library *library, struct format *format)
{
    if (format == NULL || format_is_bad(format)) {
        return format;
    }
    char *text = format_canonical(format);
    struct format *kept = table_find(&library->formatters, text);
    if (kept == NULL) {
        kept = format;
        (void)table_put(&library->formatters, text, kept); /* new: replaces nothing */
    } else {
        format_unref(format);
    }
    free(text);
    return kept;
}

/* What central knows of a named format. */
static struct format *ask_central(void *asked, const char *name)
{
    struct library *library = asked;
    struct _X_IPC_CONTEXT *context = context_current_connected(library);
    char *text = (char *)(uintptr_t)name; /* the request's string is only read */
    struct format *format = NULL;
    if (context == NULL || exchange_ask(context, LM_GET_FORMAT, &text, &format) != IPC_No_Error) {
        return NULL;
    }
    return format; /* the bad format where central does not know the name either */
}

/* Asking central gives up the lock in the middle of parsing, so one thread at a time does. */
static void names_take(struct library *library)
{
    while (library->names_busy) {
        library->sleepers++;
        condition_wait(library->changed, library->lock, UINT64_MAX);
        library->sleepers--;
    }
    library->names_busy = true;
}

static void names_give(struct library *library)
{
    library->names_busy = false;
    if (library->sleepers > 0) {
        condition_tell_all(library->changed);
    }
}

enum formatter_result formatter_parse(struct library *library, const char *text,
                                      struct format **format)
{
    struct format_diagnosis diagnosis = {NULL, 0};
    *format = NULL;
    if (text == NULL || *text == '\0') {
        return FORMATTER_OK;
    }
    names_take(library);
    format_names_set_ask(library->names, ask_central, library);
    const int error = format_parse(text, library->names, format, &diagnosis);
    names_give(library);
    if (diagnosis.text != NULL) {
        report_warning("%s", diagnosis.text);
        free(diagnosis.text);
    }
    if (error != 0) {
        *format = NULL;
        return error == ERR_UNKNOWN ? FORMATTER_UNKNOWN_NAME : FORMATTER_ILLEGAL;
    }
    *format = formatter_keep(library, *format);
    return FORMATTER_OK;
}

int formatter_define(struct library *library, const char *name, const char *text)
{
    names_take(library);
    const int error = format_names_define(library->names, name, text);
    names_give(library);
    return error;
}

char *formatter_portable(struct library *library, const char *text)
{
    return text == NULL || *text == '\0' ? NULL : format_portable_text(text, library->names);
}
