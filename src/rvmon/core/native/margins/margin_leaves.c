/* By how much a leaf holds or fails to at the position at hand, in base units.
 *
 * A comparison of numbers counts by how far its sides are apart, anything else as infinite; what is not
 * known may be anything. */
#include "input/input.h"
#include "margins/margins.h"

static const margin_range ANYTHING = {-(double)INFINITY, (double)INFINITY};

static margin_range of_truth(uint8_t truth)
{
    margin_range made = {-INFINITE, INFINITE};
    if (truth == IS_FALSE) {
        made.high = -INFINITE;
    } else if (truth == IS_TRUE) {
        made.low = INFINITE;
    } else {
        /* It may be either. */
    }
    return made;
}

static bool is_anything(const margin_range *x)
{
    return (x->low == -INFINITE) && (x->high == INFINITE);
}

static double double_of(const rv_number *x)
{
    return (x->kind == RV_WHOLE) ? (double)x->as.whole : x->as.real;
}

/* One number less another: of whole numbers rounded once. */
static double apart(const rv_number *a, const rv_number *b)
{
    if (compare_numbers(CMP_EQ, a, b) == IS_TRUE) {
        return 0.0; /* of infinite ones, too */
    }
    if ((a->kind == RV_WHOLE) && (b->kind == RV_WHOLE)) {
        const bool less = a->as.whole < b->as.whole;
        const uint64_t x = (uint64_t)a->as.whole;
        const uint64_t y = (uint64_t)b->as.whole;
        return less ? -(double)(y - x) : (double)(x - y);
    }
    return double_of(a) - double_of(b);
}

/* By how much a comparison holds, given how far its left side is above the right one. Nothing is -0. */
static double signed_by(int32_t compare, double distance)
{
    switch (compare) {
    case CMP_LT:
    case CMP_LE: return 0.0 - distance;
    case CMP_GT:
    case CMP_GE: return distance;
    case CMP_EQ: return 0.0 - fabs(distance);
    default: return fabs(distance);
    }
}

static margin_range exactly(double value)
{
    margin_range made;
    made.low = value;
    made.high = value;
    return made;
}

static margin_range of_programs(const run *r, const atom_plan *a, double factor, const int32_t *at)
{
    const rv_number left = program_value(r, a->left, at);
    const rv_number right = program_value(r, a->right, at);
    if ((left.kind == RV_UNKNOWN) || (right.kind == RV_UNKNOWN)) {
        return ANYTHING;
    }
    return exactly(signed_by(a->compare, apart(&left, &right) * factor));
}

/* Take the occurrences that are looked at to the next combination; false behind the last. */
static bool next_choice(const run *r, const int32_t *events, int32_t count)
{
    int32_t i;
    for (i = count - 1; i >= 0; i--) {
        r->chosen[events[i]]++;
        if (r->chosen[events[i]] < r->payloads[events[i]].count) {
            return true;
        }
        r->chosen[events[i]] = 0;
    }
    return false;
}

/* The best of all combinations of occurrences; of none it is infinitely far from true. */
static margin_range of_occurrences(const run *r, const atom_plan *a, double factor)
{
    const int32_t *events = LIST(PLAN(r), a->events);
    margin_range found = {-INFINITE, -INFINITE};
    bool lacks = false;
    bool may_occur = true;
    int32_t i;
    for (i = 0; i < a->events.count; i++) {
        const bool silent = r->silent[events[i]] == IS_UNKNOWN;
        lacks = lacks || silent;
        may_occur = may_occur && (silent || (r->payloads[events[i]].count > 0));
        r->chosen[events[i]] = 0;
    }
    if (!may_occur) {
        return found;
    }
    if (lacks) {
        return ANYTHING;
    }
    do {
        margin_range one = ANYTHING;
        bool known = true;
        for (i = 0; i < a->events.count; i++) {
            known = known && (r->payloads[events[i]].known[r->chosen[events[i]]] != 0U);
        }
        if (known) {
            one = of_programs(r, a, factor, r->chosen);
        }
        found.low = fmax(found.low, one.low);
        found.high = fmax(found.high, one.high);
    } while (next_choice(r, events, a->events.count));
    return found;
}

/* How a leaf that compares a signal with a real constant is measured. */
margin_real learn_real(const part *of, const measure_plan *m)
{
    margin_real made = {0.0, 0.0, -1, false};
    const atom_plan *a = (m->kind == MEASURE_DISTANCE) ? &of->atoms[of->nodes[m->node].a] : NULL;
    if ((a != NULL) && (a->op == ATOM_REAL)) {
        const double rises = signed_by(a->compare, m->factor);
        made.constant = a->constant;
        made.slope = (m->turned != 0) ? -rises : rises;
        made.input = a->input;
        made.absolute = (a->compare == CMP_EQ) || (a->compare == CMP_NE);
    }
    return made;
}

