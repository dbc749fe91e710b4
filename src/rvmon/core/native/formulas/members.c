/* The members of a window, kept as entries of equal members (members.h), with running counters and sums.
 *
 * Members are added to counters and sums when they come and subtracted when they expire, so a window of
 * any length costs amortised O(1) per change. Sums are exact (exact.h): subtracting leaves no error.
 *
 * DURATION and INTEGRAL have a member for each tick before the current instant, the other folds one for
 * each position. A window is bounded by time (`high`), by number (`most`), or not at all; in the last
 * case only what the fold still needs is kept. */
#include "formulas/exact.h"
#include "formulas/formulas.h"
#include "formulas/members.h"
#include "input/input.h"

#include <math.h>
#include <string.h>

/* What the members of entry `i` have in common. */
static stretch *kept_of(const stretches *s, int32_t i)
{
    return stretch_of(s + 1, i);
}

/* The number in an entry. Its bits may come from a forged snapshot, so one that is not finite is
 * unknown. */
static rv_number number_of(const stretch *kept)
{
    rv_number found = UNKNOWN_NUMBER;
    found.kind = (int32_t)(kept->begin & MEMBER_KIND);
    found.as.whole = kept->end;
    if (found.kind == RV_REAL) {
        (void)memcpy(&found.as.real, &kept->end, sizeof kept->end);
    }
    if ((found.kind != RV_WHOLE)
        && ((found.kind != RV_REAL) || !(fabs(found.as.real) <= 0x1.fffffffffffffp1023))) {
        found = UNKNOWN_NUMBER;
    }
    return found;
}

static bool is_below_zero(const rv_number *number)
{
    return (number->kind == RV_WHOLE) ? (number->as.whole < 0) : (number->as.real < 0.0);
}

/* A number in one reading of a sum: that of a possible member counts if it makes the worse reading
 * smaller, or the better one greater; otherwise it is 0. */
static rv_number read_as(const rv_number *number, bool maybe, bool better)
{
    rv_number found = *number;
    if (maybe && (is_below_zero(number) == better)) {
        found.kind = RV_WHOLE;
        found.as.whole = 0;
    }
    return found;
}

rv_number member_number(const window *w, int32_t i, bool better)
{
    const stretch *kept = kept_of(w->s, i);
    const rv_number number = number_of(kept);
    return (number.kind == RV_UNKNOWN) ? number
                                       : read_as(&number, (kept->begin & MEMBER_MAYBE) != 0, better);
}

bool is_counted(const window *w, int32_t i, bool better)
{
    const stretch *kept = kept_of(w->s, i);
    return (kept->end != 0) && (better || ((kept->begin & MEMBER_MAYBE) == 0));
}

/* From the first possible member on, keep a second sum for the better reading. */
static void split_sums(window *w)
{
    if (!w->s[1].apart) {
        (void)memcpy(w->x->limb + SUM_LIMBS, w->x->limb, SUM_LIMBS * sizeof *w->x->limb);
        w->s[1].apart = true;
    }
}

/* Add `count` members with a number to the sums, or subtract them (`off`). */
static void add_number(window *w, const rv_number *number, bool maybe, int64_t count, bool off)
{
    const rv_number worse = read_as(number, maybe, false);
    if (maybe) {
        split_sums(w);
    }
    w->s->left = w->s->left && (number->kind == RV_WHOLE);
    w->s[1].right = w->s[1].right || is_below_zero(number);
    exact_add(w->x->limb, &worse, count, off);
    if (w->fold == FOLD_VARIANCE) {
        exact_add_square(w->x->limb + SUM_LIMBS, &worse, count, off);
    } else if (w->s[1].apart) {
        const rv_number better = read_as(number, maybe, true);
        exact_add(w->x->limb + SUM_LIMBS, &better, count, off);
    } else {
        /* Both readings are the first sum. */
    }
}

/* Add to a counter. Those of a forged snapshot may wrap around, which is harmless: they index nothing. */
static void add_count(int64_t *x, int64_t more)
{
    *x = (int64_t)((uint64_t)*x + (uint64_t)more);
}

