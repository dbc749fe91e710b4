/* Steps of a queue (queue.c): a letter, or time, moves whole segments.
 *
 * A step goes through the segments from the oldest to the youngest attempt, splits each where an age is
 * in another region, looks the edge of each piece up once, and writes new segments; a piece that comes to
 * the state of the one before it is merged. The ring is compacted in place. */
#include "attempts/attempts.h"
#include "results/results.h"

#include <string.h>

/* The most items of a segment that are given own instants, which it had in common, to join another: so a
 * merge costs little, whatever its segments are. */
#define FEW 64

/* The first item of [from, end), all in one segment, whose clock was reset after `t`; `end`: none. Mostly
 * it is among the first, so twice as many are looked at each time, then half as many. */
static int32_t first_after(const queueing *g, const segment *s, int32_t c, int32_t from, int32_t end,
                           int64_t t)
{
    int32_t low = from;
    int32_t left = end - from;
    int32_t near = 1;
    while ((near < left) && (instant_of_clock(g, s, c, low + near - 1, t) <= t)) {
        low += near;
        left -= near;
        near *= 2;
    }
    left = (near < left) ? near : left;
    if (left == 0) {
        return low;
    }
    while (left > 1) { /* a conditional move: a branch here would be mispredicted half the time */
        const int32_t half = left / 2;
        low += (instant_of_clock(g, s, c, low + half - 1, t) <= t) ? half : 0;
        left -= half;
    }
    return low + ((instant_of_clock(g, s, c, low, t) <= t) ? 1 : 0);
}

/* The ages at which a clock of a location enters the next region. */
static const int64_t *cuts_of(const machine *a, int32_t location, int32_t c, int32_t *count)
{
    const int32_t at = location * a->clocks + c;
    *count = a->cut_first[at + 1] - a->cut_first[at];
    return &a->cuts[a->cut_first[at]];
}

/* Where time alone leads from a row, whatever the next letter is. */
static int32_t settled_at(const machine *a, int32_t row, int32_t location)
{
    const int32_t truth = a->time_values[row];
    return (truth == IS_UNKNOWN) ? location : ((truth == IS_TRUE) ? PASSED : FAILED);
}

/* Whether the items of a segment have instants of a clock that differ. */
static bool differs(const segment *s, int32_t c)
{
    return (s->clocks[c] == OF_TRIGGER) || (s->clocks[c] == OF_EACH_ATTEMPT);
}

/* The row of item `from` of a segment at `t`, and the end of the items of [from, end) that share it: ages
 * fall along them, if they differ, so that they come to lower regions, if to others. */
static int32_t end_of_row(const queueing *g, const segment *s, int32_t from, int32_t end, int64_t t,
                          int32_t *row)
{
    const machine *a = g->a;
    int32_t until = end;
    int32_t c;
    *row = a->bases[s->location];
    for (c = 0; c < a->widths[s->location]; c++) {
        int32_t region;
        const int64_t *cuts = cuts_of(a, s->location, c, &region);
        const int64_t clock = instant_of_clock(g, s, c, from, t - 1);
        while ((region > 0) && (clock > t - cuts[region - 1])) {
            region--;
        }
        *row += region * a->strides[s->location * a->clocks + c];
        if ((region > 0) && differs(s, c)) {
            until = first_after(g, s, c, from, until, t - cuts[region - 1]);
        }
    }
    return until;
}

static int32_t edge_at(const queueing *g, int32_t row)
{
    return g->a->edges[row * g->a->classes + g->j->letter];
}

static void tell_decided(const queueing *g, const segment *s, int32_t from, int32_t end, bool passed,
                         int64_t t)
{
    int32_t i;
    if ((g->j->current == IN_QUEUE) && (end == g->q->count)) {
        decide_current(g->r, g->index, !passed, t);
    }
    for (i = from; i < end; i++) {
        report_queued(g, i, s, passed, t);
    }
}

