/* Attempts with captured values: each is judged in a run of its own, forked from the run in which it was
 * triggered, in which formulas read the values that it captured.
 *
 * Attempts are numbered and reported at the end of each call, as only then their order over all instances
 * is known. Among attempts that start at one instant, the one triggered first comes first, then the one
 * whose instance's key occurred first.
 *
 * Captured values may become unknown afterwards: while a trigger is in doubt, the attempt may have
 * started at any of its positions, with other values. The parent checks that at each of its positions
 * (check_children). From the first difference on (`cut`) LAPSED nodes are TRUE, and the attempt cannot
 * pass. */
#include "formulas/formulas.h"
#include "input/input.h"
#include "networks/network.h"
#include "results/results.h"
#include "runs/runs.h"

#include <string.h>

bool starts_here(const run *r, int32_t index)
{
    return ((r->starters >> index) & 1) != 0;
}

/* Whether the attempt of a run is over and completely reported. */
bool is_idle(const run *r)
{
    return (next_open(r, r->judged, -1) < 0) && !r->judges[r->judged].running && (r->pending_margins == 0);
}

/* The instant by which an attempt is ordered among those that became sure, or that are in doubt. */
static int64_t order_instant(const home *h, int32_t at, bool sure)
{
    return sure ? h->captured_attempts[at].became : attempt_at(h, at)->triggered;
}

/* Whether an attempt has to be numbered before another. */
static bool is_earlier(const home *h, int32_t at, int32_t other, bool sure)
{
    const int64_t t = order_instant(h, at, sure);
    const int64_t other_t = order_instant(h, other, sure);
    const int64_t triggered = attempt_at(h, at)->triggered;
    const int64_t other_triggered = attempt_at(h, other)->triggered;
    if (t != other_t) {
        return t < other_t;
    }
    if (triggered != other_triggered) {
        return triggered < other_triggered;
    }
    return h->captured_attempts[at].judge->rank < h->captured_attempts[other].judge->rank;
}

static int32_t *link_of(home *h, int32_t at, bool sure)
{
    return sure ? &h->captured_attempts[at].next_sure : &h->captured_attempts[at].next_doubt;
}

/* Queue an attempt to be numbered: it became sure at `t`, or started in doubt. */
void queue_numbering(run *r, int32_t at, int64_t t)
{
    home *h = r->home;
    const bool sure = attempt_at(h, at)->sure;
    int32_t *ends = sure ? h->sure : h->doubtful;
    if (sure) {
        h->captured_attempts[at].became = t;
    }
    *link_of(h, at, sure) = -1;
    if (ends[1] < 0) {
        ends[0] = at;
    } else {
        *link_of(h, ends[1], sure) = at;
    }
    ends[1] = at;
}

/* Merge two sorted lists of attempts, stably: on a tie the first one, which was queued earlier, comes
 * first. Either may be empty (-1). */
static int32_t merged(home *h, int32_t one, int32_t other, bool sure)
{
    int32_t first = -1;
    int32_t last = -1;
    while ((one >= 0) || (other >= 0)) {
        const bool takes_other = (one < 0) || ((other >= 0) && is_earlier(h, other, one, sure));
        int32_t *from = takes_other ? &other : &one;
        if (last < 0) {
            first = *from;
        } else {
            *link_of(h, last, sure) = *from;
        }
        last = *from;
        *from = *link_of(h, last, sure);
    }
    return first;
}

/* Sort a list of attempts for numbering; returns its head. The list is mostly sorted, which is checked
 * first; else bottom-up merge sort. */
static int32_t in_order(home *h, int32_t first, bool sure)
{
    int32_t lists[32];         /* sorted lists of 2^i attempts, or -1 */
    int32_t at = first;
    int32_t i;
    while ((at >= 0) && (*link_of(h, at, sure) >= 0) && !is_earlier(h, *link_of(h, at, sure), at, sure)) {
        at = *link_of(h, at, sure);
    }
    if ((at < 0) || (*link_of(h, at, sure) < 0)) {
        return first;
    }
    for (i = 0; i < 32; i++) {
        lists[i] = -1;
    }
    for (at = first; at >= 0;) {
        int32_t own = at;
        at = *link_of(h, at, sure);
        *link_of(h, own, sure) = -1;
        for (i = 0; lists[i] >= 0; i++) {
            own = merged(h, lists[i], own, sure);
            lists[i] = -1;
        }
        lists[i] = own;
    }
    for (i = 0; i < 32; i++) {
        at = merged(h, lists[i], at, sure);
    }
    return at;
}

