/* Samples that wait for the tick of a clock that sees them, where values are captured at the end: those
 * of the last tick, whatever came behind it.
 *
 * Such a part judges nothing before the end, so nobody hears of it late. */
#include "runs/runs.h"

#include <string.h>

/* Whether samples wait in a part. */
bool holds_back(const home *h)
{
    const part *p = h->part;
    return (h->monitor->plan.header->gap > 1) && (p->plan->captures.count > 0)
           && (p->plan->judges.count > 0) && (p->judges[0].trigger < 0);
}

/* Forget the samples that were judged. */
void forget_given(home *h)
{
    const int32_t left = h->past_count - h->given;
    int32_t i;
    for (i = 0; i < h->given; i++) {
        if (h->past[i].fields != NULL) {
            arena_give(&h->monitor->memory, (void *)(uintptr_t)h->past[i].fields,
                       (size_t)h->part->events[h->past[i].local].fields * sizeof(rv_number));
        }
    }
    if ((h->given > 0) && (left > 0)) {
        (void)memmove(h->past, &h->past[h->given], (size_t)left * sizeof *h->past);
    }
    h->past_count = left;
    h->given = 0;
}

/* Put a sample that was kept into the inbox, which has held it before; false: memory is short. */
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
        h->held[i].name = 0; /* the part has a number of its own for it */
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

/* Judge the samples that wait, which one tick sees, if that is not behind `limit`; but for those from
 * `end` on. */
static void give_until(home *h, int64_t limit, int32_t end)
{
    const int64_t gap = h->monitor->plan.header->gap;
    if ((end > h->given) && (tick_from(gap, h->past[end - 1].t) <= limit)) {
        while ((h->given < end) && recall(h, h->given)) {
            const past_update *one = &h->past[h->given];
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

/* Judge the samples of which the tick is not behind `limit`. */
void give_held(home *h, int64_t limit)
{
    if (holds_back(h)) {
        give_until(h, limit, h->past_count);
    }
}

/* Keep the sample at hand until its tick comes, which may be at once. */
void hold_back(home *h, int64_t t)
{
    const int32_t before = h->past_count;
    keep_updates(h, t);
    if (!h->monitor->spoilt) {
        give_until(h, t - 1, before);
        give_until(h, t, h->past_count);
    }
}
