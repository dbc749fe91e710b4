/* Outages in sampled time. Where only samples are positions, each tick of an outage may or may not be a
 * position; every formula is unknown there.
 *
 * Past operators take one step for the whole outage, at its first tick. Attempts step at every tick with
 * a completely unknown letter: automata in bulk up to the next timer, a network tick by tick for
 * TICKS_MOST ticks; then it is given up, and its open attempts stay undecided.
 *
 * Source: SEMANTICS 1 (Outage). */
#include "formulas/formulas.h"
#include "input/input.h"
#include "networks/network.h"
#include "runs/runs.h"

#include <string.h>

/* The most ticks of an outage that networks step through one by one, which bounds the cost. */
#define TICKS_MOST 1000

int64_t last_position(const rv_monitor *m)
{
    return (m->dense_end > m->last) ? m->dense_end : m->last;
}

/* Whether a judge has to step through each tick. */
static bool needs_each_tick(const run *r, int32_t index)
{
    return is_networked(r, index) && !r->judges[index].blind
           && (has_attempts(&r->judges[index]) || needs_every_position(r, index));
}

static bool some_need_each_tick(const run *r)
{
    int32_t i;
    for (i = 0; i < r->part->plan->judges.count; i++) {
        if (needs_each_tick(r, i)) {
            return true;
        }
    }
    return false;
}

/* Make all open attempts of networks undecidable. A network that looks back also misses the positions
 * from here on, so its later attempts cannot be decided either. */
static void give_up_networks(run *r)
{
    int32_t i;
    for (i = 0; i < r->part->plan->judges.count; i++) {
        judge *j = &r->judges[i];
        if (needs_each_tick(r, i)) {
            while (j->first >= 0) {
                attempt *x = attempt_at(r->home, j->first);
                x->parted = true;
                x->location = FAILED;
                x->better = PASSED;
                move_to_undecidable(r, i, -1, j->first);
            }
            j->blind = r->part->forms[r->part->judges[i].form].looks_back != 0;
            set_rule_due(r, i, NEVER);
        }
    }
}

/* Enter an outage: `t` is the first tick that may be a position. Everything becomes unknown. */
void run_begin_dense(run *r, int64_t t)
{
    const bool apart = r->part->plan->captured > 0;
    if (apart) {
        forget_last(r);
    }
    r->at.dense = true;
    r->at.dense_from = t;
    r->at.before = r->at.started ? r->at.position : t;
    if (!r->at.started) {
        r->at.started = true;
        r->at.origin = t;
        r->at.sure_from = NEVER;
    }
    r->at.presence = ARE_THERE;
    r->opening = false;
    margins_miss(r, t);
    remember_unknown(r, t);
    blank_out(r, t);
    r->at.position = t;
    touch_all(r, TOUCHED_LETTER | TOUCHED_TRIGGER);
    run_judges(r, t);
    if (apart) {
        check_children(r, t);
    }
}

/* The next tick to visit: the next one that may matter, or `limit`. The second tick of an outage is
 * always visited, as attempts in doubt may differ there; a failed episode may continue at any tick. */
static int64_t next_tick(const run *r, int64_t limit)
{
    const int64_t next = r->at.position + 1;
    const int64_t due = timers_next(&r->rules);
    if ((r->at.position == r->at.dense_from) || (r->failing_count > 0) || some_need_each_tick(r)) {
        return next; /* attempts in doubt; restarts; networks */
    }
    return (due < limit) ? ((due > next) ? due : next) : limit;
}

/* Take a run through the ticks up to `limit`. */
void run_pass_dense(run *r, int64_t limit)
{
    const int32_t judges = r->part->plan->judges.count;
    int32_t i;
    while ((r->at.position < limit) && !r->home->monitor->spoilt) {
        const bool second = r->at.position == r->at.dense_from;
        int64_t next;
        if ((r->at.position - r->at.dense_from >= TICKS_MOST) && some_need_each_tick(r)) {
            give_up_networks(r);
        }
        next = next_tick(r, limit);
        if (second) { /* from the second tick on a trigger may have been hidden before */
            r->at.before = r->at.position;
            blank_out(r, next);
            touch_all(r, TOUCHED_LETTER | TOUCHED_TRIGGER);
        }
        for (i = 0; !second && (i < judges); i++) {
            if (!is_networked(r, i)) {
                pass_ticks(r, i, next);
            } else if (needs_each_tick(r, i)) {
                touch(r, i, TOUCHED_LETTER);
            } else {
                /* A network without open attempts. */
            }
        }
        r->at.before = next - 1;
        r->at.position = next;
        run_judges(r, next);
        if (second && (r->part->plan->captured > 0)) {
            check_children(r, next);
        }
    }
}

