/* Exact conversion of decimal numbers. */
#ifndef RVMON_NUMBERS_H
#define RVMON_NUMBERS_H

#include "csv.h"

#include <string.h>

/* Powers of ten that are exact doubles. */
static const double POWERS[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
#define MOST_POWER 22

/* Any number of this many digits fits in 64 bits. */
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

/* By exponent, the largest number that times that power of ten is still an instant. */
static const uint64_t MOST_TICKS[] = {
    TIME_LIMIT - 1,
    (TIME_LIMIT - 1) / 10,
    (TIME_LIMIT - 1) / 100,
    (TIME_LIMIT - 1) / 1000,
    (TIME_LIMIT - 1) / 10000,
    (TIME_LIMIT - 1) / 100000,
    (TIME_LIMIT - 1) / 1000000,
    (TIME_LIMIT - 1) / 10000000,
    (TIME_LIMIT - 1) / 100000000,
    (TIME_LIMIT - 1) / 1000000000,
};

/* Characters; Python reads longer numbers. */
#define LONGEST 127

typedef struct {
    uint64_t mantissa;
    int32_t decimals; /* digits after the point */
    int32_t exponent; /* as written */
    bool is_negative;
    bool is_long;  /* it has more digits than `mantissa` holds */
    bool is_whole; /* nothing but digits after its sign, so no point either */
} decimal;

/* The number that eight digits form, the first one in the lowest byte; a byte 0 counts as '0'. */
static inline uint64_t eight_digits(uint64_t text)
{
    text = (text & 0x0F0F0F0F0F0F0F0Fu) * 2561 >> 8; /* pairs, then fours, then all */
    text = (text & 0x00FF00FF00FF00FFu) * 6553601 >> 16;
    return (text & 0x0000FFFF0000FFFFu) * 42949672960001u >> 32;
}

/* The number that the first `count` digits form, at most seven. */
static inline uint64_t some_digits(uint64_t text, int32_t count)
{
    return eight_digits(text << 8 << (56 - 8 * count));
}

#define ZEROS 0x3030303030303030u

/* Mark the bytes that are no digits, in text XOR ZEROS. After the first byte that is not ASCII,
 * marks may be wrong. */
static inline uint64_t stops_in(uint64_t digits)
{
    return ((digits + 0x7676767676767676u) | digits) & 0x8080808080808080u;
}

/* Append the digits at `at` to `*mantissa`, eight at a time; returns the place after them. Too many
 * digits overflow: the caller does not use the mantissa then. */
static inline const char *digits_at_once(const char *at, const char *to, uint64_t *mantissa)
{
    uint64_t found = *mantissa;
    while (to - at >= 8) {
        const uint64_t word = csv_word(at);
        const uint64_t stops = stops_in(word ^ ZEROS);
        if (stops != 0) {
            const int32_t count = csv_lowest(stops) / 8;
            *mantissa = found * WHOLE_POWERS[count] + some_digits(word, count);
            return at + count;
        }
        found = found * WHOLE_POWERS[8] + eight_digits(word);
        at += 8;
    }
    for (; (at < to) && is_digit(*at); at++) {
        found = found * 10 + (uint64_t)(*at - '0');
    }
    *mantissa = found;
    return at;
}

/* The number of digits without leading zeros; other characters are skipped. */
static inline int32_t held_digits(const char *at, const char *to)
{
    int32_t held = 0;
    for (; at < to; at++) {
        held += (is_digit(*at) && ((held > 0) || (*at != '0'))) ? 1 : 0;
    }
    return held;
}

/* Read the decimal number at `from`, in the form that Python accepts; returns its end, NULL if
 * there is none or it is too long. */
static inline const char *decimal_at(const char *from, const char *to, decimal *d)
{
    const bool is_signed = (from < to) && ((*from == '-') || (*from == '+'));
    const char *first = from + (is_signed ? 1 : 0);
    const char *at;
    int64_t digits;
    d->is_negative = is_signed && (*from == '-');
    d->mantissa = 0;
    d->decimals = 0;
    d->exponent = 0;
    at = digits_at_once(first, to, &d->mantissa);
    digits = at - first;
    d->is_whole = (at == to) || ((*at != '.') && ((*at | 32) != 'e'));
    if ((at < to) && (*at == '.')) {
        const char *point = at;
        at = digits_at_once(at + 1, to, &d->mantissa);
        d->decimals = (int32_t)(at - point) - 1;
        digits += d->decimals;
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

/* Convert a decimal by one operation, with one rounding; false unless both operands are exact. */
static inline bool exact_of(const decimal *d, csv_number *made)
{
    const int32_t power = d->exponent - d->decimals;
    const double whole = d->is_negative ? -(double)d->mantissa : (double)d->mantissa;
    if (d->is_long || (d->mantissa > EXACT) || (power > MOST_POWER) || (power < -MOST_POWER)) {
        return false;
    }
    made->real = (power < 0) ? whole / POWERS[-power] : whole * POWERS[power];
    return true;
}

/* Convert a decimal without a fraction to an integer of at most `most`. */
static inline int whole_of(const decimal *d, uint64_t most, csv_number *made)
{
    uint64_t whole = d->mantissa;
    if (d->is_long || (d->exponent != 0) || (d->decimals > MOST_DIGITS)) {
        return CSV_ODD;
    }
    if (d->decimals > 0) {
        const uint64_t scale = WHOLE_POWERS[d->decimals];
        most = (most > EXACT) ? EXACT : most; /* Python reads a number with a point as a double */
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

/* Convert a stamp, with `places` decimal places from its unit to a tick, to ticks: half to even. */
static inline int stamp_of(const decimal *d, int32_t places, csv_number *made)
{
    uint64_t ticks = d->mantissa;
    if (d->is_long || (d->exponent != 0) || ((places == 0) && !d->is_whole)) {
        return CSV_ODD;
    }
    if (d->decimals < places) {
        if (ticks > MOST_TICKS[places - d->decimals]) {
            return CSV_ODD;
        }
        ticks *= WHOLE_POWERS[places - d->decimals];
    } else if (d->decimals - places > MOST_DIGITS) {
        return CSV_ODD;
    } else if (d->decimals > places) {
        const uint64_t scale = WHOLE_POWERS[d->decimals - places];
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

/* Convert a number for which `exact_of` is false. */
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

/* A number of up to 16 digits. */
typedef struct {
    uint64_t mantissa;
    int32_t decimals; /* digits after the point */
    bool is_negative;
} short_decimal;

/* Remove the point if it is the only mark in `stops`: the digits before it move up by one byte.
 * Returns the number of digits after it, -1 if there is something else than a point. */
static inline int32_t without_point(uint64_t *digits, uint64_t stops)
{
    const int32_t place = csv_lowest(stops) - 7;
    const uint64_t before = *digits & ((stops >> 7) - 1);
    if (((*digits >> place & 0xFF) != ('.' ^ '0')) || ((stops & (stops - 1)) != 0)) {
        return -1;
    }
    *digits = (*digits & ~((stops << 1) - 1)) | before << 8;
    return 7 - place / 8;
}

/* `short_of` for 9 to 16 characters. */
static inline bool longer_decimal(const char *to, int64_t size, short_decimal *made)
{
    uint64_t high = csv_word(to - 8) ^ ZEROS;
    uint64_t low;
    uint64_t stops = stops_in(high);
    int32_t decimals = 0;
    if ((size < 9) || (size > 16)) {
        return false;
    }
    low = (csv_word(to - 16) ^ ZEROS) >> (128 - 8 * size) << (128 - 8 * size);
    if (stops != 0) {
        decimals = without_point(&high, stops);
        if ((decimals < 0) || (stops_in(low) != 0)) {
            return false;
        }
        high |= low >> 56;
        low <<= 8;
    } else if ((stops = stops_in(low)) != 0) {
        decimals = without_point(&low, stops);
        if (decimals < 0) {
            return false;
        }
        decimals += 8;
    }
    made->decimals = decimals;
    made->mantissa = eight_digits(high) + eight_digits(low) * WHOLE_POWERS[8];
    return true;
}

/* Convert a cell of digits with at most one point, and maybe a minus; at most 16 characters after
 * that. 16 bytes before its end must be readable. False if the cell is something else. */
CSV_INNERMOST bool short_of(const char *from, const char *to, short_decimal *made)
{
    const int64_t signs = (*from == '-') ? 1 : 0;
    const int64_t size = to - from - signs;
    uint64_t digits;
    uint64_t stops;
    made->is_negative = signs != 0;
    if ((uint64_t)(size - 1) >= 8) {
        return longer_decimal(to, size, made);
    }
    digits = (csv_word(to - 8) ^ ZEROS) >> (64 - 8 * size) << (64 - 8 * size);
    stops = stops_in(digits);
    made->decimals = 0;
    if (stops != 0) {
        made->decimals = without_point(&digits, stops);
        if ((made->decimals < 0) || (size == 1)) {
            return false;
        }
    }
    made->mantissa = eight_digits(digits);
    return true;
}

#endif
