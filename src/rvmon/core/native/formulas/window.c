/* WINDOW nodes: collecting the members of a position, expiring old ones, folding the rest.
 *
 * A position has one member, or one for each occurrence of the event whose field is the number. Blank
 * positions, which may not exist, have a member that may not be one. members.c keeps the members. */
#include "formulas/formulas.h"
#include "formulas/members.h"
#include "input/input.h"

/* A number as a fold reads it: an infinite one is unknown. */
static rv_number within_range(rv_number number)
{
    const bool infinite = (number.kind == RV_REAL) && (number.as.real - number.as.real != 0.0);
    return infinite ? UNKNOWN_NUMBER : number;
}

/* Add one occurrence of an event, if the comparisons among the operands from `chosen` on hold for its
 * fields; `operand`: the truth of the first operand. */
static void collect_occurrence(window *w, int32_t event, int32_t which, uint8_t operand)
{
    run *r = w->r;
    const int32_t *nodes = LIST(PLAN(r), w->n->operands);
    const bool known = r->payloads[event].known[which] != 0U;
    rv_number number = UNKNOWN_NUMBER;
    uint8_t truth = known ? operand : IS_UNKNOWN;
    int32_t i;
    r->chosen[event] = which;
    for (i = w->n->chosen; known && (i < w->n->operands.count); i++) {
        const atom_plan *a = &r->part->atoms[r->part->nodes[nodes[i]].a];
        const rv_number left = program_value(r, a->left, r->chosen);
        const rv_number right = program_value(r, a->right, r->chosen);
        const int32_t one = compare_numbers(a->compare, &left, &right);
        truth = (one < truth) ? (uint8_t)one : truth;
    }
    if (truth != IS_FALSE) {
        if (known) {
            number = within_range(program_value(r, r->part->atoms[w->n->a].left, r->chosen));
        }
        w->s->growing = add_member(w, &number, truth != IS_TRUE);
    }
}

/* Add the occurrences of an event: several at this position, or those that comparisons select. */
static void collect_occurrences(window *w, int32_t event, uint8_t operand)
{
    run *r = w->r;
    const int32_t *nodes = LIST(PLAN(r), w->n->operands);
    const int32_t count = r->payloads[event].count;
    int32_t i;
    for (i = w->n->chosen; i < w->n->operands.count; i++) {
        if (r->truth[nodes[i]] == IS_FALSE) {
            return; /* the comparison holds for no occurrence, or is unborn */
        }
    }
    if ((r->silent[event] == IS_UNKNOWN) || (count == 0)) {
        w->s->growing = add_member(w, &UNKNOWN_NUMBER, true);
    } else if ((w->n->most > 0) && (count > 1)) {
        forget_members(w); /* occurrences of one position have no order: the last N are not defined */
    } else {
        for (i = 0; i < count; i++) {
            collect_occurrence(w, event, i, operand);
        }
    }
}

/* The number of the member at this position. Over fields of several events it is unknown if one of the
 * events occurs more than once, as there is no single combination. */
static rv_number number_now(const run *r, const atom_plan *a)
{
    const int32_t *events = LIST(PLAN(r), a->events);
    int32_t i;
    for (i = 0; i < a->events.count; i++) {
        if (r->payloads[events[i]].count > 1) {
            return UNKNOWN_NUMBER;
        }
    }
    return within_range(program_value(r, a->left, NULL));
}

/* Whether the number of all members is a constant, which is known at blank positions, too. */
static bool is_constant(const run *r, const atom_plan *a)
{
    const int32_t *word = &PLAN(r)->code[a->left];
    return ((word[0] & 255) == CODE_NUMBER) && ((word[1] & 255) == CODE_END);
}

