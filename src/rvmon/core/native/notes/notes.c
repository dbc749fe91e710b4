/* The history from which notes are written (write_notes.c). It never influences verdicts.
 *
 * Per run: for each node that notes describe, since when it has its truth and when it was last false and
 * last true; and the same before the last change of any node, as a network may report a decision one
 * position late. Per judge: rings of the leaves at triggers and at doubts. Consecutive triggers with
 * equal leaves share an entry, so attempts need not store leaves. */
#include "input/input.h"
#include "networks/network.h"
#include "notes/notes.h"

#include <string.h>

/* Assign slots to the nodes that notes of some judge describe: propositions and leaves. */
static void number_logged(const rv_monitor *m, part *p)
{
    int32_t i;
    int32_t k;
    int32_t l;
    for (i = 0; i < p->plan->nodes.count; i++) {
        p->slots[i] = -1;
    }
    p->logged = 0;
    for (i = 0; i < p->plan->judges.count; i++) {
        const list lists_of[2] = {p->judges[i].propositions, p->judges[i].leaves};
        for (k = 0; k < 2; k++) {
            const int32_t *nodes = LIST(&m->plan, lists_of[k]);
            for (l = 0; l < lists_of[k].count; l++) {
                if (p->slots[nodes[l]] < 0) {
                    p->slots[nodes[l]] = p->logged;
                    p->logged++;
                }
            }
        }
    }
}

/* Allocate the history of a run; false: memory is short. */
bool make_notes(run *r)
{
    arena *a = &r->home->monitor->memory;
    const int32_t logged_count = r->part->logged;
    int32_t i;
    if (r->truth_log == NULL) {
        r->truth_log = arena_take(a, sizeof *r->truth_log);
        if (r->truth_log == NULL) {
            return false;
        }
        r->truth_log->nodes = arena_take(a, ((size_t)logged_count + 1U) * sizeof *r->truth_log->nodes);
        if (r->truth_log->nodes == NULL) {
            return false;
        }
    }
    for (i = 0; i < r->part->plan->judges.count; i++) {
        if (r->judges[i].noting == NULL) {
            r->judges[i].noting = arena_take(a, sizeof *r->judges[i].noting);
            if (r->judges[i].noting == NULL) {
                return false;
            }
        }
        clear_noting(r, i);
    }
    r->truth_log->since = RV_NO_TIME;
    reset_truth_log(r, RV_NO_TIME);
    return true;
}

/* Drop the history of a run, as not all of it could be allocated. */
static void drop_notes(run *r)
{
    int32_t i;
    r->truth_log = NULL;
    for (i = 0; i < r->part->plan->judges.count; i++) {
        r->judges[i].noting = NULL;
    }
}

int rv_keep_notes(rv_monitor *m, rv_let_go let_piece_go, void *user)
{
    int32_t i;
    bool done = true;
    if (m->shapes != NULL) {
        return RV_OK; /* margins are reported without reasons */
    }
    m->let_go = let_piece_go;
    m->let_go_user = user;
    for (i = 0; !m->keeps_notes && done && (i < m->plan.part_count); i++) {
        part *p = &m->parts[i];
        p->slots = arena_take(&m->memory, (size_t)(p->plan->nodes.count + 1) * sizeof *p->slots);
        done = p->slots != NULL;
        if (done) {
            number_logged(m, p);
            done = make_notes(m->homes[i].root) && begin_unknowns(&m->homes[i]);
        }
    }
    if (!done) {
        for (i = 0; i < m->plan.part_count; i++) {
            drop_notes(m->homes[i].root);
        }
        m->spoilt = true;
        return RV_NO_MEMORY;
    }
    m->keeps_notes = true;
    return RV_OK;
}

/* Reset the history: every node has its truth since the first position, `t`. */
void reset_truth_log(run *r, int64_t t)
{
    truth_log *s = r->truth_log;
    int32_t i;
    for (i = 0; i < r->part->logged; i++) {
        logged_node *own = &s->nodes[i];
        own->now.since = t;
        own->now.last[0] = own->now.last[1] = RV_NO_TIME;
        own->moved_at = RV_NO_TIME;
    }
    s->moved_at = t;
}

/* Copy the history to a forked run. */
void copy_truth_log(run *made, const run *r)
{
    int32_t i;
    for (i = 0; i < r->part->logged; i++) {
        made->truth_log->nodes[i].now = r->truth_log->nodes[i].now;
        made->truth_log->nodes[i].moved_at = RV_NO_TIME;
    }
    made->truth_log->moved_at = r->truth_log->moved_at;
    made->truth_log->since = r->truth_log->since;
}

