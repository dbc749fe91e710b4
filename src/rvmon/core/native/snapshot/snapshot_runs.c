/* A run in a snapshot: inputs, nodes, and the memory of past operators. */
#include "formulas/formulas.h"
#include "input/input.h"
#include "runs/runs.h"
#include "snapshot/snapshot.h"

static void carry_history(carrier *c, history *h)
{
    carry_number(c, &h->last);
    carry_number(c, &h->before);
    carry_instant(c, &h->at);
    carry_instant(c, &h->before_at);
    carry_int(c, &h->updates, 0, 3);
}

static void carry_signals(carrier *c, run *r)
{
    const part_plan *p = r->part->plan;
    int32_t i;
    for (i = 0; (i < p->signals.count) && !is_lost(c); i++) {
        const signal_plan *s = &r->part->signals[i];
        carry_number(c, &r->value[i]);
        carry_byte(c, &r->births[i], (uint8_t)s->births);
        carry_byte(c, &r->changed[i], IS_TRUE);
        if ((s->flags & SIGNAL_HISTORY) != 0) {
            carry_history(c, &r->history[i]);
        }
        if (c->reading && (s->births > 0) && (r->births[i] == s->births)) {
            r->at.births_left--;
        }
    }
}

/* The occurrences of an event with their payloads. */
static void carry_occurrences(carrier *c, run *r, int32_t event)
{
    occurrences *o = &r->payloads[event];
    const int32_t width = r->part->events[event].fields;
    int32_t count = o->count;
    int32_t i;
    int32_t k;
    carry_size(c, &count, MOST, 1);
    for (i = 0; (i < count) && !is_lost(c); i++) {
        bool known = !c->reading && (o->known[i] != 0U);
        carry_flag(c, &known);
        if (c->reading) {
            keep_payload(r, event, known, NULL);
        }
        for (k = 0; known && (k < width) && !is_lost(c); k++) {
            carry_number(c, &o->fields[i * width + k]);
        }
    }
}

static void carry_events(carrier *c, run *r)
{
    int32_t i;
    for (i = 0; (i < r->part->plan->events.count) && !is_lost(c); i++) {
        carry_byte(c, &r->occurs[i], IS_TRUE);
        if ((r->part->events[i].flags & EVENT_FIELDS) != 0) {
            carry_occurrences(c, r, i);
        }
    }
}

/* The outage of a name. */
static void carry_loss(carrier *c, run *r, int32_t name)
{
    carry_byte(c, &r->lost[name], LOST_SINCE);
    r->at.lost_count += (c->reading && (r->lost[name] != NOT_LOST)) ? 1 : 0;
    if ((r->lost[name] == LOST_ON) || (r->lost[name] == LOST_UNTIL)) {
        carry_instant(c, &r->until[name]);
    }
    if (r->lost[name] == LOST_UNTIL) {
        carry_byte(c, &r->keeps[name], 1);
        carry_byte(c, &r->has_kept[name], 1);
        if (r->has_kept[name] != 0U) {
            carry_number(c, &r->kept[name]);
        }
    }
}

static void carry_names(carrier *c, run *r)
{
    const int32_t signals = r->part->plan->signals.count;
    const int32_t names = signals + r->part->plan->events.count;
    int32_t i;
    for (i = 0; (i < names) && !is_lost(c); i++) {
        uint8_t absent = r->absent[i];
        carry_byte(c, &absent, 1);
        if (c->reading && (absent != 0U)) {
            mark_absent(r, i >= signals, (i >= signals) ? i - signals : i);
        }
        carry_byte(c, &r->updated[i], IS_TRUE);
        if (names_to_lose(r) > 0) {
            carry_loss(c, r, i);
        }
    }
    carry_signals(c, r);
    carry_events(c, r);
    carry_list(c, r->marks, &r->at.marks_count, names, r->marked);
}

static void carry_edge(carrier *c, edge *e)
{
    carry_long(c, &e->at, INT64_MIN, NEVER);
    carry_flag(c, &e->left);
    carry_flag(c, &e->right);
    carry_flag(c, &e->apart);
}

