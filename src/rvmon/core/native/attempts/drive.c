/* Takes all attempts of a judge through positions and time, and decides them.
 *
 * Three ways: a *visit* reads the letter at a position; a *pass* lets time go on with the letter as it
 * is; a *reach* comes to an instant whose letter is not known yet, so that only deadlines before it and
 * time itself can decide. Each attempt has a `due`: the next instant at which it changes though its
 * letter does not; the judge's timer (`rules`) is the least of them. A visit with the letter of before
 * touches only attempts that are due. A judge is *restless* if an attempt may move again at the next
 * position though nothing changes; it *slides* if some clock is reset at each tick, so that such clocks
 * have to be brought up to date before another letter comes.
 *
 * Networks and chains of windows have visits and passes of their own, which are called from here. */
#include "attempts/attempts.h"
#include "formulas/formulas.h"
#include "notes/notes.h"
#include "results/results.h"
#include "windows/windows.h"

#include <string.h>

/* How attempts are taken: a letter at one position; the same letter at all positions from one instant
 * to another; time without a position. */
enum { BY_STEP, BY_RUN, BY_TIME };

void set_rule_due(run *r, int32_t index, int64_t due)
{
    timers_set(&r->rules, index, due);
}

/* Have a judge visit the next position, even if nothing changes there. */
void set_restless(run *r, int32_t index)
{
    judge *j = &r->judges[index];
    j->restless = true;
    if (!j->is_restless_listed) {
        j->is_restless_listed = true;
        r->restless[r->restless_count] = index;
        r->restless_count++;
    }
}

/* One way of taking the attempts of a judge. */
typedef struct {
    run *r;
    judge *j;
    const machine *a;
    int32_t index;
    int32_t how;               /* BY_STEP, BY_RUN, BY_TIME */
    int64_t from;              /* BY_RUN: the first position; BY_TIME: where time comes from */
    int64_t t;                 /* the last instant */
} drive_context;

/* Take one reading; returns the instant of its decision (location FAILED or PASSED), or else the next
 * instant at which it changes though the letter does not. */
static int64_t drive_token(const drive_context *g, token *k, int32_t letter)
{
    const machine *a = g->a;
    int64_t due;
    if (g->r->truth_log != NULL) {
        hold_token(g->r->home->monitor, a, k->location, k->clocks);
    }
    if (g->how == BY_STEP) {
        const bool moved = step_token(a, k, g->t, letter);
        if (k->location <= PASSED) {
            due = g->t;
        } else if (!rests(a, k, g->t, letter, &due, &g->j->slides) && moved) {
            set_restless(g->r, g->index);
            due = g->t + 1;
        } else {
            /* `due` is the next cut: until then only another letter moves it. */
        }
    } else if (g->how == BY_RUN) {
        due = run_token(a, k, letter, g->from, g->t, &g->j->slides);
    } else {
        due = settle_token(a, k, g->from, g->t);
        if ((a->gap > 0) && (k->location > PASSED)) {
            due = least(due, g->t); /* the letter at `t` is not read yet: keep the attempt due */
        }
    }
    return due;
}

/* Decide an attempt at `t`. A jump BY_RUN may have left the noted state behind: step it up to `t`, as
 * the reason tells where the attempt stood just before. */
static void decide_driven(const drive_context *g, int32_t at, bool passed, int32_t letter, int64_t t)
{
    if ((g->r->truth_log != NULL) && (g->how == BY_RUN)) {
        hold_until(g->r->home->monitor, g->a, letter, g->from, t);
    }
    decide(g->r, g->index, at, passed, t);
}

/* Take both readings of one attempt; false: it is decided. The worse one decides a pass, the better one
 * a failure; the opposite outcome of a reading only ends that reading. */
