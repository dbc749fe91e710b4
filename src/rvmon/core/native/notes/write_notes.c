/* Writing notes: the words from which reasons for decisions and for open attempts are derived. All notes
 * are in one array of int64; a record has the index of its note.
 *
 * 0  kind; from bit 8, flags; from bit 24, the judge; from bit 40, the number of words
 * 1  the index of the state of the propositions, which notes share; -1: none
 * 2  DECIDED: the instant; OPEN: the current stamp; NOTHING: -1
 * 3  network: its span of letters, or -1; for OPEN, from bit 32 on the number of open attempts
 *    automaton: the number of clocks; for OPEN, of the worse reading, and from bit 32 on of the better
 * 4  OPEN: the instant of the doubt, or RV_NO_TIME
 * 5  OPEN: the end of the trace, or RV_NO_TIME
 * 6  the position at which the attempt started
 * Then follow the leaves at the trigger; for OPEN with a doubt, the leaves there; for an automaton, the
 * location and clocks just before the decision, for OPEN of both readings; for OPEN of a network, two
 * locations; for OPEN, the unknown inputs (input/unknowns.c).
 *
 * A state: its number of words; the first position the run saw, or RV_NO_TIME; the leaves; the
 * propositions; for each proposition since when it has its truth, when it was last false and when it was
 * last true, or RV_NO_TIME. */
#include "input/input.h"
#include "networks/network.h"
#include "notes/notes.h"

#include <string.h>

static int64_t *further_words(rv_monitor *m, int64_t count)
{
    if (m->note_count + count > m->note_room) {
        int64_t *made = widened(m, m->notes, &m->note_room, m->note_count + count, sizeof *made);
        if (made == NULL) {
            return NULL;
        }
        m->notes = made;
    }
    m->note_count += count;
    return &m->notes[m->note_count - count];
}

/* Drop the notes of open attempts, which follow those of records. */
void drop_open_notes(rv_monitor *m)
{
    if (m->has_open_notes && !m->writes_open_notes) {
        forget_notes(m, m->settled_notes, m->settled_spans);
    }
}

/* The index of the state at instant `t`, shared with the last state if nothing changed since; -1: memory
 * is short. */
static int64_t note_state(run *r, int32_t index, int64_t t)
{
    rv_monitor *m = r->home->monitor;
    noting *n = r->judges[index].noting;
    const judge_plan *judged = &r->part->judges[index];
    const int32_t *nodes = LIST(PLAN(r), judged->propositions);
    const int32_t leaves = words_for(judged->leaves.count);
    const int32_t letters = words_for(judged->propositions.count);
    const bool before = t < moved_at(r);
    int64_t *made;
    int64_t count;
    int32_t i;
    bool awaits_birth;
    drop_open_notes(m);
    if (!before && (n->state >= 0) && (n->state_at == moved_at(r))
        && (n->epoch == m->epoch)) {
        return n->state;
    }
    count = 2 + leaves + letters + 3 * (int64_t)judged->propositions.count;
    made = further_words(m, count);
    if (made == NULL) {
        return -1;
    }
    made[0] = count;
    made[1] = r->truth_log->since;
    awaits_birth = pack_leaves(r, index, before, &made[2]);
    pack_truths(r, judged->propositions, before, &made[2 + leaves]);
    for (i = 0; i < judged->propositions.count; i++) {
        const truth_times one = truth_times_of(r, nodes[i], before);
        int64_t *own = &made[2 + leaves + letters + 3 * i];
        own[0] = one.since;
        own[1] = one.last[0];
        own[2] = one.last[1];
    }
    if (!before && !awaits_birth) { /* a birth may change what is shown although no truth changes */
        n->epoch = m->epoch;
        n->state_at = moved_at(r);
        n->state = made - m->notes;
    }
    return made - m->notes;
}

