/* Figures that were found, until somebody takes them; and attempts that wait for theirs.
 *
 * An attempt in doubt has its figure told once it is sure that there was a trigger, or the run is over:
 * before it may be met, and leave none. */
#include "margins/margins.h"

#include <stdlib.h>
#include <string.h>

/* Take it that an attempt begins that is measured; the place of its record, 0 if there is none. */
int32_t measured_attempt(run *r, int64_t triggered, uint32_t number)
{
    rv_monitor *m = r->home->monitor;
    margin_results *s = &m->margins;
    int32_t at = s->free_record;
    margin_record *made;
    if (m->shapes == NULL) {
        return 0;
    }
    if (at > 0) {
        s->free_record = s->records[at - 1].next;
    } else {
        made = enlarged(m, s->records, &s->record_room, (int64_t)s->record_count + 1, sizeof *made);
        if (made == NULL) {
            return 0;
        }
        s->records = made;
        s->record_count++;
        at = s->record_count;
    }
    made = &s->records[at - 1];
    (void)memset(made, 0, sizeof *made);
    made->triggered = triggered;
    made->number = number;
    made->sure = number > 0;
    return at;
}

/* Take it that an attempt has its number, or one among those in doubt; it may have both. */
void margin_numbered(rv_monitor *m, int32_t record, bool sure, uint32_t number)
{
    if (record != 0) {
        margin_record *own = &m->margins.records[record - 1];
        own->sure = own->sure || sure;
        if (sure) {
            own->number = number;
        } else {
            own->doubt_number = number;
        }
    }
}

/* Take it that an attempt in doubt was met: it leaves no figure. */
void margin_vanished(rv_monitor *m, int32_t record)
{
    if (record != 0) {
        m->margins.records[record - 1].vanished = true;
    }
}

/* A figure with whose it is; where nothing triggered it, nothing is owed. */
rv_margin as_told(const rv_monitor *m, const rv_margin *figure, int32_t record)
{
    rv_margin made = *figure;
    if (record != 0) {
        const margin_record *own = &m->margins.records[record - 1];
        made.t = own->triggered;
        made.in_doubt = own->sure ? 0 : 1;
        made.number = own->sure ? own->number : own->doubt_number;
        made.high = own->sure ? made.high : INFINITE;
    }
    return made;
}

/* Room for a figure, where it stays until it is taken; NULL: there is none. */
rv_margin *figure_found(rv_monitor *m, int32_t record)
{
    margin_results *s = &m->margins;
    if ((s->found_count == s->found_room) || (s->found_count == s->owners_room)) {
        rv_margin *made = enlarged(m, s->found, &s->found_room, (int64_t)s->found_count + 1, sizeof *made);
        int32_t *owners =
            enlarged(m, s->owners, &s->owners_room, (int64_t)s->found_count + 1, sizeof *owners);
        s->found = (made != NULL) ? made : s->found;
        s->owners = (owners != NULL) ? owners : s->owners;
        if ((made == NULL) || (owners == NULL)) {
            return NULL;
        }
    }
    s->owners[s->found_count] = record;
    s->found_count++;
    return &s->found[s->found_count - 1];
}

static void free_record(margin_results *s, int32_t record)
{
    s->records[record - 1].next = s->free_record;
    s->free_record = record;
}

/* By instant, then requirement, then attempts before positions. */
static int margins_compared(const void *one, const void *other)
{
    const rv_margin *a = one;
    const rv_margin *b = other;
    if (a->t != b->t) {
        return (a->t < b->t) ? -1 : 1;
    }
    if (a->requirement != b->requirement) {
        return (a->requirement < b->requirement) ? -1 : 1;
    }
    if (a->of_position != b->of_position) {
        return (int)a->of_position - (int)b->of_position;
    }
    if (a->in_doubt != b->in_doubt) {
        return (int)a->in_doubt - (int)b->in_doubt;
    }
    return (a->number == b->number) ? 0 : ((a->number < b->number) ? -1 : 1);
}

static bool is_to_be_told(const rv_monitor *m, int32_t record)
{
    const margin_record *own = (record == 0) ? NULL : &m->margins.records[record - 1];
    return (own == NULL) || own->sure || m->finished;
}

/* Bring what can be told to the front; what vanished is dropped. */
int64_t rv_margins(rv_monitor *m, const rv_margin **margins)
{
    margin_results *s = &m->margins;
    const int32_t first = s->ready;
    int32_t waiting = 0;
    int32_t i;
    *margins = s->found;
    for (i = first; i < s->found_count; i++) {
        const int32_t record = s->owners[i];
        rv_margin figure;
        if ((record == 0) && (i == s->ready)) {
            s->ready++; /* as mostly */
            continue;
        }
        figure = s->found[i];
        if ((record != 0) && s->records[record - 1].vanished) {
            free_record(s, record);
        } else if (is_to_be_told(m, record)) {
            s->found[s->ready + waiting] = s->found[s->ready];
            s->owners[s->ready + waiting] = s->owners[s->ready];
            s->found[s->ready] = as_told(m, &figure, record);
            s->owners[s->ready] = 0;
            s->ready++;
            if (record != 0) {
                free_record(s, record);
            }
        } else {
            s->found[s->ready + waiting] = figure;
            s->owners[s->ready + waiting] = record;
            waiting++;
        }
    }
    s->found_count = s->ready + waiting;
    for (i = first + 1; i < s->ready; i++) {
        if (margins_compared(&s->found[i - 1], &s->found[i]) > 0) {
            qsort(&s->found[first], (size_t)(s->ready - first), sizeof *s->found, margins_compared);
            break;
        }
    }
    return s->ready;
}

void rv_forget_margins(rv_monitor *m)
{
    margin_results *s = &m->margins;
    const int32_t left = s->found_count - s->ready;
    if ((s->ready > 0) && (left > 0)) {
        (void)memmove(s->found, &s->found[s->ready], (size_t)left * sizeof *s->found);
        (void)memmove(s->owners, &s->owners[s->ready], (size_t)left * sizeof *s->owners);
    }
    s->found_count = left;
    s->ready = 0;
}

void rv_measure_positions(rv_monitor *m)
{
    m->measures_positions = m->shapes != NULL;
}

/* Begin another run. */
void margins_reset(rv_monitor *m)
{
    m->margins.found_count = 0;
    m->margins.ready = 0;
    m->margins.record_count = 0;
    m->margins.free_record = 0;
}
