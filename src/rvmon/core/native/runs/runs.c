/* Creating, resetting and forking runs. The arrays of a run lie in one block, so forking an instance or
 * an attempt is one memcpy, plus copies of the arrays that grow: occurrences and the rings of past
 * operators. Released runs are reused. */
#include "formulas/formulas.h"
#include "input/input.h"
#include "networks/network.h"
#include "notes/notes.h"
#include "runs/runs.h"

#include <string.h>

#define ALIGNED(size) (((size) + 15U) & ~(size_t)15U)

/* Cuts arrays out of a block; without a block it only adds up their sizes. */
typedef struct {
    char *block;
    size_t used;
} cutter;

static void *piece(cutter *c, int64_t count, size_t each)
{
    void *made = (c->block != NULL) ? c->block + c->used : NULL;
    c->used += ALIGNED((size_t)count * each);
    return made;
}

static void cut_timers(cutter *c, timers *h, int32_t ids)
{
    h->due = piece(c, ids, sizeof *h->due);
    h->ids = piece(c, ids, sizeof *h->ids);
    h->place = piece(c, ids, sizeof *h->place);
}

/* Place the arrays of a run in its block: first those that a fork copies, whose size is returned;
 * then those that it does not, since they own other memory or belong to attempts. */
static size_t cut_block(cutter *c, run *r)
{
    const part_plan *p = r->part->plan;
    const int32_t signals = p->signals.count;
    const int32_t events = p->events.count;
    const int32_t names = signals + events;
    const int32_t atoms = p->atoms.count;
    const int32_t judges = p->judges.count;
    const int32_t words = (p->nodes.count + 63) / 64;
    size_t copied;
    r->captured = piece(c, p->captured, sizeof *r->captured);
    if (p->captured == 0) { /* else they are with those of other runs (widen_values) */
        r->value = piece(c, signals, sizeof *r->value);
        r->spans = piece(c, signals, sizeof *r->spans);
    }
    r->history = piece(c, signals, sizeof *r->history);
    r->edges = piece(c, 2 * (int64_t)p->edges, sizeof *r->edges);
    r->tallies = piece(c, p->sums, sizeof *r->tallies);
    r->amounts = piece(c, p->amounts, sizeof *r->amounts);
    cut_timers(c, &r->wake, p->timers + p->perishable);
    r->dirty = piece(c, words, sizeof *r->dirty);
    r->dirty_words = piece(c, (words + 63) / 64, sizeof *r->dirty_words);
    r->fading = piece(c, atoms, sizeof *r->fading);
    r->fresh = piece(c, atoms, sizeof *r->fresh);
    r->marks = piece(c, names, sizeof *r->marks);
    r->marked = piece(c, names, 1);
    r->truth = piece(c, p->nodes.count, 1);
    r->atom = piece(c, atoms, 1);
    r->momentary = piece(c, atoms, 1);
    r->is_fading = piece(c, atoms, 1);
    r->is_fresh = piece(c, atoms, 1);
    r->births = piece(c, signals, 1);
    r->updated = piece(c, names, 1);
    r->changed = piece(c, signals, 1);
    r->occurs = piece(c, events, 1);
    r->silent = piece(c, events, 1);
    r->absent = piece(c, names, 1);
    r->seen = piece(c, p->seen, 1);
    r->lost = piece(c, names_to_lose(r), 1);
    r->until = piece(c, names_to_lose(r), sizeof *r->until);
    r->kept = piece(c, names_to_lose(r), sizeof *r->kept);
    r->has_kept = piece(c, names_to_lose(r), 1);
    r->keeps = piece(c, names_to_lose(r), 1);
    copied = c->used;
    r->payloads = piece(c, events, sizeof *r->payloads);
    r->chosen = piece(c, events, sizeof *r->chosen);
    r->past = piece(c, 2 * (int64_t)p->stretches, sizeof *r->past);
    r->judges = piece(c, judges, sizeof *r->judges);
    cut_timers(c, &r->rules, judges);
    r->touched = piece(c, judges, sizeof *r->touched);
    r->restless = piece(c, judges, sizeof *r->restless);
    r->repeating = piece(c, judges, sizeof *r->repeating);
    r->failing = piece(c, judges, sizeof *r->failing);
    r->due_rules = piece(c, judges, sizeof *r->due_rules);
    return copied;
}

/* A run with its arrays, all zero and not yet reset; NULL: memory is short. */
run *new_run(home *h)
{
    rv_monitor *m = h->monitor;
    cutter c = {NULL, 0};
    run *made = arena_take(&m->memory, sizeof *made);
    if (made == NULL) {
        m->spoilt = true;
        return NULL;
    }
    made->home = h;
    made->part = h->part;
    made->all = &m->plan;
    made->gap = m->plan.header->gap;
    (void)cut_block(&c, made);
    c.block = arena_take(&m->memory, c.used);
    if (c.block == NULL) {
        m->spoilt = true;
        return NULL;
    }
    made->block = c.block;
    c.used = 0;
    made->copied = cut_block(&c, made);
    /* Registered last: after a reset, a registered run is given samples even if it lacks memory. */
    if ((m->keeps_notes && !make_notes(made)) || !margins_make(made) || !register_run(h, made)) {
        m->spoilt = true;
        return NULL;
    }
    return made;
}

