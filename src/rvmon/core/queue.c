/* Attempts of which age alone decides: a queue in the order of their triggers, cut into segments of one
 * location. A letter moves a segment at once; where a region of ages ends, the place is found by
 * halving. So a position costs as much as there are segments, however many attempts are open.
 *
 * Who made the plan has proved (JUDGE_IN_RUNS) that there is one clock at most, which starts at the
 * trigger, and that older attempts are never led behind younger ones. As soon as something unknown
 * matters, attempts are driven one by one.
 *
 * Source: AUTOMATA 3. */
#include "calls.h"

#include <string.h>

/* A queue with its judge. */
typedef struct {
    run *r;
    judge *j;
    queue *q;
    const machine *a;
    int32_t index;
} queueing;

bool is_queued(const run *r, int32_t index)
{
    return r->judges[index].queue != NULL;
}

bool queue_is_empty(const judge *j)
{
    return (j->queue == NULL) || (j->queue->count == 0);
}

static queueing queueing_of(run *r, int32_t index)
{
    queueing g;
    g.r = r;
    g.j = &r->judges[index];
    g.q = g.j->queue;
    g.a = &r->part->machines[index];
    g.index = index;
    return g;
}

/* The queue of a judge, if it may have one; false if memory is short. */
bool make_queue(run *r, int32_t index)
{
    const judge_plan *plan_of_judge = &r->part->judges[index];
    const int32_t flags = plan_of_judge->flags & (JUDGE_IN_RUNS | JUDGE_EPISODIC);
    judge *j = &r->judges[index];
    if ((flags != JUDGE_IN_RUNS) || (plan_of_judge->automaton < 0)
        || (r->part->machines[index].clocks > 1) || (GAP(r) > 1)
        || (r->part->plan->captured > 0) || (j->queue != NULL)) {
        return true;
    }
    j->queue = arena_take(&r->home->monitor->memory, sizeof *j->queue);
    return j->queue != NULL;
}

void clear_queue(judge *j)
{
    if (j->queue != NULL) {
        j->queue->head = 0;
        j->queue->count = 0;
        j->queue->segment_count = 0;
    }
}

static queued *item(const queue *q, int32_t i)
{
    return &q->items[(q->head + i) & (q->room - 1)];
}

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

/* Tell of an attempt that is decided, or open at the end. */
static void tell(const queueing *g, const queued *x, uint8_t verdict, uint8_t decision, int64_t t)
{
    attempt made;
    (void)memset(&made, 0, sizeof made);
    made.triggered = x->triggered;
    made.number = x->number;
    made.sure = true;
    report(g->r, g->index, &made, x->number, verdict, decision, t);
}

static void tell_decided(const queueing *g, int32_t from, int32_t end, bool passed, int64_t t)
{
    int32_t i;
    for (i = from; i < end; i++) {
        tell(g, item(g->q, i), passed ? RV_PASS : RV_FAIL, RV_BY_PREFIX, t);
    }
}

/* The segments that are made while the queue is gone through: what stays moves up. */
typedef struct {
    segment made[SEGMENTS_MOST];
    int32_t count;
    int32_t base;              /* the place of the first item that stays */
    int32_t kept;
} sorting;

static void keep_items(const queueing *g, sorting *s, int32_t location, int32_t from, int32_t end)
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

static void take_sorted(const queueing *g, const sorting *s)
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

/* Step all that are queued at the position at `t`. */
static void step_queue(const queueing *g, int64_t t)
{
    sorting s;
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
            const int32_t target = g->a->targets[g->a->edges[row * g->a->classes + g->j->letter]];
            if (target <= PASSED) {
                tell_decided(g, from, until, target == PASSED, t);
            } else {
                keep_items(g, &s, target, from, until);
            }
            from = until;
        }
    }
    take_sorted(g, &s);
    set_queue_due(g, t, true);
}

/* Decide those that time alone decides at `t`. */
static void settle_queue(const queueing *g, int64_t t)
{
    sorting s;
    int32_t from = 0;
    int32_t k;
    s.count = s.base = s.kept = 0;
    for (k = 0; k < g->q->segment_count; k++) {
        const int32_t location = g->q->segments[k].location;
        const int32_t end = from + g->q->segments[k].count;
        while (from < end) {
            int32_t region;
            const int32_t until = end_of_region(g, location, from, end, t, &region);
            const int32_t truth = g->a->time_values[row_of_region(g->a, location, region)];
            if (truth != IS_UNKNOWN) {
                tell_decided(g, from, until, truth == IS_TRUE, t);
            } else {
                keep_items(g, &s, location, from, until);
            }
            from = until;
        }
    }
    take_sorted(g, &s);
    set_queue_due(g, t, false);
}

/* Take all that are queued to the position at `t`, of which the letter was read. */
void queue_visit(run *r, int32_t index, int64_t t)
{
    const queueing g = queueing_of(r, index);
    step_queue(&g, t);
}

