/* Exact sums as long fixed-point numbers in two's complement, with limbs of 32 bits, the lowest first.
 *
 * The lowest bit of a sum is worth 2^-LOWEST, less than the smallest double (2^-1074); a sum of squares
 * has twice as many bits on either side. Products of 64 bits are added limb by limb with carry. So
 * adding costs a few limbs, comparing with 0 reads the sign, and only the variance multiplies sum by
 * sum (O(SUM_LIMBS^2), skipping zero limbs).
 *
 * Source: Kulisch, Computer Arithmetic and Validity, 2008 (the long accumulator). */
#include "formulas/exact.h"

#include <math.h>
#include <string.h>

#define LOWEST 1088 /* 34 limbs; for squares twice that */
#define VARIANCE_LIMBS (SQUARE_LIMBS + 4)

/* A number: +-size * 2^bit, in units of the lowest bit of a sum. */
typedef struct {
    uint64_t size;
    int32_t bit;
    bool negative;
} fixed_point;

static fixed_point fixed_of(const rv_number *number)
{
    fixed_point found;
    if (number->kind == RV_WHOLE) {
        found.negative = number->as.whole < 0;
        found.size =
            found.negative ? UINT64_C(0) - (uint64_t)number->as.whole : (uint64_t)number->as.whole;
        found.bit = LOWEST;
    } else {
        const int32_t smallest = LOWEST - 1074; /* the bit of the smallest subnormal */
        uint64_t bits;
        int32_t exponent;
        (void)memcpy(&bits, &number->as.real, sizeof bits);
        exponent = (int32_t)((bits >> 52) & 0x7FF);
        found.negative = (bits >> 63) != 0;
        found.size = (bits & ((UINT64_C(1) << 52) - 1)) | ((exponent > 0) ? UINT64_C(1) << 52 : 0);
        found.bit = smallest + ((exponent > 0) ? exponent - 1 : 0);
    }
    return found;
}

/* x += a * b * 2^bit, or -=: the product of 128 bits is shifted within limbs and added with carry. The
 * carry out of the highest limb is dropped, as usual in two's complement. */
static void add_product(uint32_t *x, int32_t limbs, uint64_t a, uint64_t b, int32_t bit, bool off)
{
    const uint64_t low = (a & UINT32_MAX) * (b & UINT32_MAX);
    const uint64_t one = (a & UINT32_MAX) * (b >> 32);
    const uint64_t other = (a >> 32) * (b & UINT32_MAX);
    const uint64_t high = (a >> 32) * (b >> 32);
    const uint64_t middle = (low >> 32) + (one & UINT32_MAX) + (other & UINT32_MAX);
    const uint64_t upper = (middle >> 32) + (one >> 32) + (other >> 32) + high;
    const uint32_t word[6] = {0, (uint32_t)low, (uint32_t)middle, (uint32_t)upper,
                              (uint32_t)(upper >> 32), 0};
    const int32_t by = bit % 32;
    uint64_t carry = 0;
    int32_t i;
    for (i = 0; (i < 5) || (carry != 0); i++) {
        const int32_t place = bit / 32 + i;
        const uint64_t both = (i < 5) ? (((uint64_t)word[i + 1] << 32) | word[i]) : 0;
        const uint64_t digit = ((both << by) >> 32) & UINT32_MAX;
        uint64_t made;
        if (place >= limbs) {
            return;
        }
        made = off ? x[place] - digit - carry : x[place] + digit + carry;
        x[place] = (uint32_t)made;
        carry = (made >> 32) & 1;
    }
}

/* x += a * b^2 * 2^bit, or -=: with b in halves of 32 bits, whose products fit in 64. */
static void add_square_product(uint32_t *x, int32_t limbs, uint64_t a, uint64_t b, int32_t bit,
                               bool off)
{
    const uint64_t low = b & UINT32_MAX;
    const uint64_t high = b >> 32;
    add_product(x, limbs, a, low * low, bit, off);
    add_product(x, limbs, a, low * high, bit + 33, off);
    add_product(x, limbs, a, high * high, bit + 64, off);
}

