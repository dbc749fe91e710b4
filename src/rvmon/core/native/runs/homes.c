/* A part with all its runs: what each call of core.h does in it. A part without captured values mostly
 * forwards calls to its one run. Otherwise a call lets time pass in runs with an alarm, creates
 * instances, gives the sample to the runs it concerns; rest_all then numbers, reports and releases. */
#include "formulas/formulas.h"
#include "input/input.h"
#include "networks/network.h"
#include "results/results.h"
#include "runs/runs.h"

#include <string.h>

static bool is_apart(const home *h)
{
    return h->part->plan->captured > 0;
}

static void come_through(run *r, int64_t t)
{
    pass_time(r, t, false);
}

/* Let time pass up to `limit` in all runs, in the order of alarms, so that decisions are in order. */
static void pass_all(home *h, int64_t limit)
{
    const bool sampled = h->monitor->plan.header->gap == 0; /* no position before the next sample */
    int64_t t = timers_next(&h->alarms);
    begin_silence(h, t - 1, limit);
    while (t <= limit) {
        t = sampled ? limit : t;
        for_called(h, call_due(h, t), t, come_through);
        set_alarms(h);
        t = sampled ? NEVER : timers_next(&h->alarms);
    }
    end_silence(h);
}

/* End a call: number and report attempts; release the runs of attempts that are over, then the instances
 * that are over because of that; set the alarms of all runs touched. */
void rest_all(home *h)
{
    int32_t i;
    number_and_report(h);
    h->alarmed = 0; /* places in `touched` change below */
    for (i = 0; i < h->touched_count; i++) {
        if ((h->touched[i]->parent != NULL) && is_idle(h->touched[i])) {
            h->touched[i]->touched_at = 0;
            release_attempt_run(h->touched[i]);
            h->touched[i] = NULL;
        }
    }
    for (i = 0; i < h->touched_count; i++) {
        run *r = h->touched[i];
        if ((r != NULL) && (r->parent == NULL) && (r != h->root)
            && ((h->part->plan->flags & PART_FORGETS) != 0) && equals_root(r)) {
            r->touched_at = 0;
            close_instance(r);
            h->touched[i] = NULL;
        }
    }
    drop_gone(h);
    set_alarms(h);
    untouch_all(h);
}

/* Release all runs but the root, and reset the root to before the first sample. */
static void clear_home(home *h)
{
    const part_plan *p = h->part->plan;
    run *one;
    int32_t i;
    while (h->captured != NULL) {
        delist(h->captured, true);
    }
    while (h->last_root != h->root) {
        delist(h->last_root, false);
    }
    untouch_all(h);
    h->used = 0;
    h->free_slot = -1;
    h->sure[0] = h->sure[1] = -1;
    h->doubtful[0] = h->doubtful[1] = -1;
    h->done[0] = h->done[1] = -1;
    forget_repeats(h);
    end_silence(h);
    h->count = h->doubts = h->passed = h->failed = h->inconclusive = 0;
    h->past_judged = h->past_count;
    forget_given(h);
    h->inbox_count = 0;
    h->alarm = NEVER;
    h->previous = 0;
    one = h->root;
    one->parent = NULL;
    one->first_child = NULL;
    one->opens_at = (p->each != 0) ? NEVER : -LIMIT;
    one->cut = NEVER;
    one->occurred = 0;
    one->rank = 0;
    one->key = -1;
    one->judged = 0;
    one->starters = p->root_starters;
    one->judging = (p->captures.count > 0) ? 0 : p->root_starters;
    one->opening = false;
    one->over = false;
    one->watched = false;
    one->watched_children = 0;
    one->blurs = false;
    one->touched_at = 0;
    one->doubted = p->each != 0;
    one->stays_busy = false;
    clear_run(one);
    for (i = 0; i < p->captured; i++) {
        (void)memset(&one->captured[i], 0, sizeof one->captured[i]);
    }
}

