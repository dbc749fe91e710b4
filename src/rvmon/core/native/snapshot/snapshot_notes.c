/* The state behind notes, and the notes of records, in a snapshot. */
#include "notes/notes.h"
#include "snapshot/snapshot.h"

/* A position, or RV_NO_TIME. */
static void carry_position(carrier *c, int64_t *x)
{
    carry_long(c, x, RV_NO_TIME, LIMIT);
}

static void carry_truth_times(carrier *c, truth_times *x)
{
    carry_position(c, &x->since);
    carry_position(c, &x->last[0]);
    carry_position(c, &x->last[1]);
}

void carry_truth_log(carrier *c, run *r)
{
    truth_log *s = r->truth_log;
    int32_t i;
    carry_position(c, &s->moved_at);
    carry_position(c, &s->since);
    for (i = 0; (i < r->part->logged) && !is_lost(c); i++) {
        logged_node *own = &s->nodes[i];
        uint8_t moved = ((own->moved_at == s->moved_at) && (s->moved_at != RV_NO_TIME)) ? 1 : 0;
        carry_truth_times(c, &own->now);
        carry_byte(c, &moved, 1);
        if (moved != 0U) {
            own->moved_at = s->moved_at;
            carry_truth_times(c, &own->was);
            carry_byte(c, &own->truth, IS_TRUE);
        }
    }
}

/* A ring of packed truths, ascending. */
static void carry_truths(carrier *c, truths *ring, int32_t words)
{
    int32_t count = ring->count;
    int64_t before = -LIMIT;
    int32_t i;
    int32_t k;
    carry_size(c, &count, MOST, 8);
    for (i = 0; (i < count) && !is_lost(c); i++) {
        int64_t *one;
        if (c->reading && (next_truths(c->m, ring, words) == NULL)) {
            break;
        }
        one = entry_of(ring, i, words);
        carry_instant(c, &one[0]);
        demand(c, one[0] >= before);
        before = one[0];
        for (k = 1; k <= words; k++) {
            carry_long(c, &one[k], INT64_MIN, INT64_MAX);
        }
        demand(c, are_truths(&one[1], words));
    }
}

/* The index of the last state written, if later notes may share it; else -1. */
static void carry_shared(carrier *c, run *r, int32_t index)
{
    rv_monitor *m = c->m;
    noting *n = r->judges[index].noting;
    int64_t place = ((n->epoch == m->epoch) && (n->state_at == moved_at(r))) ? n->state : -1;
    carry_long(c, &place, -1, m->note_count);
    if (c->reading && !c->refused && (place >= 0)) {
        demand(c, is_state(c, &r->part->judges[index], place));
        n->state = place;
        n->state_at = moved_at(r);
        n->epoch = m->epoch;
    }
}

void carry_noting(carrier *c, run *r, int32_t index)
{
    const judge_plan *judged = &r->part->judges[index];
    noting *n = r->judges[index].noting;
    const int32_t words = words_for(judged->leaves.count);
    carry_truths(c, &n->triggers, words);
    carry_truths(c, &n->doubts, words);
    carry_position(c, &n->began_at);
    carry_long(c, &n->undecidable_since, -LIMIT, NEVER);
    carry_shared(c, r, index);
    if (is_networked(r, index)) {
        carry_letters(c, n, words_for(judged->propositions.count) + 1);
    }
    if (c->reading && !is_lost(c) && (n->doubts.count > 0)) {
        n->doubted_at = entry_of(&n->doubts, n->doubts.count - 1, words)[0];
    }
}

