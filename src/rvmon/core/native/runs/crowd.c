/* Which runs a part has, and which of them a call concerns: those that time wakes, and those that the
 * values of its events name. The others sleep on, however many there are. */
#include "formulas/formulas.h"
#include "notes/notes.h"
#include "runs/runs.h"

#include <string.h>

/* A larger array of whatever runs have by number; the old one stays if memory is short. */
static void *resized(rv_monitor *m, void *old, int32_t room, size_t each)
{
    int32_t same = room;
    return enlarged(m, old, &same, (int64_t)room + 1, each);
}

/* Give a run that is new its number; false: memory is short. */
bool register_run(home *h, run *r)
{
    rv_monitor *m = h->monitor;
    const int32_t room = h->run_room;
    int32_t same = room;
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
    h->alarms.due[r->id] = NEVER;
    h->run_count++;
    return true;
}

/* Take it that a run comes to something in this call. */
void touch_run(run *r)
{
    if (!r->touched_now) {
        r->touched_now = true;
        r->home->touched[r->home->touched_count] = r;
        r->home->touched_count++;
    }
}

/* Add a run to those that attempts start in, or to those of one attempt each. */
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

/* Take a run out of its list, and put it aside. */
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
    set_aside(h, r);
}

void set_aside(home *h, run *r)
{
    int32_t i;
    timers_set(&h->alarms, r->id, NEVER);
    for (i = 0; i < r->part->plan->judges.count; i++) {
        clear_noting(r, i);
    }
    r->next = h->spare;
    h->spare = r;
}

/* The run behind another: those that attempts start in, then those of attempts. */
run *following(const home *h, const run *r)
{
    return ((r == h->last_root) && (r->next == NULL)) ? h->captured : r->next;
}

/* An instant before which nothing happens in a run, no sample being taken. */
static int64_t alarm_of(const run *r)
{
    return r->at.started ? r->at.alarm : ((GAP(r) > 0) ? r->at.awaited : NEVER);
}

/* Set the alarms of what was touched. */
void set_alarms(home *h)
{
    int32_t i;
    for (i = 0; i < h->touched_count; i++) {
        timers_set(&h->alarms, h->touched[i]->id, alarm_of(h->touched[i]));
    }
    h->alarm = timers_next(&h->alarms);
}

/* Those with an alarm by `t`: numbers of runs in `called`. */
int32_t call_due(home *h, int64_t t)
{
    return timers_due(&h->alarms, t, h->called);
}

/* Whether a run is of one attempt, and so comes after the one that its attempt was triggered in. */
static bool is_of_attempt(const run *r)
{
    return r->parent != NULL;
}

/* Do something with some runs: those that attempts start in, then those of attempts. What these make
 * meanwhile has come to `t` already. */
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

/* The field of an event whose value says whom it concerns; -1: all. */
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

/* Call a run, unless it is called already. */
static int32_t called_with(home *h, int32_t count, run *r)
{
    if (r->call == h->call) {
        return count;
    }
    r->call = h->call;
    h->called[count] = r->id;
    return count + 1;
}

static int32_t called_with_children(home *h, int32_t count, run *r)
{
    int32_t found = called_with(h, count, r);
    run *child;
    for (child = r->first_child; child != NULL; child = child->sibling) {
        found = called_with(h, found, child);
    }
    return found;
}

/* Those that the sample at hand concerns, or time; -1: all. */
int32_t call_concerned(home *h, int64_t t)
{
    int32_t count;
    int32_t i;
    if ((h->part->plan->each == 0)
        || ((h->monitor->shapes != NULL) && (h->monitor->plan.header->gap == 0))) {
        return -1; /* each sample is a position of what is measured */
    }
    for (i = 0; i < h->inbox_count; i++) {
        if (key_of(h, &h->inbox[i]) == NULL) {
            return -1;
        }
    }
    h->call++;
    count = call_due(h, t);
    for (i = 0; i < count; i++) {
        h->runs[h->called[i]]->call = h->call;
    }
    count = called_with_children(h, count, h->root);
    for (i = 0; i < h->inbox_count; i++) {
        run *r = instance_of(h, key_of(h, &h->inbox[i]));
        if (r != NULL) {
            count = called_with_children(h, count, r);
        }
    }
    return count;
}
