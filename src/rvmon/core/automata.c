/* Automata: one attempt through positions and through time.
 *
 * A row is a location with a region for each clock; the edge of a row and a class of letters says
 * where the attempt goes, and which old clock each new one is. */
#include "state.h"

#include <string.h>



machine machine_of(const run *r, int32_t index)
{
    machine a;
    a.whole = PLAN(r);
    a.plan = &a.whole->automata[r->part->judges[index].automaton];
    a.gap = GAP(r);
    a.step = (a.gap > 0) ? a.gap : 1;
    return a;
}

/* The class of a letter of which there are too many for a table: the digits that matter are asked
 * for one after the other. */
static int32_t class_by_diagram(const run *r, const judge_plan *j, bool better)
{
    const int32_t *propositions = LIST(PLAN(r), j->propositions);
    int32_t at = j->diagram;
    do {
        const int32_t *one = &PLAN(r)->ints[at];
        const int32_t truth = r->truth[propositions[one[0]]];
        const int32_t digit = one[1 + truth + (better ? 3 : 0)];
        at = one[8 + digit];
    } while (at >= 0);
    return ~at;
}

int32_t class_of_letter(const run *r, int32_t index, bool better)
{
    const judge_plan *j = &r->part->judges[index];
    if (j->diagram >= 0) {
        return class_by_diagram(r, j, better);
    }
    return PLAN(r)->ints[PLAN(r)->automata[j->automaton].class_of
                         + (better ? r->judges[index].better : r->judges[index].worse)];
}

/* Where the cuts of a clock of a location begin. */
static int32_t clock_place(const machine *a, int32_t location, int32_t clock)
{
    return location * a->plan->clocks + clock;
}

static int32_t width_of(const machine *a, int32_t location)
{
    return a->whole->ints[a->plan->widths + location];
}

static int32_t row_of(const machine *a, const token *k, int64_t t)
{
    const int32_t *ints = a->whole->ints;
    const int32_t *first = &ints[a->plan->cut_first];
    const int64_t *cuts = &a->whole->ticks[a->plan->cuts];
    const int32_t width = width_of(a, k->location);
    int32_t row = ints[a->plan->bases + k->location];
    int32_t c;
    for (c = 0; c < width; c++) {
        const int32_t at = clock_place(a, k->location, c);
        const int64_t age = t - k->clocks[c];
        int32_t i;
        for (i = first[at]; (i < first[at + 1]) && (age >= cuts[i]); i++) {
            row += ints[a->plan->strides + at];
        }
    }
    return row;
}

bool step_token(const machine *a, token *k, int64_t t, int32_t letter)
{
    const int32_t *ints = a->whole->ints;
    const int32_t was = k->location;
    const int32_t number = ints[a->plan->edges + row_of(a, k, t) * a->plan->classes + letter];
    const int32_t target = ints[a->plan->targets + number];
    const int32_t *sources = &ints[a->plan->sources + number * a->plan->clocks];
    const int32_t width = width_of(a, target);
    bool moved = target != was;
    int64_t old[CLOCKS_MOST];
    int32_t c;
    if (width == 1) { /* as mostly */
        const int64_t anchor = (sources[0] < 0) ? t : k->clocks[sources[0]];
        moved = moved || (anchor != k->clocks[0]);
        k->clocks[0] = anchor;
    } else if (width > 1) {
        (void)memcpy(old, k->clocks, (size_t)a->plan->clocks * sizeof *old);
        for (c = 0; c < width; c++) {
            const int64_t anchor = (sources[c] < 0) ? t : old[sources[c]];
            moved = moved || (anchor != old[c]);
            k->clocks[c] = anchor;
        }
    } else {
        /* It has none. */
    }
    k->location = target;
    return moved;
}

bool rests(const machine *a, const token *k, int64_t t, int32_t letter)
{
    token next;
    int64_t clocks[CLOCKS_MOST];
    if (a->gap == 0) {
        return false;
    }
    (void)memcpy(clocks, k->clocks, (size_t)a->plan->clocks * sizeof *clocks);
    next.location = k->location;
    next.clocks = clocks;
    return !step_token(a, &next, t + a->step, letter);
}

