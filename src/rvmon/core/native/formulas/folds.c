/* The fold of a window compared with its limit, and the next instant (`due`; NEVER: none) at which that
 * comparison can flip although no input changes.
 *
 * Between changes at most the last entry grows and the oldest one shrinks, each by one member per step.
 * So counts and sums are piecewise linear in time, and the next flip is found by solving for it. The
 * timer may be early (then the node is evaluated again), never late. */
#include "formulas/exact.h"
#include "formulas/formulas.h"
#include "formulas/members.h"
#include "input/input.h"

#include <math.h>
#include <string.h>

/* ---- COUNT, DURATION, DISTINCT: whole numbers of members, or of ticks */

/* The least whole number that satisfies the limit, within +-LIMIT. */
static int64_t least_whole(const rv_number *limit, bool strict)
{
    double up;
    if (limit->kind == RV_WHOLE) {
        const int64_t near = (limit->as.whole < -LIMIT) ? -LIMIT : least(limit->as.whole, LIMIT);
        return near + (strict ? 1 : 0);
    }
    up = ceil(limit->as.real);
    up += (strict && (up == limit->as.real)) ? 1.0 : 0.0;
    return (up >= 0x1p62) ? LIMIT : ((up <= -0x1p62) ? -LIMIT : (int64_t)up);
}

/* The next instant at which a count can pass `enough`, or an earlier one at which an entry starts or
 * ends expiring, where it is computed again. */
static int64_t count_flips_at(const window *w, int64_t value, int64_t enough, bool better)
{
    const stretches *s = w->s;
    const bool holds = value >= enough;
    const bool alone = s->growing && (s->count == 1);
    const bool comes = s->growing && is_counted(w, s->count - 1, better);
    const stretch *first;
    int64_t leaves_at;
    int64_t grown;
    bool expires;
    if ((s->count == 0) || (holds == comes)) {
        return NEVER; /* it grows at least as fast as it shrinks, or does neither */
    }
    first = stretch_of(s, 0);
    leaves_at = gone_from(first->begin, w->n->high);
    expires = is_counted(w, 0, better);
    if (holds) {
        const int64_t spare = value - enough;
        const bool within = expires && ((first->end - first->begin) / w->unit >= spare);
        return within ? gone_from(first->begin + spare * w->unit, w->n->high)
                      : (alone ? NEVER : gone_from(first->end, w->n->high));
    }
    grown = (enough - value > LIMIT / w->unit) ? NEVER : w->t + (enough - value) * w->unit;
    if (w->t + w->unit < leaves_at) {
        return (!alone || (grown < leaves_at)) ? least(grown, alone ? NEVER : leaves_at) : NEVER;
    }
    if (alone) {
        return NEVER; /* as much comes as goes */
    }
    return expires ? gone_from(first->end, w->n->high) : least(grown, gone_from(first->end, w->n->high));
}

/* A counter, which a forged snapshot may have made negative or huge. */
static int64_t counted(int64_t x)
{
    return (x < 0) ? 0 : least(x, LIMIT);
}

/* COUNT, DURATION: TRUE if the certain members are enough, FALSE if the possible ones are not. */
static uint8_t folded_count(const window *w, int64_t enough, int64_t *due)
{
    const int64_t sure = counted(w->s->total);
    const int64_t possible = counted(sure + counted(w->s[1].total));
    const int32_t last = w->s->count - 1;
    *due = count_flips_at(w, sure, enough, false);
    if ((possible > sure)
        || (w->s->growing && (is_counted(w, last, false) != is_counted(w, last, true)))) {
        *due = least(*due, count_flips_at(w, possible, enough, true));
    }
    return (uint8_t)((sure >= enough ? 1U : 0U) + (possible >= enough ? 1U : 0U));
}

/* DISTINCT: at least `spare` entries have to expire before there are too few. An unknown number may be
 * a new one. */
static uint8_t folded_distinct(const window *w, int64_t enough, int64_t *due)
{
    const stretches *s = w->s;
    const int64_t found = counted(s->total);
    const bool holds = found >= enough;
    if ((s->count > 0) && (holds || (s->lost > 0))) {
        const int64_t spare = holds ? found - enough : 0;
        *due = gone_from(stretch_of(s, (int32_t)least(spare, s->count - 1))->end, w->n->high);
    }
    return holds ? IS_TRUE : ((s->lost > 0) ? IS_UNKNOWN : IS_FALSE);
}

/* ---- SUM, INTEGRAL, MEAN, VARIANCE: exact sums */