static bool drive_readings(const drive_context *g, int32_t at, attempt *x)
{
    const machine *a = g->a;
    const int32_t clocks = a->clocks;
    const int32_t width = g->r->part->plan->clocks;
    token worse;
    token better;
    const bool was_parted = x->parted;
    int64_t own = NEVER;
    worse.moves = NULL; /* edges are counted where they are certain */
    better.moves = NULL;
    worse.location = x->location;
    worse.clocks = x->clocks;
    better.location = x->parted ? x->better : x->location;
    better.clocks = x->clocks + width;
    if (!x->parted) {
        (void)memcpy(better.clocks, worse.clocks, (size_t)clocks * sizeof *worse.clocks);
    }
    if (worse.location != FAILED) {
        own = drive_token(g, &worse, g->j->letter);
        if (worse.location == PASSED) {
            x->location = PASSED;
            decide_driven(g, at, true, g->j->letter, own);
            return false;
        }
        own = (worse.location == FAILED) ? NEVER : own;
    }
    if (better.location != PASSED) {
        const int64_t other = drive_token(g, &better, g->j->other);
        if (better.location == FAILED) {
            decide_driven(g, at, false, g->j->other, other);
            return false;
        }
        own = (better.location == PASSED) ? own : least(own, other);
    }
    x->location = worse.location;
    x->better = better.location;
    x->parted = better.location != worse.location;
    if (!x->parted) {
        const int32_t used = a->widths[worse.location];
        x->parted = memcmp(better.clocks, worse.clocks, (size_t)used * sizeof *worse.clocks) != 0;
    }
    if ((g->r->truth_log != NULL) && (x->parted != was_parted)) {
        note_parting(g->r, g->index, x);
    }
    x->due = own;
    return true;
}

/* Take one attempt and set when it is due; false: it is decided. */
static bool drive(const drive_context *g, int32_t at, attempt *x)
{
    int64_t due;
    token k;
    if (x->parted || (g->j->letter != g->j->other)) {
        return drive_readings(g, at, x);
    }
    k.location = x->location;
    k.clocks = x->clocks;
    k.moves = x->sure ? moves_of(g->r, g->index) : NULL;
    due = drive_token(g, &k, g->j->letter);
    x->location = k.location;
    if (k.location <= PASSED) {
        decide_driven(g, at, k.location == PASSED, g->j->letter, due);
        return false;
    }
    x->due = due;
    return true;
}

static drive_context drive_context_of(run *r, int32_t index, int32_t how, int64_t from, int64_t t)
{
    drive_context g;
    g.r = r;
    g.j = &r->judges[index];
    g.a = &r->part->machines[index];
    g.index = index;
    g.how = how;
    g.from = from;
    g.t = t;
    return g;
}

/* Take all attempts, unlink those that are decided or can never be, and set the judge's timer. With
 * `was` the letter is the one of before and no clock slides: attempts that are not due by `t` stay, and
 * as the list is sorted by `due` the first of them ends the loop. */
static void drive_all(run *r, int32_t index, int32_t how, int64_t from, int64_t t, bool was)
{
    const drive_context g = drive_context_of(r, index, how, from, t);
    judge *j = g.j;
    const bool some = (g.a->gap > 0) && was && j->sorted;
    int64_t next_due = NEVER;
    int64_t latest = INT64_MIN;
    int32_t before = -1;
    int32_t at = j->first;
    j->sorted = true;
    while (at >= 0) {
        attempt *x = attempt_at(r->home, at);
        const int32_t next = x->next;
        const bool waits = some && (x->due > t); /* sorted: so do all after it */
        if (!waits && !drive(&g, at, x)) {
            remove_attempt(r, index, before, at);
        } else if (is_undecidable(x)) {
            move_to_undecidable(r, index, before, at);
        } else {
            next_due = least(next_due, x->due);
            j->sorted = j->sorted && (latest <= x->due);
            latest = x->due;
            before = at;
        }
        if (waits) {
            break;
        }
        at = next;
    }
    set_rule_due(r, index, next_due);
}

/* Pass: let time come to `t` with the letter as it is, through all positions up to `t`. Where only
 * samples are positions (gap 0) there are none. */
void pass_to(run *r, int32_t index, int64_t t)
{
    judge *j = &r->judges[index];
    const int64_t position = j->position;
    const int64_t step = step_of(r);
    if (!has_attempts(j)) {
        set_rule_due(r, index, NEVER);
    } else if (j->first < 0) {
        queue_pass(r, index, t);
        if (GAP(r) > 0) {
            j->position = (t > position) ? t : position;
            j->restless = false; /* what moves at the next position is due there */
        }
    } else if (is_chained(r, index)) {
        chain_pass(r, index, t, true);
    } else if (is_networked(r, index)) {
        network_pass(r, index, t, true);
    } else if (GAP(r) == 0) {
        if (r->rules.due[index] <= t) {
            set_restless(r, index);
        }
        drive_all(r, index, BY_TIME, position, t, false);
    } else if (t > position) {
        const bool slid = j->slides;
        j->slides = false;
        drive_all(r, index, BY_RUN, position + step, t, !slid);
        j->position += whole_steps(t - position, step);
        j->restless = false;
    } else {
        /* The judge has seen `t`. */
    }
}

