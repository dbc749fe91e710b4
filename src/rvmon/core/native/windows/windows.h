/* Chains of windows: windows nested in windows over one Boolean combination of leaves, e.g. F[0, 3 s]
 * G[0, 1 s] p, perhaps required until something ends it, or excused where something holds.
 *
 * A chain is a special case of a delay network (networks/) with a cheaper form. Its values become known
 * in the order of positions, so its whole state is, for each level, the list of positions at which the
 * value changes. chain.c keeps these lists; windows.c judges attempts by them, and has the rings that
 * store the lists.
 *
 * Positions are ticks / gap, or the instants of samples where only samples are positions (`sparse`). A
 * *stamp* is a point in the order of knowledge: 2 t when time comes to t, 2 t + 1 once the letter at t
 * is known. */
#ifndef RVMON_WINDOWS_H
#define RVMON_WINDOWS_H

#include "networks/network.h"

/* ---- windows.c: attempts that a chain of windows judges */
bool is_chained(const run *r, int32_t index);
void chain_visit(run *r, int32_t index, int64_t t);
void chain_pass(run *r, int32_t index, int64_t t, bool is_position);
bool chain_enter(run *r, int32_t index, int32_t at, int64_t t);
bool chain_outlasts(run *r, int32_t index, const attempt *x, int64_t end, int64_t reached);

/* Later than all stamps and all positions. */
#define NEVER_KNOWN (NEVER - 1)

/* The parts of a letter: the base below the windows; the leaf that ends the obligation; the leaf that
 * excuses it. Each is 1 if true for the worse, plus 2 if true for the better. */
enum { BASE, LEFT, EXCUSED, FOLLOWED };

/* A judge with its chain; windows are levels 1 to `depth`, the base is level 0. */
typedef struct {
    run *r;
    judge *j;
    chain *c;
    int32_t index;
    form f;
    const int32_t *windows;    /* operators, the innermost first */
    int32_t depth;
    bool sparse;               /* only samples are positions */
} chaining;

static inline int64_t later(int64_t a, int64_t b)
{
    return (a > b) ? a : b;
}

/* ---- windows.c: rings of positions at which a value changes */
int64_t change_at(const changes *c, int32_t i);
int64_t last_change(const changes *c);
void add_change(rv_monitor *m, changes *c, int64_t position);
void copy_changes(rv_monitor *m, changes *made, const changes *c);
bool changes_agree(const changes *a, const changes *b);
void clear_changes(changes *c, bool value);
int32_t changes_until(changes *c, int64_t position);
bool value_after(const changes *c, int32_t count);
void drop_changes(changes *c, int64_t position);

/* ---- chain.c */
void begin_reading(const chaining *g, chain_reading *w, int64_t position, int32_t bit);
void forget_before(const chaining *g, int64_t position);
bool is_known(const uint8_t *letter);
void note_letter(const chaining *g, int64_t position, const uint8_t *letter);
int64_t first_failure(const chaining *g, chain_reading *w, int64_t position);
int64_t known_between(const chaining *g, chain_reading *w, int64_t first, int64_t stop);
bool outcome_of(const chaining *g, chain_reading *w, int64_t at, int64_t *stamp);

/* ---- windows.c */
chaining chaining_of(run *r, int32_t index);
chain *made_chain(const chaining *g);

#endif