/* Start a run of the monitor; on the first call, create the root. False: memory is short. */
bool home_begin(home *h)
{
    const part_plan *p = h->part->plan;
    if (h->root == NULL) {
        h->stride = sizeof(attempt) + 2 * (size_t)p->clocks * sizeof(int64_t);
        h->root = new_run(h);
        if (h->root == NULL) {
            return false;
        }
        h->last_root = h->root;
        h->scratch_attempt = arena_take(&h->monitor->memory, h->stride);
        h->room = arena_take(&h->monitor->memory, (size_t)(p->captured + 1) * sizeof *h->room);
        if ((h->room == NULL) || (h->scratch_attempt == NULL)) {
            return false;
        }
    }
    clear_home(h);
    if (h->monitor->keeps_notes && !begin_unknowns(h)) {
        return false;
    }
    return begin_watch(h) && ((p->each == 0) || begin_keys(h));
}

bool home_reserve(home *h, int32_t attempts)
{
    const run *one;
    int32_t runs = 0;
    if (!grow_pool(h, attempts)) {
        return false;
    }
    for (one = h->spare; one != NULL; one = one->next) {
        runs++;
    }
    for (; is_apart(h) && (runs < attempts); runs++) {
        run *made = new_run(h);
        if (made == NULL) {
            return false;
        }
        recycle_run(h, made);
    }
    return true;
}

void home_mark_absent(home *h, bool event, int32_t local)
{
    declare_no_source(h->root, event, local);
    if (event && (h->part->plan->each != 0) && (local == h->part->plan->each_event)) {
        h->root->opens_at = -LIMIT; /* an occurrence with unknown key is possible at any position */
    }
}

static void give_inbox(run *r, int64_t t)
{
    give_sample(r, t, r->home->inbox, r->home->inbox_count);
}

/* Judge the sample in the inbox, in a part that captures values. */
void take_inbox(home *h, int64_t t)
{
    const part_plan *p = h->part->plan;
    int32_t count;
    run *one;
    pass_all(h, t - 1);
    if (p->each != 0) {
        open_instances(h, t);
    }
    keep_given(h, t);
    count = call_affected(h, t);
    if (count >= 0) {
        for_called(h, count, t, give_inbox);
    } else {
        for (one = h->root; one != NULL; one = following(h, one)) {
            touch_run(one);
            give_inbox(one, t);
        }
    }
    rest_all(h);
}

void home_sample(home *h, int64_t t)
{
    if (!is_apart(h)) {
        give_sample(h->root, t, h->inbox, h->inbox_count);
        h->alarm = h->root->at.alarm;
    } else if (holds_back(h)) {
        hold_back(h, t);
    } else {
        take_inbox(h, t);
    }
    h->inbox_count = 0;
}

static void come_to_instant(run *r, int64_t t)
{
    reach(r, t);
    set_alarm(r, next_position(r));
}

/* Pass all positions before `t`, then let time itself come to `t`. */
void home_wait(home *h, int64_t t)
{
    if (!is_apart(h)) {
        pass_time(h->root, t - 1, true);
        reach(h->root, t);
        set_alarm(h->root, next_position(h->root));
        h->alarm = h->root->at.alarm;
        return;
    }
    give_held(h, t - 1);
    pass_all(h, t - 1);
    for_called(h, call_due(h, t), t, come_to_instant);
    rest_all(h);
}

/* Start or end the outages in the inbox, in all runs of a part that captures values. */
void lose_inbox(home *h, int64_t t)
{
    run *one;
    pass_all(h, t - 1);
    if (h->part->plan->each != 0) {
        open_instances(h, t);
    }
    keep_given(h, t);
    for (one = h->root; one != NULL; one = following(h, one)) {
        touch_run(one);
        run_take_loss(one, t, h->inbox, h->inbox_count);
    }
    rest_all(h);
}

