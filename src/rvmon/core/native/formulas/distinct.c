/* Which members of a window have the same number: a table of the places of the latest ones in their ring.
 *
 * Places of members that have left, or are not the latest any more, stay until the table is made anew;
 * what stands at a place tells whether it is one. */
#include "formulas/formulas.h"
#include "formulas/members.h"
#include "input/input.h"

#include <string.h>

/* Equal numbers have one: a whole one that is a double has that of the double. */
static uint32_t hash_of(const rv_number *number)
{
    uint64_t bits = (uint64_t)number->as.whole;
    double real = number->as.real;
    if ((number->kind == RV_WHOLE) && (number->as.whole > -(INT64_C(1) << 53))
        && (number->as.whole < (INT64_C(1) << 53))) {
        real = (double)number->as.whole;
    }
    if ((number->kind == RV_REAL) || (real == (double)number->as.whole)) {
        real += 0.0; /* a 0 has no sign */
        (void)memcpy(&bits, &real, sizeof bits);
    }
    bits *= UINT64_C(0x9E3779B97F4A7C15);
    return (uint32_t)(bits >> 32);
}

static bool is_latest(const window *w, int32_t place, const rv_number *number)
{
    const stretches *own = w->s + 1;
    const int32_t i = (place - own->head) & (own->room - 1);
    rv_number found;
    if ((i >= own->count) || ((own->at[place].begin & MEMBER_OLDER) != 0)) {
        return false;
    }
    found = member_number(w, i, false);
    return compare_numbers(CMP_EQ, &found, number) == IS_TRUE;
}

static void put_place(stretches *s, const rv_number *number, int32_t place)
{
    uint32_t slot = hash_of(number) & (uint32_t)(s->slot_room - 1);
    while (s->slots[slot] >= 0) {
        slot = (slot + 1) & (uint32_t)(s->slot_room - 1);
    }
    s->slots[slot] = place;
    s->known_slots++;
}

/* Make the table of what is in the ring, with as much room again; false: memory is short. */
static bool make_table(window *w)
{
    stretches *s = w->s;
    const int32_t wanted = (s->room > 8) ? s->room : 8;
    int32_t i;
    if (s->slot_room < 4 * wanted) {
        arena *a = &w->r->home->monitor->memory;
        int32_t *made = (wanted < INT32_MAX / 16) ? arena_take(a, 4 * (size_t)wanted * sizeof *made) : NULL;
        if (made == NULL) {
            w->r->home->monitor->spoilt = true;
            return false;
        }
        arena_give(a, s->slots, (size_t)s->slot_room * sizeof *made);
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

/* The place of the latest member with a number; -1: there is none. */
int32_t latest_with(window *w, const rv_number *number)
{
    stretches *s = w->s;
    uint32_t slot;
    if (((s->known_slots < 0) || (s->slot_room == 0) || (s->known_slots > s->slot_room / 2)) && !make_table(w)) {
        return -1;
    }
    slot = hash_of(number) & (uint32_t)(s->slot_room - 1);
    while (s->slots[slot] >= 0) {
        if (is_latest(w, s->slots[slot], number)) {
            return s->slots[slot];
        }
        slot = (slot + 1) & (uint32_t)(s->slot_room - 1);
    }
    return -1;
}

/* The last member is the latest with its number. */
void note_latest(window *w, const rv_number *number)
{
    stretches *s = w->s;
    if (s->known_slots >= 0) {
        put_place(s, number, (s[1].head + s[1].count - 1) & (s[1].room - 1));
    }
}
