/* Sliding windows, and shifts by a constant number of positions.
 *
 * A window keeps the values that can be its extreme in a wedge, the best one first, each with the last
 * position whose window contains it: amortised O(1) per change, whatever the length of the window.
 *
 * Source: Lemire 2006. */
#include "margins/margins.h"

/* A step of a window. */
typedef struct {
    gauging *w;
    margin_node *o;
    margin_edge *edge;
    const margin_steps *from;
    int32_t place;
    bool every;
    bool closes;               /* whether the value after the end is still to be read */
    double nothing;            /* the value of an empty window */
    int64_t low;
    int64_t high;
} windowing;

static int64_t exit_of(const margin_steps *wedge)
{
    return step_at(wedge, wedge->first)->at;
}

static inline void drop_exits(margin_steps *wedge, int64_t position)
{
    while ((wedge->first < wedge->end) && (exit_of(wedge) < position)) {
        wedge->first++;
    }
}

/* Emit the values of windows up to a position. */
static void emit_windows(const windowing *x, int64_t stop)
{
    margin_node *o = x->o;
    margin_steps *wedge = &o->wedge;
    int64_t at = o->next;
    while (at <= stop) {
        double best = x->nothing;
        int64_t right = stop;
        drop_exits(wedge, at);
        if (wedge->first < wedge->end) {
            best = step_at(wedge, wedge->first)->value;
            right = least(exit_of(wedge), stop);
        }
        if (!o->started || (best != o->carried)) {
            o->started = true;
            o->carried = best;
            emit_step(x->w, x->place, at, best);
        }
        at = right + 1;
    }
    o->next = at;
}

/* Add a value to a wedge; `leaves` is the position of the last window that contains it. */
static inline void enter_wedge(const windowing *x, margin_steps *wedge, int64_t leaves, double value)
{
    while (wedge->first < wedge->end) {
        const double last = step_at(wedge, wedge->end - 1)->value;
        if (x->every ? (last < value) : (last > value)) {
            break;
        }
        wedge->end--;
    }
    if (!has_room(wedge, 1)) {
        margin_steps larger = *wedge;
        (void)room_for_steps(x->w, &larger, 1, larger.first);
        *wedge = larger;
    }
    if (has_room(wedge, 1)) {
        add_step(wedge, leaves, value);
    }
}

/* The next step of the operand up to a position; after the end of the trace, an empty value. */
static bool next_entry(windowing *x, int64_t most, margin_step *found)
{
    if (x->edge->read < x->from->end) {
        const margin_step *next = step_at(x->from, x->edge->read);
        found->at = next->at;
        found->value = next->value;
        x->edge->read += (next->at <= most) ? 1 : 0;
        return next->at <= most;
    }
    if (x->closes && (x->w->end->last + 1 <= most)) {
        x->closes = false;
        found->at = x->w->end->last + 1;
        found->value = x->every ? INFINITE : -INFINITE;
        return true;
    }
    return false;
}

/* Slide up to a position, where every integer is a position. */
static void slide_along(windowing *x, int64_t until)
{
    margin_steps *wedge = &x->o->wedge;
    margin_step entry = {0, 0.0};
    while (next_entry(x, until + x->high + 1, &entry)) {
        emit_windows(x, entry.at - x->high - 1);
        if (wedge->first < wedge->end) {
            step_at(wedge, wedge->end - 1)->at = entry.at - x->low - 1;
        }
        enter_wedge(x, wedge, NEVER, entry.value);
    }
    emit_windows(x, until);
}

/* Read the values of the operand up to a position. */
static inline void enter_samples(const windowing *x, margin_steps *wedge, margin_steps *from, int64_t last)
{
    for (; (from->first < from->end) && (step_at(from, from->first)->at <= last); from->first++) {
        const margin_step next = *step_at(from, from->first);
        enter_wedge(x, wedge, next.at - x->low, next.value);
    }
}

