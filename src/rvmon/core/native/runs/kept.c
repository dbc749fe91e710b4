/* Stored samples, for two purposes. A run with captured values may have to replay everything from the
 * first sample, because its past operators depend on the values that it captured (PART_REPLAYS). And if
 * values are captured at the end of a trace with a clock, samples wait until the tick that sees them. */
#include "input/input.h"
#include "runs/runs.h"

#include <string.h>

/* Append an empty update to the stored ones; NULL: memory is short. */
past_update *keep_one(home *h, int64_t t)
{
    past_update *made = enlarged(h->monitor, h->past, &h->past_room, (int64_t)h->past_count + 1,
                              sizeof *made);
    if (made == NULL) {
        return NULL;
    }
    h->past = made;
    made = &h->past[h->past_count];
    (void)memset(made, 0, sizeof *made);
    made->t = t;
    made->local = -1;
    h->past_count++;
    return made;
}

/* Store the sample in the inbox, also one without updates: in sampled time it is a position. The last
 * update is marked, which delimits samples. */
void keep_updates(home *h, int64_t t)
{
    rv_monitor *m = h->monitor;
    past_update *made = NULL;
    int32_t i;
    if (h->inbox_count == 0) {
        made = keep_one(h, t);
    }
    for (i = 0; i < h->inbox_count; i++) {
        const incoming *in = &h->inbox[i];
        const rv_update *u = in->update;
        const int32_t fields = in->event ? h->part->events[in->local].fields : 0;
        made = keep_one(h, t);
        if (made == NULL) {
            return;
        }
        made->local = in->local;
        made->event = in->event;
        made->says = u->says;
        made->value = in->event ? UNKNOWN_NUMBER : number_given(u);
        if ((fields > 0) && (u->fields != NULL)) {
            const size_t size = (size_t)fields * sizeof *u->fields;
            rv_number *own = arena_take(&m->memory, size);
            if (own == NULL) {
                m->spoilt = true;
                return;
            }
            (void)memcpy(own, u->fields, size);
            made->fields = own;
        }
    }
    if (made != NULL) {
        made->last = true;
    }
}

/* Count the current sample as judged, and store it if runs may replay it. If samples wait for a tick, it
 * was stored before. */
void keep_given(home *h, int64_t t)
{
    if (holds_back(h)) {
        h->past_judged += (h->inbox_count > 0) ? h->inbox_count : 1; /* stored already */
    } else if ((h->part->plan->flags & PART_KEEPS_PAST) != 0) {
        keep_updates(h, t);
        h->past_judged = h->past_count;
    } else {
        /* No run replays it. */
    }
}

/* Replay all stored samples in a run with captured values, from the first on. Between samples time
 * passes as it did; outages, and stretches in which every tick may be a position, are replayed from the
 * markers stored with the samples. Runs read `previous` of the home as the previous sample, so it is
 * updated during the replay and then restored. */
void replay(run *r)
{
    home *h = r->home;
    const part_plan *p = r->part->plan;
    const int64_t previous = h->previous;
    int32_t first = 0;
    int32_t i;
    clear_run(r);
    r->over = false;
    for (i = 0; i < p->signals.count + p->events.count; i++) {
        if (has_no_source(h->root, i)) {
            declare_no_source(r, i >= p->signals.count, (i >= p->signals.count) ? i - p->signals.count : i);
        }
    }
    while (first < h->past_judged) {
        const int64_t t = h->past[first].t;
        if ((GAP(r) == 0) && r->at.started && !r->at.dense) {
            r->at.position = h->previous;
        }
        const bool loss = h->past[first].says > RV_SAYS_YES;
        const bool amid = r->at.dense;
        if (!amid) {
            approach(r, t);
        }
        if (!loss && !amid) {
            forget_last(r);
        }
        do {
            const past_update *one = &h->past[first];
            const rv_update update = {0, one->says, one->value, one->fields};
            const incoming in = {one->local, one->event, &update};
            if (one->says == SAYS_AHEAD) {
                await_blank_start(r, t);
            } else if (one->says == SAYS_DENSE) {
                run_begin_dense(r, t);
            } else if (one->says == SAYS_SPARSE) {
                run_end_dense(r, t);
            } else if (loss) {
                run_take_loss(r, t, &in, 1);
            } else if (r->at.dense) {
                run_take_amid(r, t, &in, (one->local >= 0) ? 1 : 0);
            } else if (one->local >= 0) {
                take_update(r, t, &in);
            } else {
                /* A sample without updates. */
            }
            first++;
        } while ((first < h->past_judged) && !h->past[first - 1].last);
        if (!loss && !amid) {
            arrive(r, t);
        }
        h->previous = (loss && (h->past[first - 1].says != SAYS_SPARSE)) ? h->previous : t;
    }
    h->previous = previous;
}

