/* A judge whose formula is a delay network (network.h): letters, time, attempts, the end.
 *
 * While a letter stays (gap > 0) the network is not stepped at each position. The judge is due at a
 * lower bound of its next decision (earliest_change). At that instant one step runs ahead as if the
 * letter stayed, the exact instant of the next decision is searched, and the step is undone until that
 * instant or a new letter comes. */
#include "networks/network.h"

#include <string.h>

/* How far to look ahead, as a multiple of the time since the last search or the last letter. So the
 * number of searches is logarithmic in how long nothing happens; and if searches are frequent, because
 * attempts or decisions are, none looks much further than the next. */
#define FURTHER 4
/* Number of letters between two prunings, over which their cost is spread. */
#define TIDY_EVERY 8

bool is_networked(const run *r, int32_t index)
{
    return r->part->judges[index].automaton < 0;
}

form form_at(const run *r, int32_t number)
{
    form f;
    f.plan = PLAN(r);
    f.form = &r->part->forms[number];
    f.nodes = &f.plan->operators[f.form->operators.first];
    f.gap = GAP(r);
    f.step = step_of(r);
    f.monitor = r->home->monitor;
    return f;
}

form form_of(const run *r, int32_t index)
{
    return form_at(r, r->part->judges[index].form);
}

judging judging_of(run *r, int32_t index)
{
    judging g;
    g.r = r;
    g.j = &r->judges[index];
    g.net = g.j->net;
    g.index = index;
    g.f = form_of(r, index);
    g.root = g.f.form->operators.count - 1;
    return g;
}

/* New networks for a formula; NULL: memory is short. A judge makes them at its first letter. */
networks *made_networks(const form *f)
{
    const size_t size = (size_t)f->form->operators.count * sizeof(operator_state);
    arena *a = &f->monitor->memory;
    networks *made = arena_take(a, sizeof *made);
    int32_t i;
    if (made != NULL) {
        made->turn = NEVER;
        made->leaf = arena_take(a, (size_t)f->form->leaves + 1);
        made->next_leaf = arena_take(a, (size_t)f->form->leaves + 1);
        for (i = 0; i < 2; i++) {
            made->readings[i].nodes = arena_take(a, size);
        }
    }
    if ((made == NULL) || (made->leaf == NULL) || (made->next_leaf == NULL)
        || (made->readings[0].nodes == NULL) || (made->readings[1].nodes == NULL)) {
        f->monitor->spoilt = true;
        return NULL;
    }
    return made;
}

/* Whether some leaf of the letter is unknown, that is, true only in the better reading. */
static bool parts(const judging *g)
{
    int32_t i;
    for (i = 0; i < g->f.form->leaves; i++) {
        if (g->net->leaf[i] == 2U) {
            return true;
        }
    }
    return false;
}

/* Prune now and then, and return to one reading if both agree. Letters up to `position` may not have
 * been stepped yet. */
static void prune_sometimes(judging *g, int64_t position)
{
    const int32_t at = g->j->first;
    int32_t i;
    g->net->visits++;
    if (g->net->visits < TIDY_EVERY) {
        return;
    }
    g->net->visits = 0;
    for (i = 0; i < readings(g); i++) {
        prune(&g->f, &g->net->readings[i], (at >= 0) ? position_of(attempt_of(g, at)) : position);
    }
    if (g->net->parted && !parts(g)
        && networks_agree(&g->f, &g->net->readings[0], &g->net->readings[1])) {
        g->net->parted = false;
    }
}

/* The instant, `now` or later, before which nothing is decided if the letter stays. */
int64_t earliest(const judging *g, int64_t now)
{
    int64_t found = NEVER;
    int32_t i;
    for (i = 0; i < readings(g); i++) {
        found = least(found, earliest_change(&g->f, g->net, i));
    }
    return (found > now) ? found : now;
}

/* The instant up to which to look ahead. */
static int64_t ahead_of(const judging *g, int64_t now)
{
    const int64_t since = now - g->net->searched;
    if (g->f.gap == 0) {
        return now;
    }
    return (since < LIMIT / (2 * FURTHER)) ? least(now + FURTHER * since, LIMIT - 1) : LIMIT - 1;
}

