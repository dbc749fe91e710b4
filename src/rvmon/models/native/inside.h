/* The network restricted to a formula that runs never leave.
 *
 * In each discrete state, a formula with clocks holds on a union of convex pieces. While time passes, a
 * run stays in one piece or crosses to another. */
#ifndef RVMON_ZONES_INSIDE_H
#define RVMON_ZONES_INSIDE_H

#include "reach.h"

static const int32_t *piece_at(const engine *h, int k)
{
    return plan_rows(h->plan, AT_INSIDE) + (ptrdiff_t)k * ROW_SIZE;
}

static int piece_of(const engine *h, uint32_t n)
{
    return (int)mark_of(h, h->nodes[n].state) - 1;
}

/* Whether a discrete state has a piece. The first piece without clocks makes all others redundant. */
static bool has_piece(engine *h, int k, const spot *here)
{
    int i;
    for (i = 0; i < h->inside_count; i++) {
        if ((piece_at(h, i)[ROW_ATOMS] == 0)
            && holds(h, piece_at(h, i)[ROW_CONDITION], here)) {
            return (i == k) && !h->failed;
        }
    }
    return holds(h, piece_at(h, k)[ROW_CONDITION], here) && !h->failed;
}

/* A piece as it is, or closed so that it includes the instant at which time leaves it (UNTIL), or the
 * instant after which time enters it (SINCE). */
enum { AS_IS, UNTIL, SINCE };

static bool cut_piece(engine *h, bound *z, int k, int how, const spot *here)
{
    const int32_t *piece = piece_at(h, k);
    int32_t i;
    for (i = 0; i < piece[ROW_ATOMS]; i++) {
        cut one;
        if (!atom_at(h, piece[ROW_ATOM] + i, here, &one)) {
            return false;
        }
        if ((how == UNTIL) ? (one.x == 0) : ((how == SINCE) && (one.y == 0))) {
            one.b |= 1;
        }
        if (!cut_by(h, z, one)) {
            return false;
        }
    }
    return true;
}

/* Let a zone cross from piece k to piece m as time passes: at the last instant of k (`since`) or at the
 * first instant of m, if such an instant exists. */
static bool cross(engine *h, bound *to, const bound *z, int k, int m, bool since,
                  const spot *here)
{
    copy_zone(h, to, z);
    delay(to, h->dim);
    if (!cut_invariant(h, to, here)
        || !cut_piece(h, to, k, since ? AS_IS : UNTIL, here)
        || !cut_piece(h, to, m, since ? SINCE : AS_IS, here)) {
        return false;
    }
    delay(to, h->dim);
    return cut_invariant(h, to, here) && cut_piece(h, to, m, AS_IS, here);
}

/* --- the search for late responses, with subsumption --------------------------------------------- */

/* Store a state in which the timer runs; found if the bound is exceeded here, or reached while time may
 * still pass. */
static void keep_late(engine *h, uint32_t state, const bound *z, int k, bool delays,
                      const spot *here)
{
    const bound due = 2 * (bound)h->plan[HEAD_BOUND];
    const uint32_t n = keep(h, state, NONE, z, here);
    bool late;
    if (n == NONE) {
        return;
    }
    visit(h);
    copy_zone(h, h->copy, z);
    late = cut_piece(h, h->copy, k, AS_IS, here)
           && constrain(h->copy, h->dim, h->timer, 0, -due);
    if (!late && (piece_at(h, k)[ROW_ATOMS] > 0) && delays) {
        const int bounds = invariant_of(h, here);
        int i;
        copy_zone(h, h->copy, z);
        for (i = 0, late = bounds >= 0; late && (i < bounds); i++) {
            late = constrain(h->copy, h->dim, 0, h->tightest[i], h->tightest_bound[i] & ~(bound)1);
        }
        late = late && cut_piece(h, h->copy, k, AS_IS, here)
               && constrain(h->copy, h->dim, h->timer, 0, 1 - due);
    }
    if (late && (h->found == NONE) && runs(h)) {
        h->parts.count = 0;
        if (push_zone(h, &h->parts, h->copy)) {
            h->found = n;
            h->state = SEARCH_FOUND;
        }
        return;
    }
    (void)wait_for(h, n);
}

/* --- the search for runs that stay, without subsumption: a loop of larger zones need not be a loop of
 * runs --------------------------------------------------------------------------------------------- */

static uint32_t hash_inside(const engine *h, uint32_t state, const bound *z)
{
    return hash_of(z, h->zone_bytes / 4) ^ state * 0x9e3779b1U;
}

static uint32_t hash_node(const engine *h, uint32_t n)
{
    return hash_inside(h, h->nodes[n].state, zone_of(h, n));
}

/* Add a symbolic state, new or known, as a successor of the current one. */
static void succeed(engine *h, uint32_t state, const bound *z)
{
    const size_t bytes = h->zone_bytes;
    uint32_t at;
    uint32_t n;
    if (!widen(h, &h->exact, h->exact_count, hash_node)) {
        return;
    }
    at = hash_inside(h, state, z) & (h->exact.size - 1);
    while (((n = h->exact.at[at]) != NONE)
           && ((h->nodes[n].state != state) || (memcmp(zone_of(h, n), z, bytes) != 0))) {
        at = (at + 1) & (h->exact.size - 1);
    }
    if (n == NONE) {
        const uint32_t had = h->colour_room;
        n = new_node(h, state, z);
        if ((n == NONE) || !ROOM(h, h->colours, h->colour_room, (uint64_t)n + 1)) {
            return;
        }
        (void)memset(h->colours + had, 0, h->colour_room - had);
        h->exact.at[at] = n;
        h->exact_count++;
    }
    if (ROOM(h, h->successors, h->successor_room, (uint64_t)h->successor_count + 1)) {
        h->successors[h->successor_count++] = (successor){n, h->link, 0};
    }
}

/* Intersect with the invariant and a piece and, if time may pass, add all delays in it; false if nothing
 * is left. */
static bool settle_in_piece(engine *h, bound *z, int k, bool delays, const spot *here)
{
    if (piece_at(h, k)[ROW_ATOMS] == 0) {
        return settle(h, z, here, delays);
    }
    if (!cut_piece(h, z, k, AS_IS, here) || !cut_invariant(h, z, here)) {
        return false;
    }
    if (!delays) {
        return true;
    }
    delay(z, h->dim); /* a piece is convex: a delay that starts and ends in it never leaves it */
    return cut_invariant(h, z, here) && cut_piece(h, z, k, AS_IS, here);
}

/* Split a reached zone into pieces, each with the delays that stay in it. */
static void enter(engine *h, const bound *z, const spot *here)
{
    const bool delays = may_delay(h, here);
    const bool late = (h->kind == SEEK_LATE) || (h->kind == SEEK_LATE_AFTER);
    bound *in = h->inside;
    int k;
    for (k = 0; (k < h->inside_count) && runs(h) && !h->failed; k++) {
        uint32_t state;
        if (!has_piece(h, k, here)) {
            continue;
        }
        copy_zone(h, in, z);
        if (!settle_in_piece(h, in, k, delays, here)) {
            continue;
        }
        if (!late) {
            find_limits(h, here);
            blur(h, in);
        }
        state = state_of(h, here, 1 + (uint32_t)k);
        if (state == NONE) {
            return;
        }
        if (late) {
            keep_late(h, state, in, k, delays, here);
        } else {
            succeed(h, state, in);
        }
    }
}

#endif
