/* What was not known of signals, when, and why: for notes of attempts that hang on it. The runs of a part
 * hear the same of signals, so the first one keeps it for all. */
#include "attempts/attempts.h"
#include "formulas/formulas.h"
#include "input/input.h"
#include "notes/notes.h"
#include "results/results.h"
#include "runs/runs.h"

#include <string.h>

#define SPARE_UNKNOWNS 64

/* Nothing is known of any signal; false: memory is short. */
bool begin_unknowns(home *h)
{
    rv_monitor *m = h->monitor;
    const int32_t signals = h->part->plan->signals.count;
    int32_t i;
    if (h->unknown_of == NULL) {
        h->unknown_of = arena_take(&m->memory, ((size_t)signals + 1U) * sizeof *h->unknown_of);
        h->unknowns = enlarged(m, NULL, &h->unknown_room, (int64_t)signals + SPARE_UNKNOWNS,
                            sizeof *h->unknowns);
        if ((h->unknown_of == NULL) || (h->unknowns == NULL)) {
            return false;
        }
    }
    for (i = 0; i < signals; i++) {
        h->unknowns[i].since = RV_NO_TIME;
        h->unknowns[i].until = NEVER;
        h->unknowns[i].local = i;
        h->unknowns[i].why = NEVER_KNOWN_YET;
        h->unknown_of[i] = i;
    }
    h->unknown_count = signals;
    return true;
}

/* The first instant at which something was unknown that open attempts hang on. */
static int64_t first_doubt(home *h)
{
    int64_t found = NEVER;
    run *r;
    int32_t i;
    for (r = h->root; r != NULL; r = following(h, r)) {
        for (i = 0; i < r->part->plan->judges.count; i++) {
            const judge *j = &r->judges[i];
            const truths *doubts = &j->noting->doubts;
            if ((doubts->count > 0) && (has_attempts(j) || (j->undecidable >= 0))) {
                const int32_t words = words_for(r->part->judges[i].leaves.count);
                found = least(found, entry_of(doubts, 0, words)[0]);
            }
        }
    }
    return found;
}

/* Drop what is over before anything that open attempts hang on. */
static void drop_unknowns(home *h)
{
    const int64_t first = first_doubt(h);
    int32_t kept = 0;
    int32_t i;
    for (i = 0; i < h->unknown_count; i++) {
        const int32_t local = h->unknowns[i].local;
        const bool last = h->unknown_of[local] == i;
        if (h->unknowns[i].until > first) {
            h->unknowns[kept] = h->unknowns[i];
            h->unknown_of[local] = last ? kept : h->unknown_of[local];
            kept++;
        } else {
            h->unknown_of[local] = last ? -1 : h->unknown_of[local];
        }
    }
    h->unknown_count = kept;
}

/* Take it that a signal has a value that is known, or another one. */
void note_knowledge(run *r, int64_t t, int32_t local, const rv_number *value)
{
    home *h = r->home;
    const int32_t last = h->unknown_of[local];
    unknown_stretch *made;
    if (r != h->root) {
        return;
    }
    if (value->kind != RV_UNKNOWN) {
        if ((last >= 0) && (h->unknowns[last].until == NEVER)) {
            h->unknowns[last].until = t;
        }
        return;
    }
    if (h->unknown_count == h->unknown_room) {
        drop_unknowns(h);
        if (2 * (int64_t)h->unknown_count >= h->unknown_room) { /* else it would be full again soon */
            made = enlarged(h->monitor, h->unknowns, &h->unknown_room, (int64_t)h->unknown_room + 1,
                         sizeof *made);
            if (made == NULL) {
                return;
            }
            h->unknowns = made;
        }
    }
    made = &h->unknowns[h->unknown_count];
    made->since = t;
    made->until = NEVER;
    made->local = local;
    made->why = (int32_t)value->as.whole;
    h->unknown_of[local] = h->unknown_count;
    h->unknown_count++;
}

/* Whether one matters that was not known now, or at a doubt. */
static bool matters_at(const unknown_stretch *one, int64_t doubt)
{
    return (one->until == NEVER)
           || ((doubt != RV_NO_TIME) && (one->since <= doubt) && (one->until > doubt));
}

/* How many words `put_unknowns` takes. */
int64_t unknowns_count(const run *r, int64_t doubt)
{
    const home *h = r->home;
    const int32_t names = r->part->plan->signals.count + r->part->plan->events.count;
    int64_t found = 1;
    int32_t i;
    for (i = 0; i < h->unknown_count; i++) {
        found += matters_at(&h->unknowns[i], doubt) ? 3 : 0;
    }
    for (i = 0; i < names; i++) {
        found += has_no_source(h->root, i) ? 3 : 0;
    }
    return found;
}

/* Tell what was not known now, and at a doubt: how many; of each the name, from bit 32 on why; since when;
 * until when, or NEVER. */
void put_unknowns(const run *r, int64_t doubt, int64_t *to)
{
    const home *h = r->home;
    const part *p = r->part;
    const int32_t signals = p->plan->signals.count;
    int64_t *own = &to[1];
    int32_t i;
    for (i = 0; i < h->unknown_count; i++) {
        const unknown_stretch *one = &h->unknowns[i];
        if (matters_at(one, doubt)) {
            own[0] = p->signals[one->local].name | ((int64_t)one->why << 32);
            own[1] = one->since;
            own[2] = one->until;
            own += 3;
        }
    }
    for (i = 0; i < signals + p->plan->events.count; i++) {
        if (has_no_source(h->root, i)) {
            const int32_t name = (i < signals) ? p->signals[i].name : p->events[i - signals].name;
            own[0] = name | ((int64_t)HAS_NO_SOURCE << 32);
            own[1] = RV_NO_TIME;
            own[2] = NEVER;
            own += 3;
        }
    }
    to[0] = (own - to - 1) / 3;
}

/* Positions that may not be there: of a trace that may have begun in an outage, those before its first
 * sample. Every formula is unknown there, constants too.
 *
 * What looks back is told so once, and remembers it. Attempts that begin there are in doubt: what they
 * owe there will never be known, so that they stay open for good; an episode can still fail by what it
 * owes later.
 *
 * Source: the law, section 1 (Outage). */

/* Before the first sample something was lost from `t` on: the trace may begin there. */
void await_blank_start(run *r, int64_t t)
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
    margins_miss(r, t);
    remember_unknown(r, t);
    blank_out(r, t);
    if (r->part->is_watched) {
        call_watches(r);
        watch(r, t);
    }
    for (i = 0; i < r->part->plan->judges.count; i++) {
        const int32_t trigger = followed(r, i);
        if (needs_every_position(r, i)) {
            visit_judge(r, i, t);
        }
        if ((trigger >= 0) && take_trigger(r, i, IS_UNKNOWN)) {
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
static void resume_episode(run *r, int32_t index, int64_t t)
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

void resume_episodes(run *r, int64_t t)
{
    int32_t i;
    for (i = 0; (GAP(r) > 0) && (i < r->part->plan->judges.count); i++) {
        if (runs_on(r, i) && (r->judges[i].current >= 0)) {
            resume_episode(r, i, t);
        }
    }
    r->at.presence = ARE_THERE;
}
