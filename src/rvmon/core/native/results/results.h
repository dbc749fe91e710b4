/* Results of a run: records of attempts, coverage, truths over time, moves of automata, and the
 * relative state (situation) of a run. */
#ifndef RVMON_RESULTS_H
#define RVMON_RESULTS_H

#include "basics.h"

/* ---- records.c */
bool grow_records(rv_monitor *m, int64_t wanted);
rv_record *next_record(rv_monitor *m);
int64_t keep_captured(rv_monitor *m, const rv_number *values, int32_t count);
void report(run *r, int32_t index, const attempt *x, uint32_t number, uint8_t verdict,
            uint8_t decision, int64_t t, int64_t note);
void sort_records(rv_monitor *m);

/* ---- watch.c: truths over time */
bool begin_watch(home *h);
void watch(run *r, int64_t t);
void end_watch(run *r, int64_t end, int64_t reached);

/* ---- cover.c: hits of coverpoints and crosses */
/* Iterates over the combinations of chosen bins of each axis, the last axis fastest. Bins are numbered
 * within their axis. */
typedef struct {
    int32_t begin[AXES_MOST];  /* places in `bins` of coverage */
    int32_t end[AXES_MOST];
    int32_t at[AXES_MOST];
    int32_t count;             /* of axes */
} combinations;

bool first_combination(const run *r, const group_plan *g, const uint64_t *bits, combinations *o);
bool next_combination(combinations *o);
int32_t item_of(const run *r, const group_plan *g, const combinations *o);
void make_current(covering *c, const group_plan *g, covered *s, int32_t item);
bool begin_cover(home *h);
void call_watch(run *r, int32_t number);
void call_watches(run *r);
void keep_truths_of_watches(run *r);
void cover(run *r, int64_t t);

/* ---- watch.c: moves of attempts in automata */
bool begin_moves(home *h);
void count_move(const machine *a, rv_hit *moves, int32_t from, int32_t to, int64_t count, int64_t t);
void count_begin(run *r, int32_t index, int64_t t);

/* ---- situation.c */
/* A word sequence being written; words beyond `room` are only counted. */
typedef struct {
    int64_t *words;
    int64_t room;
    int64_t count;
    int64_t now;               /* the instant to which all others are relative */
    int64_t next;              /* the next instant at which time alone may change something */
} situation;

void put_word(situation *s, int64_t word);
void put_bytes(situation *s, const uint8_t *bytes, int32_t count);

/* ---- network_state.c */
void put_networks(situation *s, run *r, int32_t index);

/* The move counts of a judge; NULL: none are kept. */
static inline rv_hit *moves_of(const run *r, int32_t index)
{
    return (r->home->moves != NULL) ? r->home->moves[index] : NULL;
}

#endif
