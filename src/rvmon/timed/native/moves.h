/* The moves from a discrete state, whatever the clocks say: edges that are taken together.
 *
 * All guards are read before a move; the sender's updates come first, then those of receivers in the
 * order of the automata; while some location is committed, a committed one is left; a broadcast takes
 * along every automaton that can receive. */
#ifndef RVMON_ZONES_MOVES_H
#define RVMON_ZONES_MOVES_H

#include "states.h"

typedef bool (*sink)(engine *h, walk *w, const int32_t *edges, int n);

static bool able(engine *h, const int32_t *edge, const int32_t *places, const int32_t *values)
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
                         const int32_t *places, const int32_t *values)
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
                              const int32_t *values)
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
static bool may_delay(engine *h, const int32_t *places, const int32_t *values)
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
        const int32_t *update = h->updates + (ptrdiff_t)edge[EDGE_UPDATE] * UPDATE_SIZE;
        int32_t i;
        for (i = 0; i < edge[EDGE_UPDATES]; i++, update += UPDATE_SIZE) {
            int64_t x = evaluate(h, update[UPDATE_VALUE], w->places, w->changed);
            int64_t slot = 0;
            if ((update[UPDATE_OFFSET] >= 0) && !h->failed) {
                slot = evaluate(h, update[UPDATE_OFFSET], w->places, w->changed);
            }
            if (h->failed) {
                return false;
            }
            if (update[UPDATE_CLOCK]) {
                int j = 0;
                if (!is_time(h, x)) {
                    return false;
                }
                while ((j < w->reset_count) && (w->resets[2 * j] != update[UPDATE_FIRST])) {
                    j++;
                }
                w->reset_count += (j == w->reset_count);
                w->resets[2 * j] = update[UPDATE_FIRST];
                w->resets[2 * j + 1] = (int32_t)x;
            } else if (within(slot, 0, update[UPDATE_COUNT])) {
                const int32_t at = update[UPDATE_FIRST] + (int32_t)slot;
                const int32_t *variable = h->variables + (ptrdiff_t)at * 4;
                x = variable[3] ? (x != 0) : x;
                h->failed = (x < variable[0]) || (x > variable[1]);
                w->changed[at] = h->failed ? w->changed[at] : (int32_t)x;
            } else {
                h->failed = true;
            }
            if (h->failed) {
                return false;
            }
        }
        w->target[edge[EDGE_AUTOMATON]] = edge[EDGE_TARGET];
    }
    return true;
}

static bool cut_guards(engine *h, const walk *w, bound *z, const int32_t *edges, int n)
{
    int k;
    for (k = 0; k < n; k++) {
        const int32_t *edge = edge_at(h, edges[k]);
        if (!cut_atoms(h, z, edge[EDGE_ATOM], edge[EDGE_ATOMS], w->places, w->values)) {
            return false;
        }
    }
    return true;
}

/* A sender and one edge of each automaton that can receive, in all ways. */
static bool broadcast(engine *h, walk *w, int32_t sender, bool committed, sink take)
{
    const int32_t *s = edge_at(h, sender);
    bool ok = !committed || w->committed[s[EDGE_AUTOMATON]];
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
            ok = ok || w->committed[a];
            w->pick[groups] = 0;
            w->first[groups++] = start;
            w->first[groups] = n;
        }
    }
    while (ok) {
        int g;
        w->chosen[0] = sender;
        for (g = 0; g < groups; g++) {
            w->chosen[1 + g] = w->group[w->first[g] + w->pick[g]];
        }
        if (h->failed || !take(h, w, w->chosen, 1 + groups)) {
            return false;
        }
        g = groups - 1;
        while ((g >= 0) && (++w->pick[g] == w->first[g + 1] - w->first[g])) {
            w->pick[g--] = 0;
        }
        if (g < 0) {
            break;
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
