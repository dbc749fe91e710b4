/* The primitive fields of a snapshot: integers of fixed size in little-endian order. Each function
 * writes or reads one; when reading, a value out of its bounds refuses the snapshot and is not
 * stored. */
#include "formulas/formulas.h"
#include "snapshot/snapshot.h"

#include <string.h>

/* Carry the low `bytes` bytes of a number. */
static void carry_digits(carrier *c, uint64_t *x, size_t bytes)
{
    size_t i;
    if (c->refused) {
        return;
    }
    if (c->reading) {
        uint64_t made = 0;
        if (c->size - c->at < bytes) {
            c->refused = true;
            return;
        }
        for (i = 0; i < bytes; i++) {
            made |= (uint64_t)c->from[c->at + i] << (8 * i);
        }
        *x = made;
    } else if (c->to != NULL) {
        for (i = 0; i < bytes; i++) {
            c->to[c->at + i] = (uint8_t)(*x >> (8 * i));
        }
    } else {
        /* Only counted. */
    }
    c->at += bytes;
}

/* Two's complement to int64, without the implementation-defined conversion of a large uint64. */
static int64_t signed_of(uint64_t digits)
{
    int64_t made;
    (void)memcpy(&made, &digits, sizeof made);
    return made;
}

void carry_word(carrier *c, uint64_t *x)
{
    carry_digits(c, x, 8);
}

void carry_byte(carrier *c, uint8_t *x, uint8_t most)
{
    carry_bytes(c, x, 1, most);
}

void carry_bytes(carrier *c, uint8_t *x, int64_t count, uint8_t most)
{
    const size_t size = (size_t)count;
    size_t i;
    if (c->refused) {
        return;
    }
    if (c->reading) {
        if (c->size - c->at < size) {
            c->refused = true;
            return;
        }
        for (i = 0; i < size; i++) {
            demand(c, c->from[c->at + i] <= most);
        }
        if (c->refused) {
            return;
        }
        if (size > 0) {
            (void)memcpy(x, &c->from[c->at], size);
        }
    } else if ((c->to != NULL) && (size > 0)) {
        (void)memcpy(&c->to[c->at], x, size);
    } else {
        /* Only counted. */
    }
    c->at += size;
}

void carry_flag(carrier *c, bool *x)
{
    uint8_t byte = *x ? 1 : 0;
    carry_byte(c, &byte, 1);
    *x = byte != 0U;
}

void carry_long(carrier *c, int64_t *x, int64_t low, int64_t most)
{
    uint64_t digits = (uint64_t)*x;
    int64_t found;
    carry_digits(c, &digits, 8);
    found = signed_of(digits);
    demand(c, (found >= low) && (found <= most));
    if (!c->refused) {
        *x = found;
    }
}

void carry_int(carrier *c, int32_t *x, int64_t low, int64_t end)
{
    uint64_t digits = (uint32_t)*x;
    int64_t found;
    carry_digits(c, &digits, 4);
    found = (digits > INT32_MAX) ? (int64_t)digits - (INT64_C(1) << 32) : (int64_t)digits;
    demand(c, is_within(found, low, end));
    if (!c->refused) {
        *x = (int32_t)found;
    }
}

void carry_count(carrier *c, uint32_t *x)
{
    uint64_t digits = *x;
    carry_digits(c, &digits, 4);
    *x = (uint32_t)digits;
}

void carry_instant(carrier *c, int64_t *x)
{
    carry_long(c, x, 1 - LIMIT, LIMIT - 1);
}

void carry_instant_or(carrier *c, int64_t *x, int64_t none)
{
    bool there = *x != none;
    carry_flag(c, &there);
    if (there) {
        carry_instant(c, x);
    } else if (c->reading) {
        *x = none;
    } else {
        /* There is none. */
    }
}

/* A number: its kind, then its value. For an unknown number with a known cause, the kind is above RV_REAL
 * and gives the cause. */
void carry_number(carrier *c, rv_number *x)
{
    const bool says_why = (x->kind == RV_UNKNOWN) && (x->as.whole > 0) && (x->as.whole <= IS_STALE);
    uint8_t kind = (uint8_t)(says_why ? RV_REAL + x->as.whole : x->kind);
    uint64_t digits = 0;
    carry_byte(c, &kind, RV_REAL + IS_STALE);
    if ((kind != RV_UNKNOWN) && (kind <= RV_REAL)) {
        (void)memcpy(&digits, &x->as, sizeof digits);
        carry_word(c, &digits);
    }
    if (c->reading && !c->refused) {
        (void)memset(x, 0, sizeof *x);
        x->kind = kind;
        if (kind > RV_REAL) {
            digits = (uint64_t)(kind - RV_REAL);
            x->kind = RV_UNKNOWN;
        }
        (void)memcpy(&x->as, &digits, sizeof digits);
        demand(c, (kind != RV_REAL) || (x->as.real == x->as.real));
    }
}

void carry_size(carrier *c, int32_t *x, int64_t most, size_t each)
{
    carry_int(c, x, 0, (most < MOST / 4) ? most + 1 : MOST / 4);
    if (c->reading && !c->refused) {
        demand(c, (size_t)*x <= (c->size - c->at) / each);
    }
    if (c->refused) {
        *x = 0;
    }
}

void carry_list(carrier *c, int32_t *items, int32_t *count, int32_t end, uint8_t *listed)
{
    uint8_t *own = listed;
    int32_t i;
    carry_size(c, count, end, 4);
    if (c->reading && (own == NULL)) {
        own = arena_take(&c->m->memory, (size_t)end + 1);
        c->m->spoilt = c->m->spoilt || (own == NULL);
    }
    for (i = 0; (i < *count) && !is_lost(c); i++) {
        carry_int(c, &items[i], 0, end);
        if (c->reading && !c->refused) {
            demand(c, own[items[i]] == 0U);
            own[items[i]] = 1;
        }
    }
    if (c->refused) {
        *count = 0;
    }
    if (c->reading && (listed == NULL)) {
        arena_give(&c->m->memory, own, (size_t)end + 1);
    }
}

void carry_timers(carrier *c, timers *h, int32_t ids, const int32_t *numbers)
{
    int32_t count = h->count;
    int32_t i;
    carry_size(c, &count, ids, 12);
    for (i = 0; (i < count) && !is_lost(c); i++) {
        int32_t id = c->reading ? 0 : h->ids[i];
        int64_t due = h->due[id];
        if (!c->reading && (numbers != NULL)) {
            id = numbers[id];
        }
        carry_int(c, &id, 0, ids);
        carry_long(c, &due, -LIMIT, NEVER - 1);
        if (c->reading && !c->refused) {
            demand(c, h->due[id] == NEVER);
            timers_set(h, id, due);
        }
    }
}
