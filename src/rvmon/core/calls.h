/* What the files of the core call of each other, file by file. */
#ifndef RVMON_CALLS_H
#define RVMON_CALLS_H

#include "state.h"

#define LIST(p, l) (&(p)->lists[(l).first])
#define GAP(r) ((r)->gap)
#define PLAN(r) ((r)->all)

static const rv_number UNKNOWN_NUMBER = {RV_UNKNOWN, {0}};
static const span NO_SPAN = {0.0, 0.0};

static inline int64_t step_of(const run *r)
{
    const int64_t gap = GAP(r);
    return (gap > 0) ? gap : 1;
}

/* So much of a duration as whole steps fill. */
static inline int64_t whole_steps(int64_t duration, int64_t step)
{
    return (step == 1) ? duration : duration / step * step; /* a division takes its time */
}

static inline int64_t least(int64_t a, int64_t b)
{
    return (a < b) ? a : b;
}

/* The stamp of the end of a trace, when time has come to `reached`: twice the instant, one more if its
 * letter is known. */
static inline int64_t stamp_of_end(int64_t end, int64_t reached)
{
    return ((reached > end) && (reached < LIMIT)) ? 2 * reached : 2 * least(end, LIMIT - 1) + 1;
}

/* How many positions of a clock lie within the bounds of time. */
static inline int64_t positions_within(int64_t step)
{
    return (step == 1) ? LIMIT : LIMIT / step;
}

/* The last position of a clock not behind an instant. */
static inline int64_t floored(int64_t t, int64_t step)
{
    if (step == 1) {
        return t;
    }
    return ((t >= 0) || (t % step == 0)) ? t / step : t / step - 1;
}

/* Have a judge look at the position at hand. */
static inline void touch(run *r, int32_t index, uint8_t what)
{
    judge *j = &r->judges[index];
    if (j->touched == 0U) {
        r->touched[r->touched_count] = index;
        r->touched_count++;
    }
    j->touched |= what;
}

static inline uint8_t truth_if(bool value)
{
    return value ? IS_TRUE : IS_FALSE;
}

/* An instant so much after another one, which is less than LIMIT. */
static inline int64_t sum(int64_t t, int64_t duration)
{
    return (duration >= LIMIT) ? NEVER : t + duration;
}

/* A position so far ahead of another, or behind it; none is farther than the bounds of time. */
static inline int64_t moved(int64_t position, int64_t distance)
{
    if (distance > 0) {
        return (position > LIMIT - distance) ? LIMIT : position + distance;
    }
    return (position < -LIMIT - distance) ? -LIMIT : position + distance;
}

static inline attempt *attempt_at(const home *h, int32_t i)
{
    return (attempt *)(void *)(h->pool + h->stride * (size_t)i);
}

/* The place of the lowest bit that is set, and of the highest one; there is one. */
static inline int32_t lowest_bit(uint64_t word)
{
#if defined(__GNUC__)
    return (int32_t)__builtin_ctzll(word);
#else
    int32_t i = 0;
    while (((word >> i) & 1U) == 0U) {
        i++;
    }
    return i;
#endif
}

static inline int32_t highest_bit(uint64_t word)
{
#if defined(__GNUC__)
    return 63 - (int32_t)__builtin_clzll(word);
#else
    int32_t i = 63;
    while (((word >> i) & 1U) == 0U) {
        i--;
    }
    return i;
#endif
}

/* A larger array with what stood in the old one, and zeros behind it; NULL if memory is short, which
 * spoils the run. The same with anything behind it. */
void *widened(rv_monitor *m, void *old, int32_t *room, int64_t wanted, size_t each);
void *enlarged(rv_monitor *m, void *old, int32_t *room, int64_t wanted, size_t each);

/* ---- timers.c */
void timers_set(timers *h, int32_t id, int64_t due);
void timers_clear(timers *h, int32_t ids);
static inline int64_t timers_next(const timers *h)
{
    return h->next;
}
/* The ids that are due by `t`, into `found`; returns how many. */
int32_t timers_due(const timers *h, int64_t t, int32_t *found);

