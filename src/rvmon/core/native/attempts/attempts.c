/* Attempts: numbered, decided, settled at the end. */
#include "attempts/attempts.h"
#include "margins/margins.h"
#include "notes/notes.h"
#include "results/results.h"
#include "runs/runs.h"
#include "windows/windows.h"

#include <string.h>

bool is_true(const run *r, int32_t node)
{
    return (node >= 0) && (r->truth[node] == IS_TRUE);
}

bool is_current(const run *r, int32_t index, int32_t at)
{
    return r->judges[index].current == at;
}

/* Make room for so many open attempts; false if there is none. */
bool grow_pool(home *h, int64_t wanted)
{
    rv_monitor *m = h->monitor;
    int32_t capacity = h->capacity;
    int32_t same = h->capacity;
    char *pool;
    if (h->part->plan->captured > 0) {
        turn *turns = enlarged(m, h->turns, &same, wanted, sizeof *turns);
        if (turns == NULL) {
            return false;
        }
        h->turns = turns;
    }
    pool = enlarged(m, h->pool, &capacity, wanted, h->stride);
    if (pool == NULL) {
        return false;
    }
    h->pool = pool;
    h->capacity = capacity;
    return true;
}

int32_t new_attempt(run *r)
{
    home *h = r->home;
    int32_t at = h->free_slot;
    if (at >= 0) {
        h->free_slot = attempt_at(h, at)->next;
    } else if ((h->used < h->capacity) || grow_pool(h, (int64_t)h->capacity + 1)) {
        at = h->used;
        h->used++;
    } else {
        /* There is none. */
    }
    return at;
}

void free_attempt(home *h, int32_t at)
{
    attempt_at(h, at)->next = h->free_slot;
    h->free_slot = at;
}

/* Number an attempt of which it is known now that there was a trigger, or not known. Those with
 * captured values are numbered at the end of the call, when all that began are known. */
void number_attempt(run *r, int32_t index, int32_t at, int64_t t)
{
    attempt *x = attempt_at(r->home, at);
    if (r->part->plan->captured > 0) {
        note_turn(r, at, t);
    } else {
        judge *j = &r->judges[index];
        j->count += x->sure ? 1U : 0U;
        j->doubts += x->sure ? 0U : 1U;
        x->number = x->sure ? j->count : j->doubts;
        margin_numbered(r->home->monitor, x->record, x->sure, x->number);
    }
}

/* Whether an attempt that runs from here on has a trigger that is true. */
bool is_sure(const run *r, int32_t index)
{
    const judge_plan *j = &r->part->judges[index];
    if (r->doubted) {
        return false;
    }
    return ((j->flags & JUDGE_HIDDEN) == 0)
           && ((j->trigger < 0) || (r->truth[j->trigger] == IS_TRUE));
}

/* Take the truth of the trigger of the attempt that runs, at `t`. */
static void update_doubt_of_trigger(run *r, int32_t index, int32_t at, int64_t t)
{
    attempt *x = attempt_at(r->home, at);
    if (r->truth[r->part->judges[index].running] == IS_UNKNOWN) {
        x->trigger_unknown = true;
    }
    if (!x->sure && is_sure(r, index)) {
        x->sure = true;
        number_attempt(r, index, at, t);
    }
}

/* Whether an attempt of a judge runs until its trigger is false. */
bool runs_on(const run *r, int32_t index)
{
    return (r->part->judges[index].flags & (JUDGE_EPISODIC | JUDGE_HIDDEN)) == JUDGE_EPISODIC;
}

/* The episode that runs is over, or goes on with another attempt. */
void leave_episode(run *r, int32_t index)
{
    r->judges[index].current = -1;
    r->judges[index].failed_at = NEVER;
}

/* Take the truth of the trigger of an episode, before the attempts see the position. */
void take_episode_trigger(run *r, int32_t index, int64_t t)
{
    const judge_plan *j = &r->part->judges[index];
    const int32_t current = r->judges[index].current;
    if (r->truth[j->running] == IS_FALSE) {
        if (current >= 0) {
            attempt *x = attempt_at(r->home, current);
            x->cannot_pass = x->cannot_pass || is_true(r, j->unborn);
        }
        leave_episode(r, index);
    } else if (current >= 0) {
        update_doubt_of_trigger(r, index, current, t);
    } else {
        /* None runs, or its attempt has failed. */
    }
}

/* Be done with an attempt. */
void conclude(run *r, int32_t index, int32_t at, uint8_t verdict, uint8_t decision, int64_t t,
              int64_t note)
{
    if (r->part->plan->captured > 0) {
        turn *own = &r->home->turns[at];
        own->verdict = verdict;
        own->decision = decision;
        own->decided = t;
        own->note = note;
        own->rule = index;
        note_done(r, at);
    } else {
        report(r, index, attempt_at(r->home, at), attempt_at(r->home, at)->number, verdict, decision,
               t, note);
    }
}

