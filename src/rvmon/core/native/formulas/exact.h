/* Sums of numbers as they are: fixed point that has every bit of a double, so that a sum forgets
 * nothing, and is the same whatever came and went before. */
#ifndef RVMON_EXACT_H
#define RVMON_EXACT_H

#include "basics.h"

/* Add a number so many times, or take it off; the same of its square, to a sum of those. */
void exact_add(uint32_t *sum, const rv_number *number, int64_t times, bool off);
void exact_add_square(uint32_t *squares, const rv_number *number, int64_t times, bool off);
/* Whether a sum is 0 or more, or is above 0. */
bool exact_is_enough(const uint32_t *sum, bool strict);
/* About how much it is, times 2 to the power of the exponent. */
double exact_roughly(const uint32_t *sum, int32_t *exponent);
/* Whether the variance of so many numbers, of which the sum and that of their squares are given, is as
 * much as a limit, or above it. */
bool exact_varies(const uint32_t *sum, const uint32_t *squares, int64_t count, const rv_number *limit,
                  bool strict);
/* The nearest double to a sum over a whole number, halves to even; to the variance. Infinite: there is none. */
double exact_nearest(const uint32_t *sum, int64_t by);
double exact_variance(const uint32_t *sum, const uint32_t *squares, int64_t count);
/* A sum of whole numbers; false: it leaves 64 bits. */
bool exact_whole(const uint32_t *sum, int64_t *found);

#endif
