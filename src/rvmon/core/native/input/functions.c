/* The functions of expressions (CODE_...) beyond arithmetic: rounding, bits, the C library's functions.
 *
 * Whole arguments give exact whole results; a result that is not finite, or exceeds 64 bits, is unknown.
 * Source: docs/reference/semantics.md, section 5. */
#include "input/input.h"

#include <math.h>

/* The mean radius of the Earth, m. Source: Moritz, Geodetic Reference System 1980, 2000. */
#define EARTH 6371008.8

int32_t arguments_of(int32_t op)
{
    switch (op) {
    case CODE_NEG:
    case CODE_ABS:
    case CODE_SQRT:
    case CODE_FLOOR:
    case CODE_CEIL:
    case CODE_ROUND:
    case CODE_SIGN:
    case CODE_SIN:
    case CODE_COS:
    case CODE_TAN:
    case CODE_ASIN:
    case CODE_ACOS:
    case CODE_EXP:
    case CODE_LOG:
    case CODE_LOG10: return 1;
    case CODE_CLAMP:
    case CODE_ANGLE_BETWEEN: return 3;
    case CODE_DISTANCE_ON_EARTH: return 4;
    default: return is_within(op, CODE_ADD, CODE_NOW) ? 2 : 0;
    }
}

/* The remainder with the sign of the divisor, as in Python. */
static int64_t whole_modulo(int64_t a, int64_t b)
{
    const int64_t rest = a % b;
    return ((rest != 0) && ((rest < 0) != (b < 0))) ? rest + b : rest;
}

/* An arithmetic shift (rounding down); for negative numbers C leaves `>>` to the compiler. */
static int64_t shifted_right(int64_t a, int64_t by)
{
    return (a < 0) ? -1 - ((-1 - a) >> by) : a >> by;
}

rv_number function_of_wholes(int32_t op, int64_t a, int64_t b)
{
    const bool shift = (op == CODE_SHIFT_LEFT) || (op == CODE_SHIFT_RIGHT) || (op == CODE_BIT);
    rv_number found = UNKNOWN_NUMBER;
    if ((shift && ((b < 0) || (b > 63))) || ((op == CODE_MOD) && (b == 0))) {
        return found;
    }
    found.kind = RV_WHOLE;
    switch (op) {
    case CODE_FLOOR:
    case CODE_CEIL:
    case CODE_ROUND: found.as.whole = a; break;
    case CODE_SIGN: found.as.whole = (a > 0) - (a < 0); break;
    case CODE_MOD: found.as.whole = (b == -1) ? 0 : whole_modulo(a, b); break;
    case CODE_BIT_AND: found.as.whole = a & b; break;
    case CODE_BIT_OR: found.as.whole = a | b; break;
    case CODE_BIT_XOR: found.as.whole = a ^ b; break;
    case CODE_SHIFT_RIGHT: found.as.whole = shifted_right(a, b); break;
    case CODE_BIT: found.as.whole = shifted_right(a, b) & 1; break;
    default: /* CODE_SHIFT_LEFT */
        if ((b == 63) ? (a != 0) && (a != -1) : shifted_right(INT64_MAX, b) < ((a < 0) ? -1 - a : a)) {
            return UNKNOWN_NUMBER;
        }
        found.as.whole = (int64_t)((uint64_t)a << b);
        break;
    }
    return found;
}

static double modulo(double a, double b)
{
    const double rest = fmod(a, b);
    return ((rest != 0.0) && ((rest < 0.0) != (b < 0.0))) ? rest + b : rest;
}

/* The difference of two directions in (-turn / 2, turn / 2]. */
static double angle_between(double a, double b, double whole_turn)
{
    const double between = remainder(b - a, whole_turn);
    return (2.0 * between == -whole_turn) ? -between : between;
}

/* The distance in m of two points on a sphere: x = latitude, longitude, latitude, longitude in rad.
 * Source: Sinnott, Virtues of the Haversine, 1984. */
static double distance_on_earth(const double *x)
{
    const double across = sin((x[2] - x[0]) / 2.0);
    const double along = sin((x[3] - x[1]) / 2.0);
    const double share = across * across + cos(x[0]) * cos(x[2]) * (along * along);
    const double root = sqrt(share);
    return 2.0 * EARTH * asin((root > 1.0) ? 1.0 : root);
}

double function_of_reals(int32_t op, const double *x)
{
    switch (op) {
    case CODE_FLOOR: return floor(x[0]);
    case CODE_CEIL: return ceil(x[0]);
    case CODE_ROUND: return round(x[0]);
    case CODE_SIGN: return (double)((x[0] > 0.0) - (x[0] < 0.0));
    case CODE_MOD: return (x[1] == 0.0) ? HUGE_VAL : modulo(x[0], x[1]);
    case CODE_SIN: return sin(x[0]);
    case CODE_COS: return cos(x[0]);
    case CODE_TAN: return tan(x[0]);
    case CODE_ASIN: return asin(x[0]);
    case CODE_ACOS: return acos(x[0]);
    case CODE_ATAN2: return atan2(x[0] + 0.0, x[1] + 0.0); /* -0 + 0 is 0: zeros have no sign here */
    case CODE_EXP: return exp(x[0]);
    case CODE_LOG: return log(x[0]);
    case CODE_LOG10: return log10(x[0]);
    case CODE_POW: return pow(x[0], x[1]);
    case CODE_ANGLE_BETWEEN: return angle_between(x[0], x[1], x[2]);
    case CODE_DISTANCE_ON_EARTH: return distance_on_earth(x);
    default: return HUGE_VAL; /* bit operations on a real: unknown */
    }
}
