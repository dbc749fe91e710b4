/* The runs of a part, and which of them a call concerns: those with an alarm, and those whose key the
 * events of the sample name. All others are not looked at, so a call costs what it concerns and not how
 * many instances there are. Behind that: at which positions a run can change without a sample. */
#include "attempts/attempts.h"
#include "formulas/formulas.h"
#include "notes/notes.h"
#include "runs/runs.h"
#include "windows/windows.h"

#include <string.h>

/* One of the arrays by id, grown; NULL: memory is short, and the old one stays valid. */
static void *resized(rv_monitor *m, void *old, int32_t room, size_t each)
{
    int32_t same = room;
    return enlarged(m, old, &same, (int64_t)room + 1, each);
}

/* Give a new run its id; false: memory is short. */
bool register_run(home *h, run *r)
{
    rv_monitor *m = h->monitor;
    const int32_t room = h->run_room;
    int32_t same = room;
    if (h->run_count == room) {
        run **touched = resized(m, h->touched, room, sizeof *touched);
        run **runs = resized(m, h->runs, room, sizeof *runs);
        int64_t *due = resized(m, h->alarms.due, room, sizeof *due);
        int32_t *ids = resized(m, h->alarms.ids, room, sizeof *ids);
        int32_t *place = resized(m, h->alarms.place, room, sizeof *place);
        int32_t *called = enlarged(m, h->called, &same, (int64_t)room + 1, sizeof *called);
        h->touched = (touched != NULL) ? touched : h->touched;
        h->runs = (runs != NULL) ? runs : h->runs;
        h->alarms.due = (due != NULL) ? due : h->alarms.due;
        h->alarms.ids = (ids != NULL) ? ids : h->alarms.ids;
        h->alarms.place = (place != NULL) ? place : h->alarms.place;
        h->called = (called != NULL) ? called : h->called;
        if ((touched == NULL) || (runs == NULL) || (due == NULL) || (ids == NULL) || (place == NULL)
            || (called == NULL)) {
            return false;
        }
        h->run_room = same;
    }
    r->id = h->run_count;
    h->runs[r->id] = r;
    h->alarms.due[r->id] = NEVER;
    h->run_count++;
    return true;
}

/* Record that a run does something in this call: its alarm is set again at the end of it. */
void touch_run(run *r)
{
    if (!r->touched_now) {
        r->touched_now = true;
        r->home->touched[r->home->touched_count] = r;
        r->home->touched_count++;
    }
}

/* Append a run to the list of root and instances, or to that of runs of attempts. */
void enlist(run *r, bool captured)
{
    home *h = r->home;
    run **last = captured ? &h->last_captured : &h->last_root;
    r->next = NULL;
    r->previous = *last;
    if (*last != NULL) {
        (*last)->next = r;
    } else if (captured) {
        h->captured = r;
    } else {
        h->root = r;
    }
    *last = r;
}

/* Remove a run from its list and release it. */
void delist(run *r, bool captured)
{
    home *h = r->home;
    if (r->previous != NULL) {
        r->previous->next = r->next;
    } else if (captured) {
        h->captured = r->next;
    } else {
        h->root = r->next;
    }
    if (r->next != NULL) {
        r->next->previous = r->previous;
    } else if (captured) {
        h->last_captured = r->previous;
    } else {
        h->last_root = r->previous;
    }
    recycle_run(h, r);
}

void recycle_run(home *h, run *r)
{
    int32_t i;
    timers_set(&h->alarms, r->id, NEVER);
    for (i = 0; i < r->part->plan->judges.count; i++) {
        clear_noting(r, i);
    }
    r->next = h->spare;
    h->spare = r;
}

/* The next run: the root and instances first, then the runs of attempts. So a run comes after the one
 * in which its attempt was triggered. */
run *following(const home *h, const run *r)
{
    return ((r == h->last_root) && (r->next == NULL)) ? h->captured : r->next;
}

/* The instant before which nothing happens in a run without a sample. */
static int64_t alarm_of(const run *r)
{
    return r->at.started ? r->at.alarm : ((GAP(r) > 0) ? r->at.awaited : NEVER);
}

/* Set the alarms of the runs touched, and that of the home. */
void set_alarms(home *h)
{
    int32_t i;
    for (i = 0; i < h->touched_count; i++) {
        timers_set(&h->alarms, h->touched[i]->id, alarm_of(h->touched[i]));
    }
    h->alarm = timers_next(&h->alarms);
}

/* Put the ids of runs with an alarm up to `t` into `called`; returns how many. */
int32_t call_due(home *h, int64_t t)
{
    return timers_due(&h->alarms, t, h->called);
}

