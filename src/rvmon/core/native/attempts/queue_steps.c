/* Attempts of a queue through positions and time: a letter moves a segment at once. */
#include "attempts/attempts.h"
#include "results/results.h"

#include <string.h>

/* The first item from one on, and before another, that was triggered after `t`. */
static int32_t first_after(const queue *q, int32_t from, int32_t end, int64_t t)
{
    int32_t low = from;
    int32_t left = end - from;
    if (left == 0) {
        return low;
    }
    while (left > 1) { /* which half is next nobody can foretell: no branch */
        const int32_t half = left / 2;
        low += (item(q, low + half - 1)->triggered <= t) ? half : 0;
        left -= half;
    }
    return low + ((item(q, low)->triggered <= t) ? 1 : 0);
}

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

/* Where time alone leads those of a row. */
static int32_t settled_at(const machine *a, int32_t row, int32_t location)
{
    const int32_t truth = a->time_values[row];
    return (truth == IS_UNKNOWN) ? location : ((truth == IS_TRUE) ? PASSED : FAILED);
}

/* The end of the items from one on that are in one region at `t`, and that region. The oldest are in
 * the last ones. */
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

/* So many of a segment go somewhere. */
static void count_segment(const queueing *g, int32_t location, int32_t target, int32_t count, int64_t t)
{
    rv_hit *moves = moves_of(g->r, g->index);
    if ((moves != NULL) && (target != location)) {
        count_move(g->a, moves, location, target, count, t);
    }
}

/* The segments that are made while the queue is gone through: what stays moves up. */
typedef struct {
    segment made[SEGMENTS_MOST];
    int32_t count;
    int32_t base;              /* the place of the first item that stays */
    int32_t kept;
} regrouping;

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
        g->r->home->monitor->spoilt = true; /* no plan of ours comes here */
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

/* Whether all of a segment stay where they are at the next position if the letter stays. */
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

/* When the first of a segment enters another region after `t`. */
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

/* Set when the queue is due, as it stands at `t`; with `moving`, it may go on moving by itself. */
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

/* Take all that are queued through what the letter says at the position at `t`, or, between positions, what
 * time alone decides then. */
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
            const int32_t target = is_position ? g->a->targets[g->a->edges[row * g->a->classes + g->j->letter]]
                                               : settled_at(g->a, row, location);
            count_segment(g, location, target, until - from, t);
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

/* Take all that are queued to the position at `t`, of which the letter was read. */
void queue_visit(run *r, int32_t index, int64_t t)
{
    const queueing g = queueing_of(r, index);
    step_queue(&g, t, true);
}

/* Let time come to `t`; if there is a position at every tick, up to there with the letter as it is. */
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

/* Let time come to `t`, of which the letter is not known. */
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
