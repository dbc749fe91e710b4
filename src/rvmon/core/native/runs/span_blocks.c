/* Which runs a value concerns, in a part that captures values. There may be thousands of runs, and most
 * samples change no comparison in any of them, so runs form blocks by id: a value inside the common span
 * of a block is not compared with each of its spans. Nor is it stored in a run whose span it does not
 * leave, as nothing in that run could tell it from the value that the run holds. */
#include "input/input.h"
#include "runs/runs.h"

#include <math.h>

#define BLOCK_RUNS 32

static struct block_span *span_of_block(const home *h, int32_t block, int32_t local)
{
    return &h->common[(size_t)block * (size_t)h->part->plan->signals.count + (size_t)local];
}

/* Make room for the values and spans of signals of one more run. They are side by side, so that a sample
 * quickly finds the runs it concerns. False: memory is short. */
bool widen_values(home *h)
{
    rv_monitor *m = h->monitor;
    const size_t signals = (size_t)h->part->plan->signals.count;
    int32_t room = h->run_room;
    int32_t same = room;
    int32_t blocks = h->block_room;
    rv_number *values = enlarged(m, h->values, &room, (int64_t)room + 1, (signals + 1) * sizeof *values);
    span *spans = enlarged(m, h->spans, &same, (int64_t)same + 1, (signals + 1) * sizeof *spans);
    const int64_t wanted = (int64_t)room / BLOCK_RUNS + 1;
    struct block_span *found = enlarged(m, h->common, &h->block_room, wanted, (signals + 1) * sizeof *found);
    int32_t *known = enlarged(m, h->known_spans, &blocks, wanted, sizeof *known);
    int32_t i;
    h->values = (values != NULL) ? values : h->values;
    h->spans = (spans != NULL) ? spans : h->spans;
    h->common = (found != NULL) ? found : h->common;
    h->known_spans = (known != NULL) ? known : h->known_spans;
    for (i = 0; i < h->run_count; i++) {
        h->runs[i]->value = &h->values[(size_t)i * signals];
        h->runs[i]->spans = &h->spans[(size_t)i * signals];
    }
    return (values != NULL) && (spans != NULL) && (found != NULL) && (known != NULL);
}

/* Forget the common spans of a run's block: those of the run may change. */
void forget_spans(const run *r)
{
    home *h = r->home;
    const int32_t block = r->id / BLOCK_RUNS;
    int32_t local;
    if ((h->known_spans == NULL) || (h->known_spans[block] == 0)) {
        return;
    }
    for (local = 0; local < h->part->plan->signals.count; local++) {
        span_of_block(h, block, local)->known = false;
    }
    h->known_spans[block] = 0;
}

/* Call the runs of a block in which a value may change a comparison; learn the common span of the block. */
static int32_t called_in_block(home *h, int32_t count, int32_t block, int32_t local, const rv_number *value)
{
    const size_t signals = (size_t)h->part->plan->signals.count;
    const int32_t end = (int32_t)least((int64_t)(block + 1) * BLOCK_RUNS, h->run_count);
    struct block_span *common = span_of_block(h, block, local);
    int32_t found = count;
    int32_t i;
    common->within.low = -HUGE_VAL;
    common->within.high = HUGE_VAL;
    for (i = block * BLOCK_RUNS; i < end; i++) {
        const rv_number *held = &h->values[(size_t)i * signals + (size_t)local];
        const span *own = &h->spans[(size_t)i * signals + (size_t)local];
        if (h->runs[i]->is_spare) {
            continue; /* it judges nothing */
        }
        if (!stays_in_span(own, held, value)) {
            found = called_with(h, found, h->runs[i]);
        }
        common->within.low = (own->low > common->within.low) ? own->low : common->within.low;
        common->within.high = (own->high < common->within.high) ? own->high : common->within.high;
    }
    common->value = *value;
    h->known_spans[block] += common->known ? 0 : 1;
    common->known = true;
    return found;
}

/* Add the runs in which a value of a signal may change a comparison to `called`. */
int32_t called_by_value(home *h, int32_t count, int32_t local, const rv_number *value)
{
    int32_t found = count;
    int32_t block;
    for (block = 0; (int64_t)block * BLOCK_RUNS < h->run_count; block++) {
        const struct block_span *common = span_of_block(h, block, local);
        if (!common->known || !stays_in_span(&common->within, &common->value, value)) {
            found = called_in_block(h, found, block, local, value);
        }
    }
    return found;
}
