/* Networks as judges: what network_judge.c and network_attempts.c share. */
#ifndef RVMON_NETWORK_H
#define RVMON_NETWORK_H

#include "calls.h"

/* A judge with its network. */
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

/* How many networks there are at present. */
static inline int32_t readings(const judging *g)
{
    return g->net->parted ? 2 : 1;
}

/* Whether nothing more is asked of a judge: memory was short, what its networks hold may be torn, or
 * there are none. */
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
void note(const form *f, operator_state *o, uint8_t value, int64_t first, int64_t last);
void lead(const form *f, const network *w, const operator_plan *n, operator_state *o);
void follow(const form *f, const network *w, const operator_plan *n, operator_state *o);

/* ---- network_search.c */
void learn_all(judging *g, int64_t now, int64_t last);
void unlearn_all(judging *g);
int64_t last_at(const judging *g, int64_t t);
int64_t step_to_decision(judging *g, int64_t now, int64_t last);

/* ---- network_judge.c */
int64_t earliest(const judging *g, int64_t now);

/* ---- network_attempts.c */
bool weigh(judging *g, int32_t at, int64_t t);
int64_t decided_one(const judging *g);
void hear_news(judging *g, int64_t t);

#endif
