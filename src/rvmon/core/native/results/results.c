/* The results that core.h lets a program read: records, open attempts, counts, verdicts, times; and
 * rv_late. */
#include "networks/network.h"
#include "notes/notes.h"
#include "runs/runs.h"

#include <string.h>

int64_t rv_records(const rv_monitor *m, const rv_record **records)
{
    *records = m->records;
    return m->record_count;
}

const rv_number *rv_captured(const rv_monitor *m, const rv_record *record)
{
    return (record->captured < 0) ? NULL : &m->captured[record->captured];
}

rv_staleness rv_stale(const rv_monitor *m, int32_t signal)
{
    return m->stale[signal];
}

int32_t rv_captured_of(const rv_monitor *m, int32_t requirement)
{
    int32_t i;
    for (i = 0; i < m->plan.part_count; i++) {
        const part_plan *p = &m->plan.parts[i];
        if ((p->captured > 0) && (p->requirement == requirement)) {
            return p->captured;
        }
    }
    return 0;
}

void rv_forget_records(rv_monitor *m)
{
    forget_notes(m, 0, 0);
    m->record_count = 0;
    m->captured_count = 0;
    m->sorted = 0;
}

/* The record of an open attempt, with a note if notes are kept. */
static rv_record open_record(run *r, int32_t index, const attempt *x, uint32_t number)
{
    const rv_monitor *m = r->home->monitor;
    rv_record made;
    (void)memset(&made, 0, sizeof made);
    made.requirement = r->part->judges[index].requirement;
    made.number = number;
    made.triggered = x->triggered;
    made.captured = -1;
    made.note = -1;
    if (r->truth_log != NULL) {
        made.note = note_open(r, index, x, 2 * m->reached + ((m->reached == m->last) ? 1 : 0),
                              x->cannot_pass, RV_NO_TIME);
    }
    made.verdict = RV_INCONCLUSIVE;
    made.decision = RV_OPEN;
    made.in_doubt = x->sure ? 0 : 1;
    return made;
}

/* Call `take` for the open attempts of a judge; false: `take` returned false. */
static bool each_open_of(run *r, int32_t index, rv_take take, void *user)
{
    const rv_number *captured = (r->part->plan->captured > 0) ? r->captured : NULL;
    queue_place place = {0, 0, 0};
    const attempt *x;
    bool more = true;
    int32_t at;
    if (r->truth_log != NULL) {
        note_open_count(r, index);
    }
    x = next_queued(r, index, &place, r->judges[index].position);
    while (more && (x != NULL)) {
        const rv_record one = open_record(r, index, x, x->number);
        more = take(user, &one, NULL);
        x = next_queued(r, index, &place, r->judges[index].position);
    }
    for (at = next_open(r, index, -1); more && (at >= 0); at = next_open(r, index, at)) {
        const rv_record one = open_record(r, index, attempt_at(r->home, at), reported_number(r, at));
        more = take(user, &one, captured);
    }
    return more;
}

void rv_each_open(rv_monitor *m, rv_take take, void *user)
{
    bool more = true;
    int32_t i;
    int32_t k;
    bracket_open_notes(m, true);
    for (i = 0; more && (i < m->plan.part_count); i++) {
        run *r;
        for (r = m->homes[i].root; more && (r != NULL); r = following(&m->homes[i], r)) {
            for (k = 0; more && (k < r->part->plan->judges.count); k++) {
                more = each_open_of(r, k, take, user);
            }
        }
    }
    bracket_open_notes(m, false);
}

/* Add the counts of a requirement in a part. A part with captured values counts in its home, as its runs
 * come and go. Whether its trigger was known is found in the root and the instances, except for an
 * instance whose key has occurred at no position yet. */
static void count_home(const home *h, int32_t requirement, rv_counts *counts)
{
    const run *r;
    int32_t i;
    if (h->part->plan->captured > 0) {
        counts->failed += h->failed;
        counts->passed += h->passed;
        counts->inconclusive += h->inconclusive;
    }
    for (r = h->root; r != NULL; r = following(h, r)) {
        const bool occurred = (r->rank == 0U) || (r->occurred <= r->at.position);
        for (i = 0; i < h->part->plan->judges.count; i++) {
            const judge *j = &r->judges[i];
            if (h->part->judges[i].requirement != requirement) {
                continue;
            }
            counts->open = counts->open || has_attempts(j) || (j->undecidable >= 0);
            if (h->part->plan->captured > 0) {
                counts->heard = counts->heard
                                || ((i == 0) && (r->parent == NULL) && occurred && was_heard(r, i));
            } else if (i < h->part->plan->requirements) {
                counts->failed += j->failed;
                counts->passed += j->passed;
                counts->inconclusive += j->inconclusive;
                counts->heard = was_heard(r, i);
            } else {
                /* Judges of attempts in doubt count with their owner. */
            }
        }
    }
}

rv_counts rv_count(const rv_monitor *m, int32_t requirement)
{
    rv_counts counts;
    int32_t i;
    (void)memset(&counts, 0, sizeof counts);
    for (i = 0; i < m->plan.part_count; i++) {
        const part_plan *p = m->homes[i].part->plan;
        if ((p->captured == 0) || (p->requirement == requirement)) {
            count_home(&m->homes[i], requirement, &counts);
        }
    }
    counts.open = counts.open && !m->finished;
    counts.late = m->late[requirement] != 0U;
    return counts;
}

