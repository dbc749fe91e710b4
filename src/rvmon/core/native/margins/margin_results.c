/* Figures until they are taken, and attempts that wait for theirs.
 *
 * The figure of an attempt in doubt is reported once its trigger is certain, or the run is over: until
 * then its obligation may be met, which leaves no record. */
#include "margins/margins.h"
#include "runs/runs.h"

#include <stdlib.h>
#include <string.h>

/* Make a record for an attempt that begins; returns its number, 0 if attempts are not measured. */
int32_t measured_attempt(run *r, int64_t triggered, uint32_t number)
{
    rv_monitor *m = r->home->monitor;
    margin_results *s = &m->margins;
    int32_t at = s->free_record;
    margin_record *made;
    if (m->shapes == NULL) {
        return 0;
    }
    if (at > 0) {
        s->free_record = s->records[at - 1].next;
    } else {
        made = enlarged(m, s->records, &s->record_room, (int64_t)s->record_count + 1, sizeof *made);
        if (made == NULL) {
            return 0;
        }
        s->records = made;
        s->record_count++;
        at = s->record_count;
    }
    made = &s->records[at - 1];
    (void)memset(made, 0, sizeof *made);
    made->triggered = triggered;
    made->number = number;
    made->sure = number > 0;
    return at;
}

/* Note the number of an attempt, or its number among those in doubt; it may have both. */
void margin_numbered(rv_monitor *m, int32_t record, bool sure, uint32_t number)
{
    if (record != 0) {
        margin_record *own = &m->margins.records[record - 1];
        own->sure = own->sure || sure;
        if (sure) {
            own->number = number;
        } else {
            own->doubt_number = number;
        }
    }
}

/* Note that the obligation of an attempt in doubt was met: it has no figure. */
void margin_vanished(rv_monitor *m, int32_t record)
{
    if (record != 0) {
        m->margins.records[record - 1].vanished = true;
    }
}

/* A figure with its attempt; without a trigger there is no obligation. */
rv_margin as_reported(const rv_monitor *m, const rv_margin *figure, int32_t record)
{
    rv_margin made = *figure;
    if (record != 0) {
        const margin_record *own = &m->margins.records[record - 1];
        made.t = own->triggered;
        made.in_doubt = own->sure ? 0 : 1;
        made.number = own->sure ? own->number : own->doubt_number;
        made.high = own->sure ? made.high : INFINITE;
    }
    return made;
}

/* Make room for another figure; false if memory is short. */
bool room_for_figure(rv_monitor *m)
{
    margin_results *s = &m->margins;
    const int64_t wanted = (int64_t)s->found_count + 1;
    rv_margin *made = enlarged(m, s->found, &s->found_room, wanted, sizeof *made);
    int32_t *owners = enlarged(m, s->owners, &s->owners_room, wanted, sizeof *owners);
    s->found = (made != NULL) ? made : s->found;
    s->owners = (owners != NULL) ? owners : s->owners;
    return (made != NULL) && (owners != NULL);
}

static void free_record(margin_results *s, int32_t record)
{
    s->records[record - 1].next = s->free_record;
    s->free_record = record;
}

/* By instant, then requirement, then attempts before positions. */
static int margins_compared(const void *one, const void *other)
{
    const rv_margin *a = one;
    const rv_margin *b = other;
    if (a->t != b->t) {
        return (a->t < b->t) ? -1 : 1;
    }
    if (a->requirement != b->requirement) {
        return (a->requirement < b->requirement) ? -1 : 1;
    }
    if (a->of_position != b->of_position) {
        return (int)a->of_position - (int)b->of_position;
    }
    if (a->in_doubt != b->in_doubt) {
        return (int)a->in_doubt - (int)b->in_doubt;
    }
    return (a->number == b->number) ? 0 : ((a->number < b->number) ? -1 : 1);
}

static bool is_reportable(const rv_monitor *m, int32_t record)
{
    const margin_record *own = (record == 0) ? NULL : &m->margins.records[record - 1];
    return (own == NULL) || own->sure || m->finished;
}