void decide(run *r, int32_t index, int32_t at, bool passed, int64_t t)
{
    const judge_plan *j = &r->part->judges[index];
    const attempt *x = attempt_at(r->home, at);
    if (is_current(r, index, at)) {
        leave_episode(r, index);
        if (!passed && x->sure && (j->again >= 0)) {
            judge *own = &r->judges[index];
            own->failed_at = t;
            if (!own->is_failing_listed) {
                own->is_failing_listed = true;
                r->failing[r->failing_count] = index;
                r->failing_count++;
            }
        }
    }
    if (passed ? x->cannot_pass : !x->sure) {
        conclude(r, index, at, RV_INCONCLUSIVE, RV_OPEN, t,
                 (r->truth_log != NULL) ? note_nothing(r, index, x) : -1);
    } else {
        const bool noted = (r->truth_log != NULL) && x->sure; /* else it was met, triggered or not */
        conclude(r, index, at, passed ? RV_PASS : RV_FAIL, RV_BY_PREFIX,
                 (j->trigger < 0) ? x->triggered : t, noted ? note_decision(r, index, x, t) : -1);
    }
}

/* Unlink an attempt from those of a judge; `before` is the one before it, -1 if there is none. */
static void unlink(run *r, int32_t index, int32_t before, int32_t at)
{
    judge *j = &r->judges[index];
    const int32_t next = attempt_at(r->home, at)->next;
    if (before < 0) {
        j->first = next;
    } else {
        attempt_at(r->home, before)->next = next;
    }
    if (next < 0) {
        j->last = before;
    }
}

/* Take an attempt that is decided out of those of a judge. */
void remove_attempt(run *r, int32_t index, int32_t before, int32_t at)
{
    unlink(r, index, before, at);
    if (r->part->plan->captured == 0) {
        free_attempt(r->home, at);
    }
}

/* Whether nothing more can be said of an attempt: it fails for the worse, and passes for the better. */
bool is_undecidable(const attempt *x)
{
    return x->parted && (x->location == FAILED) && (x->better == PASSED);
}

/* Put an attempt that stays open for good where nobody comes by until the end. */
void move_to_undecidable(run *r, int32_t index, int32_t before, int32_t at)
{
    unlink(r, index, before, at);
    add_undecidable(r, index, at);
}

/* Put an attempt there that is in no list. */
void add_undecidable(run *r, int32_t index, int32_t at)
{
    judge *j = &r->judges[index];
    attempt_at(r->home, at)->next = j->undecidable;
    j->undecidable = at;
    r->home->monitor->laid_count++;
    if (r->truth_log != NULL) {
        note_undecidable(r, index, attempt_at(r->home, at)->triggered);
    }
}

/* The open attempt of a judge behind another, those for good last; -1 before the first, and behind
 * all. */
int32_t next_open(const run *r, int32_t index, int32_t at)
{
    const judge *j = &r->judges[index];
    if (at < 0) {
        return (j->first >= 0) ? j->first : j->undecidable;
    }
    if (at == j->last) {
        return j->undecidable;
    }
    return attempt_at(r->home, at)->next;
}

/* Whether the rule for the end of a trace makes an attempt true. */
static bool holds_at_trace_end(run *r, int32_t index, const attempt *x, int64_t end, int64_t reached)
{
    if (is_chained(r, index)) {
        return chain_outlasts(r, index, x, end, reached);
    }
    if (is_networked(r, index)) {
        return network_outlasts(r, index, x);
    }
    return holds_at_end(&r->part->machines[index], x->location, x->clocks, end, reached);
}

/* The number that an attempt is told of by: those in doubt have numbers of their own. */
uint32_t reported_number(const run *r, int32_t at)
{
    const attempt *x = attempt_at(r->home, at);
    const bool apart = r->part->plan->captured > 0;
    return (apart && !x->sure) ? r->home->turns[at].doubt_number : x->number;
}

/* Settle an attempt that is undecided at the end. */
void settle_attempt(run *r, int32_t index, int32_t at, int64_t end, int64_t reached)
{
    const judge_plan *j = &r->part->judges[index];
    const attempt *x = attempt_at(r->home, at);
    const bool runs = is_current(r, index, at);
    const bool cannot_pass = x->cannot_pass || (runs && is_true(r, j->unborn));
    bool may_be_over = !x->sure || (runs && x->trigger_unknown);
    const int64_t now = stamp_of_end(end, reached);
    int32_t state = (!cannot_pass && holds_at_trace_end(r, index, x, end, reached)) ? 1 : 0;
    may_be_over = may_be_over || ((r->cut < NEVER) && x->trigger_unknown);
    state |= (cannot_pass || (x->location == FAILED)) ? 2 : 0;
    state |= (may_be_over || (x->parted && (x->better == PASSED))) ? 4 : 0;
    report(r, index, x, reported_number(r, at), (uint8_t)(j->outcomes[state] & 3),
           (uint8_t)(j->outcomes[state] >> 2), end,
           (r->truth_log == NULL) ? -1 : note_open(r, index, x, now, cannot_pass, end));
}