static int64_t flags_of(const run *r, int32_t index, const attempt *x)
{
    int64_t flags = is_networked(r, index) ? NOTE_NETWORK : 0;
    flags |= (r->cut < NEVER) ? NOTE_CUT : 0;
    flags |= x->parted ? NOTE_PARTED : 0;
    flags |= x->cannot_pass ? NOTE_CANNOT_PASS : 0;
    flags |= x->sure ? NOTE_SURE : 0;
    return flags;
}

/* Start a note with `count` words after the leaves at its trigger, which the caller fills; returns its
 * index, -1: memory is short. */
static int64_t begin_note(run *r, int32_t index, const attempt *x, int64_t kind, int64_t flags,
                          int64_t count)
{
    rv_monitor *m = r->home->monitor;
    const noting *n = r->judges[index].noting;
    const int32_t words = words_for(r->part->judges[index].leaves.count);
    const int64_t *then = truths_at(&n->triggers, words, x->triggered);
    int64_t *made;
    int32_t i;
    drop_open_notes(m);
    made = further_words(m, NOTE_HEAD + words + count);
    if (made == NULL) {
        return -1;
    }
    made[0] = kind | ((flags_of(r, index, x) | flags) << 8) | ((int64_t)index << 24)
              | ((NOTE_HEAD + words + count) << 40);
    made[1] = made[2] = made[3] = -1;
    made[4] = made[5] = RV_NO_TIME;
    made[6] = begin_of(r, index, x);
    for (i = 0; i < words; i++) {
        made[NOTE_HEAD + i] = (then != NULL) ? then[1 + i] : 0;
    }
    return made - m->notes;
}

static int64_t *after_trigger(const run *r, int32_t index, int64_t note)
{
    return &r->home->monitor->notes[note + NOTE_HEAD + words_for(r->part->judges[index].leaves.count)];
}

static void write_token(int64_t *to, int32_t location, const int64_t *clocks, int32_t width)
{
    to[0] = location;
    if (width > 0) {
        (void)memcpy(&to[1], clocks, (size_t)width * sizeof *to);
    }
}

int64_t note_inconclusive(run *r, int32_t index, const attempt *x)
{
    return begin_note(r, index, x, NOTE_NOTHING, 0, 0);
}

/* A note for a decision at `t`. For an automaton, hold_token has saved its state before. */
int64_t note_decision(run *r, int32_t index, const attempt *x, int64_t t)
{
    rv_monitor *m = r->home->monitor;
    const bool networked = is_networked(r, index);
    const before_decision *was = &m->before;
    const int64_t state = note_state(r, index, t);
    const int64_t note = begin_note(r, index, x, NOTE_DECIDED, 0, networked ? 0 : 1 + was->width);
    if ((note < 0) || (state < 0)) {
        return -1;
    }
    m->notes[note + 1] = state;
    m->notes[note + 2] = t;
    if (networked) {
        m->notes[note + 3] = span_from(m, r->judges[index].noting, m->notes[note + 6]);
    } else {
        m->notes[note + 3] = was->width;
        write_token(after_trigger(r, index, note), was->location, was->clocks, was->width);
    }
    return note;
}

/* Save location and clocks before a move, for the note of a decision by it. */
void hold_token(rv_monitor *m, const machine *a, int32_t location, const int64_t *clocks)
{
    before_decision *was = &m->before;
    was->location = location;
    was->width = a->widths[location];
    if (was->width == 1) { /* the common case */
        was->clocks[0] = clocks[0];
    } else if (was->width > 1) {
        (void)memcpy(was->clocks, clocks, (size_t)was->width * sizeof *clocks);
    } else {
        /* The location has no clocks. */
    }
}

/* Advance the saved state to just before instant `t`: positions from `first` on had this letter. Needed
 * because attempts are driven over many positions at once. */
void hold_until(rv_monitor *m, const machine *a, int32_t letter, int64_t first, int64_t t)
{
    before_decision *was = &m->before;
    bool slides = false;
    token k;
    k.location = was->location;
    k.clocks = was->clocks;
    k.moves = NULL; /* the attempt itself counts its moves */
    if ((a->gap > 0) && (first <= t - 1) && (k.location > PASSED)) {
        (void)run_token(a, &k, letter, first, t - 1, &slides);
        was->location = k.location;
        was->width = a->widths[k.location];
    }
}

