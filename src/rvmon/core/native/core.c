/* The life of a monitor: made, fed samples, advanced, finished, reset. core.h documents the
 * functions.
 *
 * A sample goes to every part that reads one of its names or has something due. There, time first
 * passes up to the tick before (approach), so that decisions by time alone come first; then updates are
 * taken (take_update), and the position is judged (arrive). */
#include "input/input.h"
#include "notes/notes.h"
#include "results/results.h"
#include "runs/runs.h"

#include <string.h>

static bool prepare_part(rv_monitor *m, part *p)
{
    int32_t i;
    p->timed = arena_take(&m->memory, (size_t)(p->plan->timers + 1) * sizeof *p->timed);
    p->perishable = arena_take(&m->memory, (size_t)(p->plan->perishable + 1) * sizeof *p->perishable);
    p->machines = arena_take(&m->memory, (size_t)p->plan->judges.count * sizeof *p->machines);
    p->networked = arena_take(&m->memory, (size_t)p->plan->judges.count * sizeof *p->networked);
    if ((p->networked == NULL) || (p->timed == NULL) || (p->perishable == NULL) || (p->machines == NULL)) {
        return false;
    }
    for (i = 0; i < p->plan->nodes.count; i++) {
        if (p->nodes[i].timer >= 0) {
            p->timed[p->nodes[i].timer] = i;
        }
    }
    for (i = 0; i < p->plan->signals.count; i++) {
        if (p->signals[i].perishable >= 0) {
            p->perishable[p->signals[i].perishable] = i;
        }
    }
    if (!find_quick(&m->memory, &m->plan, p) || !find_pulses(&m->memory, &m->plan, p)) {
        return false;
    }
    p->is_watched = (p->plan->truths >= 0) || (p->plan->watches.count > 0);
    for (i = 0; i < p->plan->judges.count; i++) {
        p->has_episodes = p->has_episodes || ((p->judges[i].flags & JUDGE_EPISODIC) != 0);
        p->is_traced = p->is_traced || ((p->judges[i].flags & JUDGE_TRACED) != 0);
        p->restarts = p->restarts || (p->judges[i].again >= 0);
        if ((p->judges[i].automaton < 0) && (p->forms[p->judges[i].form].windows.count == 0)) {
            p->networked[p->networked_count] = i;
            p->networked_count++;
        }
        if (p->judges[i].automaton >= 0) {
            p->machines[i] = machine_view(&m->plan, &m->plan.automata[p->judges[i].automaton]);
        }
    }
    return true;
}

/* Allocate what lives as long as the monitor. Sizes are one larger, as the plan may declare none. */
static bool prepare(rv_monitor *m)
{
    const plan *p = &m->plan;
    const int32_t names = p->header->signals + p->header->events;
    int32_t i;
    m->parts = arena_take(&m->memory, (size_t)(p->part_count + 1) * sizeof *m->parts);
    m->homes = arena_take(&m->memory, (size_t)(p->part_count + 1) * sizeof *m->homes);
    m->absent = arena_take(&m->memory, (size_t)names + 1);
    m->losing = arena_take(&m->memory, (size_t)names + 1);
    m->late = arena_take(&m->memory, (size_t)p->header->requirements + 1);
    m->stale = arena_take(&m->memory, (size_t)(p->header->signals + 1) * sizeof *m->stale);
    if ((m->parts == NULL) || (m->homes == NULL) || (m->absent == NULL) || (m->losing == NULL)
        || (m->late == NULL) || (m->stale == NULL)) {
        return false;
    }
    for (i = 0; i < p->part_count; i++) {
        part *one = &m->parts[i];
        one->plan = &p->parts[i];
        one->signals = &p->signals[one->plan->signals.first];
        one->events = &p->events[one->plan->events.first];
        one->atoms = &p->atoms[one->plan->atoms.first];
        one->nodes = &p->nodes[one->plan->nodes.first];
        one->judges = &p->judges[one->plan->judges.first];
        one->forms = &p->forms[one->plan->forms.first];
        one->watches = &p->watches[one->plan->watches.first];
        one->groups = &p->groups[one->plan->groups.first];
        m->homes[i].monitor = m;
        m->homes[i].part = one;
        m->homes[i].alarms.next = NEVER;
        if (!prepare_part(m, one)) {
            return false;
        }
    }
    m->is_alone = (p->part_count == 1) && (p->parts[0].captured == 0);
    return margins_prepare(m);
}

/* Reset everything that belongs to a run. Absent names are declared again, as home_begin forgets
 * them. */
