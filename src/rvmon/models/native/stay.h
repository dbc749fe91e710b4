/* Depth-first search for runs that stay inside forever: idle, in a deadlock, or in a loop.
 *
 * Source: Alur, Courcoubetis, Dill, Model-Checking in Dense Real-Time, 1993 (runs and loops). */
#ifndef RVMON_ZONES_STAY_H
#define RVMON_ZONES_STAY_H

#include "paths.h"

enum { NEW, ON_THE_WAY, DONE };

/* The valuations from which an atom (for an upper bound: its negation) can hold when time stops. */
static bool reaches_atom(engine *h, bound *to, int32_t k, bool delays, bool *upper)
{
    walk *w = &h->out;
    cut one;
    if (!atom_at(h, k, &w->here, &one)) {
        return false;
    }
    *upper = one.x == 0;
    universe(to, h->dim);
    if (!cut_invariant(h, to, &w->here) || !cut_by(h, to, *upper ? opposite(one) : one)) {
        return false;
    }
    if (delays) {
        before(to, h->dim);
    }
    return true;
}

/* The part of a zone from which no edge can be taken, and time stops before the piece ends, in `dead`. */
static bool find_stuck(engine *h, const bound *z, int k, bool delays)
{
    const walk *w = &h->out;
    const int32_t *piece = piece_at(h, k);
    int32_t i;
    if (!find_dead(h, z, &w->here)) {
        return false;
    }
    for (i = 0; delays && (h->dead.count > 0) && (i < piece[ROW_ATOMS]); i++) {
        bool upper;
        if (reaches_atom(h, h->copy, piece[ROW_ATOM] + i, true, &upper) && upper
            && !subtract(h, &h->dead, h->copy)) {
            return false;
        }
        if (h->failed || !runs(h)) {
            return false;
        }
    }
    return h->dead.count > 0;
}

/* Whether a run can end here: idle forever, which ends the search, or stuck. Returns whether to continue. */
static bool look_for_end(engine *h, const bound *z, int k, bool delays)
{
    const walk *w = &h->out;
    const int32_t *piece = piece_at(h, k);
    const int bounds = invariant_of(h, &w->here);
    bool open = delays && (bounds == 0);
    int32_t i;
    uint32_t j;
    for (i = 0; i < piece[ROW_ATOMS]; i++) {
        open = open && (h->atoms[ATOM_SIZE * (piece[ROW_ATOM] + i) + ATOM_OP] > 1);
    }
    if (open) {
        h->ending = END_IDLE;
        h->parts.count = 0;
    } else if ((h->ending == END_REACHED) && find_stuck(h, z, k, delays)) {
        h->ending = END_STUCK;
        h->parts.count = 0;
        for (j = 0; j < h->dead.count; j++) {
            (void)push_zone(h, &h->parts, nth(h, &h->dead, j));
        }
    } else {
        return runs(h) && !h->failed;
    }
    h->last_crossings.count = 0;
    for (j = 0; j < h->crossings.count; j++) {
        (void)put(h, &h->last_crossings, h->crossings.at[j]);
    }
    return !open && runs(h);
}

static bool moves_here(engine *h, const bound *z, int k, bool delays)
{
    (void)k;
    (void)delays;
    copy_zone(h, h->out.source, z);
    return each_move(h, &h->out, take);
}

/* Append the steps to the last frame, and set the index of the loop if it goes back to a node. */
static void append_frames(engine *h, uint32_t back)
{
    const uint32_t first = h->frames[0].node;
    const uint32_t parent = h->stem;
    int steps = 0;
    uint32_t i;
    h->loop = -1;
    h->path.count = 0;
    if (parent == NONE) {
        (void)put(h, &h->path, piece_of(h, first));
    } else {
        steps = append_path(h, parent) + append_link(h, parent, first, h->frames[0].link);
    }
    for (i = 1; i < h->frame_count; i++) {
        if (h->frames[i - 1].node == back) {
            h->loop = steps;
        }
        steps += append_link(h, h->frames[i - 1].node, h->frames[i].node, h->frames[i].link);
    }
    if (h->frames[i - 1].node == back) {
        h->loop = steps;
    }
}

/* Ask the caller whether time diverges on the current loop, which starts at a node: 1 or 0; -1 if the
 * search ended. */
static int ask_diverges(engine *h, uint32_t n)
{
    int64_t *head;
    uint32_t room = 0;
    int diverges;
    int e;
    head = enlarge(h, NULL, &room, (uint64_t)h->entries, sizeof *head);
    if (!runs(h)) {
        return -1;
    }
    for (e = 0; e < h->entries; e++) {
        head[e] = number_of_bound(zone_of(h, n)[e]);
    }
    diverges = h->from->diverges(h->from->context, &h->path, h->loop, head, (uint32_t)h->dim);
    give_back(h, head, room, sizeof *head);
    h->step_edge_count = 0;
    if (diverges < 0) {
        h->state = SEARCH_STOPPED;
    }
    return diverges;
}

