/* Operations on a whole network: reset, copy, compare, prune, describe for rv_situation(); and sets of
 * positions as ranges. */
#include "basics.h"
#include "networks/network.h"
#include "results/results.h"

#include <string.h>

/* Start at a position, whose letter is not read yet. */
void reset_network(const form *f, network *w, int64_t t, int64_t position)
{
    int32_t i;
    for (i = 0; i < f->form->operators.count; i++) {
        const operator_plan *n = &f->nodes[i];
        operator_state *o = &w->nodes[i];
        ranges_empty(&o->known[0]);
        ranges_empty(&o->known[1]);
        o->base = position;
        if (n->kind == OP_SINCE) { /* before the first position a `since` is false, its dual true */
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
    }
    ranges_copy(f->monitor, &made->samples, &w->samples);
    made->oldest = w->oldest;
    made->first = w->first;
    made->last = w->last;
    made->now = w->now;
    made->closed = w->closed;
}

/* Whether two networks know the same, so that one reading is enough from here on. */
bool networks_agree(const form *f, const network *one, const network *other)
{
    bool found = true;
    int32_t i;
    for (i = 0; found && (i < f->form->operators.count); i++) {
        const operator_state *a = &one->nodes[i];
        const operator_state *b = &other->nodes[i];
        found = (a->base == b->base) && ranges_alike(&a->known[0], &b->known[0])
                && ranges_alike(&a->known[1], &b->known[1]);
    }
    return found;
}

/* The first position at or after another at which a node has no known value. Ranges of the two values
 * alternate, so they are skipped in turn. */
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

/* Note that a parent needs positions from here on. */
static void want(operator_state *o, int64_t position)
{
    o->wanted = least(o->wanted, position);
}

/* Drop positions that are not needed, given that open attempts are at or after `position`. From the root
 * down, each node says from which position on it needs its operands: from its `base`, the first position
 * that it does not know itself, moved by its window. */
void prune(const form *f, network *w, int64_t position)
{
    int64_t first = position;
    int32_t i;
    int32_t j;
    for (i = 0; i < f->form->operators.count; i++) {
        w->nodes[i].wanted = LIMIT;
    }
    want(&w->nodes[f->form->operators.count - 1], position);
    for (i = f->form->operators.count - 1; i >= 0; i--) {
        const operator_plan *n = &f->nodes[i];
        operator_state *o = &w->nodes[i];
        int64_t kept = o->wanted;
        if (n->kind == OP_SINCE) { /* it needs its own last value to continue */
            o->base = open_from(o, o->base);
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
            want(&w->nodes[n->left], o->base);
            want(&w->nodes[n->right], o->base);
            break;
        }
    }
    while ((w->oldest < first - 1) && (w->samples.end - w->samples.first > 1)) {
        w->samples.first++;
        w->oldest++;
    }
}

/* Write what the networks of a judge know, and what may still be queried, relative to now: equal words
 * mean equal decisions from here on. */
void put_networks(situation *s, run *r, int32_t index)
{
    const form f = form_of(r, index);
    judge *j = &r->judges[index];
    const int64_t ref = (f.gap > 0) ? floored(s->now, f.step) : j->net->readings[0].last;
    const int64_t oldest = (j->first >= 0) ? position_of(attempt_at(r->home, j->first)) : ref + 1;
    int32_t i;
    int32_t k;
    int32_t value;
    int32_t reading;
    put_bytes(s, j->net->leaf, f.form->leaves);
    for (reading = 0; reading < (j->net->parted ? 2 : 1); reading++) {
        network *w = &j->net->readings[reading];
        prune(&f, w, oldest);
        for (i = 0; i < f.form->operators.count; i++) {
            const operator_state *o = &w->nodes[i];
            const bool since = f.nodes[i].kind == OP_SINCE;
            const int64_t from = since ? least(o->wanted, o->base - 1) : o->wanted;
            put_word(s, o->base - ref);
            for (value = 0; value < 2; value++) {
                const ranges *known = &o->known[value];
                for (k = known->first; k < known->end; k++) {
                    const range *one = &known->at[k];
                    if (one->last >= from) {
                        put_word(s, ((one->first > from) ? one->first : from) - ref);
                        put_word(s, one->last - ref);
                    }
                }
                put_word(s, NEVER);
            }
        }
        for (k = w->samples.first; k < w->samples.end; k++) {
            put_word(s, w->samples.at[k].last - s->now);
        }
    }
}

/* ---- sets of positions: ranges, sorted, with gaps between them; those before `first` were dropped */

/* The index of the first range that ends at or after a position; `end`: none. */
int32_t range_from(const ranges *r, int64_t position)
{
    int32_t low = r->first;
    int32_t left = r->end - low;
    if ((left == 0) || (r->at[low].last >= position)) {
        return low;
    }
    if ((left > 1) && (r->at[r->end - 2].last < position)) { /* the usual case: the last range */
        low = r->end - 1;
        left = 1;
    }
    while (left > 1) { /* a conditional move: a branch here would be mispredicted half the time */
        const int32_t half = left / 2;
        low += (r->at[low + half - 1].last < position) ? half : 0;
        left -= half;
    }
    return low + ((r->at[low].last < position) ? 1 : 0);
}

/* The index of the range that holds a position; -1: none. */
int32_t range_around(const ranges *r, int64_t position)
{
    const int32_t i = range_from(r, position);
    return ((i < r->end) && (r->at[i].first <= position)) ? i : -1;
}

/* The last position of the set at or before another; -NEVER: none. */
int64_t last_up_to(const ranges *r, int64_t position)
{
    const int32_t i = range_from(r, position);
    int64_t found = -NEVER;
    if ((i < r->end) && (r->at[i].first <= position)) {
        found = position;
    } else if (i > r->first) {
        found = r->at[i - 1].last;
    } else {
        /* All ranges lie behind it. */
    }
    return found;
}

/* Make room; false: memory is short. */
static bool widen(rv_monitor *m, ranges *r)
{
    range *made = enlarged(m, r->at, &r->room, (int64_t)r->room + 1, sizeof *made);
    if (made == NULL) {
        return false;
    }
    r->at = made;
    return true;
}

/* Open a slot before range `place`; returns its index, which changes if slots of dropped ranges are used;
 * -1: memory is short. The ranges before it move if they are fewer and there is room, as a network mostly
 * learns near one end. */
static int32_t opened(rv_monitor *m, ranges *r, int32_t place)
{
    int32_t i = place;
    if ((r->first > 0) && (place - r->first < r->end - place)) {
        r->first--;
        (void)memmove(&r->at[r->first], &r->at[r->first + 1], (size_t)(place - 1 - r->first) * sizeof *r->at);
        return place - 1;
    }
    if (r->end == r->room) {
        if (r->first > r->room / 2) {
            (void)memmove(r->at, &r->at[r->first], (size_t)(r->end - r->first) * sizeof *r->at);
            i -= r->first;
            r->end -= r->first;
            r->first = 0;
        } else if (!widen(m, r)) {
            return -1;
        } else {
            /* Widened. */
        }
    }
    if (i < r->end) {
        (void)memmove(&r->at[i + 1], &r->at[i], (size_t)(r->end - i) * sizeof *r->at);
    }
    r->end++;
    return i;
}

void ranges_put(rv_monitor *m, ranges *r, int32_t place, int64_t first, int64_t last)
{
    const bool appends = (place == r->end) && (place < r->room); /* the usual case: append */
    const int32_t i = appends ? place : opened(m, r, place);
    r->end += appends ? 1 : 0;
    if (i >= 0) {
        r->at[i].first = first;
        r->at[i].last = last;
    }
}

/* Remove a range; the ranges before it or after it move, whichever are fewer. */
static void take_out(ranges *r, int32_t i)
{
    if (i - r->first < r->end - i) {
        (void)memmove(&r->at[r->first + 1], &r->at[r->first], (size_t)(i - r->first) * sizeof *r->at);
        r->first++;
    } else {
        (void)memmove(&r->at[i], &r->at[i + 1], (size_t)(r->end - i - 1) * sizeof *r->at);
        r->end--;
    }
}

/* Add positions that are in no range, merged with neighbours; `i` is the first range after them. */
void ranges_insert(rv_monitor *m, ranges *r, int32_t i, int64_t first, int64_t last)
{
    const bool left = (i > r->first) && (r->at[i - 1].last + 1 == first);
    const bool right = (i < r->end) && (last + 1 == r->at[i].first);
    if (left && right) {
        r->at[i - 1].last = r->at[i].last;
        take_out(r, i);
    } else if (left) {
        r->at[i - 1].last = last;
    } else if (right) {
        r->at[i].first = first;
    } else {
        ranges_put(m, r, i, first, last);
    }
}

/* Remove positions, all of which are in one range. */
void ranges_cut(rv_monitor *m, ranges *r, int64_t first, int64_t last)
{
    const int32_t i = range_around(r, first);
    if (i < 0) {
        return; /* they were never added: memory was short */
    }
    if (r->at[i].first == first) {
        if (r->at[i].last == last) {
            take_out(r, i);
        } else {
            r->at[i].first = last + 1;
        }
    } else {
        const int64_t end = r->at[i].last;
        r->at[i].last = first - 1;
        if (last < end) {
            ranges_put(m, r, i + 1, last + 1, end);
        }
    }
}

/* Drop the ranges that end before a position. */
void ranges_drop(ranges *r, int64_t before)
{
    while ((r->first < r->end) && (r->at[r->first].last < before)) {
        r->first++;
    }
    if (r->first == r->end) {
        r->first = 0;
        r->end = 0;
    }
}

void ranges_empty(ranges *r)
{
    r->first = 0;
    r->end = 0;
}

void ranges_copy(rv_monitor *m, ranges *made, const ranges *r)
{
    int32_t i;
    ranges_empty(made);
    for (i = r->first; i < r->end; i++) {
        ranges_put(m, made, made->end, r->at[i].first, r->at[i].last);
    }
}

bool ranges_alike(const ranges *one, const ranges *other)
{
    const int32_t count = one->end - one->first;
    bool same_ones = count == other->end - other->first;
    int32_t i;
    for (i = 0; same_ones && (i < count); i++) {
        const range *a = &one->at[one->first + i];
        const range *b = &other->at[other->first + i];
        same_ones = (a->first == b->first) && (a->last == b->last);
    }
    return same_ones;
}
