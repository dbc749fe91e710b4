/* Two subjects about unknown input: when and why signals were unknown, which notes of undecided attempts
 * report; and positions that may not exist.
 *
 * The first is a list of stretches, one for each time that a signal was unknown, kept by the root run
 * of a part for all its runs. When it is full, stretches that ended before the first doubt of an open
 * attempt are dropped. */
#include "attempts/attempts.h"
#include "formulas/formulas.h"
#include "input/input.h"
#include "notes/notes.h"
#include "results/results.h"
#include "runs/runs.h"

#include <string.h>

#define SPARE_UNKNOWNS 64 /* room at first, in addition to one stretch per signal */

/* Start a run: every signal is unknown, as it was never known yet. False: memory is short. */
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

/* The earliest doubt that is noted for a judge with open attempts. */
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

/* Drop the stretches that ended before the first doubt of any judge. */
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

/* Note that a signal became known or unknown at `t`. */
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
        if (2 * (int64_t)h->unknown_count >= h->unknown_room) { /* little was dropped: grow, so that the
                                                                 * cost stays amortised O(1) */
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

/* Whether the notes of a judge report a stretch: a leaf reads the signal, which is still unknown or was
 * unknown at the doubt. */
static bool is_reported(const run *r, int32_t index, const unknown_stretch *one, int64_t doubt)
{
    const list names = r->part->judges[index].names;
    const int32_t *name = LIST(PLAN(r), names);
    int32_t left = names.count;
    if ((one->until != NEVER) && ((doubt == RV_NO_TIME) || (one->since > doubt) || (one->until <= doubt))) {
        return false;
    }
    while (left > 1) {
        const int32_t half = left / 2;
        name += (name[half] <= one->local) ? half : 0;
        left -= half;
    }
    return (left == 1) && (*name == one->local);
}

/* The number of words that put_unknowns() writes. */
int64_t unknowns_count(const run *r, int32_t index, int64_t doubt)
{
    const home *h = r->home;
    const list names = r->part->judges[index].names;
    int64_t found = 1;
    int32_t i;
    for (i = 0; i < h->unknown_count; i++) {
        found += is_reported(r, index, &h->unknowns[i], doubt) ? 3 : 0;
    }
    for (i = 0; i < names.count; i++) {
        found += has_no_source(h->root, LIST(PLAN(r), names)[i]) ? 3 : 0;
    }
    return found;
}

/* Write why names that a judge's leaves read were unknown: the stretches that last still or cover `doubt`
 * (RV_NO_TIME: none), and the names without a source. First their number; then for each the name, with
 * the cause from bit 32 on, since when, and until when (NEVER: it lasts). */
void put_unknowns(const run *r, int32_t index, int64_t doubt, int64_t *to)
{
    const home *h = r->home;
    const part *p = r->part;
    const int32_t signals = p->plan->signals.count;
    const list names = p->judges[index].names;
    int64_t *own = &to[1];
    int32_t i;
    for (i = 0; i < h->unknown_count; i++) {
        const unknown_stretch *one = &h->unknowns[i];
        if (is_reported(r, index, one, doubt)) {
            own[0] = p->signals[one->local].name | ((int64_t)one->why << 32);
            own[1] = one->since;
            own[2] = one->until;
            own += 3;
        }
    }
    for (i = 0; i < names.count; i++) {
        const int32_t local = LIST(PLAN(r), names)[i];
        if (has_no_source(h->root, local)) {
            const int32_t name = (local < signals) ? p->signals[local].name : p->events[local - signals].name;
            own[0] = name | ((int64_t)HAS_NO_SOURCE << 32);
            own[1] = RV_NO_TIME;
            own[2] = NEVER;
            own += 3;
        }
    }
    to[0] = (own - to - 1) / 3;
}

/* ---- blank positions
 *
 * If something was lost before the first sample, the trace may have started there: the positions from
 * the outage to the first sample may exist or not. Every formula is unknown at them, constants too.
 *
 * Past operators take one step with unknown operands for the whole stretch. Attempts that start there
 * are in doubt, and their obligations there stay unknown. So they are never decided, except for an
 * episode, which can still fail at a later position (resume_episode).
 *
 * Source: docs/reference/semantics.md, section 1 (Outage). */

/* Something was lost from `t` on, before the first sample: the trace may start there. */
void await_blank_start(run *r, int64_t t)
{
    r->at.presence = MAY_BE_THERE;
    r->at.awaited = tick_from(GAP(r), t);
}

/* The first blank position, which represents all of them: attempts that may start there are started. */
void begin_blank(run *r, int64_t t)
{
    int32_t i;
    r->at.started = true;
    r->at.origin = t;
    r->at.sure_from = NEVER;
    r->at.position = t;
    r->at.awaited = NEVER;
    r->opening = false;
    if (r == r->home->root) {
        r->opens_at = -LIMIT; /* an occurrence may have been lost: attempts with unknown key */
    }
    margins_miss(r, t);
    remember_unknown(r, t);
    blank_out(r, t);
    if (r->part->is_watched) {
        call_watches(r);
        watch(r, t);
    }
    for (i = 0; i < r->part->plan->judges.count; i++) {
        const int32_t trigger = trigger_node(r, i);
        if (needs_every_position(r, i)) {
            visit_judge(r, i, t);
        }
        if ((trigger >= 0) && take_trigger(r, i, IS_UNKNOWN)) {
            begin(r, i, t, t);
        }
    }
    if (r->part->plan->captured > 0) {
        check_children(r, t);
    }
}

/* The first position that certainly exists, and may be the first of all: `start` is UNKNOWN. */
void end_blank(run *r, int64_t t)
{
    r->at.starting = IS_FALSE;
    if (r->at.sure_from == NEVER) {
        r->at.starting = IS_UNKNOWN;
        r->at.sure_from = t;
    }
    recheck_all(r);
}

/* Judge the running episode from `t` on: it was parked among the undecidable attempts, as its
 * obligations at blank positions are unknown, but it can fail at the positions from here on. */
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

/* The same for all episodes of a run. In sampled time dense.c handles outages. */
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
