/* Formulas that speak of runs from a state: the valuations of each discrete state that satisfy them,
 * worked out backwards through delays and moves until nothing is new.
 *
 * Source: Henzinger, Nicollin, Sifakis, Yovine, Symbolic Model Checking for Real-Time Systems, 1994;
 * Bouyer et al., Model Checking Real-Time Systems, 2018, section 3 (backward analysis ends). */
#ifndef RVMON_ZONES_NESTED_H
#define RVMON_ZONES_NESTED_H

#include "search.h"

/* Note a move, whatever the clocks say, with its target: its guard with the source's invariant. */
static bool note_move(engine *h, walk *w, const int32_t *edges, int n)
{
    const uint32_t had = h->into_room;
    uint32_t *at;
    uint32_t target;
    labour(h);
    universe(w->zone, h->dim);
    if (!cut_guards(h, w, w->zone, edges, n)
        || !cut_invariant(h, w->zone, w->places, w->values)) {
        return runs(h) && !h->failed;
    }
    if (!apply(h, w, edges, n)) {
        const bool numbers_fit = h->failed;
        h->failed = false; /* the search forwards tells it, if it can happen */
        return numbers_fit && runs(h);
    }
    if (!invariant_data_holds(h, w->target, w->changed)) {
        return !h->failed;
    }
    pack(h, w->target, w->changed, 0, h->packed);
    at = find_state(h, h->packed);
    if ((at == NULL)
        || ((*at == NONE) && !add_state(h, at, may_delay(h, w->target, w->changed)))) {
        return false;
    }
    target = *at;
    if (!ROOM(h, h->into, h->into_room, (uint64_t)target + 1)) {
        return false;
    }
    (void)memset(h->into + had, 0xff, (h->into_room - had) * sizeof *h->into);
    if (!ROOM(h, h->arrows, h->arrow_room, (uint64_t)h->arrow_count + 1)
        || !ROOM(h, h->pool, h->pool_room, (uint64_t)h->pool_count + 2 * (uint64_t)w->reset_count + 1)
        || !push_zone(h, &h->guards, w->zone)) {
        return false;
    }
    h->arrows[h->arrow_count] = (arrow){h->from_node, h->into[target], h->pool_count};
    h->into[target] = h->arrow_count++;
    h->pool[h->pool_count++] = w->reset_count;
    (void)memcpy(h->pool + h->pool_count, w->resets,
                 2 * (size_t)w->reset_count * sizeof *w->resets);
    h->pool_count += 2 * (uint32_t)w->reset_count;
    return runs(h);
}

/* All discrete states that moves lead to, whatever the clocks say. */
static void find_moves(engine *h)
{
    walk *w = &h->out;
    uint32_t s;
    uint32_t *at;
    pack(h, w->target, w->changed, 0, h->packed);
    at = find_state(h, h->packed);
    if ((at == NULL) || !add_state(h, at, may_delay(h, w->target, w->changed))) {
        return;
    }
    for (s = 0; (s < h->state_count) && runs(h); s++) {
        visit(h);
        unpack(h, s, w->places, w->values);
        h->from_node = s;
        if (!each_move(h, w, note_move)) {
            break;
        }
    }
    h->from_node = NONE;
}

static federation *reaching(engine *h, int32_t row);

/* Add the valuations of a state that satisfy its invariant and a row of the tree. */
static void satisfy(engine *h, int32_t row, uint32_t s, const int32_t *places,
                    int32_t *values, federation *out)
{
    const int32_t *r = plan_rows(h->plan, AT_TREE) + (ptrdiff_t)3 * row;
    federation *reach;
    uint32_t i;
    uint32_t j;
    if (!runs(h) || h->failed) {
        return;
    }
    if (r[0] == TREE_OR) {
        satisfy(h, r[1], s, places, values, out);
        satisfy(h, r[2], s, places, values, out);
    } else if (r[0] == TREE_AND) {
        federation a = {0, 0, NULL};
        federation b = {0, 0, NULL};
        satisfy(h, r[1], s, places, values, &a);
        satisfy(h, r[2], s, places, values, &b);
        for (i = 0; i < a.count; i++) {
            for (j = 0; (j < b.count) && runs(h); j++) {
                labour(h);
                if (!push_zone(h, out, nth(h, &a, i))) {
                    break;
                }
                if (!cut_zone(h, nth(h, out, out->count - 1), nth(h, &b, j))) {
                    out->count--;
                } else if (!fits(h, nth(h, out, out->count - 1))) {
                    break;
                }
            }
        }
        give_back(h, &a);
        give_back(h, &b);
    } else if (r[0] == TREE_PLAIN) {
        const int32_t *piece = plan_rows(h->plan, AT_PIECES) + (ptrdiff_t)ROW_SIZE * r[1];
        int32_t k;
        for (k = 0; (k < r[2]) && runs(h) && !h->failed; k++, piece += ROW_SIZE) {
            bound *z = push(h, out);
            if (z != NULL) {
                universe(z, h->dim);
                if (!cut_invariant(h, z, places, values)
                    || !cut_row(h, z, piece, places, values)) {
                    out->count--;
                }
            }
        }
    } else {
        reach = reaching(h, r[1]);
        if ((reach == NULL) || !runs(h)) {
            return;
        }
        if (r[0] == TREE_CAN) {
            for (i = 0; (i < reach[s].count) && push_zone(h, out, nth(h, &reach[s], i)); i++) {
            }
            return;
        }
        universe(h->copy, h->dim);
        h->dead.count = 0;
        if (!cut_invariant(h, h->copy, places, values) || !push_zone(h, &h->dead, h->copy)) {
            return;
        }
        for (i = 0; (i < reach[s].count) && subtract(h, nth(h, &reach[s], i)); i++) {
        }
        for (i = 0; (i < h->dead.count) && push_zone(h, out, nth(h, &h->dead, i)); i++) {
        }
    }
}

