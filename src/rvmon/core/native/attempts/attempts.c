/* The life of an attempt apart from how its formula is judged: slots of the pool, numbers, sureness,
 * episodes, the decision and its record, the rule for the end of the trace.
 *
 * Attempts of a part share one pool (`home.pool`), linked by slot: from `judge.first` those that may
 * still be decided, in the order they began; from `judge.undecidable` those that stay open for good;
 * from `home.free_slot` the free ones. Slots, not pointers: the pool moves as it grows.
 *
 * An attempt is *sure* if its trigger was TRUE, else *in doubt*: it has a number of its own and cannot
 * fail. Source: docs/reference/semantics.md, section 3. */
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

/* Whether an attempt is that of the episode which runs now. */
bool is_current(const run *r, int32_t index, int32_t at)
{
    return r->judges[index].current == at;
}

/* Grow the pool to `wanted` slots; false: memory is short, and the run is spoilt. */
bool grow_pool(home *h, int64_t wanted)
{
    rv_monitor *m = h->monitor;
    int32_t capacity = h->capacity;
    int32_t same = h->capacity;
    char *pool;
    if (h->part->plan->captured > 0) {
        captured_attempt *turns = enlarged(m, h->captured_attempts, &same, wanted, sizeof *turns);
        if (turns == NULL) {
            return false;
        }
        h->captured_attempts = turns;
    }
    pool = enlarged(m, h->pool, &capacity, wanted, h->stride);
    if (pool == NULL) {
        return false;
    }
    h->pool = pool;
    h->capacity = capacity;
    return true;
}

/* A slot of the pool, with stale contents; -1: memory is short. */
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
        /* Memory is short: -1. */
    }
    return at;
}

void free_attempt(home *h, int32_t at)
{
    attempt_at(h, at)->next = h->free_slot;
    h->free_slot = at;
}

/* Number an attempt that begins at `t`, or becomes sure there. Attempts with captured values run in
 * forks that are visited in no particular order: they are numbered at the end of the call. */
void number_attempt(run *r, int32_t index, int32_t at, int64_t t)
{
    attempt *x = attempt_at(r->home, at);
    if (r->part->plan->captured > 0) {
        queue_numbering(r, at, t);
    } else {
        judge *j = &r->judges[index];
        j->count += x->sure ? 1U : 0U;
        j->doubts += x->sure ? 0U : 1U;
        x->number = x->sure ? j->count : j->doubts;
        margin_numbered(r->home->monitor, x->record, x->sure, x->number);
    }
}

/* Whether an attempt that begins here is sure: its trigger is TRUE (the end of the trace always is). */
bool is_sure(const run *r, int32_t index)
{
    const judge_plan *j = &r->part->judges[index];
    if (r->doubted) {
        return false;
    }
    return ((j->flags & JUDGE_HIDDEN) == 0)
           && ((j->trigger < 0) || (r->truth[j->trigger] == IS_TRUE));
}

/* Note the truth of the trigger at `t` for the attempt of the running episode: one UNKNOWN means that
 * the episode may have ended there, the first TRUE makes the attempt sure. */
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

/* Whether a judge's attempts are episodes: one runs until its trigger is FALSE. */
bool runs_on(const run *r, int32_t index)
{
    return (r->part->judges[index].flags & (JUDGE_EPISODIC | JUDGE_HIDDEN)) == JUDGE_EPISODIC;
}

/* Detach the attempt of the running episode: the trigger is FALSE, or another attempt takes over. */
void leave_episode(run *r, int32_t index)
{
    r->judges[index].current = -1;
    r->judges[index].failed_at = NEVER;
}

/* Feed an episodic judge the truth of its trigger at `t`. Before its attempts read the letter: an
 * episode ends before the first position at which the trigger is FALSE. */
void take_episode_trigger(run *r, int32_t index, int64_t t)
{
    const judge_plan *j = &r->part->judges[index];
    const int32_t truth = r->truth[j->running];
    int32_t current = r->judges[index].current;
    if ((current == IN_QUEUE)
        && ((truth == IS_UNKNOWN) || ((truth == IS_FALSE) && is_true(r, j->unborn)))) {
        dissolve_queue(r, index, r->judges[index].position);
        r->judges[index].slides = true; /* positions since then are still to be passed */
        current = r->judges[index].current;
    }
    if (truth == IS_FALSE) {
        if (current >= 0) {
            attempt *x = attempt_at(r->home, current);
            x->cannot_pass = x->cannot_pass || is_true(r, j->unborn);
        }
        leave_episode(r, index);
    } else if (current >= 0) {
        update_doubt_of_trigger(r, index, current, t);
    } else {
        /* No episode runs, or its attempt was decided. */
    }
}