/* ---- numbers.c */
int32_t compare_numbers(int32_t how, const rv_number *a, const rv_number *b); /* a truth */
bool same_number(const rv_number *a, const rv_number *b);
rv_number program_value(const run *r, int32_t place, const int32_t *at);
rv_number number_of_double(double x);

/* ---- functions.c */
#define MOST_ARGUMENTS 4
int32_t arguments_of(int32_t op); /* how many an operation has; 0: it is none */
rv_number function_of_wholes(int32_t op, int64_t a, int64_t b);
double function_of_reals(int32_t op, const double *x); /* not finite: unknown */

/* ---- values.c: samples, held values, what occurred */
void mark(run *r, int32_t name);
uint8_t remember(history *h, int64_t t, const rv_number *value);
void come_to_birth(run *r, int32_t local, bool known);
void be_born(run *r, int32_t local);
void set_stale(run *r, int32_t local, int64_t t);
void keep_payload(run *r, int32_t local, bool known, const rv_number *fields);
void apply_update(run *r, int64_t t, const incoming *in);

/* Whether a signal can take a value and nothing else is to be done. */
static inline bool means_the_same(const run *r, int32_t local, const rv_number *value)
{
    const span *s = &r->spans[local];
    const double x = (value->kind == RV_REAL) ? value->as.real : (double)value->as.whole;
    return (value->kind == r->value[local].kind) && (s->low < x) && (x < s->high);
}

void margins_mark_changed(run *r, int32_t what);

/* ---- atoms.c */
bool find_quick(arena *a, const plan *all, part *p);
bool recheck(run *r, int32_t atom);     /* whether it is another truth */
bool recheck_list(run *r, list l);      /* whether one of them is */
void recheck_amid(run *r, list l);
void recheck_fading(run *r);
void reread(run *r, int32_t atom, bool pending);
uint8_t leaf_truth(const run *r, const node_plan *n);

/* How a value stands to a constant: the place of a bit. */
enum { IS_EQUAL, IS_LESS, IS_GREATER };

static inline int32_t order_of(double x, double constant)
{
    return IS_LESS * (int32_t)(x < constant) + IS_GREATER * (int32_t)(x > constant);
}

/* The signals of a run that can be taken quickly now; NULL: none of them. */
static inline const quick_signal *quick_now(const run *r)
{
    return ((r->at.phase == 1) && (r->at.lost_count == 0) && (r->margins == NULL)) ? r->part->quick : NULL;
}

/* Take a real value of a signal that few comparisons read, without a branch for what nobody can foretell;
 * false: it is none of these. */
static inline bool take_quickly(run *r, const quick_signal *quick, int32_t local, const rv_update *u)
{
    const quick_compare *c = quick[local].compares;
    const quick_compare *end;
    rv_number *value = &r->value[local];
    uint64_t *dirty = r->dirty;
    uint64_t *words = r->dirty_words;
    uint8_t *atoms = r->atom;
    double x;
    if ((c == NULL) || (u->value.kind != RV_REAL) || (value->kind != RV_REAL) || (u->says != RV_SAYS_YES)) {
        return false;
    }
    x = u->value.as.real;
    end = c + quick[local].count;
    value->as.real = x;
    for (; c < end; c++) {
        const int32_t word = c->word;
        const uint8_t now = (uint8_t)(IS_TRUE * ((c->holds_for >> order_of(x, c->constant)) & 1));
        const uint64_t other = (now != atoms[c->atom]) ? 1U : 0U;
        dirty[word] |= c->dirty & (0U - other);
        words[word >> 6] |= other << (word & 63);
        atoms[c->atom] = now;
    }
    return true;
}

static inline void take_update(run *r, int64_t t, const incoming *in)
{
    const rv_update *u = in->update;
    if (r->margins != NULL) {
        margins_mark_changed(r, in->event ? r->part->plan->signals.count + in->local : in->local);
    }
    if (!in->event && (u->says == RV_SAYS_YES) && means_the_same(r, in->local, &u->value)) {
        r->value[in->local] = u->value;
    } else {
        apply_update(r, t, in);
    }
}