/* Count an edge that `count` attempts of a queue take at `t`. */
void count_edge(const queueing *g, int32_t location, int32_t target, int32_t count, int64_t t)
{
    rv_hit *moves = moves_of(g->r, g->index);
    if ((moves != NULL) && (target != location)) {
        count_move(g->a, moves, location, target, count, t);
    }
}

/* The items that a step has kept so far. */
typedef struct {
    int32_t base;              /* the place of the first one: the new head */
    int32_t count;
} remaining;

/* Whether clock `c` may become one of own instants where the items [from, end) of `s` follow those of
 * `last`, of which the youngest is `before`: instants ascend, and few have to be written. What was reset
 * just now, or at each tick, may go on so: it stays apart. */
static bool may_be_own(const queueing *g, const segment *last, int32_t before, const segment *s,
                       int32_t from, int32_t end, int32_t c, int64_t t)
{
    const int64_t one = last->clocks[c];
    const int64_t other = s->clocks[c];
    return (one != OF_EACH_TICK) && (other != OF_EACH_TICK) && (other != t)
           && ((one == OF_EACH_ATTEMPT) || (last->count <= FEW))
           && ((other == OF_EACH_ATTEMPT) || (end - from <= FEW))
           && (instant_of_clock(g, last, c, before, t) <= instant_of_clock(g, s, c, from, t));
}

/* Give the items [from, end) of a segment the instant of a clock as their own. */
static void make_own(const queueing *g, const segment *s, int32_t from, int32_t end, int32_t c)
{
    int32_t i;
    for (i = from; (s->clocks[c] != OF_EACH_ATTEMPT) && (i < end); i++) {
        *own_instant(g, i, c) = instant_of_clock(g, s, c, i, 0);
    }
}

/* Whether the items [from, end), which are in state `s` at `t`, become part of the last segment of those
 * kept, whose items end at `next`; its clocks are changed accordingly. */
static bool join_last(const queueing *g, segment *last, int32_t next, const segment *s, int32_t from,
                      int32_t end, int64_t t)
{
    uint32_t own = 0;
    bool same = last->location == s->location;
    int32_t c;
    for (c = 0; same && (c < g->a->widths[s->location]); c++) {
        if ((last->clocks[c] != s->clocks[c]) || (s->clocks[c] == OF_EACH_ATTEMPT)) {
            own |= (uint32_t)1 << c;
            same = may_be_own(g, last, next - 1, s, from, end, c, t);
        }
    }
    if (!same || ((own != 0U) && !make_own_instants(g->r->home->monitor, g->a, g->q))) {
        return false;
    }
    for (c = 0; c < g->a->widths[s->location]; c++) {
        if (((own >> c) & 1U) != 0U) {
            make_own(g, last, next - last->count, next, c);
            make_own(g, s, from, end, c);
            last->clocks[c] = OF_EACH_ATTEMPT;
        }
    }
    return true;
}

/* Keep the items [from, end), which are in state `s` at `t`; they move up over decided ones. */
static void keep_items(const queueing *g, remaining *kept, const segment *s, int32_t from, int32_t end,
                       int64_t t)
{
    segments *all = &g->q->next;
    segment *last = (all->count > 0) ? &all->at[all->count - 1] : NULL;
    int32_t i;
    if (kept->count == 0) {
        kept->base = from;
    }
    if ((last == NULL) || !join_last(g, last, kept->base + kept->count, s, from, end, t)) {
        last = next_segment(g->r->home->monitor, all);
        if (last == NULL) {
            return;
        }
        *last = *s;
        last->count = 0;
    }
    last->count += end - from;
    for (i = from; (kept->base + kept->count != from) && (i < end); i++) {
        const int32_t place = kept->base + kept->count + (i - from);
        *item(g->q, place) = *item(g->q, i);
        if (g->q->own != NULL) {
            (void)memcpy(own_instant(g, place, 0), own_instant(g, i, 0),
                         (size_t)g->a->clocks * sizeof *g->q->own);
        }
    }
    kept->count += end - from;
}