/* Slide up to a position, where only samples are positions; works on local copies of the rings, which
 * the compiler knows not to overlap. */
static void slide_over_samples(const windowing *x, int64_t until)
{
    margin_steps stamps = x->w->g->stamps;
    margin_steps from = *x->from;
    margin_steps wedge = x->o->wedge;
    from.first = x->edge->read;
    stamps.first = x->o->positions;
    for (; (stamps.first < stamps.end) && (step_at(&stamps, stamps.first)->at <= until); stamps.first++) {
        const int64_t position = step_at(&stamps, stamps.first)->at;
        enter_samples(x, &wedge, &from, position + x->high);
        drop_exits(&wedge, position);
        emit_step(x->w, x->place, position,
                  (wedge.first < wedge.end) ? step_at(&wedge, wedge.first)->value : x->nothing);
    }
    enter_samples(x, &wedge, &from, until + x->high + 1); /* so that the operand can drop them */
    x->o->wedge = wedge;
    x->o->positions = stamps.first;
    x->edge->read = from.first;
    x->o->next = (x->o->next <= until) ? until + 1 : x->o->next;
}

static inline void slide_window(windowing *x, int64_t until)
{
    if (x->w->sparse) {
        slide_over_samples(x, until);
    } else {
        slide_along(x, until);
    }
}

/* Windows that extend beyond the end of the trace have the value assumed for the rest. */
static void give_up(windowing *x)
{
    x->nothing = margin_beyond(x->w->end, false);
    x->o->wedge.first = x->o->wedge.end;
    x->closes = false;
    x->edge->read = x->from->end;
}

/* Emit the remaining values of windows at the end of the trace. */
static void end_windows(windowing *x, int64_t limit, bool ahead)
{
    slide_window(x, least(limit, x->w->end->last));
    if (ahead && (margin_beyond(x->w->end, false) != x->nothing)) {
        give_up(x);
    }
    slide_window(x, x->w->end->last);
}

void gauge_window(gauging *w, int32_t place)
{
    const operator_plan *n = node_plan_of(w, place);
    margin_node *nodes = w->g->nodes;
    const int64_t limit = (n->over < 0) ? w->now : floored(w->reached - n->over, w->step);
    const bool holds = n->low <= n->high; /* else all windows are empty */
    const bool every = n->turned != 0;
    windowing x = {w, &nodes[place], &w->g->edges[w->shape->places[place].edge], &nodes[n->left].out, place,
                   every, w->end != NULL, every ? INFINITE : -INFINITE, n->low, n->high};
    if (!holds) {
        x.edge->read = x.from->end;
    }
    if (w->end != NULL) {
        end_windows(&x, limit, n->over >= 0);
    } else {
        slide_window(&x, holds ? least(limit, nodes[n->left].known - n->high) : limit);
    }
    x.o->known = x.o->next - 1;
}

/* A step of a shift: the steps of the operand, then those after the end of the trace. */
typedef struct {
    const margin_steps *from;
    margin_edge *edge;
    int64_t offset;
    margin_step ends[2];
    int32_t ends_first;
    int32_t ends_count;
} shifting;

static bool next_moved(const shifting *x, margin_step *found)
{
    if (x->edge->read < x->from->end) {
        *found = *step_at(x->from, x->edge->read);
        found->at -= x->offset;
        return true;
    }
    if (x->ends_first < x->ends_count) {
        *found = x->ends[x->ends_first];
        return true;
    }
    return false;
}

static void take_moved(shifting *x)
{
    if (x->edge->read < x->from->end) {
        x->edge->read++;
    } else {
        x->ends_first++;
    }
}