/* Samples that wait for the tick that sees them. With a clock (gap above 1) and values captured at the
 * end of the trace, only the samples up to the last tick count, not those after it. Such a part decides
 * nothing before the end, so the delay is not observable. */

/* Whether a part delays its samples: its first requirement is triggered by the end of the trace. */
bool holds_back(const home *h)
{
    const part *p = h->part;
    return (h->monitor->plan.header->gap > 1) && (p->plan->captures.count > 0)
           && (p->plan->judges.count > 0) && (p->judges[0].trigger < 0);
}

/* Drop the stored samples that were judged. */
void forget_given(home *h)
{
    const int32_t left = h->past_count - h->past_judged;
    int32_t i;
    for (i = 0; i < h->past_judged; i++) {
        if (h->past[i].fields != NULL) {
            arena_give(&h->monitor->memory, (void *)(uintptr_t)h->past[i].fields,
                       (size_t)h->part->events[h->past[i].local].fields * sizeof(rv_number));
        }
    }
    if ((h->past_judged > 0) && (left > 0)) {
        (void)memmove(h->past, &h->past[h->past_judged], (size_t)left * sizeof *h->past);
    }
    h->past_count = left;
    h->past_judged = 0;
}

/* Put the stored sample that begins at `first` back into the inbox, which was large enough when it
 * arrived; false: memory is short. */
static bool recall(home *h, int32_t first)
{
    int32_t count = 1;
    int32_t i;
    while ((first + count < h->past_count) && !h->past[first + count - 1].last) {
        count++;
    }
    if (h->held_room < count) {
        rv_update *made = enlarged(h->monitor, h->held, &h->held_room, count, sizeof *made);
        if (made == NULL) {
            return false;
        }
        h->held = made;
    }
    h->inbox_count = 0;
    for (i = 0; (i < count) && (h->past[first].local >= 0); i++) {
        const past_update *one = &h->past[first + i];
        h->held[i].name = 0; /* not used: `local` is the part's own number */
        h->held[i].says = one->says;
        h->held[i].value = one->value;
        h->held[i].fields = one->fields;
        h->inbox[i].local = one->local;
        h->inbox[i].event = one->event;
        h->inbox[i].update = &h->held[i];
        h->inbox_count++;
    }
    return true;
}

/* Judge the waiting samples before `end` if the tick that sees the last of them is not after
 * `limit`. */
static void give_until(home *h, int64_t limit, int32_t end)
{
    const int64_t gap = h->monitor->plan.header->gap;
    if ((end > h->past_judged) && (tick_from(gap, h->past[end - 1].t) <= limit)) {
        while ((h->past_judged < end) && recall(h, h->past_judged)) {
            const past_update *one = &h->past[h->past_judged];
            if (one->says > RV_SAYS_YES) {
                lose_inbox(h, one->t);
            } else {
                take_inbox(h, one->t);
            }
        }
        if ((h->part->plan->flags & PART_KEEPS_PAST) == 0) {
            forget_given(h);
        }
    }
    h->inbox_count = 0;
}

/* Judge the waiting samples whose tick is not after `limit`. */
void give_held(home *h, int64_t limit)
{
    if (holds_back(h)) {
        give_until(h, limit, h->past_count);
    }
}

/* Store the current sample until its tick. Waiting samples of earlier ticks are judged first, and this
 * one, too, if `t` is itself a tick. */
void hold_back(home *h, int64_t t)
{
    const int32_t before = h->past_count;
    keep_updates(h, t);
    if (!h->monitor->spoilt) {
        give_until(h, t - 1, before);
        give_until(h, t, h->past_count);
    }
}
