/* Validates the programs of a plan: targets of jumps and calls, and the depth of the stack. */
#ifndef RVMON_ZONES_CODE_CHECK_H
#define RVMON_ZONES_CODE_CHECK_H

#include "plan.h"

/* For each op: its operands, the depth of the stack that it needs, and its effect on the depth at the next
 * instruction. */
static const struct {
    int8_t operands;
    int8_t needs;
    int8_t change;
} shapes[OPS] = {
    [OP_END] = {0, 1, 0},     [OP_CONST] = {1, 0, 1},  [OP_VARIABLE] = {1, 0, 1},
    [OP_INDEX] = {2, 1, 0},   [OP_ROW] = {1, 2, -1},   [OP_ELEMENT] = {2, 1, 0},
    [OP_LOOKUP] = {2, 1, 0},  [OP_PLACE] = {2, 0, 1},  [OP_NOT] = {0, 1, 0},
    [OP_NEGATE] = {0, 1, 0},  [OP_TRUTH] = {0, 1, 0},  [OP_AND] = {1, 1, -1},
    [OP_OR] = {1, 1, -1},     [OP_IMPLY] = {1, 1, -1}, [OP_UNLESS] = {1, 1, -1},
    [OP_GO] = {1, 0, 0},      [OP_LT] = {0, 2, -1},    [OP_LE] = {0, 2, -1},
    [OP_EQ] = {0, 2, -1},     [OP_NE] = {0, 2, -1},    [OP_GE] = {0, 2, -1},
    [OP_GT] = {0, 2, -1},     [OP_ADD] = {0, 2, -1},   [OP_SUB] = {0, 2, -1},
    [OP_MUL] = {0, 2, -1},    [OP_DIV] = {0, 2, -1},   [OP_MOD] = {0, 2, -1},
    [OP_BIT_AND] = {0, 2, -1}, [OP_BIT_OR] = {0, 2, -1}, [OP_BIT_XOR] = {0, 2, -1},
    [OP_LEFT] = {0, 2, -1},   [OP_RIGHT] = {0, 2, -1}, [OP_LEAST] = {0, 2, -1},
    [OP_MOST] = {0, 2, -1},   [OP_INVERT] = {0, 1, 0}, [OP_SET] = {1, 1, -1},
    [OP_STORE] = {2, 2, -2},  [OP_CLOCK] = {1, 1, -1}, [OP_CALL] = {1, 0, 1},
    [OP_DROP] = {0, 1, -1},   [OP_HEAD] = {0, 0, 0},   [OP_BACK] = {1, 0, 0},
    [OP_FAIL] = {0, 0, 1},
};

enum { UNSEEN = -1, NO_WAY = -2 };

typedef struct {
    const int32_t *plan;
    int16_t *depth;   /* of the stack, at targets of jumps */
    uint8_t *starts;  /* at the start of a program, one more than the depth of its nested calls; else 0 */
    int32_t begin;    /* of the current program */
} checker;

static bool within(int64_t first, int64_t count, int64_t all)
{
    return (first >= 0) && (count >= 0) && (first <= all) && (count <= all - first);
}

static int32_t rows(const checker *c, int section)
{
    return plan_count(c->plan, section);
}

static bool is_program(const checker *c, int32_t at)
{
    return (at >= 0) && (at < rows(c, AT_CODE)) && (c->starts[at] != 0);
}

static bool is_program_or_none(const checker *c, int32_t at)
{
    return (at == -1) || is_program(c, at);
}

static bool operands_fit(const checker *c, int32_t op, const int32_t *operand)
{
    switch (op) {
    case OP_VARIABLE:
    case OP_SET:
        return within(operand[0], 1, rows(c, AT_VARIABLES));
    case OP_CLOCK:
        return within((int64_t)operand[0] - 1, 1, c->plan[HEAD_CLOCKS]);
    case OP_INDEX:
        return (operand[1] >= 0) && ((int64_t)operand[0] + operand[1] <= INT32_MAX);
    case OP_ROW:
        return operand[0] >= 0;
    case OP_ELEMENT:
    case OP_STORE:
        return within(operand[0], operand[1], rows(c, AT_VARIABLES));
    case OP_LOOKUP:
        return within(operand[0], operand[1], rows(c, AT_TABLE));
    case OP_PLACE:
        return within(operand[0], 1, rows(c, AT_AUTOMATA))
               && within(operand[1], 1, plan_rows(c->plan, AT_AUTOMATA)[3 * operand[0] + 1]);
    default:
        return true;
    }
}

/* Jumps go forward, and all jumps to one target have the same depth of the stack. */
static bool jumps(checker *c, int32_t from, int32_t to, int depth)
{
    if ((to <= from) || (to >= rows(c, AT_CODE))) {
        return false;
    }
    if (c->depth[to] == UNSEEN) {
        c->depth[to] = (int16_t)depth;
    }
    return c->depth[to] == depth;
}

/* Calls go to earlier programs, so that none is recursive. A loop goes back to its head, with an empty
 * stack. */
static bool flows(checker *c, int32_t op, int32_t at, int32_t to, int depth)
{
    if (op == OP_HEAD) {
        c->depth[at] = 0;
        return depth == 0;
    }
    if (op == OP_BACK) {
        return (depth == 0) && (to >= c->begin) && (to < at) && (c->depth[to] == 0)
               && (plan_rows(c->plan, AT_CODE)[to] == OP_HEAD);
    }
    if (op == OP_CALL) {
        if ((to < 0) || (to >= c->begin) || (c->starts[to] == 0) || (c->starts[to] > MOST_NEST)) {
            return false;
        }
        if (c->starts[c->begin] <= c->starts[to]) {
            c->starts[c->begin] = (uint8_t)(c->starts[to] + 1);
        }
    }
    return true;
}

/* Check all programs, one after the other. */
static bool programs_fit(checker *c)
{
    const int32_t *code = plan_rows(c->plan, AT_CODE);
    const int32_t count = rows(c, AT_CODE);
    int depth = 0;
    bool begins = true;
    int32_t at = 0;
    while (at < count) {
        const int32_t op = code[at];
        int32_t i;
        if (begins) {
            if (c->depth[at] != UNSEEN) { /* a jump out of the previous program */
                return false;
            }
            c->starts[at] = 1;
            c->begin = at;
            depth = 0;
            begins = false;
        } else if (c->depth[at] != UNSEEN) {
            if ((depth != NO_WAY) && (depth != c->depth[at])) {
                return false;
            }
            depth = c->depth[at];
        }
        if ((op < 0) || (op >= OPS) || (depth < shapes[op].needs)
            || !within(at, 1 + shapes[op].operands, count)
            || !operands_fit(c, op, code + at + 1)
            || !flows(c, op, at, (shapes[op].operands > 0) ? code[at + 1] : 0, depth)) {
            return false;
        }
        for (i = 1; i <= shapes[op].operands; i++) { /* no jump may lead between the operands */
            if (c->depth[at + i] != UNSEEN) {
                return false;
            }
        }
        if (op == OP_END) {
            begins = true;
            if (depth != 1) {
                return false;
            }
        }
        if ((op >= OP_AND) && (op <= OP_GO)
            && !jumps(c, at + 1, code[at + 1], (op == OP_UNLESS) ? depth - 1 : depth)) {
            return false;
        }
        depth = ((op == OP_GO) || (op == OP_BACK)) ? NO_WAY : depth + shapes[op].change;
        if (depth > STACK) {
            return false;
        }
        at += 1 + shapes[op].operands;
    }
    return begins;
}

#endif