/* Handle a loop back to a node on the stack; found, if time diverges on it or need not. */
static void close_loop(engine *h, successor to)
{
    int diverges;
    append_frames(h, to.node);
    (void)append_link(h, h->frames[h->frame_count - 1].node, to.node, to.link);
    diverges = ask_diverges(h, to.node);
    if (!runs(h)) {
        return;
    }
    if ((diverges == 0) && h->from->proper_only) {
        h->improper = true;
        h->loop = -1;
    } else {
        h->ending = (diverges != 0) ? END_LOOP : END_ZENO;
        h->parts.count = 0;
        h->state = SEARCH_FOUND;
    }
}

/* Enter a new node; found if a run can end there. */
static void stay_at(engine *h, successor at)
{
    const uint32_t state = h->nodes[at.node].state;
    const bool delays = h->delays[state] != 0;
    const int k = piece_of(h, at.node);
    frame *top;
    visit(h);
    h->stored++;
    if (!runs(h) || !ROOM(h, h->frames, h->frame_room, (uint64_t)h->frame_count + 1)) {
        return;
    }
    h->colours[at.node] = ON_THE_WAY;
    top = h->frames + h->frame_count++;
    *top = (frame){at.node, at.link, h->successor_count, h->successor_count};
    unpack(h, state, &h->out.here);
    h->ending = END_REACHED;
    h->crossings.count = 0;
    (void)each_stand(h, zone_of(h, at.node), k, delays, 0, look_for_end);
    if (!runs(h) || h->failed) {
        return;
    }
    if ((h->ending == END_STUCK) && h->from->proper_only) {
        h->improper = true;
        h->ending = END_REACHED;
    }
    if (h->ending != END_REACHED) {
        append_frames(h, NONE);
        (void)append_crossings(h, &h->last_crossings);
        h->state = runs(h) ? SEARCH_FOUND : h->state;
        return;
    }
    h->from_node = at.node;
    h->out.ordinal = 0;
    h->crossings.count = 0;
    (void)each_stand(h, zone_of(h, at.node), k, delays, 0, moves_here);
    h->frames[h->frame_count - 1].end = h->successor_count;
}

/* The depth-first search, with callbacks for each successor and for each node that is left. */
static void go_deep(engine *h, void (*seen)(engine *, successor), void (*left)(engine *, uint32_t))
{
    frame stem = {NONE, 0, 0, h->successor_count};
    while (runs(h) && !h->failed) {
        frame *top = (h->frame_count > 0) ? h->frames + h->frame_count - 1 : &stem;
        h->successor_count = top->end;
        if (top->next < top->end) {
            seen(h, h->successors[top->next++]);
        } else if (h->frame_count > 0) {
            left(h, h->frames[--h->frame_count].node);
        } else {
            break;
        }
    }
    h->phase = 0;
}

static void meet_stay(engine *h, successor at)
{
    if (h->colours[at.node] == ON_THE_WAY) {
        close_loop(h, at);
    } else if (h->colours[at.node] == NEW) {
        stay_at(h, at);
    }
}

static void leave_stay(engine *h, uint32_t n)
{
    h->colours[n] = DONE;
}

/* Search from the zone of `out`, in its target state. */
static void stay_from(engine *h, uint32_t stem, uint32_t link)
{
    h->phase = 1;
    h->successor_count = 0;
    h->frame_count = 0;
    h->stem = stem;
    h->from_node = stem;
    h->link = link;
    enter(h, h->out.zone, &h->out.there);
    go_deep(h, meet_stay, leave_stay);
}

/* Search from all pending triggers: from where the goal holds in them. */
static void stay_after(engine *h)
{
    walk *w = &h->out;
    uint32_t t;
    for (t = 0; t < h->trigger_count; t++) {
        const uint32_t from = h->triggers[t];
        int32_t k;
        for (k = 0; (k < h->goal_count) && runs(h) && !h->failed; k++) {
            if (h->nodes[from].zone == NONE) {
                break; /* a larger zone replaced it, which triggers as well */
            }
            unpack(h, h->nodes[from].state, &w->there);
            copy_zone(h, w->zone, zone_of(h, from));
            if (cut_row(h, w->zone, plan_rows(h->plan, AT_GOAL) + (ptrdiff_t)k * ROW_SIZE,
                        &w->there)) {
                stay_from(h, from, LINK_MARK | (uint32_t)k);
            }
        }
    }
    h->trigger_count = 0;
}

#endif
