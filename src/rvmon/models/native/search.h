/* Successors: the target zone of a move, and how each kind of search stores it. */
#ifndef RVMON_ZONES_SEARCH_H
#define RVMON_ZONES_SEARCH_H

#include "inside.h"

static double cost_of(const engine *h, const bound *z, const int32_t *edges, int n)
{
    double cost = h->price;
    int k;
    if (h->policy == POLICY_FASTEST) {
        return price_of(h, z);
    }
    for (k = 0; k < n; k++) {
        cost += h->costs[edges[k]];
    }
    return cost;
}

/* Extend the range of the last clock of the network at the current location of the watcher. */
static void note_span(engine *h, const bound *z, const spot *here)
{
    const int32_t clock = h->plan[HEAD_CLOCKS];
    int64_t *span = h->spans + (ptrdiff_t)2 * here->places[h->automaton_count - 1];
    const bound low = z[clock * h->dim];
    const int64_t high = (z[clock] < UNBOUNDED) ? (int64_t)z[clock] : INT64_MAX;
    span[0] = (low > span[0]) ? low : span[0];
    span[1] = (high > span[1]) ? high : span[1];
}

static void enter_run(engine *h, const bound *z, const spot *here);

/* Store a zone reached in a discrete state whose data satisfy the invariant, as the kind of search needs. */
static void arrive(engine *h, bound *z, const spot *here,
                   const int32_t *edges, int count)
{
    uint32_t *at;
    uint32_t state;
    uint32_t n;
    bool fresh;
    bool delays;
    if (h->kind == SEEK_RUN) {
        enter_run(h, z, here);
        return;
    }
    if (h->phase != 0) {
        enter(h, z, here);
        return;
    }
    pack(h, here, 0, h->packed);
    at = find_state(h, h->packed);
    if (at == NULL) {
        return;
    }
    fresh = *at == NONE;
    delays = fresh ? may_delay(h, here) : (h->delays[*at] != 0);
    if (h->failed || !settle(h, z, here, delays) || (fresh && !add_state(h, at, delays))) {
        return;
    }
    state = *at;
    if (h->spans != NULL) {
        note_span(h, z, here);
    }
    if (h->policy != POLICY_SHORTEST) {
        n = new_node(h, state, z);
        if (n != NONE) {
            (void)heap_push(h, cost_of(h, z, edges, count), n, 0);
        }
        return;
    }
    n = keep(h, state, NONE, z, here);
    if (n == NONE) {
        return;
    }
    visit(h);
    if (!runs(h)) {
        return;
    }
    if ((h->kind == SEEK_GOAL) || (h->kind == SEEK_DEADLOCK) || (h->kind == SEEK_NESTED)) {
        if (is_goal(h, z, here) && runs(h)) {
            h->found = n;
            h->state = SEARCH_FOUND;
            return;
        }
    } else if (h->kind == SEEK_STAY_AFTER) {
        if (ROOM(h, h->triggers, h->trigger_room, (uint64_t)h->trigger_count + 1)) {
            h->triggers[h->trigger_count++] = n;
        }
    }
    (void)wait_for(h, n);
}

static void note_step(engine *h, const int32_t *edges, int n)
{
    (void)memcpy(h->step_edges, edges, (size_t)n * sizeof *edges);
    h->step_edge_count = n;
}

/* Take a move of the walk `out`: store the zone after it. */
static bool take(engine *h, walk *w, const int32_t *edges, int n)
{
    const uint32_t ordinal = w->ordinal++;
    count_work(h);
    copy_zone(h, w->zone, w->source);
    if (cut_guards(h, w, w->zone, edges, n)) {
        if (!apply(h, w, edges, n)) {
            note_step(h, edges, n);
            return false;
        }
        if (invariant_data_holds(h, &w->there)) {
            int j;
            for (j = 0; j < w->reset_count; j++) {
                reset(w->zone, h->dim, w->resets[2 * j], w->resets[2 * j + 1]);
            }
            h->link = ordinal;
            arrive(h, w->zone, &w->there, edges, n);
        }
    }
    return runs(h) && !h->failed;
}

