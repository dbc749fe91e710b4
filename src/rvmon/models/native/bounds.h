/* Zones: closed, non-empty DBMs. z[x * d + y] bounds clock y - clock x; clock 0 is zero.
 *
 * Source: Bengtsson and Yi, Timed Automata: Semantics, Algorithms and Tools, 2004, section 4. */
#ifndef RVMON_ZONES_BOUNDS_H
#define RVMON_ZONES_BOUNDS_H

#include "engine.h"

/* The bound on a sum of two bounded numbers: non-strict only if both bounds are. */
static inline bound sum(bound a, bound b)
{
    const bound s = a + b - ((a | b) & 1);
    return (s > FAR) ? UNBOUNDED : s;
}

/* The negation of a bound, as a bound on the opposite difference. */
static inline bound negated(bound b)
{
    return 1 - b;
}

static inline cut opposite(cut c)
{
    return (cut){c.y, c.x, negated(c.b)};
}

/* A bound as answers encode it. */
static inline int64_t number_of_bound(bound b)
{
    return (b < UNBOUNDED) ? (int64_t)b : INT64_MAX;
}

static void copy_zone(const engine *h, bound *to, const bound *from)
{
    (void)memcpy(to, from, h->zone_bytes);
}

/* row = min(row, b + other), entry by entry. */
static inline void tighten(bound *restrict row, const bound *restrict other, bound b, int d)
{
    int j;
    for (j = 0; j < d; j++) {
        bound s = b + other[j] - ((b | other[j]) & 1);
        s = (s > FAR) ? UNBOUNDED : s;
        row[j] = (s < row[j]) ? s : row[j];
    }
}

/* Constrain clock y - clock x; false if the zone becomes empty. */
static bool constrain(bound *z, int d, int x, int y, bound b)
{
    const bound *row = z + y * d;
    int i;
    if (z[x * d + y] <= b) {
        return true;
    }
    if (sum(z[y * d + x], b) < AT_ONCE) {
        return false;
    }
    for (i = 0; i < d; i++) {
        bound t = z[i * d + x];
        if (t >= UNBOUNDED) {
            continue;
        }
        t = sum(t, b);
        if ((i != y) && (t < z[i * d + y])) {
            tighten(z + i * d, row, t, d);
        }
    }
    return true;
}

static bool cut_by(const engine *h, bound *z, cut c)
{
    return constrain(z, h->dim, c.x, c.y, c.b);
}

static void reset(bound *z, int d, int clock, bound value)
{
    int i;
    (void)memcpy(z + clock * d, z, (size_t)d * sizeof *z);
    for (i = 0; i < d; i++) {
        z[i * d + clock] = z[i * d];
    }
    for (i = 0; (value != 0) && (i < d); i++) {
        if (z[clock * d + i] < UNBOUNDED) {
            z[clock * d + i] -= 2 * value;
        }
        if (z[i * d + clock] < UNBOUNDED) {
            z[i * d + clock] += 2 * value;
        }
    }
    z[clock * d + clock] = AT_ONCE;
}

static void delay(bound *z, int d)
{
    int j;
    for (j = 1; j < d; j++) {
        z[j] = UNBOUNDED;
    }
}

/* Let time pass while all n upper bounds hold. One pass closes the zone: the new bounds are the only upper
 * bounds of clocks, so each tightest path uses one of them. */
static bool delay_within(bound *z, int d, bound *top, const int32_t *clocks, const bound *bounds,
                         int n)
{
    bool holds = true;
    int j;
    int k;
    if (n == 0) {
        delay(z, d);
        return true;
    }
    for (j = 0; j < d; j++) {
        top[j] = sum(bounds[0], z[clocks[0] * d + j]);
    }
    for (k = 0; k < n; k++) {
        holds = holds && (z[clocks[k]] <= bounds[k]);
        if (k > 0) {
            tighten(top, z + clocks[k] * d, bounds[k], d);
        }
    }
    if (holds) {
        (void)memcpy(z + 1, top + 1, (size_t)(d - 1) * sizeof *z);
        return true;
    }
    for (j = 0; j < d; j++) {
        if (sum(top[j], z[j * d]) < AT_ONCE) {
            return false;
        }
    }
    top[0] = AT_ONCE;
    (void)memcpy(z, top, (size_t)d * sizeof *z);
    for (j = 1; j < d; j++) {
        tighten(z + j * d, top, z[j * d], d);
    }
    return true;
}

