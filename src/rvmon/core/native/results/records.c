/* Records of attempts. They are appended as attempts are decided, and sorted at the end of each call by
 * decision, requirement and number; mostly they are in that order already. For runs without end, rv_trim
 * bounds them and the attempts that stay undecided. */
#include "margins/margins.h"
#include "networks/network.h"
#include "notes/notes.h"
#include "results/results.h"
#include "runs/runs.h"

#include <stdlib.h>
#include <string.h>

/* Store the captured values of a record; -1: memory is short. */
int64_t keep_captured(rv_monitor *m, const rv_number *values, int32_t count)
{
    const int64_t at = m->captured_count;
    if (at + count > m->captured_room) {
        int32_t room = (int32_t)m->captured_room;
        rv_number *made = enlarged(m, m->captured, &room, at + count, sizeof *made);
        if (made == NULL) {
            return -1;
        }
        m->captured = made;
        m->captured_room = room;
    }
    (void)memcpy(&m->captured[at], values, (size_t)count * sizeof *values);
    m->captured_count += count;
    return at;
}

/* Make room for this many records; false: memory is short. */
bool grow_records(rv_monitor *m, int64_t wanted)
{
    int32_t room = (int32_t)m->record_room;
    rv_record *made = widened(m, m->records, &room, wanted, sizeof *made);
    if (made == NULL) {
        return false;
    }
    m->records = made;
    m->record_room = room;
    return true;
}

/* Append a record; NULL: memory is short. */
rv_record *next_record(rv_monitor *m)
{
    if ((m->record_count == m->record_room) && !grow_records(m, m->record_count + 1)) {
        return NULL;
    }
    m->record_count++;
    return &m->records[m->record_count - 1];
}

/* Record an attempt, and count it. An attempt in doubt that passes leaves no record: its obligation was
 * met, whether or not it was triggered. Counts are right even if memory is too short for the record. */
void report(run *r, int32_t index, const attempt *x, uint32_t number, uint8_t verdict,
            uint8_t decision, int64_t t, int64_t note)
{
    const judge_plan *judged = &r->part->judges[index];
    const bool apart = r->part->plan->captured > 0;
    int64_t captured = -1;
    rv_record *record;
    if ((verdict == RV_PASS) && !x->sure) {
        margin_vanished(r->home->monitor, x->record);
        return; /* an attempt in doubt that was met */
    }
    if (apart) {
        home *h = r->home;
        h->passed += (verdict == RV_PASS) ? 1U : 0U;
        h->failed += (verdict == RV_FAIL) ? 1U : 0U;
        h->inconclusive += (verdict == RV_INCONCLUSIVE) ? 1U : 0U;
    } else {
        judge *j = &r->judges[judged->owner];
        j->passed += (verdict == RV_PASS) ? 1U : 0U;
        j->failed += (verdict == RV_FAIL) ? 1U : 0U;
        j->inconclusive += (verdict == RV_INCONCLUSIVE) ? 1U : 0U;
    }
    if (apart) {
        captured = keep_captured(r->home->monitor, r->captured, r->part->plan->captured);
        if (captured < 0) {
            return; /* a record would show wrong values */
        }
    }
    record = next_record(r->home->monitor);
    if (record == NULL) {
        return;
    }
    (void)memset(record, 0, sizeof *record);
    record->requirement = judged->requirement;
    record->number = number;
    record->triggered = x->triggered;
    record->decided = t;
    record->captured = captured;
    record->note = note;
    record->verdict = verdict;
    record->decision = decision;
    record->in_doubt = x->sure ? 0 : 1;
}

/* The order of reports, for qsort. */
static int compared(const void *one, const void *other)
{
    const rv_record *a = one;
    const rv_record *b = other;
    if (a->decided != b->decided) {
        return (a->decided < b->decided) ? -1 : 1;
    }
    if (a->requirement != b->requirement) {
        return (a->requirement < b->requirement) ? -1 : 1;
    }
    if (a->number != b->number) {
        return (a->number < b->number) ? -1 : 1;
    }
    return (int)a->in_doubt - (int)b->in_doubt;
}

