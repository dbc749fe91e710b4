/* What all files of the core use: instants, bits, places, arrays that grow. */
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

/* So much of a duration as whole steps fill. */
static inline int64_t whole_steps(int64_t duration, int64_t step)
{
    return (step == 1) ? duration : duration / step * step; /* a division takes its time */
}

static inline bool is_within(int64_t x, int64_t low, int64_t behind)
{
    return (x >= low) && (x < behind);
}

static inline int64_t least(int64_t a, int64_t b)
{
    return (a < b) ? a : b;
}

/* The stamp of the end of a trace, when time has come to `reached`: twice the instant, one more if its
 * letter is known. */
static inline int64_t stamp_of_end(int64_t end, int64_t reached)
{
    return ((reached > end) && (reached < LIMIT)) ? 2 * reached : 2 * least(end, LIMIT - 1) + 1;
}

/* How many positions of a clock lie within the bounds of time. */
static inline int64_t positions_within(int64_t step)
{
    return (step == 1) ? LIMIT : LIMIT / step;
}

/* The last position of a clock not behind an instant. */
static inline int64_t floored(int64_t t, int64_t step)
{
    if (step == 1) {
        return t;
    }
    return ((t >= 0) || (t % step == 0)) ? t / step : t / step - 1;
}

/* Have a judge look at the position at hand. */
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

/* An instant so much after another one, which is less than LIMIT. */
static inline int64_t sum(int64_t t, int64_t duration)
{
    return (duration >= LIMIT) ? NEVER : t + duration;
}

/* The first instant at which another is no longer in a window of the past. */
static inline int64_t gone_from(int64_t at, int64_t window)
{
    return (window >= LIMIT) ? NEVER : at + window + 1;
}

/* A position so far ahead of another, or behind it; none is farther than the bounds of time. */
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

/* The place of the lowest bit that is set, and of the highest one; there is one. */
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

/* A larger array with what stood in the old one, and zeros behind it; NULL if memory is short, which
 * spoils the run. The same with anything behind it. */
void *widened(rv_monitor *m, void *old, int32_t *room, int64_t wanted, size_t each);
void *enlarged(rv_monitor *m, void *old, int32_t *room, int64_t wanted, size_t each);

#endif
