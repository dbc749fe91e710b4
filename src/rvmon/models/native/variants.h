/* The effect of a move, and its blockers: receivers that it leaves out, and moves of higher priority. At
 * least one bound of each blocker must fail, so a move has one variant per choice of these bounds. */
#ifndef RVMON_ZONES_VARIANTS_H
#define RVMON_ZONES_VARIANTS_H

#include "states.h"

typedef bool (*sink)(engine *h, walk *w, const int32_t *edges, int n);

static bool is_watcher(const engine *h, int automaton)
{
    return (h->plan[HEAD_WATCHED] != 0) && (automaton == h->automaton_count - 1);
}

/* Apply the updates of a move to its source, which gives its target and resets. */
static bool apply(engine *h, walk *w, const int32_t *edges, int n)
{
    const spot changing = {w->here.places, w->there.values};
    int k;
    copy_spot(h, &w->there, &w->here);
    w->reset_count = 0;
    for (k = 0; k < n; k++) {
        const int32_t *edge = edge_at(h, edges[k]);
        if (edge[EDGE_UPDATE] >= 0) {
            h->sets = w;
            (void)evaluate(h, edge[EDGE_UPDATE], &changing);
            h->sets = NULL;
            if (h->failed || !runs(h)) {
                return false;
            }
        }
        w->there.places[edge[EDGE_AUTOMATON]] = edge[EDGE_TARGET];
    }
    return true;
}

/* --- blockers ------------------------------------------------------------------------------------ */

static bool begin_denial(engine *h, denials *to, int32_t rank)
{
    if (!ROOM(h, to->rows, to->room, (uint64_t)to->count + 1)) {
        return false;
    }
    to->rows[to->count++] = (denial){to->atom_count, 0, rank};
    return true;
}

static bool deny(engine *h, denials *to, cut one)
{
    if (!ROOM(h, to->atoms, to->atom_room, (uint64_t)to->atom_count + 1)) {
        return false;
    }
    to->atoms[to->atom_count++] = one;
    to->rows[to->count - 1].count++;
    return true;
}

static bool deny_guard(engine *h, walk *w, denials *to, const int32_t *edge)
{
    int32_t k;
    for (k = 0; k < edge[EDGE_ATOMS]; k++) {
        cut one;
        if (!atom_at(h, edge[EDGE_ATOM] + k, &w->here, &one) || !deny(h, to, one)) {
            return false;
        }
    }
    return true;
}

static void drop_denial(denials *from)
{
    from->atom_count = from->rows[--from->count].first;
}

static void drop_denials(denials *from)
{
    from->count = 0;
    from->atom_count = 0;
}

/* A blocker of the current move by its index; receivers left out come first. */
static const denial *denied_by(const walk *w, uint32_t k, const cut **atoms)
{
    const uint32_t skipped = w->skipped.count;
    const denials *from = (k < skipped) ? &w->skipped : &w->blockers;
    const denial *row = from->rows + ((k < skipped) ? k : w->against[k - skipped]);
    *atoms = from->atoms + row->first;
    return row;
}

/* The negated bound of a blocker that fails in the current variant. */
static cut failing(const walk *w, uint32_t k)
{
    const cut *atoms;
    (void)denied_by(w, k, &atoms);
    return opposite(atoms[w->skip[k]]);
}

/* Intersect a zone with the guards of a move, and with the negated bound of each blocker. */
static bool cut_guards(engine *h, const walk *w, bound *z, const int32_t *edges, int n)
{
    uint32_t k;
    int i;
    for (i = 0; i < n; i++) {
        const int32_t *edge = edge_at(h, edges[i]);
        if (!cut_atoms(h, z, edge[EDGE_ATOM], edge[EDGE_ATOMS], &w->here)) {
            return false;
        }
    }
    for (k = 0; k < w->against_count; k++) {
        if (!cut_by(h, z, failing(w, k))) {
            return false;
        }
    }
    return true;
}

/* --- priorities ---------------------------------------------------------------------------------- */

/* The priority of a move: its channel decides, then the highest of its automata. */
static int32_t rank_of(engine *h, const walk *w, const int32_t *edges, int n)
{
    const int32_t *ranks = plan_rows(h->plan, AT_RANKS);
    const int32_t *first = edge_at(h, edges[0]);
    int64_t channel = -1;
    int32_t own = 0;
    int k;
    if (first[EDGE_CHANNEL] != -1) {
        channel = first[EDGE_FIRST];
        if (first[EDGE_STOP] - first[EDGE_FIRST] > 1) {
            channel = evaluate(h, first[EDGE_CHANNEL], &w->here);
        }
        if ((channel < first[EDGE_FIRST]) || (channel >= first[EDGE_STOP])) {
            h->failed = true;
            return 0;
        }
    }
    for (k = 0; k < n; k++) {
        const int32_t one = ranks[edge_at(h, edges[k])[EDGE_AUTOMATON]];
        own = (one > own) ? one : own;
    }
    return ranks[h->automaton_count + 1 + channel] + own;
}

/* The weakest precondition of a move for the invariant of its target, as upper bounds in `tightest`;
 * returns their number, or -1 if it cannot hold or failed. */
static int invariant_after(engine *h, const walk *w)
{
    const int bounds = invariant_of(h, &w->there);
    int n = 0;
    int i;
    for (i = 0; i < bounds; i++) {
        const int j = reset_of(w, h->tightest[i]);
        if (j == w->reset_count) {
            h->tightest[n] = h->tightest[i];
            h->tightest_bound[n++] = h->tightest_bound[i];
        } else if (2 * (bound)w->resets[2 * j + 1] + 1 > h->tightest_bound[i]) {
            return -1;
        }
    }
    return (bounds < 0) ? -1 : n;
}

