/* Numbers, binary64 and int64, and the interpreter of expressions.
 *
 * Whole numbers stay whole and exact through +, -, *, min, max and the like. A result that exceeds 64
 * bits or is not finite is unknown, and so is every result from an unknown number. A whole and a real
 * number are compared exactly. Each operation is rounded once, in the same way on every machine: no
 * contraction, no excess precision (-ffp-contract=off, no x87), and apart from functions.c only
 * operations whose results IEEE 754 fixes.
 *
 * Source: docs/reference/semantics.md, section 5. */
#include "input/input.h"

#include <math.h>

#ifdef __FAST_MATH__
#error "numbers have to be those of IEEE 754: compile without -ffast-math"
#endif

static rv_number whole(int64_t value)
{
    rv_number made;
    made.kind = RV_WHOLE;
    made.as.whole = value;
    return made;
}

/* A real result; unknown if it is not finite (inf - inf is NaN). */
static rv_number real(double value)
{
    rv_number made = UNKNOWN_NUMBER;
    if (value - value == 0.0) {
        made.kind = RV_REAL;
        made.as.real = value;
    }
    return made;
}

rv_number number_of_double(double x)
{
    rv_number made = UNKNOWN_NUMBER;
    made.as.whole = RV_IS_NAN;
    if (x == x) { /* not NaN; input may be infinite */
        made.kind = RV_REAL;
        made.as.real = x;
    }
    return made;
}

static double as_double(const rv_number *x)
{
    return (x->kind == RV_WHOLE) ? (double)x->as.whole : x->as.real;
}

/* The sign of a - b, exactly: b is split into an integer and a fraction, as (double)a could round. */
static int sign_against(int64_t a, double b)
{
    int64_t floor_of_b;
    double rest;
    if (b >= 0x1p63) {
        return -1;
    }
    if (b < -0x1p63) {
        return 1;
    }
    floor_of_b = (int64_t)b; /* truncated: the rest has the sign of b */
    rest = b - (double)floor_of_b;
    if (a != floor_of_b) {
        return (a < floor_of_b) ? -1 : 1;
    }
    return (rest > 0.0) ? -1 : ((rest < 0.0) ? 1 : 0);
}

/* The sign of a - b. */
static int order(const rv_number *a, const rv_number *b)
{
    if (a->kind == RV_REAL) {
        if (b->kind == RV_REAL) {
            return (a->as.real > b->as.real) - (a->as.real < b->as.real);
        }
        return -sign_against(b->as.whole, a->as.real);
    }
    if (b->kind == RV_REAL) {
        return sign_against(a->as.whole, b->as.real);
    }
    return (a->as.whole > b->as.whole) - (a->as.whole < b->as.whole);
}

int32_t compare_numbers(int32_t how, const rv_number *a, const rv_number *b)
{
    int sign;
    bool holds;
    if ((a->kind == RV_UNKNOWN) || (b->kind == RV_UNKNOWN)) {
        return IS_UNKNOWN;
    }
    sign = order(a, b);
    switch (how) {
    case CMP_LT: holds = sign < 0; break;
    case CMP_LE: holds = sign <= 0; break;
    case CMP_EQ: holds = sign == 0; break;
    case CMP_NE: holds = sign != 0; break;
    case CMP_GE: holds = sign >= 0; break;
    default: holds = sign > 0; break;
    }
    return holds ? IS_TRUE : IS_FALSE;
}

/* Whether two numbers have the same kind and value; two unknown numbers are the same. */
bool same_number(const rv_number *a, const rv_number *b)
{
    if (a->kind != b->kind) {
        return false;
    }
    if (a->kind == RV_WHOLE) {
        return a->as.whole == b->as.whole;
    }
    return (a->kind == RV_UNKNOWN) || (a->as.real == b->as.real);
}

static rv_number added(const rv_number *a, const rv_number *b)
{
    if ((a->kind == RV_WHOLE) && (b->kind == RV_WHOLE)) {
        const int64_t x = a->as.whole;
        const int64_t y = b->as.whole;
        const bool fits = (y >= 0) ? (x <= INT64_MAX - y) : (x >= INT64_MIN - y);
        return fits ? whole(x + y) : UNKNOWN_NUMBER;
    }
    return real(as_double(a) + as_double(b));
}

static rv_number subtracted(const rv_number *a, const rv_number *b)
{
    if ((a->kind == RV_WHOLE) && (b->kind == RV_WHOLE)) {
        const int64_t x = a->as.whole;
        const int64_t y = b->as.whole;
        const bool fits = (y >= 0) ? (x >= INT64_MIN + y) : (x <= INT64_MAX + y);
        return fits ? whole(x - y) : UNKNOWN_NUMBER;
    }
    return real(as_double(a) - as_double(b));
}

/* |x|, also for INT64_MIN. */
static uint64_t size_of(int64_t x)
{
    return (x < 0) ? UINT64_C(0) - (uint64_t)x : (uint64_t)x;
}

