/* Letters of a network's propositions, stored for notes: one where they changed (in sampled time, one per
 * sample), from the start of the oldest open attempt on.
 *
 * They are in pieces of fixed size, linked in order. A note refers to the pieces from the start of its
 * attempt to its decision, so decisions copy no letters. A piece lives while it is in the list of its
 * judge, or pinned, that is, referred to by a record's note. A piece is pinned if its number equals the
 * monitor's `pins`, so incrementing `pins` unpins all pieces at once. */
#include "networks/network.h"
#include "notes/notes.h"
#include "runs/runs.h"

#include <string.h>

/* The most pieces of a judge: an attempt that lasts longer is explained by its last part. */
#define PIECES_MOST 4096

const int64_t *rv_piece_words(const rv_piece *piece, int32_t *count)
{
    *count = piece->count;
    return piece->words;
}

int32_t rv_piece_room(const rv_piece *piece)
{
    return LETTERS_IN_PIECE * piece->stride;
}

rv_piece *rv_piece_next(const rv_piece *piece)
{
    return piece->next;
}

void **rv_piece_held(rv_piece *piece, int32_t which)
{
    return &piece->held[which];
}

static size_t size_of_piece(int32_t stride)
{
    return sizeof(rv_piece) + (size_t)LETTERS_IN_PIECE * (size_t)stride * sizeof(int64_t);
}

/* Free a piece, and release what the reader attached to it. */
static void drop_piece(rv_monitor *m, rv_piece *piece)
{
    int32_t i;
    for (i = 0; i < 2; i++) {
        if ((piece->held[i] != NULL) && (m->let_go != NULL)) {
            m->let_go(m->let_go_user, piece->held[i]);
        }
    }
    arena_give(&m->memory, piece, size_of_piece(piece->stride));
}

/* Take the oldest piece, which no open attempt needs, out of the list. If notes need it, it moves to
 * `left`; else it is freed. Notes of open attempts may refer to it in both cases, so they are dropped
 * first. */
static void leave_first(rv_monitor *m, noting *n)
{
    rv_piece *piece = n->first;
    n->first = piece->next;
    n->last = (n->first == NULL) ? NULL : n->last;
    n->pinned = (n->pinned == piece) ? NULL : n->pinned;
    n->pieces--;
    if (piece->pinned == m->pins) {
        if ((piece->next != NULL) && (piece->next->pinned != m->pins)) {
            drop_open_notes(m);  /* may refer to both */
            piece->next = NULL; /* the next piece may be freed before this one */
        }
        piece->next_left = m->left;
        m->left = piece;
    } else {
        drop_open_notes(m); /* may refer to it */
        drop_piece(m, piece);
    }
}

/* An empty piece; NULL: memory is short. */
rv_piece *made_piece(rv_monitor *m, int32_t stride)
{
    rv_piece *piece = arena_take(&m->memory, size_of_piece(stride));
    if (piece == NULL) {
        m->spoilt = true;
        return NULL;
    }
    piece->stride = stride;
    return piece;
}

/* An empty piece at the end of a judge's list; NULL: memory is short. */
rv_piece *next_piece(rv_monitor *m, noting *n, int32_t stride)
{
    rv_piece *piece = made_piece(m, stride);
    if (piece == NULL) {
        return NULL;
    }
    if (n->last == NULL) {
        n->first = piece;
    } else {
        n->last->next = piece;
    }
    n->last = piece;
    n->pieces++;
    return piece;
}

void forget_letters(rv_monitor *m, noting *n)
{
    while (n->first != NULL) {
        leave_first(m, n);
    }
}

/* The first instant whose letter is needed: since the start of the oldest attempt, or within `reach` of
 * the last letter, whichever is later. */
static int64_t needed_from(const run *r, int32_t index)
{
    const judge *j = &r->judges[index];
    const noting *n = j->noting;
    const int64_t reach = r->part->forms[r->part->judges[index].form].reach;
    int64_t found = RV_NO_TIME;
    if ((reach < LIMIT) && (n->last != NULL) && (n->last->before != NULL)) {
        found = n->last->before[0] - reach;
    }
    if (!needs_every_position(r, index) && (j->first >= 0)) {
        const int64_t begin = attempt_at(r->home, j->first)->triggered;
        found = (begin > found) ? begin : found;
    }
    return found;
}