void forget(run *r);
void go_stale(run *r, int64_t t, int32_t perishable);
void mark_absent(run *r, bool event, int32_t local);
void have_no_source(run *r, bool event, int32_t local);

/* ---- outages.c: names that may have said anything */
void begin_unlost(run *r);
bool take_amid(run *r, int64_t t, const incoming *in);
void come_back(run *r, int64_t t);
void stay_unknown(run *r, int32_t local);
bool has_no_source(const run *r, int32_t name);
bool is_lost_at(const run *r, int32_t name, int64_t t);
void give_loss(run *r, int64_t t, const incoming *in, int32_t count);
int32_t names_to_lose(const run *r);

/* ---- blank.c: positions that may not be there */
void may_begin(run *r, int64_t t);
void begin_blank(run *r, int64_t t);
void end_blank(run *r, int64_t t);
void revive_all(run *r, int64_t t);

/* ---- past.c */
stretch *next_stretch_of(rv_monitor *m, stretches *s, int32_t i, bool append);
void part_stretches(rv_monitor *m, stretches *worse, stretches *better);
uint8_t node_since(run *r, const node_plan *n, int64_t t, uint8_t left, uint8_t right);

/* ---- amounts.c */
uint8_t node_amount(run *r, const node_plan *n, int64_t t, uint8_t operand);
uint8_t node_doubt(run *r, const node_plan *n, int32_t place, int64_t t, uint8_t now);

/* ---- graph.c: the nodes of a part */
void mark_dirty(run *r, int32_t node);
void mark_all_dirty(run *r);
void work_out(run *r, int64_t t);
bool has_dirty_nodes(const run *r);
void remember_unknown(run *r, int64_t t);
void blank_out(run *r, int64_t t);
void vary(run *r, int64_t t, bool pending);
void settle_phase(run *r);

/* ---- automata.c: one attempt through positions and time */
typedef struct {
    int32_t location;
    int64_t *clocks;
    rv_hit *moves;             /* where it is counted where it goes; NULL: it is not */
} token;

int32_t class_of_letter(const run *r, int32_t index, bool better);
bool step_token(const machine *a, token *k, int64_t t, int32_t letter);
bool rests(const machine *a, const token *k, int64_t t, int32_t letter, int64_t *due);
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
int32_t place_taken(run *r);
void give_back(home *h, int32_t at);
void number_attempt(run *r, int32_t index, int32_t at, int64_t t);
bool is_sure(const run *r, int32_t index);
bool runs_on(const run *r, int32_t index);
void leave_episode(run *r, int32_t index);
void look_at(run *r, int32_t index, int64_t t);
void conclude(run *r, int32_t index, int32_t at, uint8_t verdict, uint8_t decision, int64_t t,
              int64_t note);
void decide(run *r, int32_t index, int32_t at, bool passed, int64_t t);
void leave(run *r, int32_t index, int32_t before, int32_t at);
bool is_undecidable(const attempt *x);
void lay_down(run *r, int32_t index, int32_t at);
void lay_aside(run *r, int32_t index, int32_t before, int32_t at);
int32_t next_open(const run *r, int32_t index, int32_t at);
uint32_t told_number(const run *r, int32_t at);
void settle_attempt(run *r, int32_t index, int32_t at, int64_t end, int64_t reached);

/* ---- records.c */
bool grow_records(rv_monitor *m, int64_t wanted);
void keep_record(rv_monitor *m, const rv_record *record);
int64_t keep_captured(rv_monitor *m, const rv_number *values, int32_t count);
void report(run *r, int32_t index, const attempt *x, uint32_t number, uint8_t verdict,
            uint8_t decision, int64_t t, int64_t note);
void sort_records(rv_monitor *m);

