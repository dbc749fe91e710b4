/* Timers: a binary heap of ids, least `due` first, with the place of each id in it.
 *
 * Ids are fixed (nodes, judges, runs), with one timer each; a timer at NEVER is not in the heap. Reading
 * the next timer costs O(1), a change O(log n). Nothing is popped: a timer's handler sets it again. */
#include "formulas/formulas.h"

/* Store an id at a place of the heap. */
static void put(timers *h, int32_t place, int32_t id)
{
    h->ids[place] = id;
    h->place[id] = place;
}

/* Restore the order for an entry that may be due before its parent; sink() does so for children. */
static void rise(timers *h, int32_t from)
{
    const int32_t id = h->ids[from];
    int32_t place = from;
    while (place > 0) {
        const int32_t above = (place - 1) / 2;
        if (h->due[h->ids[above]] <= h->due[id]) {
            break;
        }
        put(h, place, h->ids[above]);
        place = above;
    }
    put(h, place, id);
}

static void sink(timers *h, int32_t from)
{
    const int32_t id = h->ids[from];
    int32_t place = from;
    for (;;) {
        int32_t below = 2 * place + 1;
        if (below >= h->count) {
            break;
        }
        if ((below + 1 < h->count) && (h->due[h->ids[below + 1]] < h->due[h->ids[below]])) {
            below++;
        }
        if (h->due[h->ids[below]] >= h->due[id]) {
            break;
        }
        put(h, place, h->ids[below]);
        place = below;
    }
    put(h, place, id);
}

/* Put an id in, take it out, or move it. A hole is filled with the last entry, which may have to go
 * either way. */
static void move(timers *h, int32_t id, int64_t due)
{
    const int64_t was = h->due[id];
    h->due[id] = due;
    if (was == NEVER) {
        put(h, h->count, id);
        h->count++;
        rise(h, h->count - 1);
    } else if (due == NEVER) {
        const int32_t place = h->place[id];
        h->count--;
        if (place < h->count) {
            const int32_t moved = h->ids[h->count];
            put(h, place, moved);
            rise(h, place);
            sink(h, h->place[moved]);
        }
    } else if (due < was) {
        rise(h, h->place[id]);
    } else {
        sink(h, h->place[id]);
    }
}

void timers_set(timers *h, int32_t id, int64_t due)
{
    if (h->due[id] != due) {
        move(h, id, due);
        h->next = (h->count > 0) ? h->due[h->ids[0]] : NEVER;
    }
}

void timers_clear(timers *h, int32_t ids)
{
    int32_t i;
    h->next = NEVER;
    h->count = 0;
    for (i = 0; i < ids; i++) {
        h->due[i] = NEVER;
    }
}

int32_t timers_due(const timers *h, int64_t t, int32_t *found)
{
    int32_t count = 0;
    int32_t looked = 0;
    /* Breadth first through the top of the heap, as children are due no sooner than their parent: O(ids
     * found). `found` serves as the queue, too: places from `looked` on, ids before. */
    if ((h->count > 0) && (h->due[h->ids[0]] <= t)) {
        found[count++] = 0;
    }
    while (looked < count) {
        const int32_t below = 2 * found[looked] + 1;
        int32_t i;
        for (i = below; (i <= below + 1) && (i < h->count); i++) {
            if (h->due[h->ids[i]] <= t) {
                found[count++] = i;
            }
        }
        found[looked] = h->ids[found[looked]];
        looked++;
    }
    return count;
}