/* Drop pieces from the front while the next one still covers `needed`. */
static void drop_letters(rv_monitor *m, noting *n, int64_t needed)
{
    while ((n->first != n->last)
           && ((n->pieces > PIECES_MOST)
               || ((n->first->next->count > 0) && (n->first->next->words[0] <= needed)))) {
        leave_first(m, n);
    }
}

/* Whether a packed truth is UNKNOWN, that is 1: the lower bit of its pair is set. */
static bool is_doubtful(const int64_t *packed, int32_t words)
{
    int32_t i;
    for (i = 0; i < words; i++) {
        if (((uint64_t)packed[i] & (UINT64_MAX / 3U)) != 0U) { /* the lower bit of each pair */
            return true;
        }
    }
    return false;
}

/* Store the letter at position `t`; if something in it is unknown, it may keep open attempts undecided.
 * The slot after the last letter is written first, and kept only if the letter differs. */
void keep_letter(run *r, int32_t index, int64_t t)
{
    rv_monitor *m = r->home->monitor;
    judge *j = &r->judges[index];
    noting *n = j->noting;
    const list propositions = r->part->judges[index].propositions;
    const int32_t words = words_for(propositions.count);
    const int32_t stride = words + 1;
    int64_t *made;
    if ((j->first < 0) && !needs_every_position(r, index)) {
        forget_letters(m, n);
    }
    if (n->first != n->last) {
        drop_letters(m, n, needed_from(r, index));
    }
    if ((n->last == NULL) || (n->last->count == LETTERS_IN_PIECE * stride)) {
        const rv_piece *last = n->last;
        rv_piece *piece = next_piece(m, n, stride);
        if (piece == NULL) {
            return;
        }
        piece->before = (last != NULL) ? &last->words[last->count - stride] : NULL;
    }
    made = &n->last->words[n->last->count];
    made[0] = t;
    pack_truths(r, propositions, false, &made[1]);
    if ((j->first >= 0) && is_doubtful(&made[1], words)
        && ((n->doubts.count == 0) || (n->doubted_at < n->began_at))) {
        note_doubt(r, index, t);
    }
    if (n->last->count > 0) {
        n->last->before = made - stride;
    }
    if ((n->last->before != NULL)
        && ((n->last->before[0] == t)
            || ((GAP(r) > 0)
                && (memcmp(&n->last->before[1], &made[1], (size_t)words * sizeof *made) == 0)))) {
        return; /* the letter has not changed */
    }
    n->last->count += stride;
}

/* Pin the pieces from `first` to the end of a judge's list: from `first` up to the next pinned piece, and
 * from the last pinned piece on. There are no gaps between pinned pieces. */
static void pin(const rv_monitor *m, noting *n, rv_piece *first)
{
    rv_piece *one = first;
    while ((one != NULL) && (one->pinned != m->pins)) {
        one->pinned = m->pins;
        one = one->next;
    }
    one = ((n->pinned != NULL) && (n->pinned->pinned == m->pins)) ? n->pinned->next : NULL;
    while (one != NULL) {
        one->pinned = m->pins;
        one = one->next;
    }
    n->pinned = n->last;
}

/* A span of the letters from `begin` to the last one, shared with the previous span if equal; -1: there
 * are no letters. */
int32_t span_from(rv_monitor *m, noting *n, int64_t begin)
{
    rv_piece *first = n->first;
    span_of_letters *made;
    if (first == NULL) {
        return -1;
    }
    while ((first->next != NULL) && (first->next->count > 0) && (first->next->words[0] <= begin)) {
        first = first->next;
    }
    made = (m->span_count > 0) ? &m->spans[m->span_count - 1] : NULL;
    if ((made == NULL) || (made->first != first) || (made->last != n->last)
        || (made->last_count != n->last->count)) {
        made = enlarged(m, m->spans, &m->span_room, (int64_t)m->span_count + 1, sizeof *made);
        if (made == NULL) {
            return -1;
        }
        m->spans = made;
        made = &m->spans[m->span_count];
        made->first = first;
        made->last = n->last;
        made->last_count = n->last->count;
        m->span_count++;
    }
    if (!m->writes_open_notes) { /* notes of open attempts end with the call */
        pin(m, n, first);
    }
    return m->span_count - 1;
}

/* Copy a span to those that stay, only once: the old span then stores its new index, negated. Returns the
 * new index. */
