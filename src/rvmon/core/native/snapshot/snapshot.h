/* Snapshots: a run as bytes. The same code writes and reads: each carry_... function visits the fields
 * of something in order and either writes or reads them, so writing and reading cannot differ.
 *
 * State that follows from other state is not stored but rebuilt: heaps, free lists, links, sums, spans,
 * capacities. Everything read is checked against the plan and against what was read before. After the
 * first misfit nothing more is read, and the caller discards the monitor. */
#ifndef RVMON_SNAPSHOT_H
#define RVMON_SNAPSHOT_H

#include "networks/network.h"
#include "plan/plan_check.h"

typedef struct {
    rv_monitor *m;
    const uint8_t *from;       /* bytes being read */
    uint8_t *to;               /* bytes being written; NULL: only count them */
    size_t at;                 /* offset reached */
    size_t size;               /* bytes to read */
    bool reading;
    bool refused;              /* something that was read does not fit */
    uint8_t *begins;           /* while notes are read: for each word, what starts there */
} carrier;

/* Whether carrying has stopped, because of a misfit or because memory was short. */
static inline bool is_lost(const carrier *c)
{
    return c->refused || c->m->spoilt;
}

/* While reading, require a condition. */
static inline void demand(carrier *c, bool so)
{
    c->refused = c->refused || (c->reading && !so);
}

/* ---- snapshot_fields.c: integers in little-endian order; the bounds are checked on reading */
void carry_byte(carrier *c, uint8_t *x, uint8_t most);
void carry_bytes(carrier *c, uint8_t *x, int64_t count, uint8_t most);
void carry_flag(carrier *c, bool *x);
void carry_int(carrier *c, int32_t *x, int64_t low, int64_t end);
void carry_count(carrier *c, uint32_t *x);
void carry_word(carrier *c, uint64_t *x);
void carry_long(carrier *c, int64_t *x, int64_t low, int64_t most);
/* An instant in range; carry_instant_or() also allows the value `none`. */
void carry_instant(carrier *c, int64_t *x);
void carry_instant_or(carrier *c, int64_t *x, int64_t none);
void carry_number(carrier *c, rv_number *x);
/* A count of items that take at least `each` bytes, so that a forged count cannot ask for more memory
 * than there are bytes. */
void carry_size(carrier *c, int32_t *x, int64_t most, size_t each);
/* A list of distinct numbers below `end`, in order; marks them in `listed` unless it is NULL. */
void carry_list(carrier *c, int32_t *items, int32_t *count, int32_t end, uint8_t *listed);
/* Timers in heap order, so that the heap is restored as it was; `numbers` renames ids if not NULL. */
void carry_timers(carrier *c, timers *h, int32_t ids, const int32_t *numbers);

/* ---- snapshot_runs.c: inputs and formulas of a run */
void carry_run(carrier *c, run *r);

/* ---- snapshot_judges.c: judges, their attempts and queues */
void carry_judges(carrier *c, run *r);

/* ---- snapshot_judges.c: networks and chains */
void carry_networks(carrier *c, const form *f, networks **own);
void carry_chain(carrier *c, run *r, int32_t index);
void carry_queue(carrier *c, run *r, int32_t index);

/* ---- snapshot_homes.c: staleness, coverage, truths, moves */
void carry_stale(carrier *c, rv_monitor *m);
void carry_watch(carrier *c, home *h);

/* ---- snapshot_notes.c: state from which notes are made */
void carry_truth_log(carrier *c, run *r);
void carry_noting(carrier *c, run *r, int32_t index);
void carry_unknowns(carrier *c, home *h);

/* ---- snapshot_letters.c: letters of notes */
void carry_letters(carrier *c, noting *n, int32_t stride);
void carry_spans(carrier *c, rv_monitor *m);

/* ---- snapshot_notes.c: notes of records */
void carry_notes(carrier *c, rv_monitor *m);
bool is_state(const carrier *c, const judge_plan *judged, int64_t place);
void check_note(carrier *c, const part *own, const rv_record *one);
void end_notes(carrier *c, rv_monitor *m);

/* Whether packed truths are valid: no pair of bits is 3. */
static inline bool are_truths(const int64_t *words, int32_t count)
{
    int32_t i;
    for (i = 0; i < count; i++) {
        const uint64_t word = (uint64_t)words[i];
        if ((word & (word >> 1) & UINT64_C(0x5555555555555555)) != 0U) {
            return false;
        }
    }
    return true;
}

/* ---- snapshot_homes.c: a part with all its runs */
void carry_home(carrier *c, home *h);

#endif