/* The assumed steps of the operand after the end: `kept` up to where its windows have opened. */
static void add_ends(const gauging *w, shifting *x, const operator_plan *n)
{
    const bool kept = n->kept != 0;
    const int64_t opened = floored(w->end->instant - n->over, w->step);
    const bool by_rule = w->end->rest == REST_END;
    if (w->sparse) {
        if (by_rule) {
            x->ends[0].at = opened;
            x->ends[0].value = margin_beyond(w->end, kept);
        }
        x->ends[by_rule ? 1 : 0].at = LIMIT;
        x->ends[by_rule ? 1 : 0].value = by_rule ? -INFINITE : margin_beyond(w->end, false);
    } else {
        x->ends[0].at = w->end->last - x->offset + 1;
        x->ends[0].value = margin_beyond(w->end, kept);
        x->ends[1].at = opened + 1;
        x->ends[1].value = -INFINITE;
    }
    x->ends_count = by_rule ? 2 : 1;
}

/* Shift where every integer is a position. */
static void move_all(gauging *w, int32_t place, shifting *x, int64_t until, double before)
{
    margin_node *o = &w->g->nodes[place];
    const int64_t first = w->g->first;
    margin_step one = {first, before};
    bool some = !o->started && (x->offset < 0);
    if (until < first) {
        return;
    }
    o->started = true;
    if (!some && next_moved(x, &one) && (one.at <= until)) {
        take_moved(x);
        some = true;
    }
    while (some) {
        margin_step next = {0, 0.0};
        const bool follows = next_moved(x, &next) && (next.at <= until);
        const int64_t right = follows ? next.at - 1 : until;
        const int64_t at = (one.at < first) ? first : one.at;
        if (at <= right) {
            emit_step(w, place, at, one.value);
        }
        if (follows) {
            take_moved(x);
        }
        one = next;
        some = follows;
    }
    o->joined = until;
}

/* Shift where only samples are positions: an `until` takes the value of the next one, a `since` that of
 * the last. */
static void move_samples(gauging *w, int32_t place, shifting *x, int64_t known, double before)
{
    margin_node *o = &w->g->nodes[place];
    const margin_steps *stamps = &w->g->stamps;
    const bool ahead = x->offset > 0;
    int64_t until = known;
    margin_step one = {0, 0.0};
    if (!o->started) {
        o->started = true;
        o->carried = before;
    }
    if (ahead && (x->ends_count > 0)) {
        until = x->ends[x->ends_count - 1].at;
    } else if (ahead && (x->from->end > x->edge->read)) {
        until = step_at(x->from, x->from->end - 1)->at - x->offset;
    } else {
        /* It is known as far as its operand is. */
    }
    until = least(until, w->now);
    while ((o->positions < stamps->end) && (step_at(stamps, o->positions)->at <= until)) {
        const int64_t position = step_at(stamps, o->positions)->at;
        o->positions++;
        while (next_moved(x, &one) && (ahead ? (one.at < position) : (one.at <= position))) {
            o->carried = one.value;
            take_moved(x);
        }
        emit_step(w, place, position, ahead ? one.value : o->carried);
    }
    o->joined = until;
}

/* Shift an `until` or `since` by the lower bound of its window. */
void gauge_shift(gauging *w, int32_t place)
{
    const operator_plan *n = node_plan_of(w, place);
    const double nothing = (node_plan_of(w, n->left)->turned != 0) ? INFINITE : -INFINITE;
    const double before = w->g->after_gap ? bound_of_anything(w) : nothing;
    const int64_t known = (w->end != NULL) ? LIMIT : w->g->nodes[n->left].known - n->low;
    shifting x = {&w->g->nodes[n->left].out, &w->g->edges[w->shape->places[place].edge], n->low,
                {{0, 0.0}, {0, 0.0}}, 0, 0};
    if ((w->end != NULL) && (x.offset > 0)) {
        add_ends(w, &x, n);
    }
    if (w->sparse) {
        move_samples(w, place, &x, known, before);
    } else {
        move_all(w, place, &x, least(known, w->now), before);
    }
    w->g->nodes[place].known = w->g->nodes[place].joined;
}