/* Write location and clocks of one reading of an open attempt as of instant `until`; returns the number
 * of clocks. */
static int32_t put_by_now(run *r, int32_t index, int32_t location, const int64_t *clocks,
                          int32_t letter, int64_t until, int64_t *to)
{
    rv_monitor *m = r->home->monitor;
    const machine *a = &r->part->machines[index];
    hold_token(m, a, location, clocks);
    hold_until(m, a, letter, r->judges[index].position + a->step, until + 1);
    write_token(to, m->before.location, m->before.clocks, m->before.width);
    return m->before.width;
}

/* A note for an open attempt at stamp `now` (2t, or 2t + 1 if the letter at t is known); `end` of the
 * trace, or RV_NO_TIME. */
int64_t note_open(run *r, int32_t index, const attempt *x, int64_t now, bool cannot_pass, int64_t end)
{
    rv_monitor *m = r->home->monitor;
    judge *j = &r->judges[index];
    const bool networked = is_networked(r, index);
    const int32_t words = words_for(r->part->judges[index].leaves.count);
    const int32_t most = networked ? 0 : r->part->machines[index].clocks;
    const int64_t until = floored(now - 1, 2);
    const int64_t state = note_state(r, index, NEVER);
    const int64_t *doubt = doubt_of(r, index, x);
    const int64_t doubted_at = (doubt != NULL) ? doubt[0] : RV_NO_TIME;
    const int64_t more = words + 2 * ((int64_t)most + 1) + unknowns_count(r, index, doubted_at);
    const int64_t note = begin_note(r, index, x, NOTE_OPEN, cannot_pass ? NOTE_CANNOT_PASS : 0, more);
    int64_t *to;
    if ((note < 0) || (state < 0)) {
        return -1;
    }
    m->notes[note + 1] = state;
    m->notes[note + 2] = now;
    m->notes[note + 5] = end;
    to = after_trigger(r, index, note);
    (void)memset(to, 0, (size_t)more * sizeof *to); /* the end may stay unused */
    if (doubt != NULL) {
        m->notes[note + 4] = doubt[0];
        (void)memcpy(to, &doubt[1], (size_t)words * sizeof *to);
        to += words;
    }
    if (networked) {
        const int64_t letters = span_from(m, j->noting, m->notes[note + 6]);
        m->notes[note + 3] = (letters < 0) ? -1 : letters | ((int64_t)j->noting->open_count << 32);
        to[0] = x->location;
        to[1] = (x->parted && (x->better == PASSED)) ? PASSED : WAITING;
        to += 2;
    } else {
        const int64_t *better = x->parted ? x->clocks + r->part->plan->clocks : x->clocks;
        const int32_t location = x->parted ? x->better : x->location;
        const int32_t own = put_by_now(r, index, x->location, x->clocks, j->letter, until, to);
        const int32_t other = put_by_now(r, index, location, better, j->other, until, to + 1 + own);
        m->notes[note + 3] = own | ((int64_t)other << 32);
        to += 2 + own + other;
    }
    put_unknowns(r, index, doubted_at, to);
    return note;
}

void forget_notes(rv_monitor *m, int64_t words, int32_t spans)
{
    m->note_count = words;
    m->span_count = spans;
    if (words == 0) {
        unpin_letters(m);
    }
    m->has_open_notes = false;
    m->epoch++;
}

/* Start to drop all notes except some, which are copied to `to`; false: memory is short. */
bool begin_keeping(rv_monitor *m, kept_notes *to)
{
    drop_open_notes(m);
    to->count = 0;
    to->span_count = 0;
    to->words = arena_enlarge(&m->memory, NULL, 0, (size_t)m->note_room * sizeof *to->words);
    to->spans = arena_enlarge(&m->memory, NULL, 0, (size_t)m->span_room * sizeof *to->spans);
    if ((to->words == NULL) || (to->spans == NULL)) {
        give_up_keeping(m, to);
        return false;
    }
    return true;
}

