/* The robustness of the attempts of a run: the leaves are read at each position and given to two gauges,
 * which evaluate the bounds. The value at a position is the figure of the attempt that begins there. */
#include "formulas/formulas.h"
#include "margins/margins.h"
#include "runs/runs.h"

#include <string.h>

/* Mark the judges whose robustness reads a signal, an event or a node (in this order of numbers) that
 * may have changed. */
void margins_mark_changed(run *r, int32_t what)
{
    const margin_readers *readers = &r->part->readers[r->at.phase];
    int32_t i;
    if ((r->margins == NULL) || (GAP(r) == 0)) {
        return; /* where samples are positions, all are read at each */
    }
    for (i = readers->first[what]; i < readers->first[what + 1]; i++) {
        const int32_t index = readers->judges[i];
        if (!r->margins[index].changed_inputs) {
            r->margins[index].changed_inputs = true;
            r->changed_inputs[r->changed_count] = index;
            r->changed_count++;
        }
    }
}

static void mark_all_changed(run *r)
{
    int32_t i;
    r->changed_count = 0;
    for (i = 0; i < r->part->plan->judges.count; i++) {
        r->margins[i].changed_inputs = true;
        r->changed_inputs[i] = i;
    }
    r->changed_count = r->part->plan->judges.count;
}

/* Give the bounds of the leaves at some positions to the gauges. */
void give_letters(gauging *w, const int64_t *times, int64_t count, double *const *values, int32_t apart)
{
    measuring *q = w->q;
    w->g = &q->readings[0];
    gauge_take(w, times, count, values[0], apart);
    if (q->parted) {
        w->g = &q->readings[1];
        gauge_take(w, times, count, values[1], apart);
    }
}

/* Give the leaves once the events of the last position are over, unless a later position was read. */
void give_after(gauging *w, int64_t last)
{
    measuring *q = w->q;
    const int64_t position = floored(q->position, w->step) + 1;
    if (q->passes && (position <= last)) {
        q->passes = false;
        give_letters(w, &position, 1, q->after, 1);
    }
}

/* Fill in a figure: lower and upper bound, and lower bound by the rule for the end. Where captured values
 * are unknown it may be anything. */
void fill_figure(rv_margin *made, const run *r, int32_t index, const margin_request *one, margin_range found,
                 double kept)
{
    const bool cut = r->cut < NEVER;
    made->t = one->position * step_of(r);
    made->low = cut ? -INFINITE : found.low;
    made->high = found.high;
    made->kept = cut ? -INFINITE : kept;
    made->requirement = r->part->judges[index].requirement;
    made->number = 0;
    made->in_doubt = 0;
    made->of_position = (one->record == 0) ? 1 : 0;
}

/* Report a final figure. */
static inline void report_figure(const run *r, int32_t index, const margin_request *one, margin_range found)
{
    rv_margin *made = figure_found(r->home->monitor, one->record);
    if (made != NULL) {
        fill_figure(made, r, index, one, found, found.low);
    }
}

/* Report the figures of which both bounds are final. */
static void report_known(run *r, int32_t index)
{
    measuring *q = &r->margins[index];
    const bool streamed = is_streamed(r, index);
    const int32_t root = shape_of(r, index)->count - 1;
    gauge *least_one = &q->readings[0];
    gauge *most = q->parted ? &q->readings[1] : NULL;
    const int64_t known = q->parted ? least(least_one->nodes[root].known, most->nodes[root].known)
                                    : least_one->nodes[root].known;
    margin_cursor next = {q->requests.first, q->reported};
    margin_cursor done = next;
    margin_request one = {0, 0};
    while (next_request(q, streamed, &next, &one) && (one.position <= known)) {
        margin_range found;
        found.low = gauge_value(least_one, root, one.position);
        found.high = (most == NULL) ? found.low : gauge_value(most, root, one.position);
        report_figure(r, index, &one, found);
        done = next;
    }
    r->pending_margins -= (int32_t)(done.request - q->requests.first);
    q->requests.first = done.request;
    q->reported = done.position;
    (void)gauge_value(least_one, root, known); /* values before are not needed */
    if (most != NULL) {
        (void)gauge_value(most, root, known);
    }
    if ((q->requests.first == q->requests.end) && !is_kept_up(r, index) && !awaits_the_end(r, index)) {
        q->active = false;
        q->passes = false;
    }
}

/* Set the timer of a judge to the next instant at which time alone can make its first asked position
 * final; NEVER: there is none. */
