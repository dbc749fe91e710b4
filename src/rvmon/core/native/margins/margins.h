/* Robustness of attempts: functions shared by the files of this folder. */
#ifndef RVMON_MARGINS_H
#define RVMON_MARGINS_H

#include "basics.h"

#include <math.h>

/* ---- margins.c, margin_results.c: the robustness of attempts, if it is measured */
bool margins_prepare(rv_monitor *m);
void margins_reset(rv_monitor *m);
bool margins_make(run *r);
void margins_clear(run *r);
void margins_begin(run *r, int32_t index, int64_t t, int32_t record);
void margins_visit(run *r, int64_t t);
void margins_settle(home *h, int64_t reached);
void margins_miss(run *r, int64_t t);
void margins_close(home *h, int64_t end, int64_t reached);
int32_t measured_attempt(run *r, int64_t triggered, uint32_t number);
void margin_numbered(rv_monitor *m, int32_t record, bool sure, uint32_t number);
void margin_vanished(rv_monitor *m, int32_t record);

#define INFINITE ((double)INFINITY)

/* Lower and upper bound. */
typedef struct {
    double low;
    double high;
} margin_range;

static inline margin_step *step_at(const margin_steps *s, int64_t number)
{
    return &s->ring[number & (s->room - 1)];
}

static inline bool has_room(const margin_steps *s, int64_t count)
{
    return s->end - s->first + count <= s->room;
}

static inline const operator_plan *node_plan_of(const gauging *w, int32_t place)
{
    return &w->shape->nodes[place];
}

static inline double within(double value, double least_one, double most)
{
    return (value < least_one) ? least_one : ((value > most) ? most : value);
}

/* The value assumed after the end; `kept`: for an unbounded `R`. */
static inline double margin_beyond(const margin_end *end, bool kept)
{
    const bool good = (end->rest == REST_GREATEST) || ((end->rest == REST_END) && kept);
    return good ? INFINITE : -INFINITE;
}

/* The value of a formula at a position where it is final; positions must not decrease. */
static inline double gauge_value(gauge *g, int32_t root, int64_t position)
{
    const margin_steps *from = &g->nodes[root].out;
    while ((g->read < from->end) && (step_at(from, g->read)->at <= position)) {
        g->reported = step_at(from, g->read)->value;
        g->read++;
    }
    return g->reported;
}

/* Whether only the values of an operator at the positions of attempts matter. */
static inline bool is_thin(const gauging *w, int32_t place)
{
    return w->thin && w->shape->places[place].alone;
}

static inline const margin_shape *shape_of(const run *r, int32_t index)
{
    return &r->home->monitor->shapes[r->part->plan->judges.first + index];
}

/* A place in the asked positions: those of attempts, and all samples where each is asked. */
typedef struct {
    int64_t request;
    int64_t position;
} margin_cursor;

/* The next asked position, in order; false: there is none. */
static inline bool next_request(const measuring *q, bool streamed, margin_cursor *at, margin_request *found)
{
    const margin_steps *stamps = &q->readings[0].stamps;
    const bool begins = at->request < q->requests.end;
    if (streamed && (at->position < stamps->end)
        && (!begins || (step_at(stamps, at->position)->at < step_at(&q->requests, at->request)->at))) {
        found->position = step_at(stamps, at->position)->at;
        found->record = 0;
        at->position++;
        return true;
    }
    if (begins) {
        found->position = step_at(&q->requests, at->request)->at;
        found->record = (int32_t)step_at(&q->requests, at->request)->value;
        at->request++;
    }
    return begins;
}

/* The robustness of a comparison of a signal with a real constant; never -0.0. */
static inline double measured_real(const margin_real *x, double value)
{
    const double distance = (value == x->constant) ? 0.0 : value - x->constant; /* infinite values, too */
    return (x->absolute ? fabs(distance) : distance) * x->slope + 0.0;
}

/* ---- margin_steps.c */
bool room_for_steps(gauging *w, margin_steps *s, int64_t count, int64_t oldest);
int64_t oldest_unread(const gauging *w, int32_t place);
bool takes_step(gauging *w, int32_t place, int64_t at, double value);
bool is_requested(const gauging *w, int64_t left, int64_t right);
void note_positions(gauging *w, const int64_t *times, int64_t count);
bool steps_copy(rv_monitor *m, margin_steps *made, const margin_steps *s);
bool parts_copy(rv_monitor *m, margin_parts *made, const margin_parts *s);
void parts_follow(gauging *w, margin_parts *s, int64_t start, double low, double high, bool alone);
bool parts_settled(const margin_parts *s, double *value);
void parts_leave(margin_parts *s);

