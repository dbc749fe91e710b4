/* Which columns of rows are counted in bulk (count_rows.c): those whose values reach only bins, through
 * connectives, in a monitor that only counts (coverage has a plan of its own). Rows at which any other
 * column changes are judged. */
#include "input/input.h"
#include "results/results.h"
#include "rows/rows.h"

#include <string.h>

/* Whether the monitor only counts bins. */
static bool only_counts(const rv_monitor *m)
{
    const part_plan *p = (m->plan.part_count == 1) ? &m->plan.parts[0] : NULL;
    return (p != NULL) && m->is_alone && (p->judges.count == 0) && (p->truths < 0)
           && (p->watches.count > 0) && (m->plan.header->gap <= 1);
}

bool begin_counted(batch *s)
{
    rv_monitor *m = s->m;
    const part_plan *p = m->plan.parts;
    counting *c;
    size_t nodes;
    if (!only_counts(m)) {
        return true;
    }
    nodes = (size_t)p->nodes.count + 1U;
    c = arena_take(&m->memory, sizeof *c);
    s->counting = c;
    if (c == NULL) {
        return false;
    }
    c->rows = arena_take(&m->memory, nodes * sizeof *c->rows);
    c->reads = arena_take(&m->memory, nodes);
    c->nodes = arena_take(&m->memory, nodes * sizeof *c->nodes);
    c->bits = arena_take(&m->memory, words_of_watches(p) * sizeof *c->bits);
    c->is_bulk = arena_take(&m->memory, (size_t)p->groups.count + 1U);
    return (c->rows != NULL) && (c->reads != NULL) && (c->nodes != NULL) && (c->bits != NULL)
           && (c->is_bulk != NULL);
}

static void give_array(rv_monitor *m, void *array, size_t size)
{
    if (array != NULL) {
        arena_give(&m->memory, array, size);
    }
}

void end_counted(batch *s)
{
    counting *c = s->counting;
    if (c != NULL) {
        const part_plan *p = s->m->plan.parts;
        const size_t nodes = (size_t)p->nodes.count + 1U;
        give_array(s->m, c->rows, nodes * sizeof *c->rows);
        give_array(s->m, c->reads, nodes);
        give_array(s->m, c->nodes, nodes * sizeof *c->nodes);
        give_array(s->m, c->bits, words_of_watches(p) * sizeof *c->bits);
        give_array(s->m, c->is_bulk, (size_t)p->groups.count + 1U);
        arena_give(&s->m->memory, c, sizeof *c);
        s->counting = NULL;
    }
}

/* ---- which columns are counted */

/* Whether the bins of a group are sampled at all rows and can last (are not pulses). */
static bool is_bulk_group(const run *r, const group_plan *g)
{
    const int32_t *axes = LIST(PLAN(r), g->axes);
    int32_t k;
    int32_t i;
    for (k = 0; k < g->axes.count; k += 2) {
        for (i = axes[k]; i < axes[k] + axes[k + 1]; i++) {
            if (r->part->watches[i].is_pulse != 0) {
                return false;
            }
        }
    }
    return g->occasion < 0;
}

/* Whether a node is a comparison or a connective that only groups counted in bulk read. */
static bool is_bulk_node(const run *r, const counting *c, int32_t place)
{
    const node_plan *n = &r->part->nodes[place];
    const link_plan *l = &PLAN(r)->links[n->links.first];
    int32_t i;
    int32_t k;
    if ((n->op != NODE_LEAF) && (n->op != NODE_NOT) && (n->op != NODE_AND) && (n->op != NODE_OR)
        && (n->op != NODE_SURE)) {
        return false;
    }
    for (i = 0; i < n->links.count; i++) {
        const list own = (l[i].kind == LINK_WATCH) ? r->part->watches[l[i].judge].groups : (list){0, 0};
        if (l[i].kind != LINK_WATCH) {
            return false;
        }
        for (k = 0; k < own.count; k++) {
            if (c->is_bulk[LIST(PLAN(r), own)[k]] == 0U) {
                return false;
            }
        }
    }
    return true;
}

/* Whether the values of a column are only compared with constants, or are themselves truths. */
static bool is_bulk_column(const batch *s, const column_watch *w)
{
    const bool real = (w->column->kind == RV_COLUMN_REAL) && (w->how == BY_CONSTANTS);
    const run *r;
    list atoms;
    int32_t i;
    if (w->is_event || w->ignores_nan || w->perishable || (w->reader_count != 1)
        || (w->column->says != NULL) || (w->column->values == NULL)
        || (!real && ((w->column->kind != RV_COLUMN_BYTE) || (w->how != EACH_VALUE)))) {
        return false;
    }
    r = root_of(s, w, 0);
    atoms = r->part->signals[w->readers[0].local].on_change[r->at.phase];
    for (i = 0; i < atoms.count; i++) {
        const atom_plan *a = &r->part->atoms[LIST(PLAN(r), atoms)[i]];
        if ((a->op != (real ? ATOM_REAL : ATOM_SIGNAL)) || (a->tells != 0) || (a->momentary != 0)) {
            return false;
        }
    }
    return true;
}

