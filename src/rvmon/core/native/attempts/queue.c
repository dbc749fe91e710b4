/* Attempts in bulk: a queue in the order of their triggers, divided into segments of equal state.
 *
 * A state is a location and its clocks, each an instant that all attempts of a segment share, or the
 * trigger of each. An edge takes a clock from another or resets it now: so what attempts share, they
 * share behind it, too, if they took the same edge, and these differ only where an age that counts from
 * the trigger is in another region. The ages of a segment fall from its first attempt to its last, so
 * the attempts of one region stand together, and a letter moves a whole segment, split where such a
 * region ends (binary search). Neighbours that come to the same state become one segment; mostly they
 * soon do, as a letter that is good or bad for one is for all. A position costs O(segments * regions *
 * log attempts) plus the attempts it decides, and an open attempt takes 16 bytes.
 *
 * Readings of the unknown would double the states: at the first unknown letter the queue is dissolved
 * into attempts of the pool, which drive.c takes one by one. The judge's list is empty while its queue
 * is not, and the other way round. The attempt of a running episode is the youngest. Steps are in
 * queue_steps.c. */
#include "attempts/attempts.h"
#include "notes/notes.h"
#include "results/results.h"

#include <string.h>

bool is_queued(const run *r, int32_t index)
{
    return r->judges[index].queue != NULL;
}

bool queue_is_empty(const judge *j)
{
    return (j->queue == NULL) || (j->queue->count == 0);
}

/* Give a judge an empty queue if its attempts can stand in one: several at a time, each sure and triggered
 * by an instant of its own, which nothing but letters and time moves. False: memory is short. */
bool make_queue(run *r, int32_t index)
{
    const judge_plan *own = &r->part->judges[index];
    judge *j = &r->judges[index];
    if (((own->flags & JUDGE_HIDDEN) != 0) || (own->trigger < 0) || (own->automaton < 0)
        || (r->part->machines[index].clocks > QUEUED_CLOCKS) || (GAP(r) > 1)
        || (r->part->plan->captured > 0) || (j->queue != NULL)) {
        return true;
    }
    j->queue = arena_take(&r->home->monitor->memory, sizeof *j->queue);
    if (j->queue == NULL) {
        return false;
    }
    j->queue->latest.letter = -1;
    return true;
}

void clear_queue(judge *j)
{
    if (j->queue != NULL) {
        j->queue->head = 0;
        j->queue->count = 0;
        j->queue->now.count = 0;
    }
}

/* A queued attempt in the form of the pool's, in the part's scratch slot: valid until the next call.
 * `tick`: the last one by which clocks were reset that each tick resets. `due` is in the past, so that it
 * is driven when it is put into the pool. */
static attempt *attempt_of_queued(const run *r, const machine *a, const queued *one,
                                  const segment *s, int64_t tick)
{
    attempt *x = r->home->scratch_attempt;
    int32_t c;
    x->triggered = one->triggered;
    x->due = -LIMIT;
    x->number = one->number;
    x->next = -1;
    x->location = s->location;
    x->sure = true;
    x->doubted_at = RV_NO_TIME;
    for (c = 0; c < a->widths[s->location]; c++) {
        x->clocks[c] = instant_of_clock(s->clocks[c], one->triggered, tick);
    }
    return x;
}

/* Report a queued attempt that is decided at `t`; `s`: as it stood just before. */
void report_queued(const queueing *g, const queued *one, const segment *s, bool passed, int64_t t)
{
    const attempt *x = attempt_of_queued(g->r, g->a, one, s, t - 1);
    int64_t note = -1;
    if (g->r->truth_log != NULL) {
        hold_token(g->r->home->monitor, g->a, s->location, x->clocks);
        note = note_decision(g->r, g->index, x, t);
    }
    report(g->r, g->index, x, x->number, passed ? RV_PASS : RV_FAIL, RV_BY_PREFIX, t, note);
}

/* Double the ring of a queue, which is full; false: memory is short. */
static bool widen_queue(rv_monitor *m, queue *q)
{
    const int32_t was = q->room;
    queued *made = widened(m, q->items, &q->room, (int64_t)was + 1, sizeof *made);
    if (made == NULL) {
        return false;
    }
    q->items = made;
    if (q->head > 0) { /* the youngest, in front of the oldest, come behind the others */
        (void)memcpy(&made[was], made, (size_t)q->head * sizeof *made);
    }
    return true;
}

/* The i-th slot of a queue; with `append` a new one at its end (`i` is the old count). NULL: memory is
 * short. */
queued *queue_slot(rv_monitor *m, queue *q, int32_t i, bool append)
{
    if (append) {
        if ((q->count == q->room) && !widen_queue(m, q)) {
            return NULL;
        }
        q->count++;
    }
    return item(q, i);
}

/* Append a segment without attempts; NULL: memory is short. */
segment *next_segment(rv_monitor *m, segments *all)
{
    if (all->count == all->room) {
        segment *made = widened(m, all->at, &all->room, (int64_t)all->count + 1, sizeof *made);
        if (made == NULL) {
            return NULL;
        }
        all->at = made;
    }
    all->count++;
    return &all->at[all->count - 1];
}

