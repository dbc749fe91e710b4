/* Failures that time alone causes, one after the other, while no input comes. When there are many, most
 * are only counted, so that a stamp that leaps by years costs little. */
#include "attempts/attempts.h"
#include "formulas/formulas.h"
#include "runs/runs.h"

/* While no input comes, REPEATS_REPORTED successive failures of a judge are reported one by one, and
 * REPEATS_OF_ALL of all judges and runs of a part. The rest, except for the last REPEATS_LEFT of each, are
 * only counted: `always within 3 s e` fails 500 million times in fifty years. COUNTS_LEFT keeps counts
 * within 32 bits. */
enum { REPEATS_REPORTED = 1000, REPEATS_OF_ALL = 100000, REPEATS_LEFT = 2, COUNTS_LEFT = 1048576 };

void begin_silence(home *h, int64_t from, int64_t until)
{
    h->silence.from = from;
    h->silence.until = until;
    h->silence.reported = 0;
}

void end_silence(home *h)
{
    h->silence.until = -LIMIT;
}

/* Whether everything that the attempts of a run read stays the same without input, except by timers. */
static bool is_silent(const run *r)
{
    return (GAP(r) > 0) && (r->margins == NULL) && (r->at.presence == ARE_THERE)
           && (r->at.fading_count + r->at.fresh_count == 0) && !r->opening && !r->stays_busy;
}

/* The last instant up to which everything that the attempts of a run read surely stays the same. A run of
 * captured values also depends on its parent, which may make these values unknown. */
static int64_t same_until(const run *r)
{
    const int64_t own = least(timers_next(&r->wake), r->at.ends_at);
    const int64_t due = (r->parent != NULL) ? least(own, r->parent->at.alarm) : own;
    return least(r->home->silence.until, due - 1);
}

void forget_repeats(home *h)
{
    h->silence.count = 0;
    h->silence.total = 0;
}

/* Count failed attempts that are not created. They are numbered together with the other attempts of this
 * call, so that each later attempt gets the number that it would have had. */
static void count_captured(home *h, const repetition *found)
{
    silence *s = &h->silence;
    if (s->count == s->room) {
        repetition *made = enlarged(h->monitor, s->counted, &s->room, (int64_t)s->count + 1, sizeof *made);
        if (made == NULL) {
            return;
        }
        s->counted = made;
    }
    s->counted[s->count] = *found;
    s->count++;
    s->total += found->count;
    h->failed += (uint32_t)found->count;
}

/* Count attempts of a run that all fail: one starts at `t`, then one every `period`. Numbers have 32 bits,
 * so the count is capped. */
static void count_repeats(run *r, int32_t index, int64_t t, int64_t period, int64_t many)
{
    judge *j = &r->judges[index];
    home *h = r->home;
    const bool apart = r->part->plan->captured > 0;
    const int64_t so_far = apart ? (int64_t)h->count + h->silence.total : (int64_t)j->count;
    const int64_t left = (int64_t)(UINT32_MAX - COUNTS_LEFT) - so_far;
    const int64_t counted = (left > 0) ? least(many, left) : 0;
    if (apart) {
        const repetition found = {t, period, counted, r->rank};
        count_captured(h, &found);
    } else {
        j->count += (uint32_t)counted;
        j->failed += (uint32_t)counted;
    }
}

/* If an episode would fail and restart very often before the next input, count these failures instead of
 * executing them; false if another attempt has to start at `t`.
 *
 * An attempt that starts at `t` finds the same inputs as the last one, which started in the same silence:
 * no attempt is open, and nothing that it reads changes before the next timer. So it fails after the same
 * time, and so do all others up to that timer. */
bool passes_repeats_over(run *r, int32_t index, int64_t t)
{
    judge *j = &r->judges[index];
    silence *s = &r->home->silence;
    const int64_t before = j->again_at;
    const int64_t period = t - before;
    const int64_t until = (r->cut < NEVER) ? t : same_until(r);
    int64_t many;
    j->again_at = t;
    if ((before <= s->from) || has_attempts(j) || needs_every_position(r, index) || !is_sure(r, index)
        || !is_silent(r)) {
        return false;
    }
    many = (until > t) ? (until - t) / period - REPEATS_LEFT : 0;
    if (((many <= REPEATS_REPORTED) || ((t - s->from) / period < REPEATS_REPORTED))
        && ((many <= 0) || (s->reported < REPEATS_OF_ALL))) {
        s->reported++;
        return false;
    }
    count_repeats(r, index, t, period, many);
    j->failed_at += many * period;
    j->again_at = t + (many - 1) * period;
    return true;
}

/* How many of the attempts that were only counted come before an attempt. */
int64_t counted_before(home *h, numbering *n, int32_t at)
{
    silence *s = &h->silence;
    const captured_attempt *own = &h->captured_attempts[at];
    const int64_t t = own->became;
    int64_t found = 0;
    int32_t i;
    while ((n->started < s->count) && (s->counted[n->started].first <= t)) {
        n->started++;
    }
    for (i = n->over; i < n->started; i++) {
        const repetition x = s->counted[i];
        const int64_t since = t - x.first;
        if (since > (x.count - 1) * x.period) {
            s->counted[i] = s->counted[n->over];
            n->over++;
            n->before += x.count;
        } else {
            const bool ties = (since % x.period == 0)
                              && ((attempt_at(h, at)->triggered < t) || (own->judge->rank <= x.rank));
            found += since / x.period + (ties ? 0 : 1);
        }
    }
    return n->before + found;
}
