/* The graph of formulas of the present and the past: re-evaluates the nodes that a change reaches.
 *
 * Nodes are numbered operands first. Dirty nodes are bits in a set of two levels (`dirty`, and
 * `dirty_words`: which words of it are not 0), so that taking the lowest bit yields them in evaluation
 * order, and a node is evaluated at most once per position. A node whose truth changes marks its
 * parents and updates the letters of its judges. Operators of the past keep their state in the run:
 * `seen` (one truth), `edges`, `past` (past.c, window.c).
 *
 * Truths are ordered FALSE < UNKNOWN < TRUE: Kleene's `and` is the least operand, `or` the greatest. */
#include "formulas/formulas.h"
#include "input/input.h"
#include "notes/notes.h"
#include "results/results.h"

#include <string.h>

void mark_dirty(run *r, int32_t node)
{
    const int32_t word = node >> 6;
    r->dirty[word] |= UINT64_C(1) << (node & 63);
    r->dirty_words[word >> 6] |= UINT64_C(1) << (word & 63);
}

void mark_all_dirty(run *r)
{
    int32_t i;
    for (i = 0; i < r->part->plan->nodes.count; i++) {
        mark_dirty(r, i);
    }
}

void mark_parents(run *r, const node_plan *n, int32_t op)
{
    const list parents = n->parents[r->at.phase];
    const int32_t *parent = LIST(PLAN(r), parents);
    int32_t i;
    for (i = 0; i < parents.count; i++) {
        if (r->part->nodes[parent[i]].op == op) {
            mark_dirty(r, parent[i]);
        }
    }
}

/* AND, OR: all operands are read, as there are few; stopping at the deciding one does not pay. */
static uint8_t combined(const run *r, const node_plan *n)
{
    const int32_t *operands = LIST(PLAN(r), n->operands);
    uint8_t found = r->truth[operands[0]];
    int32_t i;
    for (i = 1; i < n->operands.count; i++) {
        const uint8_t one = r->truth[operands[i]];
        if ((n->op == NODE_AND) ? (one < found) : (one > found)) {
            found = one;
        }
    }
    return found;
}

/* ELAPSED: `low` ticks since the first position. After an outage at the start, the first position lies
 * between `origin`, the first one that may exist, and `sure_from`, the first one that certainly does. */
static uint8_t elapsed(run *r, const node_plan *n, int64_t t)
{
    const int64_t due = sum(r->at.sure_from, n->low);
    const int64_t may_be_due = sum(r->at.origin, n->low);
    timers_set(&r->wake, n->timer, (t < may_be_due) ? may_be_due : ((t < due) ? due : NEVER));
    return (t >= due) ? IS_TRUE : ((t >= may_be_due) ? IS_UNKNOWN : IS_FALSE);
}

/* PASSED: the same for a number of seconds (program `left` of the atom) since an instant (program `low`,
 * in ticks since the first position); `known` is the truth of the operand that guards both. */
static uint8_t passed(run *r, const node_plan *n, int64_t t, uint8_t known)
{
    const rv_number after = program_value(r, r->part->atoms[n->a].left, NULL);
    const rv_number since = program_value(r, (int32_t)n->low, NULL);
    int64_t delay;
    int64_t due;
    int64_t may_be_due;
    if ((known != IS_TRUE) || (after.kind == RV_UNKNOWN) || (since.kind != RV_WHOLE)) {
        timers_set(&r->wake, n->timer, NEVER);
        return IS_UNKNOWN;
    }
    delay = since.as.whole + seconds_in_ticks(&after) + n->b;
    due = (delay >= LIMIT) ? NEVER : r->at.sure_from + delay;
    may_be_due = (delay >= LIMIT) ? NEVER : r->at.origin + delay;
    timers_set(&r->wake, n->timer, (t < may_be_due) ? may_be_due : ((t < due) ? due : NEVER));
    return (t >= due) ? IS_TRUE : ((t >= may_be_due) ? IS_UNKNOWN : IS_FALSE);
}

/* PREVIOUS: the operand at the previous position. If it differs from the operand now, the node changes
 * at the next position although nothing else does. */
static uint8_t previous(run *r, const node_plan *n, int64_t t, uint8_t operand)
{
    const uint8_t value = r->seen[n->slot];
    r->seen[n->slot] = operand;
    timers_set(&r->wake, n->timer, (value != operand) ? t + step_of(r) : NEVER);
    return value;
}

/* EVER, `left S right` without bounds: (value before and left) or right, so one truth is its state. */
static uint8_t ever(run *r, const node_plan *n, uint8_t left, uint8_t right)
{
    uint8_t value = r->seen[n->slot];
    value = (left < value) ? left : value;
    value = (right > value) ? right : value;
    r->seen[n->slot] = value;
    return value;
}