static void set_margin_due(run *r, int32_t index, int64_t now, int64_t reached)
{
    const margin_shape *s = shape_of(r, index);
    const measuring *q = &r->margins[index];
    int64_t due = NEVER;
    if (q->active && (q->requests.first < q->requests.end) && !awaits_the_end(r, index)) {
        due = sum(step_at(&q->requests, q->requests.first)->at * step_of(r), s->lag);
        if (due <= reached) {
            const bool all = !s->passes && !q->passes && (now >= floored(reached, step_of(r)));
            due = all ? NEVER : reached + 1; /* NEVER: nothing is left to evaluate */
        }
    }
    timers_set(&r->margins_due, index, due);
}

/* Evaluate the gauges of a judge, with leaves known up to a position. */
static void come_to_margin(run *r, int32_t index, int64_t now, int64_t reached)
{
    measuring *q = &r->margins[index];
    gauging *w = begin_gauging(r, index, now, reached);
    give_after(w, now);
    w->g = &q->readings[0];
    gauge_run(w);
    if (q->parted) {
        w->g = &q->readings[1];
        w->side = 1;
        gauge_run(w);
    }
    report_known(r, index);
    if (!is_streamed(r, index)) {
        set_margin_due(r, index, now, reached);
    }
}

/* From the first unknown letter on the upper bound has a gauge of its own. */
void part_margins(run *r, int32_t index)
{
    measuring *q = &r->margins[index];
    q->parted = gauge_copy(r->home->monitor, shape_of(r, index), &q->readings[1], &q->readings[0]);
}

/* Begin after positions that were missed in an outage. */
static void begin_after_gap(run *r, int32_t index, int64_t position)
{
    measuring *q = &r->margins[index];
    gauging *w = begin_gauging(r, index, position, position);
    part_margins(r, index);
    for (; q->parted && (w->side < 2); w->side++) {
        w->g = &q->readings[w->side];
        gauge_begin_after_gap(w, floored(r->at.before, w->step));
    }
}

/* Read the leaves at a position and give them to the gauges. */
static void read_measures(run *r, int32_t index, int64_t position)
{
    const margin_shape *s = shape_of(r, index);
    measuring *q = &r->margins[index];
    bool differs = false;
    int32_t i;
    for (i = 0; i < s->plan->measures.count; i++) {
        const margin_range found = leaf_range(r, s, i);
        q->letter[0][i] = found.low;
        q->letter[1][i] = found.high;
        differs = differs || (found.low != found.high);
    }
    q->passes = false;
    for (i = 0; s->occurs && (i < s->plan->measures.count); i++) {
        margin_range found = {q->letter[0][i], q->letter[1][i]};
        q->passes = passes_on(r, &s->measures[i], &found) || q->passes;
        q->after[0][i] = found.low;
        q->after[1][i] = found.high;
    }
    if (differs && !q->parted) {
        part_margins(r, index);
    }
    give_letters(begin_gauging(r, index, position, position), &position, 1, q->letter, 1);
}

/* Read a position; all positions before it are complete. */
void enter_position(run *r, int32_t index, int64_t t)
{
    const margin_shape *s = shape_of(r, index);
    measuring *q = &r->margins[index];
    const int64_t position = floored(t, step_of(r));
    const bool pending_margins = q->requests.first < q->requests.end;
    if (q->active && !pending_margins && !is_kept_up(r, index)) {
        q->active = false; /* it was active only for the end of the trace */
    }
    if (!q->active) {
        q->active = true;
        q->parted = false;
        q->reported = 0;
        q->work.thin = !is_streamed(r, index);
        q->work.aligned = q->work.sparse && !q->work.thin;
        gauge_begin(s, &q->readings[0], position);
        if (q->missed && (s->plan->looks_back != 0)) {
            begin_after_gap(r, index, position);
        }
    } else if (awaits_the_end(r, index)) {
        come_to_margin(r, index, position - 1, t);
    } else if (q->passes) {
        give_after(begin_gauging(r, index, position - 1, t), position - 1);
    } else {
        /* The leaves are unchanged. */
    }
    read_measures(r, index, position);
    q->position = t;
    if (!is_streamed(r, index)) {
        timers_set(&r->margins_due, index, awaits_the_end(r, index) ? NEVER : -LIMIT);
    }
}

