/* Amounts: at how many positions a formula held in the last so many ticks.
 *
 * They are kept as stretches of positions, with their sum. What leaves the window is taken off, so that
 * an update costs what it adds. A duration is the number of ticks, up to the one before this instant;
 * each counts from the instant behind it on, as long as the position of a count, and one more. */
#include "formulas/formulas.h"

static stretch *amount_stretch(const stretches *s, int32_t i)
{
    return &s->at[(s->head + i) & (s->room - 1)];
}

/* Take off what lies before `from`. */
static void leave_before(stretches *s, int64_t from, int64_t unit)
{
    while (s->count > 0) {
        stretch *first = amount_stretch(s, 0);
        int64_t gone;
        if (first->begin >= from) {
            return;
        }
        if ((first->end < from) && !(s->growing && (s->count == 1))) {
            s->total -= (first->end - first->begin) / unit + 1;
            s->head = (s->head + 1) & (s->room - 1);
            s->count--;
            continue;
        }
        gone = least((from - first->begin + unit - 1) / unit, (first->end - first->begin) / unit + 1);
        s->total -= gone;
        first->begin += gone * unit;
        return;
    }
}

/* The next instant at which the truth may be another though nothing comes: a flip, or an instant before
 * it at which a stretch begins or ends to leave the window. */
static int64_t next_flip(const stretches *s, const node_plan *n, int64_t t, int64_t unit, bool holds)
{
    const stretch *first = (s->count > 0) ? amount_stretch(s, 0) : NULL;
    const int64_t missing = n->low - s->total;
    int64_t grown;
    if ((first == NULL) || (holds == s->growing)) {
        return NEVER; /* it grows at least as fast as it shrinks, or does neither */
    }
    if (holds) {
        const bool within = (first->end - first->begin) / unit >= -missing;
        return gone_from(within ? first->begin - missing * unit : first->end, n->high);
    }
    grown = (missing > LIMIT / unit) ? NEVER : t + missing * unit;
    if (s->count == 1) {
        return (grown <= sum(first->begin, n->high)) ? grown : NEVER;
    }
    if (t + unit > sum(first->begin, n->high)) {
        return gone_from(first->end, n->high);
    }
    return least(grown, gone_from(first->begin, n->high));
}

/* One reading: whether there is enough. */
static bool step_amount(run *r, stretches *s, const node_plan *n, int64_t t, bool now, int64_t *due)
{
    const bool lasting = n->a != 0;
    const int64_t unit = lasting ? 1 : step_of(r);
    bool holds;
    if (s->growing) {
        stretch *last = amount_stretch(s, s->count - 1);
        const int64_t end = lasting ? t - 1 : r->at.before;
        if (end > last->end) {
            s->total += (end - last->end) / unit;
            last->end = end;
        }
    }
    s->growing = false;
    if (now) {
        stretch *last = (s->count > 0) ? amount_stretch(s, s->count - 1) : NULL;
        if ((last == NULL) || (last->end + unit != t)) {
            s->count = (n->high == NEVER) ? 0 : s->count; /* nothing is ever taken off */
            last = next_stretch_of(r->home->monitor, s, s->count, true);
            if (last == NULL) {
                return false; /* the run is spoilt */
            }
            last->begin = t;
            last->end = t - unit;
        }
        if (!lasting) {
            last->end = t;
            s->total++;
        }
        s->growing = true;
    }
    if (n->high < NEVER) {
        leave_before(s, t - n->high, unit);
    }
    holds = s->total >= n->low;
    *due = next_flip(s, n, t, unit, holds);
    return holds;
}

uint8_t node_amount(run *r, const node_plan *n, int64_t t, uint8_t operand)
{
    stretches *worse = &r->past[2 * n->slot];
    stretches *better = worse + 1;
    bool holds;
    bool may_hold;
    int64_t due = NEVER;
    int64_t other = NEVER;
    if ((operand == IS_UNKNOWN) && !worse->apart) {
        part_stretches(r->home->monitor, worse, better);
    }
    holds = step_amount(r, worse, n, t, operand == IS_TRUE, &due);
    may_hold = holds;
    if (worse->apart) {
        may_hold = step_amount(r, better, n, t, operand != IS_FALSE, &other);
    }
    due = least(due, other);
    timers_set(&r->wake, n->timer, (due > t) ? due : NEVER); /* forged stretches are no matter */
    return (uint8_t)((holds ? 1U : 0U) + (may_hold ? 1U : 0U)); /* what holds may hold */
}
