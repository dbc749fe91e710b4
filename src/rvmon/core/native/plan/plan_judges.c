/* Validation of what decides attempts: automata, letter diagrams, networks and chains; and of
 * coverage. */
#include "plan/plan_check.h"

static bool has_ints(const plan *p, int64_t first, int64_t count)
{
    return has(p, SEC_INTS, first, count);
}

static bool ints_within(const plan *p, int64_t first, int64_t count, int64_t low, int64_t end)
{
    int64_t i;
    if (!has_ints(p, first, count)) {
        return false;
    }
    for (i = 0; i < count; i++) {
        if (!is_within(p->ints[first + i], low, end)) {
            return false;
        }
    }
    return true;
}

/* The row of a location is its base plus, for each clock, the cuts passed times a stride: the
 * largest such sum has to be a row of the table. Strides are non-negative, so the others are, too. */
static bool check_rows(const plan *p, const automaton_plan *a)
{
    int64_t last = 0;
    int32_t i;
    int32_t c;
    if (!has_ints(p, a->cut_first, (int64_t)a->locations * a->clocks + 1)
        || (p->ints[a->cut_first] != 0)) {
        return false;
    }
    for (i = 0; i < a->locations; i++) {
        int64_t row = p->ints[a->bases + i];
        for (c = 0; c < a->clocks; c++) {
            const int64_t at = (int64_t)i * a->clocks + c;
            const int64_t cuts = (int64_t)p->ints[a->cut_first + at + 1] - p->ints[a->cut_first + at];
            const int64_t stride = p->ints[a->strides + at];
            if ((cuts < 0) || (stride < 0) || (cuts >= MOST) || (stride >= MOST)) {
                return false;
            }
            row += cuts * stride;
            if (row >= MOST) {
                return false;
            }
        }
        if ((p->ints[a->bases + i] < 0) || (row >= a->rows)) {
            return false;
        }
        last = p->ints[a->cut_first + ((int64_t)i + 1) * a->clocks];
    }
    for (i = 0; has(p, SEC_TICKS, a->cuts, last) && (i < last); i++) {
        if (!is_within(p->ticks[a->cuts + i], 1, LIMIT + 1)) {
            return false;
        }
    }
    return has(p, SEC_TICKS, a->cuts, last);
}

/* Check the rule for the end of the trace: clauses of a location, tests of a clause. */
static bool check_clauses(const plan *p, const automaton_plan *a)
{
    int64_t clauses;
    int64_t tests;
    int64_t i;
    if (!has_ints(p, a->clause_first, (int64_t)a->locations + 1)) {
        return false;
    }
    clauses = p->ints[a->clause_first + a->locations];
    if (!ascends(&p->ints[a->clause_first], a->locations, clauses)
        || !has_ints(p, a->test_first, clauses + 1)) {
        return false;
    }
    tests = p->ints[a->test_first + clauses];
    if (!ascends(&p->ints[a->test_first], clauses, tests) || !has_ints(p, a->tests, 2 * tests)
        || !has(p, SEC_TICKS, a->ages, tests)) {
        return false;
    }
    for (i = 0; i < tests; i++) {
        if (!is_within(p->ints[a->tests + 2 * i], -1, a->clocks)
            || !is_within(p->ticks[a->ages + i], 0, LIMIT + 1)) {
            return false;
        }
    }
    return true;
}

bool check_automaton(const plan *p, const automaton_plan *a)
{
    return is_within(a->locations, 2, MOST / CLOCKS_MOST) && is_within(a->clocks, 1, CLOCKS_MOST + 1)
           && is_within(a->initial, 0, a->locations) && is_within(a->classes, 1, MOST)
           && (a->letters >= 0) && is_within(a->rows, 1, MOST) && is_within(a->targets_count, 0, MOST)
           && ints_within(p, a->class_of, a->letters, 0, a->classes)
           && has_ints(p, a->bases, a->locations)
           && ints_within(p, a->widths, a->locations, 0, (int64_t)a->clocks + 1)
           && has_ints(p, a->strides, (int64_t)a->locations * a->clocks)
           && ((int64_t)a->rows * a->classes < MOST)
           && ints_within(p, a->edges, (int64_t)a->rows * a->classes, 0, a->targets_count)
           && ints_within(p, a->targets, a->targets_count, 0, a->locations)
           && ints_within(p, a->sources, (int64_t)a->targets_count * a->clocks, -1, a->clocks)
           && ints_within(p, a->time_values, a->rows, 0, 3) && check_rows(p, a)
           && check_clauses(p, a);
}

/* A diagram maps letters to classes through decisions. Each child comes after its parent, so following
 * children ends; decisions are contiguous, so one scan up to the farthest child checks them all. A
 * decision consists of: the proposition; the digit for each truth, for the worse and for the better
 * reading; the number of children; the children. */
