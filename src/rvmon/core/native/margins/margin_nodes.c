/* Operators that join values: `and`, `or`, `since`, `until`.
 *
 * What a node has is a function of the positions in steps, known up to one of them. Where only samples
 * are positions a step belongs to the position at which it begins, and each has one of its own.
 *
 * Source: SEMANTICS 5; Fainekos and Pappas 2009; Donze, Ferrere and Maler 2013. */
#include "margins/margins.h"

/* Between which values a sweep keeps that of its neighbour. */
static margin_range bounds_of(const operator_plan *n, const margin_edge *edges)
{
    const double stays = edges[0].value;
    const double meets = edges[1].value;
    margin_range made;
    made.low = (n->turned != 0) ? fmin(stays, meets) : meets;
    made.high = (n->turned != 0) ? meets : fmax(stays, meets);
    return made;
}

/* Tell another value, unless it is none. */
static void tell_other(gauging *w, int32_t place, int64_t at, double value)
{
    margin_node *o = &w->g->nodes[place];
    if (w->sparse || !o->begun || (value != o->carried)) {
        o->begun = true;
        o->carried = value;
        tell_step(w, place, at, value);
    }
}

static void tell_junction(gauging *w, int32_t place, int64_t at)
{
    const margin_place *shape = &w->shape->places[place];
    const margin_edge *edges = &w->g->edges[shape->edge];
    const bool every = node_plan_of(w, place)->turned != 0;
    double value = edges[0].value;
    int32_t i;
    for (i = 1; i < shape->edge_count; i++) {
        if (every ? (edges[i].value < value) : (edges[i].value > value)) {
            value = edges[i].value;
        }
    }
    tell_other(w, place, at, value);
}

/* S(i) = max(meets(i), min(stays(i), S(i - 1))), or its dual. */
static void tell_since(gauging *w, int32_t place, int64_t at)
{
    const margin_edge *edges = &w->g->edges[w->shape->places[place].edge];
    const margin_range bounds = bounds_of(node_plan_of(w, place), edges);
    margin_node *o = &w->g->nodes[place];
    tell_other(w, place, at, within(o->carried, bounds.low, bounds.high));
}

/* Take what operands are at the positions at which one of them changes, up to where all are known. */
static void join_operands(gauging *w, int32_t place, void (*tell)(gauging *w, int32_t place, int64_t at))
{
    const margin_place *shape = &w->shape->places[place];
    const int32_t *operands = &w->shape->operands[shape->edge];
    margin_edge *edges = &w->g->edges[shape->edge];
    margin_node *o = &w->g->nodes[place];
    int64_t known = NEVER;
    int32_t i;
    for (i = 0; i < shape->edge_count; i++) {
        if (operands[i] >= 0) {
            known = least(known, operand_known(w, operands[i]));
        }
    }
    if (known <= o->joined) {
        return;
    }
    o->joined = known;
    for (;;) {
        int64_t at = known + 1;
        for (i = 0; i < shape->edge_count; i++) {
            if (operands[i] >= 0) {
                const margin_steps *from = &w->g->nodes[operands[i]].out;
                if (edges[i].read < from->end) {
                    at = least(at, step_at(from, edges[i].read)->at);
                }
            }
        }
        if (at > known) {
            break;
        }
        for (i = 0; i < shape->edge_count; i++) {
            if (operands[i] >= 0) {
                const margin_steps *from = &w->g->nodes[operands[i]].out;
                if ((edges[i].read < from->end) && (step_at(from, edges[i].read)->at == at)) {
                    edges[i].value = step_at(from, edges[i].read)->value;
                    edges[i].read++;
                }
            }
        }
        tell(w, place, at);
    }
}

static void follow_until(gauging *w, int32_t place, int64_t at)
{
    const margin_edge *edges = &w->g->edges[w->shape->places[place].edge];
    const margin_range bounds = bounds_of(node_plan_of(w, place), edges);
    parts_follow(w, &w->g->nodes[place].parts, at, bounds.low, bounds.high,
                 is_thin(w, place));
}

/* Tell the value of a stretch up to a position. */
static void tell_stretch(gauging *w, int32_t place, int64_t first, int64_t last, double value)
{
    margin_node *o = &w->g->nodes[place];
    if (!w->sparse || is_thin(w, place)) {
        tell_step(w, place, first, value);
        return;
    }
    while ((o->positions < w->g->stamps.end)
           && (step_at(&w->g->stamps, o->positions)->at <= last)) {
        tell_step(w, place, step_at(&w->g->stamps, o->positions)->at, value);
        o->positions++;
    }
}

/* The trace has ended: from behind its end back, each stretch has the value of what follows it. */
static void end_until(gauging *w, int32_t place)
{
    margin_parts *s = &w->g->nodes[place].parts;
    double value = margin_behind(w->end, node_plan_of(w, place)->kept != 0);
    int32_t i;
    for (i = s->end - 1; i >= s->begin; i--) {
        value = within(value, s->at[i].least, s->at[i].most);
        s->at[i].low = value;
    }
    for (i = s->begin; i < s->end; i++) {
        tell_stretch(w, place, s->at[i].first,
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
        tell_stretch(w, place, first, (s->end > s->begin) ? s->at[s->begin].first - 1 : o->joined,
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
    case OP_JUNCTION: join_operands(w, place, tell_junction); break;
    case OP_SINCE: join_operands(w, place, tell_since); break;
    default: gauge_until(w, place); return;
    }
    w->g->nodes[place].known = w->g->nodes[place].joined;
}