/* Measure an attempt that begins at the position at `t`. */
void margins_begin(run *r, int32_t index, int64_t t, int32_t record)
{
    const int64_t position = floored(t, step_of(r));
    measuring *q;
    if ((r->margins == NULL) || (record == 0)) {
        return;
    }
    q = &r->margins[index];
    if ((r->at.presence != ARE_THERE) || r->at.dense) {
        const margin_request none = {position, record};
        const margin_range anything = {-INFINITE, INFINITE};
        report_figure(r, index, &none, anything);
        return;
    }
    /* At the end the letter of the last position counts, even if a later sample was taken. */
    if (!q->active
        || ((q->position < t) && (q->changed_inputs || (GAP(r) == 0)) && !awaits_the_end(r, index))) {
        enter_position(r, index, t);
    }
    ask_for(r, index, position, record);
}

/* Read the leaves of a judge at the position at `t`, if they are needed. */
static inline void visit_measured(run *r, int32_t index, int64_t t)
{
    measuring *q = &r->margins[index];
    const bool wanted = q->active || is_kept_up(r, index) || awaits_the_end(r, index);
    q->changed_inputs = false;
    if (wanted && (!q->active || (q->position < t))) {
        enter_position(r, index, t);
    }
}

/* The number of judges, from the first, of which all positions are asked. */
static int32_t streamed_count(const run *r)
{
    return is_streamed(r, 0) ? r->part->plan->requirements : 0;
}

/* Ask some positions; where samples are positions all are asked anyway. */
void ask_for_positions(run *r, int32_t index, const int64_t *positions, int64_t count)
{
    if ((GAP(r) > 0) && (count > 0)) {
        const int64_t last = positions[count - 1];
        note_positions(begin_gauging(r, index, last, last), positions, count);
    }
}

/* Read the leaves at the position at `t`, after attempts have begun there: of all judges where samples
 * are positions, else of those whose leaves may have changed. */
void margins_visit(run *r, int64_t t)
{
    const int32_t streamed = streamed_count(r);
    const int64_t position = floored(t, step_of(r));
    int32_t i;
    if ((GAP(r) > 0) && (r->measured_at == -LIMIT)) {
        mark_all_changed(r);
    }
    r->measured_at = t;
    for (i = 0; (GAP(r) == 0) && (i < r->part->plan->judges.count); i++) {
        visit_measured(r, i, t);
    }
    for (i = 0; i < r->changed_count; i++) {
        visit_measured(r, r->changed_inputs[i], t);
    }
    r->changed_count = 0;
    for (i = 0; (GAP(r) > 0) && (i < streamed) && (t - step_of(r) < r->at.after); i++) {
        ask_for_positions(r, i, &position, 1);
    }
}

/* Report the figures of a run that are final now that time has reached an instant: of judges whose leaves
 * were read, or whose timer is due. */
static void settle_run(run *r, int64_t reached)
{
    const int64_t seen = floored((r->measured_at == reached) ? reached : reached - 1, step_of(r));
    const int32_t streamed = streamed_count(r);
    int32_t i;
    for (i = 0; i < streamed; i++) {
        if (r->margins[i].active && !awaits_the_end(r, i)) {
            come_to_margin(r, i, seen, reached);
        }
    }
    while (timers_next(&r->margins_due) <= reached) {
        come_to_margin(r, r->margins_due.ids[0], seen, reached);
    }
}

void margins_settle(home *h, int64_t reached)
{
    run *r;
    bool over = false;
    if (h->monitor->shapes == NULL) {
        return;
    }
    for (r = h->root; r != NULL; r = following(h, r)) {
        const int32_t pending_margins = r->pending_margins;
        settle_run(r, reached);
        if ((pending_margins > 0) && (r->pending_margins == 0) && (h->part->plan->captured > 0)) {
            touch_run(r); /* it may be freed */
            over = true;
        }
    }
    if (over) {
        rest_all(h);
    }
}

/* Positions from `t` on are missed in an outage: report the figures of all asked positions. */
void margins_miss(run *r, int64_t t)
{
    int32_t i;
    for (i = 0; (r->margins != NULL) && (i < r->part->plan->judges.count); i++) {
        measuring *q = &r->margins[i];
        margins_cut(r, i, t);
        r->pending_margins -= (int32_t)(q->requests.end - q->requests.first);
        q->requests.first = q->requests.end;
        q->reported = q->readings[0].stamps.end;
        q->missed = true;
        q->active = false;
        q->passes = false;
        timers_set(&r->margins_due, i, NEVER);
    }
    r->measured_at = -LIMIT;
}
