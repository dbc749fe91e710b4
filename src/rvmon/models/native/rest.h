/* Accepted runs with finitely many moves, which end idle or stuck. */
#ifndef RVMON_ZONES_REST_H
#define RVMON_ZONES_REST_H

#include "stay.h"

/* Flags of edges, besides the acceptance sets: it is a move; a unit of time has passed. */
#define MOVES ((uint32_t)1 << 29)
#define TICKS ((uint32_t)1 << 30)
#define CLOSED UINT32_MAX /* the rank of nodes in components that were left */

static const int32_t *buchi_of(const engine *h, int k)
{
    return plan_rows(h->plan, AT_BUCHI) + (ptrdiff_t)BUCHI_SIZE * k;
}

static int32_t arc_at(const engine *h, int32_t a)
{
    return plan_rows(h->plan, AT_ARCS)[a];
}

/* The flags that an accepting component must have. */
static uint32_t wanted_flags(const engine *h)
{
    return (((uint32_t)1 << h->plan[HEAD_SETS]) - 1) | MOVES | ((h->timer != 0) ? TICKS : 0);
}

/* Find the pieces from which the automaton accepts if only the allowed pieces hold forever. */
static void find_rest(engine *h)
{
    const int32_t n = h->inside_count;
    const uint32_t sets = wanted_flags(h) & ~(MOVES | TICKS);
    int32_t r;
    (void)memset(h->rest_good, 0, (size_t)n);
    for (r = 0; r < n; r++) {
        uint32_t met = 0;
        int side;
        int32_t k;
        /* forward and backward reachability from r, each to a fixed point */
        for (side = 0; side < 2; side++) {
            uint8_t *found = side ? h->rest_back : h->rest_on;
            bool changed = true;
            (void)memset(found, 0, (size_t)n);
            while (changed && (h->allowed[r] != 0)) {
                changed = false;
                count_work(h);
                for (k = 0; k < n; k++) {
                    const int32_t *buchi = buchi_of(h, k);
                    int32_t a;
                    for (a = 0; (h->allowed[k] != 0) && (a < buchi[BUCHI_ARCS]); a++) {
                        const int32_t m = arc_at(h, buchi[BUCHI_ARC] + a);
                        const int32_t from = side ? m : k;
                        const int32_t to = side ? k : m;
                        if ((h->allowed[m] != 0) && (found[to] == 0)
                            && ((from == r) || (found[from] != 0))) {
                            found[to] = 1;
                            changed = true;
                        }
                    }
                }
            }
        }
        for (k = 0; k < n; k++) {
            if ((h->rest_on[k] != 0) && (h->rest_back[k] != 0)) {
                met |= (uint32_t)buchi_of(h, k)[BUCHI_SETS];
            }
        }
        if ((h->rest_on[r] != 0) && ((met & sets) == sets)) {
            h->rest_good[r] = 1;
            for (k = 0; k < n; k++) {
                h->rest_good[k] |= h->rest_back[k];
            }
        }
    }
}

/* The same as a test of one piece; the result is kept until `allowed` changes. */
static bool rests(engine *h, int k)
{
    const size_t n = (size_t)h->inside_count;
    if (!h->rest_known || (memcmp(h->allowed, h->rest_allowed, n) != 0)) {
        find_rest(h);
        (void)memcpy(h->rest_allowed, h->allowed, n);
        h->rest_known = true;
    }
    return (h->allowed[k] != 0) && (h->rest_good[k] != 0);
}

/* Whether a piece holds when time stops. No atom may divide the zone in that respect. */
static bool holds_last(engine *h, const bound *z, int k, bool delays)
{
    const int32_t *piece = piece_at(h, k);
    int32_t i;
    for (i = 0; i < piece[ROW_ATOMS]; i++) {
        bool upper = false;
        bool met = reaches_atom(h, h->copy, piece[ROW_ATOM] + i, delays, &upper)
                   && cut_zone(h, h->copy, z);
        if (h->failed || (met == upper)) {
            return false;
        }
    }
    return true;
}

/* Whether an accepted run gets stuck in piece k; the valuations are in `parts`. The zone is split by all
 * atoms, so that the same pieces hold in the end for all valuations of a part. */
static bool look_for_stuck(engine *h, const bound *z, int k, bool delays)
{
    walk *w = &h->out;
    bound *reach = h->inside;
    federation parts = {0, 0, NULL};
    uint32_t i;
    int32_t a;
    int m;
    bool found = false;
    if (!find_dead(h, z, &w->here)) {
        return false;
    }
    for (m = 0; m < h->inside_count; m++) {
        const int32_t *piece = piece_at(h, m);
        for (a = 0; (h->allowed[m] != 0) && (a < piece[ROW_ATOMS]) && runs(h); a++) {
            bool upper;
            if (!reaches_atom(h, reach, piece[ROW_ATOM] + a, delays, &upper)) {
                continue;
            }
            parts.count = 0;
            for (i = 0; i < h->dead.count; i++) {
                copy_zone(h, h->copy, nth(h, &h->dead, i));
                if (cut_zone(h, h->copy, reach)) {
                    (void)push_zone(h, &parts, h->copy);
                }
            }
            (void)subtract(h, &h->dead, reach);
            for (i = 0; i < parts.count; i++) {
                (void)push_zone(h, &h->dead, nth(h, &parts, i));
            }
        }
    }
    (void)memcpy(h->marked, h->allowed, (size_t)h->inside_count);
    for (i = 0; (i < h->dead.count) && !found && runs(h) && !h->failed; i++) {
        for (m = 0; m < h->inside_count; m++) {
            h->allowed[m] = (h->marked[m] != 0) && holds_last(h, nth(h, &h->dead, i), m, delays);
        }
        if (rests(h, k)) {
            h->parts.count = 0;
            found = push_zone(h, &h->parts, nth(h, &h->dead, i));
        }
    }
    (void)memset(h->marked, 0, (size_t)h->inside_count);
    empty(h, &parts);
    return found;
}

/* Whether an accepted run can end at a node: idle forever, or stuck. */
static bool ends_here(engine *h, uint32_t n)
{
    const bound *z = zone_of(h, n);
    const bool delays = h->delays[h->nodes[n].state] != 0;
    const int k = piece_of(h, n);
    walk *w = &h->out;
    bool open;
    int m;
    unpack(h, h->nodes[n].state, &w->here);
    open = delays && (invariant_of(h, &w->here) == 0);
    for (m = 0; m < h->inside_count; m++) {
        const int32_t *piece = piece_at(h, m);
        int32_t i;
        h->allowed[m] = holds(h, piece[ROW_CONDITION], &w->here);
        for (i = 0; open && (i < piece[ROW_ATOMS]); i++) {
            h->allowed[m] &= h->atoms[ATOM_SIZE * (piece[ROW_ATOM] + i) + ATOM_OP] > 1;
        }
    }
    if (h->failed || !rests(h, k)) {
        return false;
    }
    h->ending = open ? END_IDLE : END_STUCK;
    h->parts.count = 0;
    return open || ((h->timer == 0) && look_for_stuck(h, z, k, delays));
}

#endif
