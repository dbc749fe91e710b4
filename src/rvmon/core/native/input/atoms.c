/* Atoms: the truths that formulas read from the input (SEC_ATOMS in plan.md).
 *
 * An atom is read again when its input changes, so its truth is always current; if it changed, its
 * leaves are marked dirty. A *momentary* atom (an event, `updated`, `changed`) is valid at one position
 * only. While it is not FALSE it is listed: as *fresh* when it is read between positions, because it is
 * valid at the one to come; from that position on as *fading*, to be read again at the next one. */
#include "formulas/formulas.h"
#include "input/input.h"

/* For each comparison the set of orders (IS_LESS ...) for which it is true. */
enum { LESS = 1 << IS_LESS, EQUAL = 1 << IS_EQUAL, GREATER = 1 << IS_GREATER };
static const uint8_t HOLDS_FOR[CMPS] = {
    [CMP_LT] = LESS, [CMP_LE] = LESS | EQUAL, [CMP_EQ] = EQUAL, [CMP_NE] = LESS | GREATER,
    [CMP_GE] = GREATER | EQUAL, [CMP_GT] = GREATER,
};

/* A comparison without a branch on the order, which would be unpredictable for noisy values. */
static uint8_t compare_real(int32_t how, const rv_number *value, double constant)
{
    const int32_t order = order_of(value->as.real, constant);
    if (value->kind != RV_REAL) {
        return IS_UNKNOWN;
    }
    return (uint8_t)(IS_TRUE * ((HOLDS_FOR[how] >> order) & 1));
}

/* Up to this many comparisons, doing them all is faster than testing a span; beyond, the span pays. */
#define QUICK_MOST 4

/* The kind of values of a signal that take_quickly() can take; RV_UNKNOWN: it cannot take it. In the
 * second phase only a few comparisons with constants, or leaves of its own truth, may read the signal. */
static int32_t kind_compared_only(const plan *all, const part *p, int32_t local)
{
    const signal_plan *s = &p->signals[local];
    const list atoms = s->on_change[1];
    int32_t op = ATOM_REAL;
    int32_t i;
    if ((s->flags != 0) || (s->perishable >= 0) || (atoms.count == 0) || (atoms.count > QUICK_MOST)) {
        return RV_UNKNOWN;
    }
    for (i = 0; i < atoms.count; i++) {
        const atom_plan *a = &p->atoms[LIST(all, atoms)[i]];
        op = (i == 0) ? a->op : op;
        if ((a->op != op) || ((op != ATOM_REAL) && (op != ATOM_SIGNAL)) || (a->momentary != 0)
            || (a->nodes[1].count != 1)) {
            return RV_UNKNOWN;
        }
    }
    return (op == ATOM_REAL) ? RV_REAL : RV_WHOLE;
}

/* Find the signals of a part for take_quickly(), and prepare their comparisons; false: memory is
 * short. */
bool find_quick(arena *a, const plan *all, part *p)
{
    const int32_t signals = p->plan->signals.count;
    int32_t local;
    p->quick = arena_take(a, (size_t)(signals + 1) * sizeof *p->quick);
    for (local = 0; (p->quick != NULL) && (local < signals); local++) {
        const list atoms = p->signals[local].on_change[1];
        const int32_t kind = kind_compared_only(all, p, local);
        quick_compare *made;
        int32_t i;
        int32_t k;
        if ((kind == RV_UNKNOWN) || (p->plan->captured > 0)) {
            continue; /* runs with captured values need the spans, which show whom a sample concerns */
        }
        made = arena_take(a, (size_t)atoms.count * sizeof *made);
        if (made == NULL) {
            return false;
        }
        for (i = 0; i < atoms.count; i++) {
            const int32_t atom = LIST(all, atoms)[i];
            const int32_t node = LIST(all, p->atoms[atom].nodes[1])[0];
            made[i].constant = (kind == RV_REAL) ? p->atoms[atom].constant : 0.0;
            made[i].atom = atom;
            made[i].word = node >> 6;
            made[i].dirty = UINT64_C(1) << (node & 63);
            made[i].dirty_word = UINT64_C(1) << (made[i].word & 63);
            for (k = IS_EQUAL; k <= IS_GREATER; k++) {
                const int32_t how = (kind == RV_REAL) ? p->atoms[atom].compare : CMP_NE;
                made[i].truths[k] = truth_if(((HOLDS_FOR[how] >> k) & 1) != 0);
            }
        }
        p->quick[local].compares = made;
        p->quick[local].count = atoms.count;
        p->quick[local].kind = kind;
    }
    return p->quick != NULL;
}

/* Compare the two programs of an atom; `at` is, by event, the occurrence that they read. */
static uint8_t compare_at(const run *r, const atom_plan *a, const int32_t *at)
{
    const rv_number left = program_value(r, a->left, at);
    const rv_number right = program_value(r, a->right, at);
    return (uint8_t)compare_numbers(a->compare, &left, &right);
}

