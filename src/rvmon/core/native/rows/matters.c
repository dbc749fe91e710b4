/* Which updates of a signal or event can change something, and between which numbers a value can move
 * and compare as it does. */
#include "rows/rows.h"

#include <math.h>

/* Whether a program is a number and nothing else, and which. */
static bool is_number(const plan *p, int32_t place, rv_number *number)
{
    const int32_t *word = &p->code[place];
    const number_plan *own = &p->numbers[word[0] >> 8];
    if (((word[0] & 255) != CODE_NUMBER) || ((word[1] & 255) != CODE_END)) {
        return false;
    }
    number->kind = (int32_t)own->kind;
    if (number->kind == RV_REAL) {
        number->as.real = own->as.real;
    } else {
        number->as.whole = own->as.whole;
    }
    return true;
}

static bool is_signal(const plan *p, int32_t place, int32_t local)
{
    const int32_t *word = &p->code[place];
    return ((word[0] & 255) == CODE_SIGNAL) && (word[0] >> 8 == local) && ((word[1] & 255) == CODE_END);
}

/* The constant that an atom compares a signal with, if it does no more. */
static bool compares_with(const run *r, const atom_plan *a, int32_t local, rv_number *constant)
{
    const plan *p = PLAN(r);
    if (a->op == ATOM_REAL) {
        constant->kind = RV_REAL;
        constant->as.real = a->constant;
        return true;
    }
    return (a->op == ATOM_COMPARE)
           && ((is_signal(p, a->left, local) && is_number(p, a->right, constant))
               || (is_number(p, a->left, constant) && is_signal(p, a->right, local)));
}

static bool all_with_constants(const run *r, const signal_plan *s, int32_t local, int32_t kind)
{
    const list atoms = s->on_change[r->at.phase];
    const int32_t *place = LIST(PLAN(r), atoms);
    rv_number constant;
    int32_t i;
    for (i = 0; i < atoms.count; i++) {
        if (!compares_with(r, &r->part->atoms[place[i]], local, &constant)
            || ((kind == RV_COLUMN_REAL) && (constant.kind != RV_REAL))) {
            return false;
        }
    }
    return true;
}

/* Which updates of a signal can change something in a run; sleeping runs of a part hold what the first
 * one does. */
static int32_t signal_matters(const home *h, const column_watch *w, int32_t local)
{
    const run *r = h->root;
    const signal_plan *s = &h->part->signals[local];
    const bool apart = h->part->plan->captured > 0;
    if (((s->flags & (SIGNAL_MARKS | SIGNAL_HISTORY)) != 0) || (r->births[local] < s->births)
        || (r->absent[local] != 0U) || (apart && (s->perishable >= 0))
        || (((s->flags & SIGNAL_CAPTURED) != 0) && (GAP(r) != 1))) {
        return EACH_UPDATE;
    }
    if (apart || ((s->flags & SIGNAL_CAPTURED) != 0)
        || (w->column->kind == RV_COLUMN_BYTE)
        || !all_with_constants(r, s, local, w->column->kind)) {
        return EACH_VALUE;
    }
    return BY_CONSTANTS;
}

void learn_how(const batch *s, column_watch *w)
{
    int32_t i;
    w->how = w->is_event ? OCCURRENCES : BY_CONSTANTS;
    w->perishable = false;
    for (i = 0; i < w->reader_count; i++) {
        const home *h = home_of(s, w, i);
        const int32_t local = w->readers[i].local;
        int32_t own;
        if (w->is_event) {
            own = ((h->part->events[local].flags & EVENT_MARKS) != 0) ? EACH_UPDATE : OCCURRENCES;
        } else {
            own = signal_matters(h, w, local);
            w->perishable = w->perishable || (h->part->signals[local].perishable >= 0);
        }
        own = holds_back(h) ? EACH_UPDATE : own;
        w->how = (own < w->how) ? own : w->how;
    }
    if (w->reader_count == 0) {
        w->how = NO_UPDATES;
    }
}

/* What is on another side of a real constant compares otherwise than the last value. */
static void bound_real(column_watch *w, double constant)
{
    if (w->last.as.real <= constant) {
        w->high = (constant < w->high) ? constant : w->high;
    }
    if (w->last.as.real >= constant) {
        w->low = (constant > w->low) ? constant : w->low;
    }
}

/* The same of whole numbers, beside a constant of either kind. */
static void bound_whole(column_watch *w, const rv_number *constant)
{
    const int64_t last = w->last.as.whole;
    int64_t below; /* the largest whole number that is not above the constant */
    bool is_whole = true;
    if (constant->kind == RV_WHOLE) {
        below = constant->as.whole;
    } else if (!(constant->as.real >= -0x1p62) || !(constant->as.real <= 0x1p62)) {
        w->floor = last; /* too far to say more */
        w->ceiling = last;
        return;
    } else {
        const double rounded = floor(constant->as.real);
        below = (int64_t)rounded;
        is_whole = rounded == constant->as.real;
    }
    if (!is_whole) {
        w->ceiling = (last <= below) ? least(w->ceiling, below + 1) : w->ceiling;
        w->floor = ((last > below) && (below > w->floor)) ? below : w->floor;
    } else {
        w->ceiling = (last <= below) ? least(w->ceiling, below) : w->ceiling;
        w->floor = ((last >= below) && (below > w->floor)) ? below : w->floor;
    }
}

/* Learn what compares as the last value does: see `learn_span`. */
void learn_between(const batch *s, column_watch *w)
{
    rv_number constant;
    int32_t i;
    int32_t k;
    w->low = -HUGE_VAL;
    w->high = HUGE_VAL;
    w->floor = INT64_MIN;
    w->ceiling = INT64_MAX;
    for (i = 0; (w->last.kind != RV_UNKNOWN) && (i < w->reader_count); i++) {
        const run *r = root_of(s, w, i);
        const int32_t local = w->readers[i].local;
        const list atoms = r->part->signals[local].on_change[r->at.phase];
        const int32_t *place = LIST(PLAN(r), atoms);
        for (k = 0; k < atoms.count; k++) {
            (void)compares_with(r, &r->part->atoms[place[k]], local, &constant);
            if (w->last.kind == RV_REAL) {
                bound_real(w, constant.as.real);
            } else {
                bound_whole(w, &constant);
            }
        }
    }
}

bool compares_alike(const column_watch *w, const rv_number *value)
{
    const double x = value->as.real;
    if ((value->kind == RV_UNKNOWN) || (value->kind != w->last.kind)) {
        return value->kind == w->last.kind;
    }
    if (value->kind == RV_REAL) {
        return ((w->low < x) && (x < w->high)) || (x == w->last.as.real);
    }
    return ((w->floor < value->as.whole) && (value->as.whole < w->ceiling))
           || (value->as.whole == w->last.as.whole);
}
