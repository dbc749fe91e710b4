/* Evaluates programs of a plan, and the bounds of its atoms. Overflow, an index or value out of range,
 * division by zero, a shift by a bad number of bits and an endless loop are failures. */
#ifndef RVMON_ZONES_PROGRAMS_H
#define RVMON_ZONES_PROGRAMS_H

#include "arithmetic.h"
#include "bounds.h"

static bool is_time(engine *h, int64_t number);

/* Set a variable if the value is in its range; a bool takes any value as its truth. */
static bool set_variable(const engine *h, int32_t *values, int64_t at, int64_t x)
{
    const int32_t *variable = h->variables + (ptrdiff_t)at * 4;
    const int64_t fit = (variable[3] != 0) ? (x != 0) : x;
    if ((fit < variable[0]) || (fit > variable[1])) {
        return false;
    }
    values[at] = (int32_t)fit;
    return true;
}

/* The index of the reset of a clock in the current move; the number of resets if there is none. */
static int reset_of(const walk *w, int32_t clock)
{
    int j = 0;
    while ((j < w->reset_count) && (w->resets[2 * j] != clock)) {
        j++;
    }
    return j;
}

/* Add a reset of a clock to the move whose updates run. */
static bool set_clock(engine *h, int32_t clock, int64_t x)
{
    walk *w = h->sets;
    int j;
    if ((w == NULL) || !is_time(h, x)) {
        return false;
    }
    j = reset_of(w, clock);
    w->reset_count += (j == w->reset_count);
    w->resets[2 * j] = clock;
    w->resets[2 * j + 1] = (int32_t)x;
    return true;
}

static void copy_spot(const engine *h, const spot *to, const spot *from)
{
    (void)memcpy(to->places, from->places, (size_t)h->automaton_count * sizeof *to->places);
    (void)memcpy(to->values, from->values, (size_t)h->variable_count * sizeof *to->values);
}

/* Run the program at `at` and return its value; if it has none, set `failed`. */
static int64_t compute(engine *h, int32_t at, const spot *here)
{
    const int32_t *code = h->code;
    int32_t *values = here->values;
    int64_t stack[STACK + 1];
    int64_t *s = stack; /* the top; the first entry is never used */
    for (;;) {
        const int32_t op = code[at++];
        bool good = true;
        switch (op) {
        case OP_END:
            return *s;
        case OP_CONST:
            *++s = code[at++];
            break;
        case OP_VARIABLE:
            *++s = values[code[at++]];
            break;
        case OP_INDEX:
            good = within(*s, code[at], code[at + 1]);
            *s -= good ? code[at] : *s;
            at += 2;
            break;
        case OP_ROW:
            good = multiplied(s[-1], code[at++], &s[-1]) && added(s[-1], s[0], &s[-1]);
            s--;
            break;
        case OP_ELEMENT:
        case OP_LOOKUP:
            good = within(*s, 0, code[at + 1]);
            if (good) {
                *s = (op == OP_LOOKUP) ? plan_rows(h->plan, AT_TABLE)[code[at] + *s]
                                       : values[code[at] + *s];
            }
            at += 2;
            break;
        case OP_PLACE:
            *++s = here->places[code[at]] == code[at + 1];
            at += 2;
            break;
        case OP_NOT:
            *s = (*s == 0);
            break;
        case OP_NEGATE:
            good = subtracted(0, *s, s);
            break;
        case OP_TRUTH:
            *s = (*s != 0);
            break;
        case OP_AND:
        case OP_OR:
        case OP_IMPLY:
            if ((*s != 0) == (op == OP_OR)) {
                *s = (op != OP_AND);
                at = code[at];
            } else {
                s--;
                at++;
            }
            break;
        case OP_UNLESS:
            at = (*s == 0) ? code[at] : at + 1;
            s--;
            break;
        case OP_GO:
        case OP_BACK:
            at = code[at];
            break;
        case OP_INVERT:
            *s = ~*s;
            break;
        case OP_SET:
            good = set_variable(h, values, code[at++], *s--);
            break;
        case OP_STORE:
            good = within(s[-1], 0, code[at + 1])
                   && set_variable(h, values, code[at] + s[-1], s[0]);
            at += 2;
            s -= 2;
            break;
        case OP_CLOCK:
            good = set_clock(h, code[at++], *s--) || !runs(h); /* too large: ends this search, no failure */
            break;
        case OP_CALL:
            *++s = compute(h, code[at++], here);
            good = !h->failed;
            break;
        case OP_DROP:
            s--;
            break;
        case OP_HEAD:
            good = h->rounds++ < MOST_ROUNDS;
            break;
        case OP_FAIL:
            s++;
            good = false;
            break;
        default:
            good = combine(op, s[-1], s[0], &s[-1]);
            s--;
        }
        if (!good) {
            h->failed = true;
            return 0;
        }
    }
}

static int64_t evaluate(engine *h, int32_t at, const spot *here)
{
    h->rounds = 0;
    return compute(h, at, here);
}

static bool holds(engine *h, int32_t program, const spot *here)
{
    return (program < 0) || (evaluate(h, program, here) != 0);
}

/* Check a number of time units: a negative one is a failure, a large one needs the search in 64 bits. */
static bool is_time(engine *h, int64_t number)
{
    if ((number < 0) || (number >= INT32_MAX)) {
        h->failed = true;
        return false;
    }
    if (number > (int64_t)h->most_time) {
        h->state = runs(h) ? SEARCH_TOO_LARGE : h->state;
        return false;
    }
    return true;
}