void carry_unknowns(carrier *c, home *h)
{
    const int32_t signals = h->part->plan->signals.count;
    int32_t i;
    carry_size(c, &h->unknown_count, MOST, 9);
    if (c->reading) {
        unknown_stretch *made =
            enlarged(c->m, h->unknowns, &h->unknown_room, h->unknown_count, sizeof *made);
        h->unknowns = (made != NULL) ? made : h->unknowns;
        for (i = 0; i < signals; i++) {
            h->unknown_of[i] = -1;
        }
    }
    for (i = 0; (i < h->unknown_count) && !is_lost(c); i++) {
        unknown_stretch *one = &h->unknowns[i];
        carry_position(c, &one->since);
        carry_instant_or(c, &one->until, NEVER);
        carry_int(c, &one->local, 0, signals);
        carry_int(c, &one->why, RV_IS_NONE, HAS_NO_SOURCE + 1);
        if (c->reading && !c->refused) {
            h->unknown_of[one->local] = i;
        }
    }
}

/* The notes of records, as plain words. On reading, each note has to belong to exactly one record and
 * refer to existing states and letters. */

/* What starts at a word: a note, a state, or a note that a record has claimed. */
enum { A_NOTE = 1, A_STATE = 2, A_TAKEN_NOTE = 3 };

/* Find where notes and states start: the first word of both has their length, for a note in its upper
 * bits. */
static void find_begins(carrier *c, const rv_monitor *m)
{
    int64_t at = 0;
    while (!c->refused && (at < m->note_count)) {
        const int64_t word = m->notes[at];
        const bool is_note = word >= (INT64_C(1) << 40);
        const int64_t length = is_note ? word >> 40 : word;
        demand(c, (length >= (is_note ? NOTE_HEAD : 2)) && (length <= m->note_count - at));
        if (!c->refused) {
            c->begins[at] = is_note ? A_NOTE : A_STATE;
            at += length;
        }
    }
}

void carry_notes(carrier *c, rv_monitor *m)
{
    int32_t count = (int32_t)m->note_count;
    int32_t i;
    carry_size(c, &count, MOST, 8);
    if (c->reading && !is_lost(c)) {
        int64_t *made = enlarged(m, m->notes, &m->note_room, count, sizeof *made);
        m->notes = (made != NULL) ? made : m->notes;
        c->begins = arena_take(&m->memory, (size_t)count + 1U);
        m->spoilt = m->spoilt || (c->begins == NULL);
    }
    for (i = 0; (i < count) && !is_lost(c); i++) {
        carry_long(c, &m->notes[i], INT64_MIN, INT64_MAX);
    }
    if (c->reading && !is_lost(c)) {
        m->note_count = count;
        find_begins(c, m);
    }
    carry_spans(c, m);
}

void end_notes(carrier *c, rv_monitor *m)
{
    if (c->begins != NULL) {
        arena_give(&m->memory, c->begins, (size_t)m->note_count + 1U);
        c->begins = NULL;
    }
}

/* Whether a state of a judge starts at a place. */
bool is_state(const carrier *c, const judge_plan *judged, int64_t place)
{
    const rv_monitor *m = c->m;
    const int32_t leaves = words_for(judged->leaves.count);
    const int32_t letters = words_for(judged->propositions.count);
    return (place >= 0) && (place < m->note_count) && (c->begins[place] == A_STATE)
           && (m->notes[place] == 2 + leaves + letters + 3 * (int64_t)judged->propositions.count)
           && are_truths(&m->notes[place + 2], leaves + letters);
}

/* A note that is being checked, and how far the check has come. */
typedef struct {
    const part *own;
    const int64_t *words;
    int64_t length;
    int64_t at;
    int32_t index;             /* of the judge in the part */
    bool fits;
} checking;

static bool has_more(checking *k, int64_t count)
{
    k->fits = k->fits && (count >= 0) && (count <= k->length - k->at);
    return k->fits;
}

static void check_truths(checking *k, int32_t words)
{
    if (has_more(k, words)) {
        k->fits = are_truths(&k->words[k->at], words);
        k->at += words;
    }
}

