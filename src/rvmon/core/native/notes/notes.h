/* Notes: the raw data from which rvmon.monitor.notes derives why an attempt was decided, or is open.
 * notes.c keeps the history of truths as it happens, letters.c the letters of networks; write_notes.c
 * writes a note with each record. Verdicts never depend on notes. */
#ifndef RVMON_NOTES_H
#define RVMON_NOTES_H

#include "basics.h"

/* ---- notes.c: history of truths */
bool make_notes(run *r);
void clear_noting(run *r, int32_t index);
void reset_truth_log(run *r, int64_t t);
void copy_truth_log(run *made, const run *r);
void note_node(run *r, int32_t node, uint8_t was, int64_t t);
void note_trigger(run *r, int32_t index, int64_t t);
void note_begin(run *r, int32_t index, attempt *x, int64_t t);
void note_parting(run *r, int32_t index, attempt *x);
void note_doubt(run *r, int32_t index, int64_t t);
void note_open_count(run *r, int32_t index);
void note_undecidable(run *r, int32_t index, int64_t t);
int64_t begin_of(const run *r, int32_t index, const attempt *x);
const int64_t *doubt_of(const run *r, int32_t index, const attempt *x);

/* ---- letters.c: the letters that a network reads */
void keep_letter(run *r, int32_t index, int64_t t);

/* ---- write_notes.c: writing notes */
int64_t note_inconclusive(run *r, int32_t index, const attempt *x);
int64_t note_decision(run *r, int32_t index, const attempt *x, int64_t t);
int64_t note_open(run *r, int32_t index, const attempt *x, int64_t now, bool cannot_pass, int64_t end);
void hold_token(rv_monitor *m, const machine *a, int32_t location, const int64_t *clocks);
void hold_until(rv_monitor *m, const machine *a, int32_t letter, int64_t first, int64_t t);
void bracket_open_notes(rv_monitor *m, bool begins);
void forget_notes(rv_monitor *m, int64_t words, int32_t spans);

/* Truths are packed two bits each. */
#define TRUTHS_IN_WORD 32U
/* Letters of a piece: its capacity. */
#define LETTERS_IN_PIECE 64

static inline int32_t words_for(int32_t nodes)
{
    return (int32_t)(((uint32_t)nodes + TRUTHS_IN_WORD - 1U) / TRUTHS_IN_WORD);
}

static inline int64_t *entry_of(const truths *ring, int32_t i, int32_t words)
{
    return &ring->words[(int64_t)((ring->head + i) & (ring->room - 1)) * (words + 1)];
}

/* ---- notes.c */
int64_t moved_at(const run *r);
truth_times truth_times_of(const run *r, int32_t node, bool before);
void pack_truths(const run *r, list nodes, bool before, int64_t *words);
bool pack_leaves(const run *r, int32_t index, bool before, int64_t *words);

/* ---- letters.c */
rv_piece *made_piece(rv_monitor *m, int32_t stride);
rv_piece *next_piece(rv_monitor *m, noting *n, int32_t stride);
void forget_letters(rv_monitor *m, noting *n);
int32_t span_from(rv_monitor *m, noting *n, int64_t begin);
void unpin_letters(rv_monitor *m);

/* ---- letters.c: rings of truths */
const int64_t *truths_at(const truths *ring, int32_t words, int64_t t);
void drop_truths(truths *ring, int32_t words, int64_t oldest);
bool grow_truths(rv_monitor *m, truths *ring, int32_t words);
int64_t *next_truths(rv_monitor *m, truths *ring, int32_t words);

/* The notes that stay while others are dropped (rv_trim): copies of their words and spans. */
typedef struct {
    int64_t *words;
    span_of_letters *spans;
    int64_t count;
    int32_t span_count;
} kept_notes;

int32_t keep_span(rv_monitor *m, kept_notes *to, int32_t number);
void pin_kept_letters(rv_monitor *m);

/* ---- write_notes.c */
enum { NOTE_DECIDED, NOTE_OPEN, NOTE_NOTHING };
enum {
    NOTE_NETWORK = 1,          /* the judge is a network */
    NOTE_CUT = 2,              /* captured values became unknown */
    NOTE_PARTED = 4,           /* the two readings differ */
    NOTE_CANNOT_PASS = 8,
    NOTE_SURE = 16
};
/* Words of a note before those of the leaves. */
#define NOTE_HEAD 7
void drop_open_notes(rv_monitor *m);
bool begin_keeping(rv_monitor *m, kept_notes *to);
int64_t keep_note(rv_monitor *m, kept_notes *to, int64_t note);
void give_up_keeping(rv_monitor *m, kept_notes *to);
void end_keeping(rv_monitor *m, kept_notes *to);

#endif
