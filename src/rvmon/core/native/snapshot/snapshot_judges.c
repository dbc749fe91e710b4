/* Judges in a snapshot: open attempts, queues, networks and chains. */
#include "attempts/attempts.h"
#include "snapshot/snapshot.h"
#include "windows/windows.h"

#include <string.h>

/* The automaton of a judge; NULL: it has none. */
static const automaton_plan *automaton_of(const run *r, int32_t index)
{
    const int32_t number = r->part->judges[index].automaton;
    return (number >= 0) ? &PLAN(r)->automata[number] : NULL;
}

/* The clocks of one reading of an attempt, as many as its location has; with a network, its
 * position. */
static void carry_clocks(carrier *c, const run *r, int32_t index, int32_t location, int64_t *clocks)
{
    const bool by_automaton = automaton_of(r, index) != NULL;
    const int32_t width = by_automaton ? r->part->machines[index].widths[location] : 1;
    const int64_t step = by_automaton ? 1 : step_of(r);
    int32_t i;
    for (i = 0; i < width; i++) {
        carry_long(c, &clocks[i], floored(1 - LIMIT, step), floored(LIMIT - 1, step));
    }
}

static void carry_attempt(carrier *c, run *r, int32_t index, int32_t at)
{
    judge *j = &r->judges[index];
    attempt *x = attempt_at(r->home, at);
    const automaton_plan *a = automaton_of(r, index);
    const int32_t locations = (a != NULL) ? a->locations : WAITING + 1;
    bool current = is_current(r, index, at);
    carry_instant(c, &x->triggered);
    carry_long(c, &x->due, -LIMIT, NEVER);
    carry_count(c, &x->number);
    carry_int(c, &x->location, 0, locations);
    carry_int(c, &x->better, 0, locations);
    carry_flag(c, &x->parted);
    carry_flag(c, &x->sure);
    carry_flag(c, &x->trigger_unknown);
    carry_flag(c, &x->cannot_pass);
    carry_instant_or(c, &x->doubted_at, RV_NO_TIME);
    carry_flag(c, &current);
    if (c->refused) {
        return;
    }
    carry_clocks(c, r, index, x->location, x->clocks);
    if (x->parted && (a != NULL)) {
        carry_clocks(c, r, index, x->better, x->clocks + r->part->plan->clocks);
    }
    if (r->part->plan->captured > 0) {
        carry_count(c, &r->home->captured_attempts[at].doubt_number);
    }
    if (c->reading && current) {
        demand(c, (j->current < 0) && runs_on(r, index));
        j->current = at;
    }
}

/* A new attempt after `last` in a list; -1: memory is short. */
static int32_t appended(run *r, int32_t *first, int32_t last)
{
    const int32_t at = new_attempt(r);
    if (at >= 0) {
        (void)memset(attempt_at(r->home, at), 0, r->home->stride);
        attempt_at(r->home, at)->next = -1;
        if (r->part->plan->captured > 0) {
            (void)memset(&r->home->captured_attempts[at], 0, sizeof *r->home->captured_attempts);
            r->home->captured_attempts[at].judge = r;
        }
        if (last < 0) {
            *first = at;
        } else {
            attempt_at(r->home, last)->next = at;
        }
    }
    return at;
}

/* A list of attempts; returns the last one. 34 is less than the number of bytes of any attempt. */
static int32_t carry_attempts(carrier *c, run *r, int32_t index, int32_t *first)
{
    int32_t count = 0;
    int32_t last = -1;
    int32_t at;
    int32_t i;
    for (at = c->reading ? -1 : *first; at >= 0; at = attempt_at(r->home, at)->next) {
        count++;
    }
    carry_size(c, &count, MOST, 34);
    at = *first;
    for (i = 0; (i < count) && !is_lost(c); i++) {
        at = c->reading ? appended(r, first, last) : at;
        if (at >= 0) {
            carry_attempt(c, r, index, at);
            last = at;
            at = attempt_at(r->home, at)->next;
        }
    }
    return last;
}

static void carry_counts(carrier *c, judge *j)
{
    carry_count(c, &j->count);
    carry_count(c, &j->doubts);
    carry_count(c, &j->passed);
    carry_count(c, &j->failed);
    carry_count(c, &j->inconclusive);
}

/* Whether `wanted` is in the list of undecidable attempts. */
static bool is_undecidable_listed(const run *r, int32_t index, int32_t wanted)
{
    int32_t at = r->judges[index].undecidable;
    while ((at >= 0) && (at != wanted)) {
        at = attempt_at(r->home, at)->next;
    }
    return at >= 0;
}

/* Whether a judge that was read can continue without reading a missing structure or looping: its timer
 * lies ahead, and attempts are in the structure of its engine. */
