/* The clock of a run: which instants are positions that have to be visited, and the order of work there.
 * Between samples nothing is evaluated unless a timer is due (`wake` for nodes, `rules` for judges), an
 * atom was valid at one position only, or an episode restarts; `alarm` is the next such instant. So the
 * cost of passing time depends on what happens in it, not on its length. */
#include "formulas/formulas.h"
#include "input/input.h"
#include "notes/notes.h"
#include "results/results.h"
#include "runs/runs.h"
#include "windows/windows.h"

#include <string.h>

/* Fire the timers of nodes and of signals that go stale, up to `t`. */
static void fire_timers(run *r, int64_t t)
{
    const int32_t nodes = r->part->plan->timers;
    while (timers_next(&r->wake) <= t) {
        const int32_t id = r->wake.ids[0];
        const int64_t due = r->wake.due[id];
        timers_set(&r->wake, id, NEVER);
        if (id < nodes) {
            mark_dirty(r, r->part->timed[id]);
        } else {
            go_stale(r, due, id - nodes);
        }
    }
}

/* The node by which this run starts attempts of a judge or ends its episodes; -1: neither happens here.
 * With captured values attempts start in one run and are judged in another. */
int32_t trigger_node(const run *r, int32_t index)
{
    const judge_plan *j = &r->part->judges[index];
    if (r->part->plan->captured == 0) {
        return j->trigger;
    }
    if (starts_here(r, index)) {
        return (r->opens_at < NEVER) ? j->trigger : -1;
    }
    return (((r->judging >> index) & 1) != 0) ? j->running : -1;
}

void touch_all(run *r, uint8_t what)
{
    int32_t i;
    call_watches(r);
    for (i = 0; i < r->part->plan->judges.count; i++) {
        touch(r, i, what);
    }
}

/* Register the judges that have to look at the position at `t` even if no node changes there: those with
 * repeating pulses, with attempts that move at every position, or with a due timer. */
static void touch_due_judges(run *r, int64_t t)
{
    int32_t kept = 0;
    int32_t i;
    int32_t count;
    for (i = 0; i < r->repeating_count; i++) {
        touch(r, r->repeating[i], TOUCHED_TRIGGER);
    }
    for (i = 0; i < r->restless_count; i++) {
        const int32_t index = r->restless[i];
        if (r->judges[index].restless) {
            touch(r, index, TOUCHED_LETTER);
            r->restless[kept] = index;
            kept++;
        } else {
            r->judges[index].is_restless_listed = false;
        }
    }
    r->restless_count = kept;
    if (timers_next(&r->rules) <= t) {
        count = timers_due(&r->rules, t, r->due_rules);
        for (i = 0; i < count; i++) {
            touch(r, r->due_rules[i], TOUCHED_LETTER);
        }
    }
}

/* The first position: everything is evaluated. */
static void start(run *r, int64_t t)
{
    r->at.started = true;
    r->at.starting = IS_TRUE;
    r->at.origin = t;
    r->at.sure_from = t;
    recheck_all(r);
}

void recheck_all(run *r)
{
    int32_t i;
    for (i = 0; i < r->part->plan->atoms.count; i++) {
        (void)recheck(r, i);
    }
    mark_all_dirty(r);
    touch_all(r, TOUCHED_LETTER | TOUCHED_TRIGGER);
}

/* Run the judges that were touched, in phases over all of them. Episodes take the truth of their trigger
 * before attempts move, since it ends the obligation from this very position on. New attempts start after
 * existing ones have moved, so that each attempt sees each position once. An episode that fails here
 * restarts at the next position at the earliest. */