static rv_number multiplied(const rv_number *a, const rv_number *b)
{
    if ((a->kind == RV_WHOLE) && (b->kind == RV_WHOLE)) {
        const uint64_t x = size_of(a->as.whole);
        const uint64_t y = size_of(b->as.whole);
        const bool negative = (a->as.whole < 0) != (b->as.whole < 0);
        const uint64_t most = (uint64_t)INT64_MAX + (negative ? 1U : 0U);
        uint64_t product;
        if ((x != 0) && (y > most / x)) {
            return UNKNOWN_NUMBER;
        }
        product = x * y;
        if (!negative) {
            return whole((int64_t)product);
        }
        return whole((product > (uint64_t)INT64_MAX) ? INT64_MIN : -(int64_t)product);
    }
    return real(as_double(a) * as_double(b));
}

static rv_number negated(const rv_number *a)
{
    if (a->kind == RV_WHOLE) {
        return (a->as.whole == INT64_MIN) ? UNKNOWN_NUMBER : whole(-a->as.whole);
    }
    return real(-a->as.real);
}

static rv_number magnitude(const rv_number *a)
{
    if (a->kind == RV_WHOLE) {
        return (a->as.whole < 0) ? negated(a) : *a;
    }
    return real(fabs(a->as.real));
}

/* An operand as a result: unknown if infinite. */
static rv_number picked(const rv_number *a)
{
    return (a->kind == RV_REAL) ? real(a->as.real) : *a;
}

/* The exact rounding error of x * x, for |x| < 2^500: Dekker's product (1971) by halves of 26 bits. Not
 * by fma(), which some C libraries of microcontrollers round twice. */
static double lost_of_square(double x, double square)
{
    const double split = x * 134217729.0; /* 2^27 + 1 */
    const double high = split - (split - x);
    const double low = x - high;
    return ((high * high - square) + 2.0 * high * low) + low * low;
}

/* sqrt(a^2 + b^2), the same on every machine, unlike hypot(): the root is corrected by the error of its
 * square, which is known to twice the precision. Scaled by a power of two if squares would leave the
 * range. */
static double length(double a, double b)
{
    const double x0 = fabs(a);
    const double y0 = fabs(b);
    const double longer = (x0 > y0) ? x0 : y0;
    const double shorter = (x0 > y0) ? y0 : x0;
    const double scale = (longer > 0x1p500) ? 0x1p-600 : ((longer < 0x1p-400) ? 0x1p700 : 1.0);
    const double x = longer * scale;
    const double y = shorter * scale;
    const double xx = x * x;
    const double yy = y * y;
    const double all = xx + yy;
    const double lost = ((xx - all) + yy) + (lost_of_square(x, xx) + lost_of_square(y, yy));
    const double root = sqrt(all);
    const double square = root * root;
    const double off = ((all - square) - lost_of_square(root, square)) + lost;
    return ((root > 0.0) ? root + off / (2.0 * root) : root) / scale;
}

static rv_number of_wholes(int32_t op, const rv_number *x)
{
    switch (op) {
    case CODE_NEG: return negated(x);
    case CODE_ABS: return magnitude(x);
    case CODE_ADD: return added(x, x + 1);
    case CODE_SUB: return subtracted(x, x + 1);
    case CODE_MUL: return multiplied(x, x + 1);
    default: return function_of_wholes(op, x->as.whole, x[1].as.whole);
    }
}

static rv_number of_reals(int32_t op, const rv_number *x)
{
    const double read[MOST_ARGUMENTS] = {x[0].as.real, x[1].as.real, x[2].as.real, x[3].as.real};
    switch (op) {
    case CODE_NEG: return negated(x);
    case CODE_ABS: return magnitude(x);
    case CODE_ADD: return added(x, x + 1);
    case CODE_SUB: return subtracted(x, x + 1);
    case CODE_MUL: return multiplied(x, x + 1);
    case CODE_DIV: return (read[1] == 0.0) ? UNKNOWN_NUMBER : real(read[0] / read[1]);
    case CODE_SQRT: return (read[0] < 0.0) ? UNKNOWN_NUMBER : real(sqrt(read[0]));
    case CODE_HYPOT: return real(length(read[0], read[1]));
    default: return real(function_of_reals(op, read));
    }
}

/* Whether an operation takes whole numbers as reals. */
static bool is_of_reals(int32_t op)
{
    return (op == CODE_DIV) || (op == CODE_SQRT) || (op == CODE_HYPOT)
           || is_within(op, CODE_SIN, CODE_DISTANCE_ON_EARTH + 1);
}

/* The result of an operation on `count` numbers. If one is real, the others are rounded to reals first;
 * min, max and clamp, which only compare, use the exact order. */