/* Where an attempt stands that begins at `t` by the letter there. */
static const beginning *begun_at(const queueing *g, int64_t t)
{
    beginning *b = &g->q->latest;
    if (b->letter != g->j->letter) {
        int64_t clocks[QUEUED_CLOCKS];
        int64_t due = NEVER;
        bool slides = false;
        token k;
        int32_t c;
        for (c = 0; c < QUEUED_CLOCKS; c++) {
            clocks[c] = t;
        }
        k.location = g->a->initial;
        k.clocks = clocks;
        k.moves = NULL;
        (void)step_token(g->a, &k, t, g->j->letter);
        b->letter = g->j->letter;
        b->location = k.location;
        b->rests = (k.location <= PASSED) || (rests(g->a, &k, t, b->letter, &due, &slides) && !slides);
        b->due = (due == NEVER) ? NEVER : due - t;
    }
    return b;
}

/* Whether an attempt that begins at `t` in a location is in the state of a segment. */
static bool begins_in(const queueing *g, const segment *s, int32_t location, int64_t t)
{
    bool same = s->location == location;
    int32_t c;
    for (c = 0; same && (c < g->a->widths[location]); c++) {
        same = (s->clocks[c] == OF_TRIGGER) || (s->clocks[c] == t);
    }
    return same;
}

/* The state in a location all of whose clocks began with the trigger. */
static void set_begun(segment *s, int32_t location)
{
    int32_t c;
    s->location = location;
    for (c = 0; c < QUEUED_CLOCKS; c++) {
        s->clocks[c] = OF_TRIGGER;
    }
}

/* Start an attempt at `t`: step it once, report it if that decides it, else append it. The last segment
 * is where the youngest stand. False: memory is short. */
bool queue_begin(run *r, int32_t index, int64_t t)
{
    const queueing g = queueing_of(r, index);
    const beginning *begun = begun_at(&g, t);
    queue *q = g.q;
    segment *last = (q->now.count > 0) ? &q->now.at[q->now.count - 1] : NULL;
    queued *made;
    int64_t due;
    queued x;
    count_begin(r, index, t);
    count_edge(&g, g.a->initial, begun->location, 1, t);
    x.triggered = t;
    g.j->count++;
    x.number = g.j->count;
    x.spare = 0;
    if (runs_on(r, index)) {
        leave_episode(r, index);
        g.j->current = IN_QUEUE;
    }
    if (begun->location <= PASSED) {
        segment initial;
        set_begun(&initial, g.a->initial);
        if (g.j->current == IN_QUEUE) {
            decide_current(r, index, begun->location == FAILED, t);
        }
        report_queued(&g, &x, &initial, begun->location == PASSED, t);
        return true;
    }
    if ((last == NULL) || !begins_in(&g, last, begun->location, t)) {
        last = next_segment(r->home->monitor, &q->now);
        if (last == NULL) {
            return false;
        }
        set_begun(last, begun->location);
        last->count = 0;
    }
    made = queue_slot(r->home->monitor, q, q->count, true);
    if (made == NULL) {
        return false;
    }
    *made = x;
    last->count++;
    due = sum(t, begun->due);
    if (!begun->rests) {
        set_restless(r, index);
        due = t + 1;
    }
    set_rule_due(r, index, least(r->rules.due[index], due));
    return true;
}

/* The next attempt of a judge's queue from a place on, which starts as zeros, oldest first, as it stands at
 * `tick`, in the form of the pool's; NULL: there is none. It is valid until the next call. */
attempt *next_queued(const run *r, int32_t index, queue_place *p, int64_t tick)
{
    const queue *q = r->judges[index].queue;
    attempt *x;
    if ((q == NULL) || (p->item == q->count)) {
        return NULL;
    }
    while (p->item == p->end) {
        p->end += q->now.at[p->segments].count;
        p->segments++;
    }
    x = attempt_of_queued(r, &r->part->machines[index], item(q, p->item), &q->now.at[p->segments - 1], tick);
    p->item++;
    return x;
}

/* Move all queued attempts to the judge's list, as they stand at `tick`: the letter behind it is unknown. */
void dissolve_queue(run *r, int32_t index, int64_t tick)
{
    judge *j = &r->judges[index];
    queue_place place = {0, 0, 0};
    const attempt *one = next_queued(r, index, &place, tick);
    while (one != NULL) {
        const int32_t at = new_attempt(r);
        if (at < 0) {
            break;
        }
        (void)memcpy(attempt_at(r->home, at), one, r->home->stride);
        if (j->last < 0) {
            j->first = at;
        } else {
            attempt_at(r->home, j->last)->next = at;
        }
        j->last = at;
        one = next_queued(r, index, &place, tick);
    }
    if (j->current == IN_QUEUE) {
        j->current = j->last;
    }
    j->sorted = false;
    clear_queue(j);
}

/* Report the queued attempts, which are open at the end of the trace. They are sure and can pass, so that
 * `outcomes` depends on the rule for the end alone. */
void queue_close(run *r, int32_t index, int64_t end, int64_t reached)
{
    const judge_plan *own = &r->part->judges[index];
    const machine *a = &r->part->machines[index];
    const int64_t tick = r->judges[index].position;
    const int64_t now = stamp_of_end(end, reached);
    queue_place place = {0, 0, 0};
    const attempt *x = next_queued(r, index, &place, tick);
    while (x != NULL) {
        const int32_t outcome = own->outcomes[holds_at_end(a, x->location, x->clocks, end, reached) ? 1 : 0];
        report(r, index, x, x->number, (uint8_t)(outcome & 3), (uint8_t)(outcome >> 2), end,
               (r->truth_log == NULL) ? -1 : note_open(r, index, x, now, false, end));
        x = next_queued(r, index, &place, tick);
    }
}

/* The i-th oldest attempt of a judge's queue: its trigger and number. */
const queued *queue_item(const judge *j, int32_t i)
{
    return item(j->queue, i);
}
