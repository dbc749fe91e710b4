/* A network as a whole: begun, copied, compared, tidied up. */
#include "networks/network.h"
#include "networks/ranges.h"

/* Begin at a position, of which nothing is known yet. */
void start_over(const form *f, network *w, int64_t t, int64_t position)
{
    int32_t i;
    for (i = 0; i < f->form->operators.count; i++) {
        const operator_plan *n = &f->nodes[i];
        operator_state *o = &w->nodes[i];
        ranges_empty(&o->known[0]);
        ranges_empty(&o->known[1]);
        o->base = position;
        o->swept = position;
        if (n->kind == OP_SINCE) { /* before there was a position nothing was met */
            ranges *none = &o->known[n->turned];
            ranges_put(f->monitor, none, 0, -LIMIT, position - 1);
        }
    }
    ranges_empty(&w->samples);
    w->oldest = position;
    w->first = position;
    w->last = position - 1;
    w->now = t;
    w->closed = NEVER;
}

void copy_network(const form *f, network *made, const network *w)
{
    int32_t i;
    int32_t value;
    for (i = 0; i < f->form->operators.count; i++) {
        const operator_state *o = &w->nodes[i];
        for (value = 0; value < 2; value++) {
            ranges_copy(f->monitor, &made->nodes[i].known[value], &o->known[value]);
        }
        made->nodes[i].base = o->base;
        made->nodes[i].swept = o->swept;
    }
    ranges_copy(f->monitor, &made->samples, &w->samples);
    made->oldest = w->oldest;
    made->first = w->first;
    made->last = w->last;
    made->now = w->now;
    made->closed = w->closed;
}

/* Whether two networks know the same. */
bool networks_agree(const form *f, const network *one, const network *other)
{
    bool found = true;
    int32_t i;
    for (i = 0; found && (i < f->form->operators.count); i++) {
        const operator_state *a = &one->nodes[i];
        const operator_state *b = &other->nodes[i];
        found = (a->base == b->base) && (a->swept == b->swept)
                && ranges_alike(&a->known[0], &b->known[0]) && ranges_alike(&a->known[1], &b->known[1]);
    }
    return found;
}

/* The first position from one on of which a node is not known. */
static int64_t open_from(const operator_state *o, int64_t position)
{
    int64_t at = position;
    uint8_t value = 0;
    int32_t without = 0;
    while (without < 2) {
        const int32_t i = range_around(&o->known[value], at);
        without = (i < 0) ? without + 1 : 0;
        at = (i < 0) ? at : o->known[value].at[i].last + 1;
        value ^= 1U;
    }
    return at;
}

/* The first position from one on at which the operands do not only lead on. */
static int64_t leads_to(const network *w, const operator_plan *n, int64_t position)
{
    const ranges *stays = &w->nodes[n->left].known[n->turned ^ 1];
    const ranges *unmet = &w->nodes[n->right].known[n->turned];
    int64_t at = position;
    for (;;) {
        const int32_t i = range_around(stays, at);
        const int32_t j = range_around(unmet, at);
        if ((i < 0) || (j < 0)) {
            break;
        }
        at = least(stays->at[i].last, unmet->at[j].last) + 1;
    }
    return at;
}

static void want(operator_state *o, int64_t position)
{
    o->wanted = least(o->wanted, position);
}

/* Drop what nobody can ask for: attempts wait from `position` on. */
void tidy(const form *f, network *w, int64_t position)
{
    int64_t first = position;
    int32_t i;
    int32_t j;
    for (i = 0; i < f->form->operators.count; i++) {
        w->nodes[i].wanted = NEVER;
    }
    want(&w->nodes[f->form->operators.count - 1], position);
    for (i = f->form->operators.count - 1; i >= 0; i--) {
        const operator_plan *n = &f->nodes[i];
        operator_state *o = &w->nodes[i];
        int64_t kept = o->wanted;
        if (n->kind == OP_SINCE) { /* what it was leads on, wanted or not */
            o->base = open_from(o, o->base);
            o->swept = o->base;
            kept = least(kept, o->base - 1);
        } else {
            o->base = open_from(o, (o->wanted > o->base) ? o->wanted : o->base);
        }
        ranges_drop(&o->known[0], kept);
        ranges_drop(&o->known[1], kept);
        first = least(first, kept);
        switch (n->kind) {
        case OP_LEAF: break;
        case OP_JUNCTION:
            for (j = 0; j < n->operands.count; j++) {
                want(&w->nodes[LIST(f->plan, n->operands)[j]], o->base);
            }
            break;
        case OP_WINDOW: want(&w->nodes[n->left], from_on(f, w, o->base, n->low)); break;
        case OP_SHIFT:
            want(&w->nodes[n->left], (n->low >= 0) ? from_on(f, w, o->base, n->low)
                                                   : up_to(f, w, o->base, n->low));
            break;
        default:
            if (n->kind == OP_UNTIL) {
                o->swept = leads_to(w, n, (o->swept > o->base) ? o->swept : o->base);
            }
            want(&w->nodes[n->left], o->swept);
            want(&w->nodes[n->right], o->swept);
            break;
        }
    }
    while ((w->oldest < first - 1) && (w->samples.end - w->samples.first > 1)) {
        w->samples.first++;
        w->oldest++;
    }
}

