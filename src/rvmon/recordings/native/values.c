/* Exact conversion of single cells to values. */
#include "numbers.h"

#include <math.h>

/* Divide an integer of up to 19 digits by an exact power of ten, rounding once; false: not certain.
 *
 * `rest` is what the rounded quotient `first` lacks, with a relative error of some 2^-52. If the
 * largest and the smallest possible `rest` give the same sum, that is the rounded result. */
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

int csv_inexact(const csv_reader *r, const decimal *d, const char *from, const char *to,
                csv_number *made)
{
    const int32_t power = d->exponent - d->decimals;
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

/* The number that `count` digits form; -1 if one of them is no digit. */
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

/* Days from 1970 to a Gregorian date. Years start in March, so that a leap day comes last. */
static int64_t days_of(int32_t year, int32_t month, int32_t day)
{
    const int64_t y = year - ((month <= 2) ? 1 : 0);
    const int64_t m = (month + 9) % 12;
    return 365 * y + y / 4 - y / 100 + y / 400 + (153 * m + 2) / 5 + day - 1 - 719468;
}

/* Seconds by which a time zone is ahead of UTC; false unless it is empty, Z, or like +02:00. */
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

/* Convert the usual form of a date and time, 2024-05-01T12:00:00.123Z, to ticks since 1970. */
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
        return CSV_ODD; /* beyond 2^62 ns, or close to it */
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

csv_sort csv_sort_of(const char *from, const char *to)
{
    decimal d;
    if (decimal_at(from, to, &d) != to) {
        return CSV_TEXT;
    }
    if ((to - from == 1) && (d.mantissa <= 1)) {
        return (d.mantissa == 0) ? CSV_ZERO : CSV_ONE;
    }
    return (d.is_whole && (to - from - (is_digit(*from) ? 0 : 1) <= 18)) ? CSV_WHOLE : CSV_NUMBER;
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
    return (decimal_at(from, to, &d) == to) ? number_of(r, kind, &d, from, to, made) : CSV_ODD;
}
