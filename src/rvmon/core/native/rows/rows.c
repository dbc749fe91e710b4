/* rv_rows: the loop over the rows of a block. Rows of one instant are one sample; rows that change
 * nothing are passed over (passing.c). */
#include "input/input.h"
#include "rows/rows.h"

#include <string.h>

/* What a column says in a row. */
static int32_t state_in(const rv_column *c, int64_t row)
{
    return (c->says == NULL) ? RV_SAYS_YES : (int32_t)c->says[row];
}

rv_number number_in(const rv_column *c, int64_t row)
{
    rv_number made = UNKNOWN_NUMBER;
    if ((state_in(c, row) != RV_SAYS_YES) || (c->values == NULL)) {
        return made;
    }
    made.kind = RV_WHOLE;
    switch (c->kind) {
    case RV_COLUMN_REAL: return number_of_double(((const double *)c->values)[row]);
    case RV_COLUMN_WHOLE: made.as.whole = ((const int64_t *)c->values)[row]; break;
    default: made.as.whole = ((const uint8_t *)c->values)[row]; break;
    }
    return made;
}

/* Whether an event has a payload in a row. */
static bool has_payload(const column_watch *w, int64_t row)
{
    int32_t i;
    for (i = 0; i < w->fields; i++) {
        if (state_in(&w->column->fields[i], row) != NO_UPDATE) {
            return true;
        }
    }
    return false;
}

static rv_update *next_update(row_sample *made, int32_t name, int32_t says)
{
    rv_update *u = &made->updates[made->count];
    made->count++;
    u->name = name;
    u->says = says;
    u->value = UNKNOWN_NUMBER;
    u->fields = NULL;
    return u;
}

/* The update of a signal at one instant: the last value in the rows of the instant. */
static void add_signal(row_sample *made, const column_watch *w, int64_t row, int64_t end)
{
    int64_t i;
    for (i = end - 1; i >= row; i--) {
        if (state_in(w->column, i) != NO_UPDATE) {
            const rv_number value = number_in(w->column, i);
            const bool known = value.kind != RV_UNKNOWN;
            if (known || !w->ignores_nan) {
                next_update(made, w->column->name, known ? RV_SAYS_YES : RV_SAYS_UNKNOWN)->value
                    = value;
                return;
            }
        }
    }
}

static void add_payload(row_sample *made, const column_watch *w, int64_t row)
{
    rv_number *own = &made->fields[made->field_count];
    int32_t i;
    for (i = 0; i < w->fields; i++) {
        own[i] = number_in(&w->column->fields[i], row);
    }
    made->field_count += w->fields;
    next_update(made, w->column->name, RV_SAYS_YES)->fields = own;
}

/* The updates of an event at one instant: one for each payload in the rows of the instant. Without a
 * payload, one update with the most certain of what the rows say: YES over UNKNOWN over NO. */
static void add_event(row_sample *made, const column_watch *w, int64_t row, int64_t end)
{
    int32_t most = -1;
    bool carried = false;
    int64_t i;
    for (i = row; i < end; i++) {
        const int32_t says = state_in(w->column, i);
        if (says != NO_UPDATE) {
            most = (says > most) ? says : most;
            if ((says == RV_SAYS_YES) && has_payload(w, i)) {
                carried = true;
                add_payload(made, w, i);
            }
        }
    }
    if ((most >= 0) && !carried) {
        (void)next_update(made, w->column->name, most);
    }
}

static void free_sample(rv_monitor *m, row_sample *made, int32_t columns)
{
    if (made->room > 0) {
        const size_t each = (size_t)columns * sizeof *made->updates;
        const size_t fields = (size_t)m->plan.header->fields * sizeof *made->fields;
        arena_give(&m->memory, made->updates, (size_t)made->room * each + 1);
        arena_give(&m->memory, made->fields, (size_t)made->room * fields + 1);
        made->room = 0;
    }
}

