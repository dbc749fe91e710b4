/* One bound of the robustness of a formula, evaluated incrementally: the values of operands flow to
 * operators as steps, and an operator passes a value on as soon as no later input can change it. Only
 * values that are not final are kept.
 *
 * Source: SEMANTICS 5; Deshmukh et al. 2017 (figures of a part of a trace). */
#include "margins/margins.h"

#include <string.h>

static void *taken(rv_monitor *m, int64_t count, size_t each)
{
    void *made = arena_take(&m->memory, (size_t)(count + 1) * each);
    m->spoilt = m->spoilt || (made == NULL);
    return made;
}

bool gauge_make(rv_monitor *m, const margin_shape *s, gauge *g)
{
    if (g->nodes == NULL) {
        g->nodes = taken(m, s->count, sizeof *g->nodes);
        g->edges = taken(m, s->edges, sizeof *g->edges);
        g->letter = taken(m, s->plan->measures.count, sizeof *g->letter);
    }
    return (g->nodes != NULL) && (g->edges != NULL) && (g->letter != NULL);
}

static void empty_steps(margin_steps *s)
{
    s->first = 0;
    s->end = 0;
}

/* Begin at a position, before its letter is read. */
void gauge_begin(const margin_shape *s, gauge *g, int64_t first)
{
    int32_t i;
    for (i = 0; i < s->count; i++) {
        margin_node *o = &g->nodes[i];
        empty_steps(&o->out);
        empty_steps(&o->wedge);
        o->parts.begin = o->parts.middle = o->parts.end = 0;
        o->known = first - 1;
        o->joined = first - 1;
        o->next = first;
        o->positions = 0;
        o->carried = (s->nodes[i].turned != 0) ? INFINITE : -INFINITE;
        o->started = false;
    }
    for (i = 0; i < s->edges; i++) {
        g->edges[i].read = 0;
        g->edges[i].value = s->fixed[i];
    }
    empty_steps(&g->stamps);
    g->first = first;
    g->read = 0;
    g->reported = -INFINITE;
    g->started = false;
    g->after_gap = false;
}

/* The bound of a value that may be anything. */
double bound_of_anything(const gauging *w)
{
    return (w->side == 0) ? -INFINITE : INFINITE;
}

/* Begin after a gap in the input, which may have been anything up to the position `last`. */
void gauge_begin_after_gap(gauging *w, int64_t last)
{
    const margin_shape *s = w->shape;
    int32_t i;
    w->g->after_gap = true;
    for (i = 0; i < s->count; i++) {
        const operator_plan *n = &s->nodes[i];
        margin_node *o = &w->g->nodes[i];
        if ((n->kind == OP_WINDOW) && (n->low < 0)
            && room_for_steps(w, &o->wedge, 1, o->wedge.first)) {
            add_step(&o->wedge, last - n->low, bound_of_anything(w));
        } else {
            o->carried = bound_of_anything(w);
        }
    }
}

/* Copy a gauge; false if memory is short. */
bool gauge_copy(rv_monitor *m, const margin_shape *s, gauge *made, const gauge *g)
{
    bool done = gauge_make(m, s, made) && steps_copy(m, &made->stamps, &g->stamps);
    int32_t i;
    for (i = 0; done && (i < s->count); i++) {
        margin_node *to = &made->nodes[i];
        const margin_node *from = &g->nodes[i];
        done = steps_copy(m, &to->out, &from->out) && steps_copy(m, &to->wedge, &from->wedge)
               && parts_copy(m, &to->parts, &from->parts);
        to->known = from->known;
        to->joined = from->joined;
        to->next = from->next;
        to->positions = from->positions;
        to->carried = from->carried;
        to->started = from->started;
    }
    if (done) {
        (void)memcpy(made->edges, g->edges, (size_t)s->edges * sizeof *g->edges);
        (void)memcpy(made->letter, g->letter, (size_t)s->plan->measures.count * sizeof *g->letter);
        made->first = g->first;
        made->read = g->read;
        made->reported = g->reported;
        made->started = g->started;
        made->after_gap = g->after_gap;
    }
    return done;
}

