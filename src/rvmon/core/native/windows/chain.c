/* Windows within windows over what a letter decides: what is known of them is known in order, so all
 * that has to be kept is where values change.
 *
 * A value of the base changes at some positions; so does the value of each window over it. A stretch
 * on which one position decides begins as far before that of the operand as the window reaches, and
 * ends as its last position leaves the window; shorter gaps vanish. So one change of the base is one
 * of each window: it comes to stand behind the others, or takes the last one away. The lists hold what
 * will be if the letter stays: a change that lies ahead is taken back if it does not.
 *
 * When something is known is told by stamps: 2 t as time comes to t, 2 t + 1 as the letter there is
 * known. From the first unknown letter on there are two readings, the unknown taken for the worse and
 * for the better.
 *
 * Source: AUTOMATA 4. */
#include "windows/windows.h"

#include <string.h>

/* Letters after which what is known is dropped. */
#define FORGETS_EVERY 8

/* The stamp of time `over` ticks behind a position, or of the letter there. */
static int64_t stamp_of(const chaining *g, int64_t position, int64_t over, bool letter)
{
    int64_t t;
    if ((position >= positions_within(g->f.step)) || (over >= LIMIT)) {
        return NEVER_KNOWN;
    }
    t = position * g->f.step + over; /* less than twice LIMIT */
    return (t >= LIMIT) ? NEVER_KNOWN : 2 * t + (letter ? 1 : 0);
}

static const operator_plan *window_at(const chaining *g, int32_t level)
{
    return &g->f.nodes[g->windows[level - 1]];
}

/* The first position from which a window reaches one. */
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

/* Take a change of the base at a position into all levels. */
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
        if (decides == added) { /* what decides begins here, or does not any more */
            start = reached_from(g, position, n->high);
            if (added) {
                added = !((own->count > 0) && (last_change(own) >= start));
            } else { /* the stretch before, if that was joined to it, ends again */
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
            m->spoilt = true; /* no plan of ours comes here */
            return;
        }
    }
}

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

/* Ticks after which a position is known at the latest, or only leads on to later ones. */
static int64_t reach_of(const chaining *g)
{
    int64_t reach = 0;
    int32_t level;
    for (level = 1; level <= g->depth; level++) {
        reach = least(reach + window_at(g, level)->over, LIMIT);
    }
    return reach;
}

/* Drop now and then what lies before all that is not known at a position. */
void forget_before(const chaining *g, int64_t position)
{
    int64_t start;
    int32_t i;
    int32_t level;
    g->c->kept++;
    if ((g->c->kept < FORGETS_EVERY) && !g->c->parted) { /* readings that agree have dropped as much */
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

/* Take the letter at a position; it stays until the next one. */
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

/* The value of the chain at a position, and the stamp as of which it is known. */
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
        bool decides = value_behind(given, i) == (n->turned == 0);
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

/* The first position from one on at which a value is so; NEVER_KNOWN: none if the letter stays. */
static int64_t first_from(changes *c, int64_t position, bool wanted)
{
    const int32_t i = changes_until(c, position);
    if (value_behind(c, i) == wanted) {
        return position;
    }
    return (i < c->count) ? change_at(c, i) : NEVER_KNOWN;
}

/* The first position from one on at which what is kept up is false. */
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

/* The last position before one at which the windows matter. */
static int64_t last_mattering(const chaining *g, chain_reading *w, int64_t behind)
{
    const int32_t i = changes_until(&w->excused, behind - 1);
    int64_t end = behind;
    if (value_behind(&w->excused, i)) {
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

/* The stamp as of which all is known of what is kept up from one position to before another. */
int64_t known_between(const chaining *g, chain_reading *w, int64_t first,
                             int64_t behind)
{
    const int64_t last = last_mattering(g, w, behind);
    int64_t stamp = INT64_MIN;
    if (last >= first) {
        (void)value_of_chain(g, w, last, &stamp);
    }
    return stamp;
}

/* The value of the whole formula, which may keep the chain up until something ends that, and the stamp
 * as of which it is known. */
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
