/* `left S[low, high] right`, and triggers that unknown input may hide.
 *
 * STRETCH, with both bounds: if `right` holds at a position s, and `left` at every position since, the
 * operator holds on [s + low, s + high]. These stretches, merged, are kept in a ring; a position at which
 * `left` is false empties it. EDGE: with low 0 only the latest s matters, with high unbounded only the
 * earliest, so one instant is the state. A change of an operand costs amortised O(1); between changes
 * the timer wakes the node when a stretch starts or ends.
 *
 * From the first unknown operand on an operator has two states: [2 slot] takes the unknown for FALSE,
 * [2 slot + 1] for TRUE. The truth is the number of states that hold: FALSE 0, UNKNOWN 1, TRUE 2. */
#include "formulas/formulas.h"

#include <string.h>

/* The i-th oldest stretch; for `count`, the slot after the last one. */
static stretch *stretch_at(const stretches *s, int32_t i)
{
    return &s->at[(s->head + i) & (s->room - 1)];
}

/* Double a ring; the part that had wrapped around moves into the new half. False: memory is short. */
static bool make_room(rv_monitor *m, stretches *s)
{
    const int32_t was = s->room;
    stretch *made = widened(m, s->at, &s->room, (int64_t)was + 1, sizeof *made);
    if (made == NULL) {
        return false;
    }
    (void)memcpy(made + was, made, (size_t)s->head * sizeof *made);
    s->at = made;
    return true;
}

/* The i-th stretch; with `append` a new one at the end (`i`: the old count). NULL: memory is short. */
stretch *stretch_slot(rv_monitor *m, stretches *s, int32_t i, bool append)
{
    if (append) {
        if ((s->count == s->room) && !make_room(m, s)) {
            return NULL;
        }
        s->count++;
    }
    return stretch_at(s, i);
}

/* Append [begin, end], merged with the last stretch if no position lies between them. */
static void add_stretch(run *r, stretches *s, int64_t begin, int64_t end)
{
    if ((s->count > 0) && (begin - step_of(r) <= stretch_at(s, s->count - 1)->end)) {
        stretch_at(s, s->count - 1)->end = end;
    } else if ((s->count < s->room) || make_room(r->home->monitor, s)) {
        stretch_at(s, s->count)->begin = begin;
        stretch_at(s, s->count)->end = end;
        s->count++;
    } else {
        /* The run is spoilt. */
    }
}

/* Step one reading to the position at `t`, with its operands there; returns whether it holds.
 *
 * While `right` holds, the last stretch has no end (`growing`); it gets one at the step after. Where
 * `right` held but `left` did not, the stretch is added at the step after: only from there on does
 * `left` have to hold. */
static bool step_stretches(run *r, stretches *s, const node_plan *n, int64_t t, bool left,
                           bool right)
{
    const int64_t last = r->at.before;
    bool holds;
    if (s->growing && (s->count > 0)) {
        stretch_at(s, s->count - 1)->end = sum(last, n->high);
    }
    s->growing = false;
    if (!s->left && s->right) {
        add_stretch(r, s, sum(last, n->low), sum(last, n->high));
    }
    s->left = left;
    s->right = right;
    if (!left) {
        s->count = 0;
        holds = right && (n->low == 0);
    } else {
        if (right) {
            add_stretch(r, s, sum(t, n->low), NEVER);
            s->growing = true;
        }
        while ((s->count > 0) && (stretch_at(s, 0)->end < t)) {
            s->head = (s->head + 1) & (s->room - 1);
            s->count--;
        }
        holds = (s->count > 0) && (stretch_at(s, 0)->begin <= t);
    }
    return holds;
}

/* The first instant after `t` at which a stretch starts or is over. */
static int64_t next_stretch(const stretches *s, int64_t t)
{
    int64_t found = NEVER;
    if (s->count > 0) {
        const stretch *one = stretch_at(s, 0);
        found = (one->begin > t) ? one->begin : ((one->end == NEVER) ? NEVER : one->end + 1);
    }
    return found;
}

/* Copy the state of the first reading to the second, at the first unknown operand. */
void split_stretches(rv_monitor *m, stretches *worse, stretches *better)
{
    int32_t i;
    while (better->room < worse->room) {
        better->count = 0;
        if (!make_room(m, better)) {
            return;
        }
    }
    better->head = 0;
    better->count = worse->count;
    for (i = 0; i < worse->count; i++) {
        *stretch_at(better, i) = *stretch_at(worse, i);
    }
    better->left = worse->left;
    better->right = worse->right;
    better->growing = worse->growing;
    better->total = worse->total;
    worse->apart = true;
}

static uint8_t since_stretches(run *r, const node_plan *n, int64_t t, uint8_t left, uint8_t right)
{
    stretches *worse = &r->past[2 * n->slot];
    stretches *better = worse + 1;
    bool holds;
    bool may_hold;
    int64_t due;
    if (((left == IS_UNKNOWN) || (right == IS_UNKNOWN)) && !worse->apart) {
        split_stretches(r->home->monitor, worse, better);
    }
    holds = step_stretches(r, worse, n, t, left == IS_TRUE, right == IS_TRUE);
    due = next_stretch(worse, t);
    may_hold = holds;
    if (worse->apart) {
        may_hold = step_stretches(r, better, n, t, left != IS_FALSE, right != IS_FALSE);
        due = least(due, next_stretch(better, t));
    }
    timers_set(&r->wake, n->timer, due);
    return (uint8_t)((holds ? 1U : 0U) + (may_hold ? 1U : 0U)); /* what holds may hold */
}