/* sum + steps * (comes - expires) >= (asked + steps * more) * limit, or > if strict. */
typedef struct {
    rv_number limit;
    int64_t factor;            /* factor of the limit: 1; for MEAN, the members; for INTEGRAL, 10^9 */
    int64_t more;              /* change of `factor` per step */
    rv_number comes;           /* what is added at each step; unknown: nothing */
    rv_number expires;         /* what expires at each step; unknown: nothing */
    bool strict;
} comparison;

/* An exact sum. */
typedef struct {
    uint32_t limb[SUM_LIMBS];
} exact_rest;

/* The left side minus the right one, after some steps. */
static exact_rest rest_after(const uint32_t *sum, const comparison *a, int64_t steps)
{
    exact_rest found;
    (void)memcpy(found.limb, sum, sizeof found.limb);
    if (a->comes.kind != RV_UNKNOWN) {
        exact_add(found.limb, &a->comes, steps, false);
    }
    if (a->expires.kind != RV_UNKNOWN) {
        exact_add(found.limb, &a->expires, steps, true);
    }
    exact_add(found.limb, &a->limit, a->factor + a->more * steps, true);
    return found;
}

static bool is_enough_after(const uint32_t *sum, const comparison *a, int64_t steps)
{
    const exact_rest found = rest_after(sum, a, steps);
    return exact_is_enough(found.limb, a->strict);
}

/* The first step after which the comparison differs from now (`holds`); after `most` steps it does. The
 * rest is a line. Where it crosses 0 is estimated in doubles, which narrows the range; the exact step is
 * then found by halving. */