static bool begin_run(rv_monitor *m)
{
    const plan *p = &m->plan;
    const int32_t names = p->header->signals + p->header->events;
    int32_t i;
    m->record_count = 0;
    m->captured_count = 0;
    m->undecidable_count = 0;
    forget_notes(m, 0, 0);
    m->sorted = 0;
    m->began = RV_NO_TIME;
    m->last = RV_NO_TIME;
    m->after = -LIMIT;
    m->reached = RV_NO_TIME;
    m->outage_at = RV_NO_TIME;
    m->losing_count = 0;
    m->dense_until = RV_NO_TIME;
    m->dense_end = RV_NO_TIME;
    (void)memset(m->losing, 0, (size_t)names + 1);
    (void)memset(m->late, 0, (size_t)p->header->requirements + 1);
    (void)memset(m->stale, 0, (size_t)(p->header->signals + 1) * sizeof *m->stale);
    m->finished = false;
    m->spoilt = false;
    margins_reset(m);
    for (i = 0; i < p->part_count; i++) {
        if (!home_begin(&m->homes[i])) {
            m->spoilt = true;
            return false;
        }
    }
    for (i = 0; i < names; i++) {
        if (m->absent[i] != 0U) {
            m->absent[i] = 0;
            rv_set_absent(m, i);
        }
    }
    return true;
}

rv_monitor *rv_new(const void *bytes, size_t size, rv_memory memory)
{
    arena a;
    rv_monitor *m;
    if (rv_plan_check(bytes, size) >= 0) {
        return NULL;
    }
    (void)memset(&a, 0, sizeof a);
    a.from = memory;
    if (memory.block != NULL) {
        const size_t off = (size_t)(16U - (uintptr_t)memory.block % 16U) % 16U;
        a.free = (char *)memory.block + off;
        a.left = (memory.size > off) ? memory.size - off : 0;
        a.from.allocate = NULL;
    }
    m = arena_take(&a, sizeof *m);
    if (m == NULL) {
        arena_release(&a);
        return NULL;
    }
    arena_move(&m->memory, &a);
    (void)plan_view(&m->plan, bytes, size);
    if (!prepare(m) || !begin_run(m)) {
        rv_free(m);
        return NULL;
    }
    return m;
}

void rv_free(rv_monitor *m)
{
    if (m != NULL) {
        arena a = m->memory; /* a copy, as the arena is part of the memory that it frees */
        arena_release(&a);
    }
}

int rv_reserve(rv_monitor *m, int32_t attempts)
{
    bool done = (attempts <= 0) || grow_records(m, attempts);
    int32_t i;
    for (i = 0; (attempts > 0) && done && (i < m->plan.part_count); i++) {
        done = (m->homes[i].part->plan->judges.count == 0) || home_reserve(&m->homes[i], attempts);
    }
    return done ? RV_OK : RV_NO_MEMORY;
}

size_t rv_memory_used(const rv_monitor *m)
{
    return m->memory.used;
}

int rv_reset(rv_monitor *m)
{
    return begin_run(m) ? RV_OK : RV_NO_MEMORY;
}

const subscription *subscriptions_of(const rv_monitor *m, int32_t name, int32_t *count)
{
    const int32_t first = m->plan.subscription_first[name];
    *count = m->plan.subscription_first[name + 1] - first;
    return &m->plan.subscriptions[first];
}

void rv_set_absent(rv_monitor *m, int32_t name)
{
    const bool event = name >= m->plan.header->signals;
    int32_t count;
    const subscription *s = subscriptions_of(m, name, &count);
    int32_t i;
    if (m->absent[name] == 0U) {
        m->absent[name] = 1;
        for (i = 0; i < count; i++) {
            home_mark_absent(&m->homes[s[i].part], event, s[i].local);
        }
    }
}

static bool is_in_range(int64_t t)
{
    return (t > -LIMIT) && (t < LIMIT);
}

/* Append updates to the inboxes of the parts that read them; false: memory is short. */
bool distribute(rv_monitor *m, const rv_update *updates, int32_t count)
{
    int32_t i;
    int32_t k;
    for (i = 0; i < count; i++) {
        const bool event = updates[i].name >= m->plan.header->signals;
        int32_t readers;
        const subscription *s = subscriptions_of(m, updates[i].name, &readers);
        for (k = 0; k < readers; k++) {
            home *h = &m->homes[s[k].part];
            if (h->inbox_count == h->inbox_room) {
                incoming *made = enlarged(m, h->inbox, &h->inbox_room, (int64_t)h->inbox_count + 1,
                                       sizeof *made);
                if (made == NULL) {
                    return false;
                }
                h->inbox = made;
            }
            h->inbox[h->inbox_count].local = s[k].local;
            h->inbox[h->inbox_count].event = event;
            h->inbox[h->inbox_count].update = &updates[i];
            h->inbox_count++;
        }
    }
    return true;
}

