/* The runs of a part, and which of them a call concerns: those with an alarm, those with the key of an
 * event of the sample, and those in which a signal leaves the span in which no comparison changes. All
 * other runs are not looked at, so the cost of a call does not depend on the number of instances. */
#include "attempts/attempts.h"
#include "formulas/formulas.h"
#include "input/input.h"
#include "notes/notes.h"
#include "runs/runs.h"
#include "windows/windows.h"

#include <string.h>

/* Grow one of the arrays by id; NULL: memory is short, and the old array stays valid. */
static void *resized(rv_monitor *m, void *old, int32_t room, size_t each)
{
    int32_t same = room;
    return enlarged(m, old, &same, (int64_t)room + 1, each);
}

/* Give a new run its id; false: memory is short. */
bool register_run(home *h, run *r)
{
    rv_monitor *m = h->monitor;
    const bool apart = h->part->plan->captured > 0;
    const int32_t room = h->run_room;
    int32_t same = room;
    if ((h->run_count == room) && apart && !widen_values(h)) {
        return false;
    }
    if (h->run_count == room) {
        run **touched = resized(m, h->touched, room, sizeof *touched);
        run **runs = resized(m, h->runs, room, sizeof *runs);
        int64_t *due = resized(m, h->alarms.due, room, sizeof *due);
        int32_t *ids = resized(m, h->alarms.ids, room, sizeof *ids);
        int32_t *place = resized(m, h->alarms.place, room, sizeof *place);
        int32_t *called = enlarged(m, h->called, &same, (int64_t)room + 1, sizeof *called);
        h->touched = (touched != NULL) ? touched : h->touched;
        h->runs = (runs != NULL) ? runs : h->runs;
        h->alarms.due = (due != NULL) ? due : h->alarms.due;
        h->alarms.ids = (ids != NULL) ? ids : h->alarms.ids;
        h->alarms.place = (place != NULL) ? place : h->alarms.place;
        h->called = (called != NULL) ? called : h->called;
        if ((touched == NULL) || (runs == NULL) || (due == NULL) || (ids == NULL) || (place == NULL)
            || (called == NULL)) {
            return false;
        }
        h->run_room = same;
    }
    r->id = h->run_count;
    h->runs[r->id] = r;
    if (apart) {
        const size_t first = (size_t)r->id * (size_t)h->part->plan->signals.count;
        r->value = &h->values[first];
        r->spans = &h->spans[first];
    }
    h->alarms.due[r->id] = NEVER;
    h->run_count++;
    return true;
}

/* Store a run at an index of `touched`. */
static void put_touched(home *h, int32_t place, run *r)
{
    h->touched[place] = r;
    r->touched_at = place + 1;
}

/* Record that a run does something in this call, so that its alarm is set again. */
void touch_run(run *r)
{
    home *h = r->home;
    forget_spans(r);
    if (r->touched_at == 0) {
        put_touched(h, h->touched_count, r);
        h->touched_count++;
    } else if (r->touched_at <= h->alarmed) {
        h->alarmed--;
        put_touched(h, r->touched_at - 1, h->touched[h->alarmed]);
        put_touched(h, h->alarmed, r);
    } else {
        /* It will be. */
    }
}

/* Close the gaps that released runs leave in `touched`. */
void drop_gone(home *h)
{
    int32_t kept = 0;
    int32_t i;
    for (i = 0; i < h->touched_count; i++) {
        if (h->touched[i] != NULL) {
            h->touched[kept] = h->touched[i];
            kept++;
        }
    }
    h->touched_count = kept;
}

void untouch_all(home *h)
{
    int32_t i;
    for (i = 0; i < h->touched_count; i++) {
        h->touched[i]->touched_at = 0;
    }
    h->touched_count = 0;
    h->alarmed = 0;
}

/* Append a run to the list of root and instances, or to that of runs of attempts. */
void enlist(run *r, bool captured)
{
    home *h = r->home;
    run **last = captured ? &h->last_captured : &h->last_root;
    r->next = NULL;
    r->previous = *last;
    if (*last != NULL) {
        (*last)->next = r;
    } else if (captured) {
        h->captured = r;
    } else {
        h->root = r;
    }
    *last = r;
}

/* Remove a run from its list and release it. */
void delist(run *r, bool captured)
{
    home *h = r->home;
    if (r->previous != NULL) {
        r->previous->next = r->next;
    } else if (captured) {
        h->captured = r->next;
    } else {
        h->root = r->next;
    }
    if (r->next != NULL) {
        r->next->previous = r->previous;
    } else if (captured) {
        h->last_captured = r->previous;
    } else {
        h->last_root = r->previous;
    }
    recycle_run(h, r);
}

void recycle_run(home *h, run *r)
{
    int32_t i;
    timers_set(&h->alarms, r->id, NEVER);
    for (i = 0; i < r->part->plan->judges.count; i++) {
        clear_noting(r, i);
    }
    r->next = h->spare;
    r->is_spare = true;
    h->spare = r;
}

/* The next run: the root and instances first, then the runs of attempts, so that a run comes after the
 * one in which its attempt was triggered. */
run *following(const home *h, const run *r)
{
    return ((r == h->last_root) && (r->next == NULL)) ? h->captured : r->next;
}

/* The instant before which nothing happens in a run without a sample. */
static int64_t alarm_of(const run *r)
{
    return r->at.started ? r->at.alarm : ((GAP(r) > 0) ? r->at.awaited : NEVER);
}

/* Set the alarms of the runs touched since the last time, and that of the home. */
void set_alarms(home *h)
{
    for (; h->alarmed < h->touched_count; h->alarmed++) {
        const run *r = h->touched[h->alarmed];
        timers_set(&h->alarms, r->id, alarm_of(r));
    }
    h->alarm = timers_next(&h->alarms);
}

