/* The list of visited zones with its subsumption, and the goals of a search. */
#ifndef RVMON_ZONES_REACH_H
#define RVMON_ZONES_REACH_H

#include "moves.h"

/* --- subsumption of zones with respect to the abstraction aLU -----------------------------------
 * Source: Herbreteau, Srivathsan, Walukiewicz, Better Abstractions for Timed Automata, LICS 2012. */

/* The least values that entries of a zone need to subsume z; returns their number. */
static int make_test(engine *h, const bound *z)
{
    const int d = h->dim;
    int n = 0;
    int i;
    int j;
    for (i = 0; i < h->upper_count; i++) {
        const int x = h->uppers[i];
        bound low = z[x * d];
        if (low < -2 * h->upper[x] + 1) {
            continue;
        }
        low += low & 1;
        for (j = 0; j < h->lower_count; j++) {
            const int y = h->lowers[j];
            if (x != y) {
                const bound least = low + 2 * h->lower[y];
                h->test_entries[n] = x * d + y;
                h->test_least[n++] = (z[x * d + y] < least) ? z[x * d + y] : least;
            }
        }
    }
    return n;
}

/* Whether a zone subsumes z: the same test for a single zone. */
static bool subsumes(const engine *h, const bound *large, const bound *z)
{
    const int d = h->dim;
    int i;
    int j;
    for (i = 0; i < h->upper_count; i++) {
        const int x = h->uppers[i];
        bound low = z[x * d];
        if (low < -2 * h->upper[x] + 1) {
            continue;
        }
        low += low & 1;
        for (j = 0; j < h->lower_count; j++) {
            const int y = h->lowers[j];
            const int e = x * d + y;
            if ((x != y) && (large[e] < z[e]) && (large[e] < low + 2 * h->lower[y])) {
                return false;
            }
        }
    }
    return true;
}

/* Store z unless a zone of its state subsumes it; returns its node (the given or a new one), or NONE. */
static uint32_t keep(engine *h, uint32_t state, uint32_t n, const bound *z, const spot *here)
{
    const bool best = h->policy != POLICY_SHORTEST;
    int tests = 0;
    uint32_t *at = h->heads + state;
    if (*at != NONE) {
        find_limits(h, here);
        tests = make_test(h, z);
    }
    while (*at != NONE) {
        const uint32_t k = *at;
        const bound *old = zone_of(h, k);
        int i = 0;
        while ((i < tests) && (old[h->test_entries[i]] >= h->test_least[i])) {
            i++;
        }
        if (i == tests) { /* move it to the front: it is likely to subsume the next zone, too */
            *at = h->nodes[k].next;
            h->nodes[k].next = h->heads[state];
            h->heads[state] = k;
            return NONE;
        }
        at = &h->nodes[k].next;
    }
    at = h->heads + state;
    while (!best && (*at != NONE)) {
        const uint32_t k = *at;
        if (subsumes(h, z, zone_of(h, k))) {
            *at = h->nodes[k].next;
            drop_zone(h, k);
            h->stored--;
        } else {
            at = &h->nodes[k].next;
        }
    }
    if (n == NONE) {
        n = new_node(h, state, z);
    }
    if (n != NONE) {
        h->nodes[n].next = h->heads[state];
        h->heads[state] = n;
        h->stored++;
    }
    return n;
}

/* --- deadlocks ---------------------------------------------------------------------------------- */

/* Add the valuations from which a move can be taken, now or after a delay, to `alive`. */
static bool note_alive(engine *h, walk *w, const int32_t *edges, int n)
{
    bound *z = w->zone;
    bool fit;
    int bounds;
    int i;
    count_work(h);
    universe(z, h->dim);
    if (!cut_guards(h, w, z, edges, n) || !cut_invariant(h, z, &w->here)) {
        return runs(h) && !h->failed;
    }
    if (!apply(h, w, edges, n)) { /* a move whose update fails can still be taken: no deadlock */
        if (!h->failed) {
            return false;
        }
        h->failed = false;
        w->reset_count = 0;
        copy_spot(h, &w->there, &w->here);
    }
    if (!invariant_data_holds(h, &w->there)) {
        return !h->failed;
    }
    bounds = invariant_after(h, w);
    fit = bounds >= 0;
    for (i = 0; fit && (i < bounds); i++) {
        fit = constrain(z, h->dim, 0, h->tightest[i], h->tightest_bound[i]);
    }
    if (!fit) {
        return runs(h) && !h->failed;
    }
    if (w->delays) {
        before(z, h->dim);
    }
    return fits(h, z) && push_zone(h, &h->alive, z) && runs(h);
}

/* Compute the part of a zone from which no edge can ever be taken, in `dead`; false if that failed. */
static bool find_dead(engine *h, const bound *z, const spot *here)
{
    walk *w = &h->look;
    copy_spot(h, &w->here, here);
    w->delays = may_delay(h, here);
    h->alive.count = 0;
    h->dead.count = 0;
    return push_zone(h, &h->dead, z) && each_move(h, w, note_alive)
           && subtract_all(h, &h->dead, &h->alive);
}

