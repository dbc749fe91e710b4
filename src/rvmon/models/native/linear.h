/* Runs that a generalised Buechi automaton accepts, namely those of an LTL formula without next.
 *
 * The pieces are the states of the automaton, each with its condition. A run takes an arc with each move,
 * and while time passes. A piece lasts through moves that do not change its condition, which is sound for
 * formulas without next. The search finds strongly connected components depth first; a component is
 * accepting if it meets all acceptance sets and has moves. Runs with finitely many moves, idle or stuck,
 * are searched separately (rest.h). If the plan has a timer, time must diverge: infinitely many moves have
 * to find that a unit of time has passed.
 *
 * Source: Couvreur, On-the-Fly Verification of Linear Temporal Logic, FM 1999; Alur, Courcoubetis,
 * Dill, Model-Checking in Dense Real-Time, 1993; Tripakis, Yovine, Bouajjani, Checking Timed Buechi
 * Automata Emptiness Efficiently, 2005. */
#ifndef RVMON_ZONES_LINEAR_H
#define RVMON_ZONES_LINEAR_H

#include "rest.h"

static uint32_t flags_of(const engine *h, uint32_t n)
{
    return (uint32_t)buchi_of(h, piece_of(h, n))[BUCHI_SETS];
}

/* --- successors ------------------------------------------------------------------------------------- */

/* Add a zone inside a piece as a successor of the current node. */
static void succeed_in(engine *h, bound *z, int k, uint32_t flags, const spot *here)
{
    const uint32_t before = h->successor_count;
    uint32_t state;
    find_limits(h, here);
    blur(h, z);
    state = state_of(h, here, 1 + (uint32_t)k);
    if (state != NONE) {
        succeed(h, state, z);
    }
    if (h->successor_count > before) {
        h->successors[before].flags = flags;
    }
}

/* Add a zone after a move, or at the start, in all pieces to which the automaton can go. */
static void enter_run(engine *h, const bound *z, const spot *here)
{
    const bool delays = may_delay(h, here);
    const int32_t *buchi = (h->from_node == NONE) ? NULL : buchi_of(h, piece_of(h, h->from_node));
    const int32_t count = (buchi == NULL) ? h->inside_count : buchi[BUCHI_ARCS];
    int32_t i;
    int tick;
    for (i = 0; (i < count) && runs(h) && !h->failed; i++) {
        const int k = (buchi == NULL) ? i : arc_at(h, buchi[BUCHI_ARC] + i);
        if (((buchi == NULL) && (buchi_of(h, k)[BUCHI_STARTS] == 0))
            || !holds(h, piece_at(h, k)[ROW_CONDITION], here)) {
            continue;
        }
        for (tick = 0; tick <= (h->timer != 0); tick++) {
            copy_zone(h, h->inside, z);
            if ((h->timer != 0)
                && !(tick ? constrain(h->inside, h->dim, h->timer, 0, -1)
                          : constrain(h->inside, h->dim, 0, h->timer, 2))) {
                continue;
            }
            if (tick) {
                reset(h->inside, h->dim, h->timer, 0);
            }
            if (settle_in_piece(h, h->inside, k, delays, here)) {
                succeed_in(h, h->inside, k, MOVES | (tick ? TICKS : 0), here);
            }
        }
    }
}

/* Add the successors of a node: after moves, and by crossings as time passes. */
static void expand_run(engine *h, uint32_t n)
{
    walk *w = &h->out;
    const int k = piece_of(h, n);
    const int32_t *buchi = buchi_of(h, k);
    const bool delays = h->delays[h->nodes[n].state] != 0;
    int32_t i;
    unpack(h, h->nodes[n].state, &w->here);
    copy_zone(h, w->source, zone_of(h, n));
    h->from_node = n;
    w->ordinal = 0;
    h->phase = 1;
    (void)each_move(h, w, take);
    for (i = 0; delays && h->clocked && (i < 2 * buchi[BUCHI_ARCS]) && runs(h) && !h->failed; i++) {
        const int m = arc_at(h, buchi[BUCHI_ARC] + i / 2);
        if ((m != k) && holds(h, piece_at(h, m)[ROW_CONDITION], &w->here)
            && cross(h, w->zone, w->source, k, m, i % 2 == 1, &w->here)) {
            h->link = LINK_CROSSING | (uint32_t)(i % 2);
            succeed_in(h, w->zone, m, 0, &w->here);
        }
    }
}

/* --- components ---------------------------------------------------------------------------------------- */

static bool in_component(const engine *h, uint32_t n, uint32_t rank)
{
    return (n < h->rank_room) && (h->rank[n] >= rank) && (h->rank[n] != CLOSED);
}

/* Append a shortest path inside a component, from a node to an edge with a wanted flag, or to the root if
 * no flag is wanted any more. Its flags are removed from `wanted`. Returns its last node, or NONE. */
