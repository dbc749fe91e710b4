/* The values of a chain of windows, kept as lists of changes (windows.h).
 *
 * The base, and each window over it, has a list of the positions at which its value toggles. If an
 * operand has the value that decides its window alone (TRUE for F, FALSE for G) on [s, e], the window
 * [low, high] has it on [s - high, e - low]. So these stretches start earlier, gaps between them shrink,
 * and a gap that is too short vanishes. Hence one change of the base makes one change of each level: a
 * change is appended to the list, or the last one is removed. A letter costs O(depth), however long
 * windows are.
 *
 * The lists say what will be if the letter stays; a change that lies ahead is removed if it does not.
 * When a value is *known* depends on stamps: value_of_chain() finds the positions that decide it, level
 * by level, and the stamp at which the last of them is known.
 *
 * From the first unknown letter on there are two readings, unknown input taken for the worse and for the
 * better. Source: docs/explanation/automata.md, section 4. */
#include "windows/windows.h"

#include <string.h>

/* Number of letters between two clean-ups, over which their cost is spread. */
#define FORGETS_EVERY 8

/* The stamp of the instant `over` ticks after a position: when time comes there or, for `letter`, once
 * its letter is known. */
static int64_t stamp_of(const chaining *g, int64_t position, int64_t over, bool letter)
{
    int64_t t;
    if ((position >= positions_within(g->f.step)) || (over >= LIMIT)) {
        return NEVER_KNOWN;
    }
    t = position * g->f.step + over; /* less than twice LIMIT */
    return (t >= LIMIT) ? NEVER_KNOWN : 2 * t + (letter ? 1 : 0);
}

/* The window of a level, from 1. */
static const operator_plan *window_at(const chaining *g, int32_t level)
{
    return &g->f.nodes[g->windows[level - 1]];
}

/* The first position whose window reaches `position`; in sampled time, the first sample near enough. */
static int64_t reached_from(const chaining *g, int64_t position, int64_t distance)
{
    changes *stamps = &g->c->stamps;
    int32_t i;
    if (!g->sparse || (distance == 0)) {
        return moved(position, -distance);
    }
    i = changes_until(stamps, moved(position, -distance) - 1);
    return change_at(stamps, (i < stamps->count) ? i : stamps->count - 1);
}

/* Carry a change of the base at a position through all levels; `value` is its value from there on. All
 * levels change in the same direction. On each level either a change is appended at `position`
 * (`added`), or the last one, which was at `position`, is removed. */
static void note_change(const chaining *g, chain_reading *w, int64_t at, bool value)
{
    rv_monitor *m = g->f.monitor;
    int64_t position = at;
    bool added = true;
    int32_t level;
    add_change(m, &w->levels[0], at);
    for (level = 1; level <= g->depth; level++) {
        const operator_plan *n = window_at(g, level);
        const changes *given = &w->levels[level - 1];
        changes *own = &w->levels[level];
        const bool decides = (n->turned != 0) ? !value : value;
        int64_t start;
        if (decides == added) { /* a stretch of the deciding value starts here, or is removed */
            start = reached_from(g, position, n->high);
            if (added) {
                added = !((own->count > 0) && (last_change(own) >= start));
            } else { /* it may have been merged with the stretch before, which now ends on its own */
                position = (given->count > 0) ? moved(last_change(given), -n->low) : start - 1;
                added = position >= start;
                start = position;
            }
        } else {
            start = moved(position, -n->low);
        }
        if (m->spoilt) {
            return;
        }
        if (added) {
            add_change(m, own, start);
            position = start;
        } else if (own->count > 0) {
            position = last_change(own);
            own->count--;
        } else {
            m->spoilt = true; /* only a forged plan or snapshot gets here */
            return;
        }
    }
}

/* Start a reading at a position, as if the letter there had been so all along. */
void begin_reading(const chaining *g, chain_reading *w, int64_t position, int32_t bit)
{
    int32_t level;
    for (level = 0; level <= g->depth; level++) {
        clear_changes(&w->levels[level], (g->c->letter[BASE] & bit) != 0);
    }
    clear_changes(&w->ends, (g->c->letter[LEFT] & bit) != 0);
    clear_changes(&w->excused, (g->c->letter[EXCUSED] & bit) != 0);
    w->start = position;
}

