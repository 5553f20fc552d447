/*
 * What becomes of a queue that is full.
 */
#include "central/settings/when_full.h"

#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "base/table.h"

struct choice {
    struct list in_policies;
    enum when_full policy;
    char module[];
};

static const char *const names[] = {
    [WHEN_FULL_WAIT] = "wait",
    [WHEN_FULL_NEWEST] = "newest",
    [WHEN_FULL_OLDEST] = "oldest",
    [WHEN_FULL_DISCONNECT] = "disconnect",
};

enum { N_POLICIES = sizeof names / sizeof names[0] };

void full_policies_init(struct full_policies *policies)
{
    policies->standard = WHEN_FULL_WAIT;
    list_init(&policies->of_modules);
}

void full_policies_fini(struct full_policies *policies)
{
    struct list *at, *following;
    LIST_EACH (at, following, &policies->of_modules) {
        free(LIST_OWNER(at, struct choice, in_policies));
    }
}

static int find_policy(const char *name, enum when_full *policy)
{
    for (int i = 0; i < N_POLICIES; i++) {
        if (strcmp(names[i], name) == 0) {
            *policy = (enum when_full)i;
            return 0;
        }
    }
    return ERR_UNKNOWN;
}

int full_policies_set(struct full_policies *policies, const char *choice)
{
    enum when_full policy;
    const char *colon = strrchr(choice, ':'); /* names of modules may hold some, too */
    if (colon == choice || find_policy(colon == NULL ? choice : colon + 1, &policy) != 0) {
        return ERR_UNKNOWN;
    }
    if (colon == NULL) {
        policies->standard = policy;
        return 0;
    }
    const size_t length = (size_t)(colon - choice);
    struct choice *chosen = mem_new(sizeof *chosen + length + 1);
    chosen->policy = policy;
    memcpy(chosen->module, choice, length);
    list_prepend(&policies->of_modules, &chosen->in_policies);
    return 0;
}

enum when_full full_policies_of(const struct full_policies *policies, const char *module)
{
    struct list *at, *following;
    LIST_EACH (at, following, &policies->of_modules) {
        const struct choice *choice = LIST_OWNER(at, struct choice, in_policies);
        if (table_same_name(TABLE_FOLDING, choice->module, module)) {
            return choice->policy;
        }
    }
    return policies->standard;
}
