/* Examining rows ahead: for up to 64 rows, column by column, which updates may change something. Columns
 * that stay within their interval are recognised by loops without branches, which compilers vectorise;
 * as their length is the constant TOGETHER, compilers can unroll them. */
#include "rows/rows.h"

#include <string.h>

static bool are_alike(const rv_number *a, const rv_number *b)
{
    return (a->kind == b->kind)
           && ((a->kind == RV_UNKNOWN) || (memcmp(&a->as, &b->as, sizeof a->as) == 0));
}

/* Whether every number compares as the last one does. */
static inline bool reals_are_within(const double *v, int32_t count, span s, double last)
{
    int32_t beyond = 0;
    int32_t i;
    for (i = 0; i < count; i++) {
        beyond |= (int32_t)(((v[i] > s.low) & (v[i] < s.high)) | (v[i] == last)) ^ 1;
    }
    return beyond == 0;
}

static inline bool wholes_are_within(const int64_t *v, int32_t count, span s, int64_t last)
{
    int32_t beyond = 0;
    int32_t i;
    for (i = 0; i < count; i++) {
        beyond |= (int32_t)((((double)v[i] > s.low) & ((double)v[i] < s.high)) | (v[i] == last)) ^ 1;
    }
    return beyond == 0;
}

static inline bool words_are(const uint64_t *v, int32_t count, uint64_t last)
{
    uint64_t other = 0;
    int32_t i;
    for (i = 0; i < count; i++) {
        other |= v[i] ^ last;
    }
    return other == 0;
}

static inline bool bytes_are(const uint8_t *v, int32_t count, uint8_t last)
{
    uint8_t other = 0;
    int32_t i;
    for (i = 0; i < count; i++) {
        other = (uint8_t)(other | (v[i] ^ last));
    }
    return other == 0;
}

/* Whether no row of a column changes anything; false also if rows have to be examined one by one. Words
 * are compared as bits: equal bits are equal values. */
static bool stays(const column_watch *w, int64_t first, int32_t count)
{
    const rv_column *c = w->column;
    const bool all = count == TOGETHER;
    if ((c->says != NULL) || (w->last.kind == RV_UNKNOWN)) {
        return false;
    }
    if ((w->how == BY_CONSTANTS) && (c->kind == RV_COLUMN_WHOLE)) {
        const int64_t *v = &((const int64_t *)c->values)[first];
        const int64_t last = w->last.as.whole;
        return all ? wholes_are_within(v, TOGETHER, w->between, last)
                   : wholes_are_within(v, count, w->between, last);
    }
    if (w->how == BY_CONSTANTS) {
        const double *v = &((const double *)c->values)[first];
        const double last = w->last.as.real;
        return all ? reals_are_within(v, TOGETHER, w->between, last)
                   : reals_are_within(v, count, w->between, last);
    }
    if (c->kind == RV_COLUMN_BYTE) {
        const uint8_t *v = &((const uint8_t *)c->values)[first];
        const uint8_t last = (uint8_t)w->last.as.whole;
        return all ? bytes_are(v, TOGETHER, last) : bytes_are(v, count, last);
    } else {
        const uint64_t *v = &((const uint64_t *)c->values)[first];
        uint64_t last;
        (void)memcpy(&last, &w->last.as, sizeof last);
        return all ? words_are(v, TOGETHER, last) : words_are(v, count, last);
    }
}

/* The rows whose `says` is between two bounds. */
static uint64_t rows_that_say(const rv_column *c, int64_t first, int32_t count, uint8_t least,
                              uint8_t most)
{
    const uint8_t *says = &c->says[first];
    uint8_t one[TOGETHER] = {0};
    int32_t i;
    for (i = 0; i < count; i++) {
        one[i] = (uint8_t)((says[i] >= least) & (says[i] <= most));
    }
    return bits_of(one);
}

/* The rows at which a Boolean column changes; false if it is not a full block of 0 and 1. */
static bool find_turns(const column_watch *w, int64_t first, int32_t count, uint64_t *found)
{
    const uint8_t *v = &((const uint8_t *)w->column->values)[first];
    uint64_t word;
    uint8_t most = 0;
    int32_t i;
    if ((w->column->kind != RV_COLUMN_BYTE) || (w->column->says != NULL) || (count < TOGETHER)
        || (w->last.kind != RV_WHOLE) || (w->last.as.whole < 0) || (w->last.as.whole > 1)) {
        return false;
    }
    for (i = 0; i < TOGETHER; i++) {
        most = (uint8_t)(most | v[i]);
    }
    word = bits_of(v);
    *found = word ^ ((word << 1) | (uint64_t)w->last.as.whole);
    return most <= 1U;
}

/* Examine the updates of a signal one by one, and mark those that may change something. */
static void look_for_news(const batch *s, column_watch *w, int64_t first)
{
    uint64_t left = w->given;
    while (left != 0U) {
        const int32_t k = lowest_bit(left);
        const uint64_t bit = UINT64_C(1) << k;
        const rv_number value = number_in(w->column, first + k);
        left &= left - 1;
        if (w->ignores_nan && (value.kind == RV_UNKNOWN)) {
            w->given &= ~bit;
        } else if (w->how == EACH_UPDATE) {
            w->needed |= bit;
        } else if ((w->how == BY_CONSTANTS) ? !compares_alike(w, &value)
                                            : !are_alike(&value, &w->last)) {
            w->needed |= bit;
            w->last = value;
            if (w->how == BY_CONSTANTS) {
                learn_between(s, w);
            }
        } else {
            /* Nothing changes. */
        }
    }
}