static void universe(bound *z, int d)
{
    int i;
    for (i = 0; i < d * d; i++) {
        z[i] = UNBOUNDED;
    }
    for (i = 0; i < d; i++) {
        z[i * d] = AT_ONCE;
        z[i * d + i] = AT_ONCE;
    }
}

/* The valuations from which a delay leads into a zone. Lower bounds drop to those that differences imply:
 * -c <= j - c for each clock j, since j >= 0. */
static void before(bound *z, int d)
{
    int c;
    int j;
    for (c = 1; c < d; c++) {
        bound low = z[c * d + 1];
        for (j = 2; j < d; j++) {
            low = (z[c * d + j] < low) ? z[c * d + j] : low;
        }
        z[c * d] = low;
    }
}

static void close_zone(bound *z, int d)
{
    int k;
    int i;
    for (k = 0; k < d; k++) {
        for (i = 0; i < d; i++) {
            if ((i != k) && (z[i * d + k] < UNBOUNDED)) {
                tighten(z + i * d, z + k * d, z[i * d + k], d);
            }
        }
    }
}

/* Intersect a zone with another; false if they are disjoint. */
static bool cut_zone(const engine *h, bound *z, const bound *other)
{
    int e;
    for (e = 0; e < h->entries; e++) {
        if ((other[e] < z[e]) && !constrain(z, h->dim, e / h->dim, e % h->dim, other[e])) {
            return false;
        }
    }
    return true;
}

static bool is_within(const bound *z, const bound *other, int entries)
{
    int e;
    for (e = 0; e < entries; e++) {
        if (z[e] > other[e]) {
            return false;
        }
    }
    return true;
}

/* Whether all finite entries are within `safe`; if not, the search ends. */
static bool fits(engine *h, const bound *z)
{
    int e;
    for (e = 0; e < h->entries; e++) {
        if ((z[e] < -h->safe) || ((z[e] > h->safe) && (z[e] < UNBOUNDED))) {
            if (runs(h)) {
                h->state = SEARCH_TOO_LARGE;
            }
            return false;
        }
    }
    return true;
}

/* Extra_M: drops bounds above the greatest constants, which keeps bisimilarity; frees clocks without
 * constants. Source: Behrmann, Bouyer, Larsen, Pelanek, Lower and Upper Bounds in Zone-Based Abstractions
 * of Timed Automata, 2006, section 3. */
static void blur(engine *h, bound *z)
{
    const int d = h->dim;
    bool changed = false;
    int x;
    int y;
    copy_zone(h, h->spare, z);
    for (x = 0; x < d; x++) {
        for (y = 0; y < d; y++) {
            const bound b = h->spare[x * d + y];
            const bound most = h->upper[y];
            const bound least = h->upper[x];
            bound now = b;
            if (x == y) {
                continue;
            }
            if ((b < UNBOUNDED) && ((most == NO_LIMIT) || (b > 2 * most + 1))) {
                now = UNBOUNDED;
            } else if ((x != 0) && (least == NO_LIMIT)) {
                now = (y != 0) ? UNBOUNDED : AT_ONCE;
            } else if ((x != 0) && (b < -2 * least)) {
                now = -2 * least;
            }
            if (now != b) {
                z[x * d + y] = now;
                changed = true;
            }
        }
    }
    if (changed) {
        close_zone(z, d);
    }
}

#endif