/* Choose the first occurrence of each event of a list (`run.chosen`). FALSE: some event does not occur;
 * UNKNOWN: some event may have occurred in any way, so there is nothing to choose. */
uint8_t first_choice(const run *r, list of)
{
    const int32_t *events = LIST(PLAN(r), of);
    uint8_t found = IS_TRUE;
    int32_t i;
    for (i = 0; i < of.count; i++) {
        const int32_t e = events[i];
        const uint8_t one = (r->silent[e] == IS_UNKNOWN) ? IS_UNKNOWN : truth_if(r->payloads[e].count > 0);
        found = (one < found) ? one : found;
        r->chosen[e] = 0;
    }
    return found;
}

/* Choose the next combination of occurrences, one per event; false: there are no more. */
bool next_choice(const run *r, list of)
{
    const int32_t *events = LIST(PLAN(r), of);
    int32_t i;
    for (i = of.count - 1; i >= 0; i--) {
        r->chosen[events[i]]++;
        if (r->chosen[events[i]] < r->payloads[events[i]].count) {
            return true;
        }
        r->chosen[events[i]] = 0;
    }
    return false;
}

/* Whether all chosen occurrences are certain. */
bool is_sure_choice(const run *r, list of)
{
    const int32_t *events = LIST(PLAN(r), of);
    bool sure = true;
    int32_t i;
    for (i = 0; i < of.count; i++) {
        sure = sure && (r->payloads[events[i]].known[r->chosen[events[i]]] != 0U);
    }
    return sure;
}

/* ATOM_PAYLOAD: Kleene's `or` of the comparison over all combinations of occurrences; FALSE if one of
 * the events does not occur. */
static uint8_t over_occurrences(const run *r, const atom_plan *a)
{
    const uint8_t occur = first_choice(r, a->events);
    uint8_t found = IS_FALSE;
    if (occur != IS_TRUE) {
        return occur;
    }
    do {
        const uint8_t one = is_sure_choice(r, a->events) ? compare_at(r, a, r->chosen) : IS_UNKNOWN;
        found = (one > found) ? one : found;
    } while (next_choice(r, a->events));
    return found;
}

/* The truth of an atom, given the updates taken for this position so far. */
uint8_t atom_now(const run *r, const atom_plan *a)
{
    const int32_t signals = r->part->plan->signals.count;
    switch (a->op) {
    case ATOM_SIGNAL:
        return (r->value[a->input].kind == RV_UNKNOWN)
            ? IS_UNKNOWN : truth_if(r->value[a->input].as.whole != 0);
    case ATOM_REAL: return compare_real(a->compare, &r->value[a->input], a->constant);
    case ATOM_COMPARE: return compare_at(r, a, NULL);
    case ATOM_PAYLOAD: return over_occurrences(r, a);
    case ATOM_EVENT:
        return (r->absent[signals + a->input] != 0U) ? IS_UNKNOWN : r->occurs[a->input];
    case ATOM_KNOWN_SIGNAL:
        if ((r->at.lost_count > 0) && (r->lost[a->input] != NOT_LOST)) {
            return IS_UNKNOWN;
        }
        return truth_if(r->value[a->input].kind != RV_UNKNOWN);
    case ATOM_KNOWN_EVENT: return truth_if(r->occurs[a->input] != IS_UNKNOWN);
    case ATOM_UPDATED_SIGNAL:
        return (r->absent[a->input] != 0U) ? IS_UNKNOWN : r->updated[a->input];
    case ATOM_UPDATED_EVENT:
        return (r->absent[signals + a->input] != 0U)
            ? IS_UNKNOWN : r->updated[signals + a->input];
    case ATOM_CHANGED: return (r->absent[a->input] != 0U) ? IS_UNKNOWN : r->changed[a->input];
    default: return r->at.starting;
    }
}

/* Whether an atom has to be read again at the next position even if no update comes. */
static bool is_momentary(const run *r, int32_t atom)
{
    return (r->atom[atom] != IS_FALSE) && (r->momentary[atom] != 0U);
}

/* List a momentary atom as valid at the position to come. */
static void list_fresh(run *r, int32_t atom)
{
    if (is_momentary(r, atom) && (r->is_fresh[atom] == 0U)) {
        r->is_fresh[atom] = 1;
        r->fresh[r->at.fresh_count] = atom;
        r->at.fresh_count++;
    }
}