/* Move the figures that can be reported to the front, sorted; drop those of vanished attempts. */
int64_t rv_margins(rv_monitor *m, const rv_margin **margins)
{
    margin_results *s = &m->margins;
    const int32_t first = s->ready;
    int32_t waiting = 0;
    int32_t i;
    *margins = s->found;
    for (i = first; i < s->found_count; i++) {
        const int32_t record = s->owners[i];
        rv_margin figure;
        if ((record == 0) && (i == s->ready)) {
            s->ready++; /* the usual case */
            continue;
        }
        figure = s->found[i];
        if ((record != 0) && s->records[record - 1].vanished) {
            free_record(s, record);
        } else if (is_reportable(m, record)) {
            s->found[s->ready + waiting] = s->found[s->ready];
            s->owners[s->ready + waiting] = s->owners[s->ready];
            s->found[s->ready] = as_reported(m, &figure, record);
            s->owners[s->ready] = 0;
            s->ready++;
            if (record != 0) {
                free_record(s, record);
            }
        } else {
            s->found[s->ready + waiting] = figure;
            s->owners[s->ready + waiting] = record;
            waiting++;
        }
    }
    s->found_count = s->ready + waiting;
    for (i = first + 1; i < s->ready; i++) {
        if (margins_compared(&s->found[i - 1], &s->found[i]) > 0) {
            qsort(&s->found[first], (size_t)(s->ready - first), sizeof *s->found, margins_compared);
            break;
        }
    }
    return s->ready;
}

void rv_forget_margins(rv_monitor *m)
{
    margin_results *s = &m->margins;
    const int32_t left = s->found_count - s->ready;
    if ((s->ready > 0) && (left > 0)) {
        (void)memmove(s->found, &s->found[s->ready], (size_t)left * sizeof *s->found);
        (void)memmove(s->owners, &s->owners[s->ready], (size_t)left * sizeof *s->owners);
    }
    s->found_count = left;
    s->ready = 0;
}

void rv_measure_positions(rv_monitor *m)
{
    m->measures_positions = m->shapes != NULL;
}

/* Begin another run. */
void margins_reset(rv_monitor *m)
{
    m->margins.found_count = 0;
    m->margins.ready = 0;
    m->margins.record_count = 0;
    m->margins.free_record = 0;
}

/* Figures at the end of a trace, or as if it had ended now: evaluated with each of the three assumptions
 * about the rest (REST_LEAST, REST_GREATEST, REST_END). */

/* End the trace in a copy of a gauge, under one assumption; false if memory is short. */
static bool try_end(run *r, int32_t index, const margin_end *end, int64_t reached)
{
    measuring *q = &r->margins[index];
    gauging w = *begin_gauging(r, index, end->last, reached);
    const int32_t side = ((end->rest == REST_GREATEST) && q->parted) ? 1 : 0;
    const int64_t beyond = floored(q->position, step_of(r)) + 1;
    if (!gauge_copy(w.monitor, w.shape, &q->scratch, &q->readings[side])) {
        return false;
    }
    w.g = &q->scratch;
    w.side = side;
    if (q->passes && (beyond <= floored(end->instant, w.step))) {
        gauge_take(&w, &beyond, 1, q->after[side], 1);
    }
    gauge_run(&w);
    w.end = end;
    gauge_run(&w);
    return true;
}

typedef bool (*take_figure)(void *user, const rv_margin *figure, int32_t record);

