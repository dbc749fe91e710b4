/* Outages: stretches of time over which a source may have sent anything (a connection that was down, a
 * line that could not be read). rv_lose() and rv_found() report their starts and ends, by name.
 *
 * Being lost is a state of a name, not a value: the name is unknown at *every* position of the outage,
 * like a name without a source, so nothing has to be evaluated there. States of a name:
 *   NOT_LOST -> LOST_ON (since `until`) -> LOST_UNTIL (up to `until`, which time may not have passed)
 *   -> NOT_LOST (event), or LOST_SINCE (signal, unknown until its next update) -> NOT_LOST
 * Updates within the outage are ignored, as a lost one may have followed, except at its last instant:
 * that update came last, is kept, and counts after it. Costs O(atoms that read the name) at either end.
 *
 * Source: docs/reference/semantics.md, section 1 (Outage). */
#include "formulas/formulas.h"
#include "input/input.h"
#include "results/results.h"
#include "runs/runs.h"

#include <string.h>

int32_t names_to_lose(const run *r)
{
    return r->part->plan->signals.count + r->part->plan->events.count;
}

/* Start a run with no name lost. */
void clear_losses(run *r)
{
    const int32_t names = names_to_lose(r);
    r->at.ends_at = NEVER;
    if (names > 0) {
        (void)memset(r->lost, NOT_LOST, (size_t)names);
        (void)memset(r->has_kept, 0, (size_t)names);
    }
}

/* Whether the last instant of a name's outage is a position; if so, the name is unknown there. */
static bool ends_at_position(const run *r, int32_t name)
{
    return tick_from(step_of(r), r->until[name]) == r->until[name];
}

/* Whether the outage of a name covers `t`. At its last instant an update may count (`keeps`), unless
 * that instant is a position. */
bool is_lost_at(const run *r, int32_t name, int64_t t)
{
    if ((r->at.lost_count == 0) || (r->lost[name] != LOST_UNTIL)) {
        return (r->at.lost_count > 0) && (r->lost[name] == LOST_ON);
    }
    return (t < r->until[name])
           || ((t == r->until[name]) && ((r->keeps[name] == 0U) || ends_at_position(r, name)));
}

/* Whether a name is absent because it has no source, not because it is lost. */
bool has_no_source(const run *r, int32_t name)
{
    return (r->absent[name] != 0U) && ((r->at.lost_count == 0) || (r->lost[name] == NOT_LOST));
}

/* Add a name to, or remove it from, the sources that make its atoms momentary. */
static void set_momentary(run *r, int32_t name, bool momentary)
{
    const int32_t signals = r->part->plan->signals.count;
    const list needs = (name < signals) ? r->part->signals[name].needs
                                        : r->part->events[name - signals].needs;
    const int32_t *atoms = LIST(PLAN(r), needs);
    int32_t i;
    for (i = 0; i < needs.count; i++) {
        r->momentary[atoms[i]] = (uint8_t)(r->momentary[atoms[i]] + (momentary ? 1 : -1));
    }
}

/* Read again all atoms of a name. */
static void recheck_name(run *r, int32_t name)
{
    const int32_t signals = r->part->plan->signals.count;
    if (name < signals) {
        recheck_amid(r, r->part->signals[name].on_change[r->at.phase]);
        recheck_amid(r, r->part->signals[name].on_update[r->at.phase]);
    } else {
        recheck_amid(r, r->part->events[name - signals].on_occurrence[r->at.phase]);
    }
    r->at.dirty = true;
}

static uint8_t at_least_unknown(uint8_t truth)
{
    return (truth > IS_UNKNOWN) ? truth : IS_UNKNOWN;
}

/* A signal is lost at `t`, which acts like an update to an unknown value. The signal counts as born,
 * since its first values may have been lost. */
static void lose_signal(run *r, int32_t local, int64_t t)
{
    const signal_plan *s = &r->part->signals[local];
    be_born(r, local);
    if (s->perishable >= 0) {
        timers_set(&r->wake, r->part->plan->timers + s->perishable, NEVER);
    }
    if ((s->flags & SIGNAL_HISTORY) != 0) {
        (void)remember(&r->history[local], t, &UNKNOWN_NUMBER);
    }
    margins_mark_changed(r, local);
    r->value[local] = UNKNOWN_NUMBER;
    r->spans[local] = NO_SPAN;
}

static void lose_name(run *r, int32_t name, int64_t t)
{
    const int32_t signals = r->part->plan->signals.count;
    const uint8_t was = r->lost[name];
    if ((was == LOST_ON) || has_no_source(r, name)) {
        return;
    }
    r->lost[name] = LOST_ON;
    r->until[name] = t; /* the first instant, until the last one is known */
    r->has_kept[name] = 0;
    if (was == LOST_UNTIL) { /* no position has seen the end of the previous outage: it continues */
        return;
    }
    r->at.lost_count += (was == NOT_LOST) ? 1 : 0;
    r->absent[name] = 1;
    set_momentary(r, name, false);
    if (name < signals) {
        lose_signal(r, name, t);
    } else {
        margins_mark_changed(r, name);
        r->silent[name - signals] = IS_UNKNOWN;
    }
    recheck_name(r, name);
}

