/* The state of a run relative to an instant, as words: two runs with equal words behave the same from
 * there on. A search for example runs uses them to recognise states that it has explored. So instants
 * become distances from `now`; all past instants, and all ages beyond the last bound that matters, become
 * equal; and attempts in equal states become one, in any order. */
#include "results/results.h"
#include "runs/runs.h"
#include "windows/windows.h"

#include <string.h>

/* The most words of an attempt: flags, and the location and clocks of both readings. */
#define PIECE_MOST (3 + 2 * CLOCKS_MOST)

void put_word(situation *s, int64_t word)
{
    if (s->count < s->room) {
        s->words[s->count] = word;
    }
    s->count++;
}

/* An instant as a distance ahead; all past instants are the same. */
static void put_ahead(situation *s, int64_t t)
{
    put_word(s, (t == NEVER) ? NEVER : ((t <= s->now) ? -1 : t - s->now));
}

void put_bytes(situation *s, const uint8_t *bytes, int32_t count)
{
    int32_t i;
    int32_t k;
    for (i = 0; i < count; i += 8) {
        uint64_t word = 0;
        for (k = i; (k < count) && (k < i + 8); k++) {
            word = word << 8 | bytes[k];
        }
        put_word(s, (int64_t)(word & UINT64_C(0x7fffffffffffffff)));
    }
}

static void put_number(situation *s, const rv_number *number)
{
    int64_t bits;
    (void)memcpy(&bits, &number->as, sizeof bits);
    put_word(s, number->kind);
    put_word(s, (number->kind == RV_UNKNOWN) ? 0 : bits);
}

static void put_edge(situation *s, const edge *e)
{
    put_ahead(s, e->at);
    put_word(s, (e->left ? 1 : 0) + (e->right ? 2 : 0));
}

static void put_stretches(situation *s, const stretches *own)
{
    int32_t i;
    for (i = 0; i < own->count; i++) {
        const stretch *one = &own->at[(own->head + i) & (own->room - 1)];
        if (one->end >= s->now) {
            put_ahead(s, one->begin);
            put_ahead(s, one->end);
        }
    }
    put_word(s, (own->left ? 1 : 0) + (own->right ? 2 : 0) + (own->growing ? 4 : 0));
}

/* The members of a window; for an unbounded window, their sum. */
static void put_window(situation *s, const node_plan *n, const stretches *own, const tally *x)
{
    int32_t i;
    for (i = 0; i < own->count; i++) {
        const stretch *one = &own->at[(own->head + i) & (own->room - 1)];
        const stretch *value = &own[1].at[(own[1].head + i) & (own[1].room - 1)];
        put_word(s, (n->high < NEVER) ? one->begin - s->now : 0);
        put_word(s, (n->high < NEVER) ? one->end - s->now : ((n->most > 0) ? one->end - one->begin : 0));
        put_word(s, value->begin);
        put_word(s, value->end);
    }
    put_word(s, own->growing ? 1 : 0);
    put_word(s, own[1].lost);
    for (i = 0; (n->high == NEVER) && (i < 2); i++) {
        put_word(s, own[i].total);
        put_word(s, own->lost);
    }
    for (i = 0; (x != NULL) && (n->high == NEVER) && (i < TALLY_LIMBS); i++) {
        put_word(s, x->limb[i]);
    }
}

/* The truths and memory of the nodes. */
static void put_formulas(situation *s, const run *r)
{
    const part_plan *p = r->part->plan;
    const int64_t gap = GAP(r);
    int32_t i;
    if (gap > 1) { /* distance to the next tick */
        put_word(s, s->now - floored(s->now, gap) * gap);
        put_ahead(s, r->at.awaited);
    }
    if ((gap == 0) && (p->edges + p->stretches > 0)) { /* past operators refer to the last sample */
        put_word(s, s->now - last_position(r->home->monitor));
    }
    put_word(s, (r->at.started ? 1 : 0) + 2 * r->at.phase + 4 * r->at.starting);
    put_bytes(s, r->truth, p->nodes.count);
    put_bytes(s, r->atom, p->atoms.count);
    put_bytes(s, r->seen, p->seen);
    put_bytes(s, r->births, p->signals.count);
    for (i = 0; i < p->timers + p->perishable; i++) {
        put_ahead(s, r->wake.due[i]);
    }
    for (i = 0; i < p->nodes.count; i++) {
        const node_plan *n = &r->part->nodes[i];
        if (n->op == NODE_EDGE) {
            const edge *worse = &r->edges[2 * n->slot];
            put_edge(s, worse);
            if (worse->apart) {
                put_edge(s, worse + 1);
            }
        } else if (n->op == NODE_STRETCH) {
            const stretches *worse = &r->past[2 * n->slot];
            put_stretches(s, worse);
            if (worse->apart) {
                put_stretches(s, worse + 1);
            }
        } else if (n->op == NODE_WINDOW) {
            put_window(s, n, &r->past[2 * n->slot], (n->sum < 0) ? NULL : &r->tallies[n->sum]);
        } else {
            /* Its memory is in `seen`, or it has none. */
        }
    }
    for (i = 0; i < p->signals.count; i++) {
        const history *own = &r->history[i];
        if ((r->part->signals[i].flags & SIGNAL_HISTORY) != 0) {
            put_word(s, own->updates);
            put_number(s, &own->last);
            put_number(s, &own->before);
            put_word(s, (own->updates > 0) ? own->at - s->now : 0);
            put_word(s, (own->updates > 1) ? own->before_at - own->at : 0);
        }
    }
}

