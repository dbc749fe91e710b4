/* The members of a window of the past: what of them is kept, and what they come to. */
#ifndef RVMON_MEMBERS_H
#define RVMON_MEMBERS_H

#include "basics.h"

/* A node WINDOW at the position at hand. Behind the stretches of positions stands a ring with what is
 * the same at each: the number of a member, and whether it is one. */
typedef struct {
    run *r;
    const node_plan *n;
    stretches *s;
    tally *x;                  /* NULL: nothing is added up */
    int64_t t;
    int64_t unit;              /* ticks of a member */
    int32_t fold;
    bool of_ticks;             /* each tick is one, up to the one before */
    int32_t slot;              /* of the table of distinct.c */
} window;

/* What stands of a member beside the kind of its number: it may be none; a later one has the same. */
enum { MEMBER_KIND = 3, MEMBER_MAYBE = 4, MEMBER_OLDER = 8 };

static inline bool keeps_extremes(const window *w)
{
    return (w->fold == FOLD_MIN) || (w->fold == FOLD_MAX);
}

static inline stretch *stretch_of(const stretches *s, int32_t i)
{
    return &s->at[(s->head + i) & (s->room - 1)];
}

/* The number of a member by one of two readings: one that may be none is that, or 0. */
rv_number member_number(const window *w, int32_t i, bool better);
bool is_counted(const window *w, int32_t i, bool better);

/* ---- members.c */
void extend_last_member(window *w, int64_t end);
bool add_member(window *w, const rv_number *number, bool maybe);
void expire_members(window *w);
void forget_members(window *w);

/* ---- distinct.c */
int32_t find_latest(window *w, const rv_number *number);
void note_latest(window *w);

/* Whether a number is the least, or greatest, that matters; it lets go of those that do not any more. */
bool push_extreme(window *w, const rv_number *number);

/* ---- folds.c */
uint8_t folded(window *w, int64_t *due);

/* ---- amounts.c: what the members come to as a number */
rv_number amount_of(const window *w, int64_t *due);

#endif
