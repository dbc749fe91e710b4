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

static double real_apart(const atom_plan *a, const measure_plan *m, double value)
{
    const double distance = (value == a->constant) ? 0.0 : value - a->constant; /* of infinite ones, too */
    return signed_by(a->compare, distance * m->factor);
}

/* What a leaf is that shows how a number compares with a constant. */
double measured_real(const atom_plan *a, const measure_plan *m, double value)
{
    const double found = real_apart(a, m, value);
    return (m->turned != 0) ? 0.0 - found : found;
}

/* The distance of the comparison that a leaf shows. */
static margin_range distance_of(const run *r, const measure_plan *m)
{
    const node_plan *n = &r->part->nodes[m->node];
    const atom_plan *a = &r->part->atoms[n->a];
    margin_range found = ANYTHING;
    if (a->op == ATOM_REAL) {
        const rv_number *x = &r->value[a->input];
        if (x->kind == RV_REAL) {
            return exactly(real_apart(a, m, x->as.real));
        }
    } else if (a->op == ATOM_COMPARE) {
        found = of_programs(r, a, m->factor, NULL);
    } else {
        found = of_occurrences(r, a, m->factor);
    }
    /* What is not born is what it is taken for. Once all is, nobody follows the truth of what has a
     * distance. */
    if (is_anything(&found) && ((r->at.phase == 0) || (a->op == ATOM_PAYLOAD) || (n->op == NODE_COMPARED))) {
        found = of_truth(r->truth[m->node]);
    }
    return found;
}

margin_range measured_leaf(const run *r, const measure_plan *m)
{
    margin_range found = {INFINITE, INFINITE};
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
static void tell_other(gauging *w, int32_t place, int64_t at, double value)
{
    margin_node *o = &w->g->nodes[place];
    if (w->sparse || !o->begun || (value != o->carried)) {
        o->begun = true;
        o->carried = value;
        tell_step(w, place, at, value);
    }
}

static void tell_junction(gauging *w, int32_t place, int64_t at)
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
static void tell_since(gauging *w, int32_t place, int64_t at)
{
    const margin_edge *edges = &w->g->edges[w->shape->places[place].edge];
    const margin_range bounds = bounds_of(node_plan_of(w, place), edges);
    margin_node *o = &w->g->nodes[place];
    tell_other(w, place, at, within(o->carried, bounds.low, bounds.high));
}

/* The next step of an operand that was not taken; NULL: there is none. */
static inline const margin_step *next_of(const gauging *w, int32_t operand, const margin_edge *own)
{
    const margin_steps *from;
    if (operand < 0) {
        return NULL; /* it never changes */
    }
    from = &w->g->nodes[operand].out;
    return (own->read < from->end) ? step_at(from, own->read) : NULL;
}

/* Take what operands are at a position; the next one at which one of them changes. */
static inline int64_t take_operands(const gauging *w, const margin_place *shape, int64_t at)
{
    const int32_t *operands = &w->shape->operands[shape->edge];
    margin_edge *edges = &w->g->edges[shape->edge];
    int64_t found = NEVER;
    int32_t i;
    for (i = 0; i < shape->edge_count; i++) {
        const margin_step *next = next_of(w, operands[i], &edges[i]);
        if ((next != NULL) && (next->at == at)) {
            edges[i].value = next->value;
            edges[i].read++;
            next = next_of(w, operands[i], &edges[i]);
        }
        found = (next != NULL) ? least(found, next->at) : found;
    }
    return found;
}

/* Take what operands are at the positions at which one of them changes, up to where all are known. */
static void join_operands(gauging *w, int32_t place, void (*tell)(gauging *w, int32_t place, int64_t at))
{
    const margin_place *shape = &w->shape->places[place];
    const int32_t *operands = &w->shape->operands[shape->edge];
    margin_node *o = &w->g->nodes[place];
    int64_t known = NEVER;
    int64_t at;
    int32_t i;
    for (i = 0; i < shape->edge_count; i++) {
        if (operands[i] >= 0) {
            known = least(known, operand_known(w, operands[i]));
        }
    }
    if (known <= o->joined) {
        return;
    }
    o->joined = known;
    at = take_operands(w, shape, -NEVER);
    while (at <= known) {
        const int64_t next = take_operands(w, shape, at);
        tell(w, place, at);
        at = next;
    }
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