/* Put the ids of runs with an alarm up to `t` into `called`; returns how many. */
int32_t call_due(home *h, int64_t t)
{
    return timers_due(&h->alarms, t, h->called);
}

/* Whether a run is that of an attempt. */
static bool is_of_attempt(const run *r)
{
    return r->parent != NULL;
}

/* Call `act` for the called runs, parents before children. Runs that it creates have already come to `t`
 * and are not visited. */
void for_called(home *h, int32_t count, int64_t t, void (*act)(run *r, int64_t t))
{
    int32_t pass;
    int32_t i;
    for (pass = 0; pass < 2; pass++) {
        for (i = 0; i < count; i++) {
            run *r = h->runs[h->called[i]];
            if (is_of_attempt(r) == (pass == 1)) {
                touch_run(r);
                act(r, t);
            }
        }
    }
}

/* The key in the payload of an event; NULL: the event concerns every instance. */
static const rv_number *key_of(const home *h, const incoming *in)
{
    const rv_update *u = in->update;
    int32_t field;
    if (!in->event || (u->says != RV_SAYS_YES) || (u->fields == NULL)) {
        return NULL;
    }
    field = h->part->events[in->local].key;
    if ((field < 0) || (u->fields[field].kind == RV_UNKNOWN)) {
        return NULL;
    }
    return &u->fields[field];
}

/* Whether runs may miss parts of the inbox that change nothing in them: updates at certain positions, of
 * which only truths are read. */
static bool may_be_missed(const home *h, const incoming *in)
{
    const run *root = h->root;
    return (in->update->says == RV_SAYS_YES) && (h->monitor->shapes == NULL) && (GAP(root) > 0)
           && root->at.started && (root->at.presence == ARE_THERE) && (root->at.lost_count == 0);
}

/* Whether the runs of attempts need not hear of an event. */
static bool is_start(const home *h, const incoming *in)
{
    return (h->part->starts_only[in->local] != 0) && (h->root->at.phase == 1) && may_be_missed(h, in);
}

/* Whether runs may hold a signal's value without being called. */
static bool may_be_held(const home *h, const incoming *in)
{
    return (in->update->value.kind != RV_UNKNOWN) && may_be_missed(h, in);
}

/* Add a run to `called` unless it is in it already. */
int32_t called_with(home *h, int32_t count, run *r)
{
    if (r->call == h->call) {
        return count;
    }
    r->call = h->call;
    h->called[count] = r->id;
    return count + 1;
}

/* Add a run that an event concerns, and those of its attempts, unless the event only starts attempts. */
static int32_t called_by_event(home *h, int32_t count, run *r, const incoming *in)
{
    int32_t found = called_with(h, count, r);
    run *child;
    if (is_start(h, in)) {
        return found;
    }
    for (child = r->first_child; child != NULL; child = child->sibling) {
        found = called_with(h, found, child);
    }
    return found;
}

/* Add the root and all instances. */
static int32_t called_instances(home *h, int32_t count)
{
    int32_t found = count;
    run *one;
    for (one = h->root; one != NULL; one = one->next) {
        found = called_with(h, found, one);
    }
    return found;
}

/* Put the called instances in the order of their list, after the runs of attempts, as attempts that they
 * start are listed in that order. */
static void put_in_order(home *h, int32_t count)
{
    int32_t kept = 0;
    int32_t i;
    const run *one;
    for (i = 0; i < count; i++) {
        if (is_of_attempt(h->runs[h->called[i]])) {
            h->called[kept] = h->called[i];
            kept++;
        }
    }
    for (one = h->root; one != NULL; one = one->next) {
        if (one->call == h->call) {
            h->called[kept] = one->id;
            kept++;
        }
    }
}

/* Put the ids of the runs that the sample or an alarm concerns into `called`; returns how many, -1: all.
 * A key's instance is called with the runs of its attempts; the root is always called, as others are
 * forked from it; and so is each run in which a signal may change a comparison. */
int32_t call_affected(home *h, int64_t t)
{
    int32_t count;
    int32_t keyed = 0;
    int32_t i;
    if ((h->monitor->plan.header->gap == 0) && ((h->part->plan->each == 0) || (h->monitor->shapes != NULL))) {
        return -1; /* every sample is a position that attempts read, or that is measured */
    }
    for (i = 0; i < h->inbox_count; i++) {
        const bool has_key = key_of(h, &h->inbox[i]) != NULL;
        const incoming *in = &h->inbox[i];
        if (in->event ? !(has_key || is_start(h, in)) : !may_be_held(h, in)) {
            return -1;
        }
        keyed += has_key ? 1 : 0;
    }
    h->call++;
    count = call_due(h, t);
    for (i = 0; i < count; i++) {
        h->runs[h->called[i]]->call = h->call;
    }
    count = called_with(h, count, h->root);
    for (i = 0; i < h->inbox_count; i++) {
        const incoming *in = &h->inbox[i];
        const rv_number *value = key_of(h, in);
        run *r = (value != NULL) ? instance_of(h, value) : NULL;
        if (!in->event) {
            count = called_by_value(h, count, in->local, &in->update->value);
        } else if (value == NULL) {
            count = called_instances(h, count);
        } else {
            count = called_by_event(h, count, h->root, in);
            count = (r != NULL) ? called_by_event(h, count, r, in) : count;
        }
    }
    if ((h->part->plan->each != 0) && (keyed < h->inbox_count)) {
        put_in_order(h, count);
    }
    return count;
}