static uint32_t append_part(engine *h, uint32_t from, uint32_t root_node, uint32_t *wanted)
{
    const uint32_t rank = h->rank[root_node];
    const uint32_t mark = h->successor_count;
    uint32_t at;
    uint32_t i;
    uint32_t last = NONE;
    h->trail_count = 0;
    if (!ROOM(h, h->trail, h->trail_room, 1)) {
        return NONE;
    }
    h->trail[h->trail_count++] = (step){from, NONE, 0, 0};
    for (at = 0; (at < h->trail_count) && (last == NONE) && runs(h); at++) {
        expand_run(h, h->trail[at].node);
        for (i = mark; (i < h->successor_count) && (last == NONE) && runs(h); i++) {
            const successor s = h->successors[i];
            const uint32_t flags = s.flags | (in_component(h, s.node, rank) ? flags_of(h, s.node) : 0);
            const bool ends = (*wanted != 0) ? (flags & *wanted) != 0 : s.node == root_node;
            if (!in_component(h, s.node, rank) || (!ends && (h->colours[s.node] != 0))
                || !ROOM(h, h->trail, h->trail_room, (uint64_t)h->trail_count + 1)) {
                continue;
            }
            h->colours[s.node] = 1;
            h->trail[h->trail_count++] = (step){s.node, at, s.link, flags};
            last = ends ? h->trail_count - 1 : NONE;
        }
        h->successor_count = mark;
    }
    for (i = 0; i < h->trail_count; i++) {
        h->colours[h->trail[i].node] = 0;
    }
    if (last == NONE) {
        return NONE;
    }
    /* reverse the chain, then append it */
    for (at = last, i = NONE; at != NONE;) {
        const uint32_t parent = h->trail[at].parent;
        h->trail[at].parent = i;
        i = at;
        at = parent;
    }
    for (at = i; h->trail[at].parent != NONE; at = h->trail[at].parent) {
        const step to = h->trail[h->trail[at].parent];
        (void)append_link(h, h->trail[at].node, to.node, to.link);
        *wanted &= ~to.flags;
    }
    return h->trail[last].node;
}

/* Handle an accepting component: append the path to it, and a loop in it with all wanted flags. */
static void append_round(engine *h, uint32_t rank)
{
    uint32_t wanted = wanted_flags(h);
    uint32_t root_node;
    uint32_t at;
    int diverges = 1;
    while (h->rank[h->frames[h->frame_count - 1].node] != rank) {
        h->frame_count--;
    }
    root_node = h->frames[h->frame_count - 1].node;
    append_frames(h, root_node);
    at = root_node;
    do {
        at = append_part(h, at, root_node, &wanted);
    } while ((at != NONE) && ((wanted != 0) || (at != root_node)) && runs(h));
    if (runs(h) && (h->timer == 0)) {
        diverges = ask_diverges(h, root_node);
    }
    if (runs(h)) {
        h->ending = (diverges != 0) ? END_LOOP : END_ZENO;
        h->parts.count = 0;
        h->state = SEARCH_FOUND;
    }
}

/* Enter a new node, as a component of its own. */
static void open_node(engine *h, successor s)
{
    const uint32_t had = h->rank_room;
    visit(h);
    h->stored++;
    if (!ROOM(h, h->rank, h->rank_room, h->node_count)) {
        return;
    }
    (void)memset(h->rank + had, 0, (h->rank_room - had) * sizeof *h->rank);
    if (!ROOM(h, h->frames, h->frame_room, (uint64_t)h->frame_count + 1)
        || !ROOM(h, h->roots, h->root_room, (uint64_t)h->root_count + 1)
        || !ROOM(h, h->open, h->open_room, (uint64_t)h->open_count + 1)) {
        return;
    }
    h->rank[s.node] = ++h->last_rank;
    h->open[h->open_count++] = s.node;
    h->roots[h->root_count++] = (root){h->last_rank, flags_of(h, s.node), s.flags};
    h->frames[h->frame_count++] =
        (frame){s.node, s.link, h->successor_count, h->successor_count};
    if (ends_here(h, s.node)) {
        append_frames(h, NONE);
        h->state = runs(h) ? SEARCH_FOUND : h->state;
        return;
    }
    h->ending = END_REACHED;
    expand_run(h, s.node);
    h->frames[h->frame_count - 1].end = h->successor_count;
}

/* Leave a node. If it is the root of a component, that component is complete and closed. */
static void leave_run(engine *h, uint32_t n)
{
    const uint32_t rank = h->rank[n];
    if (h->roots[h->root_count - 1].number == rank) {
        h->root_count--;
        while ((h->open_count > 0) && (h->rank[h->open[h->open_count - 1]] >= rank)) {
            h->rank[h->open[--h->open_count]] = CLOSED;
        }
    }
}

/* Handle an edge to a node on the stack, which merges the components between; found, if the result is
 * accepting. */
static void merge(engine *h, successor s)
{
    const uint32_t wanted = wanted_flags(h);
    const uint32_t rank = h->rank[s.node];
    uint32_t flags = s.flags;
    root *top = h->roots + h->root_count - 1;
    while (top->number > rank) {
        flags |= top->flags | top->in;
        top--;
        h->root_count--;
    }
    top->flags |= flags;
    if ((top->flags & wanted) == wanted) {
        append_round(h, top->number);
    }
}

static void meet_run(engine *h, successor s)
{
    if ((s.node >= h->rank_room) || (h->rank[s.node] == 0)) {
        open_node(h, s);
    } else if (h->rank[s.node] != CLOSED) {
        merge(h, s);
    }
}

/* Search for an accepted run from the zone in `out`. */
static void look_for_run(engine *h)
{
    int32_t k;
    for (k = 0; k < h->inside_count; k++) {
        h->clocked = h->clocked || (piece_at(h, k)[ROW_ATOMS] > 0);
    }
    h->phase = 1;
    h->stem = NONE;
    h->from_node = NONE;
    enter_run(h, h->out.zone, &h->out.there);
    go_deep(h, meet_run, leave_run);
}

#endif
