/* Nested path formulas: the valuations of each discrete state that satisfy them, computed backwards
 * through delays and moves up to a fixed point. A row of the tree is computed after the rows that it
 * refers to. A row with a bound measures time by the timer, which starts at 0 and is projected away
 * afterwards.
 *
 * Source: Henzinger, Nicollin, Sifakis, Yovine, Symbolic Model Checking for Real-Time Systems, 1994;
 * Bouyer et al., Model Checking Real-Time Systems, 2018, section 3 (backward analysis ends). */
#ifndef RVMON_ZONES_NESTED_H
#define RVMON_ZONES_NESTED_H

#include "arrows.h"

/* --- rows ------------------------------------------------------------------------------------------ */

static const int32_t *tree_row(const engine *h, int32_t row)
{
    return plan_rows(h->plan, AT_TREE) + (ptrdiff_t)TREE_SIZE * row;
}

/* Empty the unions of all states in a table, which is allocated if it is new. */
static federation *clear_table(engine *h, int32_t t)
{
    uint32_t s;
    if (h->tables[t] == NULL) {
        h->tables[t] = enlarge(h, NULL, &h->table_rooms[t], h->state_count, sizeof **h->tables);
    }
    for (s = 0; (h->tables[t] != NULL) && (s < h->state_count); s++) {
        empty(h, &h->tables[t][s]);
    }
    return h->tables[t];
}

/* Add the valuations of a state that satisfy its invariant and a row of the tree. */
static void satisfy(engine *h, int32_t row, uint32_t s, federation *out)
{
    const int32_t *r = tree_row(h, row);
    federation a = {0, 0, NULL};
    federation b = {0, 0, NULL};
    walk *w = &h->look;
    if (!runs(h) || h->failed) {
        return;
    }
    if (r[TREE_KIND] == TREE_OR) {
        satisfy(h, r[TREE_LEFT], s, out);
        satisfy(h, r[TREE_RIGHT], s, out);
    } else if (r[TREE_KIND] == TREE_AND) {
        satisfy(h, r[TREE_LEFT], s, &a);
        satisfy(h, r[TREE_RIGHT], s, &b);
        meet(h, out, &a, &b);
    } else if (r[TREE_KIND] == TREE_NOT) {
        everywhere(h, s, &a);
        satisfy(h, r[TREE_LEFT], s, &b);
        (void)subtract_all(h, &a, &b);
        join_all(h, out, &a);
    } else if (r[TREE_KIND] == TREE_PLAIN) {
        const int32_t *piece = plan_rows(h->plan, AT_PIECES) + (ptrdiff_t)ROW_SIZE * r[TREE_LEFT];
        int32_t k;
        unpack(h, s, &w->here);
        for (k = 0; (k < r[TREE_RIGHT]) && runs(h) && !h->failed; k++, piece += ROW_SIZE) {
            universe(h->copy, h->dim);
            if (cut_invariant(h, h->copy, &w->here)
                && cut_row(h, h->copy, piece, &w->here)) {
                (void)join(h, out, h->copy);
            }
        }
    } else {
        join_all(h, out, &h->tables[row][s]);
    }
    empty(h, &a);
    empty(h, &b);
}

/* Add the valuations from which a delay leads into a zone; new ones are queued for the next round. */
static void note_reaching(engine *h, uint32_t s, const bound *z, const federation *bad,
                          federation *found)
{
    federation more = {0, 0, NULL};
    uint32_t i;
    add_earlier(h, s, z, &bad[s], &more);
    for (i = 0; (i < more.count) && runs(h); i++) {
        if (join(h, found + s, nth(h, &more, i)) && push_zone(h, &h->pending, nth(h, &more, i))
            && ROOM(h, h->whose, h->whose_room, (uint64_t)h->whose_count + 1)) {
            h->whose[h->whose_count++] = s;
            visit(h);
        }
    }
    empty(h, &more);
}

