/* Robustness of rows that change no verdict: the leaves of many rows are computed together, column by
 * column, and given to the gauges. */
#include "attempts/attempts.h"
#include "input/input.h"
#include "margins/margins.h"
#include "rows/rows.h"

#include <math.h>

/* Make room for the leaves of a judge in rows that are examined together. */
bool begin_measured(batch *s)
{
    rv_monitor *m = s->m;
    int64_t i;
    for (i = 0; (m->shapes != NULL) && (i < m->plan.counts[SEC_MARGINS]); i++) {
        const int32_t count = m->shapes[i].plan->measures.count;
        s->leaves_room = (count > s->leaves_room) ? count : s->leaves_room;
    }
    for (i = 0; (m->shapes != NULL) && (i < 2); i++) {
        s->leaves[i] = arena_take(&m->memory, (size_t)(s->leaves_room + 1) * TOGETHER * sizeof(double));
        if (s->leaves[i] == NULL) {
            return false;
        }
    }
    return true;
}

void end_measured(batch *s)
{
    int32_t i;
    for (i = 0; i < 2; i++) {
        if (s->leaves[i] != NULL) {
            arena_give(&s->m->memory, s->leaves[i],
                       (size_t)(s->leaves_room + 1) * TOGETHER * sizeof(double));
        }
    }
    settle_rows(s, TOGETHER);
}

/* Settle margins once enough rows were taken. */
void settle_rows(batch *s, int64_t rows)
{
    rv_monitor *m = s->m;
    s->unsettled += rows;
    if (m->defers_margins && (s->unsettled >= TOGETHER) && !m->spoilt && (m->reached != RV_NO_TIME)) {
        s->unsettled = 0;
        m->defers_margins = false;
        settle_margins(m, m->reached);
        m->defers_margins = true;
    }
}

/* Whether rows that are passed over can be measured: all born signals are known, and the part has a
 * single run. */
bool may_pass_measured(const rv_monitor *m)
{
    const run *r = m->homes[0].root;
    return (m->shapes == NULL)
           || (m->is_alone && (GAP(r) <= 1) && (r->at.phase == 1) && (r->at.presence == ARE_THERE)
               && !r->at.dense && (r->at.lost_count == 0) && (r->cut == NEVER)
               && (r->measured_at != -LIMIT) && (r->truth_log == NULL) && !r->part->is_watched);
}

/* Whether anything but obligations of attempts reads the truth of a node. */
static bool is_looked_at(const run *r, int32_t place)
{
    const plan *p = PLAN(r);
    int32_t i;
    int32_t k;
    for (i = 0; i < r->part->plan->judges.count; i++) {
        const judge_plan *j = &r->part->judges[i];
        const list own = p->margins[r->part->plan->judges.first + i].measures;
        if ((place == j->again) || (place == j->unborn) || (place == j->blurs)) {
            return true;
        }
        for (k = own.first; k < own.first + own.count; k++) {
            const measure_plan *m = &p->measures[k];
            if ((m->node == place) && ((m->kind == MEASURE_TRUTH) || (m->kind == MEASURE_DENIED))) {
                return true;
            }
        }
    }
    return false;
}

/* Formulas with more levels are examined row by row. */
#define LEVELS_MOST 4

/* Whether a node and all nodes above it have no memory, and only obligations of judges read them; for
 * `now`, only judges without open attempts. */
static bool is_unheard(const run *r, int32_t place, bool now, int32_t level)
{
    const node_plan *n = &r->part->nodes[place];
    const link_plan *l = &PLAN(r)->links[n->links.first];
    const list parents = n->parents[r->at.phase];
    const bool joins = (n->op == NODE_NOT) || (n->op == NODE_AND) || (n->op == NODE_OR) || (n->op == NODE_SURE);
    int32_t i;
    if ((level == LEVELS_MOST) || ((n->op != NODE_LEAF) && !joins) || (!now && is_looked_at(r, place))) {
        return false;
    }
    for (i = 0; i < n->links.count; i++) {
        if ((l[i].kind != LINK_LETTER)
            || (now && (has_attempts(&r->judges[l[i].judge]) || needs_every_position(r, l[i].judge)))) {
            return false;
        }
    }
    for (i = 0; i < parents.count; i++) {
        if (!is_unheard(r, LIST(PLAN(r), parents)[i], now, level + 1)) {
            return false;
        }
    }
    return true;
}

/* Iterate over the leaves of the comparisons of a signal; -1 after the last. */
int32_t next_shown(const run *r, int32_t local, int32_t *atom, int32_t *at)
{
    const list atoms = r->part->signals[local].on_change[r->at.phase];
    for (; *atom < atoms.count; (*atom)++, *at = 0) {
        const list nodes = r->part->atoms[LIST(PLAN(r), atoms)[*atom]].nodes[r->at.phase];
        if (*at < nodes.count) {
            (*at)++;
            return LIST(PLAN(r), nodes)[*at - 1];
        }
    }
    return -1;
}

/* Whether only attempts read the comparisons of a signal, now that all signals are born. */
bool is_plain_column(const batch *s, const column_watch *w)
{
    const bool whole = (w->column->says == NULL) && (w->column->values != NULL) && !w->is_event;
    const run *r;
    list atoms;
    int32_t atom = 0;
    int32_t at = 0;
    int32_t place;
    int32_t i;
    if ((s->m->shapes == NULL) || !s->m->is_alone || !whole || w->ignores_nan || w->perishable
        || (w->reader_count != 1) || ((w->how != EACH_VALUE) && (w->how != BY_CONSTANTS))) {
        return false;
    }
    r = root_of(s, w, 0);
    atoms = r->part->signals[w->readers[0].local].on_change[r->at.phase];
    for (i = 0; i < atoms.count; i++) {
        const int32_t own = LIST(PLAN(r), atoms)[i];
        if ((r->part->atoms[own].tells != 0) || (r->momentary[own] != 0U)) {
            return false;
        }
    }
    for (place = next_shown(r, w->readers[0].local, &atom, &at); place >= 0;
         place = next_shown(r, w->readers[0].local, &atom, &at)) {
        if (!is_unheard(r, place, false, 0)) {
            return false;
        }
    }
    return true;
}

