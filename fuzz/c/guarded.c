/* The memory of a monitor, each block by itself, so that AddressSanitizer sees one step beyond it,
 * and every use after it was given back. The core's own puts many blocks into one. */
#include "state.h"

#include <stdio.h>
#include <stdlib.h>

/* Of AddressSanitizer; not every compiler brings the header. */
void __asan_poison_memory_region(const volatile void *place, size_t size);
void __asan_unpoison_memory_region(const volatile void *place, size_t size);

/* Before each block; poisoned, so that a step before the block is seen, too. */
typedef struct head {
    struct head *next;
    struct head *before;
    size_t size;
    size_t spare;
} head;

/* More than this altogether is refused, as of a machine whose memory is short. */
#define MOST ((size_t)1 << 26)

static size_t in_use;

/* So many blocks more are given, then none; negative: all are. */
long guarded_left = -1;

static head *opened(void *place)
{
    __asan_unpoison_memory_region(place, sizeof(head));
    return place;
}

static void closed(head *h)
{
    if (h != NULL) {
        __asan_poison_memory_region(h, sizeof *h);
    }
}

void *arena_take(arena *a, size_t size)
{
    head *h;
    head *next = (head *)(void *)a->chunks;
    if ((guarded_left == 0) || (size > MOST) || (in_use + size > MOST)) {
        return NULL;
    }
    guarded_left -= (guarded_left > 0) ? 1 : 0;
    h = calloc(1, sizeof *h + size);
    if (h == NULL) {
        return NULL;
    }
    in_use += size;
    a->used += size;
    h->size = size;
    h->next = next;
    if (next != NULL) {
        opened(next)->before = h;
        closed(next);
    }
    a->chunks = (chunk *)(void *)h;
    closed(h);
    return h + 1;
}

void arena_give(arena *a, void *block, size_t size)
{
    head *h;
    if (block == NULL) {
        return;
    }
    h = opened((head *)block - 1);
    if (h->size < size) {
        (void)fprintf(stderr, "%zu bytes are given back of %zu\n", size, h->size);
        abort();
    }
    if (h->next != NULL) {
        opened(h->next)->before = h->before;
        closed(h->next);
    }
    if (h->before != NULL) {
        opened(h->before)->next = h->next;
        closed(h->before);
    } else {
        a->chunks = (chunk *)(void *)h->next;
    }
    in_use -= h->size;
    free(h);
}

void arena_release(arena *a)
{
    while (a->chunks != NULL) {
        head *h = opened(a->chunks);
        a->chunks = (chunk *)(void *)h->next;
        in_use -= h->size;
        free(h);
    }
}
