/* Passing over rows that change nothing: only time advances. Their updates reach the core later: values
 * when rows are examined again (turn_from), staleness before its timer could fire (refresh). */
#include "input/input.h"
#include "rows/rows.h"

#include <math.h>

static int64_t alarm_of_all(const rv_monitor *m)
{
    int64_t found = NEVER;
    int32_t i;
    if (m->is_alone) {
        return m->homes[0].root->at.alarm;
    }
    for (i = 0; i < m->plan.part_count; i++) {
        found = least(found, m->homes[i].alarm);
    }
    return found;
}

/* The last row in [from, row) in which a column has an update; -1: none. */
static int64_t last_given(const batch *s, const column_watch *w, int64_t from, int64_t row)
{
    const uint64_t given = w->given & bits_before(row - s->first) & ~bits_before(from - s->first);
    return (given != 0U) ? s->first + highest_bit(given) : -1;
}

/* Store the value of a row in every reader without evaluating anything: it compares as the previous value
 * does, and only comparisons with constants read it. */
static void hold_in_all(const batch *s, const column_watch *w, int64_t row)
{
    const rv_number value = number_in(w->column, row);
    int32_t i;
    for (i = 0; i < w->reader_count; i++) {
        root_of(s, w, i)->value[w->readers[i].local] = value;
    }
}

/* Apply the rows before `row` to signals that go stale, by postponing their timers. This may postpone
 * alarms. */
static void refresh(batch *s, int64_t row)
{
    bool some = false;
    int32_t i;
    int32_t k;
    for (i = 0; s->perishes && (i < s->columns); i++) {
        const column_watch *w = &s->watches[i];
        const int64_t last = w->perishable ? last_given(s, w, s->fresh, row) : -1;
        for (k = 0; (last >= 0) && (k < w->reader_count); k++) {
            set_stale(root_of(s, w, k), w->readers[k].local, s->times[last]);
            some = true;
        }
        if ((last >= 0) && (w->how == BY_CONSTANTS)) {
            hold_in_all(s, w, last);
        }
    }
    for (i = 0; some && (i < s->m->plan.part_count); i++) {
        home *h = &s->m->homes[i];
        if (h->part->plan->captured == 0) {
            set_alarm(h->root, next_position(h->root));
            h->alarm = h->root->at.alarm;
        }
    }
    s->fresh = row;
}

/* Store the updates of the rows before `row`, and restart the examination at `row`. */
void turn_from(batch *s, int64_t row)
{
    int32_t i;
    if (s->together > 0) {
        refresh(s, row);
        for (i = 0; i < s->columns; i++) {
            const column_watch *w = &s->watches[i];
            const int64_t last = last_given(s, w, s->first, row);
            if ((last >= 0) && (w->how == BY_CONSTANTS) && !w->perishable && (s->m->shapes == NULL)) {
                hold_in_all(s, w, last);
            }
        }
    }
    s->first = row;
    s->fresh = row;
    s->together = 0;
    s->moved = 0;
}

static void pass_to_row(const batch *s, int64_t row)
{
    rv_monitor *m = s->m;
    const int64_t t = s->times[row];
    if (m->is_alone) {
        run *r = m->homes[0].root;
        r->at.after = t;
        if (GAP(r) == 0) {
            r->at.position = t;
        }
    }
    m->last = t;
    m->after = t;
    m->reached = t;
}

/* The first row in [row, end) with something due, or `end`. */
static int64_t first_due(const batch *s, int64_t row, int64_t end)
{
    const int64_t alarm = alarm_of_all(s->m);
    int64_t found = row;
    if (s->times[end - 1] < alarm) {
        return end;
    }
    while (s->times[found] < alarm) {
        found++;
    }
    return found;
}

/* Pass over rows from `row` on that change nothing; returns the first row that may, or the end of the
 * block. When an alarm is due, staleness is refreshed first, as updates passed over may postpone it. */
int64_t pass_over(batch *s, int64_t row)
{
    int64_t at = row;
    while (at < s->count) {
        uint64_t ahead;
        int64_t next;
        int64_t due;
        if (at == s->first + s->together) {
            turn_from(s, at);
            look_ahead(s, at);
            if (s->together == 0) {
                return at;
            }
        }
        ahead = s->moved & ~bits_before(at - s->first);
        next = (ahead != 0U) ? s->first + lowest_bit(ahead) : s->first + s->together;
        due = (next > at) ? first_due(s, at, next) : next;
        if (due > at) {
            if (s->counts && !count_rows(s, at, due)) {
                return at;
            }
            if (s->m->shapes != NULL) {
                measure_rows(s, at, due);
            }
            pass_to_row(s, due - 1);
            settle_rows(s, due - at);
            at = due;
        }
        if (due < next) {
            refresh(s, at);
            if (s->times[at] >= alarm_of_all(s->m)) {
                return at;
            }
        } else if (at < s->first + s->together) {
            return at;
        } else {
            /* The examined rows are used up. */
        }
    }
    return at;
}

