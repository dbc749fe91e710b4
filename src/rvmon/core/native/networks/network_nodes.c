/* Nodes of a delay network (network.h): one update function per operator, and the step over all.
 *
 * Operators come in dual pairs, distinguished by `turned`, which is set for `and`, G, and the dual of
 * `until`. So `turned ^ 1` is the value that one operand, or one position of a window, decides alone,
 * and `turned` is the value that needs all of them.
 *
 * An update function is called once per step, operands first, and has to add exactly the ranges that
 * this step makes known: from the ranges added to the operands and, if time or new positions matter,
 * from the stretch between `was_now` and `now`, or `was_last` and `last`. add_known() skips ranges that
 * were already known. */
#include "networks/network.h"

/* The instant of a clock's position, clamped to +-LIMIT. */
static int64_t ticks_of(int64_t position, int64_t step)
{
    const int64_t most = positions_within(step);
    return (position >= most) ? LIMIT : ((position <= -most) ? -LIMIT : position * step);
}

/* The instant of a position. That of a sample is looked up; each position after the last sample is one
 * tick later, the earliest possible; that of a dropped sample is -LIMIT. */
int64_t instant_of(const form *f, const network *w, int64_t position)
{
    int64_t t = -LIMIT;
    if (f->gap > 0) {
        t = (f->step == 1) ? position : ticks_of(position, f->step);
    } else if (position > w->last) {
        t = moved(w->samples.at[w->samples.end - 1].last, position - w->last);
    } else if (position >= w->oldest) {
        t = w->samples.at[w->samples.first + (int32_t)(position - w->oldest)].last;
    } else {
        /* Dropped: -LIMIT. */
    }
    return t;
}

/* The last position at or before an instant. */
int64_t position_by(const form *f, const network *w, int64_t t)
{
    if (f->gap > 0) {
        return floored(t, f->step);
    }
    return w->oldest + (range_from(&w->samples, t + 1) - w->samples.first) - 1;
}

/* The first position at least `distance` after another (before it if negative), in ticks, or in positions
 * of a clock. up_to(): the last position at most that far after it. */
int64_t from_on(const form *f, const network *w, int64_t position, int64_t distance)
{
    return (f->gap > 0) ? moved(position, distance)
                     : position_by(f, w, moved(instant_of(f, w, position), distance) - 1) + 1;
}

int64_t up_to(const form *f, const network *w, int64_t position, int64_t distance)
{
    return (f->gap > 0) ? moved(position, distance)
                     : position_by(f, w, moved(instant_of(f, w, position), distance));
}

/* Whether a node is known to have a value at a position. */
bool knows(const operator_state *o, uint8_t value, int64_t position)
{
    return range_around(&o->known[value], position) >= 0;
}

/* Add [first, last] to the positions at which a node is known to have a value, and to those added in
 * this step, except for positions that are already known or that no attempt needs (before `base`). */
void add_known(const form *f, operator_state *o, uint8_t value, int64_t first, int64_t last)
{
    ranges *known = &o->known[value];
    ranges *added = &o->added[value];
    int64_t at = (first > o->base) ? first : o->base;
    if ((at <= last) && (known->first < known->end) && (known->at[known->end - 1].last + 1 == at)) {
        known->at[known->end - 1].last = last; /* the usual case: extend the last range */
        ranges_put(f->monitor, added, added->end, at, last);
        return;
    }
    while (at <= last) {
        const int32_t i = range_from(known, at);
        int64_t end = last;
        if ((i < known->end) && (known->at[i].first <= at)) {
            at = known->at[i].last + 1;
            continue;
        }
        if (i < known->end) {
            end = least(last, known->at[i].first - 1);
        }
        ranges_insert(f->monitor, known, i, at, end);
        ranges_put(f->monitor, added, added->end, at, end);
        at = end + 1;
    }
}

/* Add the positions of a range at which all operands of a junction have a value. */
static void add_where_all(const form *f, const network *w, const operator_plan *n, operator_state *o,
                          uint8_t value, const range *on)
{
    const int32_t *operands = LIST(f->plan, n->operands);
    int64_t at = on->first;
    while (at <= on->last) {
        int64_t end = on->last;
        bool all = true;
        int32_t i;
        for (i = 0; all && (i < n->operands.count); i++) {
            const ranges *known = &w->nodes[operands[i]].known[value];
            const int32_t found = range_from(known, at);
            all = (found < known->end) && (known->at[found].first <= at);
            if (all) {
                end = least(end, known->at[found].last);
            } else {
                end = (found < known->end) ? known->at[found].first - 1 : on->last;
            }
        }
        if (all) {
            add_known(f, o, value, at, end);
        }
        at = end + 1;
    }
}

