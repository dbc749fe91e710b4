/* Formulas of the present and the past, evaluated at each position.
 *
 * A part's formulas are a graph of nodes (plan.md, SEC_NODES), operands before operators, each with its
 * truth at the current position in `run.truth`. Nodes whose inputs changed are marked dirty and
 * evaluated; nodes that time alone can change have a timer in `run.wake`. Judges receive the changes of
 * nodes as letters and triggers. */
#ifndef RVMON_FORMULAS_H
#define RVMON_FORMULAS_H

#include "basics.h"

/* ---- timers.c */
void timers_set(timers *h, int32_t id, int64_t due);
void timers_clear(timers *h, int32_t ids);
static inline int64_t timers_next(const timers *h)
{
    return h->next;
}
/* Write the ids due by `t`, in no order, into `found`, which has room for all; returns how many. */
int32_t timers_due(const timers *h, int64_t t, int32_t *found);

/* ---- past.c */
stretch *stretch_slot(rv_monitor *m, stretches *s, int32_t i, bool append);
void split_stretches(rv_monitor *m, stretches *worse, stretches *better);
bool edges_agree(const edge *a, const edge *b);
bool stretches_agree(const stretches *a, const stretches *b);
uint8_t node_since(run *r, const node_plan *n, int64_t t, uint8_t left, uint8_t right);
uint8_t node_doubt(run *r, const node_plan *n, int32_t place, int64_t t, uint8_t now);

/* Whether a node is the DOUBT of a pulse in a run that is not itself in doubt. Such a node is FALSE
 * where its operand is, and while it is FALSE only an UNKNOWN operand changes it. */
static inline bool is_doubt_of_pulse(const node_plan *n)
{
    return (n->op == NODE_DOUBT) && (n->a != 0) && (n->b == 0);
}

/* Whether a node is such a DOUBT and stays FALSE although its operand changed to `now`; if so the node
 * remembers the operand, as node_doubt() would. */
static inline bool doubt_stays(run *r, int32_t place, uint8_t now)
{
    const node_plan *n = &r->part->nodes[place];
    if ((now == IS_UNKNOWN) || (r->truth[place] != IS_FALSE) || !is_doubt_of_pulse(n)) {
        return false;
    }
    r->seen[n->slot] = now;
    return true;
}

/* ---- window.c; `blank`: the position may not exist, and every input is unknown */
uint8_t node_window(run *r, const node_plan *n, int64_t t, uint8_t operand, bool blank);
void restart_window(run *r, const node_plan *n);

/* ---- graph.c: the nodes of a part */
void mark_dirty(run *r, int32_t node);
void mark_all_dirty(run *r);
/* Mark the parents of a node that are of one kind (NODE_...). */
void mark_parents(run *r, const node_plan *n, int32_t op);
void work_out(run *r, int64_t t);
bool has_dirty_nodes(const run *r);
void remember_unknown(run *r, int64_t t);
void blank_out(run *r, int64_t t);
void reevaluate_varying(run *r, int64_t t, bool pending);
void settle_phase(run *r);

#endif
