/* Takes the updates of a sample: held values, births, staleness, occurrences of events.
 *
 * A signal holds its value until the next update. Everything else about an update (`updated`, `changed`,
 * occurrences and their payloads) is valid at one position only: such names are marked, and forgotten
 * once the position is over. The common update, one that changes no comparison, is recognised by the
 * signal's span and costs two comparisons of doubles (`take_update` in input.h).
 *
 * Source: docs/reference/semantics.md, section 1. */
#include "formulas/formulas.h"
#include "input/input.h"
#include "runs/runs.h"

#include <math.h>
#include <string.h>

/* List a name whose update has to be forgotten once this position is over. */
void mark(run *r, int32_t name)
{
    if (r->marked[name] == 0U) {
        r->marked[name] = 1;
        r->marks[r->at.marks_count] = name;
        r->at.marks_count++;
    }
    r->at.gathered = true;
}

/* The position is over: nothing is updated, changed, or occurs any more. */
void forget(run *r)
{
    const int32_t signals = r->part->plan->signals.count;
    int32_t i;
    for (i = 0; i < r->at.marks_count; i++) {
        const int32_t name = r->marks[i];
        r->marked[name] = 0;
        r->updated[name] = 0;
        if (name < signals) {
            r->changed[name] = IS_FALSE;
        } else {
            r->occurs[name - signals] = r->silent[name - signals];
            r->payloads[name - signals].count = 0;
        }
    }
    r->at.marks_count = 0;
}

/* Push an update into the history of the last two; returns the truth of `changed`. */
uint8_t remember(history *h, int64_t t, const rv_number *value)
{
    const bool first = h->updates == 0;
    h->before = h->last;
    h->before_at = h->at;
    h->last = *value;
    h->at = t;
    h->updates = first ? 1 : 2;
    if (first) {
        return IS_FALSE;
    }
    if ((value->kind == RV_UNKNOWN) || (h->before.kind == RV_UNKNOWN)) {
        return IS_UNKNOWN;
    }
    return truth_if(!same_number(value, &h->before));
}

/* Hold a value from `t` on; if it differs from the last one, atoms that read it are read again. */
static void hold(run *r, int64_t t, int32_t local, const rv_number *value)
{
    if (!same_number(value, &r->value[local])) {
        const list atoms = r->part->signals[local].on_change[r->at.phase];
        if (((value->kind == RV_UNKNOWN) != (r->value[local].kind == RV_UNKNOWN))
            && (r->truth_log != NULL)) {
            note_knowledge(r, t, local, value);
        }
        r->value[local] = *value;
        if (recheck_list(r, atoms)) {
            r->spans[local] = NO_SPAN; /* a signal that just changed a truth often does so again: a span
                                        * would not pay */
            return;
        }
    }
    learn_span(r, local);
}

/* Count an update towards a signal's birth: its first known value, then (if `births` is 2) the update
 * after it. Nodes that list it among their births are evaluated again. */
void come_to_birth(run *r, int32_t local, bool known)
{
    const signal_plan *s = &r->part->signals[local];
    if ((r->births[local] < s->births) && (known || (r->births[local] > 0))) {
        const int32_t *nodes = LIST(PLAN(r), s->on_birth);
        int32_t i;
        r->births[local]++;
        if (r->births[local] == s->births) {
            r->at.births_left--;
        }
        for (i = 0; i < s->on_birth.count; i++) {
            mark_dirty(r, nodes[i]);
        }
    }
}

/* Treat a signal as born: it has no source, or its first values may have been lost in an outage. Only
 * a signal whose first value is still to come is unborn. */
void be_born(run *r, int32_t local)
{
    while (r->births[local] < r->part->signals[local].births) {
        come_to_birth(r, local, true);
    }
}

/* Start the timer by which a signal goes stale after an update at `t`. */
void set_stale(run *r, int32_t local, int64_t t)
{
    const signal_plan *s = &r->part->signals[local];
    const int64_t stale_at = sum(t, s->stale_after + 1);
    timers_set(&r->wake, r->part->plan->timers + s->perishable, stale_at);
    /* An update that changes no value sets no other alarm, so this one is set here. */
    r->at.alarm = least(r->at.alarm, stale_at);
}

static void take_signal(run *r, int64_t t, int32_t local, const rv_number *value)
{
    const signal_plan *s = &r->part->signals[local];
    const bool known = value->kind != RV_UNKNOWN;
    if (!known && ((s->flags & SIGNAL_IGNORES_NAN) != 0)) {
        return;
    }
    if (((s->flags & SIGNAL_CAPTURED) != 0) && (r->parent == NULL)) {
        r->at.dirty = true; /* another value may be captured */
    }
    if (s->perishable >= 0) {
        set_stale(r, local, t);
    }
    if (s->births != 0) {
        come_to_birth(r, local, known);
    }
    if ((s->flags & (SIGNAL_MARKS | SIGNAL_HISTORY)) != 0) {
        r->updated[local] = IS_TRUE;
        mark(r, local);
        if ((s->flags & SIGNAL_HISTORY) != 0) {
            const uint8_t changed = remember(&r->history[local], t, value);
            r->changed[local] = (changed > r->changed[local]) ? changed : r->changed[local];
        }
        r->at.dirty = true;
        hold(r, t, local, value);
        (void)recheck_list(r, s->on_update[r->at.phase]);
    } else {
        hold(r, t, local, value);
    }
}

