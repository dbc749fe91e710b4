/* Coverage of rows that are passed over. If bins compare signals with constants and values change at
 * every row, judging each row would evaluate nodes that only counters read. Instead the truth of a node
 * in up to 64 rows is computed at once, as two sets of rows, and stretches of items are counted from
 * these sets. Afterwards the run is brought to the last of these rows (catch_up). */
#include "input/input.h"
#include "results/results.h"
#include "rows/rows.h"

#include <string.h>

/* A shorter stretch of rows is judged row by row, which takes less time than catching up after it. */
#define STRETCH_LEAST 8

/* ---- truths of nodes over rows */

/* The rows at which a number is less than a constant; no number is NaN. */
static uint64_t rows_below(const double *v, int32_t count, double constant)
{
    uint8_t one[TOGETHER] = {0};
    int32_t i;
    for (i = 0; i < count; i++) {
        one[i] = (uint8_t)(v[i] < constant);
    }
    return bits_of(one);
}

static uint64_t rows_above(const double *v, int32_t count, double constant)
{
    uint8_t one[TOGETHER] = {0};
    int32_t i;
    for (i = 0; i < count; i++) {
        one[i] = (uint8_t)(v[i] > constant);
    }
    return bits_of(one);
}

/* The rows at which a comparison holds. */
static uint64_t rows_that_compare(int32_t how, const double *v, int32_t count, double constant)
{
    switch (how) {
    case CMP_LT: return rows_below(v, count, constant);
    case CMP_GE: return ~rows_below(v, count, constant);
    case CMP_GT: return rows_above(v, count, constant);
    case CMP_LE: return ~rows_above(v, count, constant);
    case CMP_NE: return rows_below(v, count, constant) | rows_above(v, count, constant);
    default: return ~(rows_below(v, count, constant) | rows_above(v, count, constant));
    }
}

/* The rows at which a Boolean is true. */
static uint64_t rows_that_are_set(const uint8_t *v, int32_t count)
{
    uint8_t one[TOGETHER] = {0};
    int32_t i;
    for (i = 0; i < count; i++) {
        one[i] = (uint8_t)(v[i] != 0U);
    }
    return bits_of(one);
}

static node_rows rows_of(const run *r, const counting *c, int32_t place)
{
    node_rows found = {0, 0};
    if (c->reads[place] != READS_NONE) {
        return c->rows[place];
    }
    found.is_true = (r->truth[place] == IS_TRUE) ? ~UINT64_C(0) : 0U;
    found.is_false = (r->truth[place] == IS_FALSE) ? ~UINT64_C(0) : 0U;
    return found;
}

/* The comparisons of a column in rows [row, row + count), none of which is unknown. */
static void lay_leaves(const batch *s, const column_watch *w, int64_t row, int32_t count)
{
    const run *r = root_of(s, w, 0);
    const list atoms = r->part->signals[w->readers[0].local].on_change[r->at.phase];
    int32_t i;
    int32_t k;
    for (i = 0; i < atoms.count; i++) {
        const atom_plan *a = &r->part->atoms[LIST(PLAN(r), atoms)[i]];
        const list nodes = a->nodes[r->at.phase];
        const uint64_t is_true = (a->op == ATOM_REAL)
            ? rows_that_compare(a->compare, &((const double *)w->column->values)[row], count, a->constant)
            : rows_that_are_set(&((const uint8_t *)w->column->values)[row], count);
        for (k = 0; k < nodes.count; k++) {
            node_rows *own = &s->counting->rows[LIST(PLAN(r), nodes)[k]];
            own->is_true = is_true;
            own->is_false = ~is_true;
        }
    }
}

/* Kleene's connectives over sets of rows, with the same results as evaluated() of formulas/graph.c. */
static node_rows connected(const run *r, const counting *c, const node_plan *n)
{
    const int32_t *operands = LIST(PLAN(r), n->operands);
    node_rows found = rows_of(r, c, operands[0]);
    int32_t i;
    if (n->op == NODE_NOT) {
        const uint64_t is_true = found.is_true;
        found.is_true = found.is_false;
        found.is_false = is_true;
    } else if (n->op == NODE_SURE) {
        found.is_false = ~found.is_true;
    } else {
        for (i = 1; i < n->operands.count; i++) {
            const node_rows one = rows_of(r, c, operands[i]);
            const bool both = n->op == NODE_AND;
            found.is_true = both ? (found.is_true & one.is_true) : (found.is_true | one.is_true);
            found.is_false = both ? (found.is_false | one.is_false) : (found.is_false & one.is_false);
        }
    }
    return found;
}

/* ---- items */

