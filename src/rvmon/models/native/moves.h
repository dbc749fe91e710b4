/* The moves from a discrete state, ignoring clocks: sets of edges that are taken together.
 *
 * All guards are evaluated before a move. The sender is updated first, then the receivers in the order of
 * the automata. While some location is committed, a move must leave a committed one. A broadcast includes
 * every automaton that can receive. A move is blocked by possible moves of higher priority. */
#ifndef RVMON_ZONES_MOVES_H
#define RVMON_ZONES_MOVES_H

#include "variants.h"

static bool able(engine *h, const int32_t *edge, const spot *here)
{
    return holds(h, edge[EDGE_GUARD], here) && !h->failed;
}

static bool could_meet(const int32_t *sender, const int32_t *receiver)
{
    return (receiver[EDGE_AUTOMATON] != sender[EDGE_AUTOMATON]) && (receiver[EDGE_CHANNEL] != -1)
           && ((receiver[EDGE_FLAGS] & FLAG_SENDS) == 0)
           && (sender[EDGE_FIRST] < receiver[EDGE_STOP])
           && (receiver[EDGE_FIRST] < sender[EDGE_STOP]);
}

static bool same_channel(engine *h, const int32_t *one, const int32_t *other,
                         const spot *here)
{
    if ((one[EDGE_STOP] - one[EDGE_FIRST] == 1) && (other[EDGE_STOP] - other[EDGE_FIRST] == 1)) {
        return true;
    }
    return (evaluate(h, one[EDGE_CHANNEL], here)
            == evaluate(h, other[EDGE_CHANNEL], here))
           && !h->failed;
}

static bool is_sender(const int32_t *edge)
{
    return (edge[EDGE_CHANNEL] != -1) && ((edge[EDGE_FLAGS] & FLAG_SENDS) != 0);
}

static bool urgent_edge_waits(engine *h, const int32_t *edge, const spot *here)
{
    int b;
    if (((edge[EDGE_FLAGS] & FLAG_URGENT) == 0) || !is_sender(edge)
        || !able(h, edge, here)) {
        return false;
    }
    if ((edge[EDGE_FLAGS] & FLAG_BROADCAST) != 0) {
        return true;
    }
    for (b = 0; b < h->automaton_count; b++) {
        const int32_t *place = place_of(h, here, b);
        int32_t m;
        for (m = 0; m < place[LOC_EDGES]; m++) {
            const int32_t *other = edge_at(h, place[LOC_EDGE] + m);
            if (could_meet(edge, other) && able(h, other, here)
                && same_channel(h, edge, other, here)) {
                return true;
            }
        }
    }
    return false;
}

/* Whether time may pass: no location is committed or urgent, and no urgent channel can be used. */
static bool may_delay(engine *h, const spot *here)
{
    int a;
    for (a = 0; a < h->automaton_count; a++) {
        if (place_of(h, here, a)[LOC_KIND] != KIND_NORMAL) {
            return false;
        }
    }
    for (a = 0; a < h->automaton_count; a++) {
        const int32_t *place = place_of(h, here, a);
        int32_t k;
        for (k = 0; k < place[LOC_EDGES]; k++) {
            if (urgent_edge_waits(h, edge_at(h, place[LOC_EDGE] + k), here)) {
                return false;
            }
        }
    }
    return true;
}

/* The index of a discrete state with a mark, new or known; NONE without memory. */
static uint32_t state_of(engine *h, const spot *here, uint32_t mark)
{
    uint32_t *at;
    pack(h, here, mark, h->packed);
    at = find_state(h, h->packed);
    if ((at == NULL) || ((*at == NONE) && !add_state(h, at, may_delay(h, here)))) {
        return NONE;
    }
    return *at;
}

