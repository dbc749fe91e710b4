/* Validates a plan before a search: all references, and the stacks of its programs. */
#include "code_check.h"

#include <stdlib.h>
#include <string.h>

const uint8_t plan_widths[SECTIONS] = {
    4, 3, LOC_SIZE, EDGE_SIZE, ATOM_SIZE, LIMIT_SIZE, 1, 1, ROW_SIZE, ROW_SIZE,
    LIMIT_SIZE, TREE_SIZE, ROW_SIZE,
    BUCHI_SIZE, 1, 1,
};

static bool sections_fit(const int32_t *plan, size_t count)
{
    int64_t at = HEAD_SECTIONS + 2 * SECTIONS;
    int s;
    if ((count < (size_t)at) || (count > INT32_MAX) || (plan[HEAD_MAGIC] != PLAN_MAGIC)) {
        return false;
    }
    for (s = 0; s < SECTIONS; s++) {
        if ((plan[HEAD_SECTIONS + 2 * s] != at) || (plan_count(plan, s) < 0)) {
            return false;
        }
        at += (int64_t)plan_count(plan, s) * plan_widths[s];
        if (at > (int64_t)count) {
            return false;
        }
    }
    return at == (int64_t)count;
}

static bool limits_fit(const checker *c, int section)
{
    const int32_t *row = plan_rows(c->plan, section);
    int32_t i;
    for (i = 0; i < rows(c, section); i++, row += LIMIT_SIZE) {
        const int32_t clocks = c->plan[HEAD_CLOCKS] + c->plan[HEAD_TIMER];
        if ((row[LIMIT_CLOCK] < 1) || (row[LIMIT_CLOCK] > clocks) || (row[LIMIT_NUMBER] < 0)
            || (row[LIMIT_NUMBER] == INT32_MAX)) {
            return false;
        }
    }
    return true;
}

static bool alternatives_fit(const checker *c, int section)
{
    const int32_t *row = plan_rows(c->plan, section);
    int32_t i;
    for (i = 0; i < rows(c, section); i++, row += ROW_SIZE) {
        if (!is_program_or_none(c, row[ROW_CONDITION])
            || !within(row[ROW_ATOM], row[ROW_ATOMS], rows(c, AT_ATOMS))) {
            return false;
        }
    }
    return true;
}

static bool atoms_fit(const checker *c)
{
    const int32_t *row = plan_rows(c->plan, AT_ATOMS);
    int32_t i;
    for (i = 0; i < rows(c, AT_ATOMS); i++, row += ATOM_SIZE) {
        const int32_t clocks = c->plan[HEAD_CLOCKS] + c->plan[HEAD_TIMER];
        if ((row[ATOM_CLOCK] < 1) || (row[ATOM_CLOCK] > clocks) || (row[ATOM_OP] < 0)
            || (row[ATOM_OP] > 3) || !is_program_or_none(c, row[ATOM_CODE])
            || ((row[ATOM_CODE] == -1) && (row[ATOM_NUMBER] < 0))) {
            return false;
        }
    }
    return true;
}

static bool edges_fit(const checker *c, const int32_t *row, int32_t count, int32_t automaton)
{
    const int32_t places = plan_rows(c->plan, AT_AUTOMATA)[3 * automaton + 1];
    const bool watches = c->plan[HEAD_WATCHED] && (automaton == rows(c, AT_AUTOMATA) - 1);
    int32_t i;
    for (i = 0; i < count; i++, row += EDGE_SIZE) {
        if ((row[EDGE_AUTOMATON] != automaton) || !within(row[EDGE_TARGET], 1, places)
            || !is_program_or_none(c, row[EDGE_GUARD])
            || !within(row[EDGE_ATOM], row[EDGE_ATOMS], rows(c, AT_ATOMS))
            || !is_program_or_none(c, row[EDGE_UPDATE])
            || !is_program_or_none(c, row[EDGE_CHANNEL]) || (row[EDGE_FIRST] < 0)
            || (row[EDGE_STOP] < row[EDGE_FIRST]) || (watches && (row[EDGE_CHANNEL] != -1))) {
            return false;
        }
    }
    return true;
}

