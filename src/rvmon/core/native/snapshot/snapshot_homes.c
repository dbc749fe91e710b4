/* Parts in a snapshot: their runs, keys, stored samples, and coverage. */
#include "formulas/formulas.h"
#include "results/results.h"
#include "runs/runs.h"
#include "snapshot/snapshot.h"

#include <string.h>

/* A stored update. */
static void carry_kept(carrier *c, home *h, past_update *one)
{
    const part_plan *p = h->part->plan;
    int32_t fields;
    int32_t i;
    bool given = one->fields != NULL;
    carry_instant(c, &one->t);
    carry_flag(c, &one->event);
    carry_int(c, &one->local, -1, one->event ? p->events.count : p->signals.count);
    carry_int(c, &one->says, RV_SAYS_NO, SAYS_SPARSE + 1);
    carry_flag(c, &one->last);
    if (!one->event) {
        carry_number(c, &one->value);
    }
    carry_flag(c, &given);
    demand(c, (one->local >= 0) || (one->last && !given));
    demand(c, (one->local >= 0) || ((one->says != SAYS_LOST) && (one->says != SAYS_FOUND)));
    demand(c, !given || one->event);
    if (!given || is_lost(c)) {
        return;
    }
    fields = h->part->events[one->local].fields;
    if (c->reading) {
        one->fields = arena_take(&c->m->memory, (size_t)fields * sizeof *one->fields);
        c->m->spoilt = c->m->spoilt || (one->fields == NULL);
    }
    for (i = 0; (i < fields) && !is_lost(c); i++) {
        carry_number(c, (rv_number *)(uintptr_t)&one->fields[i]);
    }
}

/* Whether stored samples can be replayed: stamps ascend, outages start and end in turn, and an outage
 * before the first sample occurs only with a clock. `*longest` becomes the largest number of updates of
 * a sample, for which the inbox needs room. */
static bool is_in_turn(const home *h, int32_t *longest)
{
    const bool clocked = h->monitor->plan.header->gap > 0;
    int64_t before = -LIMIT;
    int32_t first = 0;
    bool dense = false;
    int32_t i;
    *longest = 0;
    for (i = 0; i < h->past_count; i++) {
        const past_update *one = &h->past[i];
        const bool begins = (i == 0) || h->past[i - 1].last;
        first = begins ? i : first;
        *longest = (i + 1 - first > *longest) ? i + 1 - first : *longest;
        if ((one->t < before) || ((one->local < 0) && !begins)
            || ((one->says == SAYS_AHEAD) && !clocked)
            || ((one->says == SAYS_DENSE) && (clocked || dense))
            || ((one->says == SAYS_SPARSE) && !dense)) {
            return false;
        }
        dense = (one->says == SAYS_DENSE) || (dense && (one->says != SAYS_SPARSE));
        before = one->t;
    }
    return true;
}

static void carry_past_updates(carrier *c, home *h)
{
    int32_t count = h->past_count;
    int32_t longest = 0;
    int32_t i;
    carry_size(c, &count, MOST, 18);
    for (i = 0; (i < count) && !is_lost(c); i++) {
        past_update *one = c->reading ? keep_one(h, 0) : &h->past[i];
        if (one != NULL) {
            carry_kept(c, h, one);
        }
    }
    carry_int(c, &h->past_judged, 0, (int64_t)count + 1);
    if (c->reading && !is_lost(c)) {
        demand(c, is_in_turn(h, &longest));
        h->inbox = enlarged(c->m, h->inbox, &h->inbox_room, longest, sizeof *h->inbox);
    }
}

/* The closed keys, the oldest first. */
static void carry_over(carrier *c, home *h)
{
    int32_t count = h->over_count;
    int32_t at = h->oldest;
    int32_t i;
    carry_size(c, &count, MOST, 13);
    for (i = 0; (i < count) && !is_lost(c); i++) {
        key one = {{RV_UNKNOWN, {0}}, 0, NULL, 0, -1, -1, -1};
        if (!c->reading) {
            one = h->keys[at];
            at = one.newer;
        }
        carry_number(c, &one.value);
        carry_instant(c, &one.occurred);
        carry_count(c, &one.rank);
        demand(c, one.value.kind != RV_UNKNOWN);
        if (c->reading && !is_lost(c)) {
            const int32_t made = restore_key(h, &one.value, one.occurred, one.rank);
            demand(c, made >= 0);
            if (made >= 0) {
                add_closed_key(h, made);
            }
        }
    }
}

