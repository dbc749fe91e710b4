/* Arithmetic of programs in 64 bits; each function returns false where there is no result. */
#ifndef RVMON_ZONES_ARITHMETIC_H
#define RVMON_ZONES_ARITHMETIC_H

#include "plan.h"

static inline bool added(int64_t a, int64_t b, int64_t *to)
{
    if ((b > 0) ? (a > INT64_MAX - b) : (a < INT64_MIN - b)) {
        return false;
    }
    *to = a + b;
    return true;
}

static inline bool subtracted(int64_t a, int64_t b, int64_t *to)
{
    if ((b < 0) ? (a > INT64_MAX + b) : (a < INT64_MIN + b)) {
        return false;
    }
    *to = a - b;
    return true;
}

static inline bool multiplied(int64_t a, int64_t b, int64_t *to)
{
    if ((a >= INT32_MIN) && (a <= INT32_MAX) && (b >= INT32_MIN) && (b <= INT32_MAX)) {
        *to = a * b;
        return true;
    }
    if ((a != 0) && (b != 0)
        && ((a > 0) ? ((b > 0) ? (a > INT64_MAX / b) : (b < INT64_MIN / a))
                    : ((b > 0) ? (a < INT64_MIN / b) : (b < INT64_MAX / a)))) {
        return false;
    }
    *to = a * b;
    return true;
}

static inline bool within(int64_t x, int64_t first, int64_t count)
{
    return (x >= first) && (x - first < count);
}

/* A binary operation. */
static bool combine(int32_t op, int64_t a, int64_t b, int64_t *to)
{
    switch (op) {
    case OP_LT:
        *to = a < b;
        return true;
    case OP_LE:
        *to = a <= b;
        return true;
    case OP_EQ:
        *to = a == b;
        return true;
    case OP_NE:
        *to = a != b;
        return true;
    case OP_GE:
        *to = a >= b;
        return true;
    case OP_GT:
        *to = a > b;
        return true;
    case OP_ADD:
        return added(a, b, to);
    case OP_SUB:
        return subtracted(a, b, to);
    case OP_MUL:
        return multiplied(a, b, to);
    case OP_BIT_AND:
        *to = a & b;
        return true;
    case OP_BIT_OR:
        *to = a | b;
        return true;
    case OP_BIT_XOR:
        *to = a ^ b;
        return true;
    case OP_LEFT:
        return (b >= 0) && (b < 32) && multiplied(a, (int64_t)1 << b, to);
    case OP_RIGHT: /* rounds down, which C does not guarantee for negative numbers */
        if ((b < 0) || (b >= 32)) {
            return false;
        }
        *to = (a >= 0) ? a >> b : ~(~a >> b);
        return true;
    case OP_LEAST:
        *to = (a < b) ? a : b;
        return true;
    case OP_MOST:
        *to = (a > b) ? a : b;
        return true;
    default:
        if ((b == 0) || ((a == INT64_MIN) && (b == -1))) {
            return false;
        }
        *to = (op == OP_DIV) ? a / b : a % b;
        return true;
    }
}

#endif
