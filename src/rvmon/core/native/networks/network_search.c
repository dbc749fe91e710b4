/* When a network decides attempts: the exact first instant, and a bound before which it cannot.
 *
 * A step may jump over many instants at which attempts were decided. What is known depends on (now,
 * last) alone and only grows. So the step is undone, and the first instant at which an attempt is decided
 * is searched by bisection, after guesses that mostly hit. The bound (earliest_change) says how long no
 * search is needed at all. */
#include "networks/network.h"

/* The most guesses per search; then it bisects, so that bad guesses cost a bounded number of steps. */
#define GUESSES 16

/* One step of all readings; undone by unlearn_all(). */
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

/* The last position whose letter is known at an instant, if letters are read up to it. */
int64_t last_at(const judging *g, int64_t t)
{
    return (g->f.gap > 0) ? floored(t, g->f.step) : g->net->readings[0].last;
}

/* Guess the instant at which `position` of the root became known in a step to `high`. Writes the guesses
 * into `found`, the likeliest last, and returns how many.
 *
 * A step mostly makes known a range of a node that grows with time up to a front; then a position became
 * known as long before `high` as it lies before the front. Or a window was complete; then a position
 * became known when its window was over. */
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
            const ranges *added = &w->nodes[i % operators].added[j % 2];
            const int64_t front = (g->f.gap > 0) ? high - (w->now - w->last * g->f.step) : high;
            for (k = added->first; (k < added->end) && (count + 2 <= GUESSES); k++) {
                const range *on = &added->at[k];
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

/* Step to (now, last), but no further than the first instant at which an attempt is decided. Returns
 * that instant; NEVER: none is decided. Invariant of the search: nothing is decided at `low`, something
 * is at `high`. `lag`: decisions from that long before the judge was due may have been put off. */
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
    one = decided_position(g);
    if ((one == NEVER) || is_spoilt(g)) {
        return NEVER; /* memory was short: knowledge is incomplete, and steps do not add up */
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
        one = decided_position(g);
        if (one == NEVER) {
            low = middle;
        } else {
            high = middle;
            count = guess(g, one, high, found);
            if (count == GUESSES) {
                count--;
            }
            found[count] = high - 1; /* if the last guess was exact, this one ends the search */
            count++;
        }
    }
    if (at != high) {
        unlearn_all(g);
        learn_all(g, high, (high == now) ? last : last_at(g, high));
    }
    return is_spoilt(g) ? NEVER : high;
}

/* ---- a lower bound: if the letter stays, nothing is added to the root before earliest_change()
 *
 * Per operator and value, `earliest` bounds when a position with that value can be added; it is
 * computed operands first, O(operators). Positions are added from `base` on, the first unknown one. */

/* Whether a value is known at some position at or after another. */
static bool has_from(const operator_state *o, uint8_t value, int64_t position)
{
    const ranges *known = &o->known[value];
    return (known->first < known->end) && (known->at[known->end - 1].last >= position);
}

/* When an operator can have a value somewhere from a position on: now, if it is known to have it there;
 * else when a position can be added. */
static int64_t earliest_from(const operator_state *o, uint8_t value, int64_t position, int64_t now)
{
    return has_from(o, value, position) ? now : o->earliest[value];
}

static void earliest_of_junction(const form *f, network *w, const operator_plan *n, operator_state *o)
{
    const int32_t *operands = LIST(f->plan, n->operands);
    const uint8_t all = (uint8_t)n->turned;
    const uint8_t some = (uint8_t)(all ^ 1U);
    int32_t i;
    o->earliest[some] = NEVER;
    o->earliest[all] = w->now;
    for (i = 0; i < n->operands.count; i++) {
        const operator_state *one = &w->nodes[operands[i]];
        const int64_t met = earliest_from(one, all, o->base, w->now);
        o->earliest[some] = least(o->earliest[some], one->earliest[some]);
        o->earliest[all] = (met > o->earliest[all]) ? met : o->earliest[all];
    }
}

static void earliest_of_window(const form *f, network *w, const operator_plan *n, operator_state *o)
{
    const operator_state *operand = &w->nodes[n->left];
    const uint8_t all = (uint8_t)n->turned;
    const int64_t over = moved(instant_of(f, w, o->base), n->over);
    o->earliest[all] = (over > w->now) ? over : w->now;
    o->earliest[all ^ 1U] = operand->earliest[all ^ 1U];
    if ((f->gap == 1) && (n->low <= n->high)) { /* no window is empty: the operand has to be known */
        const int64_t met = earliest_from(operand, all, moved(o->base, n->low), w->now);
        o->earliest[all] = (met > o->earliest[all]) ? met : o->earliest[all];
    }
}

/* `left until right` becomes yes only where right is (or was); it becomes no only where both are. */
static void earliest_of_until(network *w, const operator_plan *n, operator_state *o)
{
    const operator_state *left = &w->nodes[n->left];
    const operator_state *right = &w->nodes[n->right];
    const uint8_t no = (uint8_t)n->turned;
    const uint8_t yes = (uint8_t)(no ^ 1U);
    const int64_t failing = earliest_from(left, no, o->base, w->now);
    o->earliest[yes] = earliest_from(right, yes, o->base, w->now);
    o->earliest[no] = earliest_from(right, no, o->base, w->now);
    o->earliest[no] = (failing > o->earliest[no]) ? failing : o->earliest[no];
}

