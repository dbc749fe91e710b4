/* Automata: one attempt through positions and through time.
 *
 * A row is a location with a region for each clock; the edge of a row and a class of letters says
 * where the attempt goes, and which old clock each new one is. */
#include "attempts/attempts.h"
#include "results/results.h"

#include <string.h>

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
    return r->part->machines[index].class_of[better ? r->judges[index].better
                                                    : r->judges[index].worse];
}

/* The row of a token at an instant, and until when it is the same if the token stays. */
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
    if (width == 1) { /* as mostly */
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
        /* It has none. */
    }
    return moved;
}

/* Whether a token that came from a step at `t` would stay where it is if the letter stays, or `slides`:
 * but for clocks that each tick starts again. `due` is when the next region of the other ages begins. */
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
            /* It is as it was. */
        }
    }
    if (slid) {
        *due = next_cut(a, k, t, anchors);
        *slides = true;
    }
    return true;
}

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

/* Let time pass from `t` to `until` without a position; returns the instant of the decision, or the
 * next at which there may be one. */
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

/* Whether a step led to the same place: each clock is as it was, or went on with time. */
static bool loops(const machine *a, int32_t was, const int64_t *before, const token *behind,
                  bool *slides)
{
    const int32_t width = a->widths[behind->location];
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
