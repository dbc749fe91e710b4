/* Pulses: momentary atoms that only start attempts.
 *
 * If only pulse triggers read the atom of an event, nothing but its leaf changes where it occurs, and at
 * the next position, where it ends. So neither position is visited for it: attempts start when the sample
 * arrives, and the truths end once time passes the next position. The one exception is a stretch in doubt
 * that starts or ends there, as a DOUBT above the leaf has to see it.
 *
 * Source: SEMANTICS 3 (a pulse starts an attempt at every position where it holds). */
#include "attempts/attempts.h"
#include "formulas/formulas.h"
#include "input/input.h"
#include "notes/notes.h"
#include "runs/runs.h"
#include "windows/windows.h"

/* Whether in the second phase only pulse triggers, and at most one DOUBT, read a node. */
static bool is_read_by_pulses(const plan *all, const part *p, const node_plan *n)
{
    const link_plan *l = &all->links[n->links.first];
    const int32_t *parents = LIST(all, n->parents[1]);
    int32_t i;
    for (i = 0; i < n->links.count; i++) {
        if ((l[i].kind != LINK_TRIGGER)
            || ((p->judges[l[i].judge].flags & (JUDGE_PULSE | JUDGE_EPISODIC)) != JUDGE_PULSE)) {
            return false;
        }
    }
    return (n->parents[1].count == 0)
           || ((n->parents[1].count == 1) && is_doubt_of_pulse(&p->nodes[parents[0]]));
}

/* Whether an event only starts attempts with captured values. Their runs need not hear of it: its leaves
 * are then `unheard`, and notes read them in the parent. Networks log letters of their own, so they hear
 * everything. */
static bool only_starts(const plan *all, part *p, const event_plan *e)
{
    const int32_t *atoms = LIST(all, e->on_occurrence[1]);
    bool found = (p->plan->captures.count > 0) && ((e->flags & EVENT_MARKS) == 0);
    int32_t i;
    int32_t k;
    for (i = 0; i < p->plan->judges.count; i++) {
        found = found && (p->judges[i].automaton >= 0);
    }
    for (i = 0; i < e->on_occurrence[1].count; i++) {
        const list leaves = p->atoms[atoms[i]].nodes[1];
        for (k = 0; found && (k < leaves.count); k++) {
            found = is_read_by_pulses(all, p, &p->nodes[LIST(all, leaves)[k]]);
        }
    }
    for (i = 0; found && (i < e->on_occurrence[1].count); i++) {
        const list leaves = p->atoms[atoms[i]].nodes[1];
        for (k = 0; k < leaves.count; k++) {
            p->unheard[LIST(all, leaves)[k]] = 1;
            p->has_unheard = true;
        }
    }
    return found;
}

/* Find the pulses of a part; false: memory is short. Runs that capture values keep occurrences, and
 * margins and recorded truths see each position, so parts with these visit all ends of events. */
bool find_pulses(arena *a, const plan *all, part *p)
{
    const bool are_unheard = (all->header->gap > 0) && (p->plan->captured == 0)
                             && (p->plan->truths < 0) && (all->counts[SEC_MARGINS] == 0);
    int32_t i;
    p->pulses = arena_take(a, (size_t)(p->plan->atoms.count + 1) * sizeof *p->pulses);
    p->pulse_doubts = arena_take(a, (size_t)(p->plan->atoms.count + 1) * sizeof *p->pulse_doubts);
    p->pulsing = arena_take(a, (size_t)(p->plan->events.count + 1) * sizeof *p->pulsing);
    p->starts_only = arena_take(a, (size_t)p->plan->events.count + 1U);
    p->unheard = arena_take(a, (size_t)p->plan->nodes.count + 1U);
    if ((p->pulses == NULL) || (p->pulse_doubts == NULL) || (p->pulsing == NULL) || (p->starts_only == NULL)
        || (p->unheard == NULL)) {
        return false;
    }
    for (i = 0; i < p->plan->atoms.count; i++) {
        const list leaves = p->atoms[i].nodes[1];
        p->pulses[i] = -1;
        p->pulse_doubts[i] = -1;
        if (are_unheard && (p->atoms[i].momentary != 0) && (leaves.count == 1)) {
            const int32_t leaf = LIST(all, leaves)[0];
            if ((p->nodes[leaf].op == NODE_LEAF) && is_read_by_pulses(all, p, &p->nodes[leaf])) {
                const list doubts = p->nodes[leaf].parents[1];
                p->pulses[i] = leaf;
                p->pulse_doubts[i] = (doubts.count > 0) ? LIST(all, doubts)[0] : -1;
            }
        }
    }
    for (i = 0; i < p->plan->events.count; i++) {
        const list atoms = p->events[i].on_occurrence[1];
        const int32_t atom = (atoms.count == 1) ? LIST(all, atoms)[0] : -1;
        const bool is_pulse = (atom >= 0) && (p->pulses[atom] >= 0) && (p->atoms[atom].op == ATOM_EVENT)
                              && (p->events[i].flags == 0) && (all->header->gap == 1)
                              && (p->plan->watches.count == 0);
        p->pulsing[i] = is_pulse ? atom : -1;
        p->starts_only[i] = only_starts(all, p, &p->events[i]) ? 1 : 0;
    }
    return true;
}