/* Copy what is allocated outside the block: occurrences and the rings of past operators. The copied rings
 * start at 0, and their hash tables of distinct members are rebuilt when needed. False: memory is
 * short. */
static bool copy_grown(run *made, const run *r)
{
    rv_monitor *m = r->home->monitor;
    const part_plan *p = r->part->plan;
    int32_t i;
    int32_t j;
    for (i = 0; i < p->events.count; i++) {
        const occurrences *from = &r->payloads[i];
        occurrences *to = &made->payloads[i];
        const int32_t width = (r->part->events[i].fields > 0) ? r->part->events[i].fields : 1;
        if (to->room < from->count) {
            int32_t room = to->room;
            int32_t same = to->room;
            uint8_t *known = enlarged(m, to->known, &room, from->count, 1);
            rv_number *fields;
            if (known == NULL) {
                return false;
            }
            to->known = known;
            fields = enlarged(m, to->fields, &same, room, sizeof *fields * (size_t)width);
            if (fields == NULL) {
                return false;
            }
            to->fields = fields;
            to->room = room;
        }
        to->count = from->count;
        if (from->count > 0) {
            (void)memcpy(to->known, from->known, (size_t)from->count);
            (void)memcpy(to->fields, from->fields,
                         (size_t)from->count * (size_t)width * sizeof *to->fields);
        }
    }
    for (i = 0; i < 2 * p->stretches; i++) {
        const stretches *from = &r->past[i];
        stretches *to = &made->past[i];
        if (to->room < from->room) {
            stretch *at = arena_take(&m->memory, (size_t)from->room * sizeof *at);
            if (at == NULL) {
                m->spoilt = true;
                return false;
            }
            arena_give(&m->memory, to->at, (size_t)to->room * sizeof *at);
            to->at = at;
            to->room = from->room;
        }
        to->head = 0;
        to->count = from->count;
        for (j = 0; j < from->count; j++) {
            to->at[j] = from->at[(from->head + j) & (from->room - 1)];
        }
        to->left = from->left;
        to->right = from->right;
        to->growing = from->growing;
        to->apart = from->apart;
        to->total = from->total;
        to->lost = from->lost;
        to->members = from->members;
        to->known_slots = -1;
    }
    return true;
}

/* Reset a run to before its first sample. */
void clear_run(run *r)
{
    const part_plan *p = r->part->plan;
    int32_t i;
    (void)memset(&r->at, 0, sizeof r->at);
    r->at.alarm = -LIMIT;
    r->at.after = -LIMIT;
    r->at.awaited = NEVER;
    r->at.undetermined_left = p->undetermined;
    r->at.births_left = p->births;
    timers_clear(&r->wake, p->timers + p->perishable);
    (void)memset(r->dirty, 0, (size_t)((p->nodes.count + 63) / 64) * sizeof *r->dirty);
    (void)memset(r->dirty_words, 0,
                 (size_t)(((p->nodes.count + 63) / 64 + 63) / 64) * sizeof *r->dirty_words);
    (void)memset(r->truth, IS_UNKNOWN, (size_t)p->nodes.count);
    (void)memset(r->seen, 0, (size_t)p->seen);
    (void)memset(r->edges, 0, 2 * (size_t)p->edges * sizeof *r->edges);
    (void)memset(r->tallies, 0, (size_t)p->sums * sizeof *r->tallies);
    (void)memset(r->amounts, 0, (size_t)p->amounts * sizeof *r->amounts);
    for (i = 0; i < p->atoms.count; i++) {
        r->atom[i] = IS_UNKNOWN;
        r->momentary[i] = (uint8_t)r->part->atoms[i].momentary;
        r->is_fading[i] = 0;
        r->is_fresh[i] = 0;
    }
    for (i = 0; i < p->signals.count; i++) {
        (void)memset(&r->value[i], 0, sizeof r->value[i]);
        r->spans[i] = NO_SPAN;
        (void)memset(&r->history[i], 0, sizeof r->history[i]);
        r->births[i] = 0;
        r->changed[i] = 0;
    }
    for (i = 0; i < p->signals.count + p->events.count; i++) {
        r->marked[i] = 0;
        r->updated[i] = 0;
        r->absent[i] = 0;
    }
    for (i = 0; i < p->events.count; i++) {
        r->silent[i] = IS_FALSE;
        r->occurs[i] = IS_FALSE;
        r->payloads[i].count = 0;
    }
    for (i = 0; i < 2 * p->stretches; i++) {
        stretches *s = &r->past[i];
        s->head = 0;
        s->count = 0;
        s->left = true;
        s->right = false;
        s->growing = false;
        s->apart = false;
        s->total = 0;
        s->lost = 0;
        s->members = 0;
        s->known_slots = -1;
    }
    clear_losses(r);
    clear_judges(r);
    if (r->truth_log != NULL) {
        reset_truth_log(r, RV_NO_TIME);
        r->truth_log->since = RV_NO_TIME;
    }
}

