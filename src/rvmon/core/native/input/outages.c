/* Stretches of time over which a source may have said anything: a line that was down, or that could not
 * be read. Whose names are lost is a state of them, entered and left by `rv_lose` and `rv_found`; it is
 * no value, which a step could pass over.
 *
 * While a name is lost it is as one without a source: unknown at every position, so nothing has to be
 * looked at there. What comes of it meanwhile is left out, but for what bears the last instant: that
 * came last, and counts behind it.
 *
 * Source: the law, section 1 (Outage). */
#include "formulas/formulas.h"
#include "input/input.h"
#include "results/results.h"
#include "runs/runs.h"

#include <string.h>

int32_t names_to_lose(const run *r)
{
    return r->part->plan->signals.count + r->part->plan->events.count;
}

void clear_losses(run *r)
{
    const int32_t names = names_to_lose(r);
    r->at.ends_at = NEVER;
    if (names > 0) {
        (void)memset(r->lost, NOT_LOST, (size_t)names);
        (void)memset(r->has_kept, 0, (size_t)names);
    }
}

/* Whether the last instant of what was lost of a name is a position, which that hides. */
static bool ends_at_position(const run *r, int32_t name)
{
    return tick_from(step_of(r), r->until[name]) == r->until[name];
}

bool is_lost_at(const run *r, int32_t name, int64_t t)
{
    if ((r->at.lost_count == 0) || (r->lost[name] != LOST_UNTIL)) {
        return (r->at.lost_count > 0) && (r->lost[name] == LOST_ON);
    }
    return (t < r->until[name])
           || ((t == r->until[name]) && ((r->keeps[name] == 0U) || ends_at_position(r, name)));
}

bool has_no_source(const run *r, int32_t name)
{
    return (r->absent[name] != 0U) && ((r->at.lost_count == 0) || (r->lost[name] == NOT_LOST));
}

/* Have atoms that speak of one position only if a name has a source do so, or not. */
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

/* Read anew what reads a name. */
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

/* What was lost of a signal may have been its first values; it is as an update to what is unknown. */
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
    r->until[name] = t; /* its first instant, till the last one is known */
    r->has_kept[name] = 0;
    if (was == LOST_UNTIL) {
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

/* An update ends what is lost of a signal. */
static void end_loss(run *r, int32_t name)
{
    r->lost[name] = NOT_LOST;
    r->at.lost_count--;
}

/* Have what was lost up to `until` be behind. */
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

/* The same with nothing of it at the position that follows. */
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

/* The same between two ticks of a clock: what was lost counts at the next one, beside what came. */
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

static void end_outage_of(run *r, int32_t name, int64_t t)
{
    if (tick_from(step_of(r), r->until[name]) < tick_from(step_of(r), t)) {
        end_outage_before(r, name);
    } else {
        end_outage_at_tick(r, name);
    }
}

/* The first position that may find a name known again. */
static int64_t position_behind(const run *r, int32_t name)
{
    return ends_at_position(r, name) ? r->until[name] + step_of(r)
                                     : tick_from(step_of(r), r->until[name]);
}

static void find_name(run *r, int32_t name, int64_t at)
{
    if (r->lost[name] == LOST_ON) {
        r->lost[name] = LOST_UNTIL;
        /* Of one instant nobody can say that what came there came last. */
        r->keeps[name] = (r->until[name] < at) ? 1 : 0;
        r->until[name] = at;
        r->at.ends_at = least(r->at.ends_at, position_behind(r, name));
    }
}

/* Come to the position at `t`: what was lost up to the one before is behind. */
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
                r->at.ends_at = least(r->at.ends_at, position_behind(r, i));
            }
        }
    }
}

/* See to an update while something is lost; tells whether it does not count, or not yet. */
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
        recheck_name(r, name); /* that its value is not known, too, is known by then */
    }
    return false;
}

/* A signal that was lost, and not updated since, has become stale. */
void end_loss_when_stale(run *r, int32_t local)
{
    if (r->lost[local] == LOST_SINCE) {
        end_loss(r, local);
        recheck_name(r, local);
    }
}

/* Tell a run what is lost, or found, at `t`, to which it has come; the position there is still to be
 * looked at. */
void run_take_loss(run *r, int64_t t, const incoming *in, int32_t count)
{
    const int32_t signals = r->part->plan->signals.count;
    int32_t i;
    const int64_t gap = GAP(r);
    if (gap > 0) {
        approach(r, t);
    }
    if ((gap > 0) && (r->part->plan->captured > 0) && (r->at.position < tick_from(gap, t) - gap)) {
        forget_last(r); /* else what occurred there is still looked at by what begins at `t` */
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

static void set_losing(rv_monitor *m, int32_t name, bool lost)
{
    if ((m->losing[name] != 0U) != lost) {
        m->losing[name] = lost ? 1 : 0;
        m->losing_count += lost ? 1 : -1;
    }
}

/* Where only samples are positions, each tick may be one while anything is lost, be it nothing. */
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

/* Have some names be lost, or found, at `t`. */
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
    if ((says == SAYS_FOUND) && (m->heard == RV_NO_TIME)) {
        return RV_OK; /* nothing was lost so far */
    }
    if ((m->plan.header->gap == 0) && !update_losing(m, t, names, count, says)) {
        return RV_NO_MEMORY;
    }
    if ((m->plan.header->gap > 0) && (m->last == RV_NO_TIME) && (m->heard == RV_NO_TIME)) {
        for (i = 0; i < m->plan.part_count; i++) {
            home_begin_blank(&m->homes[i], t);
        }
    }
    m->heard = (t > m->heard) ? t : m->heard;
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