/* Let time come to `t`; if there is a position at every tick, up to there with the letter as it is. */
void queue_pass(run *r, int32_t index, int64_t t)
{
    const queueing g = queueing_of(r, index);
    while ((g.q->count > 0) && (r->rules.due[index] <= t)) {
        const int64_t due = r->rules.due[index];
        if (GAP(r) == 0) {
            settle_queue(&g, due);
            set_restless(r, index);
        } else {
            step_queue(&g, due);
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
        settle_queue(&g, t);
        set_restless(r, index);
        if (GAP(r) > 0) {
            set_rule_due(r, index, (g.q->count > 0) ? least(r->rules.due[index], t) : NEVER);
        }
    }
}

/* Put an attempt that begins at `t` behind the others, unless that decides it; false if memory is
 * short. */
bool queue_begin(run *r, int32_t index, int64_t t)
{
    const queueing g = queueing_of(r, index);
    queue *q = g.q;
    int64_t clock = 0;
    int64_t due;
    queued x;
    token k;
    k.location = g.a->initial;
    k.clocks = &clock;
    (void)step_token(g.a, &k, t, g.j->letter);
    x.triggered = t;
    g.j->count++;
    x.number = g.j->count;
    x.spare = 0;
    if (k.location <= PASSED) {
        tell(&g, &x, (k.location == PASSED) ? RV_PASS : RV_FAIL, RV_BY_PREFIX, t);
        return true;
    }
    if (q->count == q->room) {
        const int32_t room = (q->room > 0) ? 2 * q->room : 8;
        queued *made = (q->room < INT32_MAX / 4)
            ? arena_take(&r->home->monitor->memory, (size_t)room * sizeof *made) : NULL;
        int32_t i;
        if (made == NULL) {
            r->home->monitor->spoilt = true;
            return false;
        }
        for (i = 0; i < q->count; i++) {
            made[i] = *item(q, i);
        }
        arena_give(&r->home->monitor->memory, q->items, (size_t)q->room * sizeof *made);
        q->items = made;
        q->room = room;
        q->head = 0;
    }
    *item(q, q->count) = x;
    q->count++;
    if ((q->segment_count > 0) && (q->segments[q->segment_count - 1].location == k.location)) {
        q->segments[q->segment_count - 1].count++;
    } else if (q->segment_count < SEGMENTS_MOST) {
        q->segments[q->segment_count].location = k.location;
        q->segments[q->segment_count].count = 1;
        q->segment_count++;
    } else {
        r->home->monitor->spoilt = true;
        return false;
    }
    if (!rests(g.a, &k, t, g.j->letter, &due)) {
        set_restless(r, index);
        due = t + 1;
    }
    set_rule_due(r, index, least(r->rules.due[index], due));
    return true;
}

/* Drive those that are queued one by one from now on: something unknown matters. */
void loosen_queue(run *r, int32_t index)
{
    const queueing g = queueing_of(r, index);
    int32_t from = 0;
    int32_t k;
    for (k = 0; k < g.q->segment_count; k++) {
        const int32_t end = from + g.q->segments[k].count;
        for (; from < end; from++) {
            const queued *one = item(g.q, from);
            const int32_t at = place_taken(r);
            attempt *x;
            if (at < 0) {
                break;
            }
            x = attempt_at(r->home, at);
            (void)memset(x, 0, r->home->stride);
            x->triggered = one->triggered;
            x->number = one->number;
            x->location = g.q->segments[k].location;
            x->clocks[0] = one->triggered;
            x->due = -LIMIT;
            x->sure = true;
            x->next = -1;
            if (g.j->last < 0) {
                g.j->first = at;
            } else {
                attempt_at(r->home, g.j->last)->next = at;
            }
            g.j->last = at;
        }
    }
    g.j->sorted = false;
    clear_queue(g.j);
}

/* Settle those that are queued when time has come to the end. */
void queue_close(run *r, int32_t index, int64_t end, int64_t reached)
{
    const judge_plan *own = &r->part->judges[index];
    const queueing g = queueing_of(r, index);
    int32_t from = 0;
    int32_t k;
    for (k = 0; k < g.q->segment_count; k++) {
        const int32_t behind = from + g.q->segments[k].count;
        for (; from < behind; from++) {
            const queued *one = item(g.q, from);
            const int64_t clocks[1] = {one->triggered};
            const int32_t outcome =
                own->outcomes[holds_at_end(g.a, g.q->segments[k].location, clocks, end, reached) ? 1 : 0];
            tell(&g, one, (uint8_t)(outcome & 3), (uint8_t)(outcome >> 2), end);
        }
    }
}

/* The trigger and number of one that is queued, the oldest first. */
const queued *queue_item(const judge *j, int32_t i)
{
    return item(j->queue, i);
}
