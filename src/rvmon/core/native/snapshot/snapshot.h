/* What is written of a state and read back. One description serves for both: each function here carries
 * the fields of something either out or in, so the two cannot differ.
 *
 * What follows from the rest is not carried but made anew: heaps, free places, links of lists, sums,
 * spans, room. What is carried in is checked against the plan and what was carried before; once
 * something does not fit nothing more is taken, and who called throws the state away. */
#ifndef RVMON_SNAPSHOT_H
#define RVMON_SNAPSHOT_H

#include "networks/network.h"
#include "plan/plan_check.h"

typedef struct {
    rv_monitor *m;
    const uint8_t *from;       /* what is read */
    uint8_t *to;               /* where it is written; NULL: it is only counted */
    size_t at;
    size_t size;               /* of what is read */
    bool reading;
    bool refused;              /* what was read does not fit */
    uint8_t *begins;           /* of each word of notes, what begins there; while they are read */
} carrier;

/* Whether something went wrong: nothing more is carried. */
static inline bool is_lost(const carrier *c)
{
    return c->refused || c->m->spoilt;
}

/* Refuse what was read unless something is so. */
static inline void demand(carrier *c, bool so)
{
    c->refused = c->refused || (c->reading && !so);
}

/* ---- snapshot_fields.c: numbers, the lowest byte first */
void carry_byte(carrier *c, uint8_t *x, uint8_t most);
void carry_bytes(carrier *c, uint8_t *x, int64_t count, uint8_t most);
void carry_flag(carrier *c, bool *x);
void carry_int(carrier *c, int32_t *x, int64_t low, int64_t behind);
void carry_count(carrier *c, uint32_t *x);
void carry_word(carrier *c, uint64_t *x);
void carry_long(carrier *c, int64_t *x, int64_t low, int64_t most);
/* An instant within the bounds of time; the same, or `none`. */
void carry_instant(carrier *c, int64_t *x);
void carry_instant_or(carrier *c, int64_t *x, int64_t none);
void carry_number(carrier *c, rv_number *x);
/* How many of something there are, of which each takes so many bytes at least. */
void carry_size(carrier *c, int32_t *x, int64_t most, size_t each);
/* Different numbers below one, in their order; each is marked in `listed`, if that is not NULL. */
void carry_list(carrier *c, int32_t *items, int32_t *count, int32_t behind, uint8_t *listed);
/* Timers in the order of their heap, which so comes to be the same; `numbers`: by id what it is written
 * as, if not as itself. */
void carry_timers(carrier *c, timers *h, int32_t ids, const int32_t *numbers);

/* ---- snapshot_runs.c: names, formulas, what they remember */
void carry_run(carrier *c, run *r);

/* ---- snapshot_judges.c: judges, their attempts and queues */
void carry_judges(carrier *c, run *r);

/* ---- snapshot_judges.c: networks and chains */
void carry_networks(carrier *c, const form *f, networks **own);
void carry_chain(carrier *c, run *r, int32_t index);

/* ---- snapshot_homes.c: what is kept beside what becomes of attempts */
void carry_stale(carrier *c, rv_monitor *m);
void carry_watch(carrier *c, home *h);

/* ---- snapshot_notes.c: what is kept so that notes can be told */
void carry_truth_log(carrier *c, run *r);
void carry_noting(carrier *c, run *r, int32_t index);
void carry_unknowns(carrier *c, home *h);

/* ---- snapshot_letters.c: letters that notes refer to */
void carry_letters(carrier *c, noting *n, int32_t stride);
void carry_spans(carrier *c, rv_monitor *m);

/* ---- snapshot_notes.c: notes of records */
void carry_notes(carrier *c, rv_monitor *m);
bool is_state(const carrier *c, const judge_plan *judged, int64_t place);
void check_note(carrier *c, const part *own, const rv_record *one);
void end_notes(carrier *c, rv_monitor *m);

/* Whether words of truths have nothing in them that is none. */
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

/* ---- snapshot_homes.c: all runs of a part, and what they share */
void carry_home(carrier *c, home *h);

#endif