static bool is_driven(const run *r, int32_t index)
{
    const judge *j = &r->judges[index];
    const int64_t due = r->rules.due[index];
    const bool blank = (r->at.presence != ARE_THERE) && (GAP(r) > 0);
    if (blank && (j->current >= 0) && !is_undecidable_listed(r, index, j->current)) {
        return false;
    }
    if (is_chained(r, index) && (j->first >= 0) && (j->chain == NULL)) {
        return false;
    }
    if ((j->first >= 0) && !queue_is_empty(j)) {
        return false;
    }
    if ((due < LIMIT) && (j->lag >= due + LIMIT)) {
        return false;
    }
    return (GAP(r) == 0) || (automaton_of(r, index) == NULL) || !has_attempts(j) || (due > j->position);
}

static void carry_judge(carrier *c, run *r, int32_t index)
{
    judge *j = &r->judges[index];
    const automaton_plan *a = automaton_of(r, index);
    const int32_t classes = (a != NULL) ? a->classes : 1;
    bool in_queue;
    carry_long(c, &j->position, -LIMIT, LIMIT - 1);
    carry_long(c, &j->lag, 0, NEVER);
    carry_instant_or(c, &j->failed_at, NEVER);
    carry_int(c, &j->letter, 0, classes);
    carry_int(c, &j->other, 0, classes);
    carry_counts(c, j);
    carry_byte(c, &j->before, IS_TRUE);
    carry_flag(c, &j->running);
    carry_flag(c, &j->restless);
    carry_flag(c, &j->slides);
    carry_flag(c, &j->sorted);
    carry_flag(c, &j->blind);
    j->last = carry_attempts(c, r, index, &j->first);
    (void)carry_attempts(c, r, index, &j->undecidable);
    in_queue = !queue_is_empty(j);
    carry_flag(c, &in_queue);
    demand(c, !in_queue || has_queue(r, index)); /* a monitor in one block has no queues */
    if (in_queue && !is_lost(c)) {
        carry_queue(c, r, index);
    }
    if (is_chained(r, index)) {
        carry_chain(c, r, index);
    } else if (is_networked(r, index)) {
        const form f = form_of(r, index);
        carry_networks(c, &f, &j->net);
    } else {
        /* An automaton has no more state. */
    }
    if (j->noting != NULL) {
        carry_noting(c, r, index);
    }
    if (c->reading && !is_lost(c)) {
        demand(c, c->m->finished || is_driven(r, index));
    }
}

/* The lists of judges that look at the next position. */
static void carry_calls(carrier *c, run *r)
{
    const int32_t judges = r->part->plan->judges.count;
    /* In an outage no pulse repeats. */
    const bool repeats = (r->at.presence == ARE_THERE) && !r->at.dense;
    int32_t none = 0;
    int32_t i;
    carry_list(c, r->touched, &r->touched_count, judges, NULL);
    for (i = 0; (i < r->touched_count) && !is_lost(c); i++) {
        judge *j = &r->judges[r->touched[i]];
        carry_byte(c, &j->touched, TOUCHED_LETTER | TOUCHED_TRIGGER);
        demand(c, j->touched != 0U);
    }
    carry_list(c, r->restless, &r->restless_count, judges, NULL);
    for (i = 0; i < r->restless_count; i++) {
        r->judges[r->restless[i]].is_restless_listed = true;
    }
    carry_list(c, r->failing, &r->failing_count, judges, NULL);
    for (i = 0; i < r->failing_count; i++) {
        r->judges[r->failing[i]].is_failing_listed = true;
    }
    carry_list(c, r->repeating, repeats ? &r->repeating_count : &none, repeats ? judges : 0, NULL);
}

void carry_judges(carrier *c, run *r)
{
    int32_t i;
    carry_timers(c, &r->rules, r->part->plan->judges.count, NULL);
    for (i = 0; (i < r->part->plan->judges.count) && !is_lost(c); i++) {
        carry_judge(c, r, i);
    }
    carry_calls(c, r);
}

/* Networks and chains. The ranges added by the last step are not stored, as no step is undone after the
 * call that made it. */

/* Ascending disjoint ranges that end at `most` at the latest. */
static void carry_ranges(carrier *c, ranges *x, int64_t most)
{
    int32_t count = x->end - x->first;
    int64_t before = -NEVER;
    int32_t i;
    carry_size(c, &count, MOST, 16);
    for (i = 0; (i < count) && !is_lost(c); i++) {
        range one = {0, 0};
        if (!c->reading) {
            one = x->at[x->first + i];
        }
        carry_long(c, &one.first, -LIMIT, LIMIT);
        carry_long(c, &one.last, one.first, most);
        demand(c, one.first > before);
        if (c->reading && !c->refused) {
            ranges_put(c->m, x, x->end, one.first, one.last);
        }
        before = one.last;
    }
}

