/* Queues of attempts: what queue.c and queue_steps.c share. */
#ifndef RVMON_QUEUE_H
#define RVMON_QUEUE_H

#include "attempts/attempts.h"

/* A queue with its judge. */
typedef struct {
    run *r;
    judge *j;
    queue *q;
    const machine *a;
    int32_t index;
} queueing;

static inline queueing queueing_of(run *r, int32_t index)
{
    queueing g;
    g.r = r;
    g.j = &r->judges[index];
    g.q = g.j->queue;
    g.a = &r->part->machines[index];
    g.index = index;
    return g;
}

static inline queued *item(const queue *q, int32_t i)
{
    return &q->items[(q->head + i) & (q->room - 1)];
}

/* ---- queue.c */
queued *next_queued(rv_monitor *m, queue *q, int32_t i, bool append);
void tell_of_decision(const queueing *g, const queued *one, int32_t location, bool passed, int64_t t);

#endif
