/* Single cells as numbers, exactly. */
#include "csv.h"

#include <math.h>
#include <string.h>

/* Powers of ten that are exact doubles. */
static const double POWERS[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
#define MOST_POWER 22

/* So many digits fit in 64 bits. */
#define MOST_DIGITS 19

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

static bool is_digit(char c)
{
    return (c >= '0') && (c <= '9');
}

/* How many digits there are from the first that is not zero on. */
static int32_t held_digits(const char *at, const char *to)
{
    int32_t held = 0;
    for (; at < to; at++) {
        held += (is_digit(*at) && ((held > 0) || (*at != '0'))) ? 1 : 0;
    }
    return held;
}

/* Digits and a point, perhaps; gives where they end, NULL if there is no digit. */
static inline const char *digits_of(const char *from, const char *to, decimal *d)
{
    const char *at = from;
    const char *point = NULL;
    uint64_t mantissa = 0;
    int64_t digits;
    for (; at < to; at++) {
        const uint32_t digit = (uint32_t)(uint8_t)*at - '0';
        if (digit <= 9) {
            mantissa = mantissa * 10 + digit; /* of too many, nobody looks at it */
        } else if ((*at == '.') && (point == NULL)) {
            point = at;
        } else {
            break;
        }
    }
    digits = (at - from) - ((point != NULL) ? 1 : 0);
    d->mantissa = mantissa;
    d->behind = (point != NULL) ? (int32_t)(at - point) - 1 : 0;
    d->is_long = (digits > MOST_DIGITS) && (held_digits(from, at) > MOST_DIGITS);
    return (digits > 0) ? at : NULL;
}

/* The decimal number that begins here, as Python reads one; gives where it ends, NULL if there is
 * none, or a long one. */
static inline const char *decimal_at(const char *from, const char *to, decimal *d)
{
    const char *at = from;
    (void)memset(d, 0, sizeof *d);
    if ((at < to) && ((*at == '-') || (*at == '+'))) {
        d->is_negative = *at == '-';
        at++;
    }
    at = digits_of(at, to, d);
    if ((at != NULL) && (at < to) && ((*at | 32) == 'e')) {
        const char *first;
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
    return ((at == NULL) || (at - from > LONGEST)) ? NULL : at;
}

/* A whole number of up to 19 digits by an exact power of ten, rounded once; false: it is not sure.
 *
 * The quotient's error is found exactly but for its own relative error of some 2^-52: where that may
 * not change how the sum is rounded, it does not. */
static bool quotient(uint64_t mantissa, double power, double *made)
{
    const double high = (double)mantissa;
    const double low = (double)(int64_t)(mantissa - (uint64_t)high);
    const double first = high / power;
    const double rest = (fma(-first, power, high) + low) / power;
    const double least = first + rest * (1.0 - 0x1p-50);
    *made = first + rest * (1.0 + 0x1p-50);
    return *made == least;
}

/* A number that is no exact whole times or through an exact power of ten. */
static int inexact(const csv_reader *r, const decimal *d, const char *from, const char *to,
                   csv_number *made)
{
    const int32_t power = d->exponent - d->behind;
    char copy[LONGEST + 1];
    double found;
    if (!d->is_long && (power <= 0) && (power >= -MOST_POWER)
        && quotient(d->mantissa, POWERS[-power], &found)) {
        made->real = d->is_negative ? -found : found;
        return CSV_YES;
    }
    (void)memcpy(copy, from, (size_t)(to - from));
    copy[to - from] = '\0';
    made->real = r->slow(r->taken, copy);
    return isfinite(made->real) ? CSV_YES : CSV_ODD;
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

static uint64_t power_of_ten(int32_t power)
{
    uint64_t made = 1;
    for (; power > 0; power--) {
        made *= 10;
    }
    return made;
}

/* A decimal as a whole number, of which no part is behind the point; up to `most`. */
static inline int whole_of(const decimal *d, uint64_t most, csv_number *made)
{
    uint64_t whole = d->mantissa;
    if (d->is_long || (d->exponent != 0) || (d->behind > MOST_DIGITS)) {
        return CSV_ODD;
    }
    if (d->behind > 0) {
        const uint64_t scale = power_of_ten(d->behind);
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
    if (d->behind <= places) {
        const uint64_t scale = power_of_ten(places - d->behind);
        if (ticks > (TIME_LIMIT - 1) / scale) {
            return CSV_ODD;
        }
        ticks *= scale;
    } else if (d->behind - places > MOST_DIGITS) {
        return CSV_ODD;
    } else {
        const uint64_t scale = power_of_ten(d->behind - places);
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

/* So many digits as a number; -1: one is none. */
static int32_t digits_at(const char *at, int32_t count)
{
    int32_t made = 0;
    for (; count > 0; count--, at++) {
        if (!is_digit(*at)) {
            return -1;
        }
        made = made * 10 + (*at - '0');
    }
    return made;
}

/* Days since 1970 of a date of the Gregorian calendar; a year begins with March. */
static int64_t days_of(int32_t year, int32_t month, int32_t day)
{
    const int64_t y = year - ((month <= 2) ? 1 : 0);
    const int64_t m = (month + 9) % 12;
    return 365 * y + y / 4 - y / 100 + y / 400 + (153 * m + 2) / 5 + day - 1 - 719468;
}

/* Seconds that a time zone is ahead of UTC; false: it is written otherwise than Z and +02:00. */
static bool zone_of(const char *at, const char *to, int64_t *ahead)
{
    int32_t hours;
    int32_t minutes;
    *ahead = 0;
    if ((at == to) || ((to - at == 1) && ((*at | 32) == 'z'))) {
        return true;
    }
    if ((to - at != 6) || ((*at != '+') && (*at != '-')) || (at[3] != ':')) {
        return false;
    }
    hours = digits_at(at + 1, 2);
    minutes = digits_at(at + 4, 2);
    *ahead = ((*at == '-') ? -60 : 60) * ((int64_t)hours * 60 + minutes);
    return (hours >= 0) && (hours <= 23) && (minutes >= 0) && (minutes <= 59);
}

/* A date and time as most programs write it, 2024-05-01T12:00:00.123Z, as ticks since 1970. */
static int date_of(const char *from, const char *to, csv_number *made)
{
    static const int32_t DAYS[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    const char *at;
    int32_t year;
    int32_t month;
    int32_t day;
    int32_t hour;
    int32_t minute;
    int32_t second;
    int32_t scale;
    int64_t seconds;
    int64_t ahead;
    int64_t part = 0;
    bool leap;
    if ((to - from < 19) || (from[4] != '-') || (from[7] != '-') || (from[13] != ':')
        || (from[16] != ':') || ((from[10] != ' ') && ((from[10] | 32) != 't'))) {
        return CSV_ODD;
    }
    at = from + 19;
    year = digits_at(from, 4);
    month = digits_at(from + 5, 2);
    day = digits_at(from + 8, 2);
    hour = digits_at(from + 11, 2);
    minute = digits_at(from + 14, 2);
    second = digits_at(from + 17, 2);
    if ((year < 1) || (month < 1) || (month > 12) || (day < 1) || (hour < 0) || (hour > 23)
        || (minute < 0) || (minute > 59) || (second < 0) || (second > 59)) {
        return CSV_ODD;
    }
    leap = (year % 4 == 0) && ((year % 100 != 0) || (year % 400 == 0));
    if (day > DAYS[month - 1] + ((leap && (month == 2)) ? 1 : 0)) {
        return CSV_ODD;
    }
    if ((at < to) && ((*at == '.') || (*at == ','))) {
        at++;
        if ((at == to) || !is_digit(*at)) {
            return CSV_ODD;
        }
        for (scale = 100000000; (at < to) && is_digit(*at); at++, scale /= 10) {
            if ((scale == 0) && (*at != '0')) {
                return CSV_ODD;
            }
            part += (int64_t)scale * (*at - '0');
        }
    }
    if ((at + 1 < to) && (*at == ' ')) {
        at++;
    }
    if (!zone_of(at, to, &ahead)) {
        return CSV_ODD;
    }
    seconds = days_of(year, month, day) * 86400 + hour * 3600 + minute * 60 + second - ahead;
    if ((seconds <= -4611686018) || (seconds >= 4611686018)) {
        return CSV_ODD;
    }
    made->whole = seconds * 1000000000 + part;
    return CSV_YES;
}

static bool is_word(const char *from, const char *to, const char *word)
{
    const size_t size = (size_t)(to - from);
    return (size == strlen(word)) && (memcmp(from, word, size) == 0);
}

static bool is_nan(const char *from, const char *to)
{
    return (to - from == 3) && ((from[0] | 32) == 'n') && ((from[1] | 32) == 'a')
           && ((from[2] | 32) == 'n');
}

static int truth_of(const char *from, const char *to, csv_number *made)
{
    const bool yes = is_word(from, to, "true") || is_word(from, to, "True")
                     || is_word(from, to, "TRUE");
    if (yes || is_word(from, to, "false") || is_word(from, to, "False")
        || is_word(from, to, "FALSE")) {
        made->whole = yes ? 1 : 0;
        return CSV_YES;
    }
    return CSV_ODD;
}

static inline int value_of(const csv_reader *r, int32_t kind, const decimal *d, const char *from,
                           const char *to, csv_number *made)
{
    switch (kind) {
    case CSV_BOOL: return d->is_negative ? CSV_ODD : whole_of(d, 1, made);
    case CSV_INT: return whole_of(d, INT64_MAX, made);
    case CSV_REAL: return exact_of(d, made) ? CSV_YES : inexact(r, d, from, to, made);
    default: return stamp_of(d, kind - CSV_STAMP, made);
    }
}

int csv_value(const csv_reader *r, int32_t kind, const char *from, const char *to, csv_number *made)
{
    decimal d;
    made->whole = 0;
    if ((kind == CSV_BOOL) && (*from > '9') && (truth_of(from, to, made) == CSV_YES)) {
        return CSV_YES;
    }
    if ((kind < CSV_LABEL) && is_nan(from, to)) {
        if (kind == CSV_REAL) {
            made->real = NAN;
            return CSV_YES;
        }
        return CSV_UNKNOWN;
    }
    if (kind == CSV_DATE) {
        return date_of(from, to, made);
    }
    return (decimal_at(from, to, &d) == to) ? value_of(r, kind, &d, from, to, made) : CSV_ODD;
}

const char *csv_number_at(const csv_reader *r, int32_t kind, const char *from, csv_number *made)
{
    const char *end = r->text + r->size;
    decimal d;
    const char *to = ((kind == CSV_LABEL) || (kind == CSV_DATE)) ? NULL : decimal_at(from, end, &d);
    if ((to == NULL) || (to == end) || !csv_ends_cell(*to)) {
        return NULL;
    }
    return (value_of(r, kind, &d, from, to, made) == CSV_YES) ? to : NULL;
}