/* The truth of an item over rows; its bins are digits of its number, the last axis the lowest. */
static node_rows rows_of_item(const run *r, const counting *c, const group_plan *g, int32_t item)
{
    const int32_t *axes = LIST(PLAN(r), g->axes);
    node_rows found = {~UINT64_C(0), 0};
    int32_t rest = item - g->first;
    int32_t i;
    for (i = g->axes.count - 2; i >= 0; i -= 2) {
        const watch_plan *w = &r->part->watches[axes[i] + rest % axes[i + 1]];
        const node_rows one = rows_of(r, c, w->node);
        found.is_true &= one.is_true;
        found.is_false |= one.is_false;
        rest /= axes[i + 1];
    }
    return found;
}

/* Count the stretches of an item that start in some rows, of which the first is at `times[0]`. */
static void count_stretches(covering *c, const group_plan *g, covered *s, int32_t item, node_rows own,
                            uint64_t rows, const int64_t *times)
{
    rv_hit *hit = &c->hits[item];
    bool current = c->is_current[item] != 0U;
    const bool was = current;
    uint64_t left = rows;
    for (;;) {
        const uint64_t turns = (current ? own.is_false : own.is_true) & left;
        int32_t at;
        if (turns == 0U) {
            break;
        }
        at = lowest_bit(turns);
        current = !current;
        if (current) {
            hit->first = (hit->count == 0) ? times[at] : hit->first;
            hit->count++;
        }
        left &= ~bits_before(at);
    }
    if (current && !was) {
        make_current(c, g, s, item);
    }
    c->is_current[item] = current ? 1 : 0;
}

/* The same for all items of a group: first those that are true in some row, then those that were current
 * before and are not true in any. */
static void count_group(const batch *s, run *r, int32_t number, uint64_t rows, const int64_t *times)
{
    covering *c = r->home->covering;
    const group_plan *g = &r->part->groups[number];
    covered *own = &c->groups[number];
    int32_t *items = &c->current_items[g->first];
    const int32_t before = own->current;
    int32_t kept = 0;
    combinations o;
    int32_t i;
    bool more = first_combination(r, g, s->counting->bits, &o);
    for (i = 0; i < before; i++) {
        const node_rows one = rows_of_item(r, s->counting, g, items[i]);
        if ((one.is_true & rows) == 0U) {
            count_stretches(c, g, own, items[i], one, rows, times);
        }
    }
    while (more) {
        const int32_t item = item_of(r, g, &o);
        const node_rows one = rows_of_item(r, s->counting, g, item);
        if ((one.is_true & rows) != 0U) {
            count_stretches(c, g, own, item, one, rows, times);
        }
        more = next_combination(&o);
    }
    for (i = 0; i < own->current; i++) {
        if (c->is_current[items[i]] != 0U) {
            items[kept] = items[i];
            kept++;
        }
    }
    own->current = kept;
}

bool count_rows(batch *s, int64_t row, int64_t end)
{
    counting *c = s->counting;
    run *r = s->m->homes[0].root;
    const int32_t count = (int32_t)(end - row);
    int32_t i;
    if (count < STRETCH_LEAST) {
        return false;
    }
    for (i = 0; i < s->columns; i++) {
        if (s->watches[i].is_counted) {
            lay_leaves(s, &s->watches[i], row, count);
        }
    }
    for (i = 0; i < c->count; i++) {
        const node_plan *n = &r->part->nodes[c->nodes[i]];
        if (n->op != NODE_LEAF) {
            c->rows[c->nodes[i]] = connected(r, c, n);
        }
    }
    (void)memset(c->bits, 0, words_of_watches(r->part->plan) * sizeof *c->bits);
    for (i = 0; i < r->part->plan->watches.count; i++) {
        const node_rows own = rows_of(r, c, r->part->watches[i].node);
        c->bits[i >> 6] |= (uint64_t)((own.is_true & bits_before(count)) != 0U) << (i & 63);
    }
    for (i = 0; i < r->part->plan->groups.count; i++) {
        if (c->is_bulk[i] != 0U) {
            count_group(s, r, i, bits_before(count), &s->times[row]);
        }
    }
    s->counted = end;
    return true;
}

/* Bring the run to the last row that was counted: hold its values, and let the next position evaluate all
 * groups, as rows that no node has seen decided which items are current. */
void catch_up(batch *s)
{
    run *r = s->m->homes[0].root;
    int32_t i;
    if (s->counted == 0) {
        return;
    }
    for (i = 0; i < s->columns; i++) {
        const column_watch *w = &s->watches[i];
        if (w->is_counted) {
            const int32_t local = w->readers[0].local;
            r->value[local] = number_in(w->column, s->counted - 1);
            r->spans[local] = NO_SPAN;
            (void)recheck_list(r, r->part->signals[local].on_change[r->at.phase]);
        }
    }
    call_watches(r);
    s->counted = 0;
}
