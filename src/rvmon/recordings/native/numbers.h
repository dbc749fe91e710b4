/* Decimal numbers, exactly. */
#ifndef RVMON_NUMBERS_H
#define RVMON_NUMBERS_H

#include "csv.h"

#include <string.h>

/* Powers of ten that are exact doubles. */
static const double POWERS[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
#define MOST_POWER 22

/* So many digits fit in 64 bits. */
#define MOST_DIGITS 19

static const uint64_t WHOLE_POWERS[] = {
    1u,
    10u,
    100u,
    1000u,
    10000u,
    100000u,
    1000000u,
    10000000u,
    100000000u,
    1000000000u,
    10000000000u,
    100000000000u,
    1000000000000u,
    10000000000000u,
    100000000000000u,
    1000000000000000u,
    10000000000000000u,
    100000000000000000u,
    1000000000000000000u,
    10000000000000000000u,
};

#define EXACT ((uint64_t)1 << 53)
#define TIME_LIMIT ((uint64_t)1 << 62)

/* The longest number that is read here. */
#define LONGEST 127

typedef struct {
    uint64_t mantissa;
    int32_t behind;   /* digits behind the point */
    int32_t exponent; /* as written */
    bool is_negative;
    bool is_long; /* it has more digits than `mantissa` holds */
} decimal;

static inline bool is_digit(char c)
{
    return (c >= '0') && (c <= '9');
}

/* Eight digits at once, the first of which is in the lowest byte; false: one of them is none. */
static inline bool eight_digits(const char *at, uint64_t *made)
{
#if defined(__BYTE_ORDER__) && (__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__)
    uint64_t text;
    (void)memcpy(&text, at, sizeof text);
    if (((text & 0xF0F0F0F0F0F0F0F0u) | (((text + 0x0606060606060606u) & 0xF0F0F0F0F0F0F0F0u) >> 4))
        != 0x3333333333333333u) {
        return false;
    }
    text = (text & 0x0F0F0F0F0F0F0F0Fu) * 2561 >> 8; /* pairs, then fours, then all */
    text = (text & 0x00FF00FF00FF00FFu) * 6553601 >> 16;
    *made = (text & 0x0000FFFF0000FFFFu) * 42949672960001u >> 32;
    return true;
#else
    (void)at;
    (void)made;
    return false;
#endif
}

/* Digits of which too many are no number: nobody looks at it then. */
static inline const char *digits_at_once(const char *at, const char *to, uint64_t *mantissa)
{
    uint64_t found = *mantissa;
    uint64_t eight;
    while ((to - at >= 8) && eight_digits(at, &eight)) {
        found = found * 100000000 + eight;
        at += 8;
    }
    for (; (at < to) && is_digit(*at); at++) {
        found = found * 10 + (uint64_t)(*at - '0');
    }
    *mantissa = found;
    return at;
}

/* How many digits there are from the first that is not zero on. */
static inline int32_t held_digits(const char *at, const char *to)
{
    int32_t held = 0;
    for (; at < to; at++) {
        held += (is_digit(*at) && ((held > 0) || (*at != '0'))) ? 1 : 0;
    }
    return held;
}

/* The decimal number that begins here, as Python reads one; gives where it ends, NULL if there is
 * none, or a long one. */
static inline const char *decimal_at(const char *from, const char *to, decimal *d)
{
    const bool is_signed = (from < to) && ((*from == '-') || (*from == '+'));
    const char *first = from + (is_signed ? 1 : 0);
    const char *at;
    int64_t digits;
    d->is_negative = is_signed && (*from == '-');
    d->mantissa = 0;
    d->behind = 0;
    d->exponent = 0;
    at = digits_at_once(first, to, &d->mantissa);
    digits = at - first;
    if ((at < to) && (*at == '.')) {
        const char *point = at;
        at = digits_at_once(at + 1, to, &d->mantissa);
        d->behind = (int32_t)(at - point) - 1;
        digits += d->behind;
    }
    if (digits == 0) {
        return NULL;
    }
    d->is_long = (digits > MOST_DIGITS) && (held_digits(first, at) > MOST_DIGITS);
    if ((at < to) && ((*at | 32) == 'e')) {
        bool down = false;
        at++;
        if ((at < to) && ((*at == '-') || (*at == '+'))) {
            down = *at == '-';
            at++;
        }
        for (first = at; (at < to) && (at - first < 5) && is_digit(*at); at++) {
            d->exponent = d->exponent * 10 + (*at - '0');
        }
        if ((at == first) || (at - first > 4)) {
            return NULL;
        }
        d->exponent = down ? -d->exponent : d->exponent;
    }
    return (at - from > LONGEST) ? NULL : at;
}

/* A whole times or through a power of ten, rounded once; false: one of them is no exact double. */
static inline bool exact_of(const decimal *d, csv_number *made)
{
    const int32_t power = d->exponent - d->behind;
    const double whole = d->is_negative ? -(double)d->mantissa : (double)d->mantissa;
    if (d->is_long || (d->mantissa > EXACT) || (power > MOST_POWER) || (power < -MOST_POWER)) {
        return false;
    }
    made->real = (power < 0) ? whole / POWERS[-power] : whole * POWERS[power];
    return true;
}

/* A decimal as a whole number, of which no part is behind the point; up to `most`. */
static inline int whole_of(const decimal *d, uint64_t most, csv_number *made)
{
    uint64_t whole = d->mantissa;
    if (d->is_long || (d->exponent != 0) || (d->behind > MOST_DIGITS)) {
        return CSV_ODD;
    }
    if (d->behind > 0) {
        const uint64_t scale = WHOLE_POWERS[d->behind];
        most = (most > EXACT) ? EXACT : most; /* it is a double first */
        if (whole % scale != 0) {
            return CSV_ODD;
        }
        whole /= scale;
    }
    if (whole > most) {
        return CSV_ODD;
    }
    made->whole = d->is_negative ? -(int64_t)whole : (int64_t)whole;
    return CSV_YES;
}

/* A stamp as ticks, of which so many digits are whole; half a tick goes to the even one. */
static inline int stamp_of(const decimal *d, int32_t places, csv_number *made)
{
    uint64_t ticks = d->mantissa;
    if (d->is_long || (d->exponent != 0) || ((places == 0) && (d->behind > 0))) {
        return CSV_ODD;
    }
    if (d->behind < places) {
        const uint64_t scale = WHOLE_POWERS[places - d->behind];
        if (ticks > (TIME_LIMIT - 1) / scale) {
            return CSV_ODD;
        }
        ticks *= scale;
    } else if (d->behind - places > MOST_DIGITS) {
        return CSV_ODD;
    } else if (d->behind > places) {
        const uint64_t scale = WHOLE_POWERS[d->behind - places];
        const uint64_t rest = ticks % scale;
        ticks /= scale;
        if ((rest > scale - rest) || ((rest == scale - rest) && (ticks % 2 == 1))) {
            ticks++;
        }
    }
    if (ticks >= TIME_LIMIT) {
        return CSV_ODD;
    }
    made->whole = d->is_negative ? -(int64_t)ticks : (int64_t)ticks;
    return CSV_YES;
}

/* A number that is no exact whole times or through an exact power of ten. */
int csv_inexact(const csv_reader *r, const decimal *d, const char *from, const char *to,
                csv_number *made);

static inline int number_of(const csv_reader *r, int32_t kind, const decimal *d, const char *from,
                            const char *to, csv_number *made)
{
    switch (kind) {
    case CSV_BOOL: return d->is_negative ? CSV_ODD : whole_of(d, 1, made);
    case CSV_INT: return whole_of(d, INT64_MAX, made);
    case CSV_REAL: return exact_of(d, made) ? CSV_YES : csv_inexact(r, d, from, to, made);
    default: return stamp_of(d, kind - CSV_STAMP, made);
    }
}

#endif
