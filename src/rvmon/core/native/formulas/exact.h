/* Exact sums of int64 and binary64: fixed point wide enough for every bit of a double.
 *
 * Nothing is rounded, so a number that is added and subtracted again leaves no error, and a window of
 * any length can keep its sum. `sum` has SUM_LIMBS limbs, `squares` SQUARE_LIMBS (state.h), both zero
 * at first. */
#ifndef RVMON_EXACT_H
#define RVMON_EXACT_H

#include "basics.h"

/* Add `times` times a number, or subtract it (`off`); the same with its square. */
void exact_add(uint32_t *sum, const rv_number *number, int64_t times, bool off);
void exact_add_square(uint32_t *squares, const rv_number *number, int64_t times, bool off);
/* Whether sum >= 0, or sum > 0 if strict. */
bool exact_is_enough(const uint32_t *sum, bool strict);
/* An estimate of the sum: the result times 2^exponent, in units of the lowest bit. */
double exact_roughly(const uint32_t *sum, int32_t *exponent);
/* Whether the variance of `count` numbers with that sum and that sum of squares is >= limit (> if
 * strict). */
bool exact_varies(const uint32_t *sum, const uint32_t *squares, int64_t count, const rv_number *limit,
                  bool strict);
/* sum / by, and the variance, as the nearest double, ties to even; infinite: out of range. */
double exact_nearest(const uint32_t *sum, int64_t by);
double exact_variance(const uint32_t *sum, const uint32_t *squares, int64_t count);
/* A sum of whole numbers as a whole number; false: it does not fit in 64 bits. */
bool exact_whole(const uint32_t *sum, int64_t *found);

#endif
