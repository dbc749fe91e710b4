/* A search from its start to its answer. */
#ifndef RVMON_ZONES_WHOLE_H
#define RVMON_ZONES_WHOLE_H

#include "nested.h"
#include "linear.h"

/* Assign bits of packed states to locations and variables. */
static bool lay_out(engine *h)
{
    const int n = h->automaton_count + h->variable_count;
    uint32_t used = 0;
    uint32_t word = 0;
    int i;
    h->fields = block(h, (size_t)n, sizeof *h->fields);
    if (h->fields == NULL) {
        return false;
    }
    for (i = 0; i < n; i++) {
        const int32_t *v = h->variables + (ptrdiff_t)4 * (i - h->automaton_count);
        const bool place = i < h->automaton_count;
        const int64_t range = place ? h->automata[3 * i + 1] - 1 : (int64_t)v[1] - v[0];
        uint32_t bits = 0;
        while ((bits < 32) && ((range >> bits) != 0)) {
            bits++;
        }
        if (used + bits > 32) {
            word++;
            used = 0;
        }
        h->fields[i].word = word;
        h->fields[i].shift = (uint8_t)(used & 31);
        h->fields[i].mask = (bits == 32) ? UINT32_MAX : ((uint32_t)1 << bits) - 1;
        h->fields[i].low = place ? 0 : v[0];
        used += bits;
    }
    h->words = word + 2; /* the last word is the mark */
    return true;
}

static void make_walk(engine *h, walk *w)
{
    const size_t places = (size_t)h->automaton_count;
    const size_t values = (size_t)plan_count(h->plan, AT_VARIABLES);
    w->here.places = block(h, places, sizeof *w->here.places);
    w->here.values = block(h, values, sizeof *w->here.values);
    w->there.places = block(h, places, sizeof *w->there.places);
    w->there.values = block(h, values, sizeof *w->there.values);
    w->source = block(h, (size_t)h->entries, sizeof *w->source);
    w->zone = block(h, (size_t)h->entries, sizeof *w->zone);
    w->resets = block(h, 2 * (size_t)h->dim, sizeof *w->resets);
    w->chosen = block(h, places, sizeof *w->chosen);
    w->group = block(h, (size_t)h->edge_count, sizeof *w->group);
    w->first = block(h, places, sizeof *w->first);
    w->pick = block(h, places, sizeof *w->pick);
    w->committed = block(h, places, sizeof *w->committed);
    w->limits = block(h, (size_t)h->dim, sizeof *w->limits);
    w->together = block(h, places, sizeof *w->together);
    w->watching = block(h, (size_t)h->edge_count, sizeof *w->watching);
}

/* Start with empty ranges for all locations of the watcher. */
static void make_spans(engine *h)
{
    const int32_t places = h->automata[3 * (h->automaton_count - 1) + 1];
    int32_t i;
    h->spans = block(h, 2 * (size_t)places, sizeof *h->spans);
    for (i = 0; (h->spans != NULL) && (i < 2 * places); i++) {
        h->spans[i] = INT64_MIN;
    }
}