void exact_add(uint32_t *sum, const rv_number *number, int64_t times, bool off)
{
    const fixed_point p = fixed_of(number);
    add_product(sum, SUM_LIMBS, p.size, (uint64_t)times, p.bit, p.negative != off);
}

void exact_add_square(uint32_t *squares, const rv_number *number, int64_t times, bool off)
{
    const fixed_point p = fixed_of(number);
    add_square_product(squares, SQUARE_LIMBS, (uint64_t)times, p.size, 2 * p.bit, off);
}

static bool is_negative(const uint32_t *x, int32_t limbs)
{
    return (x[limbs - 1] >> 31) != 0;
}

static bool is_enough(const uint32_t *x, int32_t limbs, bool strict)
{
    int32_t i;
    for (i = 0; strict && (i < limbs); i++) {
        if (x[i] != 0) {
            return !is_negative(x, limbs);
        }
    }
    return !strict && !is_negative(x, limbs);
}

bool exact_is_enough(const uint32_t *sum, bool strict)
{
    return is_enough(sum, SUM_LIMBS, strict);
}

/* The three highest limbs that are not just sign, times 2^exponent; the relative error is below 2^-50. */
static double roughly(const uint32_t *x, int32_t limbs, int32_t *exponent)
{
    const uint32_t sign = is_negative(x, limbs) ? UINT32_MAX : 0;
    double found = 0.0;
    int32_t i = limbs - 1;
    int32_t k;
    while ((i > 2) && (x[i] == sign)) {
        i--;
    }
    for (k = i; k > i - 3; k--) {
        found = found * 0x1p32 + (double)(x[k] ^ sign);
    }
    *exponent = 32 * (i - 2);
    return (sign != 0) ? -found : found;
}

double exact_roughly(const uint32_t *sum, int32_t *exponent)
{
    return roughly(sum, SUM_LIMBS, exponent);
}

/* rest = count * squares - sum^2, which is count^2 times the variance, in units of 2^-(2 LOWEST). */
static void scaled_variance(uint32_t *rest, const uint32_t *sum, const uint32_t *squares, int64_t count)
{
    uint32_t size[SUM_LIMBS];
    const bool turned = is_negative(sum, SUM_LIMBS);
    uint64_t carry = turned ? 1 : 0;
    int32_t i;
    int32_t k;
    (void)memset(rest, 0, VARIANCE_LIMBS * sizeof *rest);
    for (i = 0; i < SUM_LIMBS; i++) {
        const uint64_t digit = (uint64_t)(turned ? ~sum[i] : sum[i]) + carry;
        size[i] = (uint32_t)digit;
        carry = digit >> 32;
    }
    for (i = 0; i < SQUARE_LIMBS; i++) {
        if (squares[i] != 0) {
            add_product(rest, VARIANCE_LIMBS, squares[i], (uint64_t)count, 32 * i, false);
        }
    }
    for (i = 0; i < SUM_LIMBS; i++) {
        for (k = 0; (size[i] != 0) && (k < SUM_LIMBS); k++) {
            if (size[k] != 0) {
                add_product(rest, VARIANCE_LIMBS, size[i], size[k], 32 * (i + k), true);
            }
        }
    }
}

/* Decides count^2 * variance - count^2 * limit >= 0. */
bool exact_varies(const uint32_t *sum, const uint32_t *squares, int64_t count, const rv_number *limit,
                  bool strict)
{
    const fixed_point p = fixed_of(limit);
    uint32_t rest[VARIANCE_LIMBS];
    scaled_variance(rest, sum, squares, count);
    add_square_product(rest, VARIANCE_LIMBS, p.size, (uint64_t)count, p.bit + LOWEST, !p.negative);
    return is_enough(rest, VARIANCE_LIMBS, strict);
}

