/* rv_save and rv_load. A header (magic with version, hash of the plan, size, hash of the rest), then the
 * whole run. The hash guards only against accidents: each field is checked whatever the bytes are, so
 * they are refused or yield a state from which the core can continue. */
#include "notes/notes.h"
#include "results/results.h"
#include "snapshot/snapshot.h"

#include <string.h>

#define SNAPSHOT_MAGIC UINT64_C(0x33746f6873767672) /* "rvvshot3" */
#define HEAD_SIZE ((size_t)32)

static uint64_t hash_of_bytes(const uint8_t *bytes, size_t size)
{
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    size_t i;
    for (i = 0; i < size; i++) {
        hash = (hash ^ bytes[i]) * UINT64_C(0x100000001b3);
    }
    return hash;
}

/* The header of a snapshot of `size` bytes. */
static void carry_head(carrier *c, size_t size, uint64_t hash)
{
    const uint64_t head[4] = {SNAPSHOT_MAGIC, c->m->plan.header->hash, (uint64_t)size, hash};
    int32_t i;
    for (i = 0; i < 4; i++) {
        uint64_t word = head[i];
        carry_word(c, &word);
        demand(c, word == head[i]);
    }
}

/* The records, each with its captured values. 27 is less than the number of bytes of any record. */
static void carry_records(carrier *c, rv_monitor *m)
{
    const int32_t requirements = m->plan.header->requirements;
    const size_t size = ((size_t)requirements + 1) * sizeof(int32_t);
    const size_t parts_size = ((size_t)requirements + 1) * sizeof(const part *);
    int32_t *captured = arena_take(&m->memory, size);
    const part **parts = arena_take(&m->memory, parts_size);
    int32_t count = (int32_t)m->record_count;
    int32_t i;
    int32_t k;
    carry_size(c, &count, MOST, 27);
    if ((captured == NULL) || (parts == NULL)) {
        m->spoilt = true;
        return;
    }
    for (i = 0; i < requirements; i++) {
        captured[i] = rv_captured_of(m, i);
    }
    for (i = 0; i < m->plan.part_count; i++) {
        for (k = 0; k < m->plan.parts[i].judges.count; k++) {
            parts[m->parts[i].judges[k].requirement] = &m->parts[i];
        }
    }
    if (c->reading && (count > 0)) {
        (void)grow_records(m, count);
    }
    for (i = 0; (i < count) && !is_lost(c); i++) {
        rv_record one;
        (void)memset(&one, 0, sizeof one);
        if (!c->reading) {
            one = m->records[i];
        }
        carry_instant(c, &one.triggered);
        carry_instant(c, &one.decided);
        carry_int(c, &one.requirement, 0, requirements);
        carry_count(c, &one.number);
        carry_byte(c, &one.verdict, RV_INCONCLUSIVE);
        carry_byte(c, &one.decision, RV_OPEN);
        carry_byte(c, &one.in_doubt, 1);
        carry_long(c, &one.note, -1, MOST);
        if (c->reading) {
            one.captured = (captured[one.requirement] > 0) ? m->captured_count : -1;
        }
        for (k = 0; (k < captured[one.requirement]) && !is_lost(c); k++) {
            rv_number value = c->reading ? UNKNOWN_NUMBER : m->captured[one.captured + k];
            carry_number(c, &value);
            if (c->reading) {
                (void)keep_captured(m, &value, 1);
            }
        }
        if (c->reading && !is_lost(c)) {
            rv_record *made;
            check_note(c, parts[one.requirement], &one);
            made = next_record(m);
            if (made != NULL) {
                *made = one;
            }
        }
    }
    m->sorted = c->reading ? m->record_count : m->sorted;
    arena_give(&m->memory, captured, size);
    arena_give(&m->memory, parts, parts_size);
}