/* ---- drive.c: attempts of a judge through time */
void set_rule_due(run *r, int32_t index, int64_t due);
void set_restless(run *r, int32_t index);
void pass_to(run *r, int32_t index, int64_t t);
void pass_ticks(run *r, int32_t index, int64_t t);
void visit_judge(run *r, int32_t index, int64_t t);
void reach_judge(run *r, int32_t index, int64_t t);
bool drive_from(run *r, int32_t index, int32_t at, int64_t t);

/* ---- starts.c: attempts as they begin */
bool starts(run *r, int32_t index, uint8_t truth);
bool watches(const run *r, int32_t index);
void begin_here(run *r, int32_t index, int64_t t, int64_t triggered);
void begin(run *r, int32_t index, int64_t t, int64_t triggered);
void enter(run *r, int32_t index, int32_t at, int64_t t);

/* ---- notes.c: what is kept so that notes can be told */
bool make_notes(run *r);
void clear_noting(run *r, int32_t index);
void stand_at_first(run *r, int64_t t);
void stand_like(run *made, const run *r);
void note_node(run *r, int32_t node, uint8_t was, int64_t t);
void note_trigger(run *r, int32_t index, int64_t t);
void note_begin(run *r, int32_t index, attempt *x, int64_t t);
void note_parting(run *r, int32_t index, attempt *x);
void note_doubt(run *r, int32_t index, int64_t t);
void note_open_count(run *r, int32_t index);
void note_undecidable(run *r, int32_t index, int64_t t);
int64_t begin_of(const run *r, int32_t index, const attempt *x);
const int64_t *doubt_of(const run *r, int32_t index, const attempt *x);

/* ---- unknowns.c: what was not known of signals */
bool begin_unknowns(home *h);
void note_knowledge(run *r, int64_t t, int32_t local, const rv_number *value);
int64_t unknowns_count(const run *r, int64_t doubt);
void put_unknowns(const run *r, int64_t doubt, int64_t *to);

/* ---- letters.c: the letters by which a network judges */
void keep_letter(run *r, int32_t index, int64_t t);

/* ---- told.c: notes of decisions and of open attempts */
int64_t note_nothing(run *r, int32_t index, const attempt *x);
int64_t note_decision(run *r, int32_t index, const attempt *x, int64_t t);
int64_t note_open(run *r, int32_t index, const attempt *x, int64_t now, bool cannot_pass, int64_t end);
void hold_token(rv_monitor *m, const machine *a, int32_t location, const int64_t *clocks);
void hold_until(rv_monitor *m, const machine *a, int32_t letter, int64_t first, int64_t t);
void tell_open(rv_monitor *m, bool begins);
void forget_notes(rv_monitor *m, int64_t words, int32_t spans);

/* ---- queue.c: attempts of which age alone decides */
bool make_queue(run *r, int32_t index);
void clear_queue(judge *j);
bool queue_is_empty(const judge *j);
bool is_queued(const run *r, int32_t index);
void queue_visit(run *r, int32_t index, int64_t t);
void queue_pass(run *r, int32_t index, int64_t t);
void queue_reach(run *r, int32_t index, int64_t t);
bool queue_begin(run *r, int32_t index, int64_t t);
void loosen_queue(run *r, int32_t index);
void queue_close(run *r, int32_t index, int64_t end, int64_t reached);
const queued *queue_item(const judge *j, int32_t i);
const attempt *queued_attempt(const run *r, int32_t index, int32_t i);

/* Whether a judge has attempts that a position may concern. */
static inline bool has_attempts(const judge *j)
{
    return (j->first >= 0) || ((j->queue != NULL) && (j->queue->count > 0));
}

/* ---- dense.c: outages where only samples are positions */
bool make_nothing(home *h);
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

/* ---- core.c */
void settle_margins(rv_monitor *m, int64_t t);
const subscription *subscriptions_of(const rv_monitor *m, int32_t name, int32_t *count);
bool distribute(rv_monitor *m, const rv_update *updates, int32_t count);