/* A location, and the clocks that it has. */
static void check_token(checking *k, int64_t width)
{
    const machine *a = &k->own->machines[k->index];
    if (has_more(k, 1) && has_more(k, width) && has_more(k, 1 + width)) { /* in this order, as `width`
                                                                           * may be any number */
        const int64_t location = k->words[k->at];
        k->fits = (location >= 0) && (location < a->locations) && (width == a->widths[location]);
        k->at += 1 + width;
    } else {
        k->fits = false;
    }
}

/* The unknown inputs in a note of an open attempt. */
static void check_unknowns(const carrier *c, checking *k)
{
    const int32_t names = c->m->plan.header->signals + c->m->plan.header->events;
    int64_t count;
    int64_t i;
    if (!has_more(k, 1)) {
        return;
    }
    count = k->words[k->at];
    k->at++;
    k->fits = (count >= 0) && (count <= k->length) && (3 * count <= k->length - k->at);
    for (i = 0; k->fits && (i < count); i++) {
        const int64_t word = k->words[k->at];
        k->fits = (word >= 0) && ((word & INT32_MAX) < names) && ((word >> 32) <= HAS_NO_SOURCE);
        k->at += 3;
    }
}

static void check_open(const carrier *c, checking *k, bool networked, int32_t leaves)
{
    if (k->words[4] != RV_NO_TIME) {
        check_truths(k, leaves);
    }
    if (networked) {
        k->fits = has_more(k, 2) && (k->words[k->at] >= FAILED) && (k->words[k->at] <= WAITING)
                  && (k->words[k->at + 1] >= FAILED) && (k->words[k->at + 1] <= WAITING);
        k->at += 2;
    } else {
        check_token(k, k->words[3] & INT32_MAX);
        check_token(k, k->words[3] >> 32);
    }
    check_unknowns(c, k);
}

/* Whether the letters to which a note of a network refers exist and belong to its judge. */
static bool has_letters(const carrier *c, const judge_plan *judged, int64_t word)
{
    const int64_t number = word & INT32_MAX;
    return (word == -1)
           || ((word >= 0) && (number < c->m->span_count)
               && (c->m->spans[number].last->stride == words_for(judged->propositions.count) + 1));
}

/* Check the note of a record, written by a judge of part `own`. */
void check_note(carrier *c, const part *own, const rv_record *one)
{
    const rv_monitor *m = c->m;
    const judge_plan *judged;
    checking k;
    bool networked;
    if (one->note < 0) {
        return;
    }
    demand(c, (own != NULL) && (one->note < m->note_count) && (c->begins[one->note] == A_NOTE));
    if (c->refused) {
        return;
    }
    c->begins[one->note] = A_TAKEN_NOTE;
    k.own = own;
    k.words = &m->notes[one->note];
    k.length = k.words[0] >> 40;
    k.at = NOTE_HEAD;
    k.index = (int32_t)((k.words[0] >> 24) & 0xffff);
    k.fits = true;
    demand(c, (k.index < own->plan->judges.count)
                  && (own->judges[k.index].requirement == one->requirement));
    if (c->refused) {
        return;
    }
    judged = &own->judges[k.index];
    networked = judged->automaton < 0;
    demand(c, networked == (((k.words[0] >> 8) & NOTE_NETWORK) != 0));
    demand(c, (k.words[1] == -1) || is_state(c, judged, k.words[1]));
    demand(c, !networked || has_letters(c, judged, k.words[3]));
    check_truths(&k, words_for(judged->leaves.count));
    switch (k.words[0] & 0xff) {
    case NOTE_DECIDED:
        if (!networked) {
            check_token(&k, k.words[3]);
        }
        break;
    case NOTE_OPEN: check_open(c, &k, networked, words_for(judged->leaves.count)); break;
    default: k.fits = k.fits && ((k.words[0] & 0xff) == NOTE_NOTHING); break;
    }
    demand(c, k.fits && ((k.at == k.length) || ((k.words[0] & 0xff) == NOTE_OPEN))); /* those have
                                                                                      * spare words
                                                                                      * at the end */
}
