/* Pulses: momentary atoms that do no more than start attempts.
 *
 * An event ends at the next position. If only triggers of pulses read the atom, its end changes nothing
 * but the truths of atom and leaf, since a pulse starts attempts where it is TRUE. So that position is
 * not visited: the truths are set once time passes it. The one exception is a stretch in doubt that
 * ends there, of which a DOUBT above the leaf has to hear.
 *
 * Source: SEMANTICS 3 (a pulse starts an attempt at every position where it holds). */
#include "formulas/formulas.h"
#include "input/input.h"
#include "notes/notes.h"
#include "runs/runs.h"

/* Whether a node is read by triggers of pulses alone, in the second phase. */
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
    for (i = 0; i < n->parents[1].count; i++) {
        if (!is_doubt_of_pulse(&p->nodes[parents[i]])) {
            return false;
        }
    }
    return true;
}

/* Find the pulses of a part; false: memory is short. Runs that capture values keep what occurred, and
 * margins and recorded truths are told of each position, so there all ends are visited. */
bool find_pulses(arena *a, const plan *all, part *p)
{
    const bool are_unheard = (all->header->gap > 0) && (p->plan->captured == 0)
                             && (p->plan->truths < 0) && (all->counts[SEC_MARGINS] == 0);
    int32_t i;
    p->pulses = arena_take(a, (size_t)(p->plan->atoms.count + 1) * sizeof *p->pulses);
    for (i = 0; (p->pulses != NULL) && (i < p->plan->atoms.count); i++) {
        const list leaves = p->atoms[i].nodes[1];
        p->pulses[i] = -1;
        if (are_unheard && (p->atoms[i].momentary != 0) && (leaves.count == 1)) {
            const int32_t leaf = LIST(all, leaves)[0];
            if ((p->nodes[leaf].op == NODE_LEAF) && is_read_by_pulses(all, p, &p->nodes[leaf])) {
                p->pulses[i] = leaf;
            }
        }
    }
    return p->pulses != NULL;
}

/* Whether an atom of the last position is FALSE at the next, and nothing there hears of it. */
static bool ends_unheard(const run *r, int32_t atom)
{
    const int32_t leaf = r->part->pulses[atom];
    list doubts;
    int32_t i;
    if ((leaf < 0) || (atom_now(r, &r->part->atoms[atom]) != IS_FALSE)) {
        return false;
    }
    doubts = r->part->nodes[leaf].parents[1];
    for (i = 0; i < doubts.count; i++) {
        if (r->truth[LIST(PLAN(r), doubts)[i]] != IS_FALSE) {
            return false;
        }
    }
    return true;
}

/* End an atom at `t`, where nothing hears of it. */
static void end_unheard(run *r, int32_t atom, int64_t t)
{
    const int32_t leaf = r->part->pulses[atom];
    const list doubts = r->part->nodes[leaf].parents[1];
    const uint8_t was = r->truth[leaf];
    int32_t i;
    r->is_fading[atom] = 0;
    r->atom[atom] = IS_FALSE;
    r->truth[leaf] = IS_FALSE;
    for (i = 0; i < doubts.count; i++) {
        (void)doubt_stays(r, LIST(PLAN(r), doubts)[i], IS_FALSE);
    }
    if (r->truth_log != NULL) {
        note_node(r, leaf, was, t);
    }
}

/* Time passes the position behind the last one visited: end what held there, unless something hears of
 * it or an attempt is due there, so that it has to be visited. */
void end_pulses(run *r)
{
    const int64_t t = r->at.position + GAP(r);
    bool is_visited = (r->at.phase == 0) || (timers_next(&r->rules) <= t);
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
        end_unheard(r, r->fading[i], t);
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