/* The distance of the comparison that a leaf shows. */
static margin_range distance_of(const run *r, const measure_plan *m)
{
    const node_plan *n = &r->part->nodes[m->node];
    const atom_plan *a = &r->part->atoms[n->a];
    margin_range found = ANYTHING;
    if (a->op == ATOM_COMPARE) {
        found = of_programs(r, a, m->factor, NULL);
    } else if (a->op == ATOM_PAYLOAD) {
        found = of_occurrences(r, a, m->factor);
    } else {
        /* The signal is unknown. */
    }
    /* What is not born is what it is taken for. Once all is, nobody follows the truth of what has a
     * distance. */
    if (is_anything(&found) && ((r->at.phase == 0) || (a->op == ATOM_PAYLOAD) || (n->op == NODE_COMPARED))) {
        found = of_truth(r->truth[m->node]);
    }
    return found;
}

/* What a leaf is at least and at most. */
margin_range measured_leaf(const run *r, const margin_shape *s, int32_t number)
{
    const measure_plan *m = &s->measures[number];
    const margin_real *real = &s->reals[number];
    margin_range found = {INFINITE, INFINITE};
    if ((real->input >= 0) && (r->value[real->input].kind == RV_REAL)) {
        return exactly(measured_real(real, r->value[real->input].as.real));
    }
    switch (m->kind) {
    case MEASURE_CONSTANT: break;
    case MEASURE_TRUTH: found = of_truth(r->truth[m->node]); break;
    case MEASURE_DENIED: found = of_truth(truth_if(r->truth[m->node] == IS_FALSE)); break;
    default: found = distance_of(r, m); break;
    }
    if (m->turned != 0) {
        const double low = found.low;
        found.low = 0.0 - found.high;
        found.high = 0.0 - low;
    }
    return found;
}

/* Whether a leaf is another behind the position at hand though none comes: it speaks of what occurs
 * there, by however much it is false. */
bool passes_on(const run *r, const measure_plan *m, margin_range *then)
{
    const node_plan *n;
    const atom_plan *a;
    if ((m->kind != MEASURE_DISTANCE) || (GAP(r) == 0)) {
        return false;
    }
    n = &r->part->nodes[m->node];
    a = &r->part->atoms[n->a];
    if ((a->op != ATOM_PAYLOAD) || (r->momentary[n->a] == 0U)) {
        return false;
    }
    *then = exactly((m->turned != 0) ? INFINITE : -INFINITE);
    return true;
}

/* Operators that join values: `and`, `or`, `since`, `until`.
 *
 * What a node has is a function of the positions in steps, known up to one of them. Where only samples
 * are positions a step belongs to the position at which it begins, and each has one of its own.
 *
 * Source: SEMANTICS 5; Fainekos and Pappas 2009; Donze, Ferrere and Maler 2013. */

/* Between which values a sweep keeps that of its neighbour. */
static margin_range bounds_of(const operator_plan *n, const margin_edge *edges)
{
    const double stays = edges[0].value;
    const double meets = edges[1].value;
    margin_range made;
    made.low = (n->turned != 0) ? fmin(stays, meets) : meets;
    made.high = (n->turned != 0) ? meets : fmax(stays, meets);
    return made;
}

/* Tell another value, unless it is none. */
static inline void tell_other(gauging *w, int32_t place, int64_t at, double value)
{
    margin_node *o = &w->g->nodes[place];
    if (w->sparse || !o->begun || (value != o->carried)) {
        o->begun = true;
        o->carried = value;
        tell_step(w, place, at, value);
    }
}

static inline void tell_junction(gauging *w, int32_t place, int64_t at)
{
    const margin_place *shape = &w->shape->places[place];
    const margin_edge *edges = &w->g->edges[shape->edge];
    const bool every = node_plan_of(w, place)->turned != 0;
    double value = edges[0].value;
    int32_t i;
    for (i = 1; i < shape->edge_count; i++) {
        if (every ? (edges[i].value < value) : (edges[i].value > value)) {
            value = edges[i].value;
        }
    }
    tell_other(w, place, at, value);
}