static bool places_fit(const checker *c)
{
    const int32_t *automaton = plan_rows(c->plan, AT_AUTOMATA);
    int32_t a;
    for (a = 0; a < rows(c, AT_AUTOMATA); a++, automaton += 3) {
        const int32_t *row;
        int32_t i;
        int32_t k;
        if (!within(automaton[0], automaton[1], rows(c, AT_LOCATIONS))
            || !within(automaton[2], 1, automaton[1])) {
            return false;
        }
        row = plan_rows(c->plan, AT_LOCATIONS) + (ptrdiff_t)automaton[0] * LOC_SIZE;
        for (i = 0; i < automaton[1]; i++, row += LOC_SIZE) {
            if ((row[LOC_KIND] < 0) || (row[LOC_KIND] > KIND_COMMITTED)
                || !is_program_or_none(c, row[LOC_INVARIANT])
                || !within(row[LOC_ATOM], row[LOC_ATOMS], rows(c, AT_ATOMS))
                || !within(row[LOC_LIMIT], row[LOC_LIMITS], rows(c, AT_LIMITS))
                || !within(row[LOC_EDGE], row[LOC_EDGES], rows(c, AT_EDGES))
                || !edges_fit(c, plan_rows(c->plan, AT_EDGES) + (ptrdiff_t)row[LOC_EDGE] * EDGE_SIZE,
                              row[LOC_EDGES], a)) {
                return false;
            }
            for (k = 0; k < row[LOC_ATOMS]; k++) { /* invariants bound from above */
                if (plan_rows(c->plan, AT_ATOMS)[ATOM_SIZE * (row[LOC_ATOM] + k) + ATOM_OP] > 1) {
                    return false;
                }
            }
        }
    }
    return true;
}

/* Priorities of all automata, of steps without channel and of all channels; any two can be added. */
static bool ranks_fit(const checker *c)
{
    const int32_t count = rows(c, AT_RANKS);
    const int32_t *edge = plan_rows(c->plan, AT_EDGES);
    int32_t i;
    for (i = 0; i < count; i++) {
        if ((plan_rows(c->plan, AT_RANKS)[i] < 0) || (plan_rows(c->plan, AT_RANKS)[i] > INT32_MAX / 2)) {
            return false;
        }
    }
    for (i = 0; (count > 0) && (i < rows(c, AT_EDGES)); i++, edge += EDGE_SIZE) {
        if (!within((int64_t)rows(c, AT_AUTOMATA) + 1, edge[EDGE_STOP], count)) {
            return false;
        }
    }
    return (count == 0) || (count > rows(c, AT_AUTOMATA));
}

/* Rows of the tree refer to earlier rows, plain ones to alternatives. */
static bool tree_fits(const checker *c)
{
    const int32_t *row = plan_rows(c->plan, AT_TREE);
    int32_t i;
    for (i = 0; i < rows(c, AT_TREE); i++, row += TREE_SIZE) {
        const int32_t kind = row[TREE_KIND];
        const bool open = (kind == TREE_UNTIL) || (kind == TREE_NEXT);
        const bool two = (kind == TREE_AND) || (kind == TREE_OR) || (kind == TREE_UNTIL);
        if ((kind < 0) || (kind >= TREE_KINDS) || (row[TREE_BOUND] < -1)
            || (row[TREE_BOUND] == INT32_MAX)
            || ((row[TREE_BOUND] >= 0) && (c->plan[HEAD_TIMER] == 0))) {
            return false;
        }
        if ((kind == TREE_PLAIN)
                ? !within(row[TREE_LEFT], row[TREE_RIGHT], rows(c, AT_PIECES))
                : (!(open && (row[TREE_LEFT] == -1)) && !within(row[TREE_LEFT], 1, i))
                      || (two && !within(row[TREE_RIGHT], 1, i))) {
            return false;
        }
    }
    return true;
}

