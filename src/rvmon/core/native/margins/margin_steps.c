/* Functions of positions as steps in rings, and the stretches of an `until`, each of which clamps the
 * value of the next. */
#include "margins/margins.h"

#include <string.h>

/* Make room for more steps, keeping those from the number `oldest` on; false if memory is short. */
bool room_for_steps(gauging *w, margin_steps *s, int64_t count, int64_t oldest)
{
    rv_monitor *m = w->monitor;
    margin_step *made;
    int64_t room = (s->room > 0) ? s->room : 8;
    int64_t i;
    if (has_room(s, count)) {
        return true;
    }
    s->first = oldest;
    while (room / 2 < s->end - s->first + count - 1) {
        room *= 2; /* doubling, so that a step is moved a constant number of times */
    }
    if (room <= s->room) {
        return true;
    }
    made = (room < INT32_MAX / 4) ? arena_take(&m->memory, (size_t)room * sizeof *made) : NULL;
    if (made == NULL) {
        m->spoilt = true;
        s->first = s->end;
        return has_room(s, count);
    }
    for (i = s->first; i < s->end; i++) {
        made[i & (room - 1)] = *step_at(s, i);
    }
    arena_give(&m->memory, s->ring, (size_t)s->room * sizeof *made);
    s->ring = made;
    s->room = (int32_t)room;
    return true;
}

/* The first step of a node that a reader has not taken, or that no reader needs. */
int64_t oldest_unread(const gauging *w, int32_t place)
{
    const margin_shape *shape = w->shape;
    int64_t found = w->g->nodes[place].out.end;
    int32_t i;
    for (i = 0; i < shape->edges; i++) {
        if (shape->operands[i] == place) {
            found = least(found, w->g->edges[i].read);
        }
    }
    return (place == shape->count - 1) ? least(found, w->g->read) : found;
}

/* Whether no reader of a node has read its last step. */
static bool is_last_unread(const gauging *w, int32_t place)
{
    const margin_shape *shape = w->shape;
    const int64_t last = w->g->nodes[place].out.end - 1;
    int32_t i;
    for (i = 0; i < shape->edges; i++) {
        if ((shape->operands[i] == place) && (w->g->edges[i].read > last)) {
            return false;
        }
    }
    return true;
}