/* Stop at the move with the wanted number, and note its edges and the negated bounds of its blockers. */
static bool match(engine *h, walk *w, const int32_t *edges, int n)
{
    uint32_t k;
    if (w->ordinal++ != h->wanted) {
        return true;
    }
    note_step(h, edges, n);
    for (k = 0; k < w->against_count; k++) {
        const cut one = failing(w, k);
        (void)(put(h, &h->step_bounds, one.x) && put(h, &h->step_bounds, one.y)
               && put(h, &h->step_bounds, (int32_t)((one.b - (one.b & 1)) / 2))
               && put(h, &h->step_bounds, (int32_t)(one.b & 1)));
    }
    return false;
}

/* Expand a node on the way to the goal: add its successors. */
static void expand(engine *h, uint32_t n)
{
    walk *w = &h->out;
    unpack(h, h->nodes[n].state, &w->here);
    copy_zone(h, w->source, zone_of(h, n));
    w->ordinal = 0;
    h->from_node = n;
    (void)each_move(h, w, take);
}

/* Expand a node of a search for a late response: inside by crossings and moves, before it by moves and by
 * marks where the goal holds. */
static void expand_late(engine *h, uint32_t n)
{
    walk *w = &h->out;
    const int k = piece_of(h, n);
    const bool delays = h->delays[h->nodes[n].state] != 0;
    uint32_t state;
    int m;
    h->phase = (k >= 0);
    if (k < 0) {
        expand(h, n);
        for (m = 0; (m < h->goal_count) && runs(h) && !h->failed; m++) {
            copy_zone(h, w->zone, w->source);
            if (cut_row(h, w->zone, plan_rows(h->plan, AT_GOAL) + (ptrdiff_t)m * ROW_SIZE,
                        &w->here)) {
                reset(w->zone, h->dim, h->timer, 0);
                h->phase = 1;
                h->link = LINK_MARK | (uint32_t)m;
                enter(h, w->zone, &w->here);
                h->phase = 0;
            }
        }
        return;
    }
    unpack(h, h->nodes[n].state, &w->here);
    copy_zone(h, w->source, zone_of(h, n));
    h->from_node = n;
    for (m = 0; delays && (piece_at(h, k)[ROW_ATOMS] > 0) && (m < 2 * h->inside_count); m++) {
        if (!runs(h) || h->failed) {
            break;
        }
        if ((m / 2 == k) || !has_piece(h, m / 2, &w->here)
            || !cross(h, w->zone, w->source, k, m / 2, m % 2 == 1, &w->here)) {
            continue;
        }
        state = state_of(h, &w->here, 1 + (uint32_t)(m / 2));
        h->link = LINK_CROSSING | (uint32_t)(m % 2);
        if (state != NONE) {
            keep_late(h, state, w->zone, m / 2, delays, &w->here);
        }
    }
    if (runs(h) && !h->failed) {
        w->ordinal = 0;
        (void)each_move(h, w, take);
    }
    h->phase = 0;
}

/* A step of a best-first search. A node that meets the goal returns to the heap with the price of the
 * goal, and ends the search when it is the best. */
static void step_best(engine *h)
{
    walk *w = &h->out;
    const entry e = heap_pop(h);
    double cost = e.cost;
    unpack(h, h->nodes[e.node].state, &w->here);
    if (e.goal != 0) {
        if (is_goal(h, zone_of(h, e.node), &w->here) && runs(h)) {
            if (h->parts.count > 0) {
                (void)cheapest(h);
                h->parts.count = 1;
            }
            h->found = e.node;
            h->state = SEARCH_FOUND;
        }
        return;
    }
    copy_zone(h, w->source, zone_of(h, e.node));
    if (keep(h, h->nodes[e.node].state, e.node, w->source, &w->here) == NONE) {
        drop_zone(h, e.node);
        return;
    }
    visit(h);
    h->price = e.cost;
    if (is_goal(h, w->source, &w->here)) {
        if ((h->policy == POLICY_FASTEST) && (h->parts.count > 0)) {
            cost = cheapest(h);
        }
        (void)heap_push(h, cost, e.node, 1);
    }
    if (runs(h) && !h->failed) {
        expand(h, e.node);
    }
}

#endif
