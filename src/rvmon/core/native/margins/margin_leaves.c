/* The robustness of leaves at the present position, in base units.
 *
 * A comparison of numbers has the distance of its sides; all other leaves are plus or minus infinity, and
 * unknown ones may be anything. */
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

/* The difference of two numbers; that of whole numbers is rounded once. */
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

/* The robustness of a comparison whose left side exceeds the right one by `distance`; never -0.0. */
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

/* The maximum over all combinations of occurrences; minus infinity if there are none. */
static margin_range of_occurrences(const run *r, const atom_plan *a, double factor)
{
    const uint8_t occur = first_choice(r, a->events);
    margin_range found = {-INFINITE, -INFINITE};
    if (occur != IS_TRUE) {
        return (occur == IS_FALSE) ? found : ANYTHING;
    }
    do {
        const bool sure = is_sure_choice(r, a->events);
        const margin_range one = sure ? of_programs(r, a, factor, r->chosen) : ANYTHING;
        found.low = fmax(found.low, one.low);
        found.high = fmax(found.high, one.high);
    } while (next_choice(r, a->events));
    return found;
}

/* Recognise a comparison of a signal with a real constant. */
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

/* The range of a leaf that is a comparison. */
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
    /* An unborn leaf has the range of the truth that it is read as. Once all signals are born, the
     * truths of leaves with a distance are no longer updated. */
    if (is_anything(&found) && ((r->at.phase == 0) || (a->op == ATOM_PAYLOAD) || (n->op == NODE_COMPARED))) {
        found = of_truth(r->truth[m->node]);
    }
    return found;
}

/* The range of a leaf, in base units. */
margin_range measured_leaf(const run *r, const margin_shape *s, int32_t number)
{
    const measure_plan *m = &s->measures[number];
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

/* Whether a leaf changes right after the present position, as it reads an event that occurs there. */
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