static void replace_segments(queue *q, const remaining *kept)
{
    const segments was = q->now;
    if (q->room > 0) {
        q->head = (q->head + kept->base) & (q->room - 1);
    }
    q->count = kept->count;
    q->now = q->next;
    q->next = was;
}

/* Let an item take its own instants from those of its clocks that an edge names. */
static void take_own(const queueing *g, int32_t i, const int32_t *sources, int32_t count)
{
    int64_t was[QUEUED_CLOCKS];
    int64_t *own = own_instant(g, i, 0);
    int32_t c;
    (void)memcpy(was, own, (size_t)g->a->clocks * sizeof *own);
    for (c = 0; c < count; c++) {
        own[c] = (sources[c] < 0) ? own[c] : was[sources[c]];
    }
}

/* The state of the items [from, end) of a segment behind an edge that they take at `t`. */
static segment moved_by(const queueing *g, const segment *s, int32_t from, int32_t end, int32_t number,
                        int64_t t)
{
    const machine *a = g->a;
    const int32_t *sources = &a->sources[number * a->clocks];
    bool others = false;
    segment made;
    int32_t c;
    int32_t i;
    made.location = a->targets[number];
    for (c = 0; c < a->widths[made.location]; c++) {
        const int64_t clock = (sources[c] < 0) ? t : s->clocks[sources[c]];
        made.clocks[c] = (clock == OF_EACH_TICK) ? t - 1 : clock;
        others = others || ((clock == OF_EACH_ATTEMPT) && (sources[c] != c));
    }
    for (i = from; others && (i < end); i++) {
        take_own(g, i, sources, a->widths[made.location]);
    }
    return made;
}

/* Whether two clocks of the items [from, end) of a segment were reset together. */
static bool are_same_clocks(const queueing *g, const segment *s, int32_t from, int32_t end, int32_t one,
                            int32_t other)
{
    bool same = s->clocks[one] == s->clocks[other];
    int32_t i;
    for (i = from; same && (one != other) && (s->clocks[one] == OF_EACH_ATTEMPT) && (i < end); i++) {
        same = *own_instant(g, i, one) == *own_instant(g, i, other);
    }
    return same;
}

/* Whether all items of a segment, which was stepped at `t`, stay in its state at the next position if the
 * letter stays, and so at all up to its next region. Clocks that each tick resets do not hinder that, if
 * they are the same for all items: they become OF_EACH_TICK. */
static bool rests_all(const queueing *g, segment *s, int32_t from, int32_t end, int64_t t)
{
    const machine *a = g->a;
    uint32_t sliding = 0;
    int32_t at = from;
    int32_t c;
    while (at < end) {
        int32_t row;
        const int32_t until = end_of_row(g, s, at, end, t + 1, &row);
        const int32_t number = edge_at(g, row);
        const int32_t *sources = &a->sources[number * a->clocks];
        uint32_t slid = 0;
        if (a->targets[number] != s->location) {
            return false;
        }
        for (c = 0; c < a->widths[s->location]; c++) {
            if ((sources[c] < 0) && (GAP(g->r) == 1) && (s->clocks[c] == t)) {
                slid |= (uint32_t)1 << c;
            } else if ((sources[c] < 0) || !are_same_clocks(g, s, at, until, sources[c], c)) {
                return false;
            } else {
                /* The clock stays. */
            }
        }
        if ((at > from) && (slid != sliding)) {
            return false;
        }
        sliding = slid;
        at = until;
    }
    for (c = 0; c < a->widths[s->location]; c++) {
        s->clocks[c] = (((sliding >> c) & 1U) != 0U) ? OF_EACH_TICK : s->clocks[c];
    }
    return true;
}

/* The first instant after `t` at which an item of a segment enters another region. A clock that each tick
 * resets enters none. */
