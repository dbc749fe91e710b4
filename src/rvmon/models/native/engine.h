/* The state of a search and its memory. Compiled twice, for bounds of 32 bits and of 64. */
#ifndef RVMON_ZONES_ENGINE_H
#define RVMON_ZONES_ENGINE_H

#include "zones.h"

#include <stdlib.h>
#include <string.h>

/* A bound: 2c + 1 for `<= c`, 2c for `< c`, so that sums need no separate case for strictness. Entries of
 * stored zones stay below `safe`, so that no path through entries of zones and guards that visits each
 * clock once comes near UNBOUNDED. */
#ifdef WIDE
typedef int64_t bound;
#define UNBOUNDED (((bound)1 << 60) | 1)
#define FAR ((bound)1 << 59)
#else
typedef int32_t bound;
#define UNBOUNDED (((bound)1 << 30) | 1)
#define FAR ((bound)1 << 29)
#endif
#define AT_ONCE 1 /* <= 0 */
#define NO_LIMIT (-1)
#define NONE UINT32_MAX
#define ZONES_IN_CHUNK 256

/* A symbolic state: its parent, its discrete state, the next node with that state, its zone, and the step
 * that led here: the number of a move, a crossing or a mark, with the kind in the upper bits. */
typedef struct {
    uint32_t parent, state, next, zone, link;
} node;

#define LINK_KIND 0xc0000000U
#define LINK_CROSSING 0x40000000U
#define LINK_MARK 0x80000000U

/* An entry of the heap: a node (`goal`: at the goal), its cost, and its age to break ties. */
typedef struct {
    double cost;
    uint32_t order, node, goal;
} entry;

/* A union of zones. */
typedef struct {
    uint32_t count, room;
    bound *zones;
} federation;

/* The bits of a location or variable in a packed state, and its least value. */
typedef struct {
    uint8_t shift;
    uint32_t word, mask;
    int32_t low;
} field;

/* A move between discrete states: the next move into the same target, and its resets in a pool. Its guard
 * is in a federation, at the same index. The moves out of a state are adjacent. */
typedef struct {
    uint32_t from, to, next, resets;
} arrow;

/* A frame of the depth-first search: a node, the link by which it was entered, its next successor and the
 * end of its successors. */
typedef struct {
    uint32_t node, link, next, end;
} frame;

typedef struct {
    uint32_t node, link, flags;
} successor;

/* An open component: the rank of its first node, the flags found in it, and those of the edge into it. */
typedef struct {
    uint32_t number, flags, in;
} root;

/* A step of a breadth-first search inside a component. */
typedef struct {
    uint32_t node, parent, link, flags;
} step;

/* A constraint: clock y - clock x is at most b. */
typedef struct {
    int32_t x, y;
    bound b;
} cut;

/* A conjunction of bounds that must not hold: at least one of them has to fail. */
typedef struct {
    uint32_t first, count;
    int32_t rank;
} denial;

typedef struct {
    denial *rows;
    cut *atoms;
    uint32_t count, room, atom_count, atom_room;
} denials;

/* A discrete state: the location of each automaton, counted from its first, and the variables. */
typedef struct {
    int32_t *places, *values;
} spot;

/* The source of moves, and the target of the current one. */
typedef struct walk {
    spot here, there;
    bound *source, *zone;
    int32_t *resets; /* clock, value */
    int32_t reset_count;
    int32_t *chosen, *group, *first, *pick; /* a broadcast: its edges; receivers in groups, where these
                                             * start, and the choice in each */
    int32_t *together, *watching; /* a move with an edge of the watcher; the edges that can join it */
    denials skipped, blockers; /* guards of receivers left out; conditions of moves, with priorities */
    /* the blockers of the current move, and the bound of each that fails */
    uint32_t blocker_count, *against, against_room, against_count, *skip, skip_room;
    bound *limits; /* the bounds of the invariant */
    uint8_t *committed;
    bool delays;
    uint32_t ordinal;
} walk;

/* A hash table of indices; NONE is an empty slot. */
typedef struct {
    uint32_t *at, size;
} table;

/* The header of each memory block of a search: a list, so that all are freed at the end. */
typedef struct held {
    struct held *next, **back;
} held;