/* A name is known again. */
static void end_loss(run *r, int32_t name)
{
    r->lost[name] = NOT_LOST;
    r->at.lost_count--;
}

/* The outage of a name is over: an event is known again, a signal waits for its next update. Its stale
 * time counts from `until`, as an update may have come then. */
static void end_outage(run *r, int32_t name, int64_t until)
{
    const int32_t signals = r->part->plan->signals.count;
    r->absent[name] = 0;
    set_momentary(r, name, true);
    if (name >= signals) {
        margins_mark_changed(r, name);
        r->silent[name - signals] = IS_FALSE;
        end_loss(r, name);
    } else {
        r->lost[name] = LOST_SINCE;
        if (r->part->signals[name].perishable >= 0) {
            set_stale(r, name, until);
        }
    }
}

/* End an outage that does not affect the position to come; a kept update becomes the value. */
static void end_outage_before(run *r, int32_t name)
{
    const int32_t signals = r->part->plan->signals.count;
    end_outage(r, name, r->until[name]);
    r->updated[name] = IS_FALSE;
    if (name < signals) {
        r->changed[name] = IS_FALSE;
        if (r->has_kept[name] != 0U) {
            r->has_kept[name] = 0;
            end_loss(r, name);
            if ((r->part->signals[name].flags & SIGNAL_HISTORY) != 0) {
                (void)remember(&r->history[name], r->until[name], &r->kept[name]);
            }
            margins_mark_changed(r, name);
            r->value[name] = r->kept[name];
        }
    } else {
        r->occurs[name - signals] = IS_FALSE;
        r->payloads[name - signals].count = 0;
    }
    recheck_name(r, name);
}

/* End an outage between the last tick of a clock and the one to come. Updates lost since then count at
 * the coming tick, where its names may be updated, changed, or occur. */
static void end_outage_at_tick(run *r, int32_t name)
{
    const int32_t signals = r->part->plan->signals.count;
    end_outage(r, name, r->until[name]);
    mark(r, name);
    r->updated[name] = at_least_unknown(r->updated[name]);
    if (name < signals) {
        r->changed[name] = at_least_unknown(r->changed[name]);
    } else {
        const int32_t event = name - signals;
        r->occurs[event] = at_least_unknown(r->occurs[event]);
        if ((r->part->events[event].flags & EVENT_FIELDS) != 0) {
            keep_payload(r, event, false, NULL);
        }
    }
    recheck_name(r, name);
}

/* End the outage of a name, at a later position or update at `t`. */
static void end_outage_of(run *r, int32_t name, int64_t t)
{
    if (tick_from(step_of(r), r->until[name]) < tick_from(step_of(r), t)) {
        end_outage_before(r, name);
    } else {
        end_outage_at_tick(r, name);
    }
}

/* The first position at which a name can be known again. */
static int64_t position_after(const run *r, int32_t name)
{
    return ends_at_position(r, name) ? r->until[name] + step_of(r)
                                     : tick_from(step_of(r), r->until[name]);
}

static void find_name(run *r, int32_t name, int64_t at)
{
    if (r->lost[name] == LOST_ON) {
        r->lost[name] = LOST_UNTIL;
        /* In an outage of one instant the update there may have come before what was lost. */
        r->keeps[name] = (r->until[name] < at) ? 1 : 0;
        r->until[name] = at;
        r->at.ends_at = least(r->at.ends_at, position_after(r, name));
    }
}

/* Before the position at `t`: end the outages that are over by then. */
void end_outages(run *r, int64_t t)
{
    const int32_t names = names_to_lose(r);
    int32_t i;
    r->at.ends_at = NEVER;
    for (i = 0; i < names; i++) {
        if (r->lost[i] == LOST_UNTIL) {
            if (r->until[i] < t) {
                end_outage_of(r, i, t);
            } else {
                r->at.ends_at = least(r->at.ends_at, position_after(r, i));
            }
        }
    }
}

/* Take an update at `t` while some name is lost; returns whether the update is dropped or kept for
 * later. It ends the outage of a signal that waits for an update. */
bool take_while_lost(run *r, int64_t t, const incoming *in)
{
    const int32_t name = in->event ? r->part->plan->signals.count + in->local : in->local;
    const rv_number *value = (in->update->says == RV_SAYS_YES) ? &in->update->value
                                                                : &UNKNOWN_NUMBER;
    const bool ignored = !in->event && (value->kind == RV_UNKNOWN)
                         && ((r->part->signals[in->local].flags & SIGNAL_IGNORES_NAN) != 0);
    if ((r->lost[name] == NOT_LOST) || ignored) {
        return ignored;
    }
    if (is_lost_at(r, name, t)) {
        if (!in->event && (r->lost[name] == LOST_UNTIL) && (t == r->until[name])
            && (r->keeps[name] != 0U)) {
            r->kept[name] = *value;
            r->has_kept[name] = 1;
        }
        return true;
    }
    if (r->lost[name] == LOST_UNTIL) {
        end_outage_of(r, name, t);
    }
    if (r->lost[name] == LOST_SINCE) {
        end_loss(r, name);
        recheck_name(r, name); /* the truth of `known` is certain again, even if the value is not */
    }
    return false;
}