/* Take the values of a leaf: where operators are aligned a step for each position, else for changes. */
static inline void take_leaf(gauging *w, int32_t place, const int64_t *times, int64_t count,
                             const double *values, double *last)
{
    margin_steps *s = &w->g->nodes[place].out;
    int64_t k;
    if (w->aligned && (has_room(s, count) || room_for_steps(w, s, count, oldest_unread(w, place)))) {
        add_steps(s, times, count, values);
    }
    for (k = 0; !w->aligned && (k < count); k++) {
        if (w->sparse || (values[k] != *last) || (!w->g->started && (k == 0))) {
            emit_step(w, place, times[k], values[k]);
        }
        *last = values[k];
    }
}

/* Take the values of all leaves at some positions; `apart` is the stride from leaf to leaf. */
void gauge_take(gauging *w, const int64_t *times, int64_t count, const double *values, int32_t apart)
{
    const margin_shape *s = w->shape;
    const int32_t measures = s->plan->measures.count;
    int32_t i;
    if (w->sparse) {
        note_positions(w, times, count);
    }
    for (i = 0; i < measures; i++) {
        if (s->leaves[i] >= 0) { /* else it is constant */
            take_leaf(w, s->leaves[i], times, count, &values[(int64_t)i * apart], &w->g->letter[i]);
        }
    }
    w->g->started = true;
}

/* Evaluate all operators, operands first, as far as the leaves are known. */
void gauge_run(gauging *w)
{
    const margin_shape *s = w->shape;
    int32_t i;
    for (i = 0; i < s->count; i++) {
        switch (s->nodes[i].kind) {
        case OP_LEAF: w->g->nodes[i].known = w->now; break;
        case OP_WINDOW: gauge_window(w, i); break;
        case OP_SHIFT: gauge_shift(w, i); break;
        default: gauge_join(w, i); break;
        }
    }
}

/* ---- shapes */

/* Mark leaves that never change and are read only as operands of sweeps: their steps are not needed. */
static void find_fixed(const plan *p, const margin_shape *s, bool *fixed)
{
    int32_t i;
    int32_t k;
    for (i = 0; i < s->count; i++) {
        const operator_plan *n = &s->nodes[i];
        fixed[i] = (n->kind == OP_LEAF) && (s->measures[n->left].kind == MEASURE_CONSTANT);
    }
    for (i = 0; i < s->count; i++) {
        const operator_plan *n = &s->nodes[i];
        const int32_t pair[2] = {n->left, n->right};
        const int32_t *operands = (n->kind == OP_JUNCTION) ? LIST(p, n->operands) : pair;
        const int32_t count = s->places[i].edge_count;
        bool all = true;
        for (k = 0; k < count; k++) {
            all = (n->kind == OP_JUNCTION) || (all && fixed[operands[k]]);
        }
        for (k = 0; all && (k < count); k++) {
            fixed[operands[k]] = false;
        }
    }
    fixed[s->count - 1] = false;
}

/* Find operators of which only the values at asked positions matter: the formula and the operands of
 * junctions at its top. */
static void find_alone(const margin_shape *s)
{
    int32_t i;
    int32_t k;
    for (i = 0; i < s->count; i++) {
        s->places[i].alone = true;
    }
    for (i = s->count - 1; i >= 0; i--) {
        const margin_place *own = &s->places[i];
        const bool joins = (s->nodes[i].kind == OP_JUNCTION) && own->alone;
        for (k = 0; !joins && (k < own->edge_count); k++) {
            if (s->operands[own->edge + k] >= 0) {
                s->places[s->operands[own->edge + k]].alone = false;
            }
        }
    }
}

static int32_t operand_count(const operator_plan *n)
{
    switch (n->kind) {
    case OP_LEAF: return 0;
    case OP_JUNCTION: return n->operands.count;
    case OP_WINDOW:
    case OP_SHIFT: return 1;
    default: return 2;
    }
}