/* The automaton has the pieces inside as states. */
static bool buchi_fits(const checker *c)
{
    const int32_t *row = plan_rows(c->plan, AT_BUCHI);
    const int32_t pieces = rows(c, AT_INSIDE);
    int32_t i;
    if (c->plan[HEAD_KIND] != SEEK_RUN) {
        return true;
    }
    if ((rows(c, AT_BUCHI) != pieces) || (c->plan[HEAD_SETS] < 0)
        || (c->plan[HEAD_SETS] > MOST_SETS)) {
        return false;
    }
    for (i = 0; i < pieces; i++, row += BUCHI_SIZE) {
        if ((row[BUCHI_SETS] < 0) || ((row[BUCHI_SETS] >> c->plan[HEAD_SETS]) != 0)
            || !within(row[BUCHI_ARC], row[BUCHI_ARCS], rows(c, AT_ARCS))) {
            return false;
        }
    }
    for (i = 0; i < rows(c, AT_ARCS); i++) {
        if (!within(plan_rows(c->plan, AT_ARCS)[i], 1, pieces)) {
            return false;
        }
    }
    return true;
}

static bool head_fits(const int32_t *plan)
{
    const int32_t kind = plan[HEAD_KIND];
    const int32_t *variable = plan_rows(plan, AT_VARIABLES);
    const bool late = (kind == SEEK_LATE) || (kind == SEEK_LATE_AFTER);
    const bool plain = (kind == SEEK_GOAL);
    int32_t i;
    if ((kind < 0) || (kind >= SEEK_KINDS) || (plan[HEAD_POLICY] < 0)
        || (plan[HEAD_POLICY] >= POLICIES) || ((plan[HEAD_POLICY] != POLICY_SHORTEST) && !plain)
        || (plan[HEAD_CLOCKS] < 0) || (plan[HEAD_CLOCKS] > MOST_CLOCKS) || (plan[HEAD_TIMER] < 0)
        || (plan[HEAD_TIMER] > 1) || (plan[HEAD_BOUND] < 0)
        || (plan[HEAD_BOUND] == INT32_MAX) || (plan[HEAD_LOCALS] < 0)
        || (plan[HEAD_LOCALS] > plan_count(plan, AT_VARIABLES)) || (plan[HEAD_WATCHED] < 0)
        || (plan[HEAD_WATCHED] > 1) || (plan_count(plan, AT_AUTOMATA) < 1)
        || ((late || (plan[HEAD_POLICY] == POLICY_FASTEST)) && (plan[HEAD_TIMER] == 0))
        || (plan_count(plan, AT_TREE) > MOST_TREE_ROWS)
        || (plan_count(plan, AT_INSIDE) > MOST_PIECES)
        || (((kind == SEEK_NESTED) || (kind == SEEK_START)) && (plan_count(plan, AT_TREE) == 0))) {
        return false;
    }
    for (i = 0; i < plan_count(plan, AT_VARIABLES); i++, variable += 4) {
        if ((variable[2] < variable[0]) || (variable[2] > variable[1])) {
            return false;
        }
    }
    return true;
}

static bool parts_fit(checker *c)
{
    return programs_fit(c) && limits_fit(c, AT_LIMITS) && limits_fit(c, AT_EXTRA) && atoms_fit(c)
           && alternatives_fit(c, AT_GOAL) && alternatives_fit(c, AT_INSIDE)
           && alternatives_fit(c, AT_PIECES) && places_fit(c) && tree_fits(c)
           && buchi_fits(c) && ranks_fit(c);
}

plan_state plan_check(const int32_t *plan, size_t count)
{
    checker c = {plan, NULL, NULL, 0};
    plan_state state = PLAN_NO_MEMORY;
    size_t size;
    if (!sections_fit(plan, count) || !head_fits(plan)) {
        return PLAN_DAMAGED;
    }
    size = (size_t)plan_count(plan, AT_CODE) + 1;
    c.depth = malloc(size * sizeof *c.depth);
    c.starts = calloc(size, 1);
    if ((c.depth != NULL) && (c.starts != NULL)) {
        (void)memset(c.depth, 0xff, size * sizeof *c.depth);
        state = parts_fit(&c) ? PLAN_GOOD : PLAN_DAMAGED;
    }
    free(c.depth);
    free(c.starts);
    return state;
}