/* Whether nothing reads the comparisons of a signal now. */
bool is_idle_now(const batch *s, const column_watch *w)
{
    const run *r;
    int32_t atom = 0;
    int32_t at = 0;
    int32_t place;
    if (!w->is_plain) {
        return false;
    }
    r = root_of(s, w, 0);
    for (place = next_shown(r, w->readers[0].local, &atom, &at); place >= 0;
         place = next_shown(r, w->readers[0].local, &atom, &at)) {
        if (!is_unheard(r, place, true, 0)) {
            return false;
        }
    }
    return true;
}

/* Hold the values of a row in a run. */
static void hold_row(const batch *s, int64_t row)
{
    int32_t i;
    for (i = 0; i < s->columns; i++) {
        const column_watch *w = &s->watches[i];
        if (!w->is_event && (w->how != NO_UPDATES) && bit_at(w->given, row - s->first)) {
            root_of(s, w, 0)->value[w->readers[0].local] = number_in(w->column, row);
        }
    }
}

/* The column of numbers that a comparison with a constant reads; NULL: there is none. */
static const double *reals_of(const batch *s, const atom_plan *a)
{
    int32_t i;
    for (i = 0; (a->op == ATOM_REAL) && (i < s->columns); i++) {
        const column_watch *w = &s->watches[i];
        if (w->is_idle && (w->column->kind == RV_COLUMN_REAL) && (w->readers[0].local == a->input)) {
            return w->column->values;
        }
    }
    return NULL;
}

/* Compute the bounds of a leaf in some rows; returns whether lower and upper bounds differ anywhere. */
static bool lay_leaf(const batch *s, const run *r, const margin_shape *shape, int32_t number, int64_t row,
                     int64_t end)
{
    const measure_plan *m = &shape->measures[number];
    const atom_plan *a = (m->kind == MEASURE_DISTANCE) ? &r->part->atoms[r->part->nodes[m->node].a] : NULL;
    const bool varies = (a != NULL) && (a->op != ATOM_PAYLOAD);
    const double *reals = varies ? reals_of(s, a) : NULL;
    double *low = &s->leaves[0][number * TOGETHER];
    double *high = &s->leaves[1][number * TOGETHER];
    margin_range now = {0.0, 0.0};
    bool differs = false;
    int64_t i;
    for (i = row; (reals != NULL) && (i < end); i++) {
        low[i - row] = measured_real(&shape->reals[number], reals[i]);
        high[i - row] = low[i - row];
    }
    for (i = (reals != NULL) ? end : row; i < end; i++) {
        if (varies) {
            hold_row(s, i);
        }
        if (varies || (i == row)) {
            now = leaf_range(r, shape, number);
            differs = differs || (now.low != now.high);
        }
        low[i - row] = now.low;
        high[i - row] = now.high;
    }
    return differs;
}

/* Pass the leaves of a judge in some rows to its gauges. */
static void give_rows(const batch *s, run *r, int32_t index, int64_t row, int64_t end)
{
    const margin_shape *shape = shape_of(r, index);
    measuring *q = &r->margins[index];
    gauging *w = begin_gauging(r, index, s->times[end - 1], s->times[end - 1]);
    bool differs = false;
    int32_t k;
    give_after(w, s->times[row] - 1);
    q->passes = false;
    for (k = 0; k < shape->plan->measures.count; k++) {
        differs = lay_leaf(s, r, shape, k, row, end) || differs;
    }
    if (differs && !q->parted) {
        part_margins(r, index);
    }
    give_letters(w, &s->times[row], end - row, s->leaves, TOGETHER);
}

/* Measure rows for a judge; its position is then that of the last row. */
static void measure_for(const batch *s, run *r, int32_t index, int64_t row, int64_t end)
{
    measuring *q = &r->margins[index];
    int64_t i = row;
    if (!(q->active || is_kept_up(r, index) || awaits_the_end(r, index))) {
        return;
    }
    if (!q->active && (end - row > 1)) {
        hold_row(s, row);
        enter_position(r, index, s->times[row]);
        i++;
    }
    if ((i < end - 1) && ((q->requests.first < q->requests.end) || is_kept_up(r, index))) {
        give_rows(s, r, index, i, end - 1);
    }
    if (is_streamed(r, index)) { /* before any position is settled */
        ask_for_positions(r, index, &s->times[row], end - 1 - row);
    }
    hold_row(s, end - 1);
    enter_position(r, index, s->times[end - 1]);
    if (is_streamed(r, index)) {
        ask_for_positions(r, index, &s->times[end - 1], 1);
    }
}

/* Measure rows that are passed over, and hold the values of the last one. */
void measure_rows(batch *s, int64_t row, int64_t end)
{
    run *r = s->m->homes[0].root;
    int32_t i;
    for (i = 0; i < r->part->plan->judges.count; i++) {
        measure_for(s, r, i, row, end);
    }
    hold_row(s, end - 1);
    r->measured_at = s->times[end - 1];
    for (i = 0; i < s->columns; i++) {
        const column_watch *w = &s->watches[i];
        if (w->is_idle) {
            const int32_t local = w->readers[0].local;
            r->spans[local] = NO_SPAN;
            (void)recheck_list(r, r->part->signals[local].on_change[r->at.phase]);
        }
    }
}
