/* The memory of a monitor, each block allocated separately: sanitize.py replaces memory.c by this. */
#include "basics.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Declarations of AddressSanitizer, because not every compiler has its header. */
void __asan_poison_memory_region(const volatile void *place, size_t size);
void __asan_unpoison_memory_region(const volatile void *place, size_t size);

/* Stored before each block, and poisoned, so that accesses before the block are detected, too. */
typedef struct guarded_head {
    struct guarded_head *next;
    struct guarded_head *before;
    size_t size;
    size_t spare;
} guarded_head;

/* Larger totals are refused, as on a machine whose memory is short. */
#ifndef GUARDED_MOST
#define GUARDED_MOST ((size_t)1 << 26)
#endif

/* Bytes allocated and not yet freed. */
size_t guarded_in_use;

/* Whether a block was refused. */
bool guarded_refused;

/* Number of allocations that still succeed; negative: unlimited. */
long guarded_left = -1;

static guarded_head *guarded_opened(void *place)
{
    __asan_unpoison_memory_region(place, sizeof(guarded_head));
    return place;
}

static void guarded_closed(guarded_head *h)
{
    if (h != NULL) {
        __asan_poison_memory_region(h, sizeof *h);
    }
}

void *arena_take(arena *a, size_t size)
{
    guarded_head *h;
    guarded_head *next = (guarded_head *)(void *)a->chunks;
    if ((guarded_left == 0) || (size > GUARDED_MOST) || (guarded_in_use + size > GUARDED_MOST)) {
        guarded_refused = true;
        return NULL;
    }
    guarded_left -= (guarded_left > 0) ? 1 : 0;
    h = calloc(1, sizeof *h + size);
    if (h == NULL) {
        guarded_refused = true;
        return NULL;
    }
    guarded_in_use += size;
    a->used += size;
    h->size = size;
    h->next = next;
    if (next != NULL) {
        guarded_opened(next)->before = h;
        guarded_closed(next);
    }
    a->chunks = (chunk *)(void *)h;
    guarded_closed(h);
    return h + 1;
}

/* A larger block is always a new one; its bytes beyond the old size are filled with a pattern, so that
 * code that reads them uninitialised misbehaves visibly. */
void *arena_enlarge(arena *a, void *old, size_t size, size_t wanted)
{
    char *made = arena_take(a, wanted);
    if (made == NULL) {
        return NULL;
    }
    if (old != NULL) {
        (void)memcpy(made, old, size);
        arena_give(a, old, size);
    }
    (void)memset(made + ((old != NULL) ? size : 0), 0xa5, wanted - ((old != NULL) ? size : 0));
    return made;
}

void arena_move(arena *to, const arena *from)
{
    *to = *from;
}

void arena_give(arena *a, void *block, size_t size)
{
    guarded_head *h;
    if (block == NULL) {
        return;
    }
    h = guarded_opened((guarded_head *)block - 1);
    if (h->size < size) {
        (void)fprintf(stderr, "%zu bytes are given back of %zu\n", size, h->size);
        abort();
    }
    if (h->next != NULL) {
        guarded_opened(h->next)->before = h->before;
        guarded_closed(h->next);
    }
    if (h->before != NULL) {
        guarded_opened(h->before)->next = h->next;
        guarded_closed(h->before);
    } else {
        a->chunks = (chunk *)(void *)h->next;
    }
    guarded_in_use -= h->size;
    free(h);
}

void arena_release(arena *a)
{
    while (a->chunks != NULL) {
        guarded_head *h = guarded_opened(a->chunks);
        a->chunks = (chunk *)(void *)h->next;
        guarded_in_use -= h->size;
        free(h);
    }
}
