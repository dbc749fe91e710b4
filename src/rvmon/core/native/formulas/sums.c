/* Sums, means and integrals: the numbers of the last so many ticks, added up exactly.
 *
 * They are kept as stretches of positions with one number each. What leaves the window is taken off: a
 * sum in fixed point that has every bit of a double forgets nothing, so it is the same whatever came
 * and went before. An integral counts ticks, up to the one before this instant; the others positions.
 *
 * Source: Kulisch, Computer Arithmetic and Validity, 2008 (the long accumulator). */
#include "formulas/formulas.h"
#include "input/input.h"

#include <math.h>
#include <string.h>

#define LOWEST 1088 /* minus the exponent of the lowest bit */

/* What a number is, where it is known, in a ring beside that of the stretches: its kind, and its bits. */
static stretch *number_at(const stretches *s, int32_t i)
{
    return &s[1].at[(s[1].head + i) & (s[1].room - 1)];
}

static stretch *stretch_of(const stretches *s, int32_t i)
{
    return &s->at[(s->head + i) & (s->room - 1)];
}

static rv_number number_of(const stretch *kept)
{
    rv_number found = UNKNOWN_NUMBER;
    found.kind = (int32_t)kept->begin;
    found.as.whole = kept->end;
    if (found.kind == RV_REAL) {
        (void)memcpy(&found.as.real, &kept->end, sizeof kept->end);
    }
    if ((found.kind != RV_WHOLE) && ((found.kind != RV_REAL) || !(fabs(found.as.real) <= 0x1.fffffffffffffp1023))) {
        found = UNKNOWN_NUMBER;
    }
    return found;
}

/* Add the product of two numbers times 2^bit to a sum, or take it off. */
static void add_product(exact_sum *x, uint64_t a, uint64_t b, int32_t bit, bool off)
{
    const uint64_t low = (a & UINT32_MAX) * (b & UINT32_MAX);
    const uint64_t one = (a & UINT32_MAX) * (b >> 32);
    const uint64_t other = (a >> 32) * (b & UINT32_MAX);
    const uint64_t high = (a >> 32) * (b >> 32);
    const uint64_t middle = (low >> 32) + (one & UINT32_MAX) + (other & UINT32_MAX);
    const uint64_t upper = (middle >> 32) + (one >> 32) + (other >> 32) + high;
    const uint32_t word[6] = {0, (uint32_t)low, (uint32_t)middle, (uint32_t)upper, (uint32_t)(upper >> 32), 0};
    const int32_t by = bit % 32;
    uint64_t carry = 0;
    int32_t i;
    for (i = 0; (i < 5) || (carry != 0); i++) {
        const int32_t place = bit / 32 + i;
        const uint64_t both = (i < 5) ? (((uint64_t)word[i + 1] << 32) | word[i]) : 0;
        const uint64_t digit = ((both << by) >> 32) & UINT32_MAX;
        uint64_t made;
        if (place >= SUM_LIMBS) {
            return;
        }
        made = off ? x->limb[place] - digit - carry : x->limb[place] + digit + carry;
        x->limb[place] = (uint32_t)made;
        carry = (made >> 32) & 1;
    }
}

/* Add a number so many times, or take it off. */
static void add_times(exact_sum *x, const rv_number *number, int64_t times, bool off)
{
    uint64_t size;
    int exponent = 0;
    bool negative;
    if (number->kind == RV_WHOLE) {
        negative = number->as.whole < 0;
        size = negative ? UINT64_C(0) - (uint64_t)number->as.whole : (uint64_t)number->as.whole;
    } else {
        negative = number->as.real < 0.0;
        size = (uint64_t)ldexp(frexp(fabs(number->as.real), &exponent), 53);
        exponent -= 53;
    }
    if (exponent < -LOWEST) {
        size >>= -LOWEST - exponent; /* of the smallest, these bits are 0 */
        exponent = -LOWEST;
    }
    add_product(x, size, (uint64_t)times, exponent + LOWEST, negative != off);
}

/* The members of a window, some positions more, or fewer. */
static void add_members(stretches *s, exact_sum *x, const rv_number *number, int64_t count, bool off)
{
    if (number->kind == RV_UNKNOWN) {
        x->lost += off ? -count : count;
    } else {
        add_times(x, number, count, off);
        s->total += off ? -count : count;
    }
}

/* What is compared: a sum with so many times a limit. */
typedef struct {
    rv_number limit;
    int64_t asked;             /* times */
    int64_t more;              /* per step */
    rv_number comes;           /* at each step; unknown: nothing does */
    rv_number goes;
    bool strict;
} asking;

/* What the sum is above that, after so many steps. */
static exact_sum rest_after(const exact_sum *x, const asking *a, int64_t steps)
{
    exact_sum rest = *x;
    if (a->comes.kind != RV_UNKNOWN) {
        add_times(&rest, &a->comes, steps, false);
    }
    if (a->goes.kind != RV_UNKNOWN) {
        add_times(&rest, &a->goes, steps, true);
    }
    add_times(&rest, &a->limit, a->asked + a->more * steps, true);
    return rest;
}