int rv_verdict(const rv_monitor *m, int32_t requirement)
{
    const rv_counts counts = rv_count(m, requirement);
    if (counts.failed > 0) {
        return RV_FAIL;
    }
    if ((counts.inconclusive > 0) || counts.open || counts.late || m->spoilt) {
        return RV_INCONCLUSIVE;
    }
    if (counts.passed > 0) {
        return RV_PASS;
    }
    return counts.heard ? RV_NOT_TRIGGERED : RV_INCONCLUSIVE;
}

bool rv_spoilt(const rv_monitor *m)
{
    return m->spoilt;
}

rv_sizes rv_sizes_of(const rv_monitor *m)
{
    rv_sizes found;
    found.signals = m->plan.header->signals;
    found.events = m->plan.header->events;
    found.fields = m->plan.header->fields;
    found.requirements = m->plan.header->requirements;
    found.captured = m->plan.header->captured;
    return found;
}

int32_t rv_fields_of(const rv_monitor *m, int32_t event, int32_t *first)
{
    *first = m->plan.field_first[event];
    return m->plan.field_first[event + 1] - *first;
}

/* The end of the trace: the last sample or outage, or `t` if that is later, or in a trace with a gap the
 * last tick that has certainly passed. */
int64_t rv_end(const rv_monitor *m, int64_t t)
{
    int64_t end = (m->outage_at > m->last) ? m->outage_at : m->last;
    if (end != RV_NO_TIME) {
        end = (t > end) ? t : end;
        if ((m->plan.header->gap > 0) && (m->reached - 1 > end)) {
            end = m->reached - 1;
        }
    }
    return end;
}

int64_t rv_next_due(rv_monitor *m)
{
    int64_t found = NEVER;
    int32_t i;
    for (i = 0; !m->finished && !m->spoilt && (i < m->plan.part_count); i++) {
        found = least(found, home_due(&m->homes[i]));
    }
    return found;
}

rv_times rv_times_of(const rv_monitor *m)
{
    rv_times found;
    found.began = m->began;
    found.last = m->last;
    found.reached = m->reached;
    return found;
}

/* A sample that comes too late is not judged. Requirements that it could have affected are marked, and no
 * longer get PASS or NOT_TRIGGERED: those whose judges depend on a leaf of its names, found by one pass
 * up the graph of nodes.
 *
 * Source: SEMANTICS 6 (Too late). */

static void mark_nodes(const run *r, list l, uint8_t *reads)
{
    const int32_t *nodes = LIST(PLAN(r), l);
    int32_t i;
    for (i = 0; i < l.count; i++) {
        reads[nodes[i]] = 1;
    }
}

/* Mark the leaves that read some atoms. */
static void mark_atoms(const run *r, list l, uint8_t *reads)
{
    const int32_t *atoms = LIST(PLAN(r), l);
    int32_t i;
    for (i = 0; i < l.count; i++) {
        mark_nodes(r, r->part->atoms[atoms[i]].nodes[0], reads);
    }
}

static void mark_leaves(const run *r, bool event, int32_t local, uint8_t *reads)
{
    if (event) {
        mark_atoms(r, r->part->events[local].on_occurrence[0], reads);
    } else {
        mark_atoms(r, r->part->signals[local].on_change[0], reads);
        mark_atoms(r, r->part->signals[local].on_update[0], reads);
        mark_nodes(r, r->part->signals[local].on_birth, reads);
    }
}

/* Propagate the marks up the nodes, which are in order, and mark the requirements linked to marked
 * nodes. */
static void mark_above(const run *r, uint8_t *reads)
{
    rv_monitor *m = r->home->monitor;
    int32_t i;
    int32_t k;
    for (i = 0; i < r->part->plan->nodes.count; i++) {
        const node_plan *n = &r->part->nodes[i];
        const int32_t *operands = LIST(PLAN(r), n->operands);
        for (k = 0; (n->op != NODE_LEAF) && (n->op != NODE_UNBORN) && (k < n->operands.count); k++) {
            reads[i] |= reads[operands[k]];
        }
        for (k = 0; (reads[i] != 0U) && (k < n->links.count); k++) {
            const link_plan *l = &PLAN(r)->links[n->links.first + k];
            if (l->kind != LINK_WATCH) {
                m->late[r->part->judges[l->judge].requirement] = 1;
            }
        }
    }
}

/* Mark the requirements of a part that depend on a name; false: memory is short. A part with captured
 * values has one requirement, which reads all its names. */
static bool mark_readers(const home *h, bool event, int32_t local)
{
    const part_plan *p = h->part->plan;
    const size_t size = (size_t)p->nodes.count + 1;
    arena *a = &h->monitor->memory;
    uint8_t *reads;
    if (p->captured > 0) {
        h->monitor->late[p->requirement] = 1;
        return true;
    }
    reads = arena_take(a, size);
    if (reads == NULL) {
        h->monitor->spoilt = true;
        return false;
    }
    mark_leaves(h->root, event, local, reads);
    mark_above(h->root, reads);
    arena_give(a, reads, size);
    return true;
}

int rv_late(rv_monitor *m, int64_t t, const int32_t *names, int32_t count)
{
    const bool all = (count < 0) || (m->plan.header->gap == 0) || (m->last == RV_NO_TIME)
                     || (t < m->began);
    int32_t i;
    int32_t k;
    for (i = 0; all && (i < m->plan.header->requirements); i++) {
        m->late[i] = 1; /* the sample would have been a position, or come before all others */
    }
    for (i = 0; !all && (i < count); i++) {
        int32_t readers;
        const subscription *s = subscriptions_of(m, names[i], &readers);
        for (k = 0; k < readers; k++) {
            if (!mark_readers(&m->homes[s[k].part], names[i] >= m->plan.header->signals, s[k].local)) {
                return RV_NO_MEMORY;
            }
        }
    }
    return RV_OK;
}
