/* Rows of columns: each is a sample, and one that changes nothing is passed over. */
#include "calls.h"

#include <string.h>

#define NO_UPDATE 255
/* So many rows are taken until it is asked which figures they have settled. */
#define ROWS_TOGETHER 64

/* What a column says in a row; NO_UPDATE: nothing. */
static int32_t said(const rv_column *c, int64_t row)
{
    return (c->says == NULL) ? RV_SAYS_YES : (int32_t)c->says[row];
}

static rv_number value_at(const rv_column *c, int64_t row)
{
    rv_number made;
    made.kind = RV_WHOLE;
    switch (c->kind) {
    case RV_COLUMN_REAL: return number_of_double(((const double *)c->values)[row]);
    case RV_COLUMN_WHOLE: made.as.whole = ((const int64_t *)c->values)[row]; break;
    default: made.as.whole = ((const uint8_t *)c->values)[row]; break;
    }
    return made;
}

/* Lay a row out as updates; returns how many there are. */
static int32_t lay_row(const rv_monitor *m, const rv_column *columns, int32_t count, int64_t row,
                       rv_update *updates, rv_number *fields)
{
    const int32_t signals = m->plan.header->signals;
    int32_t made = 0;
    int32_t i;
    for (i = 0; i < count; i++) {
        const rv_column *c = &columns[i];
        const int32_t says = said(c, row);
        rv_update *u = &updates[made];
        if (says == NO_UPDATE) {
            continue;
        }
        (void)memset(u, 0, sizeof *u);
        u->name = c->name;
        u->says = says;
        if (c->name < signals) {
            if (says == RV_SAYS_YES) {
                u->value = value_at(c, row);
            }
        } else if ((says == RV_SAYS_YES) && (c->fields != NULL)) {
            int32_t first;
            const int32_t own = rv_fields_of(m, c->name - signals, &first);
            int32_t k;
            for (k = 0; k < own; k++) {
                if (c->fields[k] == NULL) {
                    (void)memset(&fields[first + k], 0, sizeof *fields);
                } else {
                    fields[first + k] = c->fields[k][row];
                }
            }
            u->fields = &fields[first];
        } else {
            /* What occurs has no payload. */
        }
        made++;
    }
    return made;
}

/* Find the figures that rows have settled which were taken together. */
static void settle_now(rv_monitor *m)
{
    if (m->hurries && !m->spoilt && (m->reached != RV_NO_TIME)) {
        m->hurries = false;
        settle_margins(m, m->reached);
        m->hurries = true;
    }
}

int rv_rows(rv_monitor *m, const int64_t *times, int64_t rows, const rv_column *columns,
            int32_t count, int64_t *done)
{
    rv_update *updates = arena_take(&m->memory, (size_t)(count + 1) * sizeof *updates);
    const size_t fields_size = (size_t)(m->plan.header->fields + 1) * sizeof(rv_number);
    rv_number *fields = arena_take(&m->memory, fields_size);
    int status = RV_OK;
    *done = 0;
    if ((updates == NULL) || (fields == NULL)) {
        m->spoilt = true;
        status = RV_NO_MEMORY;
    }
    m->hurries = m->shapes != NULL;
    while ((status == RV_OK) && (*done < rows)) {
        const int32_t made = lay_row(m, columns, count, *done, updates, fields);
        status = rv_step(m, times[*done], updates, made);
        *done += (status == RV_OK) ? 1 : 0;
        if (m->hurries && (*done % ROWS_TOGETHER == 0)) {
            settle_now(m);
        }
    }
    settle_now(m);
    m->hurries = false;
    arena_give(&m->memory, updates, (size_t)(count + 1) * sizeof *updates);
    arena_give(&m->memory, fields, fields_size);
    return status;
}
