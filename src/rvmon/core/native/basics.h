/* Small helpers that every file of the core uses: arithmetic on instants and positions, lists of
 * the plan, bit scans, growing arrays.
 *
 * An instant is a tick of one nanosecond. A position is where formulas have a truth: every tick
 * (gap 1), every multiple of the gap, or each sample (gap 0). Functions here that take or return
 * the position of a clock count positions, not ticks. */
#ifndef RVMON_BASICS_H
#define RVMON_BASICS_H

#include "state.h"

#define LIST(p, l) (&(p)->lists[(l).first])
#define GAP(r) ((r)->gap)
#define PLAN(r) ((r)->all)

static const rv_number UNKNOWN_NUMBER = {RV_UNKNOWN, {0}};
static const span NO_SPAN = {0.0, 0.0};

static inline int64_t step_of(const run *r)
{
    const int64_t gap = GAP(r);
    return (gap > 0) ? gap : 1;
}

/* A duration rounded down to whole steps. */
static inline int64_t whole_steps(int64_t duration, int64_t step)
{
    return (step == 1) ? duration : duration / step * step; /* the common case, without a division */
}

static inline bool is_within(int64_t x, int64_t low, int64_t end)
{
    return (x >= low) && (x < end);
}

static inline int64_t least(int64_t a, int64_t b)
{
    return (a < b) ? a : b;
}

/* Stamps order what becomes known: 2t when time comes to instant t, 2t + 1 once the letter at t is
 * known. This is the stamp of the end of a trace when time has come to `reached`. */
static inline int64_t stamp_of_end(int64_t end, int64_t reached)
{
    return ((reached > end) && (reached < LIMIT)) ? 2 * reached : 2 * least(end, LIMIT - 1) + 1;
}

/* The largest position number whose instant is below LIMIT. */
static inline int64_t positions_within(int64_t step)
{
    return (step == 1) ? LIMIT : LIMIT / step;
}

/* t / step, rounded down also for negative t: C rounds towards 0. */
static inline int64_t floored(int64_t t, int64_t step)
{
    if (step == 1) {
        return t;
    }
    return ((t >= 0) || (t % step == 0)) ? t / step : t / step - 1;
}

/* Register a judge to look at the current position; `what` is TOUCHED_LETTER, TOUCHED_TRIGGER or
 * both. */
static inline void touch(run *r, int32_t index, uint8_t what)
{
    judge *j = &r->judges[index];
    if (j->touched == 0U) {
        r->touched[r->touched_count] = index;
        r->touched_count++;
    }
    j->touched |= what;
}

static inline uint8_t truth_if(bool value)
{
    return value ? IS_TRUE : IS_FALSE;
}

/* t + duration; NEVER if the duration is unbounded. `t` is below LIMIT, so the sum does not
 * overflow. */
static inline int64_t sum(int64_t t, int64_t duration)
{
    return (duration >= LIMIT) ? NEVER : t + duration;
}

/* The first instant at which a past window of this length no longer contains `at`. */
static inline int64_t gone_from(int64_t at, int64_t window)
{
    return (window >= LIMIT) ? NEVER : at + window + 1;
}

/* A position moved by a distance of either sign, clamped to [-LIMIT, LIMIT]. */
static inline int64_t moved(int64_t position, int64_t distance)
{
    if (distance > 0) {
        return (position > LIMIT - distance) ? LIMIT : position + distance;
    }
    return (position < -LIMIT - distance) ? -LIMIT : position + distance;
}

static inline attempt *attempt_at(const home *h, int32_t i)
{
    return (attempt *)(void *)(h->pool + h->stride * (size_t)i);
}

/* The index of the lowest, and of the highest, bit set in a word that is not 0. */
static inline int32_t lowest_bit(uint64_t word)
{
#if defined(__GNUC__)
    return (int32_t)__builtin_ctzll(word);
#else
    int32_t i = 0;
    while (((word >> i) & 1U) == 0U) {
        i++;
    }
    return i;
#endif
}

static inline int32_t highest_bit(uint64_t word)
{
#if defined(__GNUC__)
    return 63 - (int32_t)__builtin_clzll(word);
#else
    int32_t i = 63;
    while (((word >> i) & 1U) == 0U) {
        i--;
    }
    return i;
#endif
}

/* An array of at least `wanted` elements of `each` bytes, grown by doubling: `old` itself if
 * `*room` suffices. Elements are copied; `widened` leaves the new ones uninitialised, `enlarged`
 * zeroes them. NULL if memory is short, which spoils the run; `old` and `*room` are then unchanged. */
void *widened(rv_monitor *m, void *old, int32_t *room, int64_t wanted, size_t each);
void *enlarged(rv_monitor *m, void *old, int32_t *room, int64_t wanted, size_t each);

#endif
