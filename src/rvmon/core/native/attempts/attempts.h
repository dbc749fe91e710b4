/* Attempts: how one starts, moves through positions and time, and is decided.
 *
 * An attempt is one occasion on which a requirement's consequent has to hold. A *judge* (judging.h)
 * holds the open attempts of one requirement and reads a *letter*: the class of the valuation of its
 * propositions. Three engines decide attempts: the automaton of this folder (most requirements), a
 * delay network (networks/), a chain of windows (windows/); the plan says which.
 *
 * Unknown inputs give two *readings* of an attempt: `worse` takes every unknown for FALSE, `better`
 * for TRUE (negation normal form). It passes when the worse one has passed, fails when the better one
 * has failed, and can never be decided once worse has failed and better has passed.
 *
 * Instants are ticks (ns). `index` is a judge of the run's part, `at` a slot of the attempt pool. */
#ifndef RVMON_ATTEMPTS_H
#define RVMON_ATTEMPTS_H

#include "basics.h"

/* ---- automata.c: one attempt through positions and time */

/* One reading of an attempt, in its automaton. */
typedef struct {
    int32_t location;
    int64_t *clocks;           /* per clock, the instant at which it was reset; owned by the attempt */
    rv_hit *moves;             /* counters of its edges; NULL: they are not counted */
} token;

int32_t class_of_letter(const run *r, int32_t index, bool better);
bool step_token(const machine *a, token *k, int64_t t, int32_t letter);
bool rests(const machine *a, const token *k, int64_t t, int32_t letter, int64_t *due, bool *slides);
int64_t next_cut(const machine *a, const token *k, int64_t t, const int64_t *before);
int64_t settle_token(const machine *a, token *k, int64_t t, int64_t until);
int64_t run_token(const machine *a, token *k, int32_t letter, int64_t first, int64_t last,
                  bool *slides);
bool holds_at_end(const machine *a, int32_t location, const int64_t *clocks, int64_t end,
                  int64_t reached);

/* ---- attempts.c */
bool is_true(const run *r, int32_t node);
bool is_current(const run *r, int32_t index, int32_t at);
bool grow_pool(home *h, int64_t wanted);
int32_t new_attempt(run *r);
void free_attempt(home *h, int32_t at);
void number_attempt(run *r, int32_t index, int32_t at, int64_t t);
bool is_sure(const run *r, int32_t index);
bool runs_on(const run *r, int32_t index);
void leave_episode(run *r, int32_t index);
void take_episode_trigger(run *r, int32_t index, int64_t t);
void conclude(run *r, int32_t index, int32_t at, uint8_t verdict, uint8_t decision, int64_t t,
              int64_t note);
void decide_current(run *r, int32_t index, bool fails, int64_t t);
void decide(run *r, int32_t index, int32_t at, bool passed, int64_t t);
void remove_attempt(run *r, int32_t index, int32_t before, int32_t at);
bool is_undecidable(const attempt *x);
void add_undecidable(run *r, int32_t index, int32_t at);
void move_to_undecidable(run *r, int32_t index, int32_t before, int32_t at);
int32_t next_open(const run *r, int32_t index, int32_t at);
uint32_t reported_number(const run *r, int32_t at);
void settle_attempt(run *r, int32_t index, int32_t at, int64_t end, int64_t reached);

/* ---- starts.c: attempts as they begin */
bool take_trigger(run *r, int32_t index, uint8_t truth);
bool needs_every_position(const run *r, int32_t index);
void begin_here(run *r, int32_t index, int64_t t, int64_t triggered);
void begin(run *r, int32_t index, int64_t t, int64_t triggered);
void enter(run *r, int32_t index, int32_t at, int64_t t);

/* ---- drive.c: attempts of a judge through time */
void set_rule_due(run *r, int32_t index, int64_t due);
void set_restless(run *r, int32_t index);
void pass_to(run *r, int32_t index, int64_t t);
void pass_ticks(run *r, int32_t index, int64_t t);
void visit_judge(run *r, int32_t index, int64_t t);
void reach_judge(run *r, int32_t index, int64_t t);
bool drive_from(run *r, int32_t index, int32_t at, int64_t t);

/* ---- queue.c: attempts in bulk */
bool has_queue(run *r, int32_t index);
void clear_queue(judge *j);
bool queue_is_empty(const judge *j);
void queue_visit(run *r, int32_t index, int64_t t);
void queue_pass(run *r, int32_t index, int64_t t);
void queue_reach(run *r, int32_t index, int64_t t);
void queue_begin(run *r, int32_t index, int64_t t);
void dissolve_queue(run *r, int32_t index, int64_t tick);
void queue_close(run *r, int32_t index, int64_t end, int64_t reached);
const queued *queue_item(const judge *j, int32_t i);

/* How far the attempts of a queue were gone through: those before `item`, of so many segments, the last of
 * which ends before item `end`. */
typedef struct {
    int32_t item;
    int32_t segments;
    int32_t end;
} queue_place;

attempt *next_queued(run *r, int32_t index, queue_place *p, int64_t tick);

/* Whether a judge has attempts that a position may concern. */
static inline bool has_attempts(const judge *j)
{
    return (j->first >= 0) || ((j->queue != NULL) && (j->queue->count > 0));
}

/* ---- what queue.c and queue_steps.c share */

/* A queue with its judge and the judge's automaton. */
typedef struct {
    run *r;
    judge *j;
    queue *q;
    const machine *a;
    int32_t index;
} queueing;

static inline queueing queueing_of(run *r, int32_t index)
{
    queueing g;
    g.r = r;
    g.j = &r->judges[index];
    g.q = g.j->queue;
    g.a = &r->part->machines[index];
    g.index = index;
    return g;
}

/* The i-th oldest attempt of a queue. */
static inline queued *item(const queue *q, int32_t i)
{
    return &q->items[(q->head + i) & (q->room - 1)];
}

/* The own instant of a clock of the i-th oldest attempt. */
static inline int64_t *own_instant(const queueing *g, int32_t i, int32_t c)
{
    return &g->q->own[(size_t)((g->q->head + i) & (g->q->room - 1)) * (size_t)g->a->clocks + (size_t)c];
}

/* The instant at which clock `c` of the i-th oldest attempt, which stands in segment `s`, was reset;
 * `tick`: the last one by which clocks were reset that each tick resets. */
static inline int64_t instant_of_clock(const queueing *g, const segment *s, int32_t c, int32_t i,
                                       int64_t tick)
{
    const int64_t clock = s->clocks[c];
    if (clock < LIMIT) {
        return clock;
    }
    if (clock == OF_TRIGGER) {
        return item(g->q, i)->triggered;
    }
    return (clock == OF_EACH_ATTEMPT) ? *own_instant(g, i, c) : tick;
}

/* ---- queue.c */
queued *queue_slot(rv_monitor *m, const machine *a, queue *q, int32_t i, bool append);
segment *next_segment(rv_monitor *m, segments *all);
bool make_own_instants(rv_monitor *m, const machine *a, queue *q);
void report_queued(const queueing *g, int32_t i, const segment *s, bool passed, int64_t t);

/* ---- queue_steps.c */
void count_edge(const queueing *g, int32_t location, int32_t target, int32_t count, int64_t t);

#endif
