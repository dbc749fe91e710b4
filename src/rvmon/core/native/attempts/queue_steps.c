/* Steps of a queue (queue.c): a letter, or time, moves whole segments.
 *
 * A step goes through the segments from the oldest to the youngest attempt, splits each at the age
 * regions, looks the edge of each piece up once, and writes new segments; pieces that go to the same
 * location as the one before them are merged. The ring is compacted in place. */
#include "attempts/attempts.h"
#include "results/results.h"

#include <string.h>

/* The first item of [from, end) that was triggered after `t`; `end`: none. Mostly it is among the first, so
 * twice as many are looked at each time, then half as many. */
static int32_t first_after(const queue *q, int32_t from, int32_t end, int64_t t)
{
    int32_t low = from;
    int32_t left = end - from;
    int32_t near = 1;
    while ((near < left) && (item(q, low + near - 1)->triggered <= t)) {
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
        low += (item(q, low + half - 1)->triggered <= t) ? half : 0;
        left -= half;
    }
    return low + ((item(q, low)->triggered <= t) ? 1 : 0);
}

/* The ages at which the clock of a location enters the next region. */
static const int64_t *cuts_of(const machine *a, int32_t location, int32_t *count)
{
    const int32_t at = location * a->clocks;
    *count = (a->widths[location] > 0) ? a->cut_first[at + 1] - a->cut_first[at] : 0;
    return &a->cuts[a->cut_first[at]];
}

static int32_t row_of_region(const machine *a, int32_t location, int32_t region)
{
    return a->bases[location] + region * a->strides[location * a->clocks];
}

/* Where time alone leads from a row, whatever the next letter is. */
static int32_t settled_at(const machine *a, int32_t row, int32_t location)
{
    const int32_t truth = a->time_values[row];
    return (truth == IS_UNKNOWN) ? location : ((truth == IS_TRUE) ? PASSED : FAILED);
}

/* The age region of item `from` at `t`, and the end of the items of [from, end) that share it. Items
 * are sorted by age, the oldest first, so regions come in falling order. */
static int32_t end_of_region(const queueing *g, int32_t location, int32_t from, int32_t end, int64_t t,
                             int32_t *region)
{
    int32_t count;
    const int64_t *cuts = cuts_of(g->a, location, &count);
    for (*region = count; *region > 0; (*region)--) {
        const int64_t latest = t - cuts[*region - 1];
        if (item(g->q, from)->triggered <= latest) {
            return first_after(g->q, from, end, latest);
        }
    }
    return end;
}

static void tell_decided(const queueing *g, int32_t location, int32_t from, int32_t end, bool passed,
                         int64_t t)
{
    int32_t i;
    for (i = from; i < end; i++) {
        report_queued(g, item(g->q, i), location, passed, t);
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

/* The segments that a step has made so far. */
typedef struct {
    segment made[SEGMENTS_MOST];
    int32_t count;             /* of segments */
    int32_t base;              /* the place of the first item that stays: the new head */
    int32_t kept;              /* items that stay */
} regrouping;

/* Keep the items [from, end), which are in `location` now; they move up over decided ones. */
static void keep_items(const queueing *g, regrouping *s, int32_t location, int32_t from, int32_t end)
{
    const int32_t count = end - from;
    int32_t i;
    if ((s->count > 0) && (s->made[s->count - 1].location == location)) {
        s->made[s->count - 1].count += count;
    } else if (s->count < SEGMENTS_MOST) {
        s->made[s->count].location = location;
        s->made[s->count].count = count;
        s->count++;
    } else {
        g->r->home->monitor->spoilt = true; /* only a forged plan gets here */
        return;
    }
    if (s->kept == 0) {
        s->base = from;
    }
    for (i = from; (s->base + s->kept != from) && (i < end); i++) {
        *item(g->q, s->base + s->kept + (i - from)) = *item(g->q, i);
    }
    s->kept += count;
}

static void replace_segments(const queueing *g, const regrouping *s)
{
    queue *q = g->q;
    if (q->room > 0) {
        q->head = (q->head + s->base) & (q->room - 1);
    }
    q->count = s->kept;
    q->segment_count = s->count;
    (void)memcpy(q->segments, s->made, sizeof q->segments);
}

/* Whether all items of a segment stay in its location at the next position if the letter stays. */
static bool rests_all(const queueing *g, int32_t location, int32_t from, int32_t end, int64_t t)
{
    int32_t at = from;
    while (at < end) {
        int32_t region;
        const int32_t until = end_of_region(g, location, at, end, t + 1, &region);
        const int32_t row = row_of_region(g->a, location, region);
        if (g->a->targets[g->a->edges[row * g->a->classes + g->j->letter]] != location) {
            return false;
        }
        at = until;
    }
    return true;
}

/* The first instant after `t` at which an item of a segment enters another age region. */
static int64_t next_region(const queueing *g, int32_t location, int32_t from, int32_t end, int64_t t)
{
    int32_t count;
    const int64_t *cuts = cuts_of(g->a, location, &count);
    int64_t found = NEVER;
    int32_t i;
    for (i = 0; i < count; i++) {
        const int32_t one = first_after(g->q, from, end, t - cuts[i]);
        if (one < end) {
            found = least(found, item(g->q, one)->triggered + cuts[i]);
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
    for (k = 0; k < g->q->segment_count; k++) {
        const segment *s = &g->q->segments[k];
        const int32_t end = from + s->count;
        if (moving && !rests_all(g, s->location, from, end, t)) {
            set_restless(g->r, g->index);
            due = t + 1;
            break;
        }
        due = least(due, next_region(g, s->location, from, end, t));
        from = end;
    }
    set_rule_due(g->r, g->index, due);
}

/* One step of the queue at `t`: by the letter if it is a position, else by time alone. */
static void step_queue(const queueing *g, int64_t t, bool is_position)
{
    regrouping s;
    int32_t from = 0;
    int32_t k;
    s.count = s.base = s.kept = 0;
    for (k = 0; k < g->q->segment_count; k++) {
        const int32_t location = g->q->segments[k].location;
        const int32_t end = from + g->q->segments[k].count;
        while (from < end) {
            int32_t region;
            const int32_t until = end_of_region(g, location, from, end, t, &region);
            const int32_t row = row_of_region(g->a, location, region);
            const int32_t target = is_position
                ? g->a->targets[g->a->edges[row * g->a->classes + g->j->letter]]
                : settled_at(g->a, row, location);
            count_edge(g, location, target, until - from, t);
            if (target <= PASSED) {
                tell_decided(g, location, from, until, target == PASSED, t);
            } else {
                keep_items(g, &s, target, from, until);
            }
            from = until;
        }
    }
    replace_segments(g, &s);
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
        const int64_t due = r->rules.due[index];
        if (GAP(r) == 0) {
            step_queue(&g, due, false);
            set_restless(r, index);
        } else {
            step_queue(&g, due, true);
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
