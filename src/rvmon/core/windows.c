/* Windows within windows over what a letter decides: what is known of them is known in order, so all
 * that has to be kept is where values change.
 *
 * A value of the base changes at some positions; so does the value of each window over it. A stretch
 * on which one position decides begins as far before that of the operand as the window reaches, and
 * ends as its last position leaves the window; shorter gaps vanish. So one change of the base is one
 * of each window: it comes to stand behind the others, or takes the last one away. The lists hold what
 * will be if the letter stays: a change that lies ahead is taken back if it does not.
 *
 * When something is known is told by stamps: 2 t as time comes to t, 2 t + 1 as the letter there is
 * known. From the first unknown letter on there are two readings, the unknown taken for the worse and
 * for the better.
 *
 * Source: AUTOMATA 4. */
#include "state.h"

#include <string.h>

/* Behind all stamps. */
#define NEVER_KNOWN (NEVER - 1)

/* What of a letter is followed. */
enum { BASE, LEFT, EXCUSED, FOLLOWED };

/* A judge with its chain. */
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

bool is_chained(const run *r, int32_t index)
{
    const judge_plan *j = &r->part->judges[index];
    return (j->automaton < 0) && (r->part->forms[j->form].windows.count > 0);
}

static chaining chaining_of(run *r, int32_t index)
{
    chaining g;
    g.r = r;
    g.j = &r->judges[index];
    g.c = g.j->chain;
    g.index = index;
    g.f = form_of(r, index);
    g.windows = LIST(g.f.plan, g.f.form->windows);
    g.depth = g.f.form->windows.count;
    g.sparse = g.f.gap == 0;
    return g;
}

/* A position so far ahead of another, or behind it; none is farther than the bounds of time. */
static int64_t moved(int64_t position, int64_t distance)
{
    const int64_t at = position + distance;
    return (at > LIMIT) ? LIMIT : ((at < -LIMIT) ? -LIMIT : at);
}

/* The stamp of time `over` ticks behind a position, or of the letter there. */
static int64_t stamp_of(const chaining *g, int64_t position, int64_t over, bool letter)
{
    int64_t t;
    if ((position >= LIMIT / g->f.step) || (over >= LIMIT)) {
        return NEVER_KNOWN;
    }
    t = position * g->f.step + over; /* less than twice LIMIT */
    return (t >= LIMIT) ? NEVER_KNOWN : 2 * t + (letter ? 1 : 0);
}

static const operator_plan *window_at(const chaining *g, int32_t level)
{
    return &g->f.nodes[g->windows[level - 1]];
}

static int64_t change_at(const changes *c, int32_t i)
{
    return c->at[(c->head + i) & (c->room - 1)];
}

static int64_t last_change(const changes *c)
{
    return change_at(c, c->count - 1);
}

static void add_change(rv_monitor *m, changes *c, int64_t position)
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

static void copy_changes(rv_monitor *m, changes *made, const changes *c)
{
    int32_t i;
    made->head = 0;
    made->count = 0;
    made->begun = c->begun;
    for (i = 0; i < c->count; i++) {
        add_change(m, made, change_at(c, i));
    }
}

static bool changes_agree(const changes *a, const changes *b)
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

static void clear_changes(changes *c, bool value)
{
    c->head = 0;
    c->count = 0;
    c->begun = value;
}