/* Whether it is the run of an attempt: those come after the runs in which they were triggered. */
static bool is_of_attempt(const run *r)
{
    return r->parent != NULL;
}

/* Call `act` for the called runs, parents before children. Runs that it creates have come to `t`
 * already and are not visited. */
void for_called(home *h, int32_t count, int64_t t, void (*act)(run *r, int64_t t))
{
    int32_t pass;
    int32_t i;
    for (pass = 0; pass < 2; pass++) {
        for (i = 0; i < count; i++) {
            run *r = h->runs[h->called[i]];
            if (is_of_attempt(r) == (pass == 1)) {
                touch_run(r);
                act(r, t);
            }
        }
    }
}

/* The key that an event's payload names; NULL: the event concerns every instance. */
static const rv_number *key_of(const home *h, const incoming *in)
{
    const rv_update *u = in->update;
    int32_t field;
    if (!in->event || (u->says != RV_SAYS_YES) || (u->fields == NULL)) {
        return NULL;
    }
    field = h->part->events[in->local].key;
    if ((field < 0) || (u->fields[field].kind == RV_UNKNOWN)) {
        return NULL;
    }
    return &u->fields[field];
}

/* Add a run to `called` unless it is in it. */
static int32_t called_with(home *h, int32_t count, run *r)
{
    if (r->call == h->call) {
        return count;
    }
    r->call = h->call;
    h->called[count] = r->id;
    return count + 1;
}

static int32_t called_with_children(home *h, int32_t count, run *r)
{
    int32_t found = called_with(h, count, r);
    run *child;
    for (child = r->first_child; child != NULL; child = child->sibling) {
        found = called_with(h, found, child);
    }
    return found;
}

/* Put the ids of the runs that the sample or an alarm concerns into `called`; returns how many, -1:
 * all. A key's instance is called with the runs of its attempts; the root always, as instances are
 * forked from it. */
int32_t call_concerned(home *h, int64_t t)
{
    int32_t count;
    int32_t i;
    if ((h->part->plan->each == 0)
        || ((h->monitor->shapes != NULL) && (h->monitor->plan.header->gap == 0))) {
        return -1; /* every sample is a position to measure */
    }
    for (i = 0; i < h->inbox_count; i++) {
        if (key_of(h, &h->inbox[i]) == NULL) {
            return -1;
        }
    }
    h->call++;
    count = call_due(h, t);
    for (i = 0; i < count; i++) {
        h->runs[h->called[i]]->call = h->call;
    }
    count = called_with_children(h, count, h->root);
    for (i = 0; i < h->inbox_count; i++) {
        run *r = instance_of(h, key_of(h, &h->inbox[i]));
        if (r != NULL) {
            count = called_with_children(h, count, r);
        }
    }
    return count;
}

/* The next position at which something can change without a sample. */

/* The first of start, start + step, ... that is not before `t`. */
static int64_t position_from(int64_t start, int64_t step, int64_t t)
{
    const int64_t ahead = t - start;
    return start + (ahead + step - 1) / step * step;
}

/* The first multiple of the gap from `t` on, for t of either sign. */
int64_t tick_from(int64_t gap, int64_t t)
{
    return (t >= 0) ? position_from(0, gap, t) : -((-t) / gap) * gap;
}

/* Whether the episode's attempt has failed, and its obligations would not fail again at once, so that a
 * new attempt may start. */
bool may_go_on(const run *r, int32_t index)
{
    const int32_t again = r->part->judges[index].again;
    return (again >= 0) && (r->judges[index].failed_at < NEVER) && (r->truth[again] != IS_FALSE);
}

/* Drop judges whose episode is over from `failing`. */
void tidy_failing(run *r)
{
    int32_t kept = 0;
    int32_t i;
    for (i = 0; i < r->failing_count; i++) {
        const int32_t index = r->failing[i];
        if (r->judges[index].failed_at < NEVER) {
            r->failing[kept] = index;
            kept++;
        } else {
            r->judges[index].is_failing_listed = false;
        }
    }
    r->failing_count = kept;
}

/* Bounds on how many failures that only time brings about, one after the other, are reported singly
 * while no input comes; the rest of them, but for the last two, is only counted. That bounds the cost
 * of a stamp that leaps by years: `always within 3 s e` fails 500 million times in fifty years.
 * COUNTS_LEFT keeps counts clear of 32 bits. */
enum { REPEATS_TOLD = 1000, REPEATS_LEFT = 2, COUNTS_LEFT = 65536 };