/* ---- positions.c: at which positions something can change */
int64_t tick_from(int64_t gap, int64_t t);
bool may_go_on(const run *r, int32_t index);
void tidy_failing(run *r);
int64_t next_start(const run *r);
int64_t next_position(const run *r);
void set_alarm(run *r, int64_t position);

/* ---- clock.c */
void clear_run(run *r);
void clear_judges(run *r);
int32_t followed(const run *r, int32_t index);
void look_at_all(run *r);
void touch_all(run *r, uint8_t what);
void have_judged(run *r, int64_t t);
void visit(run *r, int64_t t);
void reach(run *r, int64_t t);
void through(run *r, int64_t limit, bool comes);
void approach(run *r, int64_t t);
void arrive(run *r, int64_t t);
int64_t next_decision(run *r);
void settle_all(run *r, int64_t end, int64_t reached);
bool was_heard(const run *r, int32_t index);

/* ---- ranges.c */
int32_t range_from(const ranges *r, int64_t position);
int32_t range_around(const ranges *r, int64_t position);
int64_t last_up_to(const ranges *r, int64_t position);
void ranges_put(rv_monitor *m, ranges *r, int32_t place, int64_t first, int64_t last);
void ranges_insert(rv_monitor *m, ranges *r, int32_t i, int64_t first, int64_t last);
void ranges_cut(rv_monitor *m, ranges *r, int64_t first, int64_t last);
void ranges_drop(ranges *r, int64_t before);
void ranges_empty(ranges *r);
void ranges_copy(rv_monitor *m, ranges *made, const ranges *r);
bool ranges_alike(const ranges *one, const ranges *other);

/* ---- network_nodes.c, network_state.c: what is known of a formula */
typedef struct {
    const plan *plan;
    const form_plan *form;
    const operator_plan *nodes;
    int64_t gap;
    int64_t step;
    rv_monitor *monitor;
} form;

form form_at(const run *r, int32_t number);
form form_of(const run *r, int32_t index); /* of a judge */
networks *made_networks(const form *f);
bool read_leaves(const run *r, const form *f, networks *net, bool *parted);
int64_t instant_of(const form *f, const network *w, int64_t position);
int64_t position_by(const form *f, const network *w, int64_t t);
int64_t from_on(const form *f, const network *w, int64_t position, int64_t distance);
int64_t up_to(const form *f, const network *w, int64_t position, int64_t distance);
bool knows(const operator_state *o, uint8_t value, int64_t position);
void learn(const form *f, networks *net, int32_t reading, int64_t now, int64_t last);
void unlearn(const form *f, network *w);
void start_over(const form *f, network *w, int64_t t, int64_t position);
void copy_network(const form *f, network *made, const network *w);
bool networks_agree(const form *f, const network *one, const network *other);
void tidy(const form *f, network *w, int64_t position);

/* ---- network_ahead.c: the first instant at which something new of a formula can be known, or before */
int64_t earliest_change(const form *f, networks *net, int32_t reading);

/* ---- network_judge.c: attempts that a network judges */
bool is_networked(const run *r, int32_t index);
void network_pass(run *r, int32_t index, int64_t now, bool is_position);
void network_put_off(run *r, int32_t index, int64_t until);
void network_foresee(run *r, int32_t index, int64_t now);
void network_come_to(run *r, int32_t index, int64_t t);
bool network_enter(run *r, int32_t index, int32_t at, int64_t t);
void network_close(run *r, int32_t index, int64_t end, int64_t reached);
bool network_outlasts(run *r, int32_t index, const attempt *x);

/* ---- watch.c: what is kept beside what becomes of attempts */
bool begin_watch(home *h);
void watch(run *r, int64_t t);
void end_watch(run *r, int64_t end, int64_t reached);

/* ---- cover.c: what runs hit of coverpoints and crosses */
bool begin_cover(home *h);
void call_watch(run *r, int32_t number);
void cover(run *r, int64_t t);