/* --- goals --------------------------------------------------------------------------------------- */

/* The least value of the timer; slightly more if it is not attained. */
static double price_of(const engine *h, const bound *z)
{
    const bound low = z[h->timer * h->dim];
    return (double)(-(low >> 1)) + (((low & 1) != 0) ? 0.0 : 0x1p-20);
}

/* The least price of the parts at the goal; the cheapest part is moved to the front. */
static double cheapest(engine *h)
{
    bound *first = h->parts.zones;
    uint32_t k;
    for (k = 1; k < h->parts.count; k++) {
        if (price_of(h, nth(h, &h->parts, k)) < price_of(h, first)) {
            copy_zone(h, first, nth(h, &h->parts, k));
        }
    }
    return price_of(h, first);
}

/* Intersect a zone with the alternatives of a section, in `parts`; false if nothing is left. */
static bool meets_rows(engine *h, const bound *z, int section, const spot *here)
{
    const int32_t *row = plan_rows(h->plan, section);
    int32_t k;
    for (k = 0; k < plan_count(h->plan, section); k++, row += ROW_SIZE) {
        if (!holds(h, row[ROW_CONDITION], here) || h->failed) {
            continue;
        }
        copy_zone(h, h->copy, z);
        if (!cut_atoms(h, h->copy, row[ROW_ATOM], row[ROW_ATOMS], here)) {
            continue;
        }
        if (row[ROW_ATOMS] == 0) {
            h->parts.count = 0;
            return (h->kind == SEEK_GOAL) || push_zone(h, &h->parts, z);
        }
        if (!push_zone(h, &h->parts, h->copy)) {
            return false;
        }
        if (h->policy != POLICY_FASTEST) {
            return true;
        }
    }
    return h->parts.count > 0;
}

/* The same for goals in states with a deadlock (AT_INSIDE) and in states without (AT_GOAL). */
static bool meets_at_deadlock(engine *h, const bound *z, const spot *here)
{
    const int sections[2] = {AT_INSIDE, AT_GOAL};
    bool some[2] = {false, false};
    uint32_t k;
    int side;
    for (side = 0; side < 2; side++) {
        const int32_t *row = plan_rows(h->plan, sections[side]);
        int32_t i;
        for (i = 0; i < plan_count(h->plan, sections[side]); i++, row += ROW_SIZE) {
            some[side] = some[side] || holds(h, row[ROW_CONDITION], here);
        }
    }
    if (h->failed || (!some[0] && !some[1]) || !find_dead(h, z, here)) {
        return false;
    }
    for (k = 0; some[0] && (k < h->dead.count); k++) {
        if (meets_rows(h, nth(h, &h->dead, k), AT_INSIDE, here)) {
            h->ending = END_DEAD;
            return true;
        }
    }
    if (some[1]) {
        swap(&h->dead, &h->alive); /* now `alive` is the dead part */
        h->dead.count = 0;
        if (!push_zone(h, &h->dead, z) || !subtract_all(h, &h->dead, &h->alive)) {
            return false;
        }
        for (k = 0; k < h->dead.count; k++) {
            if (meets_rows(h, nth(h, &h->dead, k), AT_GOAL, here)) {
                return true;
            }
        }
    }
    return false;
}

static bool meets_nested(engine *h, const bound *z, const spot *here);

/* Whether a zone meets the goal; the valuations that do are in `parts`. */
static bool is_goal(engine *h, const bound *z, const spot *here)
{
    h->parts.count = 0;
    if (h->kind == SEEK_DEADLOCK) {
        return meets_at_deadlock(h, z, here);
    }
    if (h->kind == SEEK_NESTED) {
        return meets_nested(h, z, here);
    }
    return meets_rows(h, z, AT_GOAL, here);
}

/* --- the queue of a best-first search ------------------------------------------------------------ */

static bool comes_first(const entry *a, const entry *b)
{
    return (a->cost < b->cost) || ((a->cost == b->cost) && (a->order < b->order));
}

static bool heap_push(engine *h, double cost, uint32_t n, uint32_t goal)
{
    const entry e = {cost, h->order++, n, goal};
    uint32_t i = h->heap_count;
    if (!ROOM(h, h->heap, h->heap_room, (uint64_t)h->heap_count + 1)) {
        return false;
    }
    h->heap_count++;
    while ((i > 0) && comes_first(&e, h->heap + (i - 1) / 2)) {
        h->heap[i] = h->heap[(i - 1) / 2];
        i = (i - 1) / 2;
    }
    h->heap[i] = e;
    return true;
}

static entry heap_pop(engine *h)
{
    const entry best = h->heap[0];
    const entry e = h->heap[--h->heap_count];
    uint32_t i = 0;
    for (;;) {
        uint32_t c = 2 * i + 1;
        if (c >= h->heap_count) {
            break;
        }
        if ((c + 1 < h->heap_count) && comes_first(h->heap + c + 1, h->heap + c)) {
            c++;
        }
        if (!comes_first(h->heap + c, &e)) {
            break;
        }
        h->heap[i] = h->heap[c];
        i = c;
    }
    h->heap[i] = e;
    return best;
}

#endif
