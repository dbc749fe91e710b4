/* Unions of zones as sets of valuations of a discrete state, and their time predecessors.
 *
 * Source: Cassez, David, Fleury, Larsen, Lime, Efficient On-the-Fly Algorithms for the Analysis of
 * Timed Games, 2005 (delays that avoid a zone). */
#ifndef RVMON_ZONES_UNIONS_H
#define RVMON_ZONES_UNIONS_H

#include "search.h"

/* Add a zone to a union unless one of its zones includes it, and remove those that it includes; returns
 * whether it was added. */
static bool join(engine *h, federation *f, const bound *z)
{
    uint32_t i;
    count_work(h);
    for (i = 0; i < f->count; i++) {
        if (is_within(z, nth(h, f, i), h->entries)) {
            return false;
        }
    }
    for (i = 0; i < f->count;) {
        if (is_within(nth(h, f, i), z, h->entries)) {
            f->count--;
            if (i < f->count) {
                copy_zone(h, nth(h, f, i), nth(h, f, f->count));
            }
        } else {
            i++;
        }
    }
    return fits(h, z) && push_zone(h, f, z);
}

static void join_all(engine *h, federation *f, const federation *others)
{
    uint32_t i;
    for (i = 0; (i < others->count) && runs(h); i++) {
        (void)join(h, f, nth(h, others, i));
    }
}

/* Add the intersection of two unions. */
static void meet(engine *h, federation *out, const federation *a, const federation *b)
{
    uint32_t i;
    uint32_t j;
    for (i = 0; i < a->count; i++) {
        for (j = 0; (j < b->count) && runs(h); j++) {
            copy_zone(h, h->copy, nth(h, a, i));
            if (cut_zone(h, h->copy, nth(h, b, j))) {
                (void)join(h, out, h->copy);
            }
        }
    }
}

/* Add the valuations that the invariant of a state allows: one zone, or none. */
static void everywhere(engine *h, uint32_t s, federation *out)
{
    walk *w = &h->look;
    unpack(h, s, &w->here);
    universe(h->copy, h->dim);
    if (cut_invariant(h, h->copy, &w->here)) {
        (void)push_zone(h, out, h->copy);
    }
}

/* Add the valuations from which a delay leads into a zone without passing through `bad`. */
static void add_earlier(engine *h, uint32_t s, const bound *z, const federation *bad,
                        federation *out)
{
    federation all = {0, 0, NULL};
    federation some = {0, 0, NULL};
    federation both = {0, 0, NULL};
    uint32_t i;
    uint32_t k;
    if (!push_zone(h, &all, z)) {
        return;
    }
    if (!h->delays[s]) {
        (void)subtract_all(h, &all, bad);
    } else {
        before(all.zones, h->dim);
        for (k = 0; (k < bad->count) && (all.count > 0) && runs(h); k++) {
            bound *past = h->inside;
            copy_zone(h, h->copy, z);
            before(h->copy, h->dim);
            if (!cut_zone(h, h->copy, nth(h, bad, k))) {
                continue; /* not on the way to the zone */
            }
            copy_zone(h, past, nth(h, bad, k));
            before(past, h->dim);
            /* Those with the bad zone ahead remain only if they reach a part of the target before it. */
            some.count = 0;
            copy_zone(h, h->copy, z);
            if (cut_zone(h, h->copy, past) && push_zone(h, &some, h->copy)) {
                (void)subtract(h, &some, nth(h, bad, k));
            }
            for (i = 0; i < some.count; i++) {
                before(nth(h, &some, i), h->dim);
            }
            both.count = 0;
            meet(h, &both, &all, &some);
            if (subtract(h, &all, past)) {
                join_all(h, &both, &all);
            }
            swap(&all, &both);
        }
    }
    join_all(h, out, &all);
    empty(h, &all);
    empty(h, &some);
    empty(h, &both);
}

/* The weakest precondition of a zone for setting clock c to n; false if it is empty. */
static bool undo(bound *z, int d, int c, bound n)
{
    int j;
    if (!constrain(z, d, 0, c, 2 * n + 1) || !constrain(z, d, c, 0, -2 * n + 1)) {
        return false;
    }
    (void)memcpy(z + (ptrdiff_t)c * d, z, (size_t)d * sizeof *z);
    for (j = 0; j < d; j++) {
        z[j * d + c] = UNBOUNDED;
    }
    z[c * d] = AT_ONCE;
    z[c * d + c] = AT_ONCE;
    return true;
}

#endif