static int64_t first_step(const uint32_t *sum, const comparison *a, int64_t most, bool holds)
{
    const exact_rest now = rest_after(sum, a, 0);
    const exact_rest last = rest_after(sum, a, most);
    int64_t low = 0;
    int64_t high = most;
    int32_t exponent;
    int32_t other;
    const double begin = fabs(exact_roughly(now.limb, &exponent));
    const double end = fabs(exact_roughly(last.limb, &other));
    const double ratio = (begin > 0.0) ? ldexp(end / begin, other - exponent) : HUGE_VAL;
    const double guess = (double)most / (1.0 + ratio);
    const double near = 2.0 + guess * 0x1p-40;
    if ((guess + near < (double)most) && (guess + near < 0x1p62)
        && (is_enough_after(sum, a, (int64_t)(guess + near)) != holds)) {
        high = (int64_t)(guess + near);
    }
    if ((guess > near) && (is_enough_after(sum, a, (int64_t)(guess - near)) == holds)) {
        low = (int64_t)(guess - near);
    }
    while (high - low > 1) {
        const int64_t middle = low + (high - low) / 2;
        if (is_enough_after(sum, a, middle) != holds) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return high;
}

/* The next instant at which a comparison can flip although no input changes. Completes `a` with the
 * numbers that come and go at each step from here on. */
static int64_t sum_flips_at(const window *w, const uint32_t *sum, comparison *a, bool better,
                            bool holds)
{
    const stretches *s = w->s;
    const bool mean = w->fold == FOLD_MEAN;
    const bool alone = s->growing && (s->count == 1);
    const stretch *first;
    int64_t leaves_at;
    int64_t steps;
    bool leaving;
    if ((s->count == 0) || (!holds && !s->growing && !mean && !s[1].right)) {
        return NEVER; /* without negative numbers a sum can only shrink */
    }
    first = stretch_of(s, 0);
    leaves_at = gone_from(first->begin, w->n->high);
    leaving = w->t + w->unit >= leaves_at;
    if (s->growing) {
        a->comes = member_number(w, s->count - 1, better);
        if (a->comes.kind == RV_UNKNOWN) {
            return w->t + w->unit;
        }
        if (leaving && alone) {
            return NEVER; /* as much comes as goes */
        }
    } else if (!leaving) {
        return leaves_at;
    } else {
        /* The oldest entry expires from now on. */
    }
    a->more = mean ? ((s->growing ? 1 : 0) - (leaving ? 1 : 0)) : 0;
    if (leaving) {
        a->expires = member_number(w, 0, better);
        steps = (first->end - first->begin) / w->unit + 1;
    } else {
        steps = (leaves_at == NEVER) ? LIMIT / w->unit / 2 : (leaves_at - 1 - w->t) / w->unit;
    }
    if (is_enough_after(sum, a, steps) == holds) {
        return leaving ? w->t + steps * w->unit : leaves_at;
    }
    return w->t + first_step(sum, a, steps, holds) * w->unit;
}

/* SUM, INTEGRAL, MEAN, in both readings if there are two. */
static uint8_t folded_sum(const window *w, const rv_number *limit, int64_t *due)
{
    const int32_t readings = w->s[1].apart ? 2 : 1;
    uint8_t found = 0;
    int32_t i;
    for (i = 0; i < readings; i++) {
        const uint32_t *sum = w->x->limb + i * SUM_LIMBS;
        comparison a = {*limit, 1, 0, UNKNOWN_NUMBER, UNKNOWN_NUMBER, (w->n->b & WINDOW_STRICT) != 0};
        bool holds;
        a.factor = w->of_ticks ? INT64_C(1000000000) /* the limit is in seconds, the sum in ticks */
                              : ((w->fold == FOLD_MEAN) ? counted(w->s->total) : 1);
        holds = is_enough_after(sum, &a, 0);
        *due = least(*due, sum_flips_at(w, sum, &a, i > 0, holds));
        found = (uint8_t)(found + (holds ? 3 - readings : 0));
    }
    return found;
}

/* VARIANCE is not linear between changes, so while it moves it is evaluated at each position. */
static uint8_t folded_variance(const window *w, const rv_number *limit, int64_t *due)
{
    const stretches *s = w->s;
    const uint32_t *squares = w->x->limb + SUM_LIMBS;
    if (s->growing && (s->count > 1)) {
        *due = w->t + w->unit;
    } else if (s->count > 0) {
        *due = s->growing ? NEVER : gone_from(stretch_of(s, 0)->begin, w->n->high);
    } else {
        /* An empty window stays empty. */
    }
    return truth_if(exact_varies(w->x->limb, squares, counted(s->total), limit,
                                 (w->n->b & WINDOW_STRICT) != 0));
}

/* DELTA: the last number minus the first one; UNKNOWN if this position has no member. */
static uint8_t folded_delta(const window *w, const rv_number *limit, int64_t *due)
{
    const stretches *s = w->s;
    exact_rest found = {{0}};
    rv_number first;
    rv_number last;
    if (!s->growing) {
        return IS_UNKNOWN;
    }
    first = member_number(w, 0, false);
    last = member_number(w, s->count - 1, false);
    if (s->count > 1) {
        *due = gone_from(stretch_of(s, 0)->end, w->n->high);
    }
    if ((first.kind == RV_UNKNOWN) || (last.kind == RV_UNKNOWN)) {
        return IS_UNKNOWN;
    }
    exact_add(found.limb, &last, 1, false);
    exact_add(found.limb, &first, 1, true);
    exact_add(found.limb, limit, 1, true);
    return truth_if(exact_is_enough(found.limb, (w->n->b & WINDOW_STRICT) != 0));
}

/* The truth of the comparison. It is UNKNOWN if the limit is unknown, if a number is (for a sum, until it
 * has expired), or if a mean has no members. */
uint8_t folded(window *w, int64_t *due)
{
    const stretches *s = w->s;
    rv_number limit = program_value(w->r, (int32_t)w->n->low, NULL);
    *due = NEVER;
    if ((limit.kind == RV_REAL) && (limit.as.real - limit.as.real != 0.0)) {
        limit = UNKNOWN_NUMBER;
    }
    if ((limit.kind == RV_UNKNOWN) || (s[1].lost > 0)) {
        return IS_UNKNOWN;
    }
    switch (w->fold) {
    case FOLD_COUNT:
    case FOLD_DURATION:
        return folded_count(w, least_whole(&limit, (w->n->b & WINDOW_STRICT) != 0), due);
    case FOLD_DISTINCT:
        return folded_distinct(w, least_whole(&limit, (w->n->b & WINDOW_STRICT) != 0), due);
    case FOLD_DELTA: return folded_delta(w, &limit, due);
    default: break;
    }
    if (s->lost > 0) {
        if ((s->count > 0) && !(s->growing && (s->count == 1))) {
            *due = gone_from(stretch_of(s, 0)->end, w->n->high);
        }
        return IS_UNKNOWN;
    }
    if ((s->total == 0) && ((w->fold == FOLD_MEAN) || (w->fold == FOLD_VARIANCE))) {
        return IS_UNKNOWN;
    }
    return (w->fold == FOLD_VARIANCE) ? folded_variance(w, &limit, due) : folded_sum(w, &limit, due);
}