static bool is_negative(const exact_sum *x)
{
    return (x->limb[SUM_LIMBS - 1] >> 31) != 0;
}

static bool is_enough(const exact_sum *rest, bool strict)
{
    int32_t i;
    for (i = 0; strict && (i < SUM_LIMBS); i++) {
        if (rest->limb[i] != 0) {
            return !is_negative(rest);
        }
    }
    return !strict && !is_negative(rest);
}

/* About how much it is, in units of its lowest bit: its three highest limbs. */
static double roughly(const exact_sum *x, int32_t *exponent)
{
    const uint32_t sign = is_negative(x) ? UINT32_MAX : 0;
    double found = 0.0;
    int32_t i = SUM_LIMBS - 1;
    int32_t k;
    while ((i > 2) && (x->limb[i] == sign)) {
        i--;
    }
    for (k = i; k > i - 3; k--) {
        found = found * 0x1p32 + (double)(x->limb[k] ^ sign);
    }
    *exponent = 32 * (i - 2);
    return (sign != 0) ? -found : found;
}

/* The first of some steps after which there is enough, or no longer; `most`: after so many it is so.
 * The rest is a line: where it crosses 0 is worked out roughly, then found among what is near. */
static int64_t first_step(const exact_sum *x, const asking *a, int64_t most, bool holds)
{
    const exact_sum now = rest_after(x, a, 0);
    const exact_sum last = rest_after(x, a, most);
    int64_t low = 0;
    int64_t high = most;
    int32_t exponent;
    int32_t other;
    const double begin = fabs(roughly(&now, &exponent));
    const double end = fabs(roughly(&last, &other));
    const double ratio = (begin > 0.0) ? ldexp(end / begin, other - exponent) : HUGE_VAL;
    const double guess = (double)most / (1.0 + ratio);
    const double near = 2.0 + guess * 0x1p-40;
    if ((guess + near < (double)most) && (guess + near < 0x1p62)) {
        const exact_sum rest = rest_after(x, a, (int64_t)(guess + near));
        if (is_enough(&rest, a->strict) != holds) {
            high = (int64_t)(guess + near);
        }
    }
    if (guess > near) {
        const exact_sum rest = rest_after(x, a, (int64_t)(guess - near));
        if (is_enough(&rest, a->strict) == holds) {
            low = (int64_t)(guess - near);
        }
    }
    while (high - low > 1) {
        const int64_t middle = low + (high - low) / 2;
        const exact_sum rest = rest_after(x, a, middle);
        if (is_enough(&rest, a->strict) != holds) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return high;
}

/* The next instant at which the truth may be another though nothing comes. */
static int64_t sum_flips_at(const run *r, const stretches *s, const exact_sum *x, const node_plan *n,
                         asking *a, int64_t t, bool holds)
{
    const bool mean = n->b % SUM_STRICT == SUM_MEAN;
    const int64_t unit = (n->b % SUM_STRICT == SUM_INTEGRAL) ? 1 : step_of(r);
    const stretch *first;
    exact_sum rest;
    int64_t leaves_at;
    int64_t steps;
    bool leaving;
    if ((GAP(r) == 0) || (s->count == 0)) {
        return NEVER; /* each sample is looked at */
    }
    first = stretch_of(s, 0);
    leaves_at = gone_from(first->begin, n->high);
    if (x->lost > 0) {
        return (s->growing && (s->count == 1)) ? NEVER : gone_from(first->end, n->high);
    }
    leaving = t + unit >= leaves_at;
    if (s->growing) {
        a->comes = number_of(number_at(s, s->count - 1));
        if (a->comes.kind == RV_UNKNOWN) {
            return t + unit;
        }
        if (leaving && (s->count == 1)) {
            return NEVER; /* as much comes as goes */
        }
    } else if (!leaving) {
        return leaves_at;
    } else {
        /* It goes. */
    }
    a->more = mean ? ((s->growing ? 1 : 0) - (leaving ? 1 : 0)) : 0;
    if (leaving) {
        a->goes = number_of(number_at(s, 0));
        steps = (first->end - first->begin) / unit + 1;
    } else {
        steps = (leaves_at == NEVER) ? LIMIT / unit / 2 : (leaves_at - 1 - t) / unit;
    }
    rest = rest_after(x, a, steps);
    if (is_enough(&rest, a->strict) == holds) {
        return leaving ? t + steps * unit : leaves_at;
    }
    return t + first_step(x, a, steps, holds) * unit;
}

/* Take off what lies before `from`. */
static void members_leave(stretches *s, exact_sum *x, int64_t from, int64_t unit)
{
    while (s->count > 0) {
        stretch *first = stretch_of(s, 0);
        const rv_number number = number_of(number_at(s, 0));
        const int64_t held = (first->end - first->begin) / unit + 1;
        const int64_t gone = least((from - first->begin + unit - 1) / unit, held);
        if (first->begin >= from) {
            return;
        }
        add_members(s, x, &number, gone, true);
        if ((gone < held) || (s->growing && (s->count == 1))) {
            first->begin += gone * unit;
            return;
        }
        s->head = (s->head + 1) & (s->room - 1);
        s[1].head = (s[1].head + 1) & (s[1].room - 1);
        s->count--;
        s[1].count--;
    }
}

/* Have the last number go on up to a position. */
static void members_grow(stretches *s, exact_sum *x, int64_t end, int64_t unit)
{
    stretch *last = stretch_of(s, s->count - 1);
    if (end > last->end) {
        const rv_number number = number_of(number_at(s, s->count - 1));
        add_members(s, x, &number, (end - last->end) / unit, false);
        last->end = end;
    }
}

/* Begin a stretch of another number; false: memory is short, and the run is spoilt. */
static bool begin_stretch(run *r, stretches *s, const node_plan *n, const rv_number *number, int64_t t,
                          int64_t unit)
{
    stretch *last;
    stretch *kept;
    if (n->high == NEVER) {
        s->count = 0; /* nothing of it is taken off */
        s[1].count = 0;
    }
    last = next_stretch_of(r->home->monitor, s, s->count, true);
    kept = next_stretch_of(r->home->monitor, s + 1, s[1].count, true);
    if ((last == NULL) || (kept == NULL)) {
        s->count = 0;
        s[1].count = 0;
        return false;
    }
    last->begin = t;
    last->end = t - unit;
    kept->begin = number->kind;
    kept->end = (number->kind == RV_UNKNOWN) ? 0 : number->as.whole;
    if (number->kind == RV_REAL) {
        (void)memcpy(&kept->end, &number->as.real, sizeof kept->end);
    }
    return true;
}

/* The number that is added; unknown if it is infinite, or if several occurrences have one. */
static rv_number member_now(const run *r, const node_plan *n)
{
    const atom_plan *a = &r->part->atoms[n->a];
    const int32_t *events = LIST(PLAN(r), a->events);
    rv_number found;
    int32_t i;
    for (i = 0; i < a->events.count; i++) {
        if (r->payloads[events[i]].count > 1) {
            return UNKNOWN_NUMBER;
        }
    }
    found = program_value(r, a->left, NULL);
    if ((found.kind == RV_REAL) && (found.as.real - found.as.real != 0.0)) {
        found = UNKNOWN_NUMBER;
    }
    return found;
}

static bool same_as_last(const stretches *s, const rv_number *number, int64_t before)
{
    rv_number last;
    if ((s->count == 0) || (stretch_of(s, s->count - 1)->end != before)) {
        return false;
    }
    last = number_of(number_at(s, s->count - 1));
    return (last.kind == number->kind) && same_number(&last, number);
}

uint8_t node_sum(run *r, const node_plan *n, int64_t t, uint8_t operand)
{
    stretches *s = &r->past[2 * n->slot];
    exact_sum *x = &r->sums[n->sum];
    const int32_t kind = n->b % SUM_STRICT;
    const bool of_ticks = kind == SUM_INTEGRAL;
    const int64_t unit = of_ticks ? 1 : step_of(r);
    asking a = {program_value(r, (int32_t)n->low, NULL), 1, 0, UNKNOWN_NUMBER, UNKNOWN_NUMBER,
                n->b >= SUM_STRICT};
    int64_t due = NEVER;
    uint8_t found = IS_UNKNOWN;
    s->apart = true; /* there is a ring of numbers, too */
    if (s->growing) {
        members_grow(s, x, of_ticks ? t - 1 : r->at.before, unit);
    }
    s->growing = false;
    if (operand != IS_FALSE) {
        const rv_number number = (operand == IS_TRUE) ? member_now(r, n) : UNKNOWN_NUMBER;
        if (!same_as_last(s, &number, t - unit) && !begin_stretch(r, s, n, &number, t, unit)) {
            return IS_UNKNOWN;
        }
        if (!of_ticks) {
            members_grow(s, x, t, unit);
        }
        s->growing = true;
    }
    if (n->high < NEVER) {
        members_leave(s, x, t - n->high, unit);
    }
    if ((a.limit.kind == RV_REAL) && (a.limit.as.real - a.limit.as.real != 0.0)) {
        a.limit = UNKNOWN_NUMBER;
    }
    a.asked = of_ticks ? INT64_C(1000000000) : ((kind == SUM_MEAN) ? s->total : 1);
    if ((x->lost == 0) && (a.limit.kind != RV_UNKNOWN) && ((kind != SUM_MEAN) || (s->total > 0))) {
        const exact_sum rest = rest_after(x, &a, 0);
        found = truth_if(is_enough(&rest, a.strict));
    }
    if (a.limit.kind != RV_UNKNOWN) {
        due = sum_flips_at(r, s, x, n, &a, t, found == IS_TRUE);
    }
    timers_set(&r->wake, n->timer, (due > t) ? due : NEVER); /* forged stretches are no matter */
    return found;
}