/* How many changes there are before a position, or up to it. */
static int32_t changes_until(const changes *c, int64_t position)
{
    int32_t low = 0;
    int32_t high = c->count;
    while (low < high) {
        const int32_t middle = low + (high - low) / 2;
        if (change_at(c, middle) <= position) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low;
}

static bool value_behind(const changes *c, int32_t count)
{
    return c->begun != ((count & 1) == 1);
}

/* Drop the changes before a position. */
static void drop_changes(changes *c, int64_t position)
{
    while ((c->count > 0) && (change_at(c, 0) < position)) {
        c->head = (c->head + 1) & (c->room - 1);
        c->count--;
        c->begun = !c->begun;
    }
}

/* The chain of a judge, made when it is used first; NULL: memory is short. */
static chain *made_chain(const chaining *g)
{
    arena *a = &g->f.monitor->memory;
    chain *made = arena_take(a, sizeof *made);
    int32_t i;
    if (made != NULL) {
        made->values = arena_take(a, (size_t)g->f.form->base + 1);
        for (i = 0; i < 2; i++) {
            made->readings[i].levels =
                arena_take(a, (size_t)(g->depth + 1) * sizeof *made->readings[i].levels);
        }
    }
    if ((made == NULL) || (made->values == NULL) || (made->readings[0].levels == NULL)
        || (made->readings[1].levels == NULL)) {
        g->f.monitor->spoilt = true;
        return NULL;
    }
    return made;
}

static uint8_t leaf_bits(const chaining *g, const operator_plan *n)
{
    return (uint8_t)n->values[(n->right < 0) ? 0 : (int32_t)g->r->truth[n->right]];
}

/* The base as the letter makes it: 1 if it is true for the worse, and 2 for the better. */
static uint8_t base_bits(const chaining *g)
{
    const int32_t base = g->f.form->base;
    int32_t i;
    int32_t k;
    for (i = 0; i <= base; i++) {
        const operator_plan *n = &g->f.nodes[i];
        uint8_t bits = 0;
        if (n->kind == OP_LEAF) {
            bits = leaf_bits(g, n);
        } else if (n->kind == OP_JUNCTION) {
            const int32_t *operands = LIST(g->f.plan, n->operands);
            bits = (n->turned != 0) ? 3 : 0;
            for (k = 0; k < n->operands.count; k++) {
                const uint8_t one = g->c->values[operands[k]];
                bits = (uint8_t)((n->turned != 0) ? (bits & one) : (bits | one));
            }
        } else {
            /* Nothing of the base. */
        }
        g->c->values[i] = bits;
    }
    return g->c->values[base];
}

/* The first position from which a window reaches one. */
static int64_t reached_from(const chaining *g, int64_t position, int64_t distance)
{
    const changes *stamps = &g->c->stamps;
    int32_t i;
    if (!g->sparse || (distance == 0)) {
        return moved(position, -distance);
    }
    i = changes_until(stamps, moved(position, -distance) - 1);
    return change_at(stamps, (i < stamps->count) ? i : stamps->count - 1);
}

/* Take a change of the base at a position into all levels. */
static void note_change(const chaining *g, chain_reading *w, int64_t at, bool value)
{
    rv_monitor *m = g->f.monitor;
    int64_t position = at;
    bool added = true;
    int32_t level;
    add_change(m, &w->levels[0], at);
    for (level = 1; level <= g->depth; level++) {
        const operator_plan *n = window_at(g, level);
        const changes *given = &w->levels[level - 1];
        changes *own = &w->levels[level];
        const bool decides = (n->turned != 0) ? !value : value;
        int64_t start;
        if (decides == added) { /* what decides begins here, or does not any more */
            start = reached_from(g, position, n->high);
            if (added) {
                added = !((own->count > 0) && (last_change(own) >= start));
            } else { /* the stretch before, if that was joined to it, ends again */
                position = (given->count > 0) ? moved(last_change(given), -n->low) : start - 1;
                added = position >= start;
                start = position;
            }
        } else {
            start = moved(position, -n->low);
        }
        if (m->spoilt) {
            return;
        }
        if (added) {
            add_change(m, own, start);
            position = start;
        } else if (own->count > 0) {
            position = last_change(own);
            own->count--;
        } else {
            m->spoilt = true; /* no plan of ours comes here */
            return;
        }
    }
}

static void begin_reading(const chaining *g, chain_reading *w, int64_t position, int32_t bit)
{
    int32_t level;
    for (level = 0; level <= g->depth; level++) {
        clear_changes(&w->levels[level], (g->c->letter[BASE] & bit) != 0);
    }
    clear_changes(&w->ends, (g->c->letter[LEFT] & bit) != 0);
    clear_changes(&w->excused, (g->c->letter[EXCUSED] & bit) != 0);
    w->start = position;
}

/* Ticks after which a position is known at the latest, or only leads on to later ones. */
static int64_t reach_of(const chaining *g)
{
    int64_t reach = 0;
    int32_t level;
    for (level = 1; level <= g->depth; level++) {
        reach = least(reach + window_at(g, level)->over, LIMIT);
    }
    return reach;
}

/* Drop what lies before all that is not known at a position. */
static void forget_before(const chaining *g, int64_t position)
{
    int64_t start = moved(moved(position, -(reach_of(g) / g->f.step)), -2);
    int32_t i;
    int32_t level;
    if (g->sparse) {
        changes *stamps = &g->c->stamps;
        while ((stamps->count > 1) && (change_at(stamps, 0) < start)) {
            stamps->head = (stamps->head + 1) & (stamps->room - 1);
            stamps->count--;
        }
        start = (stamps->count > 0) ? change_at(stamps, 0) : start;
    }
    for (i = 0; i < (g->c->parted ? 2 : 1); i++) {
        chain_reading *w = &g->c->readings[i];
        for (level = 0; level <= g->depth; level++) {
            drop_changes(&w->levels[level], start);
        }
        drop_changes(&w->ends, start);
        drop_changes(&w->excused, start);
        w->start = (start > w->start) ? start : w->start;
    }
}

static bool readings_agree(const chaining *g)
{
    const chain_reading *a = &g->c->readings[0];
    const chain_reading *b = &g->c->readings[1];
    int32_t level;
    for (level = 0; level <= g->depth; level++) {
        if (!changes_agree(&a->levels[level], &b->levels[level])) {
            return false;
        }
    }
    return changes_agree(&a->ends, &b->ends) && changes_agree(&a->excused, &b->excused)
           && (a->start == b->start);
}

static void part_readings(const chaining *g)
{
    const chain_reading *w = &g->c->readings[0];
    chain_reading *made = &g->c->readings[1];
    int32_t level;
    for (level = 0; level <= g->depth; level++) {
        copy_changes(g->f.monitor, &made->levels[level], &w->levels[level]);
    }
    copy_changes(g->f.monitor, &made->ends, &w->ends);
    copy_changes(g->f.monitor, &made->excused, &w->excused);
    made->start = w->start;
    g->c->parted = true;
}

static bool is_known(const uint8_t *letter)
{
    int32_t i;
    for (i = 0; i < FOLLOWED; i++) {
        if ((letter[i] == 1U) || (letter[i] == 2U)) {
            return false;
        }
    }
    return true;
}

/* Take the letter at a position; it stays until the next one. */
static void note_letter(const chaining *g, int64_t position, const uint8_t *letter)
{
    chain *c = g->c;
    int32_t i;
    if (!is_known(letter) && !c->parted) {
        part_readings(g);
    }
    for (i = 0; i < (c->parted ? 2 : 1); i++) {
        const uint8_t bit = (i == 0) ? 1U : 2U;
        chain_reading *w = &c->readings[i];
        if (((letter[LEFT] ^ c->letter[LEFT]) & bit) != 0U) {
            add_change(g->f.monitor, &w->ends, position);
        }
        if (((letter[EXCUSED] ^ c->letter[EXCUSED]) & bit) != 0U) {
            add_change(g->f.monitor, &w->excused, position);
        }
        if (((letter[BASE] ^ c->letter[BASE]) & bit) != 0U) {
            note_change(g, w, position, (letter[BASE] & bit) != 0U);
        }
    }
    (void)memcpy(c->letter, letter, FOLLOWED);
    forget_before(g, position);
    if (c->parted && is_known(letter) && readings_agree(g)) {
        c->parted = false;
    }
}

/* The value of the chain at a position, and the stamp as of which it is known. */
static bool known_of(const chaining *g, const chain_reading *w, int64_t at, int64_t *stamp)
{
    const changes *stamps = &g->c->stamps;
    int64_t position = at;
    int64_t over = INT64_MIN;
    bool value = false;
    int32_t level;
    for (level = g->depth; level >= 1; level--) {
        const operator_plan *n = window_at(g, level);
        const changes *given = &w->levels[level - 1];
        int64_t first = moved(position, n->low);
        const int32_t i = changes_until(given, first);
        bool decides = value_behind(given, i) == (n->turned == 0);
        if (!decides) {
            if ((i < given->count) && (change_at(given, i) <= moved(position, n->high))) {
                decides = true;
                first = change_at(given, i);
            } else {
                const int64_t own = stamp_of(g, position, n->over, false);
                over = (own > over) ? own : over;
                first = moved(position, n->high);
                if (g->sparse) {
                    const int32_t k = changes_until(stamps, first);
                    first = change_at(stamps, (k > 0) ? k - 1 : 0);
                }
            }
        }
        if (level == g->depth) {
            value = decides == (n->turned == 0);
        }
        position = first;
    }
    *stamp = stamp_of(g, position, 0, true);
    *stamp = (over > *stamp) ? over : *stamp;
    return value;
}

/* The first position from one on at which a value is so; NEVER_KNOWN: none if the letter stays. */
static int64_t first_from(const changes *c, int64_t position, bool wanted)
{
    const int32_t i = changes_until(c, position);
    if (value_behind(c, i) == wanted) {
        return position;
    }
    return (i < c->count) ? change_at(c, i) : NEVER_KNOWN;
}

static int64_t later(int64_t a, int64_t b)
{
    return (a > b) ? a : b;
}

/* The first position from one on at which what is kept up is false. */
static int64_t first_failure(const chaining *g, const chain_reading *w, int64_t position)
{
    int64_t at = position;
    for (;;) {
        int64_t matters;
        at = first_from(&w->levels[g->depth], at, false);
        matters = (at == NEVER_KNOWN) ? at : first_from(&w->excused, at, false);
        if (matters == at) {
            return at;
        }
        at = matters;
    }
}

/* The last position before one at which the windows matter. */
static int64_t last_mattering(const chaining *g, const chain_reading *w, int64_t behind)
{
    const int32_t i = changes_until(&w->excused, behind - 1);
    int64_t end = behind;
    if (value_behind(&w->excused, i)) {
        if (i == 0) {
            return INT64_MIN;
        }
        end = change_at(&w->excused, i - 1);
    }
    if (g->sparse) {
        const int32_t k = changes_until(&g->c->stamps, end - 1);
        return (k > 0) ? change_at(&g->c->stamps, k - 1) : INT64_MIN;
    }
    return end - 1;
}

/* The stamp as of which all is known of what is kept up from one position to before another. */
static int64_t known_between(const chaining *g, const chain_reading *w, int64_t first,
                             int64_t behind)
{
    const int64_t last = last_mattering(g, w, behind);
    int64_t stamp = INT64_MIN;
    if (last >= first) {
        (void)known_of(g, w, last, &stamp);
    }
    return stamp;
}

/* The value of the whole formula, which may keep the chain up until something ends that, and the stamp
 * as of which it is known. */
static bool outcome_of(const chaining *g, const chain_reading *w, int64_t at, int64_t *stamp)
{
    int64_t position = at;
    int64_t ends;
    int64_t fails;
    if (g->f.form->left < 0) {
        return known_of(g, w, at, stamp);
    }
    position = later(position, w->start);
    ends = first_from(&w->ends, position, true);
    fails = first_failure(g, w, position);
    if ((fails < ends) || ((fails == ends) && (fails != NEVER_KNOWN))) {
        (void)known_of(g, w, fails, stamp);
        *stamp = later(*stamp, stamp_of(g, fails, 0, true));
        return false;
    }
    if (ends == NEVER_KNOWN) {
        *stamp = NEVER_KNOWN;
        return false;
    }
    *stamp = later(stamp_of(g, ends, 0, true), known_between(g, w, position, ends + 1));
    return true;
}

static int64_t position_of_attempt(const attempt *x)
{
    return x->clocks[0];
}

/* Judge one attempt by a stamp; false if it was decided. `due` is the stamp at which it will be if the
 * letter stays. */
static bool weigh_in_chain(chaining *g, int32_t at, int64_t limit, int64_t *due)
{
    attempt *x = attempt_at(g->r->home, at);
    const int64_t position = position_of_attempt(x);
    int64_t worse_stamp = NEVER_KNOWN;
    int64_t better_stamp = NEVER_KNOWN;
    int64_t stamp;
    bool worse = false;
    bool better = true;
    /* What is known of a reading may be forgotten since. */
    if (x->location != FAILED) {
        worse = outcome_of(g, &g->c->readings[0], position, &worse_stamp);
    }
    if (!g->c->parted && !x->parted) {
        better = worse;
        better_stamp = worse_stamp;
    } else if (x->better != PASSED) {
        better = outcome_of(g, &g->c->readings[g->c->parted ? 1 : 0], position, &better_stamp);
    } else {
        /* It is known to be true for the better. */
    }
    stamp = least(worse ? worse_stamp : NEVER_KNOWN, better ? NEVER_KNOWN : better_stamp);
    if (stamp <= limit) {
        decide(g->r, g->index, at, worse && (stamp == worse_stamp),
               later(stamp / 2 - ((stamp < 0) && (stamp % 2 != 0)), position * g->f.step));
        return false;
    }
    if (g->c->parted || x->parted) {
        const bool fails = !worse && (worse_stamp <= limit);
        const bool holds = better && (better_stamp <= limit);
        x->location = fails ? FAILED : x->location;
        x->better = holds ? PASSED : x->better;
        x->parted = x->parted || fails || holds;
    }
    *due = stamp;
    return true;
}

/* Judge the attempts by all that is known as of a stamp. */
static void look_through(chaining *g, int64_t limit)
{
    int64_t next_due = NEVER_KNOWN;
    int32_t before = -1;
    int32_t at = g->j->first;
    while (at >= 0) {
        const int32_t next = attempt_at(g->r->home, at)->next;
        int64_t due = NEVER_KNOWN;
        if (g->f.monitor->spoilt) {
            break;
        }
        if (!weigh_in_chain(g, at, limit, &due)) {
            leave(g->r, g->index, before, at);
        } else if (is_moot(attempt_at(g->r->home, at))) {
            lay_aside(g->r, g->index, before, at);
        } else {
            next_due = least(next_due, due);
            before = at;
            if (!g->c->parted && !attempt_at(g->r->home, at)->parted) {
                break; /* what is known is known in order */
            }
        }
        at = next;
    }
    set_rule_due(g->r, g->index, (next_due == NEVER_KNOWN) ? NEVER : next_due / 2);
}

static void read_letter(const chaining *g, uint8_t *letter)
{
    const form_plan *own = g->f.form;
    letter[BASE] = base_bits(g);
    letter[LEFT] = (own->left < 0) ? 0 : leaf_bits(g, &g->f.nodes[own->left]);
    letter[EXCUSED] = (own->excused < 0) ? 0 : leaf_bits(g, &g->f.nodes[own->excused]);
}

/* Begin at a position: no attempt asks for what was before. */
static void begin_chain(const chaining *g, int64_t position, const uint8_t *letter)
{
    chain *c = g->c;
    (void)memcpy(c->letter, letter, FOLLOWED);
    c->begun = true;
    c->parted = !is_known(letter);
    clear_changes(&c->stamps, false);
    begin_reading(g, &c->readings[0], position, 1);
    begin_reading(g, &c->readings[1], position, 2);
    if (g->sparse) {
        add_change(g->f.monitor, &c->stamps, position);
    }
}

/* Come to the position at `t`, at which the truths are. */
void chain_visit(run *r, int32_t index, int64_t t)
{
    chaining g = chaining_of(r, index);
    const int64_t position = (g.f.gap > 0) ? floored(t, g.f.step) : t;
    uint8_t letter[FOLLOWED];
    if (g.c == NULL) {
        g.c = made_chain(&g);
        g.j->chain = g.c;
        if (g.c == NULL) {
            return;
        }
    }
    read_letter(&g, letter);
    if (!g.c->begun || (g.j->first < 0)) {
        begin_chain(&g, position, letter);
    } else if (g.j->position == t) {
        return;
    } else {
        if (g.c->parted) {
            look_through(&g, 2 * t); /* see who stays open for good, before that is forgotten */
        }
        if (g.sparse) {
            add_change(g.f.monitor, &g.c->stamps, position);
        }
        if (memcmp(letter, g.c->letter, sizeof letter) != 0) {
            note_letter(&g, position, letter);
        } else if (g.sparse) {
            forget_before(&g, position);
        } else if (t < r->rules.due[index]) {
            g.j->position = t;
            return; /* another letter like the last one decides nothing sooner */
        } else {
            /* Something is due. */
        }
    }
    g.j->position = t;
    g.j->restless = false;
    if (g.sparse) {
        set_restless(r, index);
    }
    look_through(&g, 2 * t + 1);
}

/* Let time come to `t`; if `is_position`, the letter stays up to there. */
void chain_pass(run *r, int32_t index, int64_t t, bool is_position)
{
    chaining g = chaining_of(r, index);
    if ((g.j->first >= 0) && (g.c != NULL)) {
        look_through(&g, (is_position && !g.sparse) ? 2 * t + 1 : 2 * t);
    }
}

/* Let an attempt begin at the position at `t`, to which its chain has come. */
bool chain_enter(run *r, int32_t index, int32_t at, int64_t t)
{
    chaining g = chaining_of(r, index);
    attempt *x = attempt_at(r->home, at);
    int64_t due = NEVER_KNOWN;
    if ((g.c == NULL) || g.f.monitor->spoilt) {
        return true; /* the run is spoilt */
    }
    x->clocks[0] = (g.f.gap > 0) ? floored(t, g.f.step) : t;
    if (!weigh_in_chain(&g, at, 2 * t + 1, &due)) {
        return false;
    }
    x->due = (due == NEVER_KNOWN) ? NEVER : due / 2;
    return true;
}

/* Whether an attempt was kept up to the end of the trace, so far as that is known. */
bool chain_outlasts(run *r, int32_t index, const attempt *x, int64_t end, int64_t reached)
{
    chaining g = chaining_of(r, index);
    const chain_reading *w;
    int64_t position;
    int64_t last;
    if ((g.c == NULL) || (g.f.form->left < 0) || (x->location == FAILED) || g.f.monitor->spoilt) {
        return false;
    }
    w = &g.c->readings[0];
    position = later(position_of_attempt(x), w->start);
    last = (g.f.gap > 0) ? floored(end, g.f.step) : last_change(&g.c->stamps);
    return (first_failure(&g, w, position) > last)
           && (known_between(&g, w, position, last + 1) <= later(2 * reached, 2 * end + 1));
}
