/* Attempts that a chain of windows judges (windows.h), and rings of changes.
 *
 * A new letter updates the chain; then attempts are judged, the oldest first, until one is still open:
 * with one reading the younger ones are then open, too. So a letter costs the attempts that it decides,
 * and O(depth * log changes) for the first open one, at whose stamp the judge is due next. */
#include "windows/windows.h"

#include <string.h>

bool is_chained(const run *r, int32_t index)
{
    const judge_plan *j = &r->part->judges[index];
    return (j->automaton < 0) && (r->part->forms[j->form].windows.count > 0);
}

chaining chaining_of(run *r, int32_t index)
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

/* A new chain; NULL: memory is short. A judge makes it at its first letter. */
chain *made_chain(const chaining *g)
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

/* A leaf by the truth of its node: 1 if true for the worse, plus 2 if true for the better. */
static uint8_t leaf_bits(const chaining *g, const operator_plan *n)
{
    return (uint8_t)n->values[(n->right < 0) ? 0 : (int32_t)g->r->truth[n->right]];
}

/* The base at this position, in the same form. */
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
            /* A window: not part of the base. */
        }
        g->c->values[i] = bits;
    }
    return g->c->values[base];
}

static int64_t position_of_attempt(const attempt *x)
{
    return x->clocks[0];
}

/* The instant of a stamp; rounds down for negative ones, too. */
static int64_t instant_of_stamp(int64_t stamp)
{
    return (stamp - (stamp & 1)) / 2;
}

/* Judge one attempt by what is known at the stamp `limit`; false: it is decided. `due` becomes the stamp
 * at which it is decided if the letter stays. */
static bool judge_in_chain(chaining *g, int32_t at, int64_t limit, int64_t *due)
{
    attempt *x = attempt_at(g->r->home, at);
    const int64_t position = position_of_attempt(x);
    int64_t worse_stamp = NEVER_KNOWN;
    int64_t better_stamp = NEVER_KNOWN;
    int64_t stamp;
    bool worse = false;
    bool better = true;
    /* A reading that has failed, or passed, is not queried again, as its changes may be dropped. */
    if (x->location != FAILED) {
        worse = outcome_of(g, &g->c->readings[0], position, &worse_stamp);
    }
    if (!g->c->parted && !x->parted) {
        better = worse;
        better_stamp = worse_stamp;
    } else if (x->better != PASSED) {
        better = outcome_of(g, &g->c->readings[g->c->parted ? 1 : 0], position, &better_stamp);
    } else {
        /* The better reading has passed. */
    }
    stamp = least(worse ? worse_stamp : NEVER_KNOWN, better ? NEVER_KNOWN : better_stamp);
    if (stamp <= limit) {
        decide(g->r, g->index, at, worse && (stamp == worse_stamp),
               later(instant_of_stamp(stamp), position * g->f.step));
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

/* Judge the attempts by what is known at a stamp, and set when the judge is due. */
static void judge_chain_attempts(chaining *g, int64_t limit)
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
        if (!judge_in_chain(g, at, limit, &due)) {
            remove_attempt(g->r, g->index, before, at);
        } else if (is_undecidable(attempt_at(g->r->home, at))) {
            move_to_undecidable(g->r, g->index, before, at);
        } else {
            next_due = least(next_due, due);
            before = at;
            if (!g->c->parted && !attempt_at(g->r->home, at)->parted) {
                break; /* values are known in the order of positions: younger attempts are open, too */
            }
        }
        at = next;
    }
    set_rule_due(g->r, g->index, (next_due == NEVER_KNOWN) ? NEVER : instant_of_stamp(next_due));
}

/* The letter at this position. */
static void read_letter(const chaining *g, uint8_t *letter)
{
    const form_plan *own = g->f.form;
    letter[BASE] = base_bits(g);
    letter[LEFT] = (own->left < 0) ? 0 : leaf_bits(g, &g->f.nodes[own->left]);
    letter[EXCUSED] = (own->excused < 0) ? 0 : leaf_bits(g, &g->f.nodes[own->excused]);
}

/* Start at a position: windows only reach ahead, so earlier positions do not matter. */
static void begin_chain(const chaining *g, int64_t position, const uint8_t *letter)
{
    chain *c = g->c;
    (void)memcpy(c->letter, letter, FOLLOWED);
    c->started = true;
    c->parted = !is_known(letter);
    clear_changes(&c->stamps, false);
    begin_reading(g, &c->readings[0], position, 1);
    begin_reading(g, &c->readings[1], position, 2);
    if (g->sparse) {
        add_change(g->f.monitor, &c->stamps, position);
    }
}

