/*
 * Dispatches: numbers, records, and how long their data lasts.
 */
#include "central/model/dispatch.h"

#include <string.h>

#include "base/error.h"
#include "central/settings/version.h"

void dispatch_pool_init(struct dispatch_pool *pool)
{
    idpool_init(&pool->numbers);
    pool_init(&pool->records, sizeof(struct dispatch));
    pool->n_begun = 0;
    pool->n_ended = 0;
}

void dispatch_pool_fini(struct dispatch_pool *pool)
{
    pool_fini(&pool->records);
    idpool_fini(&pool->numbers);
}

struct dispatch *dispatch_new(struct dispatch_pool *pool, struct message *message,
                              struct module *sender, const struct frame *frame)
{
    struct dispatch *dispatch = pool_take(&pool->records);
    dispatch->id = idpool_take(&pool->numbers, dispatch);
    dispatch->number = pool->n_begun;
    dispatch->state = DISPATCH_NEW;
    dispatch->uncounted = false;
    dispatch->class = frame->class;
    dispatch->data_order = frame->data_order;
    dispatch->parent = frame->parent;
    dispatch->reference = frame->reference;
    dispatch->message = message;
    dispatch->sender = sender == NULL ? NULL : module_ref(sender);
    dispatch->handler = NULL;
    dispatch->resource = NULL;
    dispatch->lost_by = NULL;
    list_init(&dispatch->link);
    pending_item_init(&dispatch->waiting);
    dispatch->block = NULL;
    dispatch->data = frame->data;
    dispatch->data_length = frame->data_length;
    pool->n_begun++;
    return dispatch;
}

void dispatch_free(struct dispatch_pool *pool, struct dispatch *dispatch)
{
    list_remove(&dispatch->link);
    idpool_release(&pool->numbers, dispatch->id);
    module_unref(dispatch->sender);
    module_unref(dispatch->lost_by);
    block_unref(dispatch->block);
    pool_give(&pool->records, dispatch);
    pool->n_ended++;
}

struct dispatch *dispatch_find(const struct dispatch_pool *pool, int64_t number)
{
    return idpool_get(&pool->numbers, number);
}

int dispatch_keep(struct dispatch *dispatch, struct block **shared)
{
    if (*shared == NULL && dispatch->data_length <= DISPATCH_SMALL) {
        if (dispatch->data_length > 0 && dispatch->data != dispatch->small) {
            memcpy(dispatch->small, dispatch->data, dispatch->data_length);
        }
        dispatch->data = dispatch->small;
        return 0;
    }
    if (*shared == NULL) {
        *shared = block_copy(dispatch->data, dispatch->data_length);
        if (*shared == NULL) {
            return ERR_MEMORY;
        }
    }
    /* A block of a whole frame holds the class data in front of the data. */
    dispatch->data = (*shared)->bytes + ((*shared)->length - dispatch->data_length);
    dispatch->block = block_ref(*shared);
    return 0;
}

void dispatch_drop_data(struct dispatch *dispatch)
{
    block_unref(dispatch->block);
    dispatch->block = NULL;
    dispatch->data = NULL;
    dispatch->data_length = 0;
}

const char *dispatch_sender_name(const struct dispatch *dispatch)
{
    return dispatch->sender == NULL ? SERVER_NAME : dispatch->sender->name;
}
