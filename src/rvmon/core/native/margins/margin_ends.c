/* Figures at the end of a trace, or as if it had ended: what lies behind it is taken for the least, for
 * the greatest, and for what the rule for the end says. */
#include "margins/margins.h"
#include "runs/runs.h"

#include <string.h>

/* What is asked for by one assumption about what lies behind the end; false if memory is short. */
static bool try_end(run *r, int32_t index, const margin_end *end, int64_t reached, double *answers)
{
    gauging w;
    measuring *q = &r->margins[index];
    const int32_t side = ((end->rest == REST_GREATEST) && q->parted) ? 1 : 0;
    int64_t i;
    int32_t k;
    begin_gauging(&w, r, index, end->last, reached);
    if (!gauge_copy(w.monitor, w.shape, &q->scratch, &q->readings[side])) {
        return false;
    }
    for (i = q->asks_first; i < q->scratch.answered; i++) {
        answers[i - q->asks_first] = (side == 0) ? ask_at(q, i)->low : ask_at(q, i)->high;
    }
    w.g = &q->scratch;
    w.answers = answers;
    for (k = 0; k < q->letter_count; k++) {
        if (q->letters[k].at <= floored(end->instant, w.step)) {
            gauge_take(&w, q->letters[k].at, (side == 0) ? q->letters[k].low : q->letters[k].high);
        }
    }
    gauge_run(&w);
    w.end = end;
    gauge_run(&w);
    return true;
}

typedef bool (*take_figure)(void *user, const rv_margin *figure, int32_t record);

/* The figures of a judge if the trace has ended; false if whoever takes them wants no more. */
static bool each_at_end(run *r, int32_t index, int64_t instant, int64_t reached, take_figure take,
                        void *user)
{
    rv_monitor *m = r->home->monitor;
    measuring *q = &r->margins[index];
    const int64_t count = q->asks_end - q->asks_first;
    const size_t size = (size_t)(3 * count + 1) * sizeof(double);
    margin_end end = {instant, LIMIT, REST_LEAST};
    rv_margin figure;
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
        if (!try_end(r, index, &end, reached, &found[end.rest * count])) {
            arena_give(&m->memory, found, size);
            found = NULL;
        }
    }
    for (i = 0; more && (found != NULL) && (i < count); i++) {
        margin_ask one = *ask_at(q, q->asks_first + i);
        one.low = found[i];
        one.high = found[count + i];
        fill_figure(&figure, r, index, &one, found[2 * count + i]);
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

/* Tell all figures that are left, when time has come to the end. */
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

/* Figures as an embedding program takes them. */
typedef struct {
    rv_monitor *monitor;
    rv_take_margin take;
    void *user;
} margin_telling;

static bool tell_open_margin(void *user, const rv_margin *figure, int32_t record)
{
    const margin_telling *to = user;
    rv_margin told;
    if ((record == 0) || to->monitor->margins.records[record - 1].vanished) {
        return true;
    }
    told = as_told(to->monitor, figure, record);
    return to->take(to->user, &told);
}

void rv_each_margin(rv_monitor *m, rv_take_margin take, void *user)
{
    margin_telling to = {m, take, user};
    const margin_results *s = &m->margins;
    const int64_t end = (m->last == m->reached) ? m->reached : m->reached - 1;
    int32_t i;
    int32_t k;
    if ((m->shapes == NULL) || (m->last == RV_NO_TIME) || m->finished) {
        return;
    }
    for (i = s->ready; i < s->found_count; i++) {
        if ((s->owners[i] != 0) && !tell_open_margin(&to, &s->found[i], s->owners[i])) {
            return;
        }
    }
    for (i = 0; i < m->plan.part_count; i++) {
        home *h = &m->homes[i];
        run *r;
        for (r = h->root; r != NULL; r = following(h, r)) {
            for (k = 0; k < h->part->plan->judges.count; k++) {
                if (!each_at_end(r, k, end, m->reached, tell_open_margin, &to)) {
                    return;
                }
            }
        }
    }
}
