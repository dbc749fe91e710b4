/* Queues of attempts in a snapshot. */
#include "attempts/attempts.h"
#include "snapshot/snapshot.h"

/* The clocks of a segment, as many as its location has; its attempts start at `first`. */
static void carry_segment_clocks(carrier *c, const queueing *g, segment *s, int32_t first)
{
    int32_t i;
    int32_t k;
    for (i = 0; !is_lost(c) && (i < g->a->widths[s->location]); i++) {
        int64_t before = -LIMIT;
        carry_long(c, &s->clocks[i], 1 - LIMIT, OF_TRIGGER);
        demand(c, (s->clocks[i] < LIMIT) || (s->clocks[i] >= OF_EACH_ATTEMPT));
        if ((s->clocks[i] != OF_EACH_ATTEMPT) || !make_own_instants(c->m, g->a, g->q)) {
            continue;
        }
        for (k = first; (k < first + s->count) && !is_lost(c); k++) {
            int64_t *own = own_instant(g, k, i);
            carry_long(c, own, before, LIMIT);
            before = *own;
        }
    }
}

/* A queue: its attempts, oldest first, then its segments, which have to add up to them. */
void carry_queue(carrier *c, run *r, int32_t index)
{
    const queueing g = queueing_of(r, index);
    queue *q = g.q;
    const int32_t locations = PLAN(r)->automata[r->part->judges[index].automaton].locations;
    int32_t count = q->count;
    int32_t segment_count = q->now.count;
    int32_t left;
    bool current = r->judges[index].current == IN_QUEUE;
    int64_t before = -LIMIT;
    int32_t i;
    carry_size(c, &count, MOST, 12);
    for (i = 0; (i < count) && !is_lost(c); i++) {
        queued *one = queue_slot(c->m, g.a, q, i, c->reading);
        if (one != NULL) {
            carry_instant(c, &one->triggered);
            carry_count(c, &one->number);
            demand(c, one->triggered >= before);
            before = one->triggered;
        }
    }
    carry_size(c, &segment_count, MOST, 8);
    left = count;
    for (i = 0; (i < segment_count) && !is_lost(c); i++) {
        segment *one = c->reading ? next_segment(c->m, &q->now) : &q->now.at[i];
        if (one != NULL) {
            carry_int(c, &one->location, WAITING, locations);
            carry_int(c, &one->count, 1, (int64_t)left + 1);
            carry_segment_clocks(c, &g, one, count - left);
            left -= one->count;
        }
    }
    demand(c, left == 0);
    carry_flag(c, &current);
    if (c->reading && current) {
        demand(c, (count > 0) && (r->judges[index].current < 0) && runs_on(r, index));
        r->judges[index].current = IN_QUEUE;
    }
}