/* Whether what the attempts of a run read stays the same without input, except by timers. */
static bool is_silent(const run *r)
{
    return (GAP(r) > 0) && (r->part->plan->captured == 0) && (r->margins == NULL)
           && (r->at.presence == ARE_THERE) && (r->at.fading_count + r->at.fresh_count == 0)
           && !r->opening && !r->stays_busy;
}

/* If an episode would fail and restart very often before the next input, count that instead of doing
 * it; false if another attempt has to begin at `t`.
 *
 * The attempt that would begin at `t` finds what the last one found, which began in the same
 * silence: no attempt is open, and nothing that it reads changes before the next timer. So it fails
 * after the same time, and so do all others up to there. Numbers have 32 bits, so the count is
 * capped below that. */
bool passes_repeats_over(run *r, int32_t index, int64_t t)
{
    judge *j = &r->judges[index];
    const int64_t before = j->again_at;
    const int64_t period = t - before;
    const int64_t silent = r->at.quiet_from;
    int64_t until = least(r->at.quiet_until, least(timers_next(&r->wake), r->at.ends_at) - 1);
    int64_t many;
    int64_t counted;
    j->again_at = t;
    if ((before <= silent) || has_attempts(j) || needs_every_position(r, index) || !is_sure(r, index)
        || !is_silent(r)) {
        return false;
    }
    until = (r->cut < NEVER) ? t : until;
    many = (until > t) ? (until - t) / period - REPEATS_LEFT : 0;
    if ((many <= REPEATS_TOLD) || ((t - silent) / period < REPEATS_TOLD)) {
        return false;
    }
    counted = least(many, (int64_t)(UINT32_MAX - COUNTS_LEFT) - (int64_t)j->count);
    counted = (counted > 0) ? counted : 0;
    j->count += (uint32_t)counted;
    j->failed += (uint32_t)counted;
    j->failed_at += many * period;
    j->again_at = t + (many - 1) * period;
    return true;
}

/* The next position at which an attempt may follow a failure though nothing changes. */
int64_t next_start(const run *r)
{
    const int64_t step = step_of(r);
    int64_t found = NEVER;
    int32_t i;
    for (i = 0; (GAP(r) > 0) && (i < r->failing_count); i++) {
        const int32_t index = r->failing[i];
        if (may_go_on(r, index)) {
            const int64_t ahead = (r->judges[index].failed_at - r->at.position) / step + 1;
            found = least(found, r->at.position + ((ahead > 1) ? ahead : 1) * step);
        }
    }
    return found;
}

/* The next position at which something can change without a sample; NEVER. In sampled time only an
 * outage makes one. */
int64_t next_position(const run *r)
{
    const int64_t gap = GAP(r);
    int64_t found = (gap > 0) ? least(r->at.awaited, r->at.ends_at) : NEVER;
    if (r->at.presence != ARE_THERE) {
        return (r->at.started && (r->at.presence == MAY_BE_THERE)) ? NEVER : r->at.awaited;
    }
    if ((gap > 0) && r->at.started) {
        int64_t change = timers_next(&r->wake);
        if ((r->at.fading_count > 0) || (r->repeating_count > 0) || r->stays_busy) {
            change = least(change, r->at.position + gap);
        }
        if (change < NEVER) {
            found = least(found, position_from(r->at.position, gap, change));
        }
        if (r->failing_count > 0) {
            found = least(found, next_start(r));
        }
        if ((r->cut < NEVER) && (r->cut > r->at.position)) {
            found = least(found, r->cut);
        }
    }
    return found;
}

static bool is_restless(const run *r)
{
    int32_t i;
    for (i = 0; i < r->restless_count; i++) {
        if (r->judges[r->restless[i]].restless) {
            return true;
        }
    }
    return false;
}

/* Set the alarm of a run, given the next position. In sampled time every sample is a position, so
 * whatever is momentary or moves at each position keeps the alarm in the past. */
void set_alarm(run *r, int64_t position)
{
    if (!r->at.started) {
        return;
    }
    r->at.alarm = least(position, timers_next(&r->rules));
    if (GAP(r) == 0) {
        const bool busy = (r->at.fading_count > 0) || (r->repeating_count > 0) || r->stays_busy
                          || (r->part->plan->stateful.count > 0) || is_restless(r)
                          || (r->failing_count > 0) || (r->at.presence != ARE_THERE)
                          || ((r->cut < NEVER) && (r->cut > r->at.position));
        r->at.alarm = busy ? -LIMIT : least(r->at.alarm, timers_next(&r->wake));
    }
}