/* Whether some reader has no staleness timer set, so that the first update has to reach it. */
static bool is_ageless(const batch *s, const column_watch *w)
{
    bool found = false;
    int32_t i;
    for (i = 0; i < w->reader_count; i++) {
        const run *r = root_of(s, w, i);
        const int32_t perishable = r->part->signals[w->readers[i].local].perishable;
        found = found || ((perishable >= 0)
                          && (r->wake.due[r->part->plan->timers + perishable] == NEVER));
    }
    return found;
}

/* The rows whose number is NaN. */
static uint64_t rows_unknown(const rv_column *c, int64_t first, int32_t count)
{
    const double *v = &((const double *)c->values)[first];
    uint64_t found = 0;
    int32_t unknown = 0;
    int32_t i;
    for (i = 0; (c->kind == RV_COLUMN_REAL) && (i < count); i++) {
        unknown |= (int32_t)(v[i] != v[i]);
    }
    for (i = 0; (unknown != 0) && (i < count); i++) {
        found |= (uint64_t)(v[i] != v[i]) << i;
    }
    return found;
}

/* Examine the rows of a column; returns those at which something may change. */
static uint64_t look_at_column(const batch *s, column_watch *w, int64_t first, int32_t count)
{
    const rv_column *c = w->column;
    uint64_t moved;
    w->given = bits_before(count);
    w->needed = 0;
    if (w->is_event) {
        if (c->says != NULL) {
            w->given = rows_that_say(c, first, count, RV_SAYS_NO, RV_SAYS_YES);
            w->needed = rows_that_say(c, first, count, RV_SAYS_UNKNOWN, RV_SAYS_YES);
        } else {
            w->needed = w->given;
        }
        w->needed = (w->how == EACH_UPDATE) ? w->given : w->needed;
        return w->needed;
    }
    if (s->counts && w->is_counted) {
        w->needed = w->given;
        return rows_unknown(c, first, count);
    }
    w->is_idle = is_idle_now(s, w);
    if (w->is_idle) {
        return rows_unknown(c, first, count);
    }
    w->last = root_of(s, w, 0)->value[w->readers[0].local];
    if (w->how == BY_CONSTANTS) {
        learn_between(s, w);
    }
    if ((w->how != EACH_UPDATE) && stays(w, first, count)) {
        moved = 0;
    } else {
        if (c->says != NULL) {
            w->given = rows_that_say(c, first, count, RV_SAYS_UNKNOWN, RV_SAYS_YES);
        }
        if ((w->how == EACH_UPDATE) || !find_turns(w, first, count, &w->needed)) {
            w->needed = 0;
            look_for_news(s, w, first);
        }
        moved = w->needed;
    }
    if (w->perishable) {
        w->needed = w->given;
        moved |= is_ageless(s, w) ? (w->given & (~w->given + 1)) : 0U; /* the first update */
    }
    return moved;
}

/* Rows that rv_step has to see whatever their updates: with stamps that do not ascend, are out of range,
 * or equal the next row's. */
static uint64_t odd_rows(const batch *s, int64_t first, int32_t count)
{
    const int64_t *t = &s->times[first];
    int32_t odd = (first + count < s->count) && (t[count] == t[count - 1]);
    uint64_t found = 0;
    int32_t i;
    for (i = 1; i < count; i++) {
        odd |= (int32_t)(t[i] <= t[i - 1]);
    }
    odd |= (int32_t)(t[0] <= s->m->after) | (int32_t)(t[count - 1] >= LIMIT);
    for (i = 0; (odd != 0) && (i < count); i++) {
        const bool again = (first + i + 1 < s->count) && (t[i + 1] <= t[i]);
        const int64_t before = (i > 0) ? t[i - 1] : s->m->after;
        if (again || (t[i] <= before) || (t[i] >= LIMIT)) {
            found |= UINT64_C(1) << i;
        }
    }
    return found;
}

/* Whether rows may be passed over at all: not before the first position, if samples are stored, or during
 * an outage. */
static bool may_pass_rows(const rv_monitor *m)
{
    int32_t i;
    for (i = 0; i < m->plan.part_count; i++) {
        if (!m->homes[i].root->at.started
            || ((m->homes[i].part->plan->flags & PART_KEEPS_PAST) != 0)) {
            return false;
        }
    }
    return may_pass_measured(m) && !m->finished && !m->spoilt && (m->outage_at == RV_NO_TIME)
           && (m->dense_until == RV_NO_TIME);
}

static bool is_settled(const rv_monitor *m)
{
    int32_t i;
    for (i = 0; i < m->plan.part_count; i++) {
        if (m->homes[i].root->at.phase == 0) {
            return false;
        }
    }
    return true;
}

void look_ahead(batch *s, int64_t row)
{
    const int64_t left = s->count - row;
    int32_t i;
    if (!may_pass_rows(s->m)) {
        return;
    }
    s->together = (left < TOGETHER) ? left : TOGETHER;
    if (!s->known) {
        s->perishes = false;
        for (i = 0; i < s->columns; i++) {
            learn_how(s, &s->watches[i]);
            s->perishes = s->perishes || s->watches[i].perishable;
        }
        s->known = is_settled(s->m);
        if (s->known && (s->counting != NULL)) {
            learn_counted(s);
        }
    }
    s->counts = may_count(s);
    if (!s->counts) {
        catch_up(s);
    }
    s->moved = odd_rows(s, row, (int32_t)s->together);
    if (s->counts && (s->together == left)) {
        s->moved |= UINT64_C(1) << (left - 1); /* the last row is judged, so nothing is left over */
    }
    for (i = 0; i < s->columns; i++) {
        column_watch *w = &s->watches[i];
        w->given = 0;
        w->needed = 0;
        if (w->how != NO_UPDATES) {
            s->moved |= look_at_column(s, w, row, (int32_t)s->together);
        }
    }
}
