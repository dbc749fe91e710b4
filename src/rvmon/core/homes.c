/* All runs of a part: begun, given samples, taken through time, ended. */
#include "state.h"

#include <string.h>

/* The run behind another: those that attempts start in, then those of attempts. */
run *following(const home *h, const run *r)
{
    return ((r == h->last_root) && (r->next == NULL)) ? h->captured : r->next;
}

/* Let go of attempts and instances that are over. */
static void sweep(home *h)
{
    run *before = NULL;
    run *one = h->captured;
    while (one != NULL) {
        run *next = one->next;
        if (is_idle(one)) {
            one->parent->children--;
            if (before == NULL) {
                h->captured = next;
            } else {
                before->next = next;
            }
            set_aside(h, one);
        } else {
            before = one;
        }
        one = next;
    }
    h->last_captured = before;
    if ((h->part->plan->flags & PART_FORGETS) != 0) {
        close_instances(h);
    }
}

/* An instant before which nothing happens in a run, no sample being taken. */
static int64_t alarm_of(const run *r)
{
    return r->at.started ? r->at.alarm : ((GAP(r) > 1) ? r->at.awaited : NEVER);
}

static bool is_apart(const home *h)
{
    return h->part->plan->captured > 0;
}

/* Let time pass up to `limit`, in all as one. */
static void pass_all(home *h, int64_t limit)
{
    const int64_t gap = h->monitor->plan.header->gap;
    run *one;
    int64_t t = (gap > 0) ? h->alarm : limit;
    while (t <= limit) {
        for (one = h->root; one != NULL; one = following(h, one)) {
            if ((gap == 0) || (alarm_of(one) <= t)) {
                through(one, t, false);
            }
        }
        t = NEVER;
        for (one = h->root; (gap > 0) && (one != NULL); one = following(h, one)) {
            t = least(t, alarm_of(one));
        }
    }
}

/* End a call. */
static void rest_all(home *h)
{
    run *one;
    flush_turns(h);
    sweep(h);
    h->alarm = NEVER;
    for (one = h->root; one != NULL; one = following(h, one)) {
        h->alarm = least(h->alarm, alarm_of(one));
        one->touched_now = false;
    }
}

/* Put all runs aside but the root, which is as before the first sample. */
static void clear_home(home *h)
{
    const part_plan *p = h->part->plan;
    run *one = h->root->next;
    int32_t i;
    while (one != NULL) {
        run *next = one->next;
        set_aside(h, one);
        one = next;
    }
    one = h->captured;
    while (one != NULL) {
        run *next = one->next;
        set_aside(h, one);
        one = next;
    }
    h->captured = NULL;
    h->last_captured = NULL;
    h->last_root = h->root;
    h->used = 0;
    h->free_slot = -1;
    h->sure[0] = h->sure[1] = -1;
    h->doubtful[0] = h->doubtful[1] = -1;
    h->done[0] = h->done[1] = -1;
    h->count = h->doubts = h->passed = h->failed = h->inconclusive = 0;
    for (i = 0; i < h->past_count; i++) {
        if (h->past[i].fields != NULL) {
            arena_give(&h->monitor->memory, (void *)(uintptr_t)h->past[i].fields,
                       (size_t)h->part->events[h->past[i].local].fields * sizeof(rv_number));
        }
    }
    h->past_count = 0;
    h->inbox_count = 0;
    h->alarm = NEVER;
    h->previous = 0;
    one = h->root;
    one->next = NULL;
    one->opens_at = (p->each != 0) ? NEVER : -LIMIT;
    one->cut = NEVER;
    one->occurred = 0;
    one->rank = 0;
    one->key = -1;
    one->judged = 0;
    one->children = 0;
    one->starters = p->root_starters;
    one->judging = (p->captures.count > 0) ? 0 : p->root_starters;
    one->opening = false;
    one->over = false;
    one->watched = false;
    one->blurs = false;
    one->touched_now = false;
    one->doubted = p->each != 0;
    one->stays_busy = false;
    clear_run(one);
    for (i = 0; i < p->captured; i++) {
        (void)memset(&one->captured[i], 0, sizeof one->captured[i]);
    }
}

bool home_begin(home *h)
{
    const part_plan *p = h->part->plan;
    if (h->root == NULL) {
        h->stride = sizeof(attempt) + 2 * (size_t)p->clocks * sizeof(int64_t);
        h->root = new_run(h);
        if (h->root == NULL) {
            return false;
        }
        h->room = arena_take(&h->monitor->memory, (size_t)(p->captured + 1) * sizeof *h->room);
        if (h->room == NULL) {
            return false;
        }
    }
    clear_home(h);
    return (p->each == 0) || begin_keys(h);
}

/* Make room for so many open attempts, each with a run if it has values of its own. */
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
        set_aside(h, made);
    }
    return true;
}

void home_lack(home *h, bool event, int32_t local)
{
    lack(h->root, event, local);
    if (event && (h->part->plan->each != 0) && (local == h->part->plan->each_event)) {
        h->root->opens_at = -LIMIT; /* whatever occurs is unknown, from the first position on */
    }
}

/* Judge what the inbox has. */
void home_sample(home *h, int64_t t)
{
    const part_plan *p = h->part->plan;
    run *one;
    if (!is_apart(h)) {
        give(h->root, t, h->inbox, h->inbox_count);
        h->alarm = h->root->at.alarm;
    } else {
        pass_all(h, t - 1);
        if (p->each != 0) {
            open_instances(h, t);
        }
        if ((p->flags & PART_KEEPS_PAST) != 0) {
            keep_updates(h, t);
        }
        for (one = h->root; one != NULL; one = following(h, one)) {
            give(one, t, h->inbox, h->inbox_count);
        }
        rest_all(h);
    }
    h->inbox_count = 0;
}

void home_wait(home *h, int64_t t)
{
    run *one;
    if (!is_apart(h)) {
        through(h->root, t - 1, true);
        reach(h->root, t);
        set_alarm(h->root, next_position(h->root));
        h->alarm = h->root->at.alarm;
        return;
    }
    pass_all(h, t - 1);
    for (one = h->root; one != NULL; one = following(h, one)) {
        reach(one, t);
        set_alarm(one, next_position(one));
    }
    rest_all(h);
}

/* The last position of a run, to which it is taken for what is judged at the end. */
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
        r->at.position = r->home->monitor->last;
    }
}

/* Begin what is triggered by the end. */
static void begin_at_end(run *r, int64_t end)
{
    int32_t i;
    if (!r->at.started || (r->opens_at == NEVER)) {
        return;
    }
    come_to_end(r, end);
    /* A value that came after the last tick of a clock has not occurred at any. */
    if ((r->rank != 0U) && (r->occurred > r->at.position)) {
        return;
    }
    for (i = 0; i < r->part->plan->judges.count; i++) {
        if (r->part->judges[i].trigger < 0) {
            begin(r, i, r->at.position, end);
        }
    }
}

/* Whether some judge waits for the end. */
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

void home_close(home *h, int64_t end, int64_t reached)
{
    run *one;
    int32_t i;
    if (is_apart(h)) {
        pass_all(h, end);
    } else {
        through(h->root, end, false);
    }
    for (one = h->root; one != NULL; one = following(h, one)) {
        for (i = 0; i < h->part->plan->judges.count; i++) {
            pass_to(one, i, end);
        }
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
    flush_turns(h);
    for (one = h->root; one != NULL; one = following(h, one)) {
        settle_all(one, end, reached);
    }
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