/* Allocate what every search needs; false without memory. */
static bool make_engine(engine *h, const int32_t *plan, const double *costs, const caller *from)
{
    size_t d;
    (void)memset(h, 0, sizeof *h);
    h->from = from;
    h->plan = plan;
    h->costs = costs;
    h->kind = plan[HEAD_KIND];
    h->policy = plan[HEAD_POLICY];
    h->variables = plan_rows(plan, AT_VARIABLES);
    h->automata = plan_rows(plan, AT_AUTOMATA);
    h->locations = plan_rows(plan, AT_LOCATIONS);
    h->edges = plan_rows(plan, AT_EDGES);
    h->atoms = plan_rows(plan, AT_ATOMS);
    h->code = plan_rows(plan, AT_CODE);
    h->variable_count = plan_count(plan, AT_VARIABLES) - plan[HEAD_LOCALS];
    h->automaton_count = plan_count(plan, AT_AUTOMATA);
    h->edge_count = plan_count(plan, AT_EDGES);
    h->goal_count = plan_count(plan, AT_GOAL);
    h->inside_count = plan_count(plan, AT_INSIDE);
    h->dim = 1 + plan[HEAD_CLOCKS] + plan[HEAD_TIMER];
    h->timer = plan[HEAD_TIMER] ? h->dim - 1 : 0;
    h->entries = h->dim * h->dim;
    h->zone_bytes = (size_t)h->entries * sizeof(bound);
    h->safe = FAR / 8 / ((bound)(h->dim + 1) * (h->dim + 1));
    h->most_time = (h->safe / 4 > INT32_MAX - 1) ? INT32_MAX - 1 : h->safe / 4;
    h->freed = NONE;
    h->found = NONE;
    h->wanted = NONE;
    h->from_node = NONE;
    h->loop = -1;
    d = (size_t)h->dim;
    if (!lay_out(h)) {
        return false;
    }
    make_walk(h, &h->out);
    make_walk(h, &h->look);
    h->packed = block(h, h->words, sizeof *h->packed);
    h->lower = block(h, d, sizeof *h->lower);
    h->upper = block(h, d, sizeof *h->upper);
    h->lowers = block(h, d, sizeof *h->lowers);
    h->uppers = block(h, d, sizeof *h->uppers);
    h->test_entries = block(h, d * d, sizeof *h->test_entries);
    h->test_least = block(h, d * d, sizeof *h->test_least);
    h->tightest = block(h, d, sizeof *h->tightest);
    h->tightest_bound = block(h, d, sizeof *h->tightest_bound);
    h->top = block(h, d, sizeof *h->top);
    h->spare = block(h, d * d, sizeof *h->spare);
    h->inside = block(h, d * d, sizeof *h->inside);
    h->copy = block(h, d * d, sizeof *h->copy);
    h->between = block(h, d * d * (size_t)h->inside_count + d * d, sizeof *h->between);
    h->marked = block(h, (size_t)h->inside_count, sizeof *h->marked);
    h->allowed = block(h, (size_t)h->inside_count, 1);
    h->rest_allowed = block(h, (size_t)h->inside_count, 1);
    h->rest_good = block(h, (size_t)h->inside_count, 1);
    h->rest_on = block(h, (size_t)h->inside_count, 1);
    h->rest_back = block(h, (size_t)h->inside_count, 1);
    h->step_edges = block(h, (size_t)h->automaton_count, sizeof *h->step_edges);
    h->failed_edges = block(h, (size_t)h->automaton_count, sizeof *h->failed_edges);
    h->tables = block(h, (size_t)plan_count(plan, AT_TREE) + 2, sizeof *h->tables);
    h->table_rooms = block(h, (size_t)plan_count(plan, AT_TREE) + 2, sizeof *h->table_rooms);
    if (plan[HEAD_WATCHED] && (plan[HEAD_CLOCKS] > 0) && (h->kind == SEEK_GOAL)) {
        make_spans(h);
    }
    return runs(h);
}

/* The initial state: initial locations and values, all clocks 0. */
static void begin(engine *h)
{
    walk *w = &h->out;
    int i;
    for (i = 0; i < h->automaton_count; i++) {
        w->there.places[i] = h->automata[3 * i + 2];
    }
    for (i = 0; i < h->variable_count; i++) {
        w->there.values[i] = h->variables[4 * i + 2];
    }
    for (i = 0; i < h->entries; i++) {
        w->zone[i] = AT_ONCE;
    }
    copy_spot(h, &w->here, &w->there);
    if (!h->from->continues(h->from->context, 0, 0)) {
        h->state = SEARCH_STOPPED;
    }
}

/* Whether all numbers that clocks are compared with fit these bounds. */
static bool limits_fit(const engine *h)
{
    const int sections[2] = {AT_LIMITS, AT_EXTRA};
    int s;
    for (s = 0; s < 2; s++) {
        const int32_t *row = plan_rows(h->plan, sections[s]);
        int32_t i;
        for (i = 0; i < plan_count(h->plan, sections[s]); i++, row += LIMIT_SIZE) {
            if (row[LIMIT_NUMBER] > h->most_time) {
                return false;
            }
        }
    }
    for (s = 0; s < plan_count(h->plan, AT_TREE); s++) {
        if (tree_row(h, s)[TREE_BOUND] > h->most_time) {
            return false;
        }
    }
    return h->plan[HEAD_BOUND] <= h->most_time;
}

