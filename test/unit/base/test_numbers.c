/*
 * Numbers: pools of them, maps from them, their byte order.
 */
#include "unit.h"

#include <stdlib.h>

#include "base/byteorder.h"
#include "base/idpool.h"
#include "base/intmap.h"

static int things[4000];

static void numbers_start_at_zero_and_count_up(void **state)
{
    (void)state;
    struct idpool pool;
    idpool_init(&pool);
    for (uint32_t i = 0; i < 100; i++) {
        assert_int_equal(idpool_take(&pool, &things[i]), i);
    }
    for (uint32_t i = 0; i < 100; i++) {
        assert_ptr_equal(idpool_get(&pool, i), &things[i]);
    }
    assert_int_equal(pool.in_use, 100);
    idpool_fini(&pool);
}

static void the_latest_freed_number_is_given_out_first(void **state)
{
    (void)state;
    struct idpool pool;
    idpool_init(&pool);
    for (uint32_t i = 0; i < 5; i++) {
        (void)idpool_take(&pool, &things[i]);
    }
    idpool_release(&pool, 1);
    idpool_release(&pool, 3);
    assert_int_equal(pool.in_use, 3);
    assert_int_equal(idpool_take(&pool, &things[10]), 3);
    assert_int_equal(idpool_take(&pool, &things[11]), 1);
    assert_int_equal(idpool_take(&pool, &things[12]), 5);
    idpool_fini(&pool);
}

static void numbers_from_outside_are_checked(void **state)
{
    (void)state;
    struct idpool pool;
    idpool_init(&pool);
    assert_null(idpool_get(&pool, 0));
    (void)idpool_take(&pool, &things[0]);
    assert_null(idpool_get(&pool, -1));
    assert_null(idpool_get(&pool, 1));
    assert_null(idpool_get(&pool, INT64_MAX));
    assert_null(idpool_get(&pool, INT64_MIN));
    assert_null(idpool_find(&pool, 0));
    assert_null(idpool_find(&pool, 2));
    assert_null(idpool_find(&pool, UINTPTR_MAX));
    idpool_release(&pool, 0);
    assert_null(idpool_get(&pool, 0));
    assert_null(idpool_find(&pool, 1));
    idpool_fini(&pool);
}

static void a_handle_finds_its_thing_and_no_later_one(void **state)
{
    (void)state;
    struct idpool pool;
    uintptr_t handles[10];
    idpool_init(&pool);
    for (size_t i = 0; i < 10; i++) {
        assert_int_equal(idpool_take(&pool, &things[0]), 0);
        handles[i] = idpool_handle(&pool, 0);
        assert_int_not_equal(handles[i], 0);
        assert_ptr_equal(idpool_find(&pool, handles[i]), &things[0]);
        for (size_t j = 0; j < i; j++) {
            assert_null(idpool_find(&pool, handles[j]));
        }
        idpool_release(&pool, 0);
        assert_null(idpool_find(&pool, handles[i]));
    }
    idpool_fini(&pool);
}

static void a_map_finds_what_was_put(void **state)
{
    (void)state;
    struct intmap map;
    intmap_init(&map);
    assert_null(intmap_find(&map, 0));
    assert_null(intmap_remove(&map, 0));
    for (uint64_t i = 0; i < N_ELEMENTS(things); i++) {
        assert_null(intmap_put(&map, i * 4096, &things[i]));
    }
    assert_int_equal(map.count, N_ELEMENTS(things));
    for (uint64_t i = 0; i < N_ELEMENTS(things); i++) {
        assert_ptr_equal(intmap_find(&map, i * 4096), &things[i]);
    }
    assert_null(intmap_find(&map, 1));
    intmap_fini(&map);
}

static void putting_again_replaces(void **state)
{
    (void)state;
    struct intmap map;
    intmap_init(&map);
    assert_null(intmap_put(&map, UINT64_MAX, &things[0]));
    assert_ptr_equal(intmap_put(&map, UINT64_MAX, &things[1]), &things[0]);
    assert_int_equal(map.count, 1);
    assert_ptr_equal(intmap_find(&map, UINT64_MAX), &things[1]);
    intmap_fini(&map);
}

/* A map and a plain array go through the same random operations. */
static void a_map_agrees_with_an_array_under_random_use(void **state)
{
    (void)state;
    struct intmap map;
    intmap_init(&map);
    void *model[512] = {0};
    uint32_t random = 1;
    for (unsigned step = 0; step < 200000; step++) {
        random = random * 1664525u + 1013904223u;
        uint64_t key = (random >> 8) % N_ELEMENTS(model);
        void *value = &things[random % N_ELEMENTS(things)];
        switch ((random >> 24) % 3) {
        case 0:
            assert_ptr_equal(intmap_put(&map, key, value), model[key]);
            model[key] = value;
            break;
        case 1:
            assert_ptr_equal(intmap_remove(&map, key), model[key]);
            model[key] = NULL;
            break;
        default:
            assert_ptr_equal(intmap_find(&map, key), model[key]);
        }
    }
    size_t count = 0;
    for (size_t i = 0; i < N_ELEMENTS(model); i++) {
        count += model[i] != NULL;
    }
    assert_int_equal(map.count, count);
    assert_true(map.n_slots <= 2048);
    intmap_fini(&map);
}

static void swaps_reverse_the_bytes(void **state)
{
    (void)state;
    assert_int_equal(swap16(0x0102), 0x0201);
    assert_int_equal(swap32(0x01020304u), 0x04030201u);
    assert_true(swap64(UINT64_C(0x0102030405060708)) == UINT64_C(0x0807060504030201));
}

static void loads_heed_the_given_order(void **state)
{
    (void)state;
    const uint8_t bytes[4] = {1, 2, 3, 4};
    uint8_t stored[4];
    assert_int_equal(load_be32(bytes), 0x01020304u);
    assert_int_equal(load_32(bytes, ORDER_BIG), 0x01020304u);
    assert_int_equal(load_32(bytes, ORDER_LITTLE), 0x04030201u);
    store_be32(stored, 0x01020304u);
    assert_memory_equal(stored, bytes, 4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_start_at_zero_and_count_up),
        cmocka_unit_test(the_latest_freed_number_is_given_out_first),
        cmocka_unit_test(numbers_from_outside_are_checked),
        cmocka_unit_test(a_handle_finds_its_thing_and_no_later_one),
        cmocka_unit_test(a_map_finds_what_was_put),
        cmocka_unit_test(putting_again_replaces),
        cmocka_unit_test(a_map_agrees_with_an_array_under_random_use),
        cmocka_unit_test(swaps_reverse_the_bytes),
        cmocka_unit_test(loads_heed_the_given_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