/* JUNCTION: `and`, `or` of any number of operands. */
static void update_junction(const form *f, const network *w, const operator_plan *n, operator_state *o)
{
    const int32_t *operands = LIST(f->plan, n->operands);
    const uint8_t some = (uint8_t)(n->turned ^ 1);
    int32_t i;
    int32_t j;
    for (i = 0; i < n->operands.count; i++) {
        const ranges *added = &w->nodes[operands[i]].added[some];
        for (j = added->first; j < added->end; j++) {
            add_known(f, o, some, added->at[j].first, added->at[j].last);
        }
    }
    for (i = 0; i < n->operands.count; i++) {
        const ranges *added = &w->nodes[operands[i]].added[n->turned];
        for (j = added->first; j < added->end; j++) {
            add_where_all(f, w, n, o, (uint8_t)n->turned, &added->at[j]);
        }
    }
}

/* Add the positions in [first, last] whose window has one of the positions `found`, at which the
 * operand has the value that decides alone. */
static void add_windows_with(const form *f, const network *w, const operator_plan *n,
                             operator_state *o, const range *found, int64_t first, int64_t last)
{
    const uint8_t some = (uint8_t)(n->turned ^ 1);
    /* low > high: no tick of the clock lies in the window, so no window has a found position. */
    int64_t position = (n->low <= n->high) ? found->first : found->last + 1;
    /* Samples may be further apart than a window is wide; then some positions are in no window. */
    const int64_t step = (f->gap > 0) ? found->last - found->first + 1 : 1;
    while (position <= found->last) {
        const int64_t start = from_on(f, w, position, -n->high);
        add_known(f, o, some, (start > first) ? start : first,
             least(up_to(f, w, position + step - 1, -n->low), last));
        position += step;
    }
}

/* Add the positions in [begin, last] in whose complete window the operand has, at all positions, the
 * value that needs all; an empty window counts. Goes from window to window, or jumps over the windows
 * that contain a position without the value. */
static void add_windows_filled(const form *f, const network *w, const operator_plan *n,
                               operator_state *o, int64_t begin, int64_t last)
{
    const ranges *known = &w->nodes[n->left].known[n->turned];
    int64_t at = (begin > o->base) ? begin : o->base;
    while (at <= last) {
        int64_t first = from_on(f, w, at, n->low);
        const int64_t end = least(up_to(f, w, at, n->high), w->last);
        int64_t until = at;
        bool all = true;
        first = (first > w->first) ? first : w->first;
        if (first > end) {
            if (f->gap > 0) {
                until = (end < w->first) ? w->first - 1 - n->high : last;
            }
        } else {
            int32_t i = range_from(known, first);
            const bool started = (i < known->end) && (known->at[i].first <= first);
            all = started && (known->at[i].last >= end);
            if (all) {
                until = (known->at[i].last >= w->last)
                    ? last : up_to(f, w, known->at[i].last + 1, -n->high - 1);
            } else if ((f->gap > 0) || ((n->low <= 0) && (n->high >= 0))) {
                /* No window is empty: go to the first one that starts after the unknown positions. */
                i += started ? 1 : 0;
                until = from_on(f, w, (i < known->end) ? known->at[i].first - 1 : w->last,
                                1 - n->low) - 1;
            } else {
                /* Windows between samples may be empty: try the next one. */
            }
        }
        if (all) {
            add_known(f, o, (uint8_t)n->turned, at, least(until, last));
        }
        at = ((until > at) ? until : at) + 1;
    }
}

/* WINDOW: F or G over [low, high], of the future (`over` >= 0: ticks until it is complete) or the past.
 * `front` is the last position whose window is complete now, `before` that at the last step. */
static void update_window(const form *f, const network *w, const operator_plan *n, operator_state *o)
{
    const operator_state *operand = &w->nodes[n->left];
    const ranges *added = &operand->added[(uint8_t)(n->turned ^ 1)];
    const bool past = n->over < 0;
    const int64_t front = past ? w->last : position_by(f, w, w->now - n->over);
    const int64_t before = past ? w->was_last : position_by(f, w, w->was_now - n->over);
    int32_t i;
    for (i = added->first; i < added->end; i++) {
        add_windows_with(f, w, n, o, &added->at[i], w->first, w->last);
    }
    if (past && (w->was_last < w->last)) {
        /* The past: windows of new positions also reach back to what was known before. */
        const ranges *known = &operand->known[(uint8_t)(n->turned ^ 1)];
        const int64_t begin = from_on(f, w, w->was_last + 1, n->low);
        /* There are no positions before the first one, although a `since` below has values there. */
        const int64_t first = (begin > w->first) ? begin : w->first;
        const int64_t last = up_to(f, w, w->last, n->high);
        for (i = range_from(known, first); (i < known->end) && (known->at[i].first <= last); i++) {
            range found = known->at[i];
            found.first = (found.first > first) ? found.first : first;
            found.last = least(found.last, last);
            add_windows_with(f, w, n, o, &found, w->was_last + 1, w->last);
        }
    }
    added = &operand->added[n->turned];
    for (i = added->first; i < added->end; i++) {
        add_windows_filled(f, w, n, o, from_on(f, w, added->at[i].first, -n->high),
                least(up_to(f, w, added->at[i].last, -n->low), before));
    }
    add_windows_filled(f, w, n, o, before + 1, front);
}