void make_ready(batch *s, int64_t row, int64_t end)
{
    if (end > s->first + s->together) {
        turn_from(s, row);
    }
    refresh(s, row);
    catch_up(s);
}

/* Rows up to `end` were judged. The examination of later rows stays valid, unless a signal became
 * unknown, or attempts that matter to margins started or ended. */
void note_judged(batch *s, int64_t end)
{
    bool other = false;        /* whether rows have to be examined again */
    int32_t i;
    s->fresh = end;
    for (i = 0; (s->m->shapes != NULL) && (i < s->columns); i++) {
        const column_watch *w = &s->watches[i];
        other = other || (w->is_idle != is_idle_now(s, w)); /* attempts may have started or ended */
    }
    for (i = 0; s->perishes && (i < s->columns); i++) {
        const column_watch *w = &s->watches[i];
        other = other || (w->perishable
                          && (root_of(s, w, 0)->value[w->readers[0].local].kind == RV_UNKNOWN));
    }
    if (s->together == 0) {
        s->first = end;
    } else if (other) {
        turn_from(s, end);
    } else {
    }
}

/* Which updates of a name can change something, and the interval of values that compare alike. */

static bool all_with_constants(const run *r, const signal_plan *s, int32_t local)
{
    const list atoms = s->on_change[r->at.phase];
    const int32_t *place = LIST(PLAN(r), atoms);
    rv_number constant;
    int32_t i;
    for (i = 0; i < atoms.count; i++) {
        if (!compares_with(r, &r->part->atoms[place[i]], local, &constant)
            || (constant.kind == RV_UNKNOWN)) {
            return false;
        }
    }
    return true;
}

/* Which updates of a signal can change something; all runs of a part hold the same inputs as its
 * root. */
static int32_t signal_matters(const home *h, const column_watch *w, int32_t local)
{
    const run *r = h->root;
    const signal_plan *s = &h->part->signals[local];
    const bool apart = h->part->plan->captured > 0;
    if (((s->flags & (SIGNAL_MARKS | SIGNAL_HISTORY)) != 0) || (r->births[local] < s->births)
        || (r->absent[local] != 0U) || (apart && (s->perishable >= 0))
        || (((s->flags & SIGNAL_CAPTURED) != 0) && (GAP(r) != 1))) {
        return EACH_UPDATE;
    }
    if (apart || ((s->flags & SIGNAL_CAPTURED) != 0)
        || (w->column->kind == RV_COLUMN_BYTE)
        || !all_with_constants(r, s, local)) {
        return EACH_VALUE;
    }
    return BY_CONSTANTS;
}

void learn_how(const batch *s, column_watch *w)
{
    int32_t i;
    w->how = w->is_event ? OCCURRENCES : BY_CONSTANTS;
    w->perishable = false;
    for (i = 0; i < w->reader_count; i++) {
        const home *h = home_of(s, w, i);
        const int32_t local = w->readers[i].local;
        int32_t own;
        if (w->is_event) {
            own = ((h->part->events[local].flags & EVENT_MARKS) != 0) ? EACH_UPDATE : OCCURRENCES;
        } else {
            own = signal_matters(h, w, local);
            w->perishable = w->perishable || (h->part->signals[local].perishable >= 0);
        }
        own = holds_back(h) ? EACH_UPDATE : own;
        w->how = (own < w->how) ? own : w->how;
    }
    if (w->reader_count == 0) {
        w->how = NO_UPDATES;
    }
    w->is_plain = is_plain_column(s, w);
}

/* Find the values that compare as the last one does. */
void learn_between(const batch *s, column_watch *w)
{
    bool bounded = true;
    int32_t i;
    w->between.low = -HUGE_VAL;
    w->between.high = HUGE_VAL;
    for (i = 0; bounded && (i < w->reader_count); i++) {
        bounded = narrow_span(root_of(s, w, i), w->readers[i].local, &w->last, &w->between);
    }
    w->between = bounded ? w->between : NO_SPAN;
}

bool compares_alike(const column_watch *w, const rv_number *value)
{
    return stays_in_span(&w->between, &w->last, value) || same_number(&w->last, value);
}