/* Add the members of this position, where the first operand is not FALSE. */
static void collect_members(window *w, uint8_t operand, bool blank)
{
    run *r = w->r;
    const node_plan *n = w->n;
    const int32_t *nodes = LIST(PLAN(r), n->operands);
    rv_number number = {RV_WHOLE, {1}};
    if ((n->most > 0) && (operand != IS_TRUE)) {
        forget_members(w); /* it may be one of the last N, or not */
    } else if ((n->b & WINDOW_COUNTED) != 0) {
        const uint8_t counted = r->truth[nodes[1]];
        number.as.whole = (counted == IS_FALSE) ? 0 : 1;
        w->s->growing = add_member(w, &number, counted == IS_UNKNOWN);
    } else if (n->a < 0) {
        w->s->growing = add_member(w, &number, operand != IS_TRUE);
    } else {
        const atom_plan *a = &r->part->atoms[n->a];
        const int32_t event = (a->events.count == 1) ? LIST(PLAN(r), a->events)[0] : -1;
        if (blank && !is_constant(r, a)) {
            w->s->growing = add_member(w, &UNKNOWN_NUMBER, true);
        } else if ((event >= 0)
                   && ((n->chosen < n->operands.count) || (r->payloads[event].count > 1))) {
            collect_occurrences(w, event, operand);
        } else {
            number = number_now(r, a);
            w->s->growing = add_member(w, &number, operand != IS_TRUE);
        }
    }
}

/* Empty a window that starts with an attempt (`since`). */
void restart_window(run *r, const node_plan *n)
{
    window w = {r, n, &r->past[2 * n->slot], (n->sum < 0) ? NULL : &r->tallies[n->sum], 0, 1, 0, false,
                -1};
    forget_members(&w);
    w.s->growing = false;
}

/* Whether a window starts later than `t`, so that blank positions before are not its members. */
static bool has_not_begun(const run *r, const node_plan *n, int64_t t)
{
    return (n->since >= 0) && (r->captured[n->since].kind == RV_WHOLE)
           && (t - r->at.sure_from < r->captured[n->since].as.whole);
}

/* Publish the fold as the number that CODE_WINDOW reads; if it changed, comparisons with it are marked.
 * Returns the node's truth, which says whether the number is known. */
static uint8_t publish_number(run *r, const node_plan *n, const rv_number *number, bool blank)
{
    rv_number *place = &r->amounts[n->low];
    if (blank) {
        *place = UNKNOWN_NUMBER;
    } else if (!same_number(place, number)) {
        *place = *number;
        mark_parents(r, n, NODE_COMPARED);
    } else {
        /* Equal to the last number: no node above changes. */
    }
    return (place->kind == RV_UNKNOWN) ? IS_UNKNOWN : IS_TRUE;
}

/* Evaluate a WINDOW node at `t`. MIN and MAX of the last N members are windows over member numbers
 * instead of instants: `t` is then the number of the last member, `unit` 1. */
uint8_t node_window(run *r, const node_plan *n, int64_t t, uint8_t operand, bool blank)
{
    const int32_t fold = n->b & WINDOW_FOLD;
    const bool of_ticks = (fold == FOLD_DURATION) || (fold == FOLD_INTEGRAL);
    const bool counts = (fold >= FOLD_MIN) && (n->most > 0);
    window w = {r, n, &r->past[2 * n->slot], (n->sum < 0) ? NULL : &r->tallies[n->sum], t,
                of_ticks ? 1 : step_of(r), fold, of_ticks, -1};
    int64_t due;
    uint8_t found;
    if (counts) {
        w.t = w.s->total - 1;
        w.unit = 1;
    }
    w.s->apart = true; /* there is a second ring */
    if (w.s->growing && (w.s->count > 0) && !counts) {
        extend_last_member(&w, of_ticks ? t - 1 : r->at.before);
    }
    w.s->growing = false;
    if ((operand != IS_FALSE) && !(blank && has_not_begun(r, n, t))) {
        collect_members(&w, operand, blank);
    }
    expire_members(&w);
    if ((n->b & WINDOW_NUMBER) != 0) {
        const rv_number number = amount_of(&w, &due);
        found = publish_number(r, n, &number, blank);
    } else {
        found = folded(&w, &due);
    }
    if (n->most > 0) {
        due = w.s->growing ? t + w.unit : NEVER; /* the next position has a member, too */
    }
    /* In sampled time the node is evaluated at each sample, without a timer. */
    timers_set(&r->wake, n->timer, ((GAP(r) > 0) && (due > t)) ? due : NEVER);
    return found;
}
