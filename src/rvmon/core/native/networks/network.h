/* Delay networks, which judge formulas without an automaton (mostly nested bounded windows).
 *
 * A network has a node per operator of the formula. A node holds the *positions* at which it is known
 * to be TRUE and those at which it is known to be FALSE, as sets of ranges; all others depend on
 * letters or time to come. A step advances time (`now`) and letters (`last`): each node derives the
 * ranges *added* to it from those added to its operands. One network serves all attempts of a judge:
 * an attempt is a position, decided when the root is known there. The cost of a step grows with the
 * ranges that it adds, not with the number of positions.
 *
 * The known positions are a function of (now, last) alone. So a step can be undone, and the first
 * instant at which a position became known is found by smaller steps (network_search.c).
 *
 * Positions are instant / gap with a clock (gap > 0), so ticks with gap 1; where only samples are
 * positions, they are sample numbers from 0. From the first unknown letter on there are two networks,
 * `readings`: unknown input taken for the worse and for the better.
 *
 * Source: Basin, Klaedtke, Zalinescu (2011); docs/explanation/automata.md, section 4. */
#ifndef RVMON_NETWORK_H
#define RVMON_NETWORK_H

#include "attempts/attempts.h"

/* ---- network_nodes.c, network_state.c: what is known of a formula */

/* A formula of the plan, with what its network needs of the run. */
typedef struct {
    const plan *plan;
    const form_plan *form;
    const operator_plan *nodes;
    int64_t gap;
    int64_t step;
    rv_monitor *monitor;
} form;

form form_at(const run *r, int32_t number);
form form_of(const run *r, int32_t index); /* of a judge */
networks *made_networks(const form *f);
bool read_leaves(const run *r, const form *f, networks *net, bool *parted);
int64_t instant_of(const form *f, const network *w, int64_t position);
int64_t position_by(const form *f, const network *w, int64_t t);
int64_t from_on(const form *f, const network *w, int64_t position, int64_t distance);
int64_t up_to(const form *f, const network *w, int64_t position, int64_t distance);
bool knows(const operator_state *o, uint8_t value, int64_t position);
void learn(const form *f, networks *net, int32_t reading, int64_t now, int64_t last);
void unlearn(const form *f, network *w);
void reset_network(const form *f, network *w, int64_t t, int64_t position);
void copy_network(const form *f, network *made, const network *w);
bool networks_agree(const form *f, const network *one, const network *other);
void prune(const form *f, network *w, int64_t position);

/* ---- network_search.c: a lower bound of the instant at which a further position becomes known */
int64_t earliest_change(const form *f, networks *net, int32_t reading);

/* ---- network_judge.c: attempts that a network judges */
bool is_networked(const run *r, int32_t index);
void network_pass(run *r, int32_t index, int64_t now, bool is_position);
void network_put_off(run *r, int32_t index, int64_t until);
void network_foresee(run *r, int32_t index, int64_t now);
void network_come_to(run *r, int32_t index, int64_t t);
bool network_enter(run *r, int32_t index, int32_t at, int64_t t);
void network_close(run *r, int32_t index, int64_t end, int64_t reached);
bool network_outlasts(run *r, int32_t index, const attempt *x);

/* A judge with its networks. */
typedef struct {
    run *r;
    judge *j;
    networks *net;
    int32_t index;
    form f;
    int32_t root;              /* the operator that is the whole formula */
} judging;

static inline bool is_spoilt(const judging *g)
{
    return g->f.monitor->spoilt;
}

/* The number of readings in use. */
static inline int32_t readings(const judging *g)
{
    return g->net->parted ? 2 : 1;
}

/* Whether a judge must not be used any more: memory was short, so its networks are missing or hold half
 * a step. */
static inline bool is_given_up(judging *g)
{
    if ((g->net == NULL) || is_spoilt(g)) {
        g->j->lag = 0;
        set_rule_due(g->r, g->index, NEVER);
        return true;
    }
    return false;
}

static inline attempt *attempt_of(const judging *g, int32_t at)
{
    return attempt_at(g->r->home, at);
}

/* The position at which an attempt started; networks keep it in place of a clock. */
static inline int64_t position_of(const attempt *x)
{
    return x->clocks[0];
}

static inline void set_due(judging *g, int64_t due)
{
    g->j->lag = 0;
    set_rule_due(g->r, g->index, due);
}

static inline int64_t due_of(const judging *g)
{
    return g->r->rules.due[g->index];
}

/* ---- network_judge.c */
judging judging_of(run *r, int32_t index);

/* ---- network_nodes.c, network_sweeps.c */
void add_known(const form *f, operator_state *o, uint8_t value, int64_t first, int64_t last);
void update_until(const form *f, const network *w, const operator_plan *n, operator_state *o);
void update_since(const form *f, const network *w, const operator_plan *n, operator_state *o);

/* ---- network_search.c */
void learn_all(judging *g, int64_t now, int64_t last);
void unlearn_all(judging *g);
int64_t last_at(const judging *g, int64_t t);
int64_t step_to_decision(judging *g, int64_t now, int64_t last);

/* ---- network_judge.c */
int64_t earliest(const judging *g, int64_t now);

/* ---- network_search.c: decisions of attempts */
bool judge_attempt(judging *g, int32_t at, int64_t t);
int64_t decided_position(const judging *g);
void judge_added(judging *g, int64_t t);

/* ---- network_state.c: sets of positions as ranges, sorted, with gaps between them */
int32_t range_from(const ranges *r, int64_t position);
int32_t range_around(const ranges *r, int64_t position);
int64_t last_up_to(const ranges *r, int64_t position);
void ranges_put(rv_monitor *m, ranges *r, int32_t place, int64_t first, int64_t last);
void ranges_insert(rv_monitor *m, ranges *r, int32_t i, int64_t first, int64_t last);
void ranges_cut(rv_monitor *m, ranges *r, int64_t first, int64_t last);
void ranges_drop(ranges *r, int64_t before);
void ranges_empty(ranges *r);
void ranges_copy(rv_monitor *m, ranges *made, const ranges *r);
bool ranges_alike(const ranges *one, const ranges *other);

#endif