static void carry_stretches(carrier *c, stretches *s)
{
    int32_t count = s->count;
    int32_t i;
    carry_size(c, &count, MOST, 16);
    for (i = 0; (i < count) && !is_lost(c); i++) {
        stretch *one = stretch_slot(c->m, s, i, c->reading);
        if (one != NULL) {
            carry_long(c, &one->begin, INT64_MIN, NEVER);
            carry_long(c, &one->end, INT64_MIN, NEVER);
        }
    }
    carry_flag(c, &s->left);
    carry_flag(c, &s->right);
    carry_flag(c, &s->growing);
    carry_flag(c, &s->apart);
    carry_long(c, &s->total, -LIMIT, LIMIT);
    carry_long(c, &s->lost, 0, LIMIT);
    carry_long(c, &s->members, 0, LIMIT);
    if (c->reading) {
        s->known_slots = -1;
    }
}

static void carry_tally(carrier *c, tally *x)
{
    int32_t i;
    for (i = 0; i < TALLY_LIMBS; i++) {
        carry_count(c, &x->limb[i]);
    }
}

/* Demand that members of windows are in range and ascend, as sums of instants rely on that. */
static void demand_members(carrier *c, const run *r, const stretches *s)
{
    int64_t end = -LIMIT;
    int32_t i;
    for (i = 0; (i < s->count) && !is_lost(c); i++) {
        const stretch *one = &s->at[(s->head + i) & (s->room - 1)];
        demand(c, (one->begin >= end) && (one->begin < LIMIT) && (one->end >= one->begin - step_of(r))
                  && (one->end < LIMIT));
        end = one->end;
    }
    demand(c, !s->growing || (s->count > 0));
}

/* Demand that the two rings of a window have the same length. */
static void demand_windows(carrier *c, const run *r)
{
    int32_t i;
    for (i = 0; (i < r->part->plan->nodes.count) && !is_lost(c); i++) {
        const node_plan *n = &r->part->nodes[i];
        if (n->op == NODE_WINDOW) {
            const stretches *own = &r->past[2 * n->slot];
            demand_members(c, r, own);
            demand(c, own->count == own[1].count);
        }
    }
}

/* The memory of past operators, with a second reading only if it differs. */
static void carry_past(carrier *c, run *r)
{
    const part_plan *p = r->part->plan;
    int32_t i;
    carry_bytes(c, r->seen, p->seen, IS_TRUE);
    for (i = 0; (i < p->edges) && !is_lost(c); i++) {
        carry_edge(c, &r->edges[2 * i]);
        if (r->edges[2 * i].apart) {
            carry_edge(c, &r->edges[2 * i + 1]);
        }
    }
    for (i = 0; (i < p->sums) && !is_lost(c); i++) {
        carry_tally(c, &r->tallies[i]);
    }
    for (i = 0; (i < p->amounts) && !is_lost(c); i++) {
        carry_number(c, &r->amounts[i]);
    }
    for (i = 0; (i < p->stretches) && !is_lost(c); i++) {
        carry_stretches(c, &r->past[2 * i]);
        if (r->past[2 * i].apart) {
            carry_stretches(c, &r->past[2 * i + 1]);
        }
    }
    demand_windows(c, r);
}

/* The nodes to be evaluated, as bits; none beyond the last node. */
static void carry_dirt(carrier *c, run *r)
{
    const int32_t nodes = r->part->plan->nodes.count;
    int32_t word;
    for (word = 0; (word < (nodes + 63) / 64) && !is_lost(c); word++) {
        const int32_t left = nodes - 64 * word;
        carry_word(c, &r->dirty[word]);
        demand(c, (left >= 64) || ((r->dirty[word] >> left) == 0U));
        if (c->reading && (r->dirty[word] != 0U)) {
            r->dirty_words[word >> 6] |= UINT64_C(1) << (word & 63);
        }
    }
}

