/* Deterministic timed automata: one token (one reading of an attempt) through positions and time.
 *
 * A clock is the instant of its last reset; its age is cut into *regions* by the constants of the
 * location. A *row* is a location with one region per clock; the edge of (row, class of letters) gives
 * the target and, for each clock of the target, the old clock it continues or -1: reset now. So a step
 * is a table look-up, O(clocks * cuts). Within a region equal letters take the same edge, hence time
 * without changes is jumped over from one region boundary (*cut*) to the next.
 *
 * Source: progression after Bacchus and Kabanza (1998), made into tables: docs/explanation/automata.md,
 * sections 1 to 3. */
#include "attempts/attempts.h"
#include "results/results.h"

#include <string.h>

/* The class of the letter by a decision diagram, where there are too many letters for a table. A node
 * of it: proposition, digit by truth in the worse reading [3], in the better [3], number of children,
 * children (~class: a leaf). */
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
    return r->part->machines[index].class_of[better ? r->judges[index].better
                                                    : r->judges[index].worse];
}

/* The row of a token at `t`; `until`: the instant of the next cut, when the row is another one though
 * the token stays. */
static inline int32_t row_of(const machine *a, const token *k, int64_t t, int64_t *until)
{
    const int32_t width = a->widths[k->location];
    const int32_t first = k->location * a->clocks;
    int32_t row = a->bases[k->location];
    int32_t c;
    *until = NEVER;
    for (c = 0; c < width; c++) {
        const int64_t clock = k->clocks[c];
        const int64_t *cut = &a->cuts[a->cut_first[first + c]];
        const int64_t *end = &a->cuts[a->cut_first[first + c + 1]];
        for (; (cut < end) && (t >= clock + *cut); cut++) {
            row += a->strides[first + c];
        }
        if (cut < end) {
            *until = least(*until, clock + *cut);
        }
    }
    return row;
}

/* Read a letter at the position at `t`; returns whether location or clocks are others than before. */
bool step_token(const machine *a, token *k, int64_t t, int32_t letter)
{
    int64_t until;
    const int32_t number = a->edges[row_of(a, k, t, &until) * a->classes + letter];
    const int32_t target = a->targets[number];
    const int32_t *sources = &a->sources[number * a->clocks];
    const int32_t width = a->widths[target];
    bool moved = target != k->location;
    if (moved && (k->moves != NULL)) {
        count_move(a, k->moves, k->location, target, 1, t);
    }
    k->location = target;
    if (width == 1) { /* the usual case, without the copy */
        const int64_t anchor = (sources[0] < 0) ? t : k->clocks[sources[0]];
        moved = moved || (anchor != k->clocks[0]);
        k->clocks[0] = anchor;
    } else if (width > 1) {
        int64_t old[CLOCKS_MOST];
        int32_t c;
        (void)memcpy(old, k->clocks, (size_t)a->clocks * sizeof *old);
        for (c = 0; c < width; c++) {
            const int64_t anchor = (sources[c] < 0) ? t : old[sources[c]];
            moved = moved || (anchor != old[c]);
            k->clocks[c] = anchor;
        }
    } else {
        /* The target has no clocks. */
    }
    return moved;
}

/* Whether a token that was stepped at `t` loops from the next position on while the letter stays. Its
 * clocks stay, or (`slides`) some are reset at each tick, and follow the last position. `due`: the next
 * cut of the clocks that stay, up to which this is certain.
 *
 * Where only samples are positions (gap 0) the next position is not known: nothing is foretold but
 * `due`. */
bool rests(const machine *a, const token *k, int64_t t, int32_t letter, int64_t *due, bool *slides)
{
    const int64_t next = t + a->step;
    const int32_t width = a->widths[k->location];
    int64_t anchors[CLOCKS_MOST];
    int32_t row = row_of(a, k, t, due);
    int64_t until;
    bool slid = false;
    const int32_t *sources;
    int32_t number;
    int32_t c;
    if (a->gap == 0) {
        return false;
    }
    if (*due <= next) {
        row = row_of(a, k, next, &until);
    }
    number = a->edges[row * a->classes + letter];
    if (a->targets[number] != k->location) {
        return false;
    }
    sources = &a->sources[number * a->clocks];
    for (c = 0; c < width; c++) {
        anchors[c] = (sources[c] < 0) ? next : k->clocks[sources[c]];
        if ((sources[c] < 0) && (k->clocks[c] == t) && (a->step == 1)) {
            slid = true;
        } else if (anchors[c] != k->clocks[c]) {
            return false;
        } else {
            /* The clock stays. */
        }
    }
    if (slid) {
        *due = next_cut(a, k, t, anchors);
        *slides = true;
    }
    return true;
}

