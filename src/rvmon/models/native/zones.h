/* Symbolic search in a network of timed automata: the interface for module.c and the fuzzer. */
#ifndef RVMON_ZONES_H
#define RVMON_ZONES_H

#include "plan.h"

/* The state of a search: it runs; it ended without a result; it found one; the caller stopped it; an
 * evaluation failed (a variable out of range, a bad number); memory ran out; numbers are too large. */
typedef enum { SEARCH_RUNS, SEARCH_ENDED, SEARCH_FOUND, SEARCH_STOPPED, SEARCH_FAILED,
               SEARCH_NO_MEMORY, SEARCH_TOO_LARGE } search_state;

/* The ending of a run that was found. */
enum { END_REACHED, END_DEAD, END_IDLE, END_STUCK, END_LOOP, END_ZENO };

/* Steps of a path, each as: kind, piece after it (-1: none), a count, number of edges, their indices. For
 * a move the count is that of further bounds under which it can be taken, which follow, each as: x, y, c,
 * 1 for `<= c`. For a crossing it is 1 if the instant still belongs to the old piece, 0 if it
 * belongs to the new one; for a mark it is the index of an alternative of the goal. */
enum { STEP_MOVE, STEP_CROSSING, STEP_MARK };

typedef struct {
    int32_t *at;
    uint32_t count;
    uint32_t room;
} numbers;

/* The result of a search.
 *   path: the piece in which the run starts (-1: none), then its steps
 *   parts: the last valuations that meet the goal: rows of DBMs, 2c + 1 for `<= c`, 2c for `< c`,
 *          INT64_MAX if unbounded
 *   spans: with a watcher, for each of its locations the bounds of the last clock of the network:
 *          `-clock` at most the first, `clock` at most the second; INT64_MIN if it was never reached
 *   loop: number of steps before the loop, -1 without one */
typedef struct {
    search_state state;
    int32_t ending;
    int32_t loop;
    bool improper; /* whether a run was skipped on which time stops */
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
    struct held *memory; /* owns all memory of the search */
} answer;

/* The caller of a search. `continues` is called from time to time, and stops the search by returning false.
 * `diverges` is called with a loop: it returns 1 if time diverges on the loop, 0 if not, -1 to stop. */
typedef struct {
    void *context;
    bool (*continues)(void *context, uint64_t visited, uint64_t waiting);
    int (*diverges)(void *context, const numbers *path, int32_t loop, const int64_t *head,
                    uint32_t dim);
    uint64_t most_states;
    uint64_t most_bytes; /* of memory in use */
    bool proper_only;    /* only runs on which time diverges */
} caller;

/* Search a validated plan, with the cost of each edge, in bounds of 32 or 64 bits. The answer must be
 * released in any case. */
answer search_narrow(const int32_t *plan, const double *costs, const caller *from);
answer search_wide(const int32_t *plan, const double *costs, const caller *from);

/* Search in 32 bits, and again in 64 bits if numbers are too large for them. */
answer search(const int32_t *plan, const double *costs, const caller *from);

void release_answer(answer *found);

#endif
