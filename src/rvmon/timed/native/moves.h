/* The moves from a discrete state, whatever the clocks say: edges that are taken together.
 *
 * All guards are read before a move; the sender's updates come first, then those of receivers in the
 * order of the automata; while some location is committed, a committed one is left; a broadcast takes
 * along every automaton that can receive. */
#ifndef RVMON_ZONES_MOVES_H
#define RVMON_ZONES_MOVES_H

#include "states.h"

typedef bool (*sink)(engine *h, walk *w, const int32_t *edges, int n);

static bool able(engine *h, const int32_t *edge, const int32_t *places, int32_t *values)
{
    return holds(h, edge[EDGE_GUARD], places, values) && !h->failed;
}

static bool could_meet(const int32_t *sender, const int32_t *receiver)
{
    return (receiver[EDGE_AUTOMATON] != sender[EDGE_AUTOMATON]) && (receiver[EDGE_CHANNEL] != -1)
           && ((receiver[EDGE_FLAGS] & FLAG_SENDS) == 0)
           && (sender[EDGE_FIRST] < receiver[EDGE_STOP])
           && (receiver[EDGE_FIRST] < sender[EDGE_STOP]);
}

static bool same_channel(engine *h, const int32_t *one, const int32_t *other,
                         const int32_t *places, int32_t *values)
{
    if ((one[EDGE_STOP] - one[EDGE_FIRST] == 1) && (other[EDGE_STOP] - other[EDGE_FIRST] == 1)) {
        return true;
    }
    return (evaluate(h, one[EDGE_CHANNEL], places, values)
            == evaluate(h, other[EDGE_CHANNEL], places, values))
           && !h->failed;
}

static bool is_sender(const int32_t *edge)
{
    return (edge[EDGE_CHANNEL] != -1) && ((edge[EDGE_FLAGS] & FLAG_SENDS) != 0);
}

static bool urgent_edge_waits(engine *h, const int32_t *edge, const int32_t *places,
                              int32_t *values)
{
    int b;
    if (((edge[EDGE_FLAGS] & FLAG_URGENT) == 0) || !is_sender(edge)
        || !able(h, edge, places, values)) {
        return false;
    }
    if ((edge[EDGE_FLAGS] & FLAG_BROADCAST) != 0) {
        return true;
    }
    for (b = 0; b < h->automaton_count; b++) {
        const int32_t *place = place_of(h, places, b);
        int32_t m;
        for (m = 0; m < place[LOC_EDGES]; m++) {
            const int32_t *other = edge_at(h, place[LOC_EDGE] + m);
            if (could_meet(edge, other) && able(h, other, places, values)
                && same_channel(h, edge, other, places, values)) {
                return true;
            }
        }
    }
    return false;
}

/* Whether time may pass: nothing is committed or urgent. */
static bool may_delay(engine *h, const int32_t *places, int32_t *values)
{
    int a;
    for (a = 0; a < h->automaton_count; a++) {
        if (place_of(h, places, a)[LOC_KIND] != KIND_NORMAL) {
            return false;
        }
    }
    for (a = 0; a < h->automaton_count; a++) {
        const int32_t *place = place_of(h, places, a);
        int32_t k;
        for (k = 0; k < place[LOC_EDGES]; k++) {
            if (urgent_edge_waits(h, edge_at(h, place[LOC_EDGE] + k), places, values)) {
                return false;
            }
        }
    }
    return true;
}

/* What the updates of a move make of its source, in `target`, `changed` and `resets`. */
static bool apply(engine *h, walk *w, const int32_t *edges, int n)
{
    int k;
    (void)memcpy(w->target, w->places, (size_t)h->automaton_count * sizeof *w->target);
    (void)memcpy(w->changed, w->values, (size_t)h->variable_count * sizeof *w->changed);
    w->reset_count = 0;
    for (k = 0; k < n; k++) {
        const int32_t *edge = edge_at(h, edges[k]);
        if (edge[EDGE_UPDATE] >= 0) {
            h->sets = w;
            (void)evaluate(h, edge[EDGE_UPDATE], w->places, w->changed);
            h->sets = NULL;
            if (h->failed || !runs(h)) {
                return false;
            }
        }
        w->target[edge[EDGE_AUTOMATON]] = edge[EDGE_TARGET];
    }
    return true;
}

/* The guards of edges that move together, and that of none that is skipped for its clocks. */
static bool cut_guards(engine *h, const walk *w, bound *z, const int32_t *edges, int n)
{
    int k;
    for (k = 0; k < n; k++) {
        const int32_t *edge = edge_at(h, edges[k]);
        if (!cut_atoms(h, z, edge[EDGE_ATOM], edge[EDGE_ATOMS], w->places, w->values)) {
            return false;
        }
    }
    for (k = 0; k < w->skipped_count; k++) {
        const int32_t atom = edge_at(h, w->skipped[k])[EDGE_ATOM] + w->skip[k];
        int x;
        int y;
        bound b;
        if (!atom_at(h, h->atoms + (ptrdiff_t)atom * ATOM_SIZE, w->places, w->values, &x, &y, &b)
            || !constrain(z, h->dim, y, x, 1 - b)) {
            return false;
        }
    }
    return true;
}