/* S(i) = max(meets(i), min(stays(i), S(i - 1))), or its dual. */
static inline void tell_since(gauging *w, int32_t place, int64_t at)
{
    const margin_edge *edges = &w->g->edges[w->shape->places[place].edge];
    const margin_range bounds = bounds_of(node_plan_of(w, place), edges);
    margin_node *o = &w->g->nodes[place];
    tell_other(w, place, at, within(o->carried, bounds.low, bounds.high));
}

/* Where an operand has its next step that was not taken; NEVER: there is none. */
static inline int64_t next_of(const margin_steps *from, const margin_edge *own)
{
    return (own->read < from->end) ? step_at(from, own->read)->at : NEVER;
}

/* Take what operands are at the positions at which one of them changes, up to where all are known. */
static inline void join_operands(gauging *w, int32_t place,
                                 void (*tell)(gauging *w, int32_t place, int64_t at))
{
    const margin_place *own = &w->shape->places[place];
    const int32_t *operands = &w->shape->operands[own->edge];
    margin_edge *edges = &w->g->edges[own->edge];
    const margin_node *nodes = w->g->nodes;
    int64_t known = NEVER;
    int64_t next = NEVER;
    int32_t i;
    for (i = 0; i < own->edge_count; i++) {
        edges[i].next = NEVER;
        if (operands[i] >= 0) { /* else it never changes */
            const margin_node *from = &nodes[operands[i]];
            known = least(known, from->known);
            edges[i].next = next_of(&from->out, &edges[i]);
            next = least(next, edges[i].next);
        }
    }
    while (next <= known) {
        const int64_t at = next;
        next = NEVER;
        for (i = 0; i < own->edge_count; i++) {
            margin_edge *one = &edges[i];
            if (one->next == at) {
                const margin_steps *from = &nodes[operands[i]].out;
                one->value = step_at(from, one->read)->value;
                one->read++;
                one->next = next_of(from, one);
            }
            next = least(next, one->next);
        }
        tell(w, place, at);
    }
    w->g->nodes[place].joined = (known > w->g->nodes[place].joined) ? known : w->g->nodes[place].joined;
}

static void follow_until(gauging *w, int32_t place, int64_t at)
{
    const margin_edge *edges = &w->g->edges[w->shape->places[place].edge];
    const margin_range bounds = bounds_of(node_plan_of(w, place), edges);
    parts_follow(w, &w->g->nodes[place].parts, at, bounds.low, bounds.high,
                 is_thin(w, place));
}

/* Tell the value of a stretch up to a position. */
static void tell_stretch(gauging *w, int32_t place, int64_t first, int64_t last, double value)
{
    margin_node *o = &w->g->nodes[place];
    if (!w->sparse || is_thin(w, place)) {
        tell_step(w, place, first, value);
        return;
    }
    while ((o->positions < w->g->stamps.end)
           && (step_at(&w->g->stamps, o->positions)->at <= last)) {
        tell_step(w, place, step_at(&w->g->stamps, o->positions)->at, value);
        o->positions++;
    }
}

/* The trace has ended: from behind its end back, each stretch has the value of what follows it. */
static void end_until(gauging *w, int32_t place)
{
    margin_parts *s = &w->g->nodes[place].parts;
    double value = margin_behind(w->end, node_plan_of(w, place)->kept != 0);
    int32_t i;
    for (i = s->end - 1; i >= s->begin; i--) {
        value = within(value, s->at[i].least, s->at[i].most);
        s->at[i].low = value;
    }
    for (i = s->begin; i < s->end; i++) {
        tell_stretch(w, place, s->at[i].first,
                     (i + 1 < s->end) ? s->at[i + 1].first - 1 : w->end->last, s->at[i].low);
    }
    s->begin = s->middle = s->end = 0;
}

static void gauge_until(gauging *w, int32_t place)
{
    margin_node *o = &w->g->nodes[place];
    margin_parts *s = &o->parts;
    double value = 0.0;
    join_operands(w, place, follow_until);
    while (parts_settled(s, &value)) {
        const int64_t first = s->at[s->begin].first;
        parts_leave(s);
        tell_stretch(w, place, first, (s->end > s->begin) ? s->at[s->begin].first - 1 : o->joined,
                     value);
    }
    if (w->end != NULL) {
        end_until(w, place);
    }
    o->known = (s->end > s->begin) ? s->at[s->begin].first - 1 : o->joined;
}

void gauge_join(gauging *w, int32_t place)
{
    switch (node_plan_of(w, place)->kind) {
    case OP_JUNCTION: join_operands(w, place, tell_junction); break;
    case OP_SINCE: join_operands(w, place, tell_since); break;
    default: gauge_until(w, place); return;
    }
    w->g->nodes[place].known = w->g->nodes[place].joined;
}