/* The same in an outage where only samples are positions, but any tick may be one: attempts of an
 * automaton read the (unknown) letter at every tick up to `t`. */
void pass_ticks(run *r, int32_t index, int64_t t)
{
    judge *j = &r->judges[index];
    if (!queue_is_empty(j)) {
        dissolve_queue(r, index, j->position);
    }
    if (has_attempts(j)) {
        drive_all(r, index, BY_RUN, j->position + 1, t, false);
        set_restless(r, index);
    }
    j->position = t;
}

/* Step the queue, if it is not empty. */
static void step_or_rest(run *r, int32_t index, int64_t t)
{
    if (queue_is_empty(&r->judges[index])) {
        set_rule_due(r, index, NEVER);
    } else {
        queue_visit(r, index, t);
    }
}

/* Visit: take a judge to the position at `t`, whose truths the nodes have. Positions between the last
 * visit and `t` had the letter of before: they are passed first if something was due or slides. */
void visit_judge(run *r, int32_t index, int64_t t)
{
    judge *j = &r->judges[index];
    int32_t letter;
    int32_t other;
    bool was;
    if ((r->truth_log != NULL) && is_networked(r, index)) {
        keep_letter(r, index, t);
    }
    if (is_chained(r, index)) {
        chain_visit(r, index, t);
        return;
    }
    if (is_networked(r, index)) {
        network_come_to(r, index, t);
        return;
    }
    letter = class_of_letter(r, index, false);
    other = letter;
    if ((j->worse != j->better) || (r->part->judges[index].diagram >= 0)) {
        other = class_of_letter(r, index, true);
    }
    was = (GAP(r) > 0) && (letter == j->letter) && (other == j->other);
    if (!queue_is_empty(j)) {
        if (r->rules.due[index] < t) {
            queue_pass(r, index, t - 1);
        }
        if (letter != other) {
            dissolve_queue(r, index, t - 1);
        }
    }
    if (!was || !has_attempts(j) || (r->rules.due[index] <= t) || j->restless || j->slides) {
        if (j->slides || (r->rules.due[index] < t)) {
            pass_to(r, index, t - 1);
        }
        was = was && !j->slides;
        j->letter = letter;
        j->other = other;
        j->restless = false;
        j->slides = false;
        j->position = t;
        if (j->first < 0) {
            step_or_rest(r, index, t);
        } else {
            drive_all(r, index, BY_STEP, t, t, was);
        }
    }
    j->position = t;
}

/* Reach: let time come to `t`, whose letter is not known yet; before it all have the old one. */
void reach_judge(run *r, int32_t index, int64_t t)
{
    judge *j = &r->judges[index];
    if (is_chained(r, index)) {
        chain_pass(r, index, t, false);
        return;
    }
    if (is_networked(r, index)) {
        if (j->first >= 0) {
            network_pass(r, index, t, false);
        } else {
            set_rule_due(r, index, NEVER);
        }
        return;
    }
    pass_to(r, index, t - 1);
    if (j->first < 0) {
        if (!queue_is_empty(j)) {
            queue_reach(r, index, t);
        }
        return;
    }
    if (r->rules.due[index] <= t) {
        set_restless(r, index);
    }
    drive_all(r, index, BY_TIME, j->position, t, !j->slides);
}

/* Have an attempt read the letter at `t`, its first position; false: it is decided. */
bool drive_from(run *r, int32_t index, int32_t at, int64_t t)
{
    const drive_context g = drive_context_of(r, index, BY_STEP, t, t);
    attempt *x = attempt_at(r->home, at);
    if (x->sure && (g.j->letter == g.j->other)) {
        count_begin(r, index, t);
    }
    return drive(&g, at, x);
}
