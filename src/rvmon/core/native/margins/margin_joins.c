/* Operators that combine values of their operands: `and`, `or`, `since`, `until`.
 *
 * A node holds a step function of positions, known up to one of them. Where only samples are positions,
 * each sample has a step of its own.
 *
 * Source: SEMANTICS 5; Fainekos and Pappas 2009; Donze, Ferrere and Maler 2013. */
#include "margins/margins.h"

/* The bounds to which a sweep (`since`, `until`) clamps the value of its neighbour. */
static margin_range bounds_of(const operator_plan *n, const margin_edge *edges)
{
    const double stays = edges[0].value;
    const double meets = edges[1].value;
    margin_range made;
    made.low = (n->turned != 0) ? fmin(stays, meets) : meets;
    made.high = (n->turned != 0) ? meets : fmax(stays, meets);
    return made;
}

/* Emit a value if it changed. */
static inline void emit_change(gauging *w, int32_t place, int64_t at, double value)
{
    margin_node *o = &w->g->nodes[place];
    if (w->sparse || !o->started || (value != o->carried)) {
        o->started = true;
        o->carried = value;
        emit_step(w, place, at, value);
    }
}

static inline double joined(bool every, double a, double b)
{
    return (every ? (b < a) : (b > a)) ? b : a;
}

static inline void emit_junction(gauging *w, int32_t place, int64_t at)
{
    const margin_place *shape = &w->shape->places[place];
    const margin_edge *edges = &w->g->edges[shape->edge];
    const bool every = node_plan_of(w, place)->turned != 0;
    double value = edges[0].value;
    int32_t i;
    for (i = 1; i < shape->edge_count; i++) {
        value = joined(every, value, edges[i].value);
    }
    emit_change(w, place, at, value);
}

/* S(i) = max(meets(i), min(stays(i), S(i - 1))), or its dual. */
static inline void emit_since(gauging *w, int32_t place, int64_t at)
{
    const margin_edge *edges = &w->g->edges[w->shape->places[place].edge];
    const margin_range bounds = bounds_of(node_plan_of(w, place), edges);
    margin_node *o = &w->g->nodes[place];
    emit_change(w, place, at, within(o->carried, bounds.low, bounds.high));
}

/* The position of the next unread step of an operand; NEVER: there is none. */
static inline int64_t next_of(const margin_steps *from, const margin_edge *own)
{
    return (own->read < from->end) ? step_at(from, own->read)->at : NEVER;
}

/* Read the operands at all positions at which one of them changes, as far as all are known. */
static inline void join_operands(gauging *w, int32_t place,
                                 void (*tell)(gauging *w, int32_t place, int64_t at))
{
    const margin_place *own = &w->shape->places[place];
    const int32_t *operands = &w->shape->operands[own->edge];
    margin_edge *edges = &w->g->edges[own->edge];
    const margin_node *nodes = w->g->nodes;
    int64_t known = NEVER;
    int64_t next = NEVER;
    int32_t i;
    for (i = 0; i < own->edge_count; i++) {
        edges[i].next = NEVER;
        if (operands[i] >= 0) { /* else it never changes */
            const margin_node *from = &nodes[operands[i]];
            known = least(known, from->known);
            edges[i].next = next_of(&from->out, &edges[i]);
            next = least(next, edges[i].next);
        }
    }
    while (next <= known) {
        const int64_t at = next;
        next = NEVER;
        for (i = 0; i < own->edge_count; i++) {
            margin_edge *one = &edges[i];
            if (one->next == at) {
                const margin_steps *from = &nodes[operands[i]].out;
                one->value = step_at(from, one->read)->value;
                one->read++;
                one->next = next_of(from, one);
            }
            next = least(next, one->next);
        }
        tell(w, place, at);
    }
    w->g->nodes[place].joined = (known > w->g->nodes[place].joined) ? known : w->g->nodes[place].joined;
}

