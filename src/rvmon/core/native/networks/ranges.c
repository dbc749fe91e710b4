/* Ranges of positions, in order, none touching another. */
#include "basics.h"
#include "networks/ranges.h"

#include <string.h>

/* The first range that ends at a position or behind it. */
int32_t range_from(const ranges *r, int64_t position)
{
    int32_t low = r->first;
    int32_t left = r->end - low;
    if (left == 0) {
        return low;
    }
    if ((left > 1) && (r->at[r->end - 2].last < position)) { /* as mostly */
        low = r->end - 1;
        left = 1;
    }
    while (left > 1) { /* which half is next nobody can foretell: no branch */
        const int32_t half = left / 2;
        low += (r->at[low + half - 1].last < position) ? half : 0;
        left -= half;
    }
    return low + ((r->at[low].last < position) ? 1 : 0);
}

/* The range that holds a position; -1: none does. */
int32_t range_around(const ranges *r, int64_t position)
{
    const int32_t i = range_from(r, position);
    return ((i < r->end) && (r->at[i].first <= position)) ? i : -1;
}

/* The last position in them that is not behind one; less than all if there is none. */
int64_t last_up_to(const ranges *r, int64_t position)
{
    const int32_t i = range_from(r, position);
    int64_t found = -NEVER;
    if ((i < r->end) && (r->at[i].first <= position)) {
        found = position;
    } else if (i > r->first) {
        found = r->at[i - 1].last;
    } else {
        /* They are all behind it. */
    }
    return found;
}

/* Make a list larger; false if memory is short. */
static bool widen(rv_monitor *m, ranges *r)
{
    range *made = enlarged(m, r->at, &r->room, (int64_t)r->room + 1, sizeof *made);
    if (made == NULL) {
        return false;
    }
    r->at = made;
    return true;
}

/* Open a place for a range; returns where it is now, -1 if there is no room. */
static int32_t opened(rv_monitor *m, ranges *r, int32_t place)
{
    int32_t i = place;
    if (r->end == r->room) {
        if (r->first > r->room / 2) {
            (void)memmove(r->at, &r->at[r->first], (size_t)(r->end - r->first) * sizeof *r->at);
            i -= r->first;
            r->end -= r->first;
            r->first = 0;
        } else if (!widen(m, r)) {
            return -1;
        } else {
            /* There is room now. */
        }
    }
    if (i < r->end) {
        (void)memmove(&r->at[i + 1], &r->at[i], (size_t)(r->end - i) * sizeof *r->at);
    }
    r->end++;
    return i;
}

void ranges_put(rv_monitor *m, ranges *r, int32_t place, int64_t first, int64_t last)
{
    const bool behind = (place == r->end) && (place < r->room); /* as mostly */
    const int32_t i = behind ? place : opened(m, r, place);
    r->end += behind ? 1 : 0;
    if (i >= 0) {
        r->at[i].first = first;
        r->at[i].last = last;
    }
}

static void take_out(ranges *r, int32_t i)
{
    (void)memmove(&r->at[i], &r->at[i + 1], (size_t)(r->end - i - 1) * sizeof *r->at);
    r->end--;
}

/* Add positions that lie in no range; `i` is the first range behind them. */
void ranges_insert(rv_monitor *m, ranges *r, int32_t i, int64_t first, int64_t last)
{
    const bool left = (i > r->first) && (r->at[i - 1].last + 1 == first);
    const bool right = (i < r->end) && (last + 1 == r->at[i].first);
    if (left && right) {
        r->at[i - 1].last = r->at[i].last;
        take_out(r, i);
    } else if (left) {
        r->at[i - 1].last = last;
    } else if (right) {
        r->at[i].first = first;
    } else {
        ranges_put(m, r, i, first, last);
    }
}

/* Take out positions that lie in one range. */
void ranges_cut(rv_monitor *m, ranges *r, int64_t first, int64_t last)
{
    const int32_t i = range_around(r, first);
    if (i < 0) {
        return; /* there was no room for them */
    }
    if (r->at[i].first == first) {
        if (r->at[i].last == last) {
            take_out(r, i);
        } else {
            r->at[i].first = last + 1;
        }
    } else {
        const int64_t end = r->at[i].last;
        r->at[i].last = first - 1;
        if (last < end) {
            ranges_put(m, r, i + 1, last + 1, end);
        }
    }
}

/* Drop the ranges that lie wholly before a position. */
void ranges_drop(ranges *r, int64_t before)
{
    while ((r->first < r->end) && (r->at[r->first].last < before)) {
        r->first++;
    }
    if (r->first == r->end) {
        r->first = 0;
        r->end = 0;
    }
}

void ranges_empty(ranges *r)
{
    r->first = 0;
    r->end = 0;
}

void ranges_copy(rv_monitor *m, ranges *made, const ranges *r)
{
    int32_t i;
    ranges_empty(made);
    for (i = r->first; i < r->end; i++) {
        ranges_put(m, made, made->end, r->at[i].first, r->at[i].last);
    }
}

bool ranges_alike(const ranges *one, const ranges *other)
{
    const int32_t count = one->end - one->first;
    bool same_ones = count == other->end - other->first;
    int32_t i;
    for (i = 0; same_ones && (i < count); i++) {
        const range *a = &one->at[one->first + i];
        const range *b = &other->at[other->first + i];
        same_ones = (a->first == b->first) && (a->last == b->last);
    }
    return same_ones;
}