/* The first cut of a token's clocks after `t`. With `before`, only of the clocks that equal those:
 * a clock that slides with time reaches no cut. */
int64_t next_cut(const machine *a, const token *k, int64_t t, const int64_t *before)
{
    const int64_t *cuts = a->cuts;
    const int32_t width = a->widths[k->location];
    int64_t found = NEVER;
    int32_t c;
    for (c = 0; c < width; c++) {
        const int32_t at = k->location * a->clocks + c;
        const int32_t end = a->cut_first[at + 1];
        int32_t i = a->cut_first[at];
        if ((before != NULL) && (before[c] != k->clocks[c])) {
            continue;
        }
        while ((i < end) && (k->clocks[c] + cuts[i] <= t)) {
            i++;
        }
        if (i < end) {
            found = least(found, k->clocks[c] + cuts[i]);
        }
    }
    return found;
}

/* Let time pass from `t` to `until` without a position: a deadline is decided as the clock passes it,
 * whatever the next letter is. Returns the instant of the decision, or the next cut behind `until`. */
int64_t settle_token(const machine *a, token *k, int64_t t, int64_t until)
{
    int64_t cut = next_cut(a, k, t, NULL);
    while (cut <= until) {
        int64_t next;
        const int32_t truth = a->time_values[row_of(a, k, cut, &next)];
        if (truth != IS_UNKNOWN) {
            const int32_t target = (truth == IS_TRUE) ? PASSED : FAILED;
            if (k->moves != NULL) {
                count_move(a, k->moves, k->location, target, 1, cut);
            }
            k->location = target;
            break;
        }
        cut = next;
    }
    return cut;
}

/* Whether a step from (`was`, `before`) was a loop: same location, and each clock stayed or moved by
 * one step (`slides`). The same edge is then taken until a clock that stayed reaches a cut. */
static bool loops(const machine *a, int32_t was, const int64_t *before, const token *after,
                  bool *slides)
{
    const int32_t width = a->widths[after->location];
    bool loop = was == after->location;
    int32_t c;
    *slides = false;
    for (c = 0; loop && (c < width); c++) {
        if (after->clocks[c] != before[c]) {
            *slides = true;
            loop = after->clocks[c] == before[c] + a->step;
        }
    }
    return loop;
}

/* Step a token through equal letters at `first` and each position up to `last`. Once it loops it jumps
 * to the position before the next cut, so the cost is the number of cuts and moves, not of positions.
 * Between the ticks of a clock (step > 1) time alone may decide. Returns the instant of the decision,
 * or the first one after which the token does not just loop on. */
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
        (void)memcpy(before, k->clocks, (size_t)a->clocks * sizeof *before);
        (void)step_token(a, k, position, letter);
        if (k->location <= PASSED) {
            due = position;
            break;
        }
        if (loops(a, was, before, k, &slid)) {
            const int64_t cut = next_cut(a, k, position, before);
            const int64_t ahead = whole_steps(least(cut - 1, last) - position, a->step);
            *slides = *slides || slid;
            if (ahead > 0) {
                const int32_t width = a->widths[k->location];
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

/* Whether a location counts as TRUE at the end of the trace: some clause has only tests that hold. A
 * test is (clock, or -1: nothing to test; whether its age is measured at `end` or at `reached`) with a
 * least age. */
bool holds_at_end(const machine *a, int32_t location, const int64_t *clocks, int64_t end,
                  int64_t reached)
{
    bool holds = false;
    int32_t i;
    int32_t j;
    for (i = a->clause_first[location]; i < a->clause_first[location + 1]; i++) {
        bool all = true;
        for (j = a->test_first[i]; j < a->test_first[i + 1]; j++) {
            const int32_t *test = &a->tests[2 * j];
            if (test[0] >= 0) {
                const int64_t now = (test[1] != 0) ? end : reached;
                all = all && (now - clocks[test[0]] >= a->ages[j]);
            }
        }
        holds = holds || all;
    }
    return holds;
}