/* Sort the records of this call, unless they are in order. */
void sort_records(rv_monitor *m)
{
    int64_t i = m->sorted + 1;
    while ((i < m->record_count) && (compared(&m->records[i - 1], &m->records[i]) <= 0)) {
        i++;
    }
    if (i < m->record_count) {
        qsort(&m->records[m->sorted], (size_t)(m->record_count - m->sorted), sizeof *m->records,
              compared);
    }
    m->sorted = m->record_count;
}

/* Bounded records (rv_keep, rv_trim): per requirement and verdict the newest, with their notes, and per
 * requirement the newest undecidable attempts. Counts stay exact. Trimming copies everything that stays,
 * so it waits until there is twice as much. */

/* The least number of records before the first trim. */
#define PATIENCE 32
/* Marks an attempt to be dropped; not a location. */
#define DROPPED (-1)

/* An undecidable attempt, for sorting. */
typedef struct {
    int64_t triggered;
    uint32_t number;
    int32_t requirement;
    int32_t at;
} undecidable_entry;

int rv_keep(rv_monitor *m, int64_t most)
{
    const size_t kinds = (size_t)RV_NOT_TRIGGERED * (size_t)m->plan.header->requirements;
    if (m->kept_of == NULL) {
        m->kept_of = arena_take(&m->memory, (kinds + 1U) * sizeof *m->kept_of);
        if (m->kept_of == NULL) {
            return RV_NO_MEMORY;
        }
    }
    m->keep = most;
    m->trim_at = (m->trim_at > PATIENCE) ? m->trim_at : PATIENCE; /* the run may be a restored one */
    return RV_OK;
}

/* Mark all records but the newest of each requirement and verdict with requirement -1; returns whether
 * any is marked. */
static bool mark_surplus(rv_monitor *m)
{
    bool some = false;
    int64_t i;
    (void)memset(m->kept_of, 0,
                 (size_t)RV_NOT_TRIGGERED * (size_t)m->plan.header->requirements * sizeof *m->kept_of);
    for (i = m->record_count - 1; i >= 0; i--) {
        rv_record *one = &m->records[i];
        int64_t *kept = &m->kept_of[(int64_t)RV_NOT_TRIGGERED * one->requirement + one->verdict];
        if (*kept == m->keep) {
            one->requirement = -1;
            some = true;
        } else {
            (*kept)++;
        }
    }
    return some;
}

/* Copy the records that stay, with their captured values and notes, and drop the rest; false: nothing
 * was dropped, or memory is short. */
static bool trim_records(rv_monitor *m)
{
    kept_notes to;
    rv_number *captured = NULL;
    const size_t captured_size = (size_t)m->captured_room * sizeof *captured;
    int64_t captured_count = 0;
    int64_t count = 0;
    int64_t i;
    if (!begin_keeping(m, &to)) {
        return false;
    }
    captured = arena_take(&m->memory, captured_size);
    if (captured == NULL) {
        give_up_keeping(m, &to);
        return false;
    }
    if (!mark_surplus(m)) {
        give_up_keeping(m, &to);
        arena_give(&m->memory, captured, captured_size);
        return false;
    }
    for (i = 0; i < m->record_count; i++) {
        rv_record one = m->records[i];
        if (one.requirement < 0) {
            continue;
        }
        if (one.captured >= 0) {
            const int32_t values = rv_captured_of(m, one.requirement);
            (void)memcpy(&captured[captured_count], &m->captured[one.captured],
                         (size_t)values * sizeof *captured);
            one.captured = captured_count;
            captured_count += values;
        }
        one.note = keep_note(m, &to, one.note);
        m->records[count] = one;
        count++;
    }
    arena_give(&m->memory, m->captured, captured_size);
    m->captured = captured;
    m->captured_count = captured_count;
    m->record_count = count;
    m->sorted = count;
    end_keeping(m, &to);
    return true;
}

static int compare_undecidable(const void *one, const void *other)
{
    const undecidable_entry *a = one;
    const undecidable_entry *b = other;
    if (a->requirement != b->requirement) {
        return (a->requirement < b->requirement) ? -1 : 1;
    }
    if (a->triggered != b->triggered) {
        return (a->triggered > b->triggered) ? -1 : 1; /* the newest first */
    }
    return (a->number > b->number) ? -1 : ((a->number < b->number) ? 1 : 0);
}