/* Evaluate an atom to a bound; false if its number is no time. */
static bool atom_at(engine *h, int32_t k, const spot *here, cut *to)
{
    const int32_t *atom = h->atoms + (ptrdiff_t)ATOM_SIZE * k;
    const int64_t number = (atom[ATOM_CODE] < 0) ? atom[ATOM_NUMBER]
                                                 : evaluate(h, atom[ATOM_CODE], here);
    if (h->failed || !is_time(h, number)) {
        return false;
    }
    if (atom[ATOM_OP] < 2) {
        *to = (cut){0, atom[ATOM_CLOCK], 2 * (bound)number + (atom[ATOM_OP] == 1)};
    } else {
        *to = (cut){atom[ATOM_CLOCK], 0, -2 * (bound)number + (atom[ATOM_OP] == 2)};
    }
    return true;
}

static bool cut_atoms(engine *h, bound *z, int32_t first, int32_t count, const spot *here)
{
    int32_t k;
    for (k = first; k < first + count; k++) {
        cut one;
        if (!atom_at(h, k, here, &one) || !cut_by(h, z, one)) {
            return false;
        }
    }
    return true;
}

/* Intersect a zone with an alternative of a formula; false if nothing is left in this discrete state. */
static bool cut_row(engine *h, bound *z, const int32_t *row, const spot *here)
{
    return holds(h, row[ROW_CONDITION], here) && !h->failed
           && cut_atoms(h, z, row[ROW_ATOM], row[ROW_ATOMS], here);
}

static const int32_t *place_of(const engine *h, const spot *here, int a)
{
    return h->locations + (ptrdiff_t)LOC_SIZE * (h->automata[3 * a] + here->places[a]);
}

static const int32_t *edge_at(const engine *h, int32_t e)
{
    return h->edges + (ptrdiff_t)e * EDGE_SIZE;
}

static bool invariant_data_holds(engine *h, const spot *here)
{
    int a;
    for (a = 0; a < h->automaton_count; a++) {
        if (!holds(h, place_of(h, here, a)[LOC_INVARIANT], here)) {
            return false;
        }
    }
    return !h->failed;
}

/* The tightest upper bound of each clock in an invariant; returns their number, -1 if it failed. */
static int invariant_of(engine *h, const spot *here)
{
    int n = 0;
    int a;
    for (a = 0; a < h->automaton_count; a++) {
        const int32_t *place = place_of(h, here, a);
        int32_t k;
        for (k = 0; k < place[LOC_ATOMS]; k++) {
            cut one;
            int i = 0;
            if (!atom_at(h, place[LOC_ATOM] + k, here, &one)) {
                return -1;
            }
            while ((i < n) && (h->tightest[i] != one.y)) {
                i++;
            }
            if ((i == n) || (one.b < h->tightest_bound[i])) {
                h->tightest[i] = one.y;
                h->tightest_bound[i] = one.b;
                n += (i == n);
            }
        }
    }
    return n;
}

static bool cut_invariant(engine *h, bound *z, const spot *here)
{
    const int n = invariant_of(h, here);
    int i;
    for (i = 0; i < n; i++) {
        if (!constrain(z, h->dim, 0, h->tightest[i], h->tightest_bound[i])) {
            return false;
        }
    }
    return n >= 0;
}

/* Intersect with the invariant and add all delays, if time may pass; false if nothing is left. */
static bool settle(engine *h, bound *z, const spot *here, bool delays)
{
    if (delays) {
        const int n = invariant_of(h, here);
        return (n >= 0)
               && delay_within(z, h->dim, h->top, h->tightest, h->tightest_bound, n);
    }
    return cut_invariant(h, z, here);
}

/* The limits of clocks in the current locations, and the clocks that have any. */
static void find_limits(engine *h, const spot *here)
{
    int a;
    int c;
    for (c = 1; c < h->dim; c++) {
        h->lower[c] = NO_LIMIT;
        h->upper[c] = NO_LIMIT;
    }
    h->lower[0] = 0;
    h->upper[0] = 0;
    for (a = -1; a < h->automaton_count; a++) {
        const int32_t *place = (a < 0) ? NULL : place_of(h, here, a);
        const int32_t *row =
            (a < 0) ? plan_rows(h->plan, AT_EXTRA)
                    : plan_rows(h->plan, AT_LIMITS) + (ptrdiff_t)LIMIT_SIZE * place[LOC_LIMIT];
        int32_t n = (a < 0) ? plan_count(h->plan, AT_EXTRA) : place[LOC_LIMITS];
        for (; n > 0; n--, row += LIMIT_SIZE) {
            bound *to = (row[LIMIT_LOWER] ? h->lower : h->upper) + row[LIMIT_CLOCK];
            *to = (row[LIMIT_NUMBER] > *to) ? row[LIMIT_NUMBER] : *to;
        }
    }
    if (h->policy == POLICY_FASTEST) { /* a later zone must not subsume an earlier one */
        h->upper[h->timer] = h->safe / 2;
    }
    if (h->phase != 0 && (h->timer != 0)) {
        h->lower[h->timer] = h->plan[HEAD_BOUND];
    }
    h->upper_count = 0;
    h->lower_count = 0;
    for (c = 0; c < h->dim; c++) {
        if (h->plan[HEAD_LEVELLED]) {
            h->lower[c] = (h->lower[c] > h->upper[c]) ? h->lower[c] : h->upper[c];
            h->upper[c] = h->lower[c];
        }
        if (h->upper[c] != NO_LIMIT) {
            h->uppers[h->upper_count++] = c;
        }
        if (h->lower[c] != NO_LIMIT) {
            h->lowers[h->lower_count++] = c;
        }
    }
}

#endif