int64_t next_cut(const machine *a, const token *k, int64_t t, const int64_t *before)
{
    const int32_t *first = &a->whole->ints[a->plan->cut_first];
    const int64_t *cuts = &a->whole->ticks[a->plan->cuts];
    const int32_t width = width_of(a, k->location);
    int64_t found = NEVER;
    int32_t c;
    for (c = 0; c < width; c++) {
        const int32_t at = clock_place(a, k->location, c);
        int32_t i = first[at];
        if ((before != NULL) && (before[c] != k->clocks[c])) {
            continue;
        }
        while ((i < first[at + 1]) && (k->clocks[c] + cuts[i] <= t)) {
            i++;
        }
        if (i < first[at + 1]) {
            found = least(found, k->clocks[c] + cuts[i]);
        }
    }
    return found;
}

/* Let time pass from `t` to `until` without a position; returns the instant of the decision, or the
 * next at which there may be one. */
int64_t settle_token(const machine *a, token *k, int64_t t, int64_t until)
{
    int64_t cut = next_cut(a, k, t, NULL);
    while (cut <= until) {
        const int32_t truth = a->whole->ints[a->plan->time_values + row_of(a, k, cut)];
        if (truth != IS_UNKNOWN) {
            k->location = (truth == IS_TRUE) ? PASSED : FAILED;
            break;
        }
        cut = next_cut(a, k, cut, NULL);
    }
    return cut;
}

/* Whether a step led to the same place: each clock is as it was, or went on with time. */
static bool loops(const machine *a, int32_t was, const int64_t *before, const token *behind,
                  bool *slides)
{
    const int32_t width = width_of(a, behind->location);
    bool loop = was == behind->location;
    int32_t c;
    *slides = false;
    for (c = 0; loop && (c < width); c++) {
        if (behind->clocks[c] != before[c]) {
            *slides = true;
            loop = behind->clocks[c] == before[c] + a->step;
        }
    }
    return loop;
}

/* Step a token through equal letters at `first` and each position up to `last`, jumping where it
 * only loops; returns the instant of the decision, or when it will not just loop on. */
int64_t run_token(const machine *a, token *k, int32_t letter, int64_t first, int64_t last,
                  bool *slides)
{
    int64_t position = first;
    int64_t due = NEVER;
    for (;;) {
        int64_t before[CLOCKS_MOST];
        int32_t was;
        bool slid = false;
        if (a->step > 1) {
            due = settle_token(a, k, position - a->step, least(position - 1, last));
            if (k->location <= PASSED) {
                break;
            }
        }
        if (position > last) {
            due = (a->step == 1) ? position : least(position, due);
            break;
        }
        was = k->location;
        (void)memcpy(before, k->clocks, (size_t)a->plan->clocks * sizeof *before);
        (void)step_token(a, k, position, letter);
        if (k->location <= PASSED) {
            due = position;
            break;
        }
        if (loops(a, was, before, k, &slid)) {
            const int64_t cut = next_cut(a, k, position, before);
            const int64_t ahead = (least(cut - 1, last) - position) / a->step * a->step;
            *slides = *slides || slid;
            if (ahead > 0) {
                const int32_t width = width_of(a, k->location);
                int32_t c;
                for (c = 0; c < width; c++) {
                    if (k->clocks[c] != before[c]) {
                        k->clocks[c] += ahead;
                    }
                }
                position += ahead;
            }
            if (cut > last) {
                due = cut;
                break;
            }
        }
        position += a->step;
    }
    return due;
}

bool holds_at_end(const machine *a, const attempt *x, int64_t end, int64_t reached)
{
    const int32_t *clauses = &a->whole->ints[a->plan->clause_first];
    const int32_t *tests = &a->whole->ints[a->plan->test_first];
    bool holds = false;
    int32_t i;
    int32_t j;
    for (i = clauses[x->location]; i < clauses[x->location + 1]; i++) {
        bool all = true;
        for (j = tests[i]; j < tests[i + 1]; j++) {
            const int32_t *test = &a->whole->ints[a->plan->tests + 2 * j];
            const int64_t age = a->whole->ticks[a->plan->ages + j];
            if (test[0] >= 0) {
                const int64_t now = (test[1] != 0) ? end : reached;
                all = all && (now - x->clocks[test[0]] >= age);
            }
        }
        holds = holds || all;
    }
    return holds;
}
