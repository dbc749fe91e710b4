/* Attempts in bulk: a queue in the order of their triggers, divided into segments of like state.
 *
 * A state is a location and its clocks, each an instant that all attempts of a segment share, or the
 * trigger of each, or an own instant of each. An edge takes a clock from another or resets it now: so what
 * attempts share, they share behind it, too, if they took the same edge, and these differ only where an
 * age is in another region. The ages of a segment never rise from its first attempt to its last, so the
 * attempts of one region stand together, and a letter moves a whole segment, split where such a region
 * ends (binary search). Neighbours that come to one location become one segment, if their instants ascend
 * and are the same or few. A position costs O(segments * regions * log attempts) plus the attempts it
 * decides; an open attempt takes 16 bytes, and 8 for each clock once one has own instants.
 *
 * Readings of the unknown would double the states: at the first unknown letter the queue is dissolved
 * into attempts of the pool, which drive.c takes one by one. The judge's list is empty while its queue
 * is not, and the other way round. The attempt of a running episode is the youngest. Steps are in
 * queue_steps.c. */
#include "attempts/attempts.h"
#include "notes/notes.h"
#include "results/results.h"

#include <string.h>

bool queue_is_empty(const judge *j)
{
    return (j->queue == NULL) || (j->queue->count == 0);
}

/* Whether attempts of a judge can stand in a queue: several at a time, each triggered by an instant of its
 * own, which nothing but letters and time moves. A monitor in one block has no queues: its memory is
 * reserved for attempts of the pool. */
static bool may_queue(const run *r, int32_t index)
{
    const judge_plan *own = &r->part->judges[index];
    return ((own->flags & JUDGE_HIDDEN) == 0) && (own->trigger >= 0) && (own->automaton >= 0)
           && (r->part->machines[index].clocks <= QUEUED_CLOCKS) && (GAP(r) <= 1)
           && (r->part->plan->captured == 0) && (r->home->monitor->memory.from.allocate != NULL);
}

