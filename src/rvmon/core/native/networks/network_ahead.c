/* How soon something new can become known of a formula if its letter stays: what cannot be decided before
 * is not looked for. It need not be so soon; that nothing is known sooner is certain.
 *
 * What is new of an operator lies from its `base` on, the first position that is not known. */
#include "networks/network.h"

/* Whether a value is known somewhere from a position on. */
static bool has_from(const operator_state *o, uint8_t value, int64_t position)
{
    const ranges *known = &o->known[value];
    return (known->first < known->end) && (known->at[known->end - 1].last >= position);
}

/* The first instant at which an operator can be known to have a value somewhere from a position on. */
static int64_t earliest_from(const operator_state *o, uint8_t value, int64_t position, int64_t now)
{
    return has_from(o, value, position) ? now : o->earliest[value];
}

static void ask_junction(const form *f, network *w, const operator_plan *n, operator_state *o)
{
    const int32_t *operands = LIST(f->plan, n->operands);
    const uint8_t all = (uint8_t)n->turned;
    const uint8_t some = (uint8_t)(all ^ 1U);
    int32_t i;
    o->earliest[some] = NEVER;
    o->earliest[all] = w->now;
    for (i = 0; i < n->operands.count; i++) {
        const operator_state *one = &w->nodes[operands[i]];
        const int64_t met = earliest_from(one, all, o->base, w->now);
        o->earliest[some] = least(o->earliest[some], one->earliest[some]);
        o->earliest[all] = (met > o->earliest[all]) ? met : o->earliest[all];
    }
}

static void ask_window(const form *f, network *w, const operator_plan *n, operator_state *o)
{
    const operator_state *operand = &w->nodes[n->left];
    const uint8_t all = (uint8_t)n->turned;
    const int64_t over = moved(instant_of(f, w, o->base), n->over);
    o->earliest[all] = (over > w->now) ? over : w->now;
    o->earliest[all ^ 1U] = operand->earliest[all ^ 1U];
    if ((f->gap == 1) && (n->low <= n->high)) { /* none is empty */
        const int64_t met = earliest_from(operand, all, moved(o->base, n->low), w->now);
        o->earliest[all] = (met > o->earliest[all]) ? met : o->earliest[all];
    }
}

/* `left until right`: what is new of it comes of something new on its right, or leads to what was met
 * there; where it fails both have to. */
static void ask_until(network *w, const operator_plan *n, operator_state *o)
{
    const operator_state *left = &w->nodes[n->left];
    const operator_state *right = &w->nodes[n->right];
    const uint8_t no = (uint8_t)n->turned;
    const uint8_t yes = (uint8_t)(no ^ 1U);
    const int64_t failing = earliest_from(left, no, o->base, w->now);
    o->earliest[yes] = earliest_from(right, yes, o->base, w->now);
    o->earliest[no] = earliest_from(right, no, o->base, w->now);
    o->earliest[no] = (failing > o->earliest[no]) ? failing : o->earliest[no];
}

int64_t earliest_change(const form *f, networks *net, int32_t reading)
{
    network *w = &net->readings[reading];
    const int32_t count = f->form->operators.count;
    int32_t i;
    for (i = 0; i < count; i++) {
        const operator_plan *n = &f->nodes[i];
        operator_state *o = &w->nodes[i];
        o->earliest[0] = w->now;
        o->earliest[1] = w->now;
        if (n->kind == OP_LEAF) {
            const uint8_t other = ((net->leaf[n->left] >> reading) & 1U) ^ 1U;
            o->earliest[other] = NEVER;
        } else if (n->kind == OP_JUNCTION) {
            ask_junction(f, w, n, o);
        } else if ((n->kind == OP_WINDOW) && (n->over >= 0)) {
            ask_window(f, w, n, o);
        } else if ((n->kind == OP_SHIFT) && (n->low >= 0)) {
            o->earliest[0] = w->nodes[n->left].earliest[0];
            o->earliest[1] = w->nodes[n->left].earliest[1];
        } else if (n->kind == OP_UNTIL) {
            ask_until(w, n, o);
        } else {
            /* What looks back is not followed. */
        }
    }
    return least(w->nodes[count - 1].earliest[0], w->nodes[count - 1].earliest[1]);
}
