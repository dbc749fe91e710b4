/* Two records kept besides the judging of attempts: where in time each operator of a formula is known to
 * be true or false (for pictures, and for the analysis of late responses), and how often attempts moved
 * between locations of automata. */
#include "networks/network.h"
#include "results/results.h"

#include <string.h>

/* The form whose truths are recorded. */
static form kept_form(const run *r)
{
    return form_at(r, r->part->plan->truths);
}

/* Reset coverage, truths and moves for a new run; false: memory is short. */
bool begin_watch(home *h)
{
    if (h->truths != NULL) {
        h->truths->started = false;
    }
    h->is_blind = false;
    return ((h->part->plan->watches.count == 0) || begin_cover(h))
           && (!h->part->is_traced || begin_moves(h));
}

/* Number of readings in use. */
static int32_t readings_of(const networks *net)
{
    return net->parted ? 2 : 1;
}

/* Extend the current letter up to position `last`, when time has come to `now`. */
static void stay(const form *f, networks *net, int64_t now, int64_t last)
{
    int32_t i;
    for (i = 0; i < readings_of(net); i++) {
        learn(f, net, i, now, last);
    }
}

/* Start at the first position; false: memory is short. */
static bool begin_truths(home *h, const form *f, int64_t t)
{
    if (h->truths == NULL) {
        h->truths = made_networks(f);
        if (h->truths == NULL) {
            return false;
        }
    }
    reset_network(f, &h->truths->readings[0], t, (f->gap > 0) ? floored(t, f->step) : 0);
    h->truths->started = true;
    h->truths->parted = false;
    h->truths->turn = NEVER;
    return true;
}

/* Sampled time: add the position of the sample at `t`. */
static void add_sample(const form *f, networks *net, int64_t t)
{
    int32_t i;
    for (i = 0; i < readings_of(net); i++) {
        ranges *samples = &net->readings[i].samples;
        ranges_put(f->monitor, samples, samples->end, t, t);
    }
    if (!f->monitor->spoilt) {
        stay(f, net, t, net->readings[0].last + 1);
    }
}

/* Take the letter at `t`. With a gap, a letter that stays is extended only when it changes. */
static void keep_truths(run *r, int64_t t)
{
    home *h = r->home;
    const form f = kept_form(r);
    const bool fresh = (h->truths == NULL) || !h->truths->started;
    bool parted = false;
    bool changed;
    if (h->monitor->spoilt || (fresh && !begin_truths(h, &f, t))) {
        return;
    }
    changed = read_leaves(r, &f, h->truths, &parted) || fresh;
    if (changed && (f.gap > 0)) {
        stay(&f, h->truths, t - 1, floored(t, f.step) - 1);
    }
    if (parted && !h->truths->parted) {
        copy_network(&f, &h->truths->readings[1], &h->truths->readings[0]);
        h->truths->parted = true;
    }
    (void)memcpy(h->truths->leaf, h->truths->next_leaf, (size_t)f.form->leaves);
    if (f.gap == 0) {
        add_sample(&f, h->truths, t);
    }
}

/* Watch the position at `t`, at which nodes have their truths. Sets stays_busy if the next position has
 * to be visited: for coverage of pulses, and in sampled time because every sample counts. */
void watch(run *r, int64_t t)
{
    r->stays_busy = false;
    if (r->part->plan->watches.count > 0) {
        cover(r, t);
        r->stays_busy = r->home->covering->called_count > 0;
    }
    if ((r->part->plan->truths >= 0) && r->at.dense) {
        r->home->is_blind = true; /* it is unknown which positions exist */
    } else if (r->part->plan->truths >= 0) {
        keep_truths(r, t);
        r->stays_busy = r->stays_busy || (GAP(r) == 0);
    } else {
        /* No truths are kept. */
    }
}

/* The trace ends: extend the last letter to the end. */
void end_watch(run *r, int64_t end, int64_t reached)
{
    networks *net = r->home->truths;
    if ((net != NULL) && net->started && !r->home->monitor->spoilt) {
        const form f = kept_form(r);
        stay(&f, net, reached, (f.gap > 0) ? floored(end, f.step) : net->readings[0].last);
    }
}

int64_t rv_truths(const rv_monitor *m, int32_t operator_number, bool better, bool value,
                  const rv_range **found)
{
    const home *h = (m->plan.part_count > 0) ? &m->homes[0] : NULL;
    const ranges *known;
    *found = NULL;
    if ((h == NULL) || (h->part->plan->truths < 0) || (operator_number < 0)
        || (operator_number >= h->part->forms[h->part->plan->truths].operators.count)) {
        return -1;
    }
    if ((h->truths == NULL) || !h->truths->started || h->is_blind || m->spoilt) {
        return 0;
    }
    known = &h->truths->readings[(better && h->truths->parted) ? 1 : 0]
                 .nodes[operator_number].known[value ? 1 : 0];
    *found = (known->at != NULL) ? &known->at[known->first] : NULL;
    return known->end - known->first;
}

/* Moves of attempts between locations: how often, and when first. Automata are shared by all
 * requirements of one shape, but each judge has its own counts. */

static bool is_traced(const home *h, int32_t index)
{
    return (h->part->judges[index].flags & JUDGE_TRACED) != 0;
}

static int32_t pairs_of(const home *h, int32_t index)
{
    const int32_t locations = h->part->machines[index].locations;
    return locations * locations;
}

/* Reset the counts of moves; false: memory is short. */
bool begin_moves(home *h)
{
    const int32_t judges = h->part->plan->judges.count;
    arena *a = &h->monitor->memory;
    int32_t i;
    if (h->moves == NULL) {
        h->moves = arena_take(a, (size_t)judges * sizeof *h->moves);
    }
    for (i = 0; (h->moves != NULL) && (i < judges); i++) {
        const size_t size = is_traced(h, i) ? (size_t)pairs_of(h, i) * sizeof(rv_hit) : 0;
        if (is_traced(h, i) && (h->moves[i] == NULL)) {
            h->moves[i] = arena_take(a, size);
            if (h->moves[i] == NULL) {
                return false;
            }
        }
        if (is_traced(h, i)) {
            (void)memset(h->moves[i], 0, size);
        }
    }
    return h->moves != NULL;
}

void count_move(const machine *a, rv_hit *moves, int32_t from, int32_t to, int64_t count, int64_t t)
{
    rv_hit *one = &moves[from * a->locations + to];
    one->first = ((one->count == 0) || (t < one->first)) ? t : one->first;
    one->count += count;
}

/* Count the start of an attempt at `t`, on the diagonal of the initial location. */
void count_begin(run *r, int32_t index, int64_t t)
{
    const machine *a = &r->part->machines[index];
    rv_hit *moves = moves_of(r, index);
    if (moves != NULL) {
        count_move(a, moves, a->initial, a->initial, 1, t);
    }
}

const rv_hit *rv_moves(const rv_monitor *m, int32_t requirement, int32_t *locations)
{
    int32_t i;
    int32_t k;
    *locations = 0;
    for (i = 0; i < m->plan.part_count; i++) {
        const home *h = &m->homes[i];
        for (k = 0; (h->moves != NULL) && (k < h->part->plan->requirements); k++) {
            if ((h->part->judges[k].requirement == requirement) && (h->moves[k] != NULL)) {
                *locations = h->part->machines[k].locations;
                return h->moves[k];
            }
        }
    }
    return NULL;
}