static void run(engine *h)
{
    const bool late = (h->kind == SEEK_LATE) || (h->kind == SEEK_LATE_AFTER);
    walk *w = &h->out;
    begin(h);
    if (runs(h) && !limits_fit(h)) {
        h->state = SEARCH_TOO_LARGE;
    }
    if (!runs(h) || !invariant_data_holds(h, &w->there)) {
        return;
    }
    if ((h->kind == SEEK_NESTED) || (h->kind == SEEK_START)) {
        find_moves(h);
        solve(h);
        if (!runs(h) || h->failed) {
            return;
        }
        begin(h);
    }
    if (h->kind == SEEK_START) {
        if (meets_nested(h, w->zone, &w->there)) {
            h->state = SEARCH_FOUND;
        }
        return;
    }
    if (h->kind == SEEK_RUN) {
        look_for_run(h);
        return;
    }
    if (h->kind == SEEK_STAY) {
        stay_from(h, NONE, 0);
        return;
    }
    h->phase = (h->kind == SEEK_LATE);
    arrive(h, w->zone, &w->there, NULL, 0);
    h->phase = 0;
    while (runs(h) && !h->failed) {
        if (h->kind == SEEK_STAY_AFTER) {
            stay_after(h);
            if (!runs(h) || h->failed) {
                break;
            }
        }
        if (h->heap_count > 0) {
            step_best(h);
        } else if (h->queue_head < h->queue_end) {
            const uint32_t n = h->queue[h->queue_head++];
            if (h->nodes[n].zone == NONE) {
                continue;
            }
            if (late) {
                expand_late(h, n);
            } else {
                expand(h, n);
            }
        } else {
            break;
        }
    }
}

/* Append the path to the result, or to the failure including the move that failed. */
static void append_end(engine *h)
{
    /* Once memory has run out, a failure may be a consequence of that. */
    const bool fails = h->failed && (runs(h) || (h->state == SEARCH_FOUND));
    const search_state ended = fails ? SEARCH_FAILED : h->state;
    const int32_t failed = h->step_edge_count;
    const bool on_the_way = (h->kind == SEEK_STAY) || (h->kind == SEEK_STAY_AFTER)
                            || (h->kind == SEEK_RUN);
    h->step_bounds.count = 0;
    if (fails) {
        (void)memcpy(h->failed_edges, h->step_edges, (size_t)failed * sizeof *h->step_edges);
    }
    if (runs(h) && !h->failed) {
        h->state = SEARCH_ENDED;
        return;
    }
    if ((ended != SEARCH_FOUND) && (ended != SEARCH_FAILED)) {
        return;
    }
    h->state = SEARCH_RUNS;
    h->failed = false;
    if (ended == SEARCH_FOUND) {
        if (!on_the_way) {
            (void)append_path(h, h->found);
        }
    } else {
        if (on_the_way && (h->frame_count > 0)) {
            append_frames(h, NONE);
        } else {
            (void)append_path(h, h->from_node);
        }
        (void)memcpy(h->step_edges, h->failed_edges, (size_t)failed * sizeof *h->step_edges);
        h->step_edge_count = failed;
        if (failed > 0) {
            append_step(h, STEP_MOVE, -1, 0, failed);
        }
    }
    if (runs(h)) {
        h->state = h->failed ? SEARCH_FAILED : ended;
    }
}

static answer search_here(const int32_t *plan, const double *costs, const caller *from)
{
    answer found;
    engine made;
    engine *h = &made;
    uint32_t k;
    int e;
    (void)memset(&found, 0, sizeof found);
    if (make_engine(h, plan, costs, from)) {
        run(h);
        append_end(h);
    }
    if ((h->state == SEARCH_FOUND) && (h->parts.count > 0)) {
        uint32_t room = 0;
        found.parts = enlarge(h, NULL, &room, (uint64_t)h->parts.count * (uint64_t)h->entries,
                             sizeof *found.parts);
        for (k = 0; (found.parts != NULL) && (k < h->parts.count); k++) {
            for (e = 0; e < h->entries; e++) {
                found.parts[(size_t)k * (size_t)h->entries + (size_t)e] =
                    number_of_bound(nth(h, &h->parts, k)[e]);
            }
            found.part_count = k + 1;
        }
    }
    found.state = h->state;
    found.ending = h->ending;
    found.loop = h->loop;
    found.improper = h->improper;
    found.visited = h->visited;
    found.stored = h->stored;
    found.states = h->state_count;
    found.peak = h->peak;
    found.path = h->path;
    found.dim = (uint32_t)h->dim;
    found.spans = h->spans;
    found.span_count = (h->spans != NULL) ? (uint32_t)h->automata[3 * h->automaton_count - 2] : 0;
    found.memory = h->memory;
    return found;
}

#endif
