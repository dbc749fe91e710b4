/* What is kept beside what becomes of attempts, in a snapshot: where formulas are known, what was hit,
 * where attempts went, what went stale. */
#include "snapshot/snapshot.h"

/* How often something was, and when first. */
static void carry_hit(carrier *c, int64_t *count, int64_t *first)
{
    carry_long(c, count, 0, LIMIT);
    if (*count > 0) {
        carry_instant(c, first);
    }
}

void carry_stale(carrier *c, rv_monitor *m)
{
    int32_t i;
    for (i = 0; (i < m->plan.header->signals) && !is_lost(c); i++) {
        carry_hit(c, &m->stale[i].count, &m->stale[i].first);
    }
}

/* The items of a group that stand, which are some of its own. */
static void carry_group(carrier *c, home *h, int32_t number)
{
    covering *own = h->covering;
    const bool last = number == h->part->plan->groups.count - 1;
    const int32_t first = h->part->groups[number].first;
    const int32_t behind = last ? own->items : h->part->groups[number + 1].first;
    covered *s = &own->groups[number];
    int32_t i;
    carry_byte(c, &s->before, IS_TRUE);
    carry_size(c, &s->current, (int64_t)behind - first, 4);
    for (i = 0; (i < s->current) && !is_lost(c); i++) {
        int32_t *item = &own->current_items[first + i];
        carry_int(c, item, first, behind);
        if (c->reading && !c->refused) {
            demand(c, own->stands[*item] == 0U);
            own->stands[*item] = 1;
        }
    }
}

static void carry_cover(carrier *c, home *h)
{
    covering *own = h->covering;
    const part_plan *p = h->part->plan;
    int32_t i;
    for (i = 0; (i < own->items) && !is_lost(c); i++) {
        carry_hit(c, &own->hits[i].count, &own->hits[i].first);
    }
    for (i = 0; (i < p->groups.count) && !is_lost(c); i++) {
        carry_group(c, h, i);
    }
    carry_list(c, own->called, &own->called_count, p->watches.count, own->is_called);
}

static void carry_moves(carrier *c, home *h)
{
    int32_t i;
    int32_t k;
    for (i = 0; i < h->part->plan->judges.count; i++) {
        const int32_t locations = (h->moves[i] != NULL) ? h->part->machines[i].locations : 0;
        for (k = 0; (k < locations * locations) && !is_lost(c); k++) {
            carry_hit(c, &h->moves[i][k].count, &h->moves[i][k].first);
        }
    }
}

void carry_watch(carrier *c, home *h)
{
    if (h->part->plan->truths >= 0) {
        const form f = form_at(h->root, h->part->plan->truths);
        carry_networks(c, &f, &h->truths);
        carry_flag(c, &h->is_blind);
    }
    if (h->covering != NULL) {
        carry_cover(c, h);
    }
    if (h->moves != NULL) {
        carry_moves(c, h);
    }
}
