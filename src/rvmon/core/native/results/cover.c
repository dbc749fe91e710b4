/* Coverage: hits of the items of coverpoints and crosses. Only certain hits count.
 *
 * A group with an occasion samples its bins where an attempt `upon` that occasion would start. Any other
 * group samples at every position: an item with a pulse among its bins is hit at each position at which
 * it is true, any other item once per stretch on which it is true. A position at which the item is
 * unknown does not end the stretch, since it may have been true. An item is true if all its bins are.
 *
 * Work is done only where a watch changed or a pulse is true (call_watch), and only for the groups of
 * that watch. */
#include "results/results.h"

#include <string.h>

/* The number of words that hold one bit per watch. */
static int32_t words_of(const part_plan *p)
{
    return (p->watches.count + 63) / 64;
}

/* Allocate coverage for a part; false: memory is short. */
static bool make_covering(home *h)
{
    const part_plan *p = h->part->plan;
    arena *a = &h->monitor->memory;
    covering *c = arena_take(a, sizeof *c);
    int32_t most = 0;
    int32_t i;
    int32_t k;
    if (c == NULL) {
        return false;
    }
    for (i = 0; i < p->groups.count; i++) {
        const group_plan *g = &h->part->groups[i];
        const int32_t *axes = LIST(&h->monitor->plan, g->axes);
        int32_t items = 1;
        int32_t bins = 0;
        for (k = 0; k < g->axes.count; k += 2) {
            items *= axes[k + 1];
            bins += axes[k + 1];
        }
        c->items += items;
        most = (bins > most) ? bins : most;
    }
    c->hits = arena_take(a, (size_t)(c->items + 1) * sizeof *c->hits);
    c->current_items = arena_take(a, (size_t)(c->items + 1) * sizeof *c->current_items);
    c->is_current = arena_take(a, (size_t)c->items + 1);
    c->groups = arena_take(a, (size_t)(p->groups.count + 1) * sizeof *c->groups);
    c->groups_called = arena_take(a, (size_t)(p->groups.count + 1) * sizeof *c->groups_called);
    c->called = arena_take(a, (size_t)p->watches.count * sizeof *c->called);
    c->is_called = arena_take(a, (size_t)p->watches.count);
    c->true_bits = arena_take(a, (size_t)words_of(p) * sizeof *c->true_bits);
    c->bins = arena_take(a, (size_t)(most + 1) * sizeof *c->bins);
    if ((c->hits == NULL) || (c->current_items == NULL) || (c->is_current == NULL) || (c->groups == NULL)
        || (c->groups_called == NULL) || (c->called == NULL) || (c->is_called == NULL)
        || (c->true_bits == NULL) || (c->bins == NULL)) {
        return false;
    }
    h->covering = c;
    return true;
}

/* Reset coverage for a new run; false: memory is short. */
bool begin_cover(home *h)
{
    const part_plan *p = h->part->plan;
    covering *c;
    if ((h->covering == NULL) && !make_covering(h)) {
        return false;
    }
    c = h->covering;
    (void)memset(c->hits, 0, (size_t)c->items * sizeof *c->hits);
    (void)memset(c->is_current, 0, (size_t)c->items);
    (void)memset(c->groups, 0, (size_t)p->groups.count * sizeof *c->groups);
    (void)memset(c->is_called, 0, (size_t)p->watches.count);
    (void)memset(c->true_bits, 0, (size_t)words_of(p) * sizeof *c->true_bits);
    c->called_count = 0;
    return true;
}

/* Mark the groups of a watch to evaluate the current position. */
void call_watch(run *r, int32_t number)
{
    covering *c = r->home->covering;
    if (c->is_called[number] == 0U) {
        c->is_called[number] = 1;
        c->called[c->called_count] = number;
        c->called_count++;
    }
}

void call_watches(run *r)
{
    int32_t i;
    for (i = 0; i < r->part->plan->watches.count; i++) {
        call_watch(r, i);
    }
}

static uint8_t truth_of(const run *r, int32_t number)
{
    return r->truth[r->part->watches[number].node];
}

/* Store whether a watch is true. */
static void keep_truth(run *r, int32_t number)
{
    const uint64_t bit = UINT64_C(1) << (number & 63);
    uint64_t *word = &r->home->covering->true_bits[number >> 6];
    *word = (truth_of(r, number) == IS_TRUE) ? (*word | bit) : (*word & ~bit);
}

/* The same for all watches, after a snapshot was read, which has the truths of nodes. */
void keep_truths_of_watches(run *r)
{
    int32_t i;
    for (i = 0; i < r->part->plan->watches.count; i++) {
        keep_truth(r, i);
    }
}

/* Collect the bins of an axis whose bit is set, from a place of `bins` on; returns the place after. */
static int32_t collect_bins(covering *c, const uint64_t *bits, int32_t first, int32_t count, int32_t used)
{
    const int32_t end = first + count;
    int32_t place = used;
    int32_t word;
    for (word = first >> 6; (word << 6) < end; word++) {
        uint64_t left = bits[word];
        for (; left != 0U; left &= left - 1) {
            const int32_t number = (word << 6) + lowest_bit(left);
            if ((number >= first) && (number < end)) {
                c->bins[place] = number - first;
                place++;
            }
        }
    }
    return place;
}

/* The first combination of bins whose bits, by watch, are set; false: some axis has none. */
bool first_combination(const run *r, const group_plan *g, const uint64_t *bits, combinations *o)
{
    const int32_t *axes = LIST(PLAN(r), g->axes);
    int32_t used = 0;
    for (o->count = 0; 2 * o->count < g->axes.count; o->count++) {
        const int32_t k = o->count;
        o->begin[k] = used;
        o->at[k] = used;
        used = collect_bins(r->home->covering, bits, axes[2 * k], axes[2 * k + 1], used);
        o->end[k] = used;
        if (o->begin[k] == used) {
            return false;
        }
    }
    return true;
}