/* The left side of a `since` at positions that may not exist: UNKNOWN, except for the constant TRUE of
 * `once`, which needs no position. */
static uint8_t left_there(const run *r, const node_plan *n)
{
    const node_plan *left = &r->part->nodes[LIST(PLAN(r), n->operands)[0]];
    return ((left->op == NODE_CONSTANT) && (left->a == IS_TRUE)) ? IS_TRUE : IS_UNKNOWN;
}

/* Step every operator with state through UNKNOWN operands from `t` on, for a stretch of positions that
 * may not exist (unknowns.c). */
void remember_unknown(run *r, int64_t t)
{
    int32_t i;
    for (i = 0; i < r->part->plan->nodes.count; i++) {
        const node_plan *n = &r->part->nodes[i];
        switch (n->op) {
        case NODE_PREVIOUS: (void)previous(r, n, t, IS_UNKNOWN); break;
        case NODE_EVER: (void)ever(r, n, left_there(r, n), IS_UNKNOWN); break;
        case NODE_EDGE:
        case NODE_STRETCH: (void)node_since(r, n, t, left_there(r, n), IS_UNKNOWN); break;
        case NODE_WINDOW: (void)node_window(r, n, t, IS_UNKNOWN, true); break;
        default: break;
        }
    }
}

static uint8_t evaluated(run *r, int32_t place, int64_t t)
{
    const node_plan *n = &r->part->nodes[place];
    const int32_t *operands = LIST(PLAN(r), n->operands);
    switch (n->op) {
    case NODE_LEAF:
    case NODE_UNBORN: return leaf_truth(r, n);
    case NODE_CONSTANT: return (uint8_t)n->a;
    case NODE_LAPSED: return truth_if(t >= r->cut);
    case NODE_ELAPSED: return elapsed(r, n, t);
    case NODE_NOT: return (uint8_t)(IS_TRUE - r->truth[operands[0]]);
    case NODE_AND:
    case NODE_OR: return combined(r, n);
    case NODE_SURE: return truth_if(r->truth[operands[0]] == IS_TRUE);
    case NODE_DOUBT: return node_doubt(r, n, place, t, r->truth[operands[0]]);
    case NODE_PREVIOUS: return previous(r, n, t, r->truth[operands[0]]);
    case NODE_EVER: return ever(r, n, r->truth[operands[0]], r->truth[operands[1]]);
    case NODE_WINDOW: return node_window(r, n, t, r->truth[operands[0]], false);
    case NODE_PASSED: return passed(r, n, t, r->truth[operands[0]]);
    case NODE_COMPARED:
        reread(r, n->a, false);
        mark_parents(r, n, NODE_WINDOW); /* their limit may differ although this truth stays */
        if (r->margins != NULL) {
            margins_mark_changed(r, names_to_lose(r) + place); /* and so may the distance */
        }
        return r->atom[n->a];
    default: return node_since(r, n, t, r->truth[operands[0]], r->truth[operands[1]]);
    }
}

/* Store the truth of a node and pass it on along its links. A letter is a sum with one term for each
 * proposition, so it is updated by differences. */
static inline void store(run *r, int32_t place, uint8_t value, int64_t t)
{
    const node_plan *n = &r->part->nodes[place];
    const uint8_t was = r->truth[place];
    const link_plan *l = &PLAN(r)->links[n->links.first];
    const link_plan *end = l + n->links.count;
    if (r->margins != NULL) {
        margins_mark_changed(r, names_to_lose(r) + place);
    }
    r->truth[place] = value;
    if (r->truth_log != NULL) {
        note_node(r, place, was, t);
    }
    for (; l < end; l++) {
        judge *j;
        if (l->kind == LINK_WATCH) {
            call_watch(r, l->judge);
            continue;
        }
        j = &r->judges[l->judge];
        if ((l->kind & LINK_LETTER) != 0) {
            j->worse += l->worse[value] - l->worse[was];
            j->better += l->better[value] - l->better[was];
            touch(r, l->judge, TOUCHED_LETTER);
        }
        if ((l->kind & LINK_TRIGGER) != 0) {
            touch(r, l->judge, TOUCHED_TRIGGER);
        }
        if (((l->kind & LINK_DETERMINED) != 0) && (value == IS_TRUE)) {
            r->at.undetermined_left--;
        }
    }
}

/* Whether a node says that a trigger has ever been TRUE or FALSE; such a node has that link first. */
static bool is_determined_node(const run *r, const node_plan *n)
{
    return (n->links.count > 0) && ((PLAN(r)->links[n->links.first].kind & LINK_DETERMINED) != 0);
}

/* The truth of a node at a position that may not exist, with all inputs unknown. Formulas are UNKNOWN,
 * constants too; nodes about knowledge itself (LAPSED, DOUBT, SURE, and connectives over these) are
 * evaluated. */
