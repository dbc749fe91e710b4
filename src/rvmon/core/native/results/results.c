/* What a monitor tells: records, open attempts, counts and verdicts. */
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

/* The record of an attempt that is open. */
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

/* Tell of the open attempts of a judge; false: that was enough. */
static bool each_open_of(run *r, int32_t index, rv_take take, void *user)
{
    const rv_number *captured = (r->part->plan->captured > 0) ? r->captured : NULL;
    bool more = true;
    int32_t at;
    if (r->truth_log != NULL) {
        note_open_count(r, index);
    }
    for (at = 0; more && !queue_is_empty(&r->judges[index]) && (at < r->judges[index].queue->count);
         at++) {
        const attempt *x = queued_attempt(r, index, at);
        const rv_record one = open_record(r, index, x, x->number);
        more = take(user, &one, NULL);
    }
    for (at = next_open(r, index, -1); more && (at >= 0); at = next_open(r, index, at)) {
        const rv_record one = open_record(r, index, attempt_at(r->home, at), told_number(r, at));
        more = take(user, &one, captured);
    }
    return more;
}

void rv_each_open(rv_monitor *m, rv_take take, void *user)
{
    bool more = true;
    int32_t i;
    int32_t k;
    tell_open(m, true);
    for (i = 0; more && (i < m->plan.part_count); i++) {
        run *r;
        for (r = m->homes[i].root; more && (r != NULL); r = following(&m->homes[i], r)) {
            for (k = 0; more && (k < r->part->plan->judges.count); k++) {
                more = each_open_of(r, k, take, user);
            }
        }
    }
    tell_open(m, false);
}

/* Add what the runs of a home have of a requirement. */
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
                /* Attempts in doubt count as those of their requirement. */
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
