/* Notes of records in a snapshot: their words as they stand, which are checked when they are read: each note
 * is of one record, and refers to what is there. */
#include "notes.h"
#include "snapshot.h"

/* What begins at a word of notes. */
enum { A_NOTE = 1, A_STANDING = 2, A_TAKEN_NOTE = 3 };

/* Find where notes and standings begin; a note says at its begin how long it is, in the upper bits. */
static void find_begins(carrier *c, const rv_monitor *m)
{
    int64_t at = 0;
    while (!c->refused && (at < m->note_count)) {
        const int64_t word = m->notes[at];
        const bool is_note = word >= (INT64_C(1) << 40);
        const int64_t length = is_note ? word >> 40 : word;
        demand(c, (length >= (is_note ? NOTE_HEAD : 2)) && (length <= m->note_count - at));
        if (!c->refused) {
            c->begins[at] = is_note ? A_NOTE : A_STANDING;
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
        int64_t *made = grown(m, m->notes, &m->note_room, count, sizeof *made);
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

/* Whether a standing of a judge begins at a place. */
bool is_standing(const carrier *c, const judge_plan *judged, int64_t place)
{
    const rv_monitor *m = c->m;
    const int32_t leaves = words_for(judged->leaves.count);
    const int32_t letters = words_for(judged->propositions.count);
    return (place >= 0) && (place < m->note_count) && (c->begins[place] == A_STANDING)
           && (m->notes[place] == 2 + leaves + letters + 3 * (int64_t)judged->propositions.count)
           && are_truths(&m->notes[place + 2], leaves + letters);
}

/* Whether what a note of an automaton says of the run that decided is one, and all of the note. */
static bool is_token(const part *own, int32_t index, const int64_t *words, int32_t leaves)
{
    const machine *a = &own->machines[index];
    int64_t location;
    if ((words[0] >> 40) <= NOTE_HEAD + leaves) {
        return false;
    }
    location = words[NOTE_HEAD + leaves];
    return (location >= 0) && (location < a->locations) && (words[3] == a->widths[location])
           && ((words[0] >> 40) == NOTE_HEAD + leaves + 1 + words[3]);
}

/* Check the note of a record, of which a judge of a part may have told. */
void check_note(carrier *c, const part *own, const rv_record *one)
{
    rv_monitor *m = c->m;
    const int64_t *words;
    const judge_plan *judged;
    int64_t index;
    bool networked;
    int32_t leaves;
    if (one->note < 0) {
        return;
    }
    demand(c, (own != NULL) && (one->note < m->note_count) && (c->begins[one->note] == A_NOTE));
    if (c->refused) {
        return;
    }
    c->begins[one->note] = A_TAKEN_NOTE;
    words = &m->notes[one->note];
    index = (words[0] >> 24) & 0xffff;
    demand(c, (index < own->plan->judges.count) && (own->judges[index].requirement == one->requirement));
    if (c->refused) {
        return;
    }
    judged = &own->judges[index];
    leaves = words_for(judged->leaves.count);
    networked = ((words[0] >> 8) & NOTE_NETWORK) != 0;
    demand(c, networked == (judged->automaton < 0));
    demand(c, (words[1] == -1) || is_standing(c, judged, words[1]));
    if (c->refused) {
        return;
    }
    if (((words[0] & 0xff) == NOTE_DECIDED) && !networked) {
        demand(c, is_token(own, (int32_t)index, words, leaves));
    } else {
        demand(c, ((words[0] & 0xff) == NOTE_DECIDED) || ((words[0] & 0xff) == NOTE_NOTHING));
        demand(c, (words[0] >> 40) == NOTE_HEAD + leaves);
    }
    if (networked && !c->refused) {
        demand(c, (words[3] >= -1) && (words[3] < m->span_count));
        demand(c, (words[3] < 0)
                      || (m->spans[words[3]].last->stride == words_for(judged->propositions.count) + 1));
    }
    demand(c, are_truths(&words[NOTE_HEAD], leaves));
}