static uint8_t blank_value(run *r, int32_t place, int64_t t)
{
    const node_plan *n = &r->part->nodes[place];
    const int32_t *operands = LIST(PLAN(r), n->operands);
    switch (n->op) {
    case NODE_LAPSED: return truth_if(t >= r->cut);
    case NODE_DOUBT: return node_doubt(r, n, place, t, IS_UNKNOWN);
    case NODE_NOT: return (uint8_t)(IS_TRUE - r->truth[operands[0]]);
    case NODE_AND:
    case NODE_OR: return combined(r, n);
    case NODE_SURE: return (r->truth[operands[0]] == IS_TRUE) ? IS_TRUE : IS_UNKNOWN;
    default: return IS_UNKNOWN;
    }
}

/* Set every formula to its blank value at `t`; a trigger that was ever known stays so. All nodes are
 * visited, operands first, which happens at most twice per outage. */
void blank_out(run *r, int64_t t)
{
    int32_t i;
    for (i = 0; i < r->part->plan->nodes.count; i++) {
        if (!is_determined_node(r, &r->part->nodes[i])) {
            const uint8_t value = blank_value(r, i, t);
            if (value != r->truth[i]) {
                store(r, i, value, t);
            }
        }
    }
}

/* Store a new truth of a node and mark the nodes that depend on it. */
static inline void change(run *r, int32_t place, uint8_t value, int64_t t)
{
    const list parents = r->part->nodes[place].parents[r->at.phase];
    const int32_t *parent = LIST(PLAN(r), parents);
    int32_t i;
    store(r, place, value, t);
    for (i = 0; i < parents.count; i++) {
        if (!doubt_stays(r, parent[i], value)) {
            mark_dirty(r, parent[i]);
        }
    }
}

bool has_dirty_nodes(const run *r)
{
    const int32_t words = (r->part->plan->nodes.count + 63) >> 6;
    int32_t upper;
    for (upper = 0; upper < ((words + 63) >> 6); upper++) {
        if (r->dirty_words[upper] != 0U) {
            return true;
        }
    }
    return false;
}

/* Evaluate all dirty nodes at the position at `t`. Parents are numbered higher than their operands, so
 * nodes marked meanwhile come later in the same sweep. */
void work_out(run *r, int64_t t)
{
    const int32_t words = (r->part->plan->nodes.count + 63) >> 6;
    int32_t upper;
    for (upper = 0; upper < ((words + 63) >> 6); upper++) {
        while (r->dirty_words[upper] != 0U) {
            const int32_t word = upper * 64 + lowest_bit(r->dirty_words[upper]);
            while (r->dirty[word] != 0U) {
                const int32_t place = word * 64 + lowest_bit(r->dirty[word]);
                uint8_t value;
                r->dirty[word] &= r->dirty[word] - 1;
                value = evaluated(r, place, t);
                if (value != r->truth[place]) {
                    change(r, place, value, t);
                }
            }
            r->dirty_words[upper] &= ~(UINT64_C(1) << (word & 63));
        }
    }
}

/* Evaluate again, at `t`, the nodes that read captured values, after a fork has captured them. Operators
 * of the past keep their state, except for windows that start with the attempt. `pending`: the events of
 * this sample belong to the next position. */
void reevaluate_varying(run *r, int64_t t, bool pending)
{
    const part_plan *p = r->part->plan;
    const int32_t *atoms = LIST(PLAN(r), p->varying_atoms);
    const int32_t *nodes = LIST(PLAN(r), p->varying_nodes);
    int32_t i;
    for (i = 0; i < p->varying_atoms.count; i++) {
        reread(r, atoms[i], pending);
    }
    for (i = 0; i < p->varying_nodes.count; i++) {
        const node_plan *n = &r->part->nodes[nodes[i]];
        uint8_t value;
        if (n->op == NODE_WINDOW) {
            if ((n->since < 0) || (r->captured[n->since].kind == RV_UNKNOWN)) {
                continue; /* a window that does not start with the attempt keeps its members */
            }
            restart_window(r, n);
        }
        value = evaluated(r, nodes[i], t);
        if (value != r->truth[nodes[i]]) {
            change(r, nodes[i], value, t); /* operators with state above it step at the next position */
        }
    }
}

/* Enter the second phase once every signal is born and every trigger has been TRUE or FALSE: from then
 * on the shorter lists of the plan are used, and the timers of nodes not needed any more stop. */
void settle_phase(run *r)
{
    if ((r->at.phase == 0) && (r->at.births_left == 0) && (r->at.undetermined_left == 0)) {
        const list dead = r->part->plan->dead_timers;
        const int32_t *nodes = LIST(PLAN(r), dead);
        int32_t i;
        r->at.phase = 1;
        for (i = 0; i < dead.count; i++) {
            timers_set(&r->wake, r->part->nodes[nodes[i]].timer, NEVER);
        }
    }
}