/* Collect the edges that may receive, grouped by automaton; returns the number of groups. */
static int receivers(engine *h, walk *w, int32_t sender)
{
    const int32_t *s = edge_at(h, sender);
    int groups = 0;
    int n = 0;
    int a;
    for (a = 0; a < h->automaton_count; a++) {
        const int32_t *place = place_of(h, &w->here, a);
        const int start = n;
        int32_t k;
        for (k = 0; k < place[LOC_EDGES]; k++) {
            const int32_t *edge = edge_at(h, place[LOC_EDGE] + k);
            if (could_meet(s, edge) && able(h, edge, &w->here)
                && same_channel(h, s, edge, &w->here)) {
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

/* The number of choices of a group: each of its edges, and none if clocks can disable all of them. */
static int choices(const engine *h, const walk *w, int g)
{
    int k;
    for (k = w->first[g]; k < w->first[g + 1]; k++) {
        if (edge_at(h, w->group[k])[EDGE_ATOMS] == 0) {
            return w->first[g + 1] - w->first[g];
        }
    }
    return w->first[g + 1] - w->first[g] + 1;
}

/* Enumerate a broadcast: the sender with each choice of edges of all possible receivers. */
static bool broadcast(engine *h, walk *w, int32_t sender, bool committed, sink take)
{
    const int groups = receivers(h, w, sender);
    int g = 0;
    while ((g >= 0) && !h->failed) {
        bool ok = !committed || w->committed[edge_at(h, sender)[EDGE_AUTOMATON]];
        int n = 0;
        drop_denials(&w->skipped);
        w->chosen[n++] = sender;
        for (g = 0; g < groups; g++) {
            int k = w->first[g] + w->pick[g];
            if (k < w->first[g + 1]) {
                w->chosen[n++] = w->group[k];
                ok = ok || w->committed[edge_at(h, w->group[k])[EDGE_AUTOMATON]];
                continue;
            }
            for (k = w->first[g]; k < w->first[g + 1]; k++) {
                if (!begin_denial(h, &w->skipped, 0)
                    || !deny_guard(h, w, &w->skipped, edge_at(h, w->group[k]))) {
                    return false;
                }
            }
        }
        if (ok && !each_variant(h, w, w->chosen, n, take)) {
            return false;
        }
        g = groups - 1;
        while ((g >= 0) && (++w->pick[g] == choices(h, w, g))) {
            w->pick[g--] = 0;
        }
    }
    drop_denials(&w->skipped);
    return !h->failed;
}

static bool pairs(engine *h, walk *w, int32_t sender, bool committed, sink take)
{
    const int32_t *edge = edge_at(h, sender);
    const int a = edge[EDGE_AUTOMATON];
    int b;
    for (b = 0; b < h->automaton_count; b++) {
        const int32_t *place = place_of(h, &w->here, b);
        int32_t m;
        if ((b == a) || (committed && !w->committed[a] && !w->committed[b])) {
            continue;
        }
        for (m = 0; m < place[LOC_EDGES]; m++) {
            const int32_t *other = edge_at(h, place[LOC_EDGE] + m);
            if (could_meet(edge, other) && able(h, other, &w->here)
                && same_channel(h, edge, other, &w->here)) {
                int32_t both[2];
                both[0] = sender;
                both[1] = place[LOC_EDGE] + m;
                if (!each_variant(h, w, both, 2, take)) {
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

/* Call `take` with all moves from the source of a walk, broadcasts last, until it returns false. Watching
 * edges are no moves of their own. */
static bool each_choice(engine *h, walk *w, sink take)
{
    bool committed = false;
    int pass;
    int a;
    drop_denials(&w->skipped);
    for (a = 0; a < h->automaton_count; a++) {
        w->committed[a] = place_of(h, &w->here, a)[LOC_KIND] == KIND_COMMITTED;
        committed = committed || w->committed[a];
    }
    for (pass = 0; pass < 2; pass++) {
        for (a = 0; a < h->automaton_count; a++) {
            const int32_t *place = place_of(h, &w->here, a);
            int32_t k;
            for (k = 0; k < place[LOC_EDGES]; k++) {
                const int32_t number = place[LOC_EDGE] + k;
                const int32_t *edge = edge_at(h, number);
                const bool alone = edge[EDGE_CHANNEL] == -1;
                const bool all = !alone && ((edge[EDGE_FLAGS] & FLAG_BROADCAST) != 0);
                bool on = true;
                if ((all != (pass == 1)) || (!alone && !is_sender(edge))
                    || (alone && committed && !w->committed[a] && !is_watcher(h, a))
                    || ((edge[EDGE_FLAGS] & FLAG_WATCHES) != 0)
                    || ((take == note_blocker) && is_watcher(h, a))) {
                    continue;
                }
                if (able(h, edge, &w->here)) {
                    on = alone ? each_variant(h, w, &number, 1, take)
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

/* The same, without moves that are blocked by one of higher priority. */
static bool each_move(engine *h, walk *w, sink take)
{
    drop_denials(&w->blockers);
    w->blocker_count = 0;
    if (plan_count(h->plan, AT_RANKS) > 0) {
        const int bounds = invariant_of(h, &w->here);
        int i;
        for (i = 0; i < h->dim; i++) {
            w->limits[i] = UNBOUNDED;
        }
        for (i = 0; i < bounds; i++) {
            w->limits[h->tightest[i]] = h->tightest_bound[i];
        }
        if ((bounds < 0) || !each_choice(h, w, note_blocker)) {
            return false;
        }
        w->blocker_count = w->blockers.count;
    }
    return each_choice(h, w, take);
}

#endif