/* Whether any position from `left` to `right` is asked. */
bool is_requested(const gauging *w, int64_t left, int64_t right)
{
    const measuring *q = w->q;
    int64_t low = q->requests.first;
    int64_t high = q->requests.end;
    while (low < high) {
        const int64_t middle = low + (high - low) / 2;
        if (step_at(&q->requests, middle)->at < left) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return (low < q->requests.end) && (step_at(&q->requests, low)->at <= right);
}

/* Whether a step has to be added to a node, and there is room for it. If only the values at asked
 * positions matter and the last step covers none, that step takes the new value instead. */
bool takes_step(gauging *w, int32_t place, int64_t at, double value)
{
    margin_steps *s = &w->g->nodes[place].out;
    if (is_thin(w, place) && (place < w->shape->count - 1) && (s->end > s->first)
        && is_last_unread(w, place) && !is_requested(w, step_at(s, s->end - 1)->at, at - 1)) {
        step_at(s, s->end - 1)->value = value;
        return false;
    }
    return has_room(s, 1) || room_for_steps(w, s, 1, oldest_unread(w, place));
}

/* The number of the first position without a value of some operator, or that was not reported. */
static int64_t oldest_position(const gauging *w)
{
    int64_t found = w->g->stamps.end;
    int32_t i;
    if (!w->thin) {
        found = least(found, w->q->reported);
    }
    for (i = 0; w->sparse && (i < w->shape->count); i++) {
        const int32_t kind = w->shape->nodes[i].kind;
        if ((kind == OP_WINDOW) || (kind == OP_SHIFT) || ((kind == OP_UNTIL) && !is_thin(w, i))) {
            found = least(found, w->g->nodes[i].positions);
        }
    }
    return found;
}

/* Add positions: all samples where only these are positions, else asked ones. */
void note_positions(gauging *w, const int64_t *times, int64_t count)
{
    margin_steps *s = &w->g->stamps;
    if (has_room(s, count) || room_for_steps(w, s, count, oldest_position(w))) {
        add_steps(s, times, count, NULL);
    }
}

bool steps_copy(rv_monitor *m, margin_steps *made, const margin_steps *s)
{
    int64_t i;
    if (made->room < s->room) {
        margin_step *ring = arena_take(&m->memory, (size_t)s->room * sizeof *ring);
        if (ring == NULL) {
            m->spoilt = true;
            return false;
        }
        arena_give(&m->memory, made->ring, (size_t)made->room * sizeof *ring);
        made->ring = ring;
        made->room = s->room;
    }
    made->first = s->first;
    made->end = s->end;
    for (i = s->first; i < s->end; i++) {
        *step_at(made, i) = *step_at(s, i);
    }
    return true;
}

/* ---- stretches of an `until`, U(i) = max(meets(i), min(stays(i), U(i + 1))), or a dual */

static void join_bounds(margin_part *made, const margin_part *before, const margin_part *after)
{
    made->low = within(after->low, before->least, before->most);
    made->high = within(after->high, before->least, before->most);
}

/* Compute the clamps of several stretches together: before `middle` from each to the middle, after it
 * from the middle to each. */
static void halve(margin_parts *s, int32_t middle)
{
    int32_t i;
    s->middle = middle;
    for (i = middle - 1; i >= s->begin; i--) {
        margin_part *one = &s->at[i];
        one->low = one->least;
        one->high = one->most;
        if (i < middle - 1) {
            join_bounds(one, one, &s->at[i + 1]);
        }
    }
    for (i = middle; i < s->end; i++) {
        margin_part *one = &s->at[i];
        one->low = one->least;
        one->high = one->most;
        if (i > middle) {
            const margin_part *before = &s->at[i - 1];
            one->low = within(one->least, before->low, before->high);
            one->high = within(one->most, before->low, before->high);
        }
    }
}

static bool room_for_part(rv_monitor *m, margin_parts *s)
{
    margin_part *made;
    const int32_t count = s->end - s->begin;
    if (s->end < s->room) {
        return true;
    }
    if ((s->begin > 0) && (count <= s->room / 2)) {
        (void)memmove(s->at, &s->at[s->begin], (size_t)count * sizeof *s->at);
    } else {
        made = enlarged(m, s->at, &s->room, (int64_t)s->room + 1, sizeof *made);
        if (made == NULL) {
            return false;
        }
        s->at = made;
        (void)memmove(s->at, &s->at[s->begin], (size_t)count * sizeof *s->at);
    }
    s->middle -= s->begin;
    s->begin = 0;
    s->end = count;
    return true;
}

static void parts_push(rv_monitor *m, margin_parts *s, int64_t first, double low, double high)
{
    margin_part *made;
    if (!room_for_part(m, s)) {
        return;
    }
    made = &s->at[s->end];
    made->first = first;
    made->least = made->low = low;
    made->most = made->high = high;
    if (s->end > s->middle) {
        const margin_part *before = &s->at[s->end - 1];
        made->low = within(low, before->low, before->high);
        made->high = within(high, before->low, before->high);
    }
    s->end++;
}

/* Drop the last stretch; amortised O(1), as in a queue of two stacks. */
static void parts_pop(margin_parts *s)
{
    if (s->end == s->middle) {
        halve(s, s->begin + (s->end - s->begin) / 2);
    }
    s->end--;
}

/* Drop the first stretch; likewise. */
void parts_leave(margin_parts *s)
{
    if (s->begin == s->middle) {
        halve(s, s->begin + (s->end - s->begin + 1) / 2);
    }
    s->begin++;
}

/* Whether the value of the first stretch is final: whatever follows is clamped to one value. */
bool parts_settled(const margin_parts *s, double *value)
{
    const margin_part *front;
    const margin_part *back;
    double low;
    double high;
    if (s->begin == s->end) {
        return false;
    }
    front = &s->at[s->begin];
    back = &s->at[s->end - 1];
    low = (s->end > s->middle) ? back->low : front->low;
    high = (s->end > s->middle) ? back->high : front->high;
    if ((s->begin < s->middle) && (s->end > s->middle)) {
        low = within(low, front->low, front->high);
        high = within(high, front->low, front->high);
    }
    *value = low;
    return low == high;
}

/* Append a stretch. A stretch whose clamp does not narrow the next one is joined to it, so that of
 * `always` and `eventually` only the extremes remain. If `alone`, only values at asked positions matter,
 * and a stretch without any is joined to the one before. */
void parts_follow(gauging *w, margin_parts *s, int64_t start, double low, double high, bool alone)
{
    int64_t first = start;
    while (s->end > s->begin) {
        const margin_part last = s->at[s->end - 1];
        const bool leads_on = (within(low, last.least, last.most) == low)
                              && (within(high, last.least, last.most) == high);
        if (!leads_on && (!alone || is_requested(w, last.first, first - 1))) {
            break;
        }
        parts_pop(s);
        if (leads_on || (s->end == s->begin)) {
            first = last.first;
        } else {
            const margin_part before = s->at[s->end - 1];
            parts_pop(s);
            parts_push(w->monitor, s, before.first, within(last.least, before.least, before.most),
                       within(last.most, before.least, before.most));
        }
    }
    parts_push(w->monitor, s, first, low, high);
}

bool parts_copy(rv_monitor *m, margin_parts *made, const margin_parts *s)
{
    const int32_t count = s->end - s->begin;
    margin_part *at = enlarged(m, made->at, &made->room, count, sizeof *at);
    if ((at == NULL) && (count > 0)) {
        return false;
    }
    made->at = at;
    if (count > 0) {
        (void)memcpy(at, &s->at[s->begin], (size_t)count * sizeof *at);
    }
    made->begin = 0;
    made->middle = s->middle - s->begin;
    made->end = count;
    return true;
}