int32_t keep_span(rv_monitor *m, kept_notes *to, int32_t number)
{
    span_of_letters *old = &m->spans[number];
    if (old->last_count >= 0) {
        to->spans[to->span_count] = *old;
        old->last_count = -1 - to->span_count;
        to->span_count++;
    }
    return -1 - old->last_count;
}

/* Free the letters to which no note refers any more: unpin all, pin those of the remaining spans, free
 * the rest. Spans are taken in reverse order, so for each judge the pinned pieces end with its last span,
 * and reaching a pinned piece ends the walk. */
void pin_kept_letters(rv_monitor *m)
{
    rv_piece **link = &m->left;
    const run *r;
    int32_t i;
    m->pins++;
    for (i = m->span_count - 1; i >= 0; i--) {
        const span_of_letters *own = &m->spans[i];
        rv_piece *one = own->first;
        while ((one != own->last) && (one->pinned != m->pins)) {
            one->pinned = m->pins;
            one = one->next;
        }
        one->pinned = m->pins;
    }
    for (i = 0; i < m->plan.part_count; i++) {
        for (r = m->homes[i].root; r != NULL; r = following(&m->homes[i], r)) {
            int32_t k;
            for (k = 0; k < r->part->plan->judges.count; k++) {
                noting *n = r->judges[k].noting;
                rv_piece *one;
                n->pinned = NULL;
                for (one = n->first; one != NULL; one = one->next) {
                    n->pinned = (one->pinned == m->pins) ? one : n->pinned;
                }
            }
        }
    }
    while (*link != NULL) {
        rv_piece *piece = *link;
        if (piece->pinned == m->pins) {
            link = &piece->next_left;
        } else {
            *link = piece->next_left;
            drop_piece(m, piece);
        }
    }
}

/* No notes are left: free the letters that only they needed. */
void unpin_letters(rv_monitor *m)
{
    while (m->left != NULL) {
        rv_piece *piece = m->left;
        m->left = piece->next_left;
        drop_piece(m, piece);
    }
    m->pins++;
}

/* Rings of truths. */

/* The last entry not after instant `t`, by bisection; NULL: none. */
const int64_t *truths_at(const truths *ring, int32_t words, int64_t t)
{
    int32_t low = 0;
    int32_t high = ring->count;
    if ((high > 0) && (entry_of(ring, high - 1, words)[0] <= t)) { /* the common case */
        return entry_of(ring, high - 1, words);
    }
    while (low < high) {
        const int32_t middle = low + (high - low) / 2;
        if (entry_of(ring, middle, words)[0] <= t) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return (low > 0) ? entry_of(ring, low - 1, words) : NULL;
}

/* Drop the entries that are not needed from `oldest` on: all at or before it except the last. */
void drop_truths(truths *ring, int32_t words, int64_t oldest)
{
    while ((ring->count > 1) && (entry_of(ring, 1, words)[0] <= oldest)) {
        ring->head = (ring->head + 1) & (ring->room - 1);
        ring->count--;
    }
}

/* Double the room; false: memory is short. */
bool grow_truths(rv_monitor *m, truths *ring, int32_t words)
{
    const int32_t room = (ring->room > 0) ? 2 * ring->room : 4;
    const size_t each = ((size_t)words + 1U) * sizeof *ring->words;
    int64_t *made = (room < INT32_MAX / 4) ? arena_take(&m->memory, (size_t)room * each) : NULL;
    int32_t i;
    if (made == NULL) {
        m->spoilt = true;
        return false;
    }
    for (i = 0; i < ring->count; i++) {
        (void)memcpy(&made[(int64_t)i * (words + 1)], entry_of(ring, i, words), each);
    }
    arena_give(&m->memory, ring->words, (size_t)ring->room * each);
    ring->words = made;
    ring->room = room;
    ring->head = 0;
    return true;
}

/* Append an entry; NULL: memory is short. */
int64_t *next_truths(rv_monitor *m, truths *ring, int32_t words)
{
    if ((ring->count == ring->room) && !grow_truths(m, ring, words)) {
        return NULL;
    }
    ring->count++;
    return entry_of(ring, ring->count - 1, words);
}

/* Reset the history of a judge. */
void clear_noting(run *r, int32_t index)
{
    noting *n = r->judges[index].noting;
    if (n != NULL) {
        forget_letters(r->home->monitor, n);
        n->triggers.head = n->triggers.count = 0;
        n->doubts.head = n->doubts.count = 0;
        n->state = -1;
        n->undecidable_since = NEVER;
        n->began_at = RV_NO_TIME;
    }
}
