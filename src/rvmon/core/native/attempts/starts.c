/* Starting attempts: when the truth of a trigger starts one, and how its judge takes it in.
 *
 * Called at a position after its formulas are evaluated and before the run moves on. Costs one slot of
 * the pool per attempt, or 16 bytes in a queue (queue.c). */
#include "attempts/attempts.h"
#include "margins/margins.h"
#include "notes/notes.h"
#include "runs/runs.h"
#include "windows/windows.h"

#include <string.h>

/* Whether a judge reads every letter even while it has no open attempt: a network with past operators,
 * whose later attempts depend on positions before them. */
bool needs_every_position(const run *r, int32_t index)
{
    const judge_plan *judged = &r->part->judges[index];
    if ((judged->automaton >= 0) || (judged->form < 0)
        || (r->part->forms[judged->form].looks_back == 0)) {
        return false;
    }
    return (r->part->plan->captured == 0) || (((r->judging >> index) & 1) != 0);
}

/* Feed a judge the truth of its trigger at this position; returns whether an attempt starts.
 *
 * A level starts one at its edge from FALSE to TRUE, a pulse at each position where it is TRUE, an
 * episode where its trigger stops being FALSE. The judge of attempts in doubt (HIDDEN) starts one where
 * its DOUBT node becomes UNKNOWN. */
bool take_trigger(run *r, int32_t index, uint8_t truth)
{
    const judge_plan *judged = &r->part->judges[index];
    const bool pulse = (judged->flags & JUDGE_PULSE) != 0;
    judge *j = &r->judges[index];
    bool start = (truth == IS_TRUE) && (pulse || (j->before == IS_FALSE));
    if ((r->part->plan->captured > 0) && !starts_here(r, index) && !j->running) {
        return false; /* this run exists for one attempt, which is over */
    }
    j->before = truth;
    if ((judged->flags & JUDGE_EPISODIC) != 0) {
        start = !j->running
                && (((judged->flags & JUDGE_HIDDEN) != 0) ? (truth == IS_UNKNOWN)
                                                        : (truth != IS_FALSE));
        j->running = start || (j->running && (truth != IS_FALSE));
    } else if (pulse && (truth == IS_TRUE)) {
        /* Nothing changes where a pulse stays TRUE, so it has to be listed to be looked at again. */
        r->repeating[r->repeating_count] = index;
        r->repeating_count++;
    } else {
        /* A level: the next edge changes its node. */
    }
    return start;
}

/* Judge an attempt at `t`, its first position; false: it is decided. */
static bool remains(run *r, int32_t index, int32_t at, int64_t t)
{
    if (is_chained(r, index)) {
        return chain_enter(r, index, at, t);
    }
    if (is_networked(r, index)) {
        return network_enter(r, index, at, t);
    }
    return drive_from(r, index, at, t);
}

/* Take a judge to the position at `t`, where an attempt begins. One that rests has nothing to read there,
 * one without attempts has not followed the letters. */
static void follow(run *r, int32_t index, int64_t t)
{
    judge *j = &r->judges[index];
    if (!has_attempts(j)) {
        visit_judge(r, index, t);
    } else if (j->position < t) {
        if (((j->touched & TOUCHED_LETTER) != 0) || (GAP(r) == 0) || (r->rules.due[index] <= t)
            || j->restless || j->slides || (is_networked(r, index) && !is_chained(r, index))) {
            visit_judge(r, index, t);
        } else {
            j->position = t;
        }
    } else {
        /* It has been there. */
    }
}

/* Start an attempt that this run judges, at the position at `t`. `triggered` is earlier than `t` if the
 * attempt was triggered in a parent run (captured values). */
void begin_here(run *r, int32_t index, int64_t t, int64_t triggered)
{
    const judge_plan *judged = &r->part->judges[index];
    judge *j = &r->judges[index];
    const bool judged_here = (r->at.presence == ARE_THERE) && !j->blind;
    attempt *x;
    int32_t at;
    if (judged_here) {
        follow(r, index, t);
    }
    if (r->truth_log != NULL) {
        note_trigger(r, index, triggered);
    }
    if (judged_here && (j->first < 0) && (j->letter == j->other)
        && (!runs_on(r, index) || is_sure(r, index)) && ((j->queue != NULL) || has_queue(r, index))) {
        if (r->margins != NULL) {
            margins_begin(r, index, t, measured_attempt(r, triggered, j->count + 1U));
        }
        queue_begin(r, index, t);
        return;
    }
    at = new_attempt(r);
    if (at < 0) {
        leave_episode(r, index); /* memory is short: do not try again at each position */
        return;
    }
    x = attempt_at(r->home, at);
    (void)memset(x, 0, r->home->stride);
    x->triggered = triggered;
    x->next = -1;
    x->location = WAITING;
    x->doubted_at = RV_NO_TIME;
    if (judged->automaton >= 0) {
        x->location = r->part->machines[index].initial;
    }
    x->sure = is_sure(r, index);
    x->trigger_unknown = !x->sure;
    if (r->part->plan->captured > 0) {
        (void)memset(&r->home->captured_attempts[at], 0, sizeof *r->home->captured_attempts);
        r->home->captured_attempts[at].judge = r;
        x->cannot_pass = r->cut < NEVER;
        j->running = (judged->flags & JUDGE_EPISODIC) != 0;
    }
    x->record = measured_attempt(r, triggered, 0);
    number_attempt(r, index, at, triggered);
    if (r->truth_log != NULL) {
        note_begin(r, index, x, t);
    }
    margins_begin(r, index, t, x->record);
    if (runs_on(r, index)) {
        leave_episode(r, index);
        j->current = at;
    }
    if (!judged_here) {
        x->cannot_pass = true; /* the letter here is lost, so its obligation stays unknown */
        x->parted = true;
        x->location = FAILED;
        x->better = PASSED;
        add_undecidable(r, index, at);
    } else {
        enter(r, index, at, t);
    }
}

/* Judge an attempt that is in no list at `t`, and list it with its judge unless that decides it. */
void enter(run *r, int32_t index, int32_t at, int64_t t)
{
    judge *j = &r->judges[index];
    attempt *x = attempt_at(r->home, at);
    const bool stays = remains(r, index, at, t);
    if (stays && is_undecidable(x)) {
        add_undecidable(r, index, at);
    } else if (stays) {
        set_rule_due(r, index, least(r->rules.due[index], x->due));
        if (j->last < 0) {
            j->first = at;
            j->sorted = true;
        } else {
            attempt *last = attempt_at(r->home, j->last);
            last->next = at;
            j->sorted = j->sorted && (last->due <= x->due);
        }
        j->last = at;
    } else if (r->part->plan->captured == 0) {
        free_attempt(r->home, at);
    } else {
        /* With captured values the slot is freed when it is reported, at the end of the call. */
    }
}

/* Start an attempt at the position at `t`: in this run, or, if it captures values, in a fork of it. */
void begin(run *r, int32_t index, int64_t t, int64_t triggered)
{
    if ((r->part->plan->captures.count > 0) && starts_here(r, index)) {
        begin_captured(r, index, t, triggered);
    } else {
        begin_here(r, index, t, triggered);
    }
}
