/* Reconstructs the path of a search. Nodes keep only the number of a step, which is enumerated again. */
#ifndef RVMON_ZONES_PATHS_H
#define RVMON_ZONES_PATHS_H

#include "search.h"

/* Visit a symbolic state inside, and all that crossings lead to, as long as the visitor returns true. A
 * run is in a convex piece for one stretch of time, so crossings never return to a piece. `crossings` has
 * the current ones, as pairs of a piece and a number. */
typedef bool (*visitor)(engine *h, const bound *z, int k, bool delays);

static bool each_stand(engine *h, const bound *z, int k, bool delays, int level, visitor seen)
{
    walk *w = &h->out;
    bool on = seen(h, z, k, delays);
    int m;
    if (!on || !delays || (piece_at(h, k)[ROW_ATOMS] == 0)) {
        return on;
    }
    h->marked[k] = 1;
    for (m = 0; on && (m < 2 * h->inside_count); m++) {
        bound *to = h->between + (size_t)level * (size_t)h->entries;
        count_work(h);
        if (!runs(h)) {
            break;
        }
        if (h->marked[m / 2] || !has_piece(h, m / 2, &w->here)
            || !cross(h, to, z, k, m / 2, m % 2 == 1, &w->here)) {
            continue;
        }
        if (!put(h, &h->crossings, m / 2) || !put(h, &h->crossings, m % 2)) {
            on = false;
        } else {
            on = each_stand(h, to, m / 2, delays, level + 1, seen);
            if (on) { /* else the result lies beyond them */
                h->crossings.count -= 2;
            }
        }
    }
    h->marked[k] = 0;
    return on && runs(h) && !h->failed;
}

static bool match_here(engine *h, const bound *z, int k, bool delays)
{
    (void)z;
    (void)k;
    (void)delays;
    return each_move(h, &h->out, match);
}

static void append_step(engine *h, int32_t kind, int32_t piece, int32_t number, int32_t edges)
{
    int32_t i;
    (void)(put(h, &h->path, kind) && put(h, &h->path, piece) && put(h, &h->path, number)
           && put(h, &h->path, edges));
    for (i = 0; i < edges; i++) {
        (void)put(h, &h->path, h->step_edges[i]);
    }
    for (i = 0; (kind == STEP_MOVE) && (i < 4 * number); i++) {
        (void)put(h, &h->path, h->step_bounds.at[i]);
    }
}

static int append_crossings(engine *h, const numbers *crossings)
{
    uint32_t i;
    for (i = 0; i + 1 < crossings->count; i += 2) {
        append_step(h, STEP_CROSSING, crossings->at[i], crossings->at[i + 1], 0);
    }
    return (int)(crossings->count / 2);
}

/* Append the steps from one node to another by a link; returns their number. The state of the search must
 * be running for that. */
static int append_link(engine *h, uint32_t from, uint32_t to, uint32_t link)
{
    walk *w = &h->out;
    const int before = piece_of(h, from);
    const int piece = piece_of(h, to);
    const int32_t number = (int32_t)(link & ~LINK_KIND);
    int steps = 1;
    if ((link & LINK_KIND) != 0) {
        append_step(h, ((link & LINK_KIND) == LINK_MARK) ? STEP_MARK : STEP_CROSSING, piece, number, 0);
        return steps;
    }
    unpack(h, h->nodes[from].state, &w->here);
    w->ordinal = 0;
    h->wanted = link;
    h->step_edge_count = 0;
    h->step_bounds.count = 0;
    h->crossings.count = 0;
    if ((before >= 0) && ((h->kind == SEEK_STAY) || (h->kind == SEEK_STAY_AFTER))) {
        (void)each_stand(h, zone_of(h, from), before, h->delays[h->nodes[from].state] != 0, 0,
                         match_here);
        steps += append_crossings(h, &h->crossings);
    } else {
        (void)each_move(h, w, match);
    }
    append_step(h, STEP_MOVE, piece, (int32_t)(h->step_bounds.count / 4), h->step_edge_count);
    return steps;
}

/* Append the steps from the start to a node along its parents; returns their number. */
static int append_path(engine *h, uint32_t n)
{
    numbers way = {NULL, 0, 0};
    int steps = 0;
    uint32_t k;
    for (k = n; (k != NONE) && put(h, &way, (int32_t)k); k = h->nodes[k].parent) {
    }
    h->path.count = 0;
    (void)put(h, &h->path, (way.count > 0) ? piece_of(h, (uint32_t)way.at[way.count - 1]) : -1);
    for (k = way.count; (k > 1) && runs(h); k--) {
        const uint32_t to = (uint32_t)way.at[k - 2];
        steps += append_link(h, (uint32_t)way.at[k - 1], to, h->nodes[to].link);
    }
    give_back(h, way.at, way.room, sizeof *way.at);
    return steps;
}

#endif
