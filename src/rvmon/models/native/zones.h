/* Searches a network of timed automata, symbolically: what module.c and the fuzzer call. */
#ifndef RVMON_ZONES_H
#define RVMON_ZONES_H

#include "plan.h"

/* How a search ended: nothing was found; something was; it was stopped; a variable left its range
 * or a number was none that can be used; memory ran out; numbers are too large. */
typedef enum { SEARCH_RUNS, SEARCH_ENDED, SEARCH_FOUND, SEARCH_STOPPED, SEARCH_FAILED,
               SEARCH_NO_MEMORY, SEARCH_TOO_LARGE } search_state;

/* How a run ends that was found. */
enum { END_REACHED, END_DEAD, END_IDLE, END_STUCK, END_LOOP, END_ZENO };

/* Steps of a path, each given as: kind, piece behind (-1: none), a number, edges, their indices. Of a
 * move the number is of further bounds under which it can be taken, given as: x, y, c, 1 for `<= c`. */
enum { STEP_MOVE, STEP_CROSSING, STEP_MARK };

typedef struct {
    int32_t *at;
    uint32_t count;
    uint32_t room;
} numbers;

/* What was found.
 *   path: first the piece in which it starts (-1: none), then its steps
 *   parts: of the last valuations, what is sought: rows of DBMs, 2c + 1 for `<= c`, 2c for `< c`,
 *          INT64_MAX for none
 *   spans: of a search for a goal with a watcher, for each of its places between which bounds the last
 *          clock of the network was: `-clock` at most the first, `clock` at most the second;
 *          INT64_MIN where it never came
 *   loop: steps before the loop, -1 without one */
typedef struct {
    search_state state;
    int32_t ending;
    int32_t loop;
    bool improper; /* whether a way was passed by on which time stops */
    uint64_t visited;
    uint64_t stored;
    uint64_t states;
    uint64_t peak;
    numbers path;
    int64_t *parts;
    uint32_t part_count;
    int64_t *spans;
    uint32_t span_count;
    uint32_t dim;
    struct held *memory; /* all of the search */
} answer;

/* What a search asks for. `goes_on` is called now and then; false stops it. `counts` is called with a
 * loop that was found: 1 if time passes on it without bound, 0 if not, -1 stops. */
typedef struct {
    void *context;
    bool (*goes_on)(void *context, uint64_t visited, uint64_t waiting);
    int (*counts)(void *context, const numbers *path, int32_t loop, const int64_t *head,
                  uint32_t dim);
    uint64_t most_states;
    uint64_t most_bytes; /* of memory that it takes */
    bool proper_only;    /* only ways on which time passes without bound */
} caller;

/* Search a plan that was checked, with the cost of each edge, in bounds of 32 or 64 bits. What it
 * gives is to be released, however it ended. */
answer search_narrow(const int32_t *plan, const double *costs, const caller *from);
answer search_wide(const int32_t *plan, const double *costs, const caller *from);

/* The first, and if numbers get too large for it, the second. */
answer search(const int32_t *plan, const double *costs, const caller *from);

void release_answer(answer *found);

#endif