/* The valuations from which some run satisfies `left until right`, within the bound if there is one. */
static void solve_until(engine *h, const int32_t *r, federation *found, federation *bad)
{
    bound *z = h->between; /* unused in this kind of search */
    federation good = {0, 0, NULL};
    federation left = {0, 0, NULL};
    uint32_t s;
    uint32_t k;
    uint32_t m;
    h->pending.count = 0;
    h->whose_count = 0;
    for (s = 0; (s < h->state_count) && runs(h) && !h->failed; s++) {
        good.count = 0;
        satisfy(h, r[TREE_RIGHT], s, &good);
        if (r[TREE_LEFT] >= 0) {
            left.count = 0;
            satisfy(h, r[TREE_LEFT], s, &left);
            everywhere(h, s, &bad[s]);
            (void)subtract_all(h, &bad[s], &good);
            (void)subtract_all(h, &bad[s], &left);
        }
        for (k = 0; (k < good.count) && runs(h); k++) {
            copy_zone(h, z, nth(h, &good, k));
            if ((r[TREE_BOUND] < 0)
                || constrain(z, h->dim, 0, h->timer, 2 * (bound)r[TREE_BOUND] + 1)) {
                note_reaching(h, s, z, bad, found);
            }
        }
    }
    empty(h, &good);
    empty(h, &left);
    for (k = 0; (k < h->whose_count) && runs(h); k++) {
        const uint32_t to = h->whose[k];
        for (m = (to < h->into_room) ? h->into[to] : NONE; (m != NONE) && runs(h);
             m = h->arrows[m].next) {
            copy_zone(h, z, nth(h, &h->pending, k));
            if (back(h, m, z)) {
                note_reaching(h, h->arrows[m].from, z, bad, found);
            }
        }
    }
}

/* Add the valuations from which the next move, now or after a delay, can lead to where a row holds, or
 * anywhere (row < 0). */
static void solve_next(engine *h, int32_t row, uint32_t s, federation *out)
{
    federation there = {0, 0, NULL};
    bound *z = h->between;
    uint32_t m;
    uint32_t k;
    for (m = h->out_of[s]; (m < h->out_of[s + 1]) && runs(h); m++) {
        there.count = 0;
        if (row < 0) {
            everywhere(h, h->arrows[m].to, &there);
        } else {
            satisfy(h, row, h->arrows[m].to, &there);
        }
        for (k = 0; (k < there.count) && runs(h); k++) {
            copy_zone(h, z, nth(h, &there, k));
            if (back(h, m, z)) {
                if (h->delays[s]) {
                    before(z, h->dim);
                }
                (void)join(h, out, z);
            }
        }
    }
    empty(h, &there);
}

/* Add the valuations from which a run can stay without a move: time is unbounded, or stops. */
static void add_ends(engine *h, uint32_t s, const federation *outside, federation *out)
{
    walk *w = &h->look;
    federation left = {0, 0, NULL};
    federation alive = {0, 0, NULL};
    uint32_t k;
    bool open;
    unpack(h, s, &w->here);
    open = h->delays[s] && (invariant_of(h, &w->here) == 0);
    everywhere(h, s, &left);
    if (!open) {
        solve_next(h, -1, s, &alive);
        (void)subtract_all(h, &left, &alive);
    }
    for (k = 0; (k < outside->count) && (left.count > 0) && runs(h); k++) {
        copy_zone(h, h->between, nth(h, outside, k));
        if (h->delays[s]) {
            before(h->between, h->dim);
        }
        (void)subtract(h, &left, h->between);
    }
    join_all(h, out, &left);
    empty(h, &left);
    empty(h, &alive);
}

/* Reduce the valuations of a state to those from which a run ends there, or leads to valuations that are
 * still in `stays`; returns whether any were removed. */
static bool shrink(engine *h, uint32_t s, const federation *outside, const federation *ends,
                   federation *stays)
{
    federation now = {0, 0, NULL};
    bound *z = h->between;
    uint32_t m;
    uint32_t k;
    bool less;
    for (k = 0; (k < ends->count) && runs(h); k++) {
        add_earlier(h, s, nth(h, ends, k), outside, &now);
    }
    for (m = h->out_of[s]; (m < h->out_of[s + 1]) && runs(h); m++) {
        const federation *to = stays + h->arrows[m].to;
        for (k = 0; (k < to->count) && runs(h); k++) {
            copy_zone(h, z, nth(h, to, k));
            if (back(h, m, z)) {
                add_earlier(h, s, z, outside, &now);
            }
        }
    }
    swap(&now, stays + s);
    (void)subtract_all(h, &now, stays + s);
    less = now.count > 0;
    empty(h, &now);
    return less;
}

