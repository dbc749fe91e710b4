/* Distinct numbers in a window: a hash table from a number to the latest entry that has it.
 *
 * Open addressing with linear probing; a slot holds a place in the ring s[1], -1: free. Expired entries
 * are not removed: a slot whose place is no longer in the ring, or is marked MEMBER_OLDER, is treated as
 * deleted and reused. The table is rebuilt when it is half full or the ring has moved. Expected cost
 * O(1) per member. */
#include "formulas/formulas.h"
#include "formulas/members.h"
#include "input/input.h"

#include <string.h>

/* A hash that is equal for equal numbers: a whole number that equals a double is hashed as that double.
 * Multiplication by 2^64 over the golden ratio (Knuth, TAOCP 3, 6.4). */
static uint32_t hash_of(const rv_number *number)
{
    uint64_t bits = (uint64_t)number->as.whole;
    double real = number->as.real;
    if ((number->kind == RV_WHOLE) && (number->as.whole > -(INT64_C(1) << 53))
        && (number->as.whole < (INT64_C(1) << 53))) {
        real = (double)number->as.whole;
    }
    if ((number->kind == RV_REAL) || (real == (double)number->as.whole)) {
        real += 0.0; /* makes -0.0 equal 0.0 */
        (void)memcpy(&bits, &real, sizeof bits);
    }
    bits *= UINT64_C(0x9E3779B97F4A7C15);
    return (uint32_t)(bits >> 32);
}

/* The entry at a place of the ring, if the place is in use and the entry is the latest with its number;
 * -1: the slot is stale. */
static int32_t latest_at(const window *w, int32_t place)
{
    const stretches *own = w->s + 1;
    const int32_t i = (place - own->head) & (own->room - 1);
    return ((i < own->count) && ((own->at[place].begin & MEMBER_OLDER) == 0)) ? i : -1;
}

/* Insert a place; the number is not in the table. */
static void put_place(stretches *s, const rv_number *number, int32_t place)
{
    uint32_t slot = hash_of(number) & (uint32_t)(s->slot_room - 1);
    while (s->slots[slot] >= 0) {
        slot = (slot + 1) & (uint32_t)(s->slot_room - 1);
    }
    s->slots[slot] = place;
    s->known_slots++;
}

/* Rebuild the table from the ring, with at least four slots for each place of the ring. False: memory
 * is short. */
static bool make_table(window *w)
{
    stretches *s = w->s;
    const int32_t wanted = (s->room > 8) ? s->room : 8;
    int32_t i;
    if (s->slot_room < 4 * wanted) {
        arena *a = &w->r->home->monitor->memory;
        const size_t size = 4 * (size_t)wanted * sizeof *s->slots;
        const size_t was = (size_t)s->slot_room * sizeof *s->slots;
        int32_t *made = (wanted < INT32_MAX / 16) ? arena_enlarge(a, s->slots, was, size) : NULL;
        if (made == NULL) {
            w->r->home->monitor->spoilt = true;
            return false;
        }
        s->slots = made;
        s->slot_room = 4 * wanted;
    }
    for (i = 0; i < s->slot_room; i++) {
        s->slots[i] = -1;
    }
    s->known_slots = 0;
    for (i = 0; i < s->count; i++) {
        const rv_number number = member_number(w, i, false);
        if ((number.kind != RV_UNKNOWN) && ((stretch_of(s + 1, i)->begin & MEMBER_OLDER) == 0)) {
            put_place(s, &number, (s[1].head + i) & (s[1].room - 1));
        }
    }
    return true;
}

/* The place of the latest entry with a number; -1: none. Sets `w->slot`, where note_latest() puts the
 * entry that is appended next. */
int32_t find_latest(window *w, const rv_number *number)
{
    stretches *s = w->s;
    uint32_t slot;
    w->slot = -1;
    if (((s->known_slots < 0) || (s->slot_room == 0) || (s->known_slots > s->slot_room / 2))
        && !make_table(w)) {
        return -1;
    }
    slot = hash_of(number) & (uint32_t)(s->slot_room - 1);
    while (s->slots[slot] >= 0) {
        const int32_t i = latest_at(w, s->slots[slot]);
        if (i >= 0) {
            const rv_number found = member_number(w, i, false);
            if (compare_numbers(CMP_EQ, &found, number) == IS_TRUE) {
                w->slot = (int32_t)slot;
                return s->slots[slot];
            }
        } else if (w->slot < 0) {
            w->slot = (int32_t)slot; /* the first stale slot of the probe is reused */
        } else {
            /* A live entry of another number, or a second stale slot. */
        }
        slot = (slot + 1) & (uint32_t)(s->slot_room - 1);
    }
    if (w->slot < 0) {
        w->slot = (int32_t)slot;
        s->known_slots++;
    }
    return -1;
}

/* Put the last entry of the ring, whose number find_latest() looked up, into the table. */
void note_latest(window *w)
{
    stretches *s = w->s;
    if ((s->known_slots >= 0) && (w->slot >= 0)) {
        s->slots[w->slot] = (s[1].head + s[1].count - 1) & (s[1].room - 1);
    }
}