/* Whether no bin of an item is false. The bins are digits of the item's number, the last axis the
 * lowest. */
static bool may_be_true(const run *r, const group_plan *g, int32_t item)
{
    const int32_t *axes = LIST(PLAN(r), g->axes);
    int32_t rest = item - g->first;
    int32_t i;
    for (i = g->axes.count - 2; i >= 0; i -= 2) {
        if (truth_of(r, axes[i] + rest % axes[i + 1]) == IS_FALSE) {
            return false;
        }
        rest /= axes[i + 1];
    }
    return true;
}

/* Start a stretch of an item. */
void make_current(covering *c, const group_plan *g, covered *s, int32_t item)
{
    c->is_current[item] = 1;
    c->current_items[g->first + s->current] = item;
    s->current++;
}

/* Count an item that is true, unless it is current, that is, was already counted in this stretch. Pulses
 * do not become current. */
static void count_item(covering *c, const group_plan *g, covered *s, int32_t item, bool passes, int64_t t)
{
    if (c->is_current[item] == 0U) {
        rv_hit *hit = &c->hits[item];
        hit->first = (hit->count == 0) ? t : hit->first;
        hit->count++;
        if (!passes && (g->occasion < 0)) {
            make_current(c, g, s, item);
        }
    }
}

/* Go to the next combination, like an odometer; false: there are no more. */
bool next_combination(combinations *o)
{
    int32_t k;
    for (k = o->count - 1; (k >= 0) && (o->at[k] + 1 == o->end[k]); k--) {
        o->at[k] = o->begin[k];
    }
    if (k >= 0) {
        o->at[k]++;
    }
    return k >= 0;
}

/* The number of the item of a combination. */
int32_t item_of(const run *r, const group_plan *g, const combinations *o)
{
    const int32_t *axes = LIST(PLAN(r), g->axes);
    int32_t item = 0;
    int32_t k;
    for (k = 0; k < o->count; k++) {
        item = item * axes[2 * k + 1] + r->home->covering->bins[o->at[k]];
    }
    return g->first + item;
}

/* Whether one of the bins of a combination is a pulse. */
static bool has_pulse(const run *r, const group_plan *g, const combinations *o)
{
    const int32_t *axes = LIST(PLAN(r), g->axes);
    int32_t k;
    for (k = 0; k < o->count; k++) {
        if (r->part->watches[axes[2 * k] + r->home->covering->bins[o->at[k]]].is_pulse != 0) {
            return true;
        }
    }
    return false;
}

/* Count the items that are true: the combinations of the true bins of each axis. */
static void count_items(run *r, const group_plan *g, covered *s, int64_t t)
{
    covering *c = r->home->covering;
    combinations o;
    bool more = first_combination(r, g, c->true_bits, &o);
    while (more) {
        count_item(c, g, s, item_of(r, g, &o), has_pulse(r, g, &o), t);
        more = next_combination(&o);
    }
}

/* Items that became false are no longer current. */
static void drop_items(run *r, const group_plan *g, covered *s)
{
    covering *c = r->home->covering;
    int32_t *items = &c->current_items[g->first];
    int32_t kept = 0;
    int32_t i;
    for (i = 0; i < s->current; i++) {
        if (may_be_true(r, g, items[i])) {
            items[kept] = items[i];
            kept++;
        } else {
            c->is_current[items[i]] = 0;
        }
    }
    s->current = kept;
}

static void look_at_group(run *r, int32_t number, int64_t t)
{
    const group_plan *g = &r->part->groups[number];
    covered *s = &r->home->covering->groups[number];
    bool looks = true;
    if (g->occasion >= 0) {
        const bool pulse = r->part->watches[g->occasion].is_pulse != 0;
        const uint8_t truth = truth_of(r, g->occasion);
        looks = (truth == IS_TRUE) && (pulse || (s->before == IS_FALSE));
        s->before = truth;
    } else {
        drop_items(r, g, s);
    }
    if (looks) {
        count_items(r, g, s, t);
    }
}

/* Evaluate the groups whose watches changed at `t`; pulses that are true have to be looked at again at
 * the next position. */
void cover(run *r, int64_t t)
{
    covering *c = r->home->covering;
    int32_t groups = 0;
    int32_t kept = 0;
    int32_t i;
    int32_t k;
    for (i = 0; i < c->called_count; i++) {
        const watch_plan *w = &r->part->watches[c->called[i]];
        const int32_t *own = LIST(PLAN(r), w->groups);
        keep_truth(r, c->called[i]);
        for (k = 0; k < w->groups.count; k++) {
            if (!c->groups[own[k]].called) {
                c->groups[own[k]].called = true;
                c->groups_called[groups] = own[k];
                groups++;
            }
        }
    }
    for (i = 0; i < groups; i++) {
        c->groups[c->groups_called[i]].called = false;
        look_at_group(r, c->groups_called[i], t);
    }
    for (i = 0; i < c->called_count; i++) {
        const int32_t number = c->called[i];
        const bool continues = (r->part->watches[number].is_pulse != 0) && (truth_of(r, number) == IS_TRUE);
        c->is_called[number] = continues ? 1 : 0;
        c->called[kept] = number;
        kept += continues ? 1 : 0;
    }
    c->called_count = kept;
}

const rv_hit *rv_hits(const rv_monitor *m, int32_t *items)
{
    const covering *c = (m->plan.part_count > 0) ? m->homes[0].covering : NULL;
    *items = (c == NULL) ? 0 : c->items;
    return (c == NULL) ? NULL : c->hits;
}