/* A node changes at position `t`; `was` is its old truth. */
void note_node(run *r, int32_t node, uint8_t was, int64_t t)
{
    const int32_t slot = r->part->slots[node];
    logged_node *own;
    if (slot < 0) {
        return;
    }
    own = &r->truth_log->nodes[slot];
    r->truth_log->moved_at = t;
    if (own->moved_at != t) {
        own->moved_at = t;
        own->was = own->now;
        own->truth = was;
    }
    own->now.since = t;
    if (was != IS_UNKNOWN) {
        own->now.last[was / IS_TRUE] = r->at.before;
    }
}

/* The run that knows the truths of a node: of events that the run of an attempt does not hear of, its
 * parent. */
static const run *knower(const run *r, int32_t node)
{
    return ((r->parent != NULL) && (r->part->unheard[node] != 0)) ? r->parent : r;
}

/* The position of the last change that notes of a run show. */
int64_t moved_at(const run *r)
{
    const int64_t own = r->truth_log->moved_at;
    const bool hears_all = (r->parent == NULL) || !r->part->has_unheard;
    return (hears_all || (r->parent->truth_log->moved_at < own)) ? own : r->parent->truth_log->moved_at;
}

/* The history of a node, if it changed at the last position at which any did; else NULL. */
static const logged_node *moved_last(const run *r, int32_t node)
{
    const logged_node *own = &knower(r, node)->truth_log->nodes[r->part->slots[node]];
    return ((own->moved_at == moved_at(r)) && (own->moved_at != RV_NO_TIME)) ? own : NULL;
}

truth_times truth_times_of(const run *r, int32_t node, bool before)
{
    const logged_node *own = &knower(r, node)->truth_log->nodes[r->part->slots[node]];
    return (before && (moved_last(r, node) != NULL)) ? own->was : own->now;
}

/* Pack the truths of nodes, as they are now or as they were before the last change of any node. */
void pack_truths(const run *r, list nodes, bool before, int64_t *words)
{
    const int32_t *node = LIST(PLAN(r), nodes);
    const int32_t *end = node + nodes.count;
    int64_t *to = words;
    uint64_t word = 0;
    uint32_t shift = 0;
    for (; node < end; node++) {
        const logged_node *was = before ? moved_last(r, *node) : NULL;
        if (shift == 2 * TRUTHS_IN_WORD) {
            (void)memcpy(to, &word, sizeof word);
            to++;
            word = 0;
            shift = 0;
        }
        word |= (uint64_t)((was != NULL) ? was->truth : knower(r, *node)->truth[*node]) << shift;
        shift += 2;
    }
    if (shift > 0) {
        (void)memcpy(to, &word, sizeof word);
    }
}

/* Pack the leaves of a judge as reports show them: UNKNOWN where a leaf has another truth only because
 * its signal is not born yet. Returns whether there is such a leaf. */
bool pack_leaves(const run *r, int32_t index, bool before, int64_t *words)
{
    const list leaves = r->part->judges[index].leaves;
    const int32_t *node = LIST(PLAN(r), leaves);
    bool found = false;
    int32_t i;
    pack_truths(r, leaves, before, words);
    for (i = 0; (r->at.births_left > 0) && (i < leaves.count); i++) {
        if (is_taken_for(r, &r->part->nodes[node[i]])) {
            const uint32_t shift = 2U * ((uint32_t)i % TRUTHS_IN_WORD);
            uint64_t word = (uint64_t)words[(uint32_t)i / TRUTHS_IN_WORD];
            word = (word & ~((uint64_t)3 << shift)) | ((uint64_t)IS_UNKNOWN << shift);
            (void)memcpy(&words[(uint32_t)i / TRUTHS_IN_WORD], &word, sizeof word);
            found = true;
        }
    }
    return found;
}

/* The trigger of a judge's oldest open attempt; NEVER. */
static int64_t oldest_trigger(const run *r, int32_t index)
{
    const judge *j = &r->judges[index];
    int64_t found = j->noting->undecidable_since;
    if (!queue_is_empty(j)) {
        found = least(found, queue_item(j, 0)->triggered);
    }
    if (j->first >= 0) {
        found = least(found, attempt_at(r->home, j->first)->triggered);
    }
    return found;
}

/* Append an entry for instant `t` to a ring of a judge; NULL: memory is short. A full ring first drops
 * the entries that no open attempt needs, and grows if that freed less than half. */
static int64_t *add_truths(const run *r, int32_t index, truths *ring, int32_t words, int64_t t)
{
    rv_monitor *m = r->home->monitor;
    int64_t *made;
    if (ring->count == ring->room) {
        drop_truths(ring, words, least(oldest_trigger(r, index), t));
        if ((2 * (int64_t)ring->count > ring->room) /* else it would soon be full again */
            && !grow_truths(m, ring, words)) {
            return NULL;
        }
    }
    made = next_truths(m, ring, words);
    if (made != NULL) {
        made[0] = t;
    }
    return made;
}