/* Ascending instants of samples. */
static void carry_samples(carrier *c, ranges *x)
{
    int32_t count = x->end - x->first;
    int64_t before = -LIMIT;
    int32_t i;
    carry_size(c, &count, MOST, 8);
    for (i = 0; (i < count) && !is_lost(c); i++) {
        int64_t t = c->reading ? 0 : x->at[x->first + i].first;
        carry_instant(c, &t);
        demand(c, t > before);
        if (c->reading && !c->refused) {
            ranges_put(c->m, x, x->end, t, t);
        }
        before = t;
    }
}

/* What one reading of a network knows. In sampled time positions are sample numbers from 0, and the
 * instants of all samples from `oldest` on have to be there. */
static void carry_network(carrier *c, const form *f, network *w)
{
    const bool sparse = f->gap == 0;
    const int64_t low = sparse ? 0 : floored(1 - LIMIT, f->step);
    const int64_t high = floored(LIMIT - 1, f->step);
    int32_t i;
    int32_t value;
    carry_instant(c, &w->now);
    carry_long(c, &w->first, low, sparse ? 0 : high);
    carry_long(c, &w->last, w->first - 1, high);
    carry_long(c, &w->oldest, low, high);
    carry_samples(c, &w->samples);
    if (sparse) {
        demand(c, (int64_t)w->samples.end - w->samples.first == w->last - w->oldest + 1);
        demand(c, w->samples.end > w->samples.first);
    }
    for (i = 0; (i < f->form->operators.count) && !is_lost(c); i++) {
        operator_state *o = &w->nodes[i];
        carry_long(c, &o->base, sparse ? w->oldest : -LIMIT, LIMIT);
        for (value = 0; value < 2; value++) {
            carry_ranges(c, &o->known[value], sparse ? w->last : LIMIT);
        }
    }
    w->closed = c->reading ? NEVER : w->closed;
}

void carry_networks(carrier *c, const form *f, networks **own)
{
    networks *net = *own;
    bool started = (net != NULL) && net->started;
    int32_t i;
    carry_flag(c, &started);
    if (!started || c->refused) {
        return;
    }
    if (c->reading) {
        net = made_networks(f);
        *own = net;
        if (net == NULL) {
            return;
        }
        net->started = true;
    }
    carry_bytes(c, net->leaf, f->form->leaves, 3);
    carry_long(c, &net->searched, -LIMIT, LIMIT);
    carry_int(c, &net->visits, 0, MOST / 2);
    carry_flag(c, &net->parted);
    for (i = 0; (i < (net->parted ? 2 : 1)) && !is_lost(c); i++) {
        carry_network(c, f, &net->readings[i]);
    }
    demand(c, !net->parted || (net->readings[0].last == net->readings[1].last));
}

/* The ascending changes of a value. */
static void carry_changes(carrier *c, changes *x)
{
    int32_t count = x->count;
    int64_t before = -LIMIT;
    int32_t i;
    carry_flag(c, &x->initial);
    carry_size(c, &count, MOST, 8);
    for (i = 0; (i < count) && !is_lost(c); i++) {
        int64_t one = c->reading ? 0 : change_at(x, i);
        carry_long(c, &one, before, LIMIT);
        if (c->reading && !c->refused) {
            add_change(c->m, x, one);
        }
        before = one;
    }
}

void carry_chain(carrier *c, run *r, int32_t index)
{
    const chaining g = chaining_of(r, index);
    chain *own = g.c;
    bool started = (own != NULL) && own->started;
    int32_t i;
    int32_t level;
    carry_flag(c, &started);
    if (!started || c->refused) {
        return;
    }
    if (c->reading) {
        own = made_chain(&g);
        g.j->chain = own;
        if (own == NULL) {
            return;
        }
        own->started = true;
    }
    carry_bytes(c, own->letter, FOLLOWED, 3);
    carry_int(c, &own->kept, 0, MOST / 2);
    carry_flag(c, &own->parted);
    if (g.sparse) {
        carry_changes(c, &own->stamps);
        demand(c, own->stamps.count > 0);
    }
    for (i = 0; (i < (own->parted ? 2 : 1)) && !is_lost(c); i++) {
        chain_reading *w = &own->readings[i];
        for (level = 0; level <= g.depth; level++) {
            carry_changes(c, &w->levels[level]);
        }
        carry_changes(c, &w->ends);
        carry_changes(c, &w->excused);
        carry_long(c, &w->start, -LIMIT, LIMIT);
    }
}