/* Keep what leads to where something can be reached, unless it is known. */
static void note_reaching(engine *h, federation *known, uint32_t s, bound *z)
{
    uint32_t i = 0;
    if (h->delays[s]) {
        before(z, h->dim);
    }
    labour(h);
    for (i = 0; i < known->count; i++) {
        if (is_within(z, nth(h, known, i), h->entries)) {
            return;
        }
    }
    for (i = 0; i < known->count;) {
        if (is_within(nth(h, known, i), z, h->entries)) {
            known->count--;
            if (i < known->count) {
                copy_zone(h, nth(h, known, i), nth(h, known, known->count));
            }
        } else {
            i++;
        }
    }
    if (!fits(h, z) || !push_zone(h, known, z) || !push_zone(h, &h->pending, z)
        || !ROOM(h, h->whose, h->whose_room, (uint64_t)h->whose_count + 1)) {
        return;
    }
    h->whose[h->whose_count++] = s;
    visit(h);
}

/* The valuations from which a move leads into a zone of its target, in place; false if there are none. */
static bool back(engine *h, uint32_t m, bound *z)
{
    const int32_t *resets = h->pool + h->arrows[m].resets;
    const int d = h->dim;
    int i;
    int j;
    for (i = 0; i < resets[0]; i++) {
        const int c = resets[1 + 2 * i];
        const bound n = resets[2 + 2 * i];
        if (!constrain(z, d, 0, c, 2 * n + 1) || !constrain(z, d, c, 0, -2 * n + 1)) {
            return false;
        }
        (void)memcpy(z + c * d, z, (size_t)d * sizeof *z);
        for (j = 0; j < d; j++) {
            z[j * d + c] = UNBOUNDED;
        }
        z[c * d] = AT_ONCE;
        z[c * d + c] = AT_ONCE;
    }
    return cut_zone(h, z, nth(h, &h->guards, m));
}

/* For each state the valuations from which a row of the tree can be reached; found once. */
static federation *reaching(engine *h, int32_t row)
{
    bound *z = h->between; /* used by nothing else in this kind of search */
    walk *w = &h->look;
    uint32_t room = 0;
    uint32_t s;
    uint32_t q;
    federation *found = h->reaching[row];
    if ((found != NULL) || !runs(h)) {
        return found;
    }
    found = enlarge(h, NULL, &room, h->state_count, sizeof *found);
    if (found == NULL) {
        return NULL;
    }
    (void)memset(found, 0, room * sizeof *found);
    h->reaching[row] = found;
    h->reaching_room[row] = room;
    for (s = 0; (s < h->state_count) && runs(h) && !h->failed; s++) {
        federation here = {0, 0, NULL};
        unpack(h, s, w->places, w->values);
        satisfy(h, row, s, w->places, w->values, &here);
        if (s == 0) {
            /* rows within this one are found by now, and left nothing pending */
            h->pending.count = 0;
            h->whose_count = 0;
        }
        for (q = 0; (q < here.count) && runs(h); q++) {
            copy_zone(h, z, nth(h, &here, q));
            note_reaching(h, found + s, s, z);
        }
        give_back(h, &here);
    }
    for (q = 0; (q < h->whose_count) && runs(h); q++) {
        const uint32_t to = h->whose[q];
        uint32_t m = (to < h->into_room) ? h->into[to] : NONE;
        for (; (m != NONE) && runs(h); m = h->arrows[m].next) {
            copy_zone(h, z, nth(h, &h->pending, q));
            labour(h);
            if (back(h, m, z)) {
                note_reaching(h, found + h->arrows[m].from, h->arrows[m].from, z);
            }
        }
    }
    return found;
}

static bool in_nested(engine *h, const bound *z, const int32_t *places, int32_t *values)
{
    federation sought = {0, 0, NULL};
    uint32_t *at;
    uint32_t i;
    pack(h, places, values, 0, h->packed);
    at = find_state(h, h->packed);
    if ((at == NULL) || (*at == NONE)) {
        return false;
    }
    satisfy(h, plan_count(h->plan, AT_TREE) - 1, *at, places, values, &sought);
    for (i = 0; (i < sought.count) && runs(h); i++) {
        copy_zone(h, h->copy, z);
        if (cut_zone(h, h->copy, nth(h, &sought, i))) {
            (void)push_zone(h, &h->parts, h->copy);
        }
    }
    give_back(h, &sought);
    return h->parts.count > 0;
}

#endif