/* Leave the outage: after `until` only samples are positions, and the first sample evaluates
 * everything. */
void run_end_dense(run *r, int64_t until)
{
    run_pass_dense(r, until);
    r->at.dense = false;
    r->at.presence = ARE_THERE_NEXT;
    r->at.alarm = -LIMIT;
}

/* Take updates during the outage: values are held, but the tick may not be a position, so occurrences
 * are forgotten at once. */
void run_take_amid(run *r, int64_t t, const incoming *in, int32_t count)
{
    int32_t i;
    for (i = 0; i < count; i++) {
        take_update(r, t, &in[i]);
    }
    r->at.gathered = false;
    r->over = false;
    forget(r);
}

/* Call `act` for every run of a part, then end the call in the part. */
static void for_all(home *h, int64_t t, void (*act)(run *r, int64_t t))
{
    run *one;
    for (one = h->root; one != NULL; one = following(h, one)) {
        touch_run(one);
        act(one, t);
    }
    if (h->part->plan->captured > 0) {
        rest_all(h);
    } else {
        untouch_all(h);
        h->alarm = h->root->at.alarm;
    }
}

/* Store a marker (SAYS_DENSE, SAYS_SPARSE) between the stored samples, for replay. */
static void keep_marker(home *h, int64_t t, int32_t says)
{
    if ((h->part->plan->flags & PART_KEEPS_PAST) != 0) {
        const int32_t count = h->past_count;
        h->inbox_count = 0;
        keep_given(h, t);
        if (h->past_count > count) {
            h->past[count].says = says;
        }
    }
}

static void begin_one(run *r, int64_t t)
{
    if (!r->at.dense) {
        run_begin_dense(r, t);
    }
}

/* Make the array of unknown values that captures read in an outage; false: memory is short. */
bool make_unknown_values(home *h)
{
    if (h->unknown_values == NULL) {
        h->unknown_values = arena_take(&h->monitor->memory,
                                (size_t)(h->part->plan->signals.count + 1) * sizeof *h->unknown_values);
    }
    return h->unknown_values != NULL;
}

/* Start an outage at `t` in every part. The last position before it is that of the last sample of any
 * part; an event that opens instances may have occurred with any key. */
bool begin_dense(rv_monitor *m, int64_t t)
{
    int32_t i;
    for (i = 0; i < m->plan.part_count; i++) {
        home *h = &m->homes[i];
        run *one;
        if (!make_unknown_values(h)) {
            m->spoilt = true;
            return false;
        }
        for (one = h->root; one != NULL; one = following(h, one)) {
            if (one->at.started) {
                one->at.position = last_position(m);
            }
        }
        if (h->part->plan->each != 0) {
            h->previous = last_position(m);
            open_unknown(h, t);
        }
        keep_marker(h, t, SAYS_DENSE);
        for_all(h, t, begin_one);
    }
    m->dense_until = NEVER;
    return !m->spoilt;
}

/* Take all runs through the ticks up to `limit`, and out of the outage if it ends by then. */
void pass_dense(rv_monitor *m, int64_t limit)
{
    int32_t i;
    if (limit >= m->dense_until) {
        end_dense(m);
        return;
    }
    for (i = 0; i < m->plan.part_count; i++) {
        for_all(&m->homes[i], limit, run_pass_dense);
    }
}

void end_dense(rv_monitor *m)
{
    int32_t i;
    for (i = 0; i < m->plan.part_count; i++) {
        for_all(&m->homes[i], m->dense_until, run_end_dense);
        keep_marker(&m->homes[i], m->dense_until, SAYS_SPARSE);
    }
    m->dense_end = m->dense_until;
    m->dense_until = RV_NO_TIME;
}

/* Whether `t` lies in the outage; an instant after its end ends the outage. */
bool is_amid_dense(rv_monitor *m, int64_t t)
{
    if (t > m->dense_until) {
        end_dense(m);
        return false;
    }
    return true;
}

void home_take_amid(home *h, int64_t t)
{
    run *one;
    keep_given(h, t);
    for (one = h->root; one != NULL; one = following(h, one)) {
        run_take_amid(one, t, h->inbox, h->inbox_count);
        one->at.after = t;
    }
    h->inbox_count = 0;
}
