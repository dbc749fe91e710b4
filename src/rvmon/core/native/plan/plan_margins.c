/* The check of what is measured. */
#include "plan/plan_check.h"

#include <math.h>

/* What a measure reads is a node, a distance that of two numbers. */
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
    if ((n->op != NODE_LEAF) || !(m->factor > 0.0) || isinf(m->factor)) {
        return false;
    }
    op = p->atoms[x->atoms.first + n->a].op;
    return (op == ATOM_REAL) || (op == ATOM_COMPARE) || (op == ATOM_PAYLOAD);
}

/* Each leaf has a measure of its own, and what is moved along is a sweep. */
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