/* Record a decision at `t`; with captured values it is kept until the end of the call. `note`: place of
 * its reason among notes, -1: none. */
void conclude(run *r, int32_t index, int32_t at, uint8_t verdict, uint8_t decision, int64_t t,
              int64_t note)
{
    if (r->part->plan->captured > 0) {
        captured_attempt *own = &r->home->captured_attempts[at];
        own->verdict = verdict;
        own->decision = decision;
        own->decided = t;
        own->note = note;
        own->rule = index;
        queue_report(r, at);
    } else {
        report(r, index, attempt_at(r->home, at), attempt_at(r->home, at)->number, verdict, decision,
               t, note);
    }
}

/* The attempt of the running episode is decided at `t`. If it fails, the judge is listed: `again` says from
 * which position another attempt follows. */
void decide_current(run *r, int32_t index, bool fails, int64_t t)
{
    judge *j = &r->judges[index];
    leave_episode(r, index);
    if (fails && (r->part->judges[index].again >= 0)) {
        j->failed_at = t;
        if (!j->is_failing_listed) {
            j->is_failing_listed = true;
            r->failing[r->failing_count] = index;
            r->failing_count++;
        }
    }
}

/* Decide an attempt by the prefix up to `t`. INCONCLUSIVE where a pass is excluded (a signal of the
 * consequent was unborn at the episode's end) or a failure is (the attempt is in doubt). */
void decide(run *r, int32_t index, int32_t at, bool passed, int64_t t)
{
    const judge_plan *j = &r->part->judges[index];
    const attempt *x = attempt_at(r->home, at);
    if (is_current(r, index, at)) {
        decide_current(r, index, !passed && x->sure, t);
    }
    if (passed ? x->cannot_pass : !x->sure) {
        conclude(r, index, at, RV_INCONCLUSIVE, RV_OPEN, t,
                 (r->truth_log != NULL) ? note_inconclusive(r, index, x) : -1);
    } else {
        const bool noted = (r->truth_log != NULL) && x->sure; /* in doubt and met: not reported */
        conclude(r, index, at, passed ? RV_PASS : RV_FAIL, RV_BY_PREFIX,
                 (j->trigger < 0) ? x->triggered : t, noted ? note_decision(r, index, x, t) : -1);
    }
}

/* Unlink an attempt from its judge's list; `before`: its predecessor, -1: none. */
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

/* Unlink a decided attempt. With captured values its slot is still needed for the record. */
void remove_attempt(run *r, int32_t index, int32_t before, int32_t at)
{
    unlink(r, index, before, at);
    if (r->part->plan->captured == 0) {
        free_attempt(r->home, at);
    }
}

/* Whether no later letter can decide an attempt: the worse reading failed, the better one passed. */
bool is_undecidable(const attempt *x)
{
    return x->parted && (x->location == FAILED) && (x->better == PASSED);
}

/* Move an attempt that stays open for good to the list that no position visits. */
void move_to_undecidable(run *r, int32_t index, int32_t before, int32_t at)
{
    unlink(r, index, before, at);
    add_undecidable(r, index, at);
}

/* The same for an attempt that is in no list. */
void add_undecidable(run *r, int32_t index, int32_t at)
{
    judge *j = &r->judges[index];
    attempt_at(r->home, at)->next = j->undecidable;
    j->undecidable = at;
    r->home->monitor->undecidable_count++;
    if (r->truth_log != NULL) {
        note_undecidable(r, index, attempt_at(r->home, at)->triggered);
    }
}

/* Iterate over a judge's open attempts, undecidable ones last: the one after slot `at` (-1: the first),
 * or -1 at the end. Queued attempts are not among them. */
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

/* Whether an open attempt's formula is TRUE by the rule for the end of the trace. */
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

/* The number in the record of an attempt. */
uint32_t reported_number(const run *r, int32_t at)
{
    const attempt *x = attempt_at(r->home, at);
    const bool apart = r->part->plan->captured > 0;
    return (apart && !x->sure) ? r->home->captured_attempts[at].doubt_number : x->number;
}

/* Report an attempt that is open at `end`, the last instant of the trace; time has come to `reached`.
 * `outcomes` of the plan holds verdict and decision by the three bits of `state`: the formula holds by
 * the rule for the end; the attempt cannot pass; it cannot fail. */
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