void run_judges(run *r, int64_t t)
{
    int32_t i;
    r->repeating_count = 0; /* the starts below list each judge again, at most once */
    if (r->part->is_watched) {
        watch(r, t);
    }
    for (i = 0; r->part->has_episodes && (i < r->touched_count); i++) {
        const int32_t index = r->touched[i];
        if (((r->judges[index].touched & TOUCHED_TRIGGER) != 0) && runs_on(r, index)) {
            take_episode_trigger(r, index, t);
        }
    }
    for (i = 0; i < r->touched_count; i++) {
        const int32_t index = r->touched[i];
        if (((r->judges[index].touched & TOUCHED_LETTER) != 0)
            && (has_attempts(&r->judges[index]) || needs_every_position(r, index))) {
            visit_judge(r, index, t);
        }
    }
    if (r->at.presence == ARE_THERE_NEXT) {
        resume_episodes(r, t);
    }
    for (i = 0; i < r->touched_count; i++) {
        const int32_t index = r->touched[i];
        if ((r->judges[index].touched & TOUCHED_TRIGGER) != 0) {
            const int32_t trigger = trigger_node(r, index);
            if ((trigger >= 0) && take_trigger(r, index, r->truth[trigger])) {
                begin(r, index, t, t);
            }
        }
        r->judges[index].touched = 0;
    }
    r->touched_count = 0;
    if (r->failing_count > 0) {
        for (i = 0; i < r->failing_count; i++) {
            const int32_t index = r->failing[i];
            if (may_go_on(r, index) && (r->judges[index].failed_at < t)
                && !passes_repeats_over(r, index, t)) {
                begin_here(r, index, t, t);
            }
        }
        tidy_failing(r);
    }
}

/* Visit the position at `t`: the steps are in the order that runs.h describes. */
void visit(run *r, int64_t t)
{
    const bool apart = r->part->plan->captured > 0;
    const int64_t gap = GAP(r);
    if (apart) {
        forget_last(r);
    }
    r->at.before = (gap > 0) ? t - gap : r->at.position;
    if (r->at.presence == MAY_BE_THERE) {
        begin_blank(r, t);
        return;
    }
    if (r->at.presence == ARE_THERE_NEXT) {
        end_blank(r, t);
    } else if (!r->at.started) {
        start(r, t);
    } else {
        r->at.starting = IS_FALSE;
        if (gap == 0) {
            const int32_t *nodes = LIST(PLAN(r), r->part->plan->stateful);
            int32_t i;
            for (i = 0; i < r->part->plan->stateful.count; i++) {
                mark_dirty(r, nodes[i]);
            }
        }
    }
    if (t >= r->cut) {
        mark_lapsed(r);
    }
    if (t >= r->at.ends_at) {
        end_outages(r, t);
    }
    fire_timers(r, t); /* first, as atoms of a stale signal may become momentary */
    if (r->at.fading_count + r->at.fresh_count > 0) {
        recheck_fading(r);
    }
    if (r->opening && (t >= r->opens_at)) {
        r->opening = false;
        if (!is_opening_lost(r, t)) {
            touch_all(r, TOUCHED_TRIGGER);
        }
    }
    touch_due_judges(r, t);
    work_out(r, t);
    if ((r->truth_log != NULL) && (r->at.starting == IS_TRUE)) {
        reset_truth_log(r, t);
    }
    r->at.position = t;
    r->at.awaited = NEVER;
    run_judges(r, t);
    if (r->margins != NULL) {
        margins_visit(r, t); /* before occurrences are forgotten */
    }
    if (r->at.phase == 0) {
        settle_phase(r);
    }
    if (apart) {
        r->over = r->over || r->at.gathered; /* captures may read them until the next position */
        r->at.gathered = false;
        check_children(r, t);
    } else if (r->at.gathered) {
        r->at.gathered = false;
        forget(r);
    } else {
        /* Nothing occurred. */
    }
}

/* Let time come to `t` although it is not known whether `t` is a position, or with which letter: only
 * what time alone decides is decided. */
void reach(run *r, int64_t t)
{
    if (timers_next(&r->rules) <= t) {
        const int32_t count = timers_due(&r->rules, t, r->due_rules);
        int32_t i;
        for (i = 0; i < count; i++) {
            reach_judge(r, r->due_rules[i], t);
        }
    }
}

/* Let time pass up to `limit`, visiting the positions on the way at which something can change. If a
 * sample `comes` after it, networks may leave decisions to that visit. With restarts it stops at each due
 * judge, as a new attempt may follow a failure at once. */