/* Queue an attempt to be reported as decided. */
void queue_report(run *r, int32_t at)
{
    home *h = r->home;
    h->captured_attempts[at].next_done = -1;
    if (h->done[1] < 0) {
        h->done[0] = at;
    } else {
        h->captured_attempts[h->done[1]].next_done = at;
    }
    h->done[1] = at;
}

/* Number the attempts that started or became sure in this call, then report the decided ones and free
 * their slots. */
void number_and_report(home *h)
{
    numbering counted = {0, 0, 0};
    int32_t at;
    for (at = in_order(h, h->sure[0], true); at >= 0; at = h->captured_attempts[at].next_sure) {
        h->count++;
        attempt_at(h, at)->number = h->count + (uint32_t)counted_before(h, &counted, at);
        margin_numbered(h->monitor, attempt_at(h, at)->record, true, attempt_at(h, at)->number);
    }
    h->count += (uint32_t)h->silence.total;
    forget_repeats(h);
    for (at = in_order(h, h->doubtful[0], false); at >= 0; at = h->captured_attempts[at].next_doubt) {
        h->doubts++;
        h->captured_attempts[at].doubt_number = h->doubts;
        margin_numbered(h->monitor, attempt_at(h, at)->record, false, h->doubts);
    }
    at = h->done[0];
    h->sure[0] = h->sure[1] = -1;
    h->doubtful[0] = h->doubtful[1] = -1;
    h->done[0] = h->done[1] = -1;
    while (at >= 0) {
        captured_attempt *own = &h->captured_attempts[at];
        const int32_t next = own->next_done;
        report(own->judge, own->rule, attempt_at(h, at), reported_number(own->judge, at), own->verdict,
               own->decision, own->decided, own->note);
        own->judge = NULL;
        free_attempt(h, at);
        at = next;
    }
}

/* Evaluate the `let` values of an attempt that starts at the position of `r`; in `values` they follow
 * its key. */
static void capture(run *r, rv_number *values)
{
    const list captures = r->part->plan->captures;
    const int32_t *programs = LIST(PLAN(r), captures);
    const int32_t first = r->part->plan->each;
    rv_number *own = r->captured;
    rv_number *now = r->value;
    int32_t i;
    if ((r->home->unknown_values != NULL) && (r->at.dense || (r->at.presence != ARE_THERE))) {
        r->value = r->home->unknown_values; /* in an outage; for windows see left_number */
    }
    r->captured = values; /* a `let` may read earlier ones */
    for (i = 0; i < captures.count; i++) {
        values[first + i] = program_value(r, programs[i], NULL);
    }
    r->captured = own;
    r->value = now;
}

/* Whether an attempt may have started at the parent's position with other values than it captured: the
 * trigger is in doubt there, and evaluating the captures now gives other values. */
static bool may_capture_other(run *r)
{
    const judge_plan *j = &r->part->judges[r->judged];
    const part_plan *p = r->part->plan;
    run *parent = r->parent;
    rv_number *now = r->home->room;
    int32_t i;
    if (!(parent->doubted && ((j->flags & JUDGE_BLURS_ANYWHERE) != 0))
        && (parent->truth[j->blurs] != IS_UNKNOWN)) {
        return false;
    }
    now[0] = r->captured[0];
    capture(parent, now);
    for (i = p->each; i < p->captured; i++) {
        if ((now[i].kind == RV_UNKNOWN) || !same_number(&now[i], &r->captured[i])) {
            return true;
        }
    }
    return false;
}

/* Mark the LAPSED nodes to be evaluated. */
void mark_lapsed(run *r)
{
    const int32_t *lapsed = LIST(PLAN(r), r->part->plan->lapsed);
    int32_t i;
    for (i = 0; i < r->part->plan->lapsed.count; i++) {
        mark_dirty(r, lapsed[i]);
    }
}

static void set_watched(run *r, bool watched)
{
    r->parent->watched_children += (watched ? 1 : 0) - (r->watched ? 1 : 0);
    r->watched = watched;
}