/* ---- rounding to doubles */

/* A long number whose lowest bit is worth 2^-lowest, over `by`, or over its square. */
typedef struct {
    const uint32_t *limb;
    int32_t limbs;
    int32_t lowest;
    uint64_t by;
    bool squared;
} quotient;

/* The sign of 2 q - (a + b), that is, on which side of the midpoint of a and b the quotient lies. Exact,
 * as everything is multiplied by the divisor. */
static int compare_doubled(const quotient *q, double a, double b)
{
    const double both[2] = {a, b};
    uint32_t rest[VARIANCE_LIMBS];
    uint32_t carry = 0;
    int32_t i;
    for (i = 0; i < q->limbs; i++) {
        rest[i] = (q->limb[i] << 1) | carry;
        carry = q->limb[i] >> 31;
    }
    for (i = 0; i < 2; i++) {
        const rv_number number = {RV_REAL, {.real = both[i]}};
        const fixed_point p = fixed_of(&number);
        const int32_t bit = p.bit + q->lowest - LOWEST;
        if (q->squared) {
            add_square_product(rest, q->limbs, p.size, q->by, bit, !p.negative);
        } else {
            add_product(rest, q->limbs, p.size, q->by, bit, !p.negative);
        }
    }
    return is_negative(rest, q->limbs) ? -1 : (is_enough(rest, q->limbs, true) ? 1 : 0);
}

static bool is_odd(double number)
{
    uint64_t bits;
    (void)memcpy(&bits, &number, sizeof bits);
    return (bits & 1) != 0;
}

/* The nearest double, ties to even; infinite if out of range. Starts from an estimate and moves to the
 * neighbour as long as the quotient lies beyond the midpoint of the two. */
static double nearest(const quotient *q)
{
    const double by = (double)q->by;
    int32_t exponent;
    const double rough = roughly(q->limb, q->limbs, &exponent);
    double found = ldexp(q->squared ? rough / by / by : rough / by, exponent - q->lowest);
    int32_t steps;
    found = fmax(-0x1.fffffffffffffp1023, fmin(found, 0x1.fffffffffffffp1023));
    for (steps = 0; steps < 64; steps++) { /* a few are enough; more only in a forged snapshot */
        const double above = nextafter(found, HUGE_VAL);
        const double below = nextafter(found, -HUGE_VAL);
        const int up = compare_doubled(q, found, above);
        const int down = compare_doubled(q, found, below);
        if ((up > 0) || ((up == 0) && is_odd(found))) {
            found = above;
        } else if ((down < 0) || ((down == 0) && is_odd(found))) {
            found = below;
        } else {
            break;
        }
        if (found - found != 0.0) {
            break;
        }
    }
    return found + 0.0;
}

double exact_nearest(const uint32_t *sum, int64_t by)
{
    const quotient q = {sum, SUM_LIMBS, LOWEST, (uint64_t)by, false};
    return nearest(&q);
}

double exact_variance(const uint32_t *sum, const uint32_t *squares, int64_t count)
{
    uint32_t rest[VARIANCE_LIMBS];
    const quotient q = {rest, VARIANCE_LIMBS, 2 * LOWEST, (uint64_t)count, true};
    scaled_variance(rest, sum, squares, count);
    return nearest(&q);
}

bool exact_whole(const uint32_t *sum, int64_t *found)
{
    const int32_t low = LOWEST / 32;
    const uint64_t bits = ((uint64_t)sum[low + 1] << 32) | sum[low];
    const uint32_t sign = is_negative(sum, SUM_LIMBS) ? UINT32_MAX : 0;
    int32_t i;
    for (i = low + 2; i < SUM_LIMBS; i++) {
        if (sum[i] != sign) {
            return false;
        }
    }
    (void)memcpy(found, &bits, sizeof bits);
    return ((bits >> 63) != 0) == (sign != 0);
}
