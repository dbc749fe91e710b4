/* Validation of a part's inputs, expression programs, atoms, nodes and margins. */
#include "input/input.h"
#include "plan/plan_check.h"

#include <math.h>

/* Check signals and events. Fields of a part's events are numbered without gaps, so that they fit its
 * `fields`. */
bool check_inputs(const plan *p, const part_plan *x)
{
    int32_t i;
    int32_t fields = 0;
    for (i = 0; i < x->signals.count; i++) {
        const signal_plan *s = &p->signals[x->signals.first + i];
        if (!is_within(s->name, 0, p->header->signals) || !is_within(s->births, 0, 3)
            || !is_within(s->stale_after, 0, LIMIT) || !is_within(s->perishable, -1, x->perishable)
            || !both(p, s->on_change, 0, x->atoms.count) || !both(p, s->on_update, 0, x->atoms.count)
            || !lists(p, s->on_birth, 0, x->nodes.count) || !lists(p, s->needs, 0, x->atoms.count)) {
            return false;
        }
    }
    for (i = 0; i < x->events.count; i++) {
        const event_plan *e = &p->events[x->events.first + i];
        const int64_t number = (int64_t)e->name - p->header->signals;
        if (!is_within(number, 0, p->header->events) || (e->field != fields)
            || (e->fields != p->field_first[number + 1] - p->field_first[number])
            || (((e->flags & EVENT_KEY) != 0) && ((x->each == 0) || (i != x->each_event)))
            || !both(p, e->on_occurrence, 0, x->atoms.count)
            || !lists(p, e->needs, 0, x->atoms.count)
            || !is_within(e->key, -1, e->fields)) {
            return false;
        }
        fields += e->fields;
    }
    return fields == x->fields;
}

/* Check a program: operands are in range, it ends, and its stack neither underflows nor reaches
 * PROGRAM_DEPTH. Programs have no jumps, so one pass over the words is enough. */
static bool check_program(const plan *p, const part_plan *x, int64_t place)
{
    int32_t depth = 0;
    int64_t at;
    for (at = place; is_within(at, 0, p->counts[SEC_CODE]); at++) {
        const int32_t op = p->code[at] & 255;
        const int32_t arg = p->code[at] >> 8;
        switch (op) {
        case CODE_END: return depth == 1;
        case CODE_NUMBER:
            if (!is_within(arg, 0, p->counts[SEC_NUMBERS])) {
                return false;
            }
            depth++;
            break;
        case CODE_SIGNAL:
        case CODE_PREV:
        case CODE_DELTA:
        case CODE_RATE:
            if (!is_within(arg, 0, x->signals.count)) {
                return false;
            }
            depth++;
            break;
        case CODE_NOW: depth++; break;
        case CODE_WINDOW:
            if (!is_within(arg, 0, x->amounts)) {
                return false;
            }
            depth++;
            break;
        case CODE_CAPTURED:
            if (!is_within(arg, 0, x->captured)) {
                return false;
            }
            depth++;
            break;
        case CODE_FIELD:
            at++;
            if (!is_within(arg, 0, x->events.count) || (at >= p->counts[SEC_CODE])
                || !is_within(p->code[at], 0, p->events[x->events.first + arg].fields)) {
                return false;
            }
            depth++;
            break;
        default:
            if (!is_within(op, CODE_ADD, CODE_NOW) || (depth < arguments_of(op))) {
                return false;
            }
            depth -= arguments_of(op) - 1;
            break;
        }
        if (depth >= PROGRAM_DEPTH) {
            return false;
        }
    }
    return false;
}

bool check_atoms(const plan *p, const part_plan *x)
{
    int32_t i;
    for (i = 0; i < x->atoms.count; i++) {
        const atom_plan *a = &p->atoms[x->atoms.first + i];
        const bool of_event = (a->op == ATOM_EVENT) || (a->op == ATOM_KNOWN_EVENT)
                              || (a->op == ATOM_UPDATED_EVENT);
        const bool of_programs = (a->op == ATOM_COMPARE) || (a->op == ATOM_PAYLOAD);
        const bool of_signal = !of_event && !of_programs && (a->op != ATOM_START);
        if (!is_within(a->op, 0, ATOMS) || !is_within(a->compare, 0, CMPS)
            || !is_within(a->momentary, 0, 256) || !both(p, a->nodes, 0, x->nodes.count)
            || (of_event && !is_within(a->input, 0, x->events.count))
            || (of_signal && !is_within(a->input, 0, x->signals.count))
            || (of_programs
                && (!check_program(p, x, a->left) || !check_program(p, x, a->right)))
            || !lists(p, a->events, 0, x->events.count)
            || (a->events.count > PAYLOAD_EVENTS_MOST)
            || ((a->op == ATOM_PAYLOAD) != (a->events.count > 0))) {
            return false;
        }
    }
    for (i = 0; i < x->captures.count; i++) {
        if (!check_program(p, x, p->lists[x->captures.first + i])) {
            return false;
        }
    }
    return true;
}

/* Check the operands of a node: as many as its operator needs, each before the node itself. So
 * evaluation in index order terminates and needs no recursion. */