/* Whether the DOUBT above the leaf of a pulse has to see its changes. */
static inline bool is_doubted(const run *r, int32_t atom)
{
    const int32_t doubt = r->part->pulse_doubts[atom];
    return (doubt >= 0) && (r->truth[doubt] != IS_FALSE);
}

/* Whether an atom of the last position is FALSE at the next, and nothing depends on that. */
static bool ends_unheard(const run *r, int32_t atom)
{
    return (r->part->pulses[atom] >= 0) && !is_doubted(r, atom)
           && (atom_now(r, &r->part->atoms[atom]) == IS_FALSE);
}

/* Set the leaf of a pulse at `t`, if no DOUBT has to see it. */
static inline void set_unheard(run *r, int32_t atom, uint8_t now, int64_t t)
{
    const int32_t leaf = r->part->pulses[atom];
    const int32_t doubt = r->part->pulse_doubts[atom];
    const uint8_t was = r->truth[leaf];
    r->truth[leaf] = now;
    if (doubt >= 0) {
        r->seen[r->part->nodes[doubt].slot] = now; /* as doubt_stays() does */
    }
    if (r->truth_log != NULL) {
        note_node(r, leaf, was, t);
    }
}

/* Take an event that is just a pulse; false: it has to be taken in full. Its leaf is evaluated when its
 * position is visited, or set when its attempts start. */
bool take_pulse(run *r, int32_t local, int32_t says)
{
    const int32_t atom = r->part->pulsing[local];
    if ((atom < 0) || (r->at.phase == 0)) {
        return false;
    }
    if ((r->is_fresh[atom] != 0U) && (r->atom[atom] == IS_TRUE)) {
        return true; /* it has occurred already, so further updates change nothing */
    }
    if ((says != RV_SAYS_YES) || (r->at.presence != ARE_THERE) || (r->at.lost_count > 0)
        || (r->atom[atom] != IS_FALSE) || is_doubted(r, atom)) {
        return false;
    }
    r->atom[atom] = IS_TRUE;
    r->is_fresh[atom] = 1;
    r->fresh[r->at.fresh_count] = atom;
    r->at.fresh_count++;
    return true;
}

/* Start the attempts of the pulses at `t`, where nothing else happens. */
void start_pulses(run *r, int64_t t)
{
    const int32_t count = r->at.fresh_count;
    int32_t i;
    int32_t k;
    r->at.starting = IS_FALSE;
    r->at.before = t - 1;
    r->at.position = t;
    r->at.alarm = t + 1; /* they end there */
    r->at.fresh_count = 0;
    r->at.fading_count = count; /* the earlier ones have ended */
    for (i = 0; i < count; i++) {
        r->fading[i] = r->fresh[i];
        r->is_fresh[r->fading[i]] = 0;
        r->is_fading[r->fading[i]] = 1;
        set_unheard(r, r->fading[i], IS_TRUE, t);
    }
    for (i = 0; i < count; i++) {
        const list links = r->part->nodes[r->part->pulses[r->fading[i]]].links;
        for (k = links.first; k < links.first + links.count; k++) {
            const int32_t index = PLAN(r)->links[k].judge;
            if (take_trigger(r, index, IS_TRUE)) {
                begin_here(r, index, t, t);
            }
        }
    }
}

/* Whether a position has to be visited for what is due by then, as not all is decided by time alone. */
static bool is_due(run *r, int64_t t)
{
    const int32_t count = (timers_next(&r->rules) <= t) ? timers_due(&r->rules, t, r->due_rules) : 0;
    int32_t i;
    for (i = 0; i < count; i++) {
        if ((r->judges[r->due_rules[i]].first >= 0) && !is_chained(r, r->due_rules[i])) {
            return true;
        }
    }
    return false;
}

/* Time passes the position after the last one visited: end the pulses of that one, unless something
 * depends on their end or an attempt is due there, so that the position has to be visited. */
void end_pulses(run *r)
{
    const int64_t t = r->at.position + GAP(r);
    bool is_visited = (r->at.phase == 0) || is_due(r, t);
    int32_t kept = 0;
    int32_t i;
    for (i = 0; !is_visited && (i < r->at.fading_count); i++) {
        is_visited = !ends_unheard(r, r->fading[i]);
    }
    if (is_visited) {
        return;
    }
    r->at.starting = IS_FALSE;
    r->at.before = r->at.position;
    for (i = 0; i < r->at.fading_count; i++) {
        r->is_fading[r->fading[i]] = 0;
        r->atom[r->fading[i]] = IS_FALSE;
        set_unheard(r, r->fading[i], IS_FALSE, t);
    }
    r->at.fading_count = 0;
    for (i = 0; i < r->repeating_count; i++) {
        const int32_t index = r->repeating[i];
        r->judges[index].before = r->truth[r->part->judges[index].trigger];
        if (r->judges[index].before == IS_TRUE) {
            r->repeating[kept] = index;
            kept++;
        }
    }
    r->repeating_count = kept;
}