/* A new run to read into; NULL: memory is short. */
static run *blank_run(home *h)
{
    run *made = new_run(h);
    if (made != NULL) {
        clear_run(made);
        made->cut = NEVER;
        made->key = -1;
    }
    return made;
}

static void carry_instance(carrier *c, home *h, run *r)
{
    const part_plan *p = h->part->plan;
    carry_number(c, &r->captured[0]);
    demand(c, r->captured[0].kind != RV_UNKNOWN);
    if (c->reading) {
        r->starters = p->instance_starters;
        r->judging = (p->captures.count > 0) ? 0 : p->instance_starters;
        enlist(r, false);
    }
    carry_run(c, r);
    if (c->reading && !is_lost(c)) {
        r->key = restore_key(h, &r->captured[0], r->occurred, r->rank);
        demand(c, r->key >= 0);
        if (r->key >= 0) {
            h->keys[r->key].open = r;
        }
    }
}

/* The run of an attempt; `parent` is the index of the run in which it was triggered. */
static void carry_child(carrier *c, home *h, run *r, int32_t parent)
{
    const part_plan *p = h->part->plan;
    int32_t i;
    carry_int(c, &r->judged, 0, p->judges.count);
    for (i = p->each; i < p->captured; i++) {
        carry_number(c, &r->captured[i]);
    }
    if (c->reading) {
        run *own = h->runs[parent];
        r->judging = 1 << r->judged;
        r->doubted = own->doubted;
        r->key = own->key;
        if (p->each != 0) {
            r->captured[0] = own->captured[0];
        }
        adopt(own, r);
        enlist(r, true);
    }
    carry_run(c, r);
    r->parent->watched_children += (c->reading && r->watched) ? 1 : 0;
}

/* Map run ids to the ids that they get when read back, in the order of writing. */
static void number_runs(home *h)
{
    int32_t number = 0;
    run *one;
    for (one = h->root; one != NULL; one = following(h, one)) {
        h->called[one->id] = number;
        number++;
    }
}

static int32_t length_of(const run *first)
{
    const run *one;
    int32_t count = 0;
    for (one = first; one != NULL; one = one->next) {
        count++;
    }
    return count;
}

static void carry_runs(carrier *c, home *h)
{
    const part_plan *p = h->part->plan;
    int32_t instances = c->reading ? 0 : length_of(h->root) - 1;
    int32_t children = c->reading ? 0 : length_of(h->captured);
    run *one = c->reading ? NULL : h->root->next;
    int32_t i;
    number_runs(h);
    carry_run(c, h->root);
    carry_size(c, &instances, (p->each != 0) ? MOST : 0, 9);
    for (i = 0; (i < instances) && !is_lost(c); i++) {
        one = c->reading ? blank_run(h) : one;
        if (one != NULL) {
            carry_instance(c, h, one);
            one = one->next;
        }
    }
    one = h->captured;
    carry_size(c, &children, (p->captures.count > 0) ? MOST : 0, 8);
    for (i = 0; (i < children) && !is_lost(c); i++) {
        int32_t parent = c->reading ? 0 : h->called[one->parent->id];
        carry_int(c, &parent, 0, (int64_t)instances + 1);
        one = c->reading ? blank_run(h) : one;
        if ((one != NULL) && !is_lost(c)) {
            carry_child(c, h, one, parent);
            one = one->next;
        }
    }
    if (!is_lost(c)) {
        carry_timers(c, &h->alarms, 1 + instances + children, h->called);
    }
}

/* Whether a part has done everything that was due by `reached`; else the core would catch up, over any
 * number of positions. */