/* Number of ticks after which a position of the whole chain is known at the latest. */
static int64_t reach_of(const chaining *g)
{
    int64_t reach = 0;
    int32_t level;
    for (level = 1; level <= g->depth; level++) {
        reach = least(reach + window_at(g, level)->over, LIMIT);
    }
    return reach;
}

/* Drop changes and samples on which no unknown position can depend: those further back than the chain
 * reaches. `position` is that of the current letter. */
void forget_before(const chaining *g, int64_t position)
{
    int64_t start;
    int32_t i;
    int32_t level;
    g->c->kept++;
    if ((g->c->kept < FORGETS_EVERY) && !g->c->parted) { /* two readings: always, so that equal ones
                                                          * have equal lists */
        return;
    }
    g->c->kept = 0;
    start = moved(moved(position, -floored(reach_of(g), g->f.step)), -2);
    if (g->sparse) {
        changes *stamps = &g->c->stamps;
        while ((stamps->count > 1) && (change_at(stamps, 0) < start)) {
            stamps->head = (stamps->head + 1) & (stamps->room - 1);
            stamps->count--;
        }
        start = (stamps->count > 0) ? change_at(stamps, 0) : start;
    }
    for (i = 0; i < (g->c->parted ? 2 : 1); i++) {
        chain_reading *w = &g->c->readings[i];
        for (level = 0; level <= g->depth; level++) {
            drop_changes(&w->levels[level], start);
        }
        drop_changes(&w->ends, start);
        drop_changes(&w->excused, start);
        w->start = (start > w->start) ? start : w->start;
    }
}

static bool readings_agree(const chaining *g)
{
    const chain_reading *a = &g->c->readings[0];
    const chain_reading *b = &g->c->readings[1];
    int32_t level;
    for (level = 0; level <= g->depth; level++) {
        if (!changes_agree(&a->levels[level], &b->levels[level])) {
            return false;
        }
    }
    return changes_agree(&a->ends, &b->ends) && changes_agree(&a->excused, &b->excused)
           && (a->start == b->start);
}

/* At the first unknown letter, the better reading starts as a copy of the worse one. */
static void split_readings(const chaining *g)
{
    const chain_reading *w = &g->c->readings[0];
    chain_reading *made = &g->c->readings[1];
    int32_t level;
    for (level = 0; level <= g->depth; level++) {
        copy_changes(g->f.monitor, &made->levels[level], &w->levels[level]);
    }
    copy_changes(g->f.monitor, &made->ends, &w->ends);
    copy_changes(g->f.monitor, &made->excused, &w->excused);
    made->start = w->start;
    g->c->parted = true;
}

/* Whether nothing in a letter is unknown. */
bool is_known(const uint8_t *letter)
{
    int32_t i;
    for (i = 0; i < FOLLOWED; i++) {
        if ((letter[i] == 1U) || (letter[i] == 2U)) {
            return false;
        }
    }
    return true;
}

/* Take a new letter, from a position on. */
void note_letter(const chaining *g, int64_t position, const uint8_t *letter)
{
    chain *c = g->c;
    int32_t i;
    if (!is_known(letter) && !c->parted) {
        split_readings(g);
    }
    for (i = 0; i < (c->parted ? 2 : 1); i++) {
        const uint8_t bit = (i == 0) ? 1U : 2U;
        chain_reading *w = &c->readings[i];
        if (((letter[LEFT] ^ c->letter[LEFT]) & bit) != 0U) {
            add_change(g->f.monitor, &w->ends, position);
        }
        if (((letter[EXCUSED] ^ c->letter[EXCUSED]) & bit) != 0U) {
            add_change(g->f.monitor, &w->excused, position);
        }
        if (((letter[BASE] ^ c->letter[BASE]) & bit) != 0U) {
            note_change(g, w, position, (letter[BASE] & bit) != 0U);
        }
    }
    (void)memcpy(c->letter, letter, FOLLOWED);
    forget_before(g, position);
    if (c->parted && is_known(letter) && readings_agree(g)) {
        c->parted = false;
    }
}

/* The value of the chain at a position if the letter stays, and the stamp at which it is known.
 *
 * From the outermost window inwards: if a position of the window has the deciding value, the first such
 * position has to be known; else all have to be known, so the last one of the window, and the window has
 * to be over (`over`). At the end `position` is the position of the base that is known last. */