void pass_time(run *r, int64_t limit, bool comes)
{
    const int32_t *index = r->part->networked;
    const int32_t networked = r->part->networked_count;
    const int64_t gap = GAP(r);
    const bool restarts = r->part->restarts && (gap > 0);
    int64_t position;
    int32_t i;
    if (r->part->plan->captured == 0) {
        begin_silence(r->home, r->at.position, limit);
    }
    if ((r->at.fading_count > 0) && (r->at.position + gap <= limit)) {
        end_pulses(r);
    }
    for (;;) {
        int64_t until;
        int64_t stop;
        position = next_position(r);
        until = least(position - 1, limit);
        for (i = 0; (i < networked) && (gap <= 1) && (comes || (position <= limit)); i++) {
            network_put_off(r, index[i], until);
        }
        for (i = 0; (i < networked) && restarts; i++) {
            network_foresee(r, index[i], until);
        }
        stop = restarts ? least(until, timers_next(&r->rules)) : until;
        if (timers_next(&r->rules) <= stop) {
            const int32_t count = timers_due(&r->rules, stop, r->due_rules);
            for (i = 0; i < count; i++) {
                pass_to(r, r->due_rules[i], stop);
            }
        }
        if ((stop < until) || ((r->failing_count > 0) && (next_start(r) < position))) {
            continue;
        }
        if (position > limit) {
            break;
        }
        visit(r, position);
    }
    if (r->part->plan->captured == 0) {
        end_silence(r->home);
    }
    set_alarm(r, position);
}

/* Let time pass up to the tick before a sample at `t`. */
void approach(run *r, int64_t t)
{
    if (t > r->at.alarm) {
        pass_time(r, t - 1, true);
    }
}

/* Judge the instant of a sample whose updates were taken. With a clock (gap above 1) the sample is seen
 * at the next tick, which is `t` itself if `t` is a tick; until then time alone decides. */
void arrive(run *r, int64_t t)
{
    const int64_t gap = GAP(r);
    const bool dirty = r->at.dirty || has_dirty_nodes(r) || (r->at.presence != ARE_THERE)
                       || ((r->margins != NULL) && ((gap > 1) || !r->at.started));
    if (r->at.presence == MAY_BE_THERE) {
        r->at.presence = r->at.started ? ARE_THERE_NEXT : ARE_THERE;
    }
    r->at.dirty = false;
    r->at.after = t;
    if (dirty || (t >= r->at.alarm)) {
        if (gap > 1) {
            r->at.awaited = tick_from(gap, t);
            if (r->at.awaited == t) {
                visit(r, t);
            } else {
                reach(r, t);
            }
        } else {
            visit(r, t);
        }
        set_alarm(r, next_position(r));
    } else if (r->margins != NULL) {
        margins_visit(r, t); /* a distance may change although no truth does */
    } else if ((r->at.fresh_count > 0) && (gap == 1)) { /* else they wait for their tick */
        start_pulses(r, t);
    } else {
        /* Nothing changed and nothing is due. */
    }
    if (gap == 0) {
        r->at.position = t;
    }
}

/* Settle every undecided attempt by the policy of its requirement. */
void settle_all(run *r, int64_t end, int64_t reached)
{
    int32_t i;
    int32_t at;
    for (i = 0; i < r->part->plan->judges.count; i++) {
        if (is_networked(r, i) && !is_chained(r, i)) {
            network_close(r, i, end, reached);
        }
        if (r->truth_log != NULL) {
            note_open_count(r, i);
        }
        if ((r->judges[i].current == IN_QUEUE) && is_true(r, r->part->judges[i].unborn)) {
            dissolve_queue(r, i, r->judges[i].position);
        }
        if (!queue_is_empty(&r->judges[i])) {
            queue_close(r, i, end, reached);
        }
        for (at = next_open(r, i, -1); at >= 0; at = next_open(r, i, at)) {
            settle_attempt(r, i, at, end, reached);
        }
    }
}

/* The next instant at which something is decided if no sample comes. Networks search for theirs. */
int64_t next_decision(run *r)
{
    int32_t i;
    for (i = 0; i < r->part->networked_count; i++) {
        network_foresee(r, r->part->networked[i], LIMIT - 1);
    }
    return least(next_position(r), timers_next(&r->rules));
}

/* Whether the trigger of a judge was ever known to be true or false. */
bool was_heard(const run *r, int32_t index)
{
    const int32_t determined = r->part->judges[index].determined;
    return r->at.started && ((determined < 0) || is_true(r, determined));
}