int64_t earliest_change(const form *f, networks *net, int32_t reading)
{
    network *w = &net->readings[reading];
    const int32_t count = f->form->operators.count;
    int32_t i;
    for (i = 0; i < count; i++) {
        const operator_plan *n = &f->nodes[i];
        operator_state *o = &w->nodes[i];
        o->earliest[0] = w->now;
        o->earliest[1] = w->now;
        if (n->kind == OP_LEAF) {
            const uint8_t other = ((net->leaf[n->left] >> reading) & 1U) ^ 1U; /* the letter stays */
            o->earliest[other] = NEVER;
        } else if (n->kind == OP_JUNCTION) {
            earliest_of_junction(f, w, n, o);
        } else if ((n->kind == OP_WINDOW) && (n->over >= 0)) {
            earliest_of_window(f, w, n, o);
        } else if ((n->kind == OP_SHIFT) && (n->low >= 0)) {
            o->earliest[0] = w->nodes[n->left].earliest[0];
            o->earliest[1] = w->nodes[n->left].earliest[1];
        } else if (n->kind == OP_UNTIL) {
            earliest_of_until(w, n, o);
        } else {
            /* For operators of the past a position may be added at once. */
        }
    }
    return least(w->nodes[count - 1].earliest[0], w->nodes[count - 1].earliest[1]);
}

/* ---- attempts: each is a position of the root */

/* Decide an attempt at `t` by what is known; false: it is decided. Nothing is decided once memory was
 * short, as knowledge may then be wrong. */
bool judge_attempt(judging *g, int32_t at, int64_t t)
{
    attempt *x = attempt_of(g, at);
    const bool parted = g->net->parted;
    const operator_state *worse = &g->net->readings[0].nodes[g->root];
    const operator_state *better = &g->net->readings[parted ? 1 : 0].nodes[g->root];
    if (is_spoilt(g)) {
        return true;
    }
    if (knows(worse, 1U, position_of(x))) {
        decide(g->r, g->index, at, true, t);
        return false;
    }
    if (knows(better, 0U, position_of(x))) {
        decide(g->r, g->index, at, false, t);
        return false;
    }
    if (parted && knows(worse, 0U, position_of(x))) {
        x->location = FAILED;
    }
    if (parted && knows(better, 1U, position_of(x))) {
        x->better = PASSED;
        x->parted = true;
    }
    return true;
}

/* The oldest attempt at or after a position; -1: none. */
static int32_t attempt_from(const judging *g, int64_t position)
{
    int32_t at = g->j->first;
    if ((at < 0) || (position_of(attempt_of(g, g->j->last)) < position)) {
        return -1;
    }
    while (position_of(attempt_of(g, at)) < position) {
        at = attempt_of(g, at)->next;
    }
    return at;
}

/* The position of an attempt that the last step decided; NEVER: none. A pass needs the worse reading to
 * be TRUE, a failure the better one to be FALSE. */
int64_t decided_position(const judging *g)
{
    uint8_t value;
    int32_t i;
    for (value = 0; value < 2U; value++) {
        const int32_t reading = (g->net->parted && (value == 0U)) ? 1 : 0;
        const ranges *added = &g->net->readings[reading].nodes[g->root].added[value];
        for (i = added->first; i < added->end; i++) {
            const int32_t at = attempt_from(g, added->at[i].first);
            if ((at >= 0) && (position_of(attempt_of(g, at)) <= added->at[i].last)) {
                return position_of(attempt_of(g, at));
            }
        }
    }
    return NEVER;
}

/* The first position at or after another at which the last step made the root known; NEVER: none. */
static int64_t next_new(const judging *g, int64_t position)
{
    int64_t found = NEVER;
    int32_t i;
    int32_t j;
    for (i = 0; i < 2 * readings(g); i++) {
        const ranges *added = &g->net->readings[i / 2].nodes[g->root].added[i % 2];
        for (j = added->first; j < added->end; j++) {
            if (added->at[j].last >= position) {
                const int64_t first = added->at[j].first;
                found = least(found, (first > position) ? first : position);
            }
        }
    }
    return found;
}

/* Decide, at `t`, the attempts at positions that the last step added. Attempts are in the order of
 * their positions; those before the next added position are skipped. */
void judge_added(judging *g, int64_t t)
{
    int64_t upcoming = -NEVER;
    int32_t before = -1;
    int32_t at = g->j->first;
    if (!g->net->parted && (decided_position(g) == NEVER)) {
        return;
    }
    while (at >= 0) {
        const int32_t next = attempt_of(g, at)->next;
        const int64_t position = position_of(attempt_of(g, at));
        if (position > upcoming) {
            upcoming = next_new(g, position);
            if (upcoming == NEVER) {
                break;
            }
        }
        if ((position >= upcoming) && !judge_attempt(g, at, t)) {
            remove_attempt(g->r, g->index, before, at);
        } else if (is_undecidable(attempt_of(g, at))) {
            move_to_undecidable(g->r, g->index, before, at);
        } else {
            before = at;
        }
        at = next;
    }
}