/* Append an occurrence of an event with its payload; if not `known`, it may not have occurred. */
void keep_payload(run *r, int32_t local, bool known, const rv_number *fields)
{
    occurrences *o = &r->payloads[local];
    const int32_t width = r->part->events[local].fields;
    rv_monitor *m = r->home->monitor;
    if (o->count == o->room) {
        int32_t room = o->room;
        int32_t same = o->room;
        uint8_t *flags = enlarged(m, o->known, &room, (int64_t)o->count + 1, 1);
        rv_number *values;
        if (flags == NULL) {
            return;
        }
        o->known = flags;
        values = enlarged(m, o->fields, &same, room,
                          sizeof *values * (size_t)((width > 0) ? width : 1));
        if (values == NULL) {
            return;
        }
        o->fields = values;
        o->room = room;
    }
    o->known[o->count] = known ? 1U : 0U;
    if (width > 0) {
        rv_number *own = &o->fields[o->count * width];
        int32_t i;
        for (i = 0; i < width; i++) {
            own[i] = (known && (fields != NULL)) ? fields[i] : UNKNOWN_NUMBER;
        }
    }
    o->count++;
}

/* Take a report of an event: that it occurs, may occur, or does not (which only `updated` sees). */
static void take_event(run *r, int32_t local, int32_t says, const rv_number *fields)
{
    const event_plan *e = &r->part->events[local];
    const int32_t name = r->part->plan->signals.count + local;
    if (take_pulse(r, local, says)) {
        return;
    }
    if ((e->flags & EVENT_MARKS) != 0) {
        r->updated[name] = IS_TRUE;
        mark(r, name);
        r->at.dirty = true;
    }
    if (says != RV_SAYS_NO) {
        const bool known = says == RV_SAYS_YES;
        const uint8_t occurs = known ? IS_TRUE : IS_UNKNOWN;
        mark(r, name);
        r->occurs[local] = (occurs > r->occurs[local]) ? occurs : r->occurs[local];
        if ((e->flags & EVENT_FIELDS) != 0) {
            keep_payload(r, local, known, fields);
        }
        r->at.dirty = true;
    }
    (void)recheck_list(r, e->on_occurrence[r->at.phase]);
}

rv_number number_given(const rv_update *u)
{
    const bool given = u->value.kind != RV_UNKNOWN;
    rv_number unknown = UNKNOWN_NUMBER;
    unknown.as.whole = (!given && (u->value.as.whole == RV_IS_NAN)) ? RV_IS_NAN : RV_IS_NONE;
    return (given && (u->says == RV_SAYS_YES)) ? u->value : unknown;
}

/* Take one update at `t` in full. Whether an event with a key concerns a run depends on the key. */
void apply_update(run *r, int64_t t, const incoming *in)
{
    const rv_update *u = in->update;
    if ((r->at.lost_count > 0) && take_while_lost(r, t, in)) {
        return;
    }
    if (!in->event) {
        const rv_number number = number_given(u);
        take_signal(r, t, in->local, &number);
    } else if ((r->part->events[in->local].flags & EVENT_KEY) != 0) {
        const int32_t says = says_for_instance(r, u);
        if (says >= 0) {
            take_event(r, in->local, says, u->fields);
        }
    } else {
        take_event(r, in->local, u->says, u->fields);
    }
}

/* Count for rv_stale() that a signal went stale at `t`. Every run notices, so only the root run of the
 * first part that reads it counts. */
static void count_stale(const run *r, int64_t t, int32_t name)
{
    const rv_monitor *m = r->home->monitor;
    const subscription *first = &m->plan.subscriptions[m->plan.subscription_first[name]];
    if ((r == r->home->root) && (r->home == &m->homes[first->part])) {
        rv_staleness *found = &m->stale[name];
        found->first = (found->count == 0) ? t : found->first;
        found->count++;
    }
}

/* A signal becomes unknown at `t`, as its timer fired. */
void go_stale(run *r, int64_t t, int32_t perishable)
{
    const int32_t local = r->part->perishable[perishable];
    rv_number stale = UNKNOWN_NUMBER;
    stale.as.whole = IS_STALE;
    count_stale(r, t, r->part->signals[local].name);
    if (r->at.lost_count > 0) {
        end_loss_when_stale(r, local);
    }
    margins_mark_changed(r, local);
    hold(r, t, local, &stale);
}

/* Make a name unknown at every position. Atoms that are momentary only if it has a source (`needs`) have
 * one reason less to be read again at the next position. */
void mark_absent(run *r, bool event, int32_t local)
{
    const part *p = r->part;
    const int32_t name = event ? p->plan->signals.count + local : local;
    const list needs = event ? p->events[local].needs : p->signals[local].needs;
    const int32_t *atoms = LIST(PLAN(r), needs);
    int32_t i;
    if (r->absent[name] != 0U) {
        return;
    }
    r->absent[name] = 1;
    if (event) {
        r->silent[local] = IS_UNKNOWN;
        r->occurs[local] = IS_UNKNOWN;
    }
    for (i = 0; i < needs.count; i++) {
        r->momentary[atoms[i]]--;
    }
}

/* Declare, before the first position, that a name has no source. */
void declare_no_source(run *r, bool event, int32_t local)
{
    mark_absent(r, event, local);
    if (!event) {
        be_born(r, local);
    }
}