/* The clock of the monitor, and the state of names. */
static void carry_times(carrier *c, rv_monitor *m)
{
    const int32_t names = m->plan.header->signals + m->plan.header->events;
    const bool sparse = m->plan.header->gap == 0;
    int32_t i;
    carry_instant_or(c, &m->began, RV_NO_TIME);
    carry_instant_or(c, &m->last, RV_NO_TIME);
    carry_long(c, &m->after, -LIMIT, LIMIT - 1);
    carry_instant_or(c, &m->reached, RV_NO_TIME);
    carry_instant_or(c, &m->outage_at, RV_NO_TIME);
    carry_flag(c, &m->finished);
    carry_bytes(c, m->absent, names, 1);
    carry_bytes(c, m->late, m->plan.header->requirements, 1);
    demand(c, (m->began != RV_NO_TIME) == (m->last != RV_NO_TIME));
    demand(c, (m->last <= m->reached) && (m->outage_at <= m->reached) && (m->began <= m->last));
    demand(c, (m->reached == RV_NO_TIME) ? (m->after == -LIMIT) : (m->after >= m->reached - 1));
    demand(c, (m->after <= m->reached) || (m->reached == RV_NO_TIME));
    if (sparse) {
        bool amid = m->dense_until != RV_NO_TIME;
        carry_bytes(c, m->losing, (int64_t)names + 1, 1);
        carry_instant_or(c, &m->dense_end, RV_NO_TIME);
        carry_flag(c, &amid);
        if (amid) {
            carry_instant_or(c, &m->dense_until, NEVER);
        }
        for (i = 0; c->reading && (i <= names); i++) {
            m->losing_count += m->losing[i];
        }
    }
}

/* The whole run. */
static void carry_monitor(carrier *c, size_t size, uint64_t hash)
{
    rv_monitor *m = c->m;
    int32_t i;
    carry_head(c, size, hash);
    carry_times(c, m);
    carry_stale(c, m);
    carry_long(c, &m->undecidable_count, 0, MOST);
    carry_long(c, &m->trim_at, 0, 4 * (int64_t)MOST);
    carry_notes(c, m);
    carry_records(c, m);
    for (i = 0; (i < m->plan.part_count) && !is_lost(c); i++) {
        carry_home(c, &m->homes[i]);
    }
    end_notes(c, m);
}

size_t rv_save(rv_monitor *m, void *bytes, size_t size)
{
    carrier c = {m, NULL, NULL, 0, 0, false, false, NULL};
    size_t wanted;
    if (m->spoilt || (m->shapes != NULL)) {
        return 0;
    }
    drop_open_notes(m);
    carry_monitor(&c, 0, 0);
    wanted = c.at;
    if ((bytes != NULL) && (size >= wanted) && !m->spoilt) {
        c.to = bytes;
        c.at = 0;
        carry_monitor(&c, wanted, 0);
        c.at = 0;
        carry_head(&c, wanted, hash_of_bytes((uint8_t *)bytes + HEAD_SIZE, wanted - HEAD_SIZE));
    }
    return m->spoilt ? 0 : wanted;
}

/* Whether a monitor is as rv_new made it. */
static bool is_fresh(const rv_monitor *m)
{
    const int32_t names = m->plan.header->signals + m->plan.header->events;
    bool fresh = (m->reached == RV_NO_TIME) && !m->finished && !m->spoilt;
    int32_t i;
    for (i = 0; i < names; i++) {
        fresh = fresh && (m->absent[i] == 0U);
    }
    for (i = 0; i < m->plan.part_count; i++) {
        fresh = fresh && (m->homes[i].run_count == 1);
    }
    return fresh;
}

int rv_load(rv_monitor *m, const void *bytes, size_t size)
{
    carrier c = {m, bytes, NULL, 0, 0, true, false, NULL};
    c.size = size;
    if (!is_fresh(m)) {
        return RV_NOT_FRESH;
    }
    if (size < HEAD_SIZE) {
        return RV_BAD_SNAPSHOT;
    }
    carry_monitor(&c, size, hash_of_bytes((const uint8_t *)bytes + HEAD_SIZE, size - HEAD_SIZE));
    demand(&c, c.at == size);
    if (c.refused) {
        m->spoilt = true; /* half restored: nothing may be read from it */
        return RV_BAD_SNAPSHOT;
    }
    return m->spoilt ? RV_NO_MEMORY : RV_OK;
}