/* Make room for a sample of `count` rows; false: memory is short. */
static bool make_room_for(rv_monitor *m, row_sample *made, int64_t count, int32_t columns)
{
    const size_t each = (size_t)columns * sizeof *made->updates;
    const size_t fields = (size_t)m->plan.header->fields * sizeof *made->fields;
    if (count > made->room) {
        void *updates = arena_take(&m->memory, (size_t)count * each + 1);
        void *numbers = arena_take(&m->memory, (size_t)count * fields + 1);
        if ((updates == NULL) || (numbers == NULL)) {
            m->spoilt = true;
            return false;
        }
        free_sample(m, made, columns);
        made->updates = updates;
        made->fields = numbers;
        made->room = count;
    }
    return true;
}

/* The end of the rows that have the instant of `row`. */
static int64_t end_of_instant(const batch *s, int64_t row)
{
    int64_t end = row + 1;
    while ((end < s->count) && (s->times[end] == s->times[row])) {
        end++;
    }
    return end;
}

/* Judge rows [row, end) as one sample. For a single row that was examined, only the updates that may
 * change something are passed on; turn_from later holds the rest. */
static int judge_instant(batch *s, int64_t row, int64_t end)
{
    row_sample *made = &s->sample;
    const int64_t k = row - s->first;
    const bool known = (k < s->together) && (end == row + 1) && (s->m->shapes == NULL);
    int32_t i;
    made->count = 0;
    made->field_count = 0;
    if (!make_room_for(s->m, made, end - row, s->columns)) {
        return RV_NO_MEMORY;
    }
    for (i = 0; i < s->columns; i++) {
        const column_watch *w = &s->watches[i];
        if (known && !bit_at(w->needed, k)) {
            continue;
        }
        if (w->is_event) {
            add_event(made, w, row, end);
        } else {
            add_signal(made, w, row, end);
        }
    }
    return rv_step(s->m, s->times[row], made->updates, made->count);
}

static void begin_column(const batch *s, column_watch *w, const rv_column *c)
{
    const rv_monitor *m = s->m;
    int32_t first;
    int32_t i;
    w->column = c;
    w->is_event = c->name >= m->plan.header->signals;
    w->readers = subscriptions_of(m, c->name, &w->reader_count);
    if (w->is_event && (c->fields != NULL)) {
        w->fields = rv_fields_of(m, c->name - m->plan.header->signals, &first);
    }
    for (i = 0; !w->is_event && (i < w->reader_count); i++) {
        const signal_plan *own = &home_of(s, w, i)->part->signals[w->readers[i].local];
        w->ignores_nan = w->ignores_nan || ((own->flags & SIGNAL_IGNORES_NAN) != 0);
    }
}

/* Allocate the state for examining rows; false: memory is short. */
static bool begin_rows(batch *s, const rv_column *columns)
{
    int32_t i;
    s->watches = arena_take(&s->m->memory, (size_t)(s->columns + 1) * sizeof *s->watches);
    for (i = 0; (s->watches != NULL) && (i < s->columns); i++) {
        begin_column(s, &s->watches[i], &columns[i]);
    }
    return (s->watches != NULL) && begin_measured(s) && begin_counted(s);
}

static void end_rows(batch *s, int64_t row)
{
    if (s->watches != NULL) {
        turn_from(s, row);
        catch_up(s);
        end_measured(s);
        end_counted(s);
        arena_give(&s->m->memory, s->watches, (size_t)(s->columns + 1) * sizeof *s->watches);
    }
}

int rv_rows(rv_monitor *m, const int64_t *times, int64_t count, const rv_column *columns,
            int32_t columns_count, int64_t *done)
{
    batch s;
    int status = RV_OK;
    int64_t row = 0;
    (void)memset(&s, 0, sizeof s);
    s.m = m;
    s.times = times;
    s.count = count;
    s.columns = columns_count;
    if (!begin_rows(&s, columns)) {
        m->spoilt = true;
        status = RV_NO_MEMORY;
    }
    m->defers_margins = m->shapes != NULL;
    while ((status == RV_OK) && (row < count)) {
        row = pass_over(&s, row);
        if (row < count) {
            const int64_t end = end_of_instant(&s, row);
            make_ready(&s, row, end);
            status = judge_instant(&s, row, end);
            if (status == RV_OK) {
                note_judged(&s, end);
                settle_rows(&s, end - row);
                row = end;
            }
        }
    }
    end_rows(&s, row);
    m->defers_margins = false;
    free_sample(m, &s.sample, columns_count);
    *done = row;
    return status;
}
