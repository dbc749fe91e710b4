/* Positions that may not be there: of a trace that may have begun in an outage, those before its first
 * sample. Every formula is unknown there, constants too.
 *
 * What looks back is told so once, and remembers it. Attempts that begin there are in doubt: what they
 * owe there will never be known, so that they stay open for good; an episode can still fail by what it
 * owes later.
 *
 * Source: the law, section 1 (Outage). */
#include "attempts/attempts.h"
#include "formulas/formulas.h"
#include "input/input.h"
#include "results/results.h"
#include "runs/runs.h"

/* Before the first sample something was lost from `t` on: the trace may begin there. */
void may_begin(run *r, int64_t t)
{
    r->at.presence = MAY_BE_THERE;
    r->at.awaited = tick_from(GAP(r), t);
}

/* Come to the first position that may be there. */
void begin_blank(run *r, int64_t t)
{
    int32_t i;
    r->at.started = true;
    r->at.origin = t;
    r->at.begun = NEVER;
    r->at.position = t;
    r->at.awaited = NEVER;
    r->opening = false;
    if (r == r->home->root) {
        r->opens_at = -LIMIT; /* whatever occurs is unknown */
    }
    margins_miss(r);
    remember_unknown(r, t);
    blank_out(r, t);
    if (r->part->is_watched) {
        touch_all(r, 0);
        watch(r, t);
    }
    for (i = 0; i < r->part->plan->judges.count; i++) {
        const int32_t trigger = followed(r, i);
        if (watches(r, i)) {
            visit_judge(r, i, t);
        }
        if ((trigger >= 0) && starts(r, i, IS_UNKNOWN)) {
            begin(r, i, t, t);
        }
    }
    if (r->part->plan->captured > 0) {
        look_after(r, t);
    }
}

/* Come to the first position that is surely there. */
void end_blank(run *r, int64_t t)
{
    r->at.starting = IS_FALSE;
    if (r->at.begun == NEVER) {
        r->at.starting = IS_UNKNOWN;
        r->at.begun = t;
    }
    look_at_all(r);
}

/* Have the episode that runs be judged from here on. */
static void revive(run *r, int32_t index, int64_t t)
{
    judge *j = &r->judges[index];
    const int32_t at = j->current;
    attempt *x = attempt_at(r->home, at);
    int32_t *link = &j->undecidable;
    while (*link != at) {
        link = &attempt_at(r->home, *link)->next;
    }
    *link = x->next;
    x->next = -1;
    x->parted = false;
    x->better = FAILED;
    x->location = (r->part->judges[index].automaton >= 0) ? r->part->machines[index].initial
                                                          : WAITING;
    if (!has_attempts(j) || (j->position < t)) {
        visit_judge(r, index, t);
    }
    enter(r, index, at, t);
}

void revive_all(run *r, int64_t t)
{
    int32_t i;
    for (i = 0; (GAP(r) > 0) && (i < r->part->plan->judges.count); i++) {
        if (runs_on(r, i) && (r->judges[i].current >= 0)) {
            revive(r, i, t);
        }
    }
    r->at.presence = ARE_THERE;
}