/* Step one reading of an EDGE to `t`; `last` is the position before. With low 0, `at` is the last instant
 * at which it holds (INT64_MIN: none); without an upper bound, the first one (NEVER: none). `due` becomes
 * the next instant at which it changes although its operands stay. */
static bool step_edge(edge *e, const node_plan *n, int64_t t, int64_t last, bool left, bool right,
                      int64_t *due)
{
    bool holds;
    if (n->low == 0) {
        e->at = e->right ? sum(last, n->high) : (e->left ? e->at : INT64_MIN);
        e->at = left ? e->at : INT64_MIN;
        holds = right || (e->at >= t);
        *due = (holds && !right && (e->at < NEVER)) ? e->at + 1 : NEVER;
    } else {
        e->at = e->left ? e->at : (e->right ? sum(last, n->low) : NEVER);
        e->at = left ? (right ? least(e->at, sum(t, n->low)) : e->at) : NEVER;
        holds = e->at <= t;
        *due = (e->at > t) ? e->at : NEVER;
    }
    e->left = left;
    e->right = right;
    return holds;
}

static uint8_t since_edge(run *r, const node_plan *n, int64_t t, uint8_t left, uint8_t right)
{
    edge *worse = &r->edges[2 * n->slot];
    edge *better = worse + 1;
    bool holds;
    bool may_hold;
    int64_t due;
    int64_t other;
    if (((left == IS_UNKNOWN) || (right == IS_UNKNOWN)) && !worse->apart) {
        *better = *worse;
        worse->apart = true;
    }
    holds = step_edge(worse, n, t, r->at.before, left == IS_TRUE, right == IS_TRUE, &due);
    may_hold = holds;
    if (worse->apart) {
        may_hold = step_edge(better, n, t, r->at.before, left != IS_FALSE, right != IS_FALSE,
                             &other);
        due = least(due, other);
    }
    timers_set(&r->wake, n->timer, due);
    return (uint8_t)((holds ? 1U : 0U) + (may_hold ? 1U : 0U));
}

uint8_t node_since(run *r, const node_plan *n, int64_t t, uint8_t left, uint8_t right)
{
    return (n->op == NODE_EDGE) ? since_edge(r, n, t, left, right)
                                : since_stretches(r, n, t, left, right);
}

/* Whether two states are equal, so that everything decided from here on is the same. */
bool edges_agree(const edge *a, const edge *b)
{
    return (a->at == b->at) && (a->left == b->left) && (a->right == b->right)
           && (a->apart == b->apart);
}

bool stretches_agree(const stretches *a, const stretches *b)
{
    int32_t i;
    if ((a->count != b->count) || (a->left != b->left) || (a->right != b->right)
        || (a->growing != b->growing) || (a->apart != b->apart) || (a->total != b->total)
        || (a->lost != b->lost) || (a->members != b->members)) {
        return false;
    }
    for (i = 0; i < a->count; i++) {
        const stretch *one = &a->at[(a->head + i) & (a->room - 1)];
        const stretch *other = &b->at[(b->head + i) & (b->room - 1)];
        if ((one->begin != other->begin) || (one->end != other->end)) {
            return false;
        }
    }
    return true;
}

/* The truth of a DOUBT node. A stretch is where the trigger is not FALSE. UNKNOWN: an attempt may start
 * here, hidden by unknown input; TRUE: one may have started earlier in this stretch; FALSE: neither.
 *
 * before, now: the trigger at the last position and here; value: the node at the last position; pulse:
 * each position at which the trigger holds starts an attempt, otherwise only its edge does; every: the
 * run itself is in doubt, so that no trigger is sure. */
static uint8_t hidden_by(uint8_t before, uint8_t now, uint8_t value, bool pulse, bool every)
{
    const bool is_edge = every ? (before != IS_TRUE)
                               : ((before == IS_UNKNOWN)
                                  || ((now == IS_UNKNOWN) && (before == IS_FALSE)));
    uint8_t found = truth_if(value != IS_FALSE);
    if (now == IS_FALSE) {
        found = IS_FALSE;
    } else if (pulse ? (every || (now == IS_UNKNOWN)) : is_edge) {
        found = IS_UNKNOWN;
    } else {
        /* Nothing is hidden here. */
    }
    return found;
}

uint8_t node_doubt(run *r, const node_plan *n, int32_t place, int64_t t, uint8_t now)
{
    const bool pulse = n->a != 0;
    const bool every = n->b != 0;
    const uint8_t was = (t == r->at.origin) ? IS_FALSE : r->truth[place];
    const uint8_t found = hidden_by(r->seen[n->slot], now, was, pulse, every);
    const bool moves = hidden_by(now, now, found, pulse, every) != found;
    timers_set(&r->wake, n->timer, moves ? t + step_of(r) : NEVER);
    r->seen[n->slot] = now;
    return found;
}