/* Visit the position at `t`, whose truths the nodes have. Without open attempts letters are not
 * followed: the chain is reset. */
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
    if (!g.c->started || (g.j->first < 0)) {
        begin_chain(&g, position, letter);
    } else if (g.j->position == t) {
        return;
    } else {
        if (g.c->parted) {
            judge_chain_attempts(&g, 2 * t); /* before the changes of decided readings are dropped */
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
            return; /* the letter stays, as the due instant assumes */
        } else {
            /* An attempt is due. */
        }
    }
    g.j->position = t;
    g.j->restless = false;
    if (g.sparse) {
        set_restless(r, index);
    }
    judge_chain_attempts(&g, 2 * t + 1);
}

/* Let time come to `t`. `is_position`: the letter stays up to `t`, else it is not known at `t`. */
void chain_pass(run *r, int32_t index, int64_t t, bool is_position)
{
    chaining g = chaining_of(r, index);
    if ((g.j->first >= 0) && (g.c != NULL)) {
        judge_chain_attempts(&g, (is_position && !g.sparse) ? 2 * t + 1 : 2 * t);
    }
}

/* Start an attempt at `t`, whose letter was read; false: it is decided. */
bool chain_enter(run *r, int32_t index, int32_t at, int64_t t)
{
    chaining g = chaining_of(r, index);
    attempt *x = attempt_at(r->home, at);
    int64_t due = NEVER_KNOWN;
    if ((g.c == NULL) || g.f.monitor->spoilt) {
        return true; /* memory was short */
    }
    x->clocks[0] = (g.f.gap > 0) ? floored(t, g.f.step) : t;
    if ((g.j->first >= 0) && (g.f.form->left < 0) && !g.c->parted
        && !attempt_at(r->home, g.j->first)->parted) {
        x->due = NEVER; /* an older one is open, and values are known in the order of positions */
        return true;
    }
    if (!judge_in_chain(&g, at, 2 * t + 1, &due)) {
        return false;
    }
    x->due = (due == NEVER_KNOWN) ? NEVER : instant_of_stamp(due);
    return true;
}

/* Whether an open attempt counts as TRUE at the end of the trace: its obligation lasts until something
 * ends it, and it is known not to have failed at any position up to there. */
bool chain_outlasts(run *r, int32_t index, const attempt *x, int64_t end, int64_t reached)
{
    chaining g = chaining_of(r, index);
    chain_reading *w;
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

/* ---- changes: the positions at which a Boolean value toggles, in order, as a ring; `initial` is the
 * value before all of them */

int64_t change_at(const changes *c, int32_t i)
{
    return c->at[(c->head + i) & (c->room - 1)];
}

int64_t last_change(const changes *c)
{
    return change_at(c, c->count - 1);
}

/* Append a change; the ring doubles as needed. If memory is short, the run is spoilt. */
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
    made->initial = c->initial;
    for (i = 0; i < c->count; i++) {
        add_change(m, made, change_at(c, i));
    }
}

bool changes_agree(const changes *a, const changes *b)
{
    int32_t i;
    if ((a->count != b->count) || (a->initial != b->initial)) {
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
    c->initial = value;
}

/* Number of changes tried one by one from the last query on; beyond that, bisection is faster. */
#define NEAR 4

/* The number of changes up to a position. Most queries are for the end of the list, or a little after
 * the last query (`cursor`); the others bisect, without a branch that would be mispredicted. */
int32_t changes_until(changes *c, int64_t position)
{
    int32_t low = (c->cursor < c->count) ? c->cursor : 0;
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
            if (change_at(c, low) > position) { /* at the last one if not before */
                c->cursor = low;
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
    c->cursor = low;
    return low;
}

/* The value after the first `count` changes. */
bool value_after(const changes *c, int32_t count)
{
    return c->initial != ((count & 1) == 1);
}

/* Drop the changes before a position; the value before the rest follows from their number. */
void drop_changes(changes *c, int64_t position)
{
    while ((c->count > 0) && (change_at(c, 0) < position)) {
        c->head = (c->head + 1) & (c->room - 1);
        c->count--;
        c->cursor -= (c->cursor > 0) ? 1 : 0;
        c->initial = !c->initial;
    }
}
