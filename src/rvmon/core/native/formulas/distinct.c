/* Which members of a window have the same number: a table of the places of the latest ones in their ring.
 *
 * Places of members that have left stay until others need theirs, or the table is made anew; what stands at
 * a place tells whether it is one. */
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

/* Which member stands at a place, if it is the latest with its number; -1: none. */
static int32_t latest_at(const window *w, int32_t place)
{
    const stretches *own = w->s + 1;
    const int32_t i = (place - own->head) & (own->room - 1);
    return ((i < own->count) && ((own->at[place].begin & MEMBER_OLDER) == 0)) ? i : -1;
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

/* The place of the latest member with a number; -1: there is none. The window learns where the next one
 * is to be noted. */
int32_t find_latest(window *w, const rv_number *number)
{
    stretches *s = w->s;
    uint32_t slot;
    w->slot = -1;
    if (((s->known_slots < 0) || (s->slot_room == 0) || (s->known_slots > s->slot_room / 2)) && !make_table(w)) {
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
            w->slot = (int32_t)slot; /* what stood there has left */
        } else {
            /* An earlier one serves. */
        }
        slot = (slot + 1) & (uint32_t)(s->slot_room - 1);
    }
    if (w->slot < 0) {
        w->slot = (int32_t)slot;
        s->known_slots++;
    }
    return -1;
}

/* The last member is the latest with the number that was looked for. */
void note_latest(window *w)
{
    stretches *s = w->s;
    if ((s->known_slots >= 0) && (w->slot >= 0)) {
        s->slots[w->slot] = (s[1].head + s[1].count - 1) & (s[1].room - 1);
    }
}
