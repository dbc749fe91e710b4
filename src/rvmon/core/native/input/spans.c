/* Spans of signals: the open interval around a value, between the nearest numbers with which the signal
 * is compared, in which no comparison changes. A value within the span is only held, and runs with
 * captured values that hold it need not be called. */
#include "input/input.h"

#include <math.h>

/* Whether a program reads only constants and captured values, which stay the same for a whole run. */
static bool is_lasting(const plan *p, int32_t place)
{
    const int32_t *word = &p->code[place];
    for (; (*word & 255) != CODE_END; word++) {
        const int32_t op = *word & 255;
        if ((op != CODE_NUMBER) && (op != CODE_CAPTURED) && (arguments_of(op) == 0)) {
            return false;
        }
    }
    return true;
}

static bool is_signal(const plan *p, int32_t place, int32_t local)
{
    const int32_t *word = &p->code[place];
    return ((word[0] & 255) == CODE_SIGNAL) && (word[0] >> 8 == local) && ((word[1] & 255) == CODE_END);
}

/* The number with which an atom compares a signal as long as the run lasts; false: the atom does
 * something else. */
bool compares_with(const run *r, const atom_plan *a, int32_t local, rv_number *constant)
{
    const plan *p = PLAN(r);
    bool found = true;
    if (a->op == ATOM_REAL) {
        constant->kind = RV_REAL;
        constant->as.real = a->constant;
    } else if ((a->op == ATOM_COMPARE) && is_signal(p, a->left, local) && is_lasting(p, a->right)) {
        *constant = program_value(r, a->right, NULL);
    } else if ((a->op == ATOM_COMPARE) && is_signal(p, a->right, local) && is_lasting(p, a->left)) {
        *constant = program_value(r, a->left, NULL);
    } else {
        found = false;
    }
    return found;
}

/* Whether a whole number and both its neighbours are distinct doubles. */
static bool is_exact(const rv_number *whole)
{
    return (whole->as.whole > -(INT64_C(1) << 52)) && (whole->as.whole < (INT64_C(1) << 52));
}

/* Narrow a span around `x` to one side of a constant; false: it is not an exact double, or is `x`. */
static bool bound_span(span *s, double x, const rv_number *constant)
{
    const bool whole = constant->kind == RV_WHOLE;
    const double c = whole ? (double)constant->as.whole : constant->as.real;
    if ((constant->kind == RV_UNKNOWN) || (whole && !is_exact(constant))) {
        return false;
    }
    if (x < c) {
        s->high = (c < s->high) ? c : s->high;
    } else if (x > c) {
        s->low = (c > s->low) ? c : s->low;
    } else {
        return false;
    }
    return true;
}

/* Narrow a span to values of a signal for which every comparison gives the same result as for `value`:
 * the open interval between the nearest numbers with which it is compared. False: it is compared with
 * `value` itself, or with a number that may change, or doubles are too coarse. */
bool narrow_span(const run *r, int32_t local, const rv_number *value, span *s)
{
    const double x = (value->kind == RV_REAL) ? value->as.real : (double)value->as.whole;
    const list atoms = r->part->signals[local].on_change[r->at.phase];
    const int32_t *place = LIST(PLAN(r), atoms);
    bool bounded = (value->kind == RV_REAL) || ((value->kind == RV_WHOLE) && is_exact(value));
    int32_t i;
    for (i = 0; bounded && (i < atoms.count); i++) {
        const atom_plan *a = &r->part->atoms[place[i]];
        rv_number constant;
        bounded = (a->tells == 0) && compares_with(r, a, local, &constant) && bound_span(s, x, &constant);
    }
    return bounded;
}

/* Set the span of a signal: empty if anything else depends on the value (another kind of atom, staleness,
 * history, births still to come). The run of an attempt captures nothing itself. */
void learn_span(run *r, int32_t local)
{
    const signal_plan *s = &r->part->signals[local];
    const uint32_t flags = (uint32_t)s->flags & ~((r->parent != NULL) ? (uint32_t)SIGNAL_CAPTURED : 0U);
    const rv_number *value = &r->value[local];
    const bool may_be_quick = (r->margins == NULL) && (r->part->quick[local].kind != RV_UNKNOWN);
    span found = {-HUGE_VAL, HUGE_VAL};
    r->spans[local] = NO_SPAN;
    /* A signal of take_quickly() has no span: it replaces the value and would not update a span. */
    if (may_be_quick || (flags != 0U) || (s->perishable >= 0) || (r->births[local] < s->births)) {
        return;
    }
    if (narrow_span(r, local, value, &found)) {
        r->spans[local] = found;
    } else if ((value->kind == RV_WHOLE) && is_exact(value)) {
        r->spans[local].low = (double)value->as.whole - 1.0;
        r->spans[local].high = (double)value->as.whole + 1.0;
    } else {
        /* Other values may change a comparison. */
    }
}