/* Reset the judges of a run, which then have no attempts. Letters are sums over the truths of nodes and
 * are computed again. The memory of judges (networks, queues, notes) is kept for reuse. */
void clear_judges(run *r)
{
    const part_plan *p = r->part->plan;
    int32_t i;
    int32_t k;
    margins_clear(r);
    timers_clear(&r->rules, p->judges.count);
    r->touched_count = 0;
    r->restless_count = 0;
    r->repeating_count = 0;
    r->failing_count = 0;
    for (i = 0; i < p->judges.count; i++) {
        networks *net = r->judges[i].net;
        chain *windows = r->judges[i].chain;
        queue *line = r->judges[i].queue;
        noting *noted = r->judges[i].noting;
        (void)memset(&r->judges[i], 0, sizeof r->judges[i]);
        r->judges[i].net = net;
        r->judges[i].chain = windows;
        r->judges[i].queue = line;
        r->judges[i].noting = noted;
        clear_noting(r, i);
        clear_queue(&r->judges[i]);
        if (windows != NULL) {
            windows->started = false;
            windows->kept = 0;
        }
        if (net != NULL) {
            net->started = false;
            net->parted = false;
            net->visits = 0;
            net->turn = NEVER;
        }
        r->judges[i].position = -LIMIT;
        r->judges[i].first = -1;
        r->judges[i].last = -1;
        r->judges[i].undecidable = -1;
        r->judges[i].current = -1;
        r->judges[i].failed_at = NEVER;
        r->judges[i].again_at = -LIMIT;
    }
    for (i = 0; i < p->nodes.count; i++) {
        const list links = r->part->nodes[i].links;
        for (k = links.first; k < links.first + links.count; k++) {
            const link_plan *l = &PLAN(r)->links[k];
            if ((l->kind & LINK_LETTER) != 0) {
                r->judges[l->judge].worse += l->worse[r->truth[i]];
                r->judges[l->judge].better += l->better[r->truth[i]];
            }
        }
    }
}

/* A run in the same state as another, but without its attempts; NULL: memory is short. The caller sets
 * which judges may start attempts in it, and links it. */
run *forked(const run *r)
{
    home *h = r->home;
    run *made = h->spare;
    int32_t i;
    if (made != NULL) {
        h->spare = made->next;
        made->is_spare = false;
    } else {
        made = new_run(h);
        if (made == NULL) {
            return NULL;
        }
    }
    (void)memcpy(made->block, r->block, r->copied);
    made->wake.count = r->wake.count;
    made->wake.next = r->wake.next;
    made->at = r->at;
    if (!copy_grown(made, r)) {
        recycle_run(h, made);
        return NULL;
    }
    clear_judges(made);
    if (made->truth_log != NULL) {
        copy_truth_log(made, r);
    }
    made->parent = r->parent;
    made->opens_at = r->opens_at;
    made->occurred = r->occurred;
    made->rank = r->rank;
    made->key = r->key;
    made->judged = r->judged;
    made->starters = r->starters;
    made->judging = r->judging;
    made->doubted = r->doubted;
    made->blurs = r->blurs;
    made->first_child = NULL;
    made->opening = false;
    made->over = r->over || r->at.gathered;
    made->at.gathered = false;
    made->watched = false;
    made->watched_children = 0;
    for (i = 0; i < r->part->plan->signals.count; i++) {
        made->value[i] = r->value[i];
        made->spans[i] = NO_SPAN; /* the fork compares with numbers of its own */
    }
    touch_run(made);
    made->stays_busy = r->stays_busy;
    made->cut = NEVER;
    return made;
}

/* Judge a sample in one run. Does nothing if this sample created the run, which has then taken it. */
void give_sample(run *r, int64_t t, const incoming *in, int32_t count)
{
    const quick_signal *quick;
    int32_t i;
    if (t <= r->at.after) {
        return;
    }
    if ((GAP(r) == 0) && r->at.started) {
        r->at.position = r->home->previous;
    }
    approach(r, t);
    if (r->part->plan->captured > 0) {
        forget_last(r);
    }
    quick = quick_now(r);
    for (i = 0; i < count; i++) {
        if (in[i].event || (quick == NULL) || !take_quickly(r, quick, in[i].local, in[i].update)) {
            take_update(r, t, &in[i]);
        }
    }
    arrive(r, t);
}
