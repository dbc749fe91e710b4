/* Positions at which a value changes, as a ring. */
#include "windows/windows.h"

int64_t change_at(const changes *c, int32_t i)
{
    return c->at[(c->head + i) & (c->room - 1)];
}

int64_t last_change(const changes *c)
{
    return change_at(c, c->count - 1);
}

void add_change(rv_monitor *m, changes *c, int64_t position)
{
    if (c->count == c->room) {
        const int32_t room = (c->room > 0) ? 2 * c->room : 8;
        int64_t *made = (c->room < INT32_MAX / 4)
            ? arena_take(&m->memory, (size_t)room * sizeof *made) : NULL;
        int32_t i;
        if (made == NULL) {
            m->spoilt = true;
            return;
        }
        for (i = 0; i < c->count; i++) {
            made[i] = change_at(c, i);
        }
        arena_give(&m->memory, c->at, (size_t)c->room * sizeof *made);
        c->at = made;
        c->room = room;
        c->head = 0;
    }
    c->at[(c->head + c->count) & (c->room - 1)] = position;
    c->count++;
}

void copy_changes(rv_monitor *m, changes *made, const changes *c)
{
    int32_t i;
    made->head = 0;
    made->count = 0;
    made->begun = c->begun;
    for (i = 0; i < c->count; i++) {
        add_change(m, made, change_at(c, i));
    }
}

bool changes_agree(const changes *a, const changes *b)
{
    int32_t i;
    if ((a->count != b->count) || (a->begun != b->begun)) {
        return false;
    }
    for (i = 0; i < a->count; i++) {
        if (change_at(a, i) != change_at(b, i)) {
            return false;
        }
    }
    return true;
}

void clear_changes(changes *c, bool value)
{
    c->head = 0;
    c->count = 0;
    c->begun = value;
}

/* So many changes are looked at one by one from where it was asked last; beyond, halves are. */
#define NEAR 4

/* How many changes there are up to a position: mostly all, or hardly more than when it was asked last.
 * Which half is next nobody can foretell: so these steps are chosen without a branch. */
int32_t changes_until(changes *c, int64_t position)
{
    int32_t low = (c->asked < c->count) ? c->asked : 0;
    int32_t left = c->count;
    int32_t i;
    if ((left == 0) || (change_at(c, left - 1) <= position)) {
        return left;
    }
    if ((low > 0) && (change_at(c, low - 1) > position)) {
        left = low;
        low = 0;
    } else {
        for (i = 0; i < NEAR; i++) {
            if (change_at(c, low) > position) { /* the last one is */
                c->asked = low;
                return low;
            }
            low++;
        }
        left -= low;
    }
    while (left > 1) {
        const int32_t half = left / 2;
        low += (change_at(c, low + half - 1) <= position) ? half : 0;
        left -= half;
    }
    low += ((left > 0) && (change_at(c, low) <= position)) ? 1 : 0;
    c->asked = low;
    return low;
}

bool value_behind(const changes *c, int32_t count)
{
    return c->begun != ((count & 1) == 1);
}

/* Drop the changes before a position. */
void drop_changes(changes *c, int64_t position)
{
    while ((c->count > 0) && (change_at(c, 0) < position)) {
        c->head = (c->head + 1) & (c->room - 1);
        c->count--;
        c->asked -= (c->asked > 0) ? 1 : 0;
        c->begun = !c->begun;
    }
}