typedef struct {
    const caller *from;
    held *memory;
    const int32_t *plan, *variables, *automata, *locations, *edges, *atoms, *code;
    const double *costs;
    int32_t kind, policy, automaton_count, variable_count, edge_count, inside_count, goal_count;
    int32_t dim, entries, timer;
    size_t zone_bytes;
    bound safe, most_time;
    uint32_t words;
    search_state state;
    bool failed;
    struct walk *sets; /* the move whose updates run, if clocks may be set */
    int32_t rounds;    /* of loops of programs */
    uint64_t bytes, peak, work, visited, stored;
    field *fields;
    /* discrete states */
    table met;
    uint32_t *bits, *heads, state_count, heads_room, delays_room, bits_room;
    uint8_t *delays;
    uint32_t *packed;
    /* symbolic states */
    node *nodes;
    uint32_t node_count, node_room;
    bound **chunks;
    uint32_t chunk_count, chunk_room, zone_count, freed;
    uint32_t *queue, queue_head, queue_end, queue_room;
    entry *heap;
    uint32_t heap_count, heap_room, order;
    double price;
    /* limits in the current locations */
    bound *lower, *upper;
    int32_t *lowers, *uppers, lower_count, upper_count;
    int32_t *test_entries, *tightest;
    bound *test_least, *tightest_bound, *top, *spare, *inside, *copy;
    walk out, look; /* `look` looks for deadlocks while `out` enumerates moves */
    federation alive, dead, rest;
    uint32_t from_node, link, found;
    int32_t *step_edges, step_edge_count, *failed_edges; /* of a move that failed, or is reconstructed */
    numbers step_bounds;                                 /* the bounds by which nothing blocks that move */
    uint32_t wanted;
    numbers crossings, last_crossings; /* the current ones; those of the end that was found */
    numbers path;
    int64_t *spans; /* by location of the watcher: least and greatest value of the last clock */
    federation parts;
    int32_t ending, loop;
    uint32_t *triggers, trigger_count, trigger_room;
    /* staying inside */
    int32_t phase; /* 0: on the way to the goal; 1: inside */
    uint8_t *colours, *marked;
    bound *between;
    table exact;
    uint32_t colour_room, exact_count;
    successor *successors;
    uint32_t successor_count, successor_room;
    frame *frames;
    uint32_t frame_count, frame_room;
    bool improper;
    uint32_t stem;
    /* runs that an automaton accepts */
    uint32_t *rank, rank_room, last_rank, *open, open_count, open_room;
    root *roots;
    uint32_t root_count, root_room;
    step *trail;
    uint32_t trail_count, trail_room;
    bool clocked, rest_known;
    uint8_t *allowed, *rest_allowed, *rest_good, *rest_on, *rest_back;
    /* nested formulas */
    arrow *arrows;
    uint32_t arrow_count, arrow_room, *into, into_room, *out_of, out_of_room;
    int32_t *pool;
    uint32_t pool_count, pool_room;
    federation guards;
    federation **tables; /* by row and state; two further ones are auxiliary */
    uint32_t *table_rooms;
    federation pending;
    uint32_t *whose, whose_count, whose_room;
} engine;

/* --- memory ------------------------------------------------------------------------------------ */

/* Room for at least `wanted` rows; new arrays are zeros. Without memory the old rows stay, and the search
 * ends. */
static void *enlarge(engine *h, void *old, uint32_t *room, uint64_t wanted, size_t each)
{
    uint64_t more = (uint64_t)*room + *room / 2 + 16;
    held *made = NULL;
    if (wanted <= *room) {
        return old;
    }
    more = (more < wanted) ? wanted : more;
    if ((more < NONE) && (more <= SIZE_MAX / 4 / each)
        && ((more - *room) * each <= h->from->most_bytes - h->bytes)) {
        const size_t size = sizeof *made + (size_t)more * each;
        made = (old == NULL) ? calloc(1, size) : realloc((held *)old - 1, size);
    }
    if (made == NULL) {
        h->state = SEARCH_NO_MEMORY;
        return old;
    }
    if (old == NULL) {
        *made = (held){h->memory, &h->memory};
    }
    *made->back = made;
    if (made->next != NULL) {
        made->next->back = &made->next;
    }
    h->bytes += (more - *room) * each;
    h->peak = (h->bytes > h->peak) ? h->bytes : h->peak;
    *room = (uint32_t)more;
    return made + 1;
}

/* Free rows before the end of the search. */
static void give_back(engine *h, void *rows, uint32_t room, size_t each)
{
    if (rows != NULL) {
        held *made = (held *)rows - 1;
        *made->back = made->next;
        if (made->next != NULL) {
            made->next->back = made->back;
        }
        free(made);
        h->bytes -= (uint64_t)room * each;
    }
}

#define ROOM(h, rows, room, wanted)                                                              \
    (((uint64_t)(wanted) <= (room))                                                              \
     || ((rows) = enlarge((h), (rows), &(room), (wanted), sizeof *(rows)),                       \
         (uint64_t)(wanted) <= (room)))

/* A block of zeros that lasts as long as the search. */
static void *block(engine *h, size_t count, size_t each)
{
    uint32_t room = 0;
    return enlarge(h, NULL, &room, (uint64_t)count + 1, each);
}

static bool put(engine *h, numbers *to, int32_t number)
{
    if (!ROOM(h, to->at, to->room, (uint64_t)to->count + 1)) {
        return false;
    }
    to->at[to->count++] = number;
    return true;
}

/* Count work, and ask the caller from time to time whether to continue. */
static void count_work(engine *h)
{
    h->work += (uint64_t)h->entries + 16;
    if (h->work >= (UINT64_C(1) << 18)) {
        h->work = 0;
        if (!h->from->continues(h->from->context, h->visited,
                              (uint64_t)(h->queue_end - h->queue_head) + h->heap_count
                                  + h->frame_count)
            && (h->state == SEARCH_RUNS)) {
            h->state = SEARCH_STOPPED;
        }
    }
}

static void visit(engine *h)
{
    h->visited++;
    if ((h->visited > h->from->most_states) && (h->state == SEARCH_RUNS)) {
        h->state = SEARCH_STOPPED;
    }
    count_work(h);
}

static bool runs(const engine *h)
{
    return h->state == SEARCH_RUNS;
}

#endif