/* A signal that waits for an update after an outage went stale: now it is certainly unknown. */
void end_loss_when_stale(run *r, int32_t local)
{
    if (r->lost[local] == LOST_SINCE) {
        end_loss(r, local);
        recheck_name(r, local);
    }
}

/* Apply SAYS_LOST and SAYS_FOUND to a run at `t`: positions before `t` are judged first, a position at
 * `t` is judged afterwards. */
void run_take_loss(run *r, int64_t t, const incoming *in, int32_t count)
{
    const int32_t signals = r->part->plan->signals.count;
    int32_t i;
    const int64_t gap = GAP(r);
    if (gap > 0) {
        approach(r, t);
    }
    if ((gap > 0) && (r->part->plan->captured > 0) && (r->at.position < tick_from(gap, t) - gap)) {
        forget_last(r); /* occurrences of the last position are over, although no position has come */
    }
    for (i = 0; i < count; i++) {
        const int32_t name = in[i].event ? signals + in[i].local : in[i].local;
        if (in[i].update->says == SAYS_LOST) {
            lose_name(r, name, t);
        } else {
            find_name(r, name, t);
        }
    }
    if (gap > 0) {
        r->at.awaited = least(r->at.awaited, tick_from(gap, t));
        set_alarm(r, next_position(r));
    }
}

/* Count the names that are lost now; the entry after the last name stands for an outage of no name. */
static void set_losing(rv_monitor *m, int32_t name, bool lost)
{
    if ((m->losing[name] != 0U) != lost) {
        m->losing[name] = lost ? 1 : 0;
        m->losing_count += lost ? 1 : -1;
    }
}

/* In sampled time a lost sample may have been at any tick: while anything is lost each tick may be a
 * position (dense.c), even if no name of the plan is lost. False: memory is short. */
static bool update_losing(rv_monitor *m, int64_t t, const int32_t *names, int32_t count, int32_t says)
{
    const bool lost = says == SAYS_LOST;
    int32_t i;
    for (i = 0; i < count; i++) {
        set_losing(m, names[i], lost);
    }
    if (count == 0) {
        set_losing(m, m->plan.header->signals + m->plan.header->events, lost);
    }
    if (lost && (m->dense_until == RV_NO_TIME)) {
        return begin_dense(m, t);
    }
    if (m->dense_until != RV_NO_TIME) {
        m->dense_until = (m->losing_count > 0) ? NEVER : t;
    }
    return true;
}

/* rv_lose() and rv_found(). An outage before the first sample means that the trace may start there
 * (home_begin_blank). */
static int apply_loss(rv_monitor *m, int64_t t, const int32_t *names, int32_t count, int32_t says)
{
    const size_t size = (size_t)(count + 1) * sizeof(rv_update);
    rv_update *updates;
    int32_t i;
    int code;
    if (!m->finished && !m->spoilt && (t > -LIMIT) && (t <= m->after)) {
        return RV_TOO_EARLY;
    }
    code = rv_advance(m, t);
    if (code != RV_OK) {
        return code;
    }
    if ((says == SAYS_FOUND) && (m->outage_at == RV_NO_TIME)) {
        return RV_OK; /* found, but nothing was ever lost */
    }
    if ((m->plan.header->gap == 0) && !update_losing(m, t, names, count, says)) {
        return RV_NO_MEMORY;
    }
    if ((m->plan.header->gap > 0) && (m->last == RV_NO_TIME) && (m->outage_at == RV_NO_TIME)) {
        for (i = 0; i < m->plan.part_count; i++) {
            home_begin_blank(&m->homes[i], t);
        }
    }
    m->outage_at = (t > m->outage_at) ? t : m->outage_at;
    updates = arena_take(&m->memory, size);
    if (updates == NULL) {
        m->spoilt = true;
        return RV_NO_MEMORY;
    }
    for (i = 0; i < count; i++) {
        updates[i].name = names[i];
        updates[i].says = says;
    }
    if (distribute(m, updates, count)) {
        for (i = 0; i < m->plan.part_count; i++) {
            if (m->homes[i].inbox_count > 0) {
                home_lose(&m->homes[i], t);
            }
        }
    }
    arena_give(&m->memory, updates, size);
    sort_records(m);
    return m->spoilt ? RV_NO_MEMORY : RV_OK;
}

int rv_lose(rv_monitor *m, int64_t since, const int32_t *names, int32_t count)
{
    return apply_loss(m, since, names, count, SAYS_LOST);
}

int rv_found(rv_monitor *m, int64_t at, const int32_t *names, int32_t count)
{
    return apply_loss(m, at, names, count, SAYS_FOUND);
}