/* Add `count` members of an entry to the counters and sums, or subtract them (`off`). */
static void add_members(window *w, const stretch *kept, int64_t count, bool off)
{
    const bool maybe = (kept->begin & MEMBER_MAYBE) != 0;
    const int64_t more = off ? -count : count;
    stretches *s = w->s;
    add_count(&s->members, keeps_extremes(w) ? 0 : more);
    if (!off && (w->n->most > 0)) {
        s[1].lost -= least(s[1].lost, count);
    }
    if ((w->fold == FOLD_COUNT) || (w->fold == FOLD_DURATION)) {
        add_count(&s[maybe ? 1 : 0].total, (kept->end != 0) ? more : 0);
    } else if ((w->fold == FOLD_DELTA) || (w->fold >= FOLD_MIN)) {
        /* DELTA, MIN, MAX, AGO read single entries: nothing is counted. */
    } else {
        const rv_number number = number_of(kept);
        if (number.kind == RV_UNKNOWN) {
            add_count(&s->lost, more);
        } else if (w->fold != FOLD_DISTINCT) {
            add_number(w, &number, maybe, count, off);
            add_count(&s->total, more);
        } else {
            /* DISTINCT counts numbers when entries start and end. */
        }
    }
}

/* Extend the last entry, which still holds, up to `end`. */
void extend_last_member(window *w, int64_t end)
{
    stretch *last = stretch_of(w->s, w->s->count - 1);
    if (end > last->end) {
        add_members(w, kept_of(w->s, w->s->count - 1), (end - last->end) / w->unit, false);
        last->end = end;
    }
}

/* Append an entry, empty so far; false: memory is short, and the run is spoilt. */
static bool begin_member(window *w, const stretch *kept)
{
    stretches *s = w->s;
    const bool grows = s->count == s->room;
    stretch *last = stretch_slot(w->r->home->monitor, s, s->count, true);
    stretch *own = stretch_slot(w->r->home->monitor, s + 1, s[1].count, true);
    if ((last == NULL) || (own == NULL)) {
        s->count = 0;
        s[1].count = 0;
        return false;
    }
    if (grows) {
        s->known_slots = -1; /* the ring moved: places in the table of distinct.c are void */
    }
    last->begin = w->t;
    last->end = w->t - w->unit;
    *own = *kept;
    return true;
}

/* Prepare for an entry with another number than the last one's; returns whether to append it.
 *
 * MIN, MAX: a monotonic wedge. DISTINCT: the latest entry of a number represents it, and older ones are
 * marked; without bounds nothing expires, so one entry per number is enough. For the other folds without
 * bounds only the last entry is kept, and for DELTA also the first. */
static bool admit_member(window *w, const rv_number *number)
{
    stretches *s = w->s;
    const bool ever = (w->n->high == NEVER) && (w->n->most == 0);
    if (keeps_extremes(w)) {
        return push_extreme(w, number);
    }
    if (w->fold == FOLD_DISTINCT) {
        const int32_t same = (number->kind == RV_UNKNOWN) ? -1 : find_latest(w, number);
        if (ever && (number->kind == RV_UNKNOWN)) {
            s->lost = 1;
        } else if ((same >= 0) && !ever) {
            s[1].at[same].begin |= MEMBER_OLDER;
        } else {
            s->total += ((number->kind != RV_UNKNOWN) && (same < 0)) ? 1 : 0;
        }
        return !ever || ((number->kind != RV_UNKNOWN) && (same < 0));
    }
    if (ever) { /* nothing expires: older entries are in the counters */
        s->count = ((w->fold == FOLD_DELTA) && (s->count > 0)) ? 1 : 0;
        s[1].count = s->count;
    }
    return true;
}

/* Add a member at `w->t`: extend the last entry if it is equal and adjacent, else append one. `maybe`: it
 * may not be a member. Sums and counts then have two readings; the other folds (MEAN, MAX, ...) take its
 * number for unknown. Returns whether there is an entry that may continue. */