/* Whether the leaves of a judge have these truths, as pack_leaves() packs them. */
static bool leaves_are(const run *r, int32_t index, const int64_t *words)
{
    const list leaves = r->part->judges[index].leaves;
    const int32_t *node = LIST(PLAN(r), leaves);
    const bool awaits_birth = r->at.births_left > 0;
    uint64_t left = 0;
    int32_t i;
    for (i = 0; i < leaves.count; i++) {
        const bool is_taken = awaits_birth && is_taken_for(r, &r->part->nodes[node[i]]);
        const uint64_t truth = is_taken ? (uint64_t)IS_UNKNOWN : r->truth[node[i]];
        left = ((uint32_t)i % TRUTHS_IN_WORD == 0U) ? (uint64_t)words[(uint32_t)i / TRUTHS_IN_WORD] : left;
        if ((left & 3U) != truth) {
            return false;
        }
        left >>= 2;
    }
    return true;
}

/* An attempt is triggered at `t`: remember the leaves, unless they equal those at the last trigger, whose
 * entry then serves this one, too. */
void note_trigger(run *r, int32_t index, int64_t t)
{
    noting *n = r->judges[index].noting;
    const int32_t words = words_for(r->part->judges[index].leaves.count);
    const truths *ring = &n->triggers;
    n->began_at = t;
    if ((ring->count == 0) || !leaves_are(r, index, &entry_of(ring, ring->count - 1, words)[1])) {
        int64_t *made = add_truths(r, index, &n->triggers, words, t);
        if (made != NULL) {
            (void)pack_leaves(r, index, false, &made[1]);
        }
    }
}

/* Unknown input at `t` may keep attempts undecided: remember the leaves, once per instant. */
void note_doubt(run *r, int32_t index, int64_t t)
{
    noting *n = r->judges[index].noting;
    const list leaves = r->part->judges[index].leaves;
    const int32_t words = words_for(leaves.count);
    truths *ring = &n->doubts;
    int64_t *made;
    if ((ring->count > 0) && (entry_of(ring, ring->count - 1, words)[0] >= t)) {
        return;
    }
    made = add_truths(r, index, ring, words, t);
    n->doubted_at = t;
    if (made != NULL) {
        pack_truths(r, leaves, false, &made[1]);
    }
}

/* The position at which an attempt started; the last one if the end of the trace triggered it. */
int64_t begin_of(const run *r, int32_t index, const attempt *x)
{
    return (r->part->judges[index].trigger < 0) ? r->at.position : x->triggered;
}

/* The entry of the doubt that keeps an attempt open, or NULL: that where its readings parted; for a
 * network the first doubt since its start. */
const int64_t *doubt_of(const run *r, int32_t index, const attempt *x)
{
    const truths *ring = &r->judges[index].noting->doubts;
    const int32_t words = words_for(r->part->judges[index].leaves.count);
    int32_t i;
    if (x->doubted_at != RV_NO_TIME) {
        return truths_at(ring, words, x->doubted_at);
    }
    for (i = 0; is_networked(r, index) && (i < ring->count); i++) {
        if (entry_of(ring, i, words)[0] >= begin_of(r, index, x)) {
            return entry_of(ring, i, words);
        }
    }
    return NULL;
}

/* The readings of an attempt have parted, or agree again, at the position of its judge. */
void note_parting(run *r, int32_t index, attempt *x)
{
    if ((r->part->judges[index].flags & JUDGE_HIDDEN) == 0) {
        x->doubted_at = x->parted ? r->judges[index].position : RV_NO_TIME;
        if (x->parted) {
            note_doubt(r, index, x->doubted_at);
        }
    }
}

/* Whether a proposition of a judge is unknown. */
static bool is_in_doubt(const run *r, int32_t index)
{
    const list propositions = r->part->judges[index].propositions;
    const int32_t *nodes = LIST(PLAN(r), propositions);
    int32_t i;
    for (i = 0; i < propositions.count; i++) {
        if (r->truth[nodes[i]] == IS_UNKNOWN) {
            return true;
        }
    }
    return false;
}

/* An attempt starts at position `t` (not in a queue). */
void note_begin(run *r, int32_t index, attempt *x, int64_t t)
{
    if ((r->part->judges[index].flags & JUDGE_HIDDEN) != 0) {
        x->doubted_at = t;
        note_doubt(r, index, t);
    } else if (is_networked(r, index) && is_in_doubt(r, index)) {
        note_doubt(r, index, t);
    } else {
        /* Nothing is in doubt. */
    }
}

/* An undecidable attempt was triggered at `t`. */
void note_undecidable(run *r, int32_t index, int64_t t)
{
    noting *n = r->judges[index].noting;
    n->undecidable_since = least(n->undecidable_since, t);
}

/* Count the open attempts of a network, for their notes. */
void note_open_count(run *r, int32_t index)
{
    int32_t at;
    if (is_networked(r, index)) {
        r->judges[index].noting->open_count = 0;
        for (at = next_open(r, index, -1); at >= 0; at = next_open(r, index, at)) {
            r->judges[index].noting->open_count++;
        }
    }
}