/* Add the positions whose shifted position is in `found`. In sampled time the shift goes to the first
 * sample at least `low` ahead, or the last one at least -low back. */
static void add_shifted(const form *f, const network *w, const operator_plan *n, operator_state *o,
                        uint8_t value, const range *found)
{
    if (n->low >= 0) {
        add_known(f, o, value, from_on(f, w, found->first - 1, 1 - n->low),
                  up_to(f, w, found->last, -n->low));
    } else {
        const bool ends = (f->gap == 0) && (found->last >= w->last);
        add_known(f, o, value, from_on(f, w, found->first, -n->low),
             ends ? w->last : least(w->last, up_to(f, w, found->last + 1, -n->low - 1)));
    }
}

/* SHIFT: the operand at a distance ahead, or back. A position beyond the end of the trace counts as TRUE
 * if `kept`. */
static void update_shift(const form *f, const network *w, const operator_plan *n, operator_state *o)
{
    const operator_state *operand = &w->nodes[n->left];
    uint8_t value;
    int32_t i;
    for (value = 0; value < 2U; value++) {
        const ranges *added = &operand->added[value];
        for (i = added->first; i < added->end; i++) {
            add_shifted(f, w, n, o, value, &added->at[i]);
        }
        if ((n->low < 0) && (w->was_last < w->last)) {
            const ranges *known = &operand->known[value];
            const int64_t last = up_to(f, w, w->last, n->low);
            i = range_from(known, up_to(f, w, w->was_last + 1, n->low));
            for (; (i < known->end) && (known->at[i].first <= last); i++) {
                add_shifted(f, w, n, o, value, &known->at[i]);
            }
        }
    }
    if ((w->closed < NEVER) && (n->kept != 0)) {
        add_known(f, o, 1U, from_on(f, w, w->last, 1 - n->low),
             least(w->last, position_by(f, w, w->closed - n->over)));
    }
}

/* One step of a reading: time comes to `now`, and letters are known for positions up to `last`. The
 * letter is `leaf` for positions before `turn`, and `next_leaf` from there on. */
void learn(const form *f, networks *net, int32_t reading, int64_t now, int64_t last)
{
    network *w = &net->readings[reading];
    int32_t i;
    w->was_now = w->now;
    w->was_last = w->last;
    w->now = (now > w->now) ? now : w->now;
    w->last = (last > w->last) ? last : w->last;
    for (i = 0; i < f->form->operators.count; i++) {
        const operator_plan *n = &f->nodes[i];
        operator_state *o = &w->nodes[i];
        ranges_empty(&o->added[0]);
        ranges_empty(&o->added[1]);
        switch (n->kind) {
        case OP_LEAF:
            add_known(f, o, (uint8_t)((net->leaf[n->left] >> reading) & 1), w->was_last + 1,
                 least(w->last, net->turn - 1));
            add_known(f, o, (uint8_t)((net->next_leaf[n->left] >> reading) & 1),
                 (net->turn > w->was_last) ? net->turn : w->was_last + 1, w->last);
            break;
        case OP_JUNCTION: update_junction(f, w, n, o); break;
        case OP_WINDOW: update_window(f, w, n, o); break;
        case OP_SHIFT: update_shift(f, w, n, o); break;
        case OP_UNTIL: update_until(f, w, n, o); break;
        default: update_since(f, w, n, o); break;
        }
    }
}

/* Undo the last step by removing the ranges that it added. Only one step can be undone. */
void unlearn(const form *f, network *w)
{
    int32_t i;
    int32_t j;
    uint8_t value;
    for (i = 0; i < f->form->operators.count; i++) {
        operator_state *o = &w->nodes[i];
        for (value = 0; value < 2U; value++) {
            for (j = o->added[value].first; j < o->added[value].end; j++) {
                ranges_cut(f->monitor, &o->known[value], o->added[value].at[j].first,
                           o->added[value].at[j].last);
            }
            ranges_empty(&o->added[value]);
        }
    }
    w->now = w->was_now;
    w->last = w->was_last;
}
