/* Setup of robustness: the judges that read each input, so that the cost of a sample is in what it
 * changes; the state of a run; and the asked positions of attempts. */
#include "formulas/formulas.h"
#include "margins/margins.h"

/* The search for readers: a first pass counts, a second lists them. */
typedef struct {
    const plan *plan;
    const part *of;
    int32_t phase;
    int32_t *counts;           /* by input */
    int32_t *judges;           /* NULL: first pass */
    const int32_t *first;
} finding;

static void found_reader(finding *f, int32_t what, int32_t judge_number)
{
    if (f->judges != NULL) {
        f->judges[f->first[what] + f->counts[what]] = judge_number;
    }
    f->counts[what]++;
}

/* The signals that a program reads. */
static void find_in_program(finding *f, int32_t place, int32_t judge_number)
{
    const int32_t *word = &f->plan->code[place];
    for (; (*word & 255) != CODE_END; word++) {
        switch (*word & 255) {
        case CODE_SIGNAL:
        case CODE_PREV:
        case CODE_DELTA:
        case CODE_RATE: found_reader(f, *word >> 8, judge_number); break;
        case CODE_FIELD: word++; break;
        default: break;
        }
    }
}

/* The signals and events that a comparison reads. */
static void find_in_atom(finding *f, const atom_plan *a, int32_t judge_number)
{
    const int32_t *events = LIST(f->plan, a->events);
    int32_t i;
    if (a->op == ATOM_REAL) {
        found_reader(f, a->input, judge_number);
        return;
    }
    find_in_program(f, a->left, judge_number);
    find_in_program(f, a->right, judge_number);
    for (i = 0; i < a->events.count; i++) {
        found_reader(f, f->of->plan->signals.count + events[i], judge_number);
    }
}

static void find_readers(finding *f)
{
    const part_plan *p = f->of->plan;
    int32_t judge_number;
    int32_t i;
    for (judge_number = 0; judge_number < p->judges.count; judge_number++) {
        const list own = f->plan->margins[p->judges.first + judge_number].measures;
        for (i = own.first; i < own.first + own.count; i++) {
            const measure_plan *m = &f->plan->measures[i];
            bool by_truth = m->kind != MEASURE_CONSTANT;
            if (m->kind == MEASURE_DISTANCE) {
                const node_plan *n = &f->of->nodes[m->node];
                const atom_plan *a = &f->of->atoms[n->a];
                find_in_atom(f, a, judge_number);
                /* Until all signals are born; and the values of windows, which are nodes. */
                by_truth = (f->phase == 0) || (a->op == ATOM_PAYLOAD) || (n->op == NODE_COMPARED);
            }
            if (by_truth) {
                found_reader(f, p->signals.count + p->events.count + m->node, judge_number);
            }
        }
    }
}

/* Find the readers of all inputs of a part in a phase; false if memory is short. */
static bool prepare_readers(rv_monitor *m, part *of, int32_t phase)
{
    const part_plan *p = of->plan;
    const int32_t count = p->signals.count + p->events.count + p->nodes.count;
    const size_t size = (size_t)(count + 1) * sizeof(int32_t);
    int32_t *counts = arena_take(&m->memory, size);
    int32_t *first = arena_take(&m->memory, size);
    finding f = {&m->plan, of, phase, counts, NULL, first};
    int32_t i;
    if ((counts == NULL) || (first == NULL)) {
        return false;
    }
    find_readers(&f);
    for (i = 0; i < count; i++) {
        first[i + 1] = first[i] + counts[i];
        counts[i] = 0;
    }
    f.judges = arena_take(&m->memory, (size_t)(first[count] + 1) * sizeof *f.judges);
    if (f.judges == NULL) {
        return false;
    }
    find_readers(&f);
    of->readers[phase].first = first;
    of->readers[phase].judges = f.judges;
    arena_give(&m->memory, counts, size);
    return true;
}