/* Check at position `t` of the parent whether the captured values remain known. */
static void check_captured(run *r, int64_t t)
{
    const uint8_t trigger = r->parent->truth[r->part->judges[0].trigger];
    int32_t at;
    if (is_idle(r) || (trigger == IS_FALSE)) {
        r->blurs = false;
    } else if (r->blurs && (r->cut == NEVER) && may_capture_other(r)) {
        r->cut = t;
        r->at.alarm = least(r->at.alarm, t);
        mark_lapsed(r);
    } else {
        /* They remain known. */
    }
    if (r->cut < NEVER) {
        for (at = next_open(r, r->judged, -1); at >= 0; at = next_open(r, r->judged, at)) {
            attempt *x = attempt_at(r->home, at);
            x->cannot_pass = true;
            x->trigger_unknown = (trigger != IS_FALSE) && (x->trigger_unknown || (trigger == IS_UNKNOWN));
        }
    }
    set_watched(r, r->blurs || ((r->cut < NEVER) && (trigger != IS_FALSE)));
}

/* Link the run of an attempt below the run in which it was triggered. */
void adopt(run *parent, run *child)
{
    child->parent = parent;
    child->previous_sibling = NULL;
    child->sibling = parent->first_child;
    if (parent->first_child != NULL) {
        parent->first_child->previous_sibling = child;
    }
    parent->first_child = child;
}

/* Release the run of an attempt that is over. */
void release_attempt_run(run *r)
{
    set_watched(r, false);
    if (r->previous_sibling != NULL) {
        r->previous_sibling->sibling = r->sibling;
    } else {
        r->parent->first_child = r->sibling;
    }
    if (r->sibling != NULL) {
        r->sibling->previous_sibling = r->previous_sibling;
    }
    touch_run(r->parent); /* an instance without attempts may be closed */
    delist(r, true);
}

/* Start an attempt that captures values: fork the run, evaluate the captures, and update everything that
 * depends on them, by replaying the past if past operators do. Only then is the attempt judged. */
void begin_captured(run *r, int32_t index, int64_t t, int64_t triggered)
{
    const bool watched = r->part->judges[index].blurs >= 0;
    run *made = forked(r);
    int32_t i;
    if (made == NULL) {
        return;
    }
    made->parent = r;
    made->judged = index;
    made->starters = 0;
    made->judging = 1 << index;
    made->opens_at = -LIMIT;
    made->blurs = true;
    capture(r, made->captured);
    if (watched && may_capture_other(made)) {
        made->cut = t;
    }
    if ((r->part->plan->flags & PART_REPLAYS) != 0) {
        replay(made);
        if (made->at.dense) {
            run_pass_dense(made, t);
        } else {
            pass_time(made, t, false);
        }
    } else if ((made->at.presence == ARE_THERE) && !made->at.dense) {
        reevaluate_varying(made, t, false);
    } else {
        /* In an outage everything is unknown anyway. */
    }
    adopt(r, made);
    enlist(made, true);
    begin_here(made, index, t, triggered);
    for (i = 0; !made->at.dense && (i < r->part->plan->signals.count); i++) {
        learn_span(made, i); /* now, so that the next sample need not call this run for it */
    }
    set_alarm(made, next_position(made));
    if (watched) {
        check_captured(made, t);
    }
}

/* Check the captured values of the attempts triggered in this run, at its position `t`; sets stays_busy
 * if the next position has to be visited for them. */
void check_children(run *r, int64_t t)
{
    run *one;
    bool some = false;
    bool other_next = false;
    int32_t i;
    for (one = r->first_child; (r->watched_children > 0) && (one != NULL); one = one->sibling) {
        if (one->watched) {
            touch_run(one);
            check_captured(one, t);
            some = some || one->watched;
            other_next = other_next || (one->watched && (one->cut == NEVER));
        }
    }
    r->stays_busy = other_next && ((r->part->plan->flags & PART_CAPTURES_NOW) != 0);
    for (i = 0; some && (i < r->part->plan->events.count); i++) {
        /* The payloads are gone at the next position. */
        r->stays_busy = r->stays_busy || (r->payloads[i].count > 0);
    }
}

/* Forget what occurred at the last position, once captures can no longer read it. */
void forget_last(run *r)
{
    touch_run(r);
    if (r->over) {
        r->over = false;
        forget(r);
    }
}
