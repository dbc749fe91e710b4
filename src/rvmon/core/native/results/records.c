/* Records of attempts, in the order of reports. */
#include "margins/margins.h"
#include "results/results.h"

#include <stdlib.h>
#include <string.h>

/* Keep the values that an attempt captured; -1: there is no room. */
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

/* Make room for so many records; false if there is none. */
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

/* One record more; NULL: there is no room. */
rv_record *next_record(rv_monitor *m)
{
    if ((m->record_count == m->record_room) && !grow_records(m, m->record_count + 1)) {
        return NULL;
    }
    m->record_count++;
    return &m->records[m->record_count - 1];
}

/* Tell of an attempt that has its number. */
void report(run *r, int32_t index, const attempt *x, uint32_t number, uint8_t verdict,
            uint8_t decision, int64_t t, int64_t note)
{
    const judge_plan *judged = &r->part->judges[index];
    const bool apart = r->part->plan->captured > 0;
    int64_t captured = -1;
    rv_record *record;
    if ((verdict == RV_PASS) && !x->sure) {
        margin_vanished(r->home->monitor, x->record);
        return; /* it was met, triggered or not */
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
            return; /* it would say other values */
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

/* Whether a record stands before another: by decision, requirement, number. */
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

/* Bring what was recorded in this call into order; mostly it is. */
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