/* Add those bounds of the target's invariant that the source does not imply; false if the invariant cannot
 * hold, or failed. */
static bool deny_invariant(engine *h, walk *w)
{
    const int bounds = invariant_after(h, w);
    int c;
    int i;
    for (c = 1; c < h->dim; c++) {
        for (i = 0; (i < bounds) && (h->tightest[i] != c); i++) {
        }
        if ((i < bounds) && (h->tightest_bound[i] < w->limits[c])
            && !deny(h, &w->blockers, (cut){0, c, h->tightest_bound[i]})) {
            return false;
        }
    }
    return bounds >= 0;
}

/* Add the condition of a move to the blockers of moves of lower priority. */
static bool note_blocker(engine *h, walk *w, const int32_t *edges, int n)
{
    uint32_t k;
    int i;
    count_work(h);
    if (!begin_denial(h, &w->blockers, rank_of(h, w, edges, n))) {
        return false;
    }
    for (i = 0; i < n; i++) {
        if (!deny_guard(h, w, &w->blockers, edge_at(h, edges[i]))) {
            return false;
        }
    }
    for (k = 0; k < w->against_count; k++) {
        if (!deny(h, &w->blockers, failing(w, k))) {
            return false;
        }
    }
    if (!apply(h, w, edges, n)) {
        const bool update_failed = h->failed; /* reported where the move itself is taken */
        h->failed = false;
        return update_failed;
    }
    if (!invariant_data_holds(h, &w->there) || !deny_invariant(h, w)) {
        drop_denial(&w->blockers);
    }
    return runs(h) && !h->failed;
}

static bool is_same(const walk *w, const denial *one, const denial *other)
{
    return (one->count == other->count)
           && (memcmp(w->blockers.atoms + one->first, w->blockers.atoms + other->first,
                      one->count * sizeof(cut))
               == 0);
}

/* Collect the distinct blockers of higher priority of a move; false if one of them always blocks it. */
static bool find_blockers(engine *h, walk *w, const int32_t *edges, int n)
{
    const bool waits = (w->blocker_count > 0) && !is_watcher(h, edge_at(h, edges[0])[EDGE_AUTOMATON]);
    const int32_t rank = waits ? rank_of(h, w, edges, n) : 0;
    uint32_t had = 0;
    uint32_t k;
    uint32_t j;
    for (k = 0; waits && (k < w->blocker_count); k++) {
        const denial *one = w->blockers.rows + k;
        if (one->rank <= rank) {
            continue;
        }
        if (one->count == 0) {
            return false;
        }
        for (j = 0; (j < had) && !is_same(w, one, w->blockers.rows + w->against[j]); j++) {
        }
        if (j == had) {
            if (!ROOM(h, w->against, w->against_room, (uint64_t)had + 1)) {
                return false;
            }
            w->against[had++] = k;
        }
    }
    w->against_count = w->skipped.count + had;
    return ROOM(h, w->skip, w->skip_room, (uint64_t)w->against_count + 1);
}

/* --- the watcher --------------------------------------------------------------------------------- */

/* Join a move with each edge of the watcher that allows it. Moves of the watcher itself stay alone. */
static bool each_watched(engine *h, walk *w, const int32_t *edges, int n, sink take)
{
    const search_state before = h->state;
    const int32_t *place;
    int32_t count = 0;
    int32_t k;
    if ((h->plan[HEAD_WATCHED] == 0) || (take == note_blocker)
        || is_watcher(h, edge_at(h, edges[0])[EDGE_AUTOMATON])) {
        return take(h, w, edges, n);
    }
    if (!apply(h, w, edges, n)) { /* reported where the move itself is taken */
        h->failed = false;
        h->state = before;
        return take(h, w, edges, n);
    }
    place = place_of(h, &w->here, h->automaton_count - 1);
    for (k = place[LOC_EDGE]; k < place[LOC_EDGE] + place[LOC_EDGES]; k++) {
        const int32_t *edge = edge_at(h, k);
        if (((edge[EDGE_FLAGS] & FLAG_WATCHES) != 0)
            && holds(h, edge[EDGE_GUARD], &w->there)) {
            w->watching[count++] = k;
        }
    }
    (void)memcpy(w->together, edges, (size_t)n * sizeof *edges);
    for (k = 0; (k < count) && !h->failed; k++) {
        w->together[n] = w->watching[k];
        if (!take(h, w, w->together, n + 1)) {
            return false;
        }
    }
    return !h->failed;
}

/* Call `take` with all variants of a move. */
static bool each_variant(engine *h, walk *w, const int32_t *edges, int n, sink take)
{
    int64_t i = 0;
    if (!find_blockers(h, w, edges, n)) {
        return runs(h) && !h->failed;
    }
    (void)memset(w->skip, 0, (size_t)w->against_count * sizeof *w->skip);
    while (i >= 0) {
        if (h->failed || !each_watched(h, w, edges, n, take)) {
            return false;
        }
        for (i = (int64_t)w->against_count - 1; i >= 0; i--) {
            const cut *atoms;
            if (++w->skip[i] < denied_by(w, (uint32_t)i, &atoms)->count) {
                break;
            }
            w->skip[i] = 0;
        }
    }
    return true;
}

#endif