static void lay_out(const plan *p, margin_shape *s, const bool *fixed)
{
    int32_t i;
    int32_t k;
    for (i = 0; i < s->count; i++) {
        const operator_plan *n = &s->nodes[i];
        const int32_t pair[2] = {n->left, n->right};
        const int32_t *operands = (n->kind == OP_JUNCTION) ? LIST(p, n->operands) : pair;
        for (k = 0; k < s->places[i].edge_count; k++) {
            const int32_t own = s->places[i].edge + k;
            s->operands[own] = fixed[operands[k]] ? -1 : operands[k];
            if (fixed[operands[k]]) {
                const bool no = s->measures[s->nodes[operands[k]].left].turned != 0;
                s->fixed[own] = no ? -INFINITE : INFINITE;
            }
        }
        if (n->kind == OP_LEAF) {
            s->leaves[n->left] = fixed[i] ? -1 : i;
        }
        s->passes = s->passes || (n->kind == OP_WINDOW) || (n->kind == OP_SHIFT);
    }
}

/* The ticks that must pass after a position before the value of an operator can be final. */
static int64_t lag_of(const margin_shape *s, int32_t place, const int64_t *lags, int64_t step)
{
    const operator_plan *n = &s->nodes[place];
    const margin_place *own = &s->places[place];
    const int64_t steps = (n->high > 0) ? n->high : 0;
    const int64_t ahead = (steps > LIMIT / step) ? LIMIT : steps * step;
    int64_t found = 0;
    int32_t k;
    for (k = 0; k < own->edge_count; k++) {
        const int32_t operand = s->operands[own->edge + k];
        if ((operand >= 0) && (lags[operand] > found)) {
            found = lags[operand];
        }
    }
    if ((n->kind == OP_WINDOW) || (n->kind == OP_SHIFT)) {
        found = (ahead > 0) ? moved(found, ahead) : 0;
    }
    return ((n->kind == OP_WINDOW) && (n->over > found)) ? n->over : found;
}

/* Compute the shape of a formula; false if memory is short. */
bool make_shape(rv_monitor *m, const part *of, const margin_plan *g, margin_shape *s)
{
    const plan *p = &m->plan;
    const int32_t count = g->operators.count;
    bool *fixed = taken(m, count, sizeof *fixed);
    int64_t *lags = taken(m, count, sizeof *lags);
    int32_t i;
    s->plan = g;
    s->nodes = &p->operators[g->operators.first];
    s->measures = &p->measures[g->measures.first];
    s->count = count;
    s->places = taken(m, count, sizeof *s->places);
    s->leaves = taken(m, g->measures.count, sizeof *s->leaves);
    s->reals = taken(m, g->measures.count, sizeof *s->reals);
    if ((fixed == NULL) || (lags == NULL) || (s->places == NULL) || (s->leaves == NULL)
        || (s->reals == NULL)) {
        return false;
    }
    for (i = 0; i < g->measures.count; i++) {
        const measure_plan *own = &s->measures[i];
        s->reals[i] = learn_real(of, own);
        s->occurs = s->occurs || ((own->kind == MEASURE_DISTANCE)
                                  && (of->atoms[of->nodes[own->node].a].op == ATOM_PAYLOAD));
    }
    for (i = 0; i < count; i++) {
        s->places[i].edge = s->edges;
        s->places[i].edge_count = operand_count(&s->nodes[i]);
        s->edges += s->places[i].edge_count;
    }
    s->operands = taken(m, s->edges, sizeof *s->operands);
    s->fixed = taken(m, s->edges, sizeof *s->fixed);
    if ((s->operands == NULL) || (s->fixed == NULL)) {
        return false;
    }
    find_fixed(p, s, fixed);
    lay_out(p, s, fixed);
    find_alone(s);
    for (i = 0; i < count; i++) {
        lags[i] = lag_of(s, i, lags, (p->header->gap > 0) ? p->header->gap : 1);
    }
    s->lag = lags[count - 1];
    arena_give(&m->memory, fixed, (size_t)(count + 1) * sizeof *fixed);
    arena_give(&m->memory, lags, (size_t)(count + 1) * sizeof *lags);
    return true;
}
