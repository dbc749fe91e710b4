/* Runs: the state of a part of the plan as samples and time pass. A part without captured values is
 * one run; for one with `let` or `for each` these files create, fork, replay and release runs.
 *
 * The order of work at a position (clock.c): outages end; timers fire; atoms valid only at the last
 * position are read again; changed nodes are evaluated; judges whose letter or trigger changed move
 * their attempts; new attempts start; failed episodes restart. */
#ifndef RVMON_RUNS_H
#define RVMON_RUNS_H

#include "basics.h"

/* ---- core.c */
void settle_margins(rv_monitor *m, int64_t t);
const subscription *subscriptions_of(const rv_monitor *m, int32_t name, int32_t *count);
bool distribute(rv_monitor *m, const rv_update *updates, int32_t count);

/* ---- positions.c: the next position at which something can change */
int64_t tick_from(int64_t gap, int64_t t);
bool may_go_on(const run *r, int32_t index);
void tidy_failing(run *r);
int64_t next_start(const run *r);
int64_t next_position(const run *r);
void set_alarm(run *r, int64_t position);

/* ---- repeats.c: attempts that are counted instead of made */
void begin_silence(home *h, int64_t from, int64_t until);
void end_silence(home *h);
void forget_repeats(home *h);
bool passes_repeats_over(run *r, int32_t index, int64_t t);
int64_t counted_before(home *h, numbering *n, int32_t at);

/* ---- clock.c */
void clear_run(run *r);
void clear_judges(run *r);
int32_t trigger_node(const run *r, int32_t index);
void recheck_all(run *r);
void touch_all(run *r, uint8_t what);
void run_judges(run *r, int64_t t);
void visit(run *r, int64_t t);
void reach(run *r, int64_t t);
void pass_time(run *r, int64_t limit, bool comes);
void approach(run *r, int64_t t);
void arrive(run *r, int64_t t);
int64_t next_decision(run *r);
void settle_all(run *r, int64_t end, int64_t reached);
bool was_heard(const run *r, int32_t index);

/* ---- dense.c: outages in sampled time */
bool make_unknown_values(home *h);
bool begin_dense(rv_monitor *m, int64_t t);
void pass_dense(rv_monitor *m, int64_t limit);
void end_dense(rv_monitor *m);
bool is_amid_dense(rv_monitor *m, int64_t t);
void run_begin_dense(run *r, int64_t t);
void run_pass_dense(run *r, int64_t limit);
void run_end_dense(run *r, int64_t until);
void run_take_amid(run *r, int64_t t, const incoming *in, int32_t count);
void home_take_amid(home *h, int64_t t);
int64_t last_position(const rv_monitor *m);

/* ---- runs.c: creating and forking runs */
run *new_run(home *h);
run *forked(const run *r);
void recycle_run(home *h, run *r);
void give_sample(run *r, int64_t t, const incoming *in, int32_t count);

/* ---- kept.c: samples stored for replay */
past_update *keep_one(home *h, int64_t t);
void keep_updates(home *h, int64_t t);
void keep_given(home *h, int64_t t);
void replay(run *r);

/* ---- kept.c: samples that wait for their tick */
bool holds_back(const home *h);
void hold_back(home *h, int64_t t);
void give_held(home *h, int64_t limit);
void forget_given(home *h);

/* ---- captured.c: attempts with captured values */
bool starts_here(const run *r, int32_t index);
void queue_numbering(run *r, int32_t at, int64_t t);
void queue_report(run *r, int32_t at);
void number_and_report(home *h);
void begin_captured(run *r, int32_t index, int64_t t, int64_t triggered);
void check_children(run *r, int64_t t);
void mark_lapsed(run *r);
void forget_last(run *r);
bool is_idle(const run *r);
void release_attempt_run(run *r);
void adopt(run *parent, run *child);

/* ---- keys.c: instances of `for each` */
bool begin_keys(home *h);
int32_t restore_key(home *h, const rv_number *value, int64_t occurred, uint32_t rank);
void add_closed_key(home *h, int32_t at);
void open_instances(home *h, int64_t t);
void open_unknown(home *h, int64_t t);
void close_instance(run *r);
bool equals_root(const run *r);
run *instance_of(const home *h, const rv_number *value);
void open_at(run *r, int64_t t);
bool is_opening_lost(run *r, int64_t t);
int32_t says_for_instance(const run *r, const rv_update *u);

/* ---- crowd.c: the runs of a part, and which of them a call concerns */
bool register_run(home *h, run *r);
void touch_run(run *r);
void drop_gone(home *h);
void untouch_all(home *h);
void enlist(run *r, bool captured);
void delist(run *r, bool captured);
void set_alarms(home *h);
int32_t call_due(home *h, int64_t t);
int32_t called_with(home *h, int32_t count, run *r);
int32_t call_affected(home *h, int64_t t);
void for_called(home *h, int32_t count, int64_t t, void (*act)(run *r, int64_t t));

/* ---- span_blocks.c: which runs a value concerns */
struct block_span {
    span within;               /* the interval in which no comparison of its runs changes */
    rv_number value;           /* one in it */
    bool known;
};

bool widen_values(home *h);
void forget_spans(const run *r);
int32_t called_by_value(home *h, int32_t count, int32_t local, const rv_number *value);

/* ---- homes.c: a part with all its runs */
bool home_begin(home *h);
bool home_reserve(home *h, int32_t attempts);
void home_mark_absent(home *h, bool event, int32_t local);
void home_sample(home *h, int64_t t);
void take_inbox(home *h, int64_t t);
void lose_inbox(home *h, int64_t t);
void home_wait(home *h, int64_t t);
void home_lose(home *h, int64_t t);
void home_begin_blank(home *h, int64_t t);
void rest_all(home *h);
void home_come_to(home *h, int64_t end);
void home_close(home *h, int64_t end, int64_t reached);
int64_t home_due(home *h);
run *following(const home *h, const run *r);

#endif