static void carry_nodes(carrier *c, run *r)
{
    const part_plan *p = r->part->plan;
    carry_bytes(c, r->truth, p->nodes.count, IS_TRUE);
    carry_bytes(c, r->atom, p->atoms.count, IS_TRUE);
    carry_list(c, r->fading, &r->at.fading_count, p->atoms.count, r->is_fading);
    carry_list(c, r->fresh, &r->at.fresh_count, p->atoms.count, r->is_fresh);
    carry_dirt(c, r);
    carry_past(c, r);
    carry_timers(c, &r->wake, p->timers + p->perishable, NULL);
}

/* Whether the clock of a run is consistent: sums of instants stay in 64 bits, no pending position is
 * before the current one (or passing time would go backwards or loop), and the outage states fit the time
 * model. */
static bool is_in_time(const run *r)
{
    const int64_t gap = GAP(r);
    const bool later = (r->at.awaited > r->at.position)
                       && ((r->at.ends_at > r->at.position) || (r->at.presence != ARE_THERE));
    int32_t i;
    if (r->at.dense ? (gap > 0) || !r->at.started : (r->at.presence == MAY_BE_THERE) && (gap == 0)) {
        return false;
    }
    if (r->at.started && (r->at.presence == ARE_THERE) && !r->at.dense && (r->at.sure_from == NEVER)) {
        return false;
    }
    if ((r->at.presence == ARE_THERE_NEXT) && !r->at.started) {
        return false;
    }
    for (i = 0; i < r->wake.count; i++) {
        const int64_t due = r->wake.due[r->wake.ids[i]];
        if ((r->at.position < 0) && (due > NEVER - step_of(r) + r->at.position)) {
            return false;
        }
    }
    return (gap == 0) || !r->at.started || later;
}

static void carry_progress(carrier *c, run *r)
{
    carry_instant(c, &r->at.origin);
    carry_instant(c, &r->at.dense_from);
    carry_instant_or(c, &r->at.sure_from, NEVER);
    carry_instant(c, &r->at.position);
    carry_long(c, &r->at.before, -NEVER, LIMIT);
    carry_long(c, &r->at.alarm, -LIMIT, NEVER);
    carry_long(c, &r->at.after, -LIMIT, LIMIT);
    carry_long(c, &r->at.awaited, -LIMIT, NEVER);
    carry_long(c, &r->at.ends_at, -LIMIT, NEVER);
    carry_int(c, &r->at.undetermined_left, -MOST / 2, MOST);
    carry_int(c, &r->at.phase, 0, 2);
    carry_flag(c, &r->at.started);
    carry_byte(c, &r->at.starting, IS_TRUE);
    carry_byte(c, &r->at.presence, ARE_THERE_NEXT);
    carry_flag(c, &r->at.dense);
    carry_flag(c, &r->at.gathered);
    carry_flag(c, &r->at.dirty);
    if ((r->part->plan->captured > 0) || r->part->is_watched) {
        carry_flag(c, &r->stays_busy);
    }
}

/* The fields of a run whose part captures values. */
static void carry_own(carrier *c, run *r)
{
    carry_long(c, &r->opens_at, -LIMIT, NEVER);
    carry_instant_or(c, &r->cut, NEVER);
    carry_instant_or(c, &r->occurred, NEVER);
    carry_count(c, &r->rank);
    carry_flag(c, &r->opening);
    carry_flag(c, &r->over);
    carry_flag(c, &r->watched);
    carry_flag(c, &r->blurs);
}

void carry_run(carrier *c, run *r)
{
    if (r->part->plan->captured > 0) {
        carry_own(c, r);
    }
    carry_progress(c, r);
    carry_names(c, r);
    carry_nodes(c, r);
    demand(c, c->m->finished || is_in_time(r));
    if (c->reading && !is_lost(c)) {
        clear_judges(r); /* letters are sums over the nodes that were read */
    }
    if (r->truth_log != NULL) {
        carry_truth_log(c, r);
    }
    carry_judges(c, r);
}