bool add_member(window *w, const rv_number *number, bool maybe)
{
    stretches *s = w->s;
    stretch kept = {number->kind, 0};
    if (keeps_extremes(w) && (w->n->most > 0)) {
        w->t = s->total;
        s->total++;
    }
    if (number->kind == RV_REAL) {
        (void)memcpy(&kept.end, &number->as.real, sizeof kept.end);
    } else if (number->kind == RV_WHOLE) {
        kept.end = number->as.whole;
    } else {
        /* Unknown: kind and bits are 0. */
    }
    if (maybe && ((w->fold == FOLD_COUNT) || (w->fold == FOLD_DURATION) || (w->fold == FOLD_SUM)
                  || (w->fold == FOLD_INTEGRAL))) {
        kept.begin |= (number->kind == RV_UNKNOWN) ? 0 : MEMBER_MAYBE;
    } else if (maybe) {
        kept.begin = RV_UNKNOWN;
        kept.end = 0;
    } else {
        /* A certain member. */
    }
    if ((s->count == 0) || (stretch_of(s, s->count - 1)->end != w->t - w->unit)
        || (kept_of(s, s->count - 1)->begin != kept.begin)
        || (kept_of(s, s->count - 1)->end != kept.end)) {
        const rv_number own = number_of(&kept);
        if (!admit_member(w, &own) || !begin_member(w, &kept)) {
            return false;
        }
        if ((w->fold == FOLD_DISTINCT) && (own.kind != RV_UNKNOWN)) {
            note_latest(w);
        }
        if ((w->x != NULL) && ((kept.begin & MEMBER_MAYBE) != 0)) {
            split_sums(w); /* now, although for an INTEGRAL the first tick is still to come */
        }
    }
    if (!w->of_ticks) {
        extend_last_member(w, w->t);
    }
    return true;
}

/* Let `gone` members of the oldest entry expire. The last entry stays, though empty, while it grows. */
static void remove_from_oldest(window *w, int64_t gone)
{
    stretches *s = w->s;
    stretch *first = stretch_of(s, 0);
    const stretch *kept = kept_of(s, 0);
    const int64_t held = (first->end - first->begin) / w->unit + 1;
    add_members(w, kept, gone, true);
    if ((gone < held) || (s->growing && (s->count == 1))) {
        first->begin += gone * w->unit;
        return;
    }
    if ((w->fold == FOLD_DISTINCT) && ((kept->begin & MEMBER_OLDER) == 0)
        && (number_of(kept).kind != RV_UNKNOWN)) {
        s->total--;
    }
    s->head = (s->head + 1) & (s->room - 1);
    s[1].head = (s[1].head + 1) & (s[1].room - 1);
    s->count--;
    s[1].count--;
}

/* Let members expire that exceed `most`, or are before the window at `w->t`. */
void expire_members(window *w)
{
    stretches *s = w->s;
    const bool counts = keeps_extremes(w) && (w->n->most > 0); /* `t` is the number of a member */
    const int64_t high = counts ? w->n->most - 1 : w->n->high;
    const int64_t from = (high < NEVER) ? w->t - high : INT64_MIN;
    while ((w->n->most > 0) && (s->count > 0) && (s->members > w->n->most)) {
        const stretch *first = stretch_of(s, 0);
        remove_from_oldest(w, least(s->members - w->n->most,
                                    (first->end - first->begin) / w->unit + 1));
    }
    while ((s->count > 0) && (stretch_of(s, 0)->begin < from)) {
        const stretch *first = stretch_of(s, 0);
        const int64_t held = (first->end - first->begin) / w->unit + 1;
        const int64_t gone = least((from - first->begin + w->unit - 1) / w->unit, held);
        const bool continues = s->growing && (s->count == 1);
        remove_from_oldest(w, gone);
        if ((gone < held) || continues) {
            return;
        }
    }
}

/* Drop all members. The fold of a window over the last N is then unknown until N new members have
 * come. */
void forget_members(window *w)
{
    stretches *s = w->s;
    s->count = 0;
    s[1].count = 0;
    s->total = 0;
    s[1].total = 0;
    s->lost = 0;
    s->members = 0;
    s->known_slots = -1;
    s[1].lost = w->n->most;
    if (w->x != NULL) {
        (void)memset(w->x, 0, sizeof *w->x);
    }
}