/* Compute all shapes and readers; false if memory is short. */
bool margins_prepare(rv_monitor *m)
{
    const int64_t count = m->plan.counts[SEC_MARGINS];
    int32_t i;
    int32_t k;
    if (count == 0) {
        return true;
    }
    m->shapes = arena_take(&m->memory, (size_t)count * sizeof *m->shapes);
    for (i = 0; (m->shapes != NULL) && (i < m->plan.part_count); i++) {
        const list own = m->parts[i].plan->judges;
        for (k = own.first; k < own.first + own.count; k++) {
            if (!make_shape(m, &m->parts[i], &m->plan.margins[k], &m->shapes[k])) {
                return false;
            }
        }
        if (!prepare_readers(m, &m->parts[i], 0) || !prepare_readers(m, &m->parts[i], 1)) {
            return false;
        }
    }
    return m->shapes != NULL;
}

/* Make the state of robustness of a new run; false if memory is short. */
bool margins_make(run *r)
{
    rv_monitor *m = r->home->monitor;
    const int32_t judges = r->part->plan->judges.count;
    int32_t i;
    int32_t k;
    if (m->shapes == NULL) {
        return true;
    }
    r->margins = arena_take(&m->memory, (size_t)(judges + 1) * sizeof *r->margins);
    r->changed_inputs = arena_take(&m->memory, (size_t)(judges + 1) * sizeof *r->changed_inputs);
    r->margins_due.due = arena_take(&m->memory, (size_t)(judges + 1) * sizeof(int64_t));
    r->margins_due.ids = arena_take(&m->memory, (size_t)(judges + 1) * sizeof(int32_t));
    r->margins_due.place = arena_take(&m->memory, (size_t)(judges + 1) * sizeof(int32_t));
    if ((r->changed_inputs == NULL) || (r->margins_due.due == NULL) || (r->margins_due.ids == NULL)
        || (r->margins_due.place == NULL)) {
        return false;
    }
    for (i = 0; (r->margins != NULL) && (i < judges); i++) {
        const margin_shape *s = shape_of(r, i);
        measuring *q = &r->margins[i];
        const size_t size = (size_t)(s->plan->measures.count + 1) * sizeof(double);
        for (k = 0; k < 2; k++) {
            q->letter[k] = arena_take(&m->memory, size);
            q->after[k] = arena_take(&m->memory, size);
            if ((q->letter[k] == NULL) || (q->after[k] == NULL)) {
                return false;
            }
        }
        q->work.monitor = m;
        q->work.shape = s;
        q->work.q = q;
        q->work.step = step_of(r);
        q->work.sparse = GAP(r) == 0;
        if (!gauge_make(m, s, &q->readings[0])) {
            return false;
        }
    }
    return r->margins != NULL;
}

/* Reset it: no position is asked. */
void margins_clear(run *r)
{
    int32_t i;
    r->pending_margins = 0;
    r->changed_count = 0;
    r->measured_at = -LIMIT;
    if (r->margins != NULL) {
        timers_clear(&r->margins_due, r->part->plan->judges.count);
    }
    for (i = 0; (r->margins != NULL) && (i < r->part->plan->judges.count); i++) {
        measuring *q = &r->margins[i];
        q->requests.first = q->requests.end = 0;
        q->reported = 0;
        q->readings[0].stamps.end = 0;
        q->passes = false;
        q->position = -LIMIT;
        q->active = false;
        q->parted = false;
        q->missed = false;
        q->changed_inputs = false;
    }
}

/* Ask the position at which an attempt begins; positions must not decrease. */
void ask_for(run *r, int32_t index, int64_t position, int32_t record)
{
    measuring *q = &r->margins[index];
    const bool first = q->requests.end == q->requests.first;
    if (!room_for_steps(&q->work, &q->requests, 1, q->requests.first)) {
        return;
    }
    add_step(&q->requests, position, record);
    r->pending_margins++;
    if (first && !awaits_the_end(r, index) && !is_streamed(r, index)) {
        const int64_t due = sum(position * step_of(r), shape_of(r, index)->lag);
        timers_set(&r->margins_due, index, least(due, r->margins_due.due[index]));
    }
}
