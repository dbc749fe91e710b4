/* The fold of a window as a number that expressions read (CODE_WINDOW), and when it can change although
 * no input does. Numbers are rounded once, from exact sums; they are unknown if a possible member
 * matters. */
#include "formulas/exact.h"
#include "formulas/formulas.h"
#include "formulas/members.h"
#include "input/input.h"

#include <string.h>

/* ---- MIN and MAX */

/* A monotonic wedge: an entry that is not better than the new number expires before it and can never be
 * the extreme again, so it is dropped. The front is then the extreme of the window; amortised O(1). An
 * unknown number beats every entry, and no known number beats an unknown one. */
bool push_extreme(window *w, const rv_number *number)
{
    stretches *s = w->s;
    while (s->count > 0) {
        const rv_number last = member_number(w, s->count - 1, false);
        const int32_t outdoes = (w->fold == FOLD_MIN) ? CMP_LE : CMP_GE;
        if ((number->kind != RV_UNKNOWN)
            && ((last.kind == RV_UNKNOWN) || (compare_numbers(outdoes, number, &last) != IS_TRUE))) {
            break;
        }
        s->count--;
        s[1].count--;
    }
    return (w->n->high < NEVER) || (w->n->most > 0) || (s->count == 0);
}

/* ---- numbers */

static rv_number whole_of(int64_t number)
{
    rv_number found = {RV_WHOLE, {0}};
    found.as.whole = number;
    return found;
}

static rv_number real_of(double number)
{
    rv_number found = {RV_REAL, {0}};
    found.as.real = number;
    return (number - number != 0.0) ? UNKNOWN_NUMBER : found;
}

/* The quotient of two whole numbers, rounded once. */
static rv_number share_of(int64_t number, int64_t by)
{
    uint32_t sum[SUM_LIMBS] = {0};
    const rv_number whole = whole_of(number);
    exact_add(sum, &whole, 1, false);
    return real_of(exact_nearest(sum, by));
}

/* An exact sum divided by `by`, as a whole number if all numbers were whole. Unknown if some number was,
 * or if the two readings, with and without possible members, differ. */
static rv_number sum_of(const window *w, int64_t by)
{
    const uint32_t *sum = w->x->limb;
    int64_t whole;
    if ((w->s->lost > 0)
        || (w->s[1].apart && (memcmp(sum, sum + SUM_LIMBS, SUM_LIMBS * sizeof *sum) != 0))) {
        return UNKNOWN_NUMBER;
    }
    if ((w->fold != FOLD_SUM) || !w->s->left) {
        return real_of(exact_nearest(sum, by));
    }
    return exact_whole(sum, &whole) ? whole_of(whole) : UNKNOWN_NUMBER;
}

/* The current value of the fold. */
static rv_number comes_to(const window *w)
{
    const stretches *s = w->s;
    const bool some = s->count > 0;
    rv_number number = UNKNOWN_NUMBER;
    if (s[1].lost > 0) {
        return number;
    }
    switch (w->fold) {
    case FOLD_COUNT: return (s[1].total > 0) ? number : whole_of(s->total);
    case FOLD_DURATION: return (s[1].total > 0) ? number : share_of(s->total, 1000000000);
    case FOLD_SUM: return sum_of(w, 1);
    case FOLD_INTEGRAL: return sum_of(w, 1000000000);
    case FOLD_MEAN: return (s->total > 0) ? sum_of(w, s->total) : number;
    case FOLD_VARIANCE:
        return ((s->total > 0) && (s->lost == 0))
            ? real_of(exact_variance(w->x->limb, w->x->limb + SUM_LIMBS, s->total)) : number;
    case FOLD_DISTINCT: return (s->lost > 0) ? number : whole_of(s->total);
    case FOLD_DELTA:
        if (s->growing) {
            const rv_number first = member_number(w, 0, false);
            const rv_number last = member_number(w, s->count - 1, false);
            return difference(&last, &first);
        }
        return number;
    case FOLD_AGO:
        return (some && (stretch_of(s, 0)->begin <= w->t - w->n->high)) ? member_number(w, 0, false)
                                                                        : number;
    default: return some ? member_number(w, 0, false) : number;
    }
}

/* ---- instants */

/* Whether the fold stays the same while the last entry grows. */
static bool is_level(const window *w, bool known)
{
    const stretches *s = w->s;
    switch (w->fold) {
    case FOLD_MEAN:
    case FOLD_VARIANCE: return !known || ((s->count == 1) && (w->n->high < NEVER));
    case FOLD_COUNT:
    case FOLD_DURATION:
    case FOLD_SUM:
    case FOLD_INTEGRAL: return !known && !is_counted(w, s->count - 1, false);
    default: return true;
    }
}

/* The next instant at which the fold can change although no input does; it may be early, never late. */
static int64_t moves_at(const window *w, bool known)
{
    const stretches *s = w->s;
    const bool alone = s->growing && (s->count == 1);
    const stretch *first;
    if (s->count == 0) {
        return NEVER;
    }
    first = stretch_of(s, 0);
    switch (w->fold) {
    case FOLD_DISTINCT:
    case FOLD_DELTA:
    case FOLD_MIN:
    case FOLD_MAX: return alone ? NEVER : gone_from(first->end, w->n->high);
    case FOLD_AGO:
        if (first->begin > w->t - w->n->high) {
            return first->begin + w->n->high;
        }
        return alone ? NEVER : gone_from(first->end, w->n->high);
    default: break;
    }
    if (alone && (w->t + w->unit >= gone_from(first->begin, w->n->high))) {
        return NEVER; /* as much comes as goes */
    }
    if (s->growing && !is_level(w, known)) {
        return w->t + w->unit;
    }
    /* An uncertain entry counts until all of it has expired. */
    return alone ? NEVER : gone_from(is_counted(w, 0, false) ? first->begin : first->end, w->n->high);
}

rv_number amount_of(const window *w, int64_t *due)
{
    const rv_number found = comes_to(w);
    *due = moves_at(w, found.kind != RV_UNKNOWN);
    return found;
}