/* The edges that may receive, as groups of one automaton each; how many groups. */
static int receivers(engine *h, walk *w, int32_t sender)
{
    const int32_t *s = edge_at(h, sender);
    int groups = 0;
    int n = 0;
    int a;
    for (a = 0; a < h->automaton_count; a++) {
        const int32_t *place = place_of(h, w->places, a);
        const int start = n;
        int32_t k;
        for (k = 0; k < place[LOC_EDGES]; k++) {
            const int32_t *edge = edge_at(h, place[LOC_EDGE] + k);
            if (could_meet(s, edge) && able(h, edge, w->places, w->values)
                && same_channel(h, s, edge, w->places, w->values)) {
                w->group[n++] = place[LOC_EDGE] + k;
            }
        }
        if (n > start) {
            w->pick[groups] = 0;
            w->first[groups++] = start;
            w->first[groups] = n;
        }
    }
    return groups;
}

/* How many ways a group has to take part: each of its edges, and none if all can be kept back by
 * clocks. */
static int ways(const engine *h, const walk *w, int g)
{
    int k;
    for (k = w->first[g]; k < w->first[g + 1]; k++) {
        if (edge_at(h, w->group[k])[EDGE_ATOMS] == 0) {
            return w->first[g + 1] - w->first[g];
        }
    }
    return w->first[g + 1] - w->first[g] + 1;
}

/* One move for each choice of the atoms that keep back what is skipped. */
static bool each_variant(engine *h, walk *w, int n, sink take)
{
    int i = 0;
    w->variant = 0;
    (void)memset(w->skip, 0, (size_t)w->skipped_count * sizeof *w->skip);
    while (i >= 0) {
        if (h->failed || !take(h, w, w->chosen, n)) {
            return false;
        }
        w->variant++;
        i = w->skipped_count - 1;
        while ((i >= 0) && (++w->skip[i] == edge_at(h, w->skipped[i])[EDGE_ATOMS])) {
            w->skip[i--] = 0;
        }
    }
    w->skipped_count = 0;
    w->variant = 0;
    return true;
}

/* A sender and one edge of each automaton that can receive, in all ways. */
static bool broadcast(engine *h, walk *w, int32_t sender, bool committed, sink take)
{
    const int groups = receivers(h, w, sender);
    int g = 0;
    while ((g >= 0) && !h->failed) {
        bool ok = !committed || w->committed[edge_at(h, sender)[EDGE_AUTOMATON]];
        int n = 0;
        w->skipped_count = 0;
        w->chosen[n++] = sender;
        for (g = 0; g < groups; g++) {
            int k = w->first[g] + w->pick[g];
            if (k < w->first[g + 1]) {
                w->chosen[n++] = w->group[k];
                ok = ok || w->committed[edge_at(h, w->group[k])[EDGE_AUTOMATON]];
                continue;
            }
            for (k = w->first[g]; k < w->first[g + 1]; k++) {
                w->skipped[w->skipped_count++] = w->group[k];
            }
        }
        if (ok && !each_variant(h, w, n, take)) {
            return false;
        }
        g = groups - 1;
        while ((g >= 0) && (++w->pick[g] == ways(h, w, g))) {
            w->pick[g--] = 0;
        }
    }
    return !h->failed;
}

static bool pairs(engine *h, walk *w, int32_t sender, bool committed, sink take)
{
    const int32_t *edge = edge_at(h, sender);
    const int a = edge[EDGE_AUTOMATON];
    int b;
    for (b = 0; b < h->automaton_count; b++) {
        const int32_t *place = place_of(h, w->places, b);
        int32_t m;
        if ((b == a) || (committed && !w->committed[a] && !w->committed[b])) {
            continue;
        }
        for (m = 0; m < place[LOC_EDGES]; m++) {
            const int32_t *other = edge_at(h, place[LOC_EDGE] + m);
            if (could_meet(edge, other) && able(h, other, w->places, w->values)
                && same_channel(h, edge, other, w->places, w->values)) {
                int32_t both[2];
                both[0] = sender;
                both[1] = place[LOC_EDGE] + m;
                if (!take(h, w, both, 2)) {
                    return false;
                }
            }
            if (h->failed) {
                return false;
            }
        }
    }
    return true;
}

/* Give all moves from where a walk is to `take`, until that says no; broadcasts come last. */
static bool each_move(engine *h, walk *w, sink take)
{
    bool committed = false;
    int pass;
    int a;
    w->skipped_count = 0;
    w->variant = 0;
    for (a = 0; a < h->automaton_count; a++) {
        w->committed[a] = place_of(h, w->places, a)[LOC_KIND] == KIND_COMMITTED;
        committed = committed || w->committed[a];
    }
    for (pass = 0; pass < 2; pass++) {
        for (a = 0; a < h->automaton_count; a++) {
            const int32_t *place = place_of(h, w->places, a);
            int32_t k;
            for (k = 0; k < place[LOC_EDGES]; k++) {
                const int32_t number = place[LOC_EDGE] + k;
                const int32_t *edge = edge_at(h, number);
                const bool alone = edge[EDGE_CHANNEL] == -1;
                const bool all = !alone && ((edge[EDGE_FLAGS] & FLAG_BROADCAST) != 0);
                bool on = true;
                if ((all != (pass == 1)) || (!alone && !is_sender(edge))
                    || (alone && committed && !w->committed[a])) {
                    continue;
                }
                if (able(h, edge, w->places, w->values)) {
                    on = alone ? take(h, w, &number, 1)
                               : (all ? broadcast(h, w, number, committed, take)
                                      : pairs(h, w, number, committed, take));
                }
                if (!on || h->failed) {
                    return false;
                }
            }
        }
    }
    return true;
}

#endif
