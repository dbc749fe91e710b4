/* When something was decided by what a network knows: what is known depends on time and letters alone, so
 * a step is taken back and smaller ones are tried. */
#include "networks/network.h"

/* Instants that are tried at most before a search halves what is left. */
#define GUESSES 16

void learn_all(judging *g, int64_t now, int64_t last)
{
    int32_t i;
    for (i = 0; i < readings(g); i++) {
        learn(&g->f, g->net, i, now, last);
    }
}

void unlearn_all(judging *g)
{
    int32_t i;
    for (i = 0; i < readings(g); i++) {
        unlearn(&g->f, &g->net->readings[i]);
    }
}

/* The last position of which the letter is known behind an instant. */
int64_t last_at(const judging *g, int64_t t)
{
    return (g->f.gap > 0) ? floored(t, g->f.step) : g->net->readings[0].last;
}

/* Guess when it was that a position of the formula became known, or what made it so, by `high`; what
 * is likely comes last.
 *
 * What is new of a node goes up to a front, which moves with time, or did so till now. */
static int32_t guess(const judging *g, int64_t position, int64_t high, int64_t *found)
{
    const int32_t operators = g->f.form->operators.count;
    int32_t count = 0;
    int32_t i;
    int32_t j;
    int32_t k;
    for (i = 0; i < 2 * operators; i++) {
        const bool itself = i >= operators;
        const operator_plan *n = &g->f.nodes[i % operators];
        for (j = 0; j < 2 * readings(g); j++) {
            const network *w = &g->net->readings[j / 2];
            const ranges *news = &w->nodes[i % operators].news[j % 2];
            const int64_t front = (g->f.gap > 0) ? high - (w->now - w->last * g->f.step) : high;
            for (k = news->first; (k < news->end) && (count + 2 <= GUESSES); k++) {
                const range *on = &news->at[k];
                const bool within = (on->first <= position) && (position <= on->last);
                const int64_t first = itself ? position : on->first;
                if (!itself || within) {
                    found[count] = front - (on->last - first) * g->f.step;
                    count++;
                }
                if ((!itself || within) && (n->kind == OP_WINDOW) && (n->over >= 0)) {
                    found[count] = instant_of(&g->f, w, first) + n->over;
                    count++;
                }
            }
        }
    }
    return count;
}

/* Let time come to `now`, and the letter to positions up to `last`; but not behind the first instant
 * at which an attempt is decided. Returns that; NEVER: none is. */
int64_t step_to_decision(judging *g, int64_t now, int64_t last)
{
    int64_t found[GUESSES];
    int64_t low = due_of(g) - g->j->lag - 1;
    int64_t high = now;
    int64_t at = now;
    int64_t one;
    int32_t tries = GUESSES;
    int32_t count = 0;
    learn_all(g, now, last);
    one = decided_one(g);
    if ((one == NEVER) || is_spoilt(g)) {
        return NEVER; /* what did not fit is not known: nothing is found by steps */
    }
    if (high - low > 1) {
        count = guess(g, one, high, found);
    }
    while (high - low > 1) {
        int64_t middle = low + (high - low) / 2;
        if ((count > 0) && (tries > 0)) {
            count--;
            middle = found[count];
            if ((middle <= low) || (middle >= high)) {
                continue;
            }
            tries--;
        }
        unlearn_all(g);
        at = middle;
        learn_all(g, at, last_at(g, at));
        one = decided_one(g);
        if (one == NEVER) {
            low = middle;
        } else {
            high = middle;
            count = guess(g, one, high, found);
            if (count == GUESSES) {
                count--;
            }
            found[count] = high - 1; /* it may be exact */
            count++;
        }
    }
    if (at != high) {
        unlearn_all(g);
        learn_all(g, high, (high == now) ? last : last_at(g, high));
    }
    return is_spoilt(g) ? NEVER : high;
}