/* Combine the operands position by position, as far as all are known; all have a step at each. */
static void join_aligned(gauging *w, int32_t place)
{
    const margin_place *own = &w->shape->places[place];
    const int32_t *operands = &w->shape->operands[own->edge];
    const bool every = node_plan_of(w, place)->turned != 0;
    margin_node *o = &w->g->nodes[place];
    const int64_t first = o->out.end;
    const margin_steps *stamps = &w->g->nodes[operands[0]].out;
    int64_t known = NEVER;
    int64_t end = NEVER;
    int64_t k;
    int32_t i;
    for (i = 0; i < own->edge_count; i++) {
        const margin_node *from = &w->g->nodes[operands[i]];
        known = least(known, from->known);
        end = least(end, from->out.end);
    }
    o->joined = known;
    while ((end > first) && (step_at(stamps, end - 1)->at > known)) {
        end--;
    }
    if ((end == first) || (!has_room(&o->out, end - first)
                           && !room_for_steps(w, &o->out, end - first, oldest_unread(w, place)))) {
        return;
    }
    for (i = 0; i < own->edge_count; i++) {
        const margin_steps from = w->g->nodes[operands[i]].out;
        const margin_steps to = o->out;
        for (k = first; k < end; k++) {
            const margin_step next = *step_at(&from, k);
            margin_step *made = step_at(&to, k);
            made->at = next.at;
            made->value = (i == 0) ? next.value : joined(every, made->value, next.value);
        }
        w->g->edges[own->edge + i].read = end;
    }
    o->out.end = end;
}

static void follow_until(gauging *w, int32_t place, int64_t at)
{
    const margin_edge *edges = &w->g->edges[w->shape->places[place].edge];
    const margin_range bounds = bounds_of(node_plan_of(w, place), edges);
    parts_follow(w, &w->g->nodes[place].parts, at, bounds.low, bounds.high,
                 is_thin(w, place));
}

/* Emit the value of a stretch up to a position. */
static void emit_stretch(gauging *w, int32_t place, int64_t first, int64_t last, double value)
{
    margin_node *o = &w->g->nodes[place];
    if (!w->sparse || is_thin(w, place)) {
        emit_step(w, place, first, value);
        return;
    }
    while ((o->positions < w->g->stamps.end)
           && (step_at(&w->g->stamps, o->positions)->at <= last)) {
        emit_step(w, place, step_at(&w->g->stamps, o->positions)->at, value);
        o->positions++;
    }
}

/* The trace has ended: compute the stretches backwards from the value assumed after the end. */
static void end_until(gauging *w, int32_t place)
{
    margin_parts *s = &w->g->nodes[place].parts;
    double value = margin_beyond(w->end, node_plan_of(w, place)->kept != 0);
    int32_t i;
    for (i = s->end - 1; i >= s->begin; i--) {
        value = within(value, s->at[i].least, s->at[i].most);
        s->at[i].low = value;
    }
    for (i = s->begin; i < s->end; i++) {
        emit_stretch(w, place, s->at[i].first,
                     (i + 1 < s->end) ? s->at[i + 1].first - 1 : w->end->last, s->at[i].low);
    }
    s->begin = s->middle = s->end = 0;
}

static void gauge_until(gauging *w, int32_t place)
{
    margin_node *o = &w->g->nodes[place];
    margin_parts *s = &o->parts;
    double value = 0.0;
    join_operands(w, place, follow_until);
    while (parts_settled(s, &value)) {
        const int64_t first = s->at[s->begin].first;
        parts_leave(s);
        emit_stretch(w, place, first, (s->end > s->begin) ? s->at[s->begin].first - 1 : o->joined,
                     value);
    }
    if (w->end != NULL) {
        end_until(w, place);
    }
    o->known = (s->end > s->begin) ? s->at[s->begin].first - 1 : o->joined;
}

void gauge_join(gauging *w, int32_t place)
{
    switch (node_plan_of(w, place)->kind) {
    case OP_JUNCTION:
        if (w->aligned) {
            join_aligned(w, place);
        } else {
            join_operands(w, place, emit_junction);
        }
        break;
    case OP_SINCE: join_operands(w, place, emit_since); break;
    default: gauge_until(w, place); return;
    }
    w->g->nodes[place].known = w->g->nodes[place].joined;
}