/* Set a judge due at the next instant up to `until` at which an attempt is decided if the letter stays,
 * or else after `until`. The networks are not changed. */
static void foresee(judging *g, int64_t until)
{
    const int64_t decided = step_to_decision(g, until, last_at(g, until));
    unlearn_all(g);
    set_due(g, (decided < NEVER) ? decided : until + 1);
}

/* The same for a judge that is due by `now`: its exact instant matters if a failure starts another
 * attempt (clock.c). */
void network_foresee(run *r, int32_t index, int64_t now)
{
    judging g = judging_of(r, index);
    if ((g.j->first >= 0) && (due_of(&g) <= now) && !is_given_up(&g)) {
        foresee(&g, ahead_of(&g, now));
    }
}

/* Step to `now`, with the letter as it is for positions up to `last`, and decide attempts on the way,
 * each at its instant. */
static void decide_up_to(judging *g, int64_t now, int64_t last)
{
    int64_t decided = -LIMIT;
    while ((g->j->first >= 0) && (decided < NEVER)) {
        decided = step_to_decision(g, now, last);
        judge_added(g, least(decided, now)); /* even if no attempt is decided, one reading may be */
        set_due(g, least(decided, now));
    }
}

/* Let time come to `now`; see decide_up_to(). If letters are known up to there, look ahead. */
static void pass(judging *g, int64_t now, int64_t last)
{
    const bool complete = last == last_at(g, now); /* else the letter at `now` is not read yet */
    if ((g->f.gap > 0) && complete) {
        const int64_t due = earliest(g, now);
        if (due > now) {
            set_due(g, due);
            return;
        }
    }
    decide_up_to(g, now, last);
    if (g->j->first < 0) {
        set_due(g, NEVER);
    } else if (complete) {
        const int64_t until = ahead_of(g, now);
        g->net->searched = now;
        set_due(g, now + 1);
        if (until > now) {
            foresee(g, until);
        }
    } else {
        set_due(g, now);
    }
}

/* Let time come to `now`. `is_position`: the letter stays up to `now`, else it is not known at `now`. */
void network_pass(run *r, int32_t index, int64_t now, bool is_position)
{
    judging g = judging_of(r, index);
    if (!is_given_up(&g)) {
        pass(&g, now, last_at(&g, is_position ? now : now - 1));
    }
}

/* Put off decisions up to `until` to the visit after it, which finds their instants all the same; that
 * saves a search. Not done if a failure may start another attempt of the running episode before that.
 * `lag` remembers how long before the new due instant something may have been decided. */
void network_put_off(run *r, int32_t index, int64_t until)
{
    judge *j = &r->judges[index];
    const int64_t due = r->rules.due[index];
    const bool alone = (j->current < 0) || (r->part->judges[index].again < 0);
    if (alone && (j->first >= 0) && (due <= until)) {
        j->lag += until + 1 - due;
        set_rule_due(r, index, until + 1);
    }
}

/* Read the leaves of a form into `next_leaf`; returns whether they differ from `leaf`. `parted` is set
 * if one is unknown. */
bool read_leaves(const run *r, const form *f, networks *net, bool *parted)
{
    bool changed = false;
    int32_t i;
    for (i = 0; i < f->form->operators.count; i++) {
        const operator_plan *n = &f->nodes[i];
        if (n->kind == OP_LEAF) {
            const int32_t truth = (n->right < 0) ? 0 : (int32_t)r->truth[n->right];
            const uint8_t value = (uint8_t)n->values[truth];
            net->next_leaf[n->left] = value;
            changed = changed || (value != net->leaf[n->left]);
            *parted = *parted || (value == 1U) || (value == 2U);
        }
    }
    return changed;
}

/* From here on `leaf` is the letter that was read. */
static void adopt_next_letter(judging *g)
{
    (void)memcpy(g->net->leaf, g->net->next_leaf, (size_t)g->f.form->leaves);
    g->net->turn = NEVER;
}