/* Collect the undecidable attempts of a part into `to`, unless they belong to a running episode;
 * returns how many. `to` NULL: only count. */
static int64_t gather_undecidable(const home *h, undecidable_entry *to)
{
    int64_t count = 0;
    const run *r;
    int32_t i;
    int32_t at;
    for (r = h->root; r != NULL; r = following(h, r)) {
        for (i = 0; i < h->part->plan->judges.count; i++) {
            for (at = r->judges[i].undecidable; at >= 0; at = attempt_at(h, at)->next) {
                if (is_current(r, i, at)) {
                    continue;
                }
                if (to != NULL) {
                    to[count].triggered = attempt_at(h, at)->triggered;
                    to[count].number = attempt_at(h, at)->number;
                    to[count].requirement = h->part->judges[i].requirement;
                    to[count].at = at;
                }
                count++;
            }
        }
    }
    return count;
}

/* Remove the marked attempts of a judge, and count them as inconclusive, since they stay undecided. */
static void drop_undecidable(run *r, int32_t index)
{
    home *h = r->home;
    judge *j = &r->judges[index];
    judge *owner = &r->judges[h->part->judges[index].owner];
    int32_t *link = &j->undecidable;
    while (*link >= 0) {
        const int32_t at = *link;
        if (attempt_at(h, at)->location != DROPPED) {
            link = &attempt_at(h, at)->next;
            continue;
        }
        *link = attempt_at(h, at)->next;
        if (h->part->plan->captured > 0) {
            h->inconclusive++;
            h->captured_attempts[at].judge = NULL;
            touch_run(r); /* the run may be released now */
        } else {
            owner->inconclusive++;
        }
        free_attempt(h, at);
    }
    if (j->noting != NULL) { /* its notes may go, too */
        int32_t at;
        j->noting->undecidable_since = NEVER;
        for (at = j->undecidable; at >= 0; at = attempt_at(h, at)->next) {
            note_undecidable(r, index, attempt_at(h, at)->triggered);
        }
    }
}

/* Drop the oldest undecidable attempts of each requirement of a part; returns how many are left. */
static int64_t trim_undecidable(rv_monitor *m, home *h)
{
    const int64_t count = gather_undecidable(h, NULL);
    const size_t size = (size_t)count * sizeof(undecidable_entry);
    undecidable_entry *all = (count > m->keep) ? arena_take(&m->memory, size) : NULL;
    int64_t left = count;
    int64_t own = 0;
    int64_t i;
    run *r;
    int32_t k;
    if (all == NULL) {
        return count;
    }
    (void)gather_undecidable(h, all);
    qsort(all, (size_t)count, sizeof *all, compare_undecidable);
    for (i = 0; i < count; i++) {
        own = ((i > 0) && (all[i].requirement == all[i - 1].requirement)) ? own + 1 : 0;
        if (own >= m->keep) {
            attempt_at(h, all[i].at)->location = DROPPED;
            left--;
        }
    }
    for (r = h->root; r != NULL; r = following(h, r)) {
        for (k = 0; k < h->part->plan->judges.count; k++) {
            drop_undecidable(r, k);
        }
    }
    arena_give(&m->memory, all, size);
    if (h->touched_count > 0) {
        rest_all(h);
    }
    return left;
}

bool rv_trim(rv_monitor *m)
{
    bool trimmed = false;
    int64_t left = 0;
    int64_t runs = 0;
    int32_t i;
    if ((m->kept_of == NULL) || m->spoilt
        || (!m->finished && (m->record_count + m->undecidable_count <= m->trim_at))) {
        return false;
    }
    for (i = 0; !m->finished && (i < m->plan.part_count); i++) {
        left += trim_undecidable(m, &m->homes[i]);
        runs += m->homes[i].run_count;
    }
    m->undecidable_count = left;
    trimmed = trim_records(m);
    m->trim_at = 2 * (m->record_count + left) + runs + PATIENCE; /* all runs were looked at */
    return trimmed;
}