static rv_number calculated(int32_t op, const rv_number *args, int32_t count)
{
    rv_number x[MOST_ARGUMENTS] = {UNKNOWN_NUMBER, UNKNOWN_NUMBER, UNKNOWN_NUMBER, UNKNOWN_NUMBER};
    bool wholes = !is_of_reals(op);
    int32_t i;
    for (i = 0; i < count; i++) {
        if (args[i].kind == RV_UNKNOWN) {
            return UNKNOWN_NUMBER;
        }
        wholes = wholes && (args[i].kind == RV_WHOLE);
        x[i] = args[i];
    }
    for (i = 0; !wholes && (i < count); i++) {
        x[i].as.real = as_double(&args[i]);
        x[i].kind = RV_REAL;
    }
    switch (op) {
    case CODE_MIN: return picked((order(&x[1], &x[0]) < 0) ? &x[1] : &x[0]);
    case CODE_MAX: return picked((order(&x[1], &x[0]) > 0) ? &x[1] : &x[0]);
    case CODE_CLAMP: {
        const rv_number *raised = (order(&x[1], &x[0]) > 0) ? &x[1] : &x[0];
        return picked((order(&x[2], raised) < 0) ? &x[2] : raised);
    }
    default: return wholes ? of_wholes(op, x) : of_reals(op, x);
    }
}

rv_number difference(const rv_number *a, const rv_number *b)
{
    const rv_number both[2] = {*a, *b};
    return calculated(CODE_SUB, both, 2);
}

/* PREV, DELTA, RATE (per second) of the last two updates of a signal, whose value is `now`. */
static rv_number of_updates(int32_t op, const history *h, const rv_number *now)
{
    rv_number found = UNKNOWN_NUMBER;
    if ((h->updates == 2) && (now->kind != RV_UNKNOWN)) {
        found = h->before;
    }
    if ((op != CODE_PREV) && (found.kind != RV_UNKNOWN)) {
        found = subtracted(now, &found);
        if ((op == CODE_RATE) && (found.kind != RV_UNKNOWN)) {
            const rv_number scaled[2] = {found, real(1e9)};
            const rv_number shared[2] = {calculated(CODE_MUL, scaled, 2), whole(h->at - h->before_at)};
            found = calculated(CODE_DIV, shared, 2);
        }
    }
    return found;
}

/* A field of an occurrence; `at` is, by event, the occurrence; NULL: the last one. */
static rv_number field_value(const run *r, int32_t event, int32_t field, const int32_t *at)
{
    const occurrences *o = &r->payloads[event];
    const int32_t one = (at != NULL) ? at[event] : o->count - 1;
    if ((one < 0) || (one >= o->count) || (o->known[one] == 0U) || (r->silent[event] == IS_UNKNOWN)) {
        return UNKNOWN_NUMBER;
    }
    return o->fields[one * r->part->events[event].fields + field];
}

/* Ticks since the first position; unknown if it is not certain which is the first, or if this is one. */
static rv_number time_now(const run *r)
{
    const bool known = (r->at.sure_from == r->at.origin) && !r->at.dense && (r->at.presence == ARE_THERE);
    return known ? whole(r->at.position - r->at.sure_from) : UNKNOWN_NUMBER;
}

/* Seconds in ticks, rounded to nearest, ties to even; clamped to +-LIMIT. */
int64_t seconds_in_ticks(const rv_number *seconds)
{
    const double ticks = as_double(seconds) * 1e9;
    if (seconds->kind == RV_WHOLE) {
        const int64_t most = LIMIT / 1000000000;
        return (seconds->as.whole > most) ? LIMIT : ((seconds->as.whole < -most) ? -LIMIT
                                                     : seconds->as.whole * 1000000000);
    }
    return (ticks >= 0x1p62) ? LIMIT : ((ticks <= -0x1p62) ? -LIMIT : (int64_t)rint(ticks));
}

/* Run the program (postfix, SEC_CODE) at `place`. `at` is, by event, the occurrence that FIELD reads. The
 * plan check has bounded the depth of the stack and every argument. O(operations). */
rv_number program_value(const run *r, int32_t place, const int32_t *at)
{
    rv_number stack[PROGRAM_DEPTH];
    const plan *p = PLAN(r);
    const int32_t *word = &p->code[place];
    int32_t n = 0;
    for (; (*word & 255) != CODE_END; word++) {
        const int32_t op = *word & 255;
        const int32_t arg = *word >> 8;
        switch (op) {
        case CODE_NUMBER:
            stack[n].kind = (int32_t)p->numbers[arg].kind;
            stack[n].as.whole = p->numbers[arg].as.whole;
            if (stack[n].kind == RV_REAL) {
                stack[n].as.real = p->numbers[arg].as.real;
            }
            n++;
            break;
        case CODE_NOW: stack[n++] = time_now(r); break;
        case CODE_WINDOW: stack[n++] = r->amounts[arg]; break;
        case CODE_SIGNAL: stack[n++] = r->value[arg]; break;
        case CODE_CAPTURED: stack[n++] = r->captured[arg]; break;
        case CODE_FIELD:
            word++;
            stack[n++] = field_value(r, arg, *word, at);
            break;
        case CODE_PREV:
        case CODE_DELTA:
        case CODE_RATE: stack[n++] = of_updates(op, &r->history[arg], &r->value[arg]); break;
        default: {
            const int32_t count = arguments_of(op);
            n -= count - 1;
            stack[n - 1] = calculated(op, &stack[n - 1], count);
            break;
        }
        }
    }
    return stack[0];
}
