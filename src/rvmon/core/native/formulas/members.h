/* Windows of the past over numbers: count, sum, mean, max and others over a duration, or over the last N
 * members.
 *
 * A *member* is a position at which the first operand of the node holds, with a number. A *fold* makes
 * one number from all members, which is compared with a limit or read by other nodes. Equal members at
 * neighbouring positions are one entry, so memory and time depend on changes, not on positions. */
#ifndef RVMON_MEMBERS_H
#define RVMON_MEMBERS_H

#include "basics.h"

/* A WINDOW node at a position. Its entries are in two parallel rings: s[0] has the stretch of positions
 * of each entry, s[1] what its members have in common: in `begin` kind and marks (MEMBER_...), in `end`
 * the bits of the number.
 *
 * Counters, depending on the fold: s[0].members, all members; s[0].total, those that count (for
 * DISTINCT, the different numbers); s[1].total, those that may count; s[0].lost, those whose number is
 * unknown; s[1].lost, how many have to come until the last `most` members are known again; s[0].left,
 * all numbers were whole; s[1].right, some were negative; s[1].apart, the better reading has a sum of
 * its own. */
typedef struct {
    run *r;
    const node_plan *n;
    stretches *s;
    tally *x;                  /* exact sums: of two readings, or numbers and squares; NULL: none */
    int64_t t;                 /* the position, ticks; for MIN and MAX of the last N, a member's number */
    int64_t unit;              /* distance between two members of an entry, in units of `t` */
    int32_t fold;              /* FOLD_... */
    bool of_ticks;             /* each tick before `t` is a member; else positions are */
    int32_t slot;              /* where note_latest() puts the next member: distinct.c */
} window;

/* `begin` of an entry of s[1]: the kind of its number; it may not be a member (unknown operand); a
 * later entry has the same number (DISTINCT). */
enum { MEMBER_KIND = 3, MEMBER_MAYBE = 4, MEMBER_OLDER = 8 };

static inline bool keeps_extremes(const window *w)
{
    return (w->fold == FOLD_MIN) || (w->fold == FOLD_MAX);
}

/* The i-th oldest entry of a ring. */
static inline stretch *stretch_of(const stretches *s, int32_t i)
{
    return &s->at[(s->head + i) & (s->room - 1)];
}

/* The number of entry `i` in a reading of a sum. An entry that may not be a member has its number or 0,
 * whichever is less for the worse reading, and greater for the better one. */
rv_number member_number(const window *w, int32_t i, bool better);
/* Whether entry `i` counts in a reading, for COUNT and DURATION. */
bool is_counted(const window *w, int32_t i, bool better);

/* ---- members.c */
void extend_last_member(window *w, int64_t end);
bool add_member(window *w, const rv_number *number, bool maybe);
void expire_members(window *w);
void forget_members(window *w);

/* ---- distinct.c */
int32_t find_latest(window *w, const rv_number *number);
void note_latest(window *w);

/* Drop the entries that a new number makes irrelevant for MIN or MAX; returns whether the new number
 * has to be kept. */
bool push_extreme(window *w, const rv_number *number);

/* ---- folds.c: the fold of the members compared with the limit */
uint8_t folded(window *w, int64_t *due);

/* ---- amounts.c: the fold of the members as a number */
rv_number amount_of(const window *w, int64_t *due);

#endif