/* Location and ages of an attempt in one reading; all ages beyond the last cut are the same. */
static void put_token(situation *s, const machine *a, int32_t location, const int64_t *clocks)
{
    int32_t c;
    put_word(s, location);
    for (c = 0; c < a->clocks; c++) {
        const int32_t at = location * a->clocks + c;
        const int32_t cuts = (c < a->widths[location]) ? a->cut_first[at + 1] - a->cut_first[at] : 0;
        const int64_t last = (cuts > 0) ? a->cuts[a->cut_first[at + 1] - 1] : 0;
        put_word(s, (cuts > 0) ? least(s->now - clocks[c], last) : 0);
    }
}

static void note_next_cut(situation *s, const machine *a, int32_t location, int64_t *clocks)
{
    token k;
    if (location > PASSED) {
        k.location = location;
        k.clocks = clocks;
        k.moves = NULL;
        s->next = least(s->next, next_cut(a, &k, s->now, NULL));
    }
}

static void put_attempt(situation *s, const run *r, int32_t index, attempt *x)
{
    const int32_t width = r->part->plan->clocks;
    put_word(s, (x->sure ? 1 : 0) + (x->trigger_unknown ? 2 : 0) + (x->cannot_pass ? 4 : 0) + (x->parted ? 8 : 0));
    if (is_networked(r, index)) {
        put_word(s, x->location);
        put_word(s, x->parted ? x->better : x->location);
        put_word(s, (GAP(r) > 0) ? x->clocks[0] - floored(s->now, step_of(r))
                            : x->clocks[0] - r->judges[index].net->readings[0].last);
    } else {
        const machine *a = &r->part->machines[index];
        put_token(s, a, x->location, x->clocks);
        put_token(s, a, x->parted ? x->better : x->location, x->clocks + (x->parted ? width : 0));
        note_next_cut(s, a, x->location, x->clocks);
        if (x->parted) {
            note_next_cut(s, a, x->better, x->clocks + width);
        }
    }
}

static int32_t order_of_words(const int64_t *one, const int64_t *other, int64_t width)
{
    int64_t i;
    for (i = 0; i < width; i++) {
        if (one[i] != other[i]) {
            return (one[i] < other[i]) ? -1 : 1;
        }
    }
    return 0;
}

/* Sort the records of `width` words from `start` on, drop duplicates, and append the number left, as
 * attempts in equal states are one. Insertion sort, as there are few. */
static void sort_unique(situation *s, int64_t start, int64_t width)
{
    int64_t held[PIECE_MOST];
    int64_t *records = s->words + start;
    int64_t end = s->count - start;
    int64_t kept = 0;
    int64_t i;
    if (s->count > s->room) {
        put_word(s, 0); /* the words were only counted, not written */
        return;
    }
    for (i = 0; i < end; i += width) {
        int64_t at = kept;
        while ((at > 0) && (order_of_words(records + at - width, records + i, width) > 0)) {
            at -= width;
        }
        if ((at == 0) || (order_of_words(records + at - width, records + i, width) < 0)) {
            (void)memcpy(held, records + i, (size_t)width * sizeof *held);
            (void)memmove(records + at + width, records + at, (size_t)(kept - at) * sizeof *records);
            (void)memcpy(records + at, held, (size_t)width * sizeof *held);
            kept += width;
        }
    }
    s->count = start + kept;
    put_word(s, kept);
}