void home_lose(home *h, int64_t t)
{
    if (!is_apart(h)) {
        run_take_loss(h->root, t, h->inbox, h->inbox_count);
        h->alarm = h->root->at.alarm;
    } else if (holds_back(h)) {
        hold_back(h, t);
    } else {
        lose_inbox(h, t);
    }
    h->inbox_count = 0;
}

void home_begin_blank(home *h, int64_t t)
{
    const bool keeps = (h->part->plan->flags & PART_KEEPS_PAST) != 0;
    if (keeps) {
        keep_updates(h, t);
        h->past_judged = h->past_count;
        if (h->past_count > 0) {
            h->past[h->past_count - 1].says = SAYS_AHEAD;
        }
    }
    touch_run(h->root);
    await_blank_start(h->root, t);
    if (is_apart(h)) {
        rest_all(h);
    } else {
        untouch_all(h);
        h->alarm = t;
    }
}

/* Move a run to its last position up to `end`. Time has passed, so formulas do not change on the
 * way. */
static void come_to_end(run *r, int64_t end)
{
    const int64_t gap = GAP(r);
    if (gap > 0) {
        const int64_t last = r->at.position + (end - r->at.position) / gap * gap;
        if (last > r->at.position) {
            if (is_apart(r->home)) {
                forget_last(r);
            }
            r->at.position = last;
            r->at.before = last - gap;
        }
    } else {
        if (is_apart(r->home) && (last_position(r->home->monitor) > r->at.position)) {
            forget_last(r); /* a sample of which this part reads nothing is a position, too */
        }
        r->at.position = last_position(r->home->monitor);
    }
}

static void begin_at_end(run *r, int64_t end)
{
    int32_t i;
    if (!r->at.started || (r->opens_at == NEVER)) {
        return;
    }
    come_to_end(r, end);
    /* A key that first occurred after the last tick has occurred at no position. */
    if ((r->rank != 0U) && (r->occurred > r->at.position)) {
        return;
    }
    for (i = 0; i < r->part->plan->judges.count; i++) {
        if (r->part->judges[i].trigger < 0) {
            begin(r, i, r->at.position, end);
        }
    }
}

static bool awaits_end(const home *h)
{
    int32_t i;
    for (i = 0; i < h->part->plan->judges.count; i++) {
        if (h->part->judges[i].trigger < 0) {
            return true;
        }
    }
    return false;
}

/* Let time pass `end`, with inputs as they are. */
void home_come_to(home *h, int64_t end)
{
    run *one;
    int32_t i;
    if (is_apart(h)) {
        give_held(h, end);
        pass_all(h, end);
    } else {
        pass_time(h->root, end, false);
    }
    for (one = h->root; one != NULL; one = following(h, one)) {
        for (i = 0; i < h->part->plan->judges.count; i++) {
            pass_to(one, i, end);
        }
    }
}

/* End the trace. First judge all positions up to `end`; then the attempts triggered by the end; then let
 * time pass it, which closes windows that end there; only then settle undecided attempts by policy. */
void home_close(home *h, int64_t end, int64_t reached)
{
    run *one;
    int32_t i;
    home_come_to(h, end);
    if (!is_apart(h)) {
        end_watch(h->root, end, reached);
    }
    if (awaits_end(h)) {
        for (one = h->root; one != NULL; one = one->next) {
            begin_at_end(one, end);
        }
    }
    for (one = h->root; one != NULL; one = following(h, one)) {
        for (i = 0; i < h->part->plan->judges.count; i++) {
            reach_judge(one, i, reached);
        }
    }
    number_and_report(h);
    for (one = h->root; one != NULL; one = following(h, one)) {
        settle_all(one, end, reached);
    }
    margins_close(h, end, reached);
}

int64_t home_due(home *h)
{
    int64_t found = NEVER;
    run *one;
    for (one = h->root; one != NULL; one = following(h, one)) {
        found = least(found, next_decision(one));
    }
    return found;
}