/* A sample for a plan with one part without captured values, the common case: no inbox is filled. */
static void step_alone(rv_monitor *m, int64_t t, const rv_update *updates, int32_t count)
{
    run *r = m->homes[0].root;
    const int32_t *read_first = m->plan.subscription_first;
    const int32_t signals = m->plan.header->signals;
    const quick_signal *quick;
    int32_t i;
    if ((m->plan.header->gap == 0) && r->at.started) {
        r->at.position = last_position(m);
    }
    approach(r, t);
    quick = quick_now(r);
    for (i = 0; i < count; i++) {
        const int32_t name = updates[i].name;
        const int32_t first = read_first[name];
        if (first < read_first[name + 1]) {
            incoming in;
            in.local = m->plan.subscriptions[first].local;
            in.event = name >= signals;
            if (in.event || (quick == NULL) || !take_quickly(r, quick, in.local, &updates[i])) {
                in.update = &updates[i];
                take_update(r, t, &in);
            }
        }
    }
    arrive(r, t);
}

/* A sample for a plan with several parts. A part that reads none of its names and has nothing due is
 * skipped, unless every sample matters to it. */
static bool step_parts(rv_monitor *m, int64_t t, const rv_update *updates, int32_t count)
{
    int32_t i;
    if (!distribute(m, updates, count)) {
        return false;
    }
    for (i = 0; i < m->plan.part_count; i++) {
        home *h = &m->homes[i];
        if ((h->inbox_count > 0) || (h->alarm <= t) || !h->root->at.started || (m->shapes != NULL)
            || (h->root->at.presence != ARE_THERE)
            || ((h->part->plan->flags & PART_KEEPS_PAST) != 0)) {
            h->previous = last_position(m);
            home_sample(h, t);
        }
    }
    return true;
}

/* Report the margins settled by `t`; if rows are judged in bulk, only at the end of the block. */
void settle_margins(rv_monitor *m, int64_t t)
{
    int32_t i;
    for (i = 0; (m->shapes != NULL) && !m->defers_margins && (i < m->plan.part_count); i++) {
        margins_settle(&m->homes[i], t);
    }
}

/* The code with which a call at `t` is refused; RV_OK if it is not. */
static inline int refusal(const rv_monitor *m, int64_t t)
{
    if (m->finished) {
        return RV_FINISHED;
    }
    if (m->spoilt) {
        return RV_NO_MEMORY;
    }
    return is_in_range(t) ? RV_OK : RV_OUT_OF_RANGE;
}

int rv_step(rv_monitor *m, int64_t t, const rv_update *updates, int32_t count)
{
    int32_t i;
    const int refused = refusal(m, t);
    if (refused != RV_OK) {
        return refused;
    }
    if (t <= m->after) {
        return RV_TOO_EARLY;
    }
    if ((m->dense_until != RV_NO_TIME) && is_amid_dense(m, t)) {
        if (!distribute(m, updates, count)) {
            return RV_NO_MEMORY;
        }
        for (i = 0; i < m->plan.part_count; i++) {
            home_take_amid(&m->homes[i], t);
        }
    } else if (m->is_alone) {
        step_alone(m, t, updates, count);
    } else if (!step_parts(m, t, updates, count)) {
        return RV_NO_MEMORY;
    } else {
        /* All parts have taken it. */
    }
    if (m->last == RV_NO_TIME) {
        m->began = t;
    }
    m->last = t;
    m->after = t;
    m->reached = t;
    if (m->shapes != NULL) {
        settle_margins(m, t);
    }
    if (m->record_count > m->sorted) {
        sort_records(m);
    }
    return m->spoilt ? RV_NO_MEMORY : RV_OK;
}

int rv_advance(rv_monitor *m, int64_t t)
{
    int32_t i;
    const int refused = refusal(m, t);
    if (refused != RV_OK) {
        return refused;
    }
    if (t > m->reached) {
        if (m->dense_until != RV_NO_TIME) {
            pass_dense(m, t - 1);
        }
        for (i = 0; i < m->plan.part_count; i++) {
            home_wait(&m->homes[i], t);
        }
        m->reached = t;
        if (t - 1 > m->after) {
            m->after = t - 1;
        }
        settle_margins(m, t);
        sort_records(m);
    }
    return m->spoilt ? RV_NO_MEMORY : RV_OK;
}

int rv_finish(rv_monitor *m, int64_t t)
{
    const int64_t end = rv_end(m, t);
    int32_t i;
    if (m->finished) {
        return RV_FINISHED;
    }
    if ((t != RV_NO_TIME) && !is_in_range(t)) {
        return RV_OUT_OF_RANGE;
    }
    if ((m->dense_until != RV_NO_TIME) && !m->spoilt) {
        m->dense_until = least(m->dense_until, end);
        end_dense(m);
    }
    m->finished = true;
    if ((end != RV_NO_TIME) && !m->spoilt) {
        const int64_t reached = (m->reached > end) ? m->reached : end + 1;
        for (i = 0; i < m->plan.part_count; i++) {
            home_close(&m->homes[i], end, reached);
        }
        sort_records(m);
    }
    return m->spoilt ? RV_NO_MEMORY : RV_OK;
}