bool recheck(run *r, int32_t atom)
{
    const atom_plan *a = &r->part->atoms[atom];
    const uint8_t now = (a->op == ATOM_REAL)
        ? compare_real(a->compare, &r->value[a->input], a->constant) : atom_now(r, a);
    const bool changed = now != r->atom[atom];
    /* A comparison of fields may be UNKNOWN for another reason than before, which decides whether its
     * leaf is unborn. */
    if (changed || (a->tells != 0) || ((a->op == ATOM_PAYLOAD) && (now == IS_UNKNOWN))) {
        const list nodes = a->nodes[r->at.phase];
        const int32_t *node = LIST(PLAN(r), nodes);
        int32_t i;
        r->atom[atom] = now;
        for (i = 0; i < nodes.count; i++) {
            mark_dirty(r, node[i]);
        }
    }
    if (r->momentary[atom] != 0U) {
        list_fresh(r, atom);
    }
    return changed;
}

bool recheck_list(run *r, list l)
{
    const int32_t *atoms = LIST(PLAN(r), l);
    bool changed = false;
    int32_t i;
    for (i = 0; i < l.count; i++) {
        changed = recheck(r, atoms[i]) || changed;
    }
    return changed;
}

/* List a momentary atom to be read again at the next position. */
static void fade(run *r, int32_t atom)
{
    if (is_momentary(r, atom) && (r->is_fading[atom] == 0U)) {
        r->is_fading[atom] = 1;
        r->fading[r->at.fading_count] = atom;
        r->at.fading_count++;
    }
}

/* Read atoms again between two positions. If occurrences of the last position are still held (`over`:
 * runs with captured values keep them until the next), momentary atoms belong to the last position. */
void recheck_amid(run *r, list l)
{
    const int32_t *atoms = LIST(PLAN(r), l);
    int32_t i;
    recheck_list(r, l);
    for (i = 0; r->over && (i < l.count); i++) {
        fade(r, atoms[i]);
    }
}

/* At the start of a position: read the momentary atoms of the last position again; fresh atoms are valid
 * at this position, and fade after it. */
void recheck_fading(run *r)
{
    const int32_t count = r->at.fading_count;
    int32_t i;
    for (i = 0; i < count; i++) {
        r->is_fading[r->fading[i]] = 0;
    }
    r->at.fading_count = 0;
    for (i = 0; i < count; i++) {
        (void)recheck(r, r->fading[i]);
    }
    for (i = 0; i < r->at.fresh_count; i++) {
        const int32_t atom = r->fresh[i];
        r->is_fresh[atom] = 0;
        fade(r, atom);
        if (r->part->pulses[atom] >= 0) {
            mark_dirty(r, r->part->pulses[atom]); /* take_pulse() has not marked its leaf */
        }
    }
    r->at.fresh_count = 0;
}

/* Read an atom whose nodes are evaluated anyway. `pending`: occurrences so far belong to the next
 * position. */
void reread(run *r, int32_t atom, bool pending)
{
    r->atom[atom] = atom_now(r, &r->part->atoms[atom]);
    if (!is_momentary(r, atom)) {
        return;
    }
    if (pending) {
        list_fresh(r, atom);
    } else {
        fade(r, atom);
    }
}

/* Whether a signal of a list is not born. An entry is twice the signal's number, plus 1 if its birth
 * takes an update after the first value. */
static bool is_unborn(const run *r, list births)
{
    const int32_t *one = LIST(PLAN(r), births);
    int32_t i;
    for (i = 0; i < births.count; i++) {
        if (r->births[one[i] >> 1] <= (one[i] & 1)) {
            return true;
        }
    }
    return false;
}

/* Whether no occurrence of an atom's events is unknown: an unborn signal does not excuse lost events. */
static bool all_occurrences_known(const run *r, const atom_plan *a)
{
    const int32_t *events = LIST(PLAN(r), a->events);
    int32_t i;
    int32_t j;
    for (i = 0; i < a->events.count; i++) {
        const occurrences *o = &r->payloads[events[i]];
        if (r->silent[events[i]] == IS_UNKNOWN) {
            return false;
        }
        for (j = 0; j < o->count; j++) {
            if (o->known[j] == 0U) {
                return false;
            }
        }
    }
    return true;
}

/* Whether a leaf has the truth `b` because its atom is UNKNOWN only due to a signal not born yet. */
bool is_taken_for(const run *r, const node_plan *n)
{
    return (n->op == NODE_LEAF) && (r->atom[n->a] == IS_UNKNOWN) && (n->b != IS_UNKNOWN)
           && is_unborn(r, n->operands) && all_occurrences_known(r, &r->part->atoms[n->a]);
}

/* The truth of a leaf: that of its atom or, while a signal is unborn, `b`. */
uint8_t leaf_truth(const run *r, const node_plan *n)
{
    if (n->op == NODE_UNBORN) {
        return truth_if(is_unborn(r, n->operands));
    }
    return is_taken_for(r, n) ? (uint8_t)n->b : r->atom[n->a];
}