void give_up_keeping(rv_monitor *m, kept_notes *to)
{
    arena_give(&m->memory, to->words, (size_t)m->note_room * sizeof *to->words);
    arena_give(&m->memory, to->spans, (size_t)m->span_room * sizeof *to->spans);
}

static int64_t keep_words(kept_notes *to, const int64_t *words, int64_t count)
{
    (void)memcpy(&to->words[to->count], words, (size_t)count * sizeof *words);
    to->count += count;
    return to->count - count;
}

/* Copy a note and what it refers to; returns its new index. A copied state stores its new index, negated,
 * so that it is copied only once. */
int64_t keep_note(rv_monitor *m, kept_notes *to, int64_t note)
{
    const int64_t *words;
    int64_t made;
    if (note < 0) {
        return note;
    }
    words = &m->notes[note];
    made = keep_words(to, words, words[0] >> 40);
    if (words[1] >= 0) {
        int64_t *state = &m->notes[words[1]];
        if (state[0] >= 0) { /* else it was copied before */
            const int64_t place = keep_words(to, state, state[0]);
            state[0] = -1 - place;
        }
        to->words[made + 1] = -1 - state[0];
    }
    if ((((words[0] >> 8) & NOTE_NETWORK) != 0) && (words[3] >= 0)) {
        const int64_t others = words[3] >> 32;
        to->words[made + 3] = keep_span(m, to, (int32_t)(words[3] & INT32_MAX)) | (others << 32);
    }
    return made;
}

void end_keeping(rv_monitor *m, kept_notes *to)
{
    int64_t *words = m->notes;
    span_of_letters *spans = m->spans;
    m->notes = to->words;
    m->note_count = to->count;
    m->spans = to->spans;
    m->span_count = to->span_count;
    to->words = words;
    to->spans = spans;
    give_up_keeping(m, to);
    m->epoch++;
    if (m->keeps_notes) {
        pin_kept_letters(m);
    }
}

/* Bracket the writing of notes of open attempts, which follow those of records. */
void bracket_open_notes(rv_monitor *m, bool begins)
{
    if (begins) {
        drop_open_notes(m);
        m->settled_notes = m->note_count;
        m->settled_spans = m->span_count;
    }
    m->epoch++; /* states are not shared across the bracket */
    m->writes_open_notes = begins;
    m->has_open_notes = true;
}

/* Whether `count` words at an index are notes. */
static bool are_written(const rv_monitor *m, int64_t place, int64_t count)
{
    return (place >= 0) && (count >= 2) && (count <= m->note_count - place);
}

int64_t rv_notes(const rv_monitor *m, const int64_t **words)
{
    *words = m->notes;
    return m->note_count;
}

bool rv_span(const rv_monitor *m, int32_t number, rv_note *note)
{
    if ((number < 0) || (number >= m->span_count)) {
        return false;
    }
    note->first = m->spans[number].first;
    note->last = m->spans[number].last;
    note->last_count = m->spans[number].last_count;
    return true;
}

bool rv_note_of(const rv_monitor *m, const rv_record *record, rv_note *note)
{
    const int64_t *words;
    (void)memset(note, 0, sizeof *note);
    if (!are_written(m, record->note, NOTE_HEAD)) {
        return false;
    }
    words = &m->notes[record->note];
    if (!are_written(m, record->note, words[0] >> 40)) {
        return false;
    }
    note->words = words;
    note->count = words[0] >> 40;
    if (are_written(m, words[1], 2) && are_written(m, words[1], m->notes[words[1]])) {
        note->state = &m->notes[words[1]];
        note->state_count = note->state[0];
    }
    if ((((words[0] >> 8) & NOTE_NETWORK) != 0) && (m->span_count > 0)) {
        (void)rv_span(m, (int32_t)(words[3] & INT32_MAX), note);
    }
    return true;
}