static bool value_of_chain(const chaining *g, chain_reading *w, int64_t at, int64_t *stamp)
{
    changes *stamps = &g->c->stamps;
    int64_t position = at;
    int64_t over = INT64_MIN;
    bool value = false;
    int32_t level;
    for (level = g->depth; level >= 1; level--) {
        const operator_plan *n = window_at(g, level);
        changes *given = &w->levels[level - 1];
        int64_t first = moved(position, n->low);
        const int32_t i = changes_until(given, first);
        bool decides = value_after(given, i) == (n->turned == 0);
        if (!decides) {
            if ((i < given->count) && (change_at(given, i) <= moved(position, n->high))) {
                decides = true;
                first = change_at(given, i);
            } else {
                const int64_t own = stamp_of(g, position, n->over, false);
                over = (own > over) ? own : over;
                first = moved(position, n->high);
                if (g->sparse) {
                    const int32_t k = changes_until(stamps, first);
                    first = change_at(stamps, (k > 0) ? k - 1 : 0);
                }
            }
        }
        if (level == g->depth) {
            value = decides == (n->turned == 0);
        }
        position = first;
    }
    *stamp = stamp_of(g, position, 0, true);
    *stamp = (over > *stamp) ? over : *stamp;
    return value;
}

/* The first position at or after another at which a value is `wanted`; NEVER_KNOWN: none if the letter
 * stays. */
static int64_t first_from(changes *c, int64_t position, bool wanted)
{
    const int32_t i = changes_until(c, position);
    if (value_after(c, i) == wanted) {
        return position;
    }
    return (i < c->count) ? change_at(c, i) : NEVER_KNOWN;
}

/* The first position at or after another at which the chain is false and not excused. */
int64_t first_failure(const chaining *g, chain_reading *w, int64_t position)
{
    int64_t at = position;
    for (;;) {
        int64_t matters;
        at = first_from(&w->levels[g->depth], at, false);
        matters = (at == NEVER_KNOWN) ? at : first_from(&w->excused, at, false);
        if (matters == at) {
            return at;
        }
        at = matters;
    }
}

/* The last position before another at which the chain is not excused; INT64_MIN: none is known. */
static int64_t last_mattering(const chaining *g, chain_reading *w, int64_t stop)
{
    const int32_t i = changes_until(&w->excused, stop - 1);
    int64_t end = stop;
    if (value_after(&w->excused, i)) {
        if (i == 0) {
            return INT64_MIN;
        }
        end = change_at(&w->excused, i - 1);
    }
    if (g->sparse) {
        const int32_t k = changes_until(&g->c->stamps, end - 1);
        return (k > 0) ? change_at(&g->c->stamps, k - 1) : INT64_MIN;
    }
    return end - 1;
}

/* The stamp at which it is known that the chain held, or was excused, on [first, stop). As values
 * become known in order, it is the stamp of the last position that matters. */
int64_t known_between(const chaining *g, chain_reading *w, int64_t first,
                             int64_t stop)
{
    const int64_t last = last_mattering(g, w, stop);
    int64_t stamp = INT64_MIN;
    if (last >= first) {
        (void)value_of_chain(g, w, last, &stamp);
    }
    return stamp;
}

/* The value of the whole formula for an attempt at a position, and the stamp at which it is known: the
 * chain there, or the chain at every position until, and including, the one where `ends` holds. */
bool outcome_of(const chaining *g, chain_reading *w, int64_t at, int64_t *stamp)
{
    int64_t position = at;
    int64_t ends;
    int64_t fails;
    if (g->f.form->left < 0) {
        return value_of_chain(g, w, at, stamp);
    }
    position = later(position, w->start);
    ends = first_from(&w->ends, position, true);
    fails = first_failure(g, w, position);
    if ((fails < ends) || ((fails == ends) && (fails != NEVER_KNOWN))) {
        (void)value_of_chain(g, w, fails, stamp);
        *stamp = later(*stamp, stamp_of(g, fails, 0, true));
        return false;
    }
    if (ends == NEVER_KNOWN) {
        *stamp = NEVER_KNOWN;
        return false;
    }
    *stamp = later(stamp_of(g, ends, 0, true), known_between(g, w, position, ends + 1));
    return true;
}