/* The figures of a judge if the trace has ended; false if the receiver wants no more. */
static bool each_at_end(run *r, int32_t index, int64_t instant, int64_t reached, take_figure take,
                        void *user)
{
    rv_monitor *m = r->home->monitor;
    measuring *q = &r->margins[index];
    const bool streamed = is_streamed(r, index);
    const margin_cursor begin = {q->requests.first, q->reported};
    const int64_t count = q->requests.end - q->requests.first
                          + (streamed ? q->readings[0].stamps.end - q->reported : 0);
    const int32_t root = shape_of(r, index)->count - 1;
    const size_t size = (size_t)(3 * count + 1) * sizeof(double);
    margin_end end = {instant, LIMIT, REST_LEAST};
    margin_request one = {0, 0};
    rv_margin figure;
    margin_cursor next;
    double *found;
    bool more = true;
    int64_t i;
    if (count == 0) {
        return true;
    }
    if (GAP(r) > 0) {
        end.last = floored(instant, step_of(r));
    }
    found = arena_take(&m->memory, size);
    m->spoilt = m->spoilt || (found == NULL);
    for (; (found != NULL) && (end.rest <= REST_END); end.rest++) {
        if (!try_end(r, index, &end, reached)) {
            arena_give(&m->memory, found, size);
            return true;
        }
        next = begin;
        for (i = end.rest * count; next_request(q, streamed, &next, &one); i++) {
            found[i] = gauge_value(&q->scratch, root, one.position);
        }
    }
    next = begin;
    for (i = 0; more && (found != NULL) && next_request(q, streamed, &next, &one); i++) {
        const margin_range bounds = {found[i], found[count + i]};
        fill_figure(&figure, r, index, &one, bounds, found[2 * count + i]);
        more = take(user, &figure, one.record);
    }
    arena_give(&m->memory, found, size);
    return more;
}

static bool found_at_end(void *user, const rv_margin *figure, int32_t record)
{
    rv_margin *made = figure_found(user, record);
    if (made != NULL) {
        *made = *figure;
    }
    return made != NULL;
}

static bool found_where_cut(void *user, const rv_margin *figure, int32_t record)
{
    rv_margin made = *figure;
    made.kept = made.low;
    return found_at_end(user, &made, record);
}

/* Report all remaining figures of a judge: nothing is known from `t` on. */
void margins_cut(run *r, int32_t index, int64_t t)
{
    (void)each_at_end(r, index, t - 1, t, found_where_cut, r->home->monitor);
}

/* Report all remaining figures at the end of the trace. */
void margins_close(home *h, int64_t end, int64_t reached)
{
    run *r;
    int32_t i;
    for (r = h->root; (h->monitor->shapes != NULL) && (r != NULL); r = following(h, r)) {
        for (i = 0; i < h->part->plan->judges.count; i++) {
            (void)each_at_end(r, i, end, reached, found_at_end, h->monitor);
        }
        margins_clear(r);
    }
}

/* The callback of an embedding program that takes figures. */
typedef struct {
    rv_monitor *monitor;
    rv_take_margin take;
    void *user;
} margin_receiver;

static bool report_open_margin(void *user, const rv_margin *figure, int32_t record)
{
    const margin_receiver *to = user;
    rv_margin reported;
    if ((record == 0) || to->monitor->margins.records[record - 1].vanished) {
        return true;
    }
    reported = as_reported(to->monitor, figure, record);
    return to->take(to->user, &reported);
}

void rv_each_margin(rv_monitor *m, rv_take_margin take, void *user)
{
    margin_receiver to = {m, take, user};
    const margin_results *s = &m->margins;
    const int64_t end = (m->last == m->reached) ? m->reached : m->reached - 1;
    int32_t i;
    int32_t k;
    if ((m->shapes == NULL) || (m->last == RV_NO_TIME) || m->finished) {
        return;
    }
    for (i = s->ready; i < s->found_count; i++) {
        if ((s->owners[i] != 0) && !report_open_margin(&to, &s->found[i], s->owners[i])) {
            return;
        }
    }
    for (i = 0; i < m->plan.part_count; i++) {
        home *h = &m->homes[i];
        run *r;
        for (r = h->root; r != NULL; r = following(h, r)) {
            for (k = 0; k < h->part->plan->judges.count; k++) {
                if (!each_at_end(r, k, end, m->reached, report_open_margin, &to)) {
                    return;
                }
            }
        }
    }
}