static int64_t next_region(const queueing *g, const segment *s, int32_t from, int32_t end, int64_t t)
{
    int64_t found = NEVER;
    int32_t c;
    int32_t i;
    for (c = 0; c < g->a->widths[s->location]; c++) {
        int32_t count;
        const int64_t *cuts = cuts_of(g->a, s->location, c, &count);
        for (i = 0; (i < count) && (s->clocks[c] != OF_EACH_TICK); i++) {
            int64_t clock = s->clocks[c];
            if (differs(s, c)) {
                const int32_t one = first_after(g, s, c, from, end, t - cuts[i]);
                clock = (one < end) ? instant_of_clock(g, s, c, one, t) : -LIMIT;
            }
            found = (clock + cuts[i] > t) ? least(found, clock + cuts[i]) : found;
        }
    }
    return found;
}

/* Set when the queue is due next, as it stands at `t`. With `moving` a letter was read: if an attempt
 * would go on moving by the same letter, it is due at the next position. */
static void set_queue_due(const queueing *g, int64_t t, bool moving)
{
    int64_t due = NEVER;
    int32_t from = 0;
    int32_t k;
    for (k = 0; k < g->q->now.count; k++) {
        segment *s = &g->q->now.at[k];
        const int32_t end = from + s->count;
        if (moving && !rests_all(g, s, from, end, t)) {
            set_restless(g->r, g->index);
            due = t + 1;
            break;
        }
        due = least(due, next_region(g, s, from, end, t));
        from = end;
    }
    set_rule_due(g->r, g->index, due);
}

/* One step of the queue at `t`: by the letter if it is a position, else by time alone. */
static void step_queue(const queueing *g, int64_t t, bool is_position)
{
    remaining kept = {0, 0};
    int32_t from = 0;
    int32_t k;
    g->q->next.count = 0;
    for (k = 0; k < g->q->now.count; k++) {
        const segment *s = &g->q->now.at[k];
        const int32_t end = from + s->count;
        while (from < end) {
            int32_t row;
            const int32_t until = end_of_row(g, s, from, end, t, &row);
            const int32_t number = is_position ? edge_at(g, row) : -1;
            const int32_t target = is_position ? g->a->targets[number] : settled_at(g->a, row, s->location);
            count_edge(g, s->location, target, until - from, t);
            if (target <= PASSED) {
                tell_decided(g, s, from, until, target == PASSED, t);
            } else {
                const segment moved = is_position ? moved_by(g, s, from, until, number, t) : *s;
                keep_items(g, &kept, &moved, from, until, t);
            }
            from = until;
        }
    }
    replace_segments(g->q, &kept);
    set_queue_due(g, t, is_position);
}

/* Visit the position at `t`, whose letter the judge has. */
void queue_visit(run *r, int32_t index, int64_t t)
{
    const queueing g = queueing_of(r, index);
    step_queue(&g, t, true);
}

/* Let time come to `t` with the letter as it is: steps at the due instants, nothing between them. Where
 * only samples are positions time alone decides, and the next sample has to be looked at. */
void queue_pass(run *r, int32_t index, int64_t t)
{
    const queueing g = queueing_of(r, index);
    while ((g.q->count > 0) && (r->rules.due[index] <= t)) {
        step_queue(&g, r->rules.due[index], GAP(r) > 0);
        if (GAP(r) == 0) {
            set_restless(r, index);
        }
    }
    if (g.q->count == 0) {
        set_rule_due(r, index, NEVER);
    }
}

/* Let time come to `t`, whose letter is not known yet: time alone decides. */
void queue_reach(run *r, int32_t index, int64_t t)
{
    const queueing g = queueing_of(r, index);
    if ((g.q->count > 0) && (r->rules.due[index] <= t)) {
        step_queue(&g, t, false);
        set_restless(r, index);
        if (GAP(r) > 0) {
            set_rule_due(r, index, (g.q->count > 0) ? least(r->rules.due[index], t) : NEVER);
        }
    }
}