/* Add a step, for which there is room. */
static inline void add_step(margin_steps *s, int64_t at, double value)
{
    margin_step *made = step_at(s, s->end);
    made->at = at;
    made->value = value;
    s->end++;
}

/* Add steps, for which there is room. */
static inline void add_steps(margin_steps *s, const int64_t *times, int64_t count, const double *values)
{
    margin_steps now = *s; /* a local copy: the compiler cannot know that the ring does not overlap it */
    int64_t k;
    for (k = 0; k < count; k++) {
        add_step(&now, times[k], (values != NULL) ? values[k] : 0.0);
    }
    s->end = now.end;
}

/* Give a node another value from a position on. */
static inline void emit_step(gauging *w, int32_t place, int64_t at, double value)
{
    margin_steps *s = &w->g->nodes[place].out;
    if ((!w->thin && has_room(s, 1)) || takes_step(w, place, at, value)) {
        add_step(s, at, value);
    }
}

/* ---- margin_joins.c */
void gauge_join(gauging *w, int32_t place);

/* ---- margin_windows.c */
void gauge_window(gauging *w, int32_t place);
void gauge_shift(gauging *w, int32_t place);

/* ---- gauge.c */
bool gauge_make(rv_monitor *m, const margin_shape *s, gauge *g);
void gauge_begin(const margin_shape *s, gauge *g, int64_t first);
void gauge_begin_after_gap(gauging *w, int64_t last);
bool gauge_copy(rv_monitor *m, const margin_shape *s, gauge *made, const gauge *g);
void gauge_take(gauging *w, const int64_t *times, int64_t count, const double *values, int32_t apart);
void gauge_run(gauging *w);
double bound_of_anything(const gauging *w);

bool make_shape(rv_monitor *m, const part *of, const margin_plan *g, margin_shape *s);

/* ---- margin_readers.c */
void ask_for(run *r, int32_t index, int64_t position, int32_t record);

/* ---- margin_leaves.c */
margin_real learn_real(const part *of, const measure_plan *m);
margin_range measured_leaf(const run *r, const margin_shape *s, int32_t number);
bool passes_on(const run *r, const measure_plan *m, margin_range *then);

/* The range of a leaf; fast for the most frequent kind, comparisons with a constant. */
static inline margin_range leaf_range(const run *r, const margin_shape *s, int32_t number)
{
    const margin_real *real = &s->reals[number];
    if ((real->input >= 0) && (r->value[real->input].kind == RV_REAL)) {
        margin_range made;
        made.low = measured_real(real, r->value[real->input].as.real);
        made.high = made.low;
        return made;
    }
    return measured_leaf(r, s, number);
}

/* Whether the positions of all samples are asked. */
static inline bool is_streamed(const run *r, int32_t index)
{
    return r->home->monitor->measures_positions && (r->part->plan->captured == 0)
           && (index < r->part->plan->requirements);
}

/* Whether leaves have to be read even while no position is asked. */
static inline bool is_kept_up(const run *r, int32_t index)
{
    return (shape_of(r, index)->plan->looks_back != 0) || is_streamed(r, index);
}

/* Whether attempts begin at the end: then the last position may be asked after the trace. */
static inline bool awaits_the_end(const run *r, int32_t index)
{
    return r->part->judges[index].trigger < 0;
}

/* Begin a step: leaves are known up to a position, and time has reached an instant. */
static inline gauging *begin_gauging(const run *r, int32_t index, int64_t now, int64_t reached)
{
    measuring *q = &r->margins[index];
    gauging *w = &q->work;
    w->g = &q->readings[0];
    w->side = 0;
    w->now = now;
    w->reached = reached;
    return w;
}

/* ---- margins.c, of a run */
void give_letters(gauging *w, const int64_t *times, int64_t count, double *const *values, int32_t apart);
void give_after(gauging *w, int64_t last);
void part_margins(run *r, int32_t index);
void enter_position(run *r, int32_t index, int64_t t);
void ask_for_positions(run *r, int32_t index, const int64_t *positions, int64_t count);
void fill_figure(rv_margin *made, const run *r, int32_t index, const margin_request *one, margin_range found,
                 double kept);

/* ---- margin_results.c */
bool room_for_figure(rv_monitor *m);
void margins_cut(run *r, int32_t index, int64_t t);
rv_margin as_reported(const rv_monitor *m, const rv_margin *figure, int32_t record);

/* A place for another figure; NULL: memory is short. */
static inline rv_margin *figure_found(rv_monitor *m, int32_t record)
{
    margin_results *s = &m->margins;
    if ((s->found_count == least(s->found_room, s->owners_room)) && !room_for_figure(m)) {
        return NULL; /* the run is spoilt */
    }
    s->owners[s->found_count] = record;
    s->found_count++;
    return &s->found[s->found_count - 1];
}

#endif
