/* Networks and chains of windows in a snapshot: what is known of formulas. What a step was that may be
 * taken back is not carried: none is between two calls. */
#include "snapshot/snapshot.h"
#include "windows/windows.h"

/* Ranges in ascending order; none ends behind `most`. */
static void carry_ranges(carrier *c, ranges *x, int64_t most)
{
    int32_t count = x->end - x->first;
    int64_t before = -NEVER;
    int32_t i;
    carry_size(c, &count, MOST, 16);
    for (i = 0; (i < count) && !is_lost(c); i++) {
        range one = {0, 0};
        if (!c->reading) {
            one = x->at[x->first + i];
        }
        carry_long(c, &one.first, -LIMIT, LIMIT);
        carry_long(c, &one.last, one.first, most);
        demand(c, one.first > before);
        if (c->reading && !c->refused) {
            ranges_put(c->m, x, x->end, one.first, one.last);
        }
        before = one.last;
    }
}

/* The instants of samples. */
static void carry_samples(carrier *c, ranges *x)
{
    int32_t count = x->end - x->first;
    int64_t before = -LIMIT;
    int32_t i;
    carry_size(c, &count, MOST, 8);
    for (i = 0; (i < count) && !is_lost(c); i++) {
        int64_t t = c->reading ? 0 : x->at[x->first + i].first;
        carry_instant(c, &t);
        demand(c, t > before);
        if (c->reading && !c->refused) {
            ranges_put(c->m, x, x->end, t, t);
        }
        before = t;
    }
}

/* What is known of a formula by one reading. Where positions are samples they count from 0, and none
 * from the oldest one that is kept on is missing. */
static void carry_network(carrier *c, const form *f, network *w)
{
    const bool sparse = f->gap == 0;
    const int64_t most = positions_within(f->step) - 1;
    int32_t i;
    int32_t value;
    carry_instant(c, &w->now);
    carry_long(c, &w->first, sparse ? 0 : -most, sparse ? 0 : most);
    carry_long(c, &w->last, sparse ? 0 : -most, most);
    carry_long(c, &w->oldest, sparse ? 0 : -most, most);
    carry_samples(c, &w->samples);
    if (sparse) {
        demand(c, (int64_t)w->samples.end - w->samples.first == w->last - w->oldest + 1);
        demand(c, w->samples.end > w->samples.first);
    }
    for (i = 0; (i < f->form->operators.count) && !is_lost(c); i++) {
        operator_state *o = &w->nodes[i];
        carry_long(c, &o->base, sparse ? w->oldest : -LIMIT, sparse ? w->last + 1 : most);
        carry_long(c, &o->swept, sparse ? 0 : -LIMIT, sparse ? w->last + 1 : most);
        for (value = 0; value < 2; value++) {
            carry_ranges(c, &o->known[value], sparse ? w->last : LIMIT);
        }
    }
    w->closed = c->reading ? NEVER : w->closed;
}

void carry_networks(carrier *c, const form *f, networks **own)
{
    networks *net = *own;
    bool begun = (net != NULL) && net->begun;
    int32_t i;
    carry_flag(c, &begun);
    if (!begun || c->refused) {
        return;
    }
    if (c->reading) {
        net = made_networks(f);
        *own = net;
        if (net == NULL) {
            return;
        }
        net->begun = true;
    }
    carry_bytes(c, net->leaf, f->form->leaves, 3);
    carry_int(c, &net->visits, 0, MOST / 2);
    carry_flag(c, &net->parted);
    for (i = 0; (i < (net->parted ? 2 : 1)) && !is_lost(c); i++) {
        carry_network(c, f, &net->readings[i]);
    }
    demand(c, !net->parted || (net->readings[0].last == net->readings[1].last));
}

/* Positions at which a value changes, in ascending order. */
static void carry_changes(carrier *c, changes *x)
{
    int32_t count = x->count;
    int64_t before = -LIMIT;
    int32_t i;
    carry_flag(c, &x->begun);
    carry_size(c, &count, MOST, 8);
    for (i = 0; (i < count) && !is_lost(c); i++) {
        int64_t one = c->reading ? 0 : change_at(x, i);
        carry_long(c, &one, before, LIMIT);
        if (c->reading && !c->refused) {
            add_change(c->m, x, one);
        }
        before = one;
    }
}

void carry_chain(carrier *c, run *r, int32_t index)
{
    const chaining g = chaining_of(r, index);
    chain *own = g.c;
    bool begun = (own != NULL) && own->begun;
    int32_t i;
    int32_t level;
    carry_flag(c, &begun);
    if (!begun || c->refused) {
        return;
    }
    if (c->reading) {
        own = made_chain(&g);
        g.j->chain = own;
        if (own == NULL) {
            return;
        }
        own->begun = true;
    }
    carry_bytes(c, own->letter, FOLLOWED, 3);
    carry_int(c, &own->kept, 0, MOST / 2);
    carry_flag(c, &own->parted);
    if (g.sparse) {
        carry_changes(c, &own->stamps);
        demand(c, own->stamps.count > 0);
    }
    for (i = 0; (i < (own->parted ? 2 : 1)) && !is_lost(c); i++) {
        chain_reading *w = &own->readings[i];
        for (level = 0; level <= g.depth; level++) {
            carry_changes(c, &w->levels[level]);
        }
        carry_changes(c, &w->ends);
        carry_changes(c, &w->excused);
        carry_long(c, &w->start, -LIMIT, LIMIT);
    }
}
