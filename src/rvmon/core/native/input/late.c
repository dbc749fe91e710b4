/* What comes behind what was judged: it is not judged any more, and nothing that it would have touched is
 * green.
 *
 * Source: the law, section 6 (Too late). */
#include "runs/runs.h"

static void mark_nodes(const run *r, list l, uint8_t *reads)
{
    const int32_t *nodes = LIST(PLAN(r), l);
    int32_t i;
    for (i = 0; i < l.count; i++) {
        reads[nodes[i]] = 1;
    }
}

/* Mark the leaves of some atoms. */
static void mark_atoms(const run *r, list l, uint8_t *reads)
{
    const int32_t *atoms = LIST(PLAN(r), l);
    int32_t i;
    for (i = 0; i < l.count; i++) {
        mark_nodes(r, r->part->atoms[atoms[i]].nodes[0], reads);
    }
}

static void mark_leaves(const run *r, bool event, int32_t local, uint8_t *reads)
{
    if (event) {
        mark_atoms(r, r->part->events[local].on_occurrence[0], reads);
    } else {
        mark_atoms(r, r->part->signals[local].on_change[0], reads);
        mark_atoms(r, r->part->signals[local].on_update[0], reads);
        mark_nodes(r, r->part->signals[local].on_birth, reads);
    }
}

/* Mark what depends on what is marked, and the requirements that hear of it. */
static void mark_above(const run *r, uint8_t *reads)
{
    rv_monitor *m = r->home->monitor;
    int32_t i;
    int32_t k;
    for (i = 0; i < r->part->plan->nodes.count; i++) {
        const node_plan *n = &r->part->nodes[i];
        const int32_t *operands = LIST(PLAN(r), n->operands);
        for (k = 0; (n->op != NODE_LEAF) && (n->op != NODE_UNBORN) && (k < n->operands.count); k++) {
            reads[i] |= reads[operands[k]];
        }
        for (k = 0; (reads[i] != 0U) && (k < n->links.count); k++) {
            const link_plan *l = &PLAN(r)->links[n->links.first + k];
            if (l->kind != LINK_WATCH) {
                m->late[r->part->judges[l->judge].requirement] = 1;
            }
        }
    }
}

/* Mark the requirements of a part that read a name; false: memory is short. */
static bool mark_readers(const home *h, bool event, int32_t local)
{
    const part_plan *p = h->part->plan;
    const size_t size = (size_t)p->nodes.count + 1;
    arena *a = &h->monitor->memory;
    uint8_t *reads;
    if (p->captured > 0) {
        h->monitor->late[p->requirement] = 1;
        return true;
    }
    reads = arena_take(a, size);
    if (reads == NULL) {
        h->monitor->spoilt = true;
        return false;
    }
    mark_leaves(h->root, event, local, reads);
    mark_above(h->root, reads);
    arena_give(a, reads, size);
    return true;
}

int rv_late(rv_monitor *m, int64_t t, const int32_t *names, int32_t count)
{
    const bool all = (count < 0) || (m->plan.header->gap == 0) || (m->last == RV_NO_TIME)
                     || (t < m->began);
    int32_t i;
    int32_t k;
    for (i = 0; all && (i < m->plan.header->requirements); i++) {
        m->late[i] = 1; /* it was a position, or one before all others */
    }
    for (i = 0; !all && (i < count); i++) {
        int32_t readers;
        const subscription *s = subscriptions_of(m, names[i], &readers);
        for (k = 0; k < readers; k++) {
            if (!mark_readers(&m->homes[s[k].part], names[i] >= m->plan.header->signals, s[k].local)) {
                return RV_NO_MEMORY;
            }
        }
    }
    return RV_OK;
}