/* The state of a judge and its attempts. */
static void put_judge(situation *s, run *r, int32_t index)
{
    judge *j = &r->judges[index];
    queue_place place = {0, 0, 0};
    attempt *x;
    const bool networked = is_networked(r, index);
    const int64_t width = networked ? 4 : 1 + 2 * (1 + (int64_t)r->part->machines[index].clocks);
    int64_t start;
    int32_t at;
    put_word(s, j->before + (j->running ? 4 : 0) + ((j->failed_at < NEVER) ? 8 : 0) + ((j->undecidable >= 0) ? 16 : 0)
               + (j->blind ? 32 : 0) + ((j->failed > 0U) ? 64 : 0) + ((j->passed > 0U) ? 128 : 0));
    if (networked && (j->net != NULL) && j->net->started
        && ((j->first >= 0) || needs_every_position(r, index))) {
        judging g = judging_of(r, index);
        learn_all(&g, s->now, last_at(&g, s->now));
        judge_added(&g, s->now);
        put_networks(s, r, index);
        s->next = least(s->next, (j->first >= 0) ? earliest(&g, s->now + 1) : NEVER);
    }
    start = s->count;
    for (at = j->first; at >= 0; at = attempt_at(r->home, at)->next) {
        put_attempt(s, r, index, attempt_at(r->home, at));
    }
    for (x = next_queued(r, index, &place, j->position); x != NULL;
         x = next_queued(r, index, &place, j->position)) {
        put_attempt(s, r, index, x);
    }
    sort_unique(s, start, width);
}

/* With a clock: the inputs that may be captured at the next tick. */
static void put_captured(situation *s, const run *r)
{
    int32_t i;
    int32_t k;
    for (i = 0; i < r->part->plan->signals.count; i++) {
        if ((r->part->signals[i].flags & SIGNAL_CAPTURED) != 0) {
            put_number(s, &r->value[i]);
        }
    }
    for (i = 0; i < r->part->plan->events.count; i++) {
        const int32_t fields = r->part->events[i].fields;
        const occurrences *own = &r->payloads[i];
        put_word(s, own->count);
        for (k = 0; k < own->count * fields; k++) {
            put_number(s, &own->fields[k]);
        }
    }
}

static void put_run(situation *s, run *r)
{
    const part_plan *p = r->part->plan;
    int32_t i;
    if (p->captured > 0) {
        put_word(s, r->starters + 256 * (int64_t)r->judging + (r->opening ? 1 << 20 : 0) + (r->doubted ? 1 << 21 : 0));
        put_ahead(s, r->opens_at);
        put_ahead(s, r->cut);
        for (i = 0; i < p->captured; i++) {
            put_number(s, &r->captured[i]);
        }
        if ((GAP(r) > 1) && (r->parent == NULL)) { /* the run of an attempt captures nothing itself */
            put_captured(s, r);
        }
    }
    put_formulas(s, r);
    s->next = least(s->next, next_position(r));
    for (i = 0; i < p->judges.count; i++) {
        put_judge(s, r, i);
    }
}

/* Stored samples, which replay would read. */
static void put_past(situation *s, const home *h)
{
    int32_t i;
    int32_t k;
    for (i = 0; i < h->past_count; i++) {
        const past_update *u = &h->past[i];
        const int32_t fields = (u->event && (u->fields != NULL)) ? h->part->events[u->local].fields : 0;
        put_word(s, u->t - s->now);
        put_word(s, u->local * 16 + u->says * 4 + (u->event ? 2 : 0) + (u->last ? 1 : 0));
        put_number(s, &u->value);
        for (k = 0; k < fields; k++) {
            put_number(s, &u->fields[k]);
        }
    }
    put_word(s, h->past_count);
}

static bool has_chain(const home *h)
{
    int32_t i;
    for (i = 0; i < h->part->plan->judges.count; i++) {
        if (is_chained(h->root, i)) {
            return true;
        }
    }
    return false;
}

int64_t rv_situation(rv_monitor *m, int64_t now, int64_t *words, int64_t room, int64_t *next)
{
    situation s;
    int32_t i;
    run *one;
    s.words = words;
    s.room = room;
    s.count = 0;
    s.now = now;
    s.next = NEVER;
    *next = NEVER;
    if (m->finished || m->spoilt || (m->last == RV_NO_TIME) || (now < m->last) || (now >= LIMIT)
        || (m->dense_until != RV_NO_TIME)) {
        return -1;
    }
    for (i = 0; i < m->plan.part_count; i++) {
        home *h = &m->homes[i];
        if (has_chain(h)) {
            return -1;
        }
        home_come_to(h, now);
        for (one = h->root; one != NULL; one = following(h, one)) {
            put_run(&s, one);
        }
        put_past(&s, h);
        put_word(&s, (h->failed > 0U ? 1 : 0) + (h->passed > 0U ? 2 : 0));
    }
    *next = s.next;
    return m->spoilt ? -1 : s.count;
}