static bool check_operands(const plan *p, const part_plan *x, const node_plan *n, int32_t place)
{
    switch (n->op) {
    case NODE_LEAF:
    case NODE_UNBORN: return lists(p, n->operands, 0, 2 * (int64_t)x->signals.count);
    case NODE_CONSTANT:
    case NODE_LAPSED:
    case NODE_ELAPSED: return n->operands.count == 0;
    case NODE_AND:
    case NODE_OR:
    case NODE_COMPARED: return (n->operands.count >= 1) && lists(p, n->operands, 0, place);
    case NODE_EVER:
    case NODE_EDGE:
    case NODE_STRETCH: return (n->operands.count == 2) && lists(p, n->operands, 0, place);
    case NODE_WINDOW: return (n->operands.count >= 1) && lists(p, n->operands, 0, place);
    default: return (n->operands.count == 1) && lists(p, n->operands, 0, place);
    }
}

/* Check the memory and timer of a node: the kind of memory that its operator needs. Timers have to be
 * numbered in the order of their nodes, so that no two nodes share one. */
static bool check_memory(const part_plan *x, const node_plan *n, int32_t *timed_nodes)
{
    int32_t slots = 0;
    bool timed = true;
    switch (n->op) {
    case NODE_DOUBT:
    case NODE_PREVIOUS: slots = x->seen; break;
    case NODE_EVER:
        slots = x->seen;
        timed = false;
        break;
    case NODE_EDGE: slots = x->edges; break;
    case NODE_STRETCH:
    case NODE_WINDOW: slots = x->stretches; break;
    case NODE_ELAPSED:
    case NODE_PASSED: break;
    default: timed = false; break;
    }
    if ((slots > 0) ? !is_within(n->slot, 0, slots) : is_within(n->op, NODE_DOUBT, NODE_PASSED)) {
        return false;
    }
    if (!timed) {
        return n->timer == -1;
    }
    (*timed_nodes)++;
    return n->timer == *timed_nodes - 1;
}

/* Check what a link adds to a letter. Weights are 0 unless a table classifies letters; then
 * check_letters bounds their sums, so that a running sum stays in 32 bits. */
static bool check_weights(const plan *p, const part_plan *x, const link_plan *l)
{
    const judge_plan *j = &p->judges[x->judges.first + l->judge];
    const int64_t end = ((j->automaton >= 0) && (j->diagram < 0)) ? MOST : 1;
    int32_t v;
    for (v = 0; v < 3; v++) {
        if (!is_within(l->worse[v], 0, end) || !is_within(l->better[v], 0, end)) {
            return false;
        }
    }
    return true;
}

/* Check the links of a node. Those to its watches ascend and add to `*watched`, so that each watch of
 * the part turns out to be linked once. */
static bool check_links(const plan *p, const part_plan *x, int32_t node, list links, int32_t *watched)
{
    int32_t last = -1;
    int32_t i;
    if (!has(p, SEC_LINKS, links.first, links.count)) {
        return false;
    }
    for (i = links.first; i < links.first + links.count; i++) {
        const link_plan *l = &p->links[i];
        if (l->kind == LINK_WATCH) {
            if (!is_within(l->judge, (int64_t)last + 1, x->watches.count)
                || (p->watches[x->watches.first + l->judge].node != node)) {
                return false;
            }
            last = l->judge;
            *watched += 1;
        } else if (!is_within(l->judge, 0, x->judges.count) || ((l->kind & LINK_WATCH) != 0)
                   || !check_weights(p, x, l)) {
            return false;
        } else {
            /* A link to a judge. */
        }
    }
    return true;
}

/* Check an atom whose left program yields the numbers of a WINDOW or PASSED node. */
static bool check_read(const plan *p, const part_plan *x, int32_t number)
{
    const atom_plan *a;
    if (!is_within(number, 0, x->atoms.count)) {
        return false;
    }
    a = &p->atoms[x->atoms.first + number];
    return (a->op == ATOM_COMPARE) || (a->op == ATOM_PAYLOAD);
}

/* Check a PASSED node: `a` yields the duration, `low` is the program for the instant it counts from. */
static bool check_passed(const plan *p, const part_plan *x, const node_plan *n)
{
    return check_read(p, x, n->a) && is_within(n->b, 0, 2) && check_program(p, x, n->low);
}

/* Check a WINDOW node: the aggregate, its limit or result, its members. Minimum, maximum and first value
 * are not compared with a limit here: they exist only as WINDOW_NUMBER. */