static bool is_caught_up(const home *h)
{
    const rv_monitor *m = h->monitor;
    const run *one;
    for (one = h->root; one != NULL; one = following(h, one)) {
        if (one->at.dense != (m->dense_until != RV_NO_TIME)) {
            return false;
        }
        if (one->at.started && !one->at.dense && (m->plan.header->gap == 0)
            && (last_position(m) == RV_NO_TIME)) {
            return false;
        }
        if (one->at.started && (one->at.position > m->reached)) {
            return false;
        }
        if (!holds_back(h) && !one->at.dense /* samples during an outage do not advance it */
            && ((next_position(one) < m->reached) || (timers_next(&one->rules) < m->reached))) {
            return false;
        }
    }
    return true;
}

void carry_home(carrier *c, home *h)
{
    carry_long(c, &h->previous, RV_NO_TIME, LIMIT);
    carry_long(c, &h->alarm, -LIMIT, NEVER);
    carry_count(c, &h->count);
    carry_count(c, &h->doubts);
    carry_count(c, &h->passed);
    carry_count(c, &h->failed);
    carry_count(c, &h->inconclusive);
    if (h->part->plan->each != 0) {
        carry_over(c, h);
    }
    if (h->unknowns != NULL) {
        carry_unknowns(c, h);
    }
    carry_runs(c, h);
    carry_watch(c, h);
    carry_count(c, &h->last_rank);
    carry_past_updates(c, h);
    if (c->reading && !is_lost(c)) {
        const bool was_dense = (c->m->dense_until != RV_NO_TIME) || (c->m->dense_end != RV_NO_TIME);
        demand(c, c->m->finished || is_caught_up(h));
        c->m->spoilt = c->m->spoilt || (was_dense && !make_unknown_values(h));
    }
}

/* Staleness, coverage, truths over time and moves. */

/* A count and its first instant. */
static void carry_hit(carrier *c, int64_t *count, int64_t *first)
{
    carry_long(c, count, 0, LIMIT);
    if (*count > 0) {
        carry_instant(c, first);
    }
}

void carry_stale(carrier *c, rv_monitor *m)
{
    int32_t i;
    for (i = 0; (i < m->plan.header->signals) && !is_lost(c); i++) {
        carry_hit(c, &m->stale[i].count, &m->stale[i].first);
    }
}

/* The current items of a group, which have to belong to it. */
static void carry_group(carrier *c, home *h, int32_t number)
{
    covering *own = h->covering;
    const bool last = number == h->part->plan->groups.count - 1;
    const int32_t first = h->part->groups[number].first;
    const int32_t end = last ? own->items : h->part->groups[number + 1].first;
    covered *s = &own->groups[number];
    int32_t i;
    carry_byte(c, &s->before, IS_TRUE);
    carry_size(c, &s->current, (int64_t)end - first, 4);
    for (i = 0; (i < s->current) && !is_lost(c); i++) {
        int32_t *item = &own->current_items[first + i];
        carry_int(c, item, first, end);
        if (c->reading && !c->refused) {
            demand(c, own->is_current[*item] == 0U);
            own->is_current[*item] = 1;
        }
    }
}

static void carry_cover(carrier *c, home *h)
{
    covering *own = h->covering;
    const part_plan *p = h->part->plan;
    int32_t i;
    for (i = 0; (i < own->items) && !is_lost(c); i++) {
        carry_hit(c, &own->hits[i].count, &own->hits[i].first);
    }
    for (i = 0; (i < p->groups.count) && !is_lost(c); i++) {
        carry_group(c, h, i);
    }
    carry_list(c, own->called, &own->called_count, p->watches.count, own->is_called);
    if (c->reading) {
        keep_truths_of_watches(h->root);
    }
}

static void carry_moves(carrier *c, home *h)
{
    int32_t i;
    int32_t k;
    for (i = 0; i < h->part->plan->judges.count; i++) {
        const int32_t locations = (h->moves[i] != NULL) ? h->part->machines[i].locations : 0;
        for (k = 0; (k < locations * locations) && !is_lost(c); k++) {
            carry_hit(c, &h->moves[i][k].count, &h->moves[i][k].first);
        }
    }
}

void carry_watch(carrier *c, home *h)
{
    if (h->part->plan->truths >= 0) {
        const form f = form_at(h->root, h->part->plan->truths);
        carry_networks(c, &f, &h->truths);
        carry_flag(c, &h->is_blind);
    }
    if (h->covering != NULL) {
        carry_cover(c, h);
    }
    if (h->moves != NULL) {
        carry_moves(c, h);
    }
}