/* Mark the leaves of the comparisons of a column. */
static void mark_counted_leaves(const batch *s, const column_watch *w)
{
    int32_t atom = 0;
    int32_t at = 0;
    int32_t place = next_shown(root_of(s, w, 0), w->readers[0].local, &atom, &at);
    for (; place >= 0; place = next_shown(root_of(s, w, 0), w->readers[0].local, &atom, &at)) {
        s->counting->reads[place] = READS_COLUMN;
    }
}

/* Whether a leaf of a column reaches more than bins. */
static bool reads_more(const batch *s, const column_watch *w)
{
    int32_t atom = 0;
    int32_t at = 0;
    int32_t place = next_shown(root_of(s, w, 0), w->readers[0].local, &atom, &at);
    bool more = false;
    for (; place >= 0; place = next_shown(root_of(s, w, 0), w->readers[0].local, &atom, &at)) {
        more = more || (s->counting->reads[place] == READS_MORE);
    }
    return more;
}

/* Mark the nodes that marked leaves reach; operands have lower numbers. */
static void spread_upwards(const run *r, counting *c)
{
    int32_t i;
    int32_t k;
    for (i = 0; i < r->part->plan->nodes.count; i++) {
        const list parents = r->part->nodes[i].parents[r->at.phase];
        for (k = 0; (c->reads[i] != READS_NONE) && (k < parents.count); k++) {
            c->reads[LIST(PLAN(r), parents)[k]] = READS_COLUMN;
        }
    }
}

/* Mark the nodes that reach something other than bins of groups counted in bulk. */
static void spread_downwards(const run *r, counting *c)
{
    int32_t i;
    int32_t k;
    for (i = r->part->plan->nodes.count - 1; i >= 0; i--) {
        const list parents = r->part->nodes[i].parents[r->at.phase];
        bool more = !is_bulk_node(r, c, i);
        for (k = 0; (c->reads[i] != READS_NONE) && (k < parents.count); k++) {
            more = more || (c->reads[LIST(PLAN(r), parents)[k]] == READS_MORE);
        }
        c->reads[i] = ((c->reads[i] != READS_NONE) && more) ? READS_MORE : c->reads[i];
    }
}

/* Mark the leaves of counted columns, and all nodes that they reach. */
static void mark_counted_nodes(const batch *s, const run *r)
{
    int32_t i;
    (void)memset(s->counting->reads, READS_NONE, (size_t)r->part->plan->nodes.count);
    for (i = 0; i < s->columns; i++) {
        if (s->watches[i].is_counted) {
            mark_counted_leaves(s, &s->watches[i]);
        }
    }
    spread_upwards(r, s->counting);
}

/* Find the counted columns and the nodes that they reach; every signal is born. */
void learn_counted(batch *s)
{
    counting *c = s->counting;
    const run *r = s->m->homes[0].root;
    int32_t i;
    for (i = 0; i < r->part->plan->groups.count; i++) {
        c->is_bulk[i] = is_bulk_group(r, &r->part->groups[i]) ? 1 : 0;
    }
    for (i = 0; i < s->columns; i++) {
        s->watches[i].is_counted = is_bulk_column(s, &s->watches[i]);
    }
    mark_counted_nodes(s, r);
    spread_downwards(r, c);
    for (i = 0; i < s->columns; i++) {
        column_watch *w = &s->watches[i];
        w->is_counted = w->is_counted && !reads_more(s, w);
    }
    mark_counted_nodes(s, r); /* without the columns that are not counted after all */
    c->count = 0;
    for (i = 0; i < r->part->plan->nodes.count; i++) {
        if (c->reads[i] != READS_NONE) {
            c->nodes[c->count] = i;
            c->count++;
        }
    }
}

/* Whether rows may be counted now: nothing is lost, and signals have the values of their last updates. */
bool may_count(const batch *s)
{
    const run *r = s->m->homes[0].root;
    return (s->counting != NULL) && s->known && (s->counting->count > 0) && (r->at.lost_count == 0)
           && (r->at.presence == ARE_THERE) && (r->cut == NEVER) && !r->at.dense;
}