static bool check_window(const plan *p, const part_plan *x, const node_plan *n)
{
    const int32_t fold = n->b & WINDOW_FOLD;
    const bool tallied = is_within(fold, FOLD_SUM, FOLD_VARIANCE + 1);
    const bool alone = (n->b & WINDOW_NUMBER) == 0;
    const int32_t *operands = &p->lists[n->operands.first];
    int32_t i;
    if (!is_within(fold, 0, FOLDS) || !is_within(n->b, 0, 2 * WINDOW_NUMBER) || (n->most < 0)
        || (alone ? !check_program(p, x, n->low) : !is_within(n->low, 0, x->amounts))
        || (alone && (fold > FOLD_DISTINCT))
        || ((fold == FOLD_AGO) && ((n->high >= LIMIT) || (n->most > 0)))
        || !is_within(n->chosen, 1, n->operands.count + 1)
        || !is_within(n->since, -1, x->captured)
        || (tallied ? !is_within(n->sum, 0, x->sums) : (n->sum != -1))) {
        return false;
    }
    if ((fold == FOLD_COUNT) || (fold == FOLD_DURATION)) {
        const bool counted = (n->b & WINDOW_COUNTED) != 0;
        return (n->a == -1) && (!counted || ((n->most > 0) && (n->chosen > 1)));
    }
    for (i = n->chosen; i < n->operands.count; i++) {
        const node_plan *one = &p->nodes[x->nodes.first + operands[i]];
        if ((one->op != NODE_LEAF) || !check_read(p, x, one->a)) {
            return false;
        }
    }
    return ((n->b & WINDOW_COUNTED) == 0) && check_read(p, x, n->a);
}

bool check_nodes(const plan *p, const part_plan *x)
{
    int32_t timed_nodes = 0;
    int32_t watched = 0;
    int32_t i;
    for (i = 0; i < x->nodes.count; i++) {
        const node_plan *n = &p->nodes[x->nodes.first + i];
        if (!is_within(n->op, 0, NODES) || !check_operands(p, x, n, i)
            || !check_memory(x, n, &timed_nodes) || !both(p, n->parents, (int64_t)i + 1, x->nodes.count)
            || !check_links(p, x, i, n->links, &watched) || (n->low < 0) || (n->high < 0)
            || ((n->op == NODE_LEAF)
                && (!is_within(n->a, 0, x->atoms.count) || !is_within(n->b, 0, 3)))
            || ((n->op == NODE_CONSTANT) && !is_within(n->a, 0, 3))
            || ((n->op == NODE_PASSED) && !check_passed(p, x, n))
            || ((n->op == NODE_COMPARED) && !check_read(p, x, n->a))
            || ((n->op == NODE_WINDOW) && !check_window(p, x, n))) {
            return false;
        }
    }
    for (i = 0; i < x->dead_timers.count; i++) {
        if (p->nodes[x->nodes.first + p->lists[x->dead_timers.first + i]].timer < 0) {
            return false;
        }
    }
    return (timed_nodes == x->timers) && (watched == x->watches.count);
}

/* Margins. */

/* Check a measure: it reads a node, a DISTANCE a comparison of two numbers. */
static bool check_measure(const plan *p, const part_plan *x, const measure_plan *m)
{
    const node_plan *n;
    int32_t op;
    if (!is_within(m->kind, 0, MEASURES) || !is_within(m->turned, 0, 2)) {
        return false;
    }
    if (m->kind == MEASURE_CONSTANT) {
        return m->node == -1;
    }
    if (!is_within(m->node, 0, x->nodes.count)) {
        return false;
    }
    n = &p->nodes[x->nodes.first + m->node];
    if (m->kind != MEASURE_DISTANCE) {
        return true;
    }
    if (((n->op != NODE_LEAF) && (n->op != NODE_COMPARED)) || !(m->factor > 0.0) || isinf(m->factor)) {
        return false;
    }
    op = p->atoms[x->atoms.first + n->a].op;
    return (op == ATOM_REAL) || (op == ATOM_COMPARE) || (op == ATOM_PAYLOAD);
}

/* Check a measured formula: leaves are numbered in order, with one measure each. A SHIFT is over an
 * UNTIL ahead or a SINCE back, by a distance other than 0, which is what the sweep of margin_windows.c
 * handles. */
static bool check_margin(const plan *p, const part_plan *x, const margin_plan *g)
{
    const operator_plan *nodes;
    int32_t leaves = 0;
    int32_t i;
    if (!has(p, SEC_MEASURES, g->measures.first, g->measures.count)
        || !check_operators(p, x, g->operators, g->measures.count)
        || !is_within(g->looks_back, 0, 2)) {
        return false;
    }
    for (i = 0; i < g->measures.count; i++) {
        if (!check_measure(p, x, &p->measures[g->measures.first + i])) {
            return false;
        }
    }
    nodes = &p->operators[g->operators.first];
    for (i = 0; i < g->operators.count; i++) {
        const operator_plan *o = &nodes[i];
        const bool moved_on = (o->kind == OP_SHIFT) && (o->low > 0);
        const int32_t swept = moved_on ? OP_UNTIL : OP_SINCE;
        if ((o->kind == OP_LEAF) && (o->left != leaves)) {
            return false;
        }
        if ((o->kind == OP_SHIFT) && ((nodes[o->left].kind != swept) || (o->low == 0))) {
            return false;
        }
        leaves += (o->kind == OP_LEAF) ? 1 : 0;
    }
    return leaves == g->measures.count;
}

bool check_margins(const plan *p, const part_plan *x)
{
    int32_t i;
    for (i = 0; (p->counts[SEC_MARGINS] > 0) && (i < x->judges.count); i++) {
        if (!check_margin(p, x, &p->margins[x->judges.first + i])) {
            return false;
        }
    }
    return true;
}