/* ---- moves.c: where attempts go in automata */
bool begin_moves(home *h);
void count_move(const machine *a, rv_hit *moves, int32_t from, int32_t to, int64_t count, int64_t t);
void count_begin(run *r, int32_t index, int64_t t);

/* Where it is counted where the attempts of a judge go; NULL: it is not. */
static inline rv_hit *moves_of(const run *r, int32_t index)
{
    return (r->home->moves != NULL) ? r->home->moves[index] : NULL;
}

/* ---- windows.c: attempts that a chain of windows judges */
bool is_chained(const run *r, int32_t index);
void chain_visit(run *r, int32_t index, int64_t t);
void chain_pass(run *r, int32_t index, int64_t t, bool is_position);
bool chain_enter(run *r, int32_t index, int32_t at, int64_t t);
bool chain_outlasts(run *r, int32_t index, const attempt *x, int64_t end, int64_t reached);

/* ---- runs.c: made, forked, replayed, let go */
run *new_run(home *h);
run *forked(const run *r);
void set_aside(home *h, run *r);
void give(run *r, int64_t t, const incoming *in, int32_t count);

/* ---- kept.c: samples for those that look at what was before */
past_update *keep_one(home *h, int64_t t);
void keep_updates(home *h, int64_t t);
void keep_given(home *h, int64_t t);
void replay(run *r);

/* ---- waiting.c: samples that wait for the tick that sees them */
bool holds_back(const home *h);
void hold_back(home *h, int64_t t);
void give_held(home *h, int64_t limit);
void forget_given(home *h);

/* ---- captured.c: attempts with captured values */
bool starts_here(const run *r, int32_t index);
void note_turn(run *r, int32_t at, int64_t t);
void note_done(run *r, int32_t at);
void flush_turns(home *h);
void begin_captured(run *r, int32_t index, int64_t t, int64_t triggered);
void look_after(run *r, int64_t t);
void mark_lapsed(run *r);
void forget_last(run *r);
bool is_idle(const run *r);
void let_go(run *r);
void adopt(run *parent, run *child);

/* ---- margins.c, margin_results.c: by how much what attempts owe holds; nothing where that is not asked
 * for */
bool margins_prepare(rv_monitor *m);
void margins_reset(rv_monitor *m);
bool margins_make(run *r);
void margins_clear(run *r);
void margins_begin(run *r, int32_t index, int64_t t, int32_t record);
void margins_visit(run *r, int64_t t);
void margins_settle(home *h, int64_t reached);
void margins_miss(run *r);
void margins_close(home *h, int64_t end, int64_t reached);
int32_t measured_attempt(run *r, int64_t triggered, uint32_t number);
void margin_numbered(rv_monitor *m, int32_t record, bool sure, uint32_t number);
void margin_vanished(rv_monitor *m, int32_t record);

/* ---- keys.c: instances of a `for each` */
bool begin_keys(home *h);
int32_t key_again(home *h, const rv_number *value, int64_t occurred, uint32_t rank);
void put_over(home *h, int32_t at);
void open_instances(home *h, int64_t t);
void open_unknown(home *h, int64_t t);
void close_instance(run *r);
bool is_over(const run *r);
run *instance_of(const home *h, const rv_number *value);
void open_at(run *r, int64_t t);
bool was_swallowed(run *r, int64_t t);
int32_t concerning(const run *r, const rv_update *u);

/* ---- crowd.c: which runs a part has, and which of them a call concerns */
bool register_run(home *h, run *r);
void touch_run(run *r);
void enlist(run *r, bool captured);
void delist(run *r, bool captured);
void set_alarms(home *h);
int32_t call_due(home *h, int64_t t);
int32_t call_concerned(home *h, int64_t t);
void for_called(home *h, int32_t count, int64_t t, void (*act)(run *r, int64_t t));

/* ---- homes.c: all runs of a part */
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
void untouch_all(home *h);
void home_come_to(home *h, int64_t end);
void home_close(home *h, int64_t end, int64_t reached);
int64_t home_due(home *h);
run *following(const home *h, const run *r);

#endif