static bool check_diagram(const plan *p, const judge_plan *j, int64_t at, int32_t classes)
{
    const int64_t end = p->counts[SEC_INTS];
    int64_t farthest = at;
    int64_t one = at;
    while (one <= farthest) {
        int32_t children;
        int32_t i;
        if (!has_ints(p, one, 8) || !is_within(p->ints[one], 0, j->propositions.count)) {
            return false;
        }
        children = p->ints[one + 7];
        if ((children < 1) || !ints_within(p, one + 1, 6, 0, children)
            || !has_ints(p, one + 8, children)) {
            return false;
        }
        for (i = 0; i < children; i++) {
            const int32_t child = p->ints[one + 8 + i];
            if (child < 0) {
                if (!is_within(~child, 0, classes)) {
                    return false;
                }
            } else if (!is_within(child, one + 8 + children, end)) {
                return false;
            } else {
                farthest = (child > farthest) ? child : farthest;
            }
        }
        one += 8 + children;
    }
    return true;
}

/* Whether every letter that a judge's links can add up to is in its table: the least and the
 * greatest sum, for both readings. */
static bool check_letters(const plan *p, const part_plan *x, int32_t judge_number, int32_t letters)
{
    int64_t low[2] = {0, 0};
    int64_t high[2] = {0, 0};
    int32_t i;
    int32_t k;
    int32_t v;
    for (i = 0; i < x->nodes.count; i++) {
        const list links = p->nodes[x->nodes.first + i].links;
        for (k = links.first; k < links.first + links.count; k++) {
            const link_plan *l = &p->links[k];
            const int32_t *weights[2];
            int32_t r;
            if ((l->judge != judge_number) || ((l->kind & LINK_LETTER) == 0)) {
                continue;
            }
            weights[0] = l->worse;
            weights[1] = l->better;
            for (r = 0; r < 2; r++) {
                int32_t least_one = weights[r][0];
                int32_t most_one = weights[r][0];
                for (v = 1; v < 3; v++) {
                    least_one = (weights[r][v] < least_one) ? weights[r][v] : least_one;
                    most_one = (weights[r][v] > most_one) ? weights[r][v] : most_one;
                }
                low[r] += least_one;
                high[r] += most_one;
            }
        }
    }
    return (low[0] >= 0) && (low[1] >= 0) && (high[0] < letters) && (high[1] < letters);
}

/* Whether a number is a node of the part, or -1 for none. */
static bool is_node(const part_plan *x, int32_t node)
{
    return is_within(node, -1, x->nodes.count);
}

/* Check the nodes, engine and tables of a judge. An episodic judge has to say when episodes end;
 * captured values can blur only if there is a trigger. */
bool check_judge(const plan *p, const part_plan *x, int32_t number)
{
    const judge_plan *j = &p->judges[x->judges.first + number];
    const automaton_plan *a;
    int32_t i;
    if (!is_node(x, j->trigger) || !is_node(x, j->again) || !is_node(x, j->unborn)
        || !is_node(x, j->determined) || !is_node(x, j->running) || !is_node(x, j->blurs)
        || !is_within(j->owner, 0, x->requirements)
        || !is_within(j->requirement, 0, p->header->requirements)
        || ((x->captured > 0) && (j->requirement != x->requirement))
        || (((j->flags & (JUDGE_EPISODIC | JUDGE_HIDDEN)) == JUDGE_EPISODIC) && (j->running < 0))
        || ((x->captures.count > 0) && (x->captured > 0) && (j->blurs >= 0) && (j->trigger < 0))
        || !lists(p, j->propositions, 0, x->nodes.count) || !lists(p, j->leaves, 0, x->nodes.count)
        || !lists(p, j->names, 0, (int64_t)x->signals.count + x->events.count)) {
        return false;
    }
    for (i = 0; i < 8; i++) {
        if (!is_within(j->outcomes[i], 0, 16) || ((j->outcomes[i] & 3) == RV_NOT_TRIGGERED)) {
            return false;
        }
    }
    if (j->automaton < 0) {
        return (j->automaton == -1) && ((j->flags & JUDGE_TRACED) == 0) && is_within(j->form, 0, x->forms.count) && (j->diagram == -1);
    }
    if (!is_within(j->automaton, 0, p->counts[SEC_AUTOMATA])) {
        return false;
    }
    a = &p->automata[j->automaton];
    if ((a->clocks > x->clocks)
        || (((j->flags & JUDGE_TRACED) != 0) && (a->locations > TRACED_MOST))) {
        return false;
    }
    if (j->diagram >= 0) {
        return check_diagram(p, j, j->diagram, a->classes);
    }
    return (j->diagram == -1) && check_letters(p, x, number, a->letters);
}