/* The valuations from which some run stays where a row holds, forever or until the bound is over: the
 * greatest fixed point, from all valuations in which the row holds. */
static void solve_stay(engine *h, const int32_t *r, federation *stays, federation *outside,
                       federation *ends)
{
    bool changed = true;
    uint32_t s;
    uint32_t m;
    for (s = 0; (s < h->state_count) && runs(h) && !h->failed; s++) {
        satisfy(h, r[TREE_LEFT], s, &stays[s]);
        everywhere(h, s, &outside[s]);
        if ((r[TREE_BOUND] >= 0) && (outside[s].count > 0)) {
            copy_zone(h, h->between, outside[s].zones);
            if (constrain(h->between, h->dim, h->timer, 0, -2 * (bound)r[TREE_BOUND])) {
                (void)join(h, &stays[s], h->between);
            }
        }
        (void)subtract_all(h, &outside[s], &stays[s]);
        add_ends(h, s, &outside[s], &ends[s]);
    }
    if (!ROOM(h, h->whose, h->whose_room, h->state_count)) {
        return;
    }
    (void)memset(h->whose, 1, h->state_count * sizeof *h->whose); /* the states to visit in the next round */
    while (changed && runs(h) && !h->failed) {
        changed = false;
        for (s = h->state_count; (s-- > 0) && runs(h);) {
            if (h->whose[s] == 0) {
                continue;
            }
            h->whose[s] = 0;
            visit(h);
            if (shrink(h, s, &outside[s], &ends[s], stays)) {
                for (m = (s < h->into_room) ? h->into[s] : NONE; m != NONE; m = h->arrows[m].next) {
                    h->whose[h->arrows[m].from] = 1;
                    changed = true;
                }
            }
        }
    }
}

/* Project away the timer, from valuations in which it is 0. */
static void forget_timer(engine *h, federation *f)
{
    uint32_t k;
    for (k = 0; k < f->count;) {
        if (undo(nth(h, f, k), h->dim, h->timer, 0)) {
            k++;
        } else if (--f->count > k) {
            copy_zone(h, nth(h, f, k), nth(h, f, f->count));
        }
    }
}

/* Compute all rows with path formulas, in order. */
static void solve(engine *h)
{
    const int32_t rows = plan_count(h->plan, AT_TREE);
    int32_t row;
    uint32_t s;
    for (row = 0; (row < rows) && runs(h) && !h->failed; row++) {
        const int32_t *r = tree_row(h, row);
        federation *found;
        federation *outside = clear_table(h, rows);
        federation *ends = clear_table(h, rows + 1);
        if ((r[TREE_KIND] < TREE_UNTIL) || (outside == NULL) || (ends == NULL)) {
            continue;
        }
        found = clear_table(h, row);
        if (found == NULL) {
            return;
        }
        if (r[TREE_KIND] == TREE_UNTIL) {
            solve_until(h, r, found, outside);
        } else if (r[TREE_KIND] == TREE_STAY) {
            solve_stay(h, r, found, outside, ends);
        }
        for (s = 0; (s < h->state_count) && runs(h) && !h->failed; s++) {
            if (r[TREE_KIND] == TREE_NEXT) {
                solve_next(h, r[TREE_LEFT], s, &found[s]);
            } else if (r[TREE_BOUND] >= 0) {
                forget_timer(h, &found[s]);
            }
        }
    }
}

static bool meets_nested(engine *h, const bound *z, const spot *here)
{
    federation sought = {0, 0, NULL};
    uint32_t *at;
    uint32_t i;
    pack(h, here, 0, h->packed);
    at = find_state(h, h->packed);
    if ((at == NULL) || (*at == NONE)) {
        return false;
    }
    satisfy(h, plan_count(h->plan, AT_TREE) - 1, *at, &sought);
    for (i = 0; (i < sought.count) && runs(h); i++) {
        copy_zone(h, h->copy, z);
        if (cut_zone(h, h->copy, nth(h, &sought, i))) {
            (void)push_zone(h, &h->parts, h->copy);
        }
    }
    empty(h, &sought);
    return h->parts.count > 0;
}

#endif