/* Whether a judge has a queue, which is made when it is first asked for; false also if memory is short. */
bool has_queue(run *r, int32_t index)
{
    judge *j = &r->judges[index];
    if ((j->queue == NULL) && may_queue(r, index)) {
        j->queue = arena_take(&r->home->monitor->memory, sizeof *j->queue);
        if (j->queue != NULL) {
            j->queue->latest.letter = -1;
        }
    }
    return j->queue != NULL;
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
static attempt *attempt_of_queued(const queueing *g, int32_t i, const segment *s, int64_t tick)
{
    const queued *one = item(g->q, i);
    attempt *x = g->r->home->scratch_attempt;
    int32_t c;
    x->triggered = one->triggered;
    x->due = -LIMIT;
    x->number = one->number;
    x->next = -1;
    x->location = s->location;
    x->sure = true;
    x->doubted_at = RV_NO_TIME;
    for (c = 0; c < g->a->widths[s->location]; c++) {
        x->clocks[c] = instant_of_clock(g, s, c, i, tick);
    }
    return x;
}

/* Report the i-th oldest attempt, which is decided at `t`; `s`: as it stood just before. */
void report_queued(const queueing *g, int32_t i, const segment *s, bool passed, int64_t t)
{
    const attempt *x = attempt_of_queued(g, i, s, t - 1);
    int64_t note = -1;
    if (g->r->truth_log != NULL) {
        hold_token(g->r->home->monitor, g->a, s->location, x->clocks);
        note = note_decision(g->r, g->index, x, t);
    }
    report(g->r, g->index, x, x->number, passed ? RV_PASS : RV_FAIL, RV_BY_PREFIX, t, note);
}

/* Give each slot of the ring an own instant of each clock; false: memory is short. */
bool make_own_instants(rv_monitor *m, const machine *a, queue *q)
{
    int32_t room = 0;
    if (q->own == NULL) {
        q->own = widened(m, NULL, &room, q->room, (size_t)a->clocks * sizeof *q->own);
    }
    return q->own != NULL;
}

/* Double the ring of a queue, which is full; false: memory is short. */
static bool widen_queue(rv_monitor *m, const machine *a, queue *q)
{
    const size_t each = (size_t)a->clocks * sizeof *q->own;
    const int32_t was = q->room;
    int32_t room = was;
    queued *made = widened(m, q->items, &room, (int64_t)was + 1, sizeof *made);
    int64_t *own = q->own;
    if (made == NULL) {
        return false;
    }
    q->items = made;
    if (own != NULL) {
        room = was;
        own = widened(m, own, &room, (int64_t)was + 1, each);
        if (own == NULL) {
            return false;
        }
        q->own = own;
    }
    q->room = room;
    if (q->head > 0) { /* the youngest, in front of the oldest, come behind the others */
        (void)memcpy(&made[was], made, (size_t)q->head * sizeof *made);
        if (own != NULL) {
            (void)memcpy(&own[(size_t)was * (size_t)a->clocks], own, (size_t)q->head * each);
        }
    }
    return true;
}

/* The i-th slot of a queue; with `append` a new one at its end (`i` is the old count). NULL: memory is
 * short. */
queued *queue_slot(rv_monitor *m, const machine *a, queue *q, int32_t i, bool append)
{
    if (append) {
        if ((q->count == q->room) && !widen_queue(m, a, q)) {
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
static const attempt_start *start_at(const queueing *g, int64_t t)
{
    attempt_start *b = &g->q->latest;
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
        b->rests = (k.location <= PASSED) || rests(g->a, &k, t, b->letter, &due, &slides);
        b->due = (due == NEVER) ? NEVER : due - t;
        b->sliding = 0;
        if (slides) {
            (void)step_token(g->a, &k, t + 1, b->letter);
        }
        for (c = 0; slides && (c < g->a->widths[b->location]); c++) {
            b->sliding |= (k.clocks[c] == t + 1) ? ((uint32_t)1 << c) : 0U;
        }
    }
    return b;
}

/* The state in a location all of whose clocks began with the trigger, and some of which each tick resets. */
static void set_started(segment *s, int32_t location, uint32_t sliding)
{
    int32_t c;
    s->location = location;
    s->count = 0;
    for (c = 0; c < QUEUED_CLOCKS; c++) {
        s->clocks[c] = (((sliding >> c) & 1U) != 0U) ? OF_EACH_TICK : OF_TRIGGER;
    }
}

/* Whether an attempt that begins at `t` is in the state of a segment. */
static bool starts_in(const queueing *g, const attempt_start *b, const segment *s, int64_t t)
{
    bool same = s->location == b->location;
    int32_t c;
    for (c = 0; same && (c < g->a->widths[b->location]); c++) {
        const int64_t clock = s->clocks[c];
        same = (((b->sliding >> c) & 1U) != 0U)
                   ? (clock == OF_EACH_TICK)
                   : ((clock == OF_TRIGGER) || (clock == OF_EACH_ATTEMPT) || (clock == t));
    }
    return same;
}

/* The youngest attempt, which began at `t`, joins a segment: it has own instants where others have. */
static void begin_in(const queueing *g, segment *s, int64_t t)
{
    int32_t c;
    for (c = 0; c < g->a->widths[s->location]; c++) {
        if (s->clocks[c] == OF_EACH_ATTEMPT) {
            *own_instant(g, g->q->count - 1, c) = t;
        }
    }
    s->count++;
}

/* Start an attempt at `t`: step it once, report it if that decides it, else append it to the last
 * segment, which holds the youngest attempts, or to a new one. If memory is short, the queue stays as it
 * was. */
void queue_begin(run *r, int32_t index, int64_t t)
{
    const queueing g = queueing_of(r, index);
    const attempt_start *start = start_at(&g, t);
    queue *q = g.q;
    segment *last = (q->now.count > 0) ? &q->now.at[q->now.count - 1] : NULL;
    queued *made = queue_slot(r->home->monitor, g.a, q, q->count, true);
    int64_t due;
    if (made == NULL) {
        return;
    }
    if (r->home->moves != NULL) {
        count_begin(r, index, t);
        count_edge(&g, g.a->initial, start->location, 1, t);
    }
    g.j->count++;
    made->triggered = t;
    made->number = g.j->count;
    made->spare = 0;
    if (runs_on(r, index)) {
        leave_episode(r, index);
        g.j->current = IN_QUEUE;
    }
    if (start->location <= PASSED) {
        segment initial;
        set_started(&initial, g.a->initial, 0);
        if (g.j->current == IN_QUEUE) {
            decide_current(r, index, start->location == FAILED, t);
        }
        report_queued(&g, q->count - 1, &initial, start->location == PASSED, t);
        q->count--;
        return;
    }
    if ((last == NULL) || !starts_in(&g, start, last, t)) {
        last = next_segment(r->home->monitor, &q->now);
        if (last == NULL) {
            q->count--; /* every item belongs to a segment */
            return;
        }
        set_started(last, start->location, start->sliding);
    }
    begin_in(&g, last, t);
    due = sum(t, start->due);
    if (!start->rests) {
        set_restless(r, index);
        due = t + 1;
    }
    set_rule_due(r, index, least(r->rules.due[index], due));
}

/* The next attempt of a judge's queue from a place on, which starts as zeros, oldest first, as it stands at
 * `tick`, in the form of the pool's; NULL: there is none. It is valid until the next call. */
attempt *next_queued(run *r, int32_t index, queue_place *p, int64_t tick)
{
    const queueing g = queueing_of(r, index);
    const queue *q = g.q;
    attempt *x;
    if ((q == NULL) || (p->item == q->count)) {
        return NULL;
    }
    while (p->item == p->end) {
        p->end += q->now.at[p->segments].count;
        p->segments++;
    }
    x = attempt_of_queued(&g, p->item, &q->now.at[p->segments - 1], tick);
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