static bool check_operator(const plan *p, const part_plan *x, const operator_plan *o, int32_t leaves,
                           int32_t place)
{
    if (!is_within(o->kind, 0, OPS) || !is_within(o->turned, 0, 2) || !is_distance(o->low)
        || !is_distance(o->high) || !is_within(o->over, -1, LIMIT)) {
        return false;
    }
    switch (o->kind) {
    case OP_LEAF:
        return is_within(o->left, 0, leaves) && is_node(x, o->right)
               && is_within(o->values[0], 0, 4) && is_within(o->values[1], 0, 4)
               && is_within(o->values[2], 0, 4);
    case OP_JUNCTION: return (o->operands.count >= 1) && lists(p, o->operands, 0, place);
    case OP_WINDOW:
    case OP_SHIFT: return is_within(o->left, 0, place);
    default: return is_within(o->left, 0, place) && is_within(o->right, 0, place);
    }
}

/* Check a chain: each window is over the one before, the innermost over a leaf or a junction. */
static bool check_chain(const plan *p, const form_plan *f)
{
    const operator_plan *nodes = &p->operators[f->operators.first];
    int32_t under = f->base;
    int32_t i;
    if (!lists(p, f->windows, 0, f->operators.count) || (f->windows.count > CLOCKS_MOST)
        || (f->windows.count == 0)) {
        return f->windows.count == 0;
    }
    if (!is_within(f->base, 0, f->operators.count) || !is_within(f->left, -1, f->operators.count)
        || !is_within(f->excused, -1, f->operators.count)
        || ((f->left >= 0) && (nodes[f->left].kind != OP_LEAF))
        || ((f->excused >= 0) && ((f->left < 0) || (nodes[f->excused].kind != OP_LEAF)))
        || ((nodes[f->base].kind != OP_LEAF) && (nodes[f->base].kind != OP_JUNCTION))) {
        return false;
    }
    for (i = 0; i < f->windows.count; i++) {
        const int32_t one = p->lists[f->windows.first + i];
        const operator_plan *n = &nodes[one];
        if ((n->kind != OP_WINDOW) || (n->left != under) || (n->low < 0) || (n->high < n->low)
            || (n->over < 0) || ((p->header->gap == 0) && (n->low != 0))) {
            return false;
        }
        under = one;
    }
    return true;
}

/* Check the operators of a formula with `leaves` leaves: operands precede their operators, and there
 * are no more leaves than operators. */
bool check_operators(const plan *p, const part_plan *x, list operators, int32_t leaves)
{
    int32_t k;
    if (!has(p, SEC_OPERATORS, operators.first, operators.count) || (operators.count < 1)
        || !is_within(leaves, 0, (int64_t)operators.count + 1)) {
        return false;
    }
    for (k = 0; k < operators.count; k++) {
        if (!check_operator(p, x, &p->operators[operators.first + k], leaves, k)) {
            return false;
        }
    }
    return true;
}

bool check_forms(const plan *p, const part_plan *x)
{
    int32_t i;
    for (i = 0; i < x->forms.count; i++) {
        const form_plan *f = &p->forms[x->forms.first + i];
        if ((f->reach < 0) || !check_operators(p, x, f->operators, f->leaves) || !check_chain(p, f)) {
            return false;
        }
    }
    return true;
}

bool check_watches(const plan *p, const part_plan *x)
{
    int32_t i;
    for (i = 0; i < x->watches.count; i++) {
        const watch_plan *w = &p->watches[x->watches.first + i];
        if (!is_within(w->node, 0, x->nodes.count) || !is_within(w->is_pulse, 0, 2)
            || !lists(p, w->groups, 0, x->groups.count)) {
            return false;
        }
    }
    return true;
}

/* The number of items of a group; 0 if its axes are wrong or the product exceeds ITEMS_MOST. The
 * limit is divided before it is compared, so the product does not overflow. */
static int64_t items_of_group(const plan *p, const part_plan *x, const group_plan *g)
{
    const int32_t *axes = LIST(p, g->axes);
    int64_t items = 1;
    int32_t i;
    for (i = 0; (items > 0) && (i < g->axes.count); i += 2) {
        const bool fits = is_within(axes[i], 0, x->watches.count) && (axes[i + 1] >= 1)
                          && (axes[i + 1] <= x->watches.count - axes[i]);
        items = (fits && (axes[i + 1] <= ITEMS_MOST / items)) ? items * axes[i + 1] : 0;
    }
    return items;
}

bool check_groups(const plan *p, const part_plan *x)
{
    int64_t first = 0;
    int32_t i;
    for (i = 0; i < x->groups.count; i++) {
        const group_plan *g = &p->groups[x->groups.first + i];
        int64_t items;
        if (!is_within(g->occasion, -1, x->watches.count) || (g->first != first)
            || !has(p, SEC_LISTS, g->axes.first, g->axes.count) || (g->axes.count % 2 != 0)
            || !is_within(g->axes.count, 2, 2 * AXES_MOST + 1)) {
            return false;
        }
        items = items_of_group(p, x, g);
        first += items;
        if ((items == 0) || (first > ITEMS_MOST)) {
            return false;
        }
    }
    return true;
}
