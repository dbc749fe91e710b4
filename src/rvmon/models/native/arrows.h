/* The moves between all discrete states, ignoring clocks, for backward search. */
#ifndef RVMON_ZONES_ARROWS_H
#define RVMON_ZONES_ARROWS_H

#include "unions.h"

/* Store a move with its target, and with its guard intersected with the invariant of its source. */
static bool note_move(engine *h, walk *w, const int32_t *edges, int n)
{
    const uint32_t had = h->into_room;
    uint32_t target;
    count_work(h);
    universe(w->zone, h->dim);
    if (!cut_guards(h, w, w->zone, edges, n)
        || !cut_invariant(h, w->zone, &w->here)) {
        return runs(h) && !h->failed;
    }
    if (!apply(h, w, edges, n)) {
        const bool update_failed = h->failed;
        h->failed = false; /* the forward search reports it, if it can happen */
        return update_failed && runs(h);
    }
    if (!invariant_data_holds(h, &w->there)) {
        return !h->failed;
    }
    target = state_of(h, &w->there, 0);
    if ((target == NONE) || !ROOM(h, h->into, h->into_room, (uint64_t)target + 1)) {
        return false;
    }
    (void)memset(h->into + had, 0xff, (h->into_room - had) * sizeof *h->into);
    if (!ROOM(h, h->arrows, h->arrow_room, (uint64_t)h->arrow_count + 1)
        || !ROOM(h, h->pool, h->pool_room, (uint64_t)h->pool_count + 2 * (uint64_t)w->reset_count + 1)
        || !push_zone(h, &h->guards, w->zone)) {
        return false;
    }
    h->arrows[h->arrow_count] = (arrow){h->from_node, target, h->into[target], h->pool_count};
    h->into[target] = h->arrow_count++;
    h->pool[h->pool_count++] = w->reset_count;
    (void)memcpy(h->pool + h->pool_count, w->resets,
                 2 * (size_t)w->reset_count * sizeof *w->resets);
    h->pool_count += 2 * (uint32_t)w->reset_count;
    return runs(h);
}

/* Find all discrete states that are reachable if clocks are ignored, and the moves between them. */
static void find_moves(engine *h)
{
    walk *w = &h->out;
    uint32_t s;
    (void)state_of(h, &w->there, 0);
    for (s = 0; (s < h->state_count) && runs(h); s++) {
        visit(h);
        unpack(h, s, &w->here);
        h->from_node = s;
        if (!ROOM(h, h->out_of, h->out_of_room, (uint64_t)s + 2)) {
            break;
        }
        h->out_of[s] = h->arrow_count;
        if (!each_move(h, w, note_move)) {
            break;
        }
        h->out_of[s + 1] = h->arrow_count;
    }
    h->from_node = NONE;
}

/* The valuations from which a move leads into a zone of its target, in place; false if there are none. */
static bool back(engine *h, uint32_t m, bound *z)
{
    const int32_t *resets = h->pool + h->arrows[m].resets;
    int i;
    for (i = 0; i < resets[0]; i++) {
        if (!undo(z, h->dim, resets[1 + 2 * i], resets[2 + 2 * i])) {
            return false;
        }
    }
    return cut_zone(h, z, nth(h, &h->guards, m));
}

#endif