/* Visit the position at `t`, whose truths the nodes have. */
static void come_to(judging *g, int64_t t)
{
    network *w = &g->net->readings[0];
    const bool fresh = !g->net->started || ((g->j->first < 0) && (g->f.form->looks_back == 0));
    bool parted = false;
    const bool changed = read_leaves(g->r, &g->f, g->net, &parted);
    int64_t position = (g->f.gap > 0) ? floored(t, g->f.step) : 0;
    int32_t i;
    if (fresh) {
        reset_network(&g->f, w, t, position);
        g->net->started = true;
        g->net->parted = false;
        set_due(g, t);
    } else if (g->j->position == t) {
        return;
    } else if ((g->f.gap > 0) && !changed) {
        pass(g, t, position);
        return;
    } else {
        position = (g->f.gap > 0) ? position : w->last + 1;
        prune_sometimes(g, position);
    }
    g->j->position = t;
    g->net->searched = t;
    g->j->restless = false;
    if (g->f.gap == 0) {
        set_restless(g->r, g->index);
    }
    if (parted && !g->net->parted) {
        copy_network(&g->f, &g->net->readings[1], w);
        g->net->parted = true;
    }
    for (i = 0; (g->f.gap == 0) && (i < readings(g)); i++) {
        ranges *samples = &g->net->readings[i].samples;
        ranges_put(g->f.monitor, samples, samples->end, t, t);
    }
    if (is_spoilt(g)) {
        return;
    }
    g->net->turn = position;
    learn_all(g, t, position);
    if ((due_of(g) - g->j->lag < t) && (decided_position(g) < NEVER)) {
        /* The previous letter may have decided something before `t`: undo the step, and find it. */
        unlearn_all(g);
        g->net->turn = NEVER;
        decide_up_to(g, t - 1, position - 1);
        g->net->turn = position;
        learn_all(g, t, position);
    }
    adopt_next_letter(g);
    judge_added(g, t);
    set_due(g, (g->j->first < 0) ? NEVER : earliest(g, t + 1));
}

void network_come_to(run *r, int32_t index, int64_t t)
{
    judging g = judging_of(r, index);
    if (g.net == NULL) {
        g.net = made_networks(&g.f);
        g.j->net = g.net;
    }
    if (!is_given_up(&g)) {
        come_to(&g, t);
    }
}

/* Start an attempt at `t`, whose letter was read; false: it is decided. */
bool network_enter(run *r, int32_t index, int32_t at, int64_t t)
{
    judging g = judging_of(r, index);
    if (is_given_up(&g)) {
        return true;
    }
    if (g.net->readings[0].last < last_at(&g, t)) {
        learn_all(&g, t, last_at(&g, t));
        judge_added(&g, t);
    }
    attempt_of(&g, at)->due = earliest(&g, t + 1);
    attempt_of(&g, at)->clocks[0] = g.net->readings[0].last;
    return judge_attempt(&g, at, t);
}

/* The trace ends at `end`, and time has come to `reached`. A last step decides everything that time alone
 * decides; a further step of the worse reading applies the rule for the end (`closed`). */
void network_close(run *r, int32_t index, int64_t end, int64_t reached)
{
    judging g = judging_of(r, index);
    if ((g.j->first >= 0) && !is_given_up(&g)) {
        learn_all(&g, reached, last_at(&g, end));
        judge_added(&g, reached); /* before the rule for the end, which decides no attempt */
        g.net->readings[0].closed = end;
        learn(&g.f, g.net, 0, g.net->readings[0].now, g.net->readings[0].last);
    }
}

/* Whether an open attempt is TRUE by the rule for the end of the trace; after network_close(). */
bool network_outlasts(run *r, int32_t index, const attempt *x)
{
    const judging g = judging_of(r, index);
    return (g.net != NULL) && (x->location != FAILED) && !is_spoilt(&g)
           && knows(&g.net->readings[0].nodes[g.root], 1U, position_of(x));
}
