/* The positions at which a run can change without a sample. */
#include "attempts/attempts.h"
#include "formulas/formulas.h"
#include "runs/runs.h"

/* The first of start, start + step, ... that is not before `t`. */
static int64_t position_from(int64_t start, int64_t step, int64_t t)
{
    return (step == 1) ? t : start + (t - start + step - 1) / step * step; /* division is slow */
}

/* The first multiple of the gap from `t` on, for t of either sign. */
int64_t tick_from(int64_t gap, int64_t t)
{
    return (t >= 0) ? position_from(0, gap, t) : -((-t) / gap) * gap;
}

/* Whether the episode's attempt has failed, and its obligations would not fail again at once, so that a
 * new attempt may start. */
bool may_go_on(const run *r, int32_t index)
{
    const int32_t again = r->part->judges[index].again;
    return (again >= 0) && (r->judges[index].failed_at < NEVER) && (r->truth[again] != IS_FALSE);
}

/* Drop judges whose episode is over from `failing`. */
void tidy_failing(run *r)
{
    int32_t kept = 0;
    int32_t i;
    for (i = 0; i < r->failing_count; i++) {
        const int32_t index = r->failing[i];
        if (r->judges[index].failed_at < NEVER) {
            r->failing[kept] = index;
            kept++;
        } else {
            r->judges[index].is_failing_listed = false;
        }
    }
    r->failing_count = kept;
}

/* The next position at which an attempt may follow a failure although nothing changes. */
int64_t next_start(const run *r)
{
    const int64_t step = step_of(r);
    int64_t found = NEVER;
    int32_t i;
    for (i = 0; (GAP(r) > 0) && (i < r->failing_count); i++) {
        const int32_t index = r->failing[i];
        if (may_go_on(r, index)) {
            const int64_t ahead = (r->judges[index].failed_at - r->at.position) / step + 1;
            found = least(found, r->at.position + ((ahead > 1) ? ahead : 1) * step);
        }
    }
    return found;
}

/* The next position at which something can change without a sample; NEVER: none. In sampled time only an
 * outage has such positions. */
int64_t next_position(const run *r)
{
    const int64_t gap = GAP(r);
    int64_t found = (gap > 0) ? least(r->at.awaited, r->at.ends_at) : NEVER;
    if (r->at.presence != ARE_THERE) {
        return (r->at.started && (r->at.presence == MAY_BE_THERE)) ? NEVER : r->at.awaited;
    }
    if ((gap > 0) && r->at.started) {
        int64_t change = timers_next(&r->wake);
        if ((r->at.fading_count > 0) || (r->repeating_count > 0) || r->stays_busy) {
            change = least(change, r->at.position + gap);
        }
        if (change < NEVER) {
            found = least(found, position_from(r->at.position, gap, change));
        }
        if (r->failing_count > 0) {
            found = least(found, next_start(r));
        }
        if ((r->cut < NEVER) && (r->cut > r->at.position)) {
            found = least(found, r->cut);
        }
    }
    return found;
}

static bool is_restless(const run *r)
{
    int32_t i;
    for (i = 0; i < r->restless_count; i++) {
        if (r->judges[r->restless[i]].restless) {
            return true;
        }
    }
    return false;
}

/* Set the alarm of a run, given the next position. In sampled time every sample is a position, so
 * anything that is momentary or moves at each position keeps the alarm in the past. */
void set_alarm(run *r, int64_t position)
{
    if (!r->at.started) {
        return;
    }
    r->at.alarm = least(position, timers_next(&r->rules));
    if (GAP(r) == 0) {
        const bool busy = (r->at.fading_count > 0) || (r->repeating_count > 0) || r->stays_busy
                          || (r->part->plan->stateful.count > 0) || is_restless(r)
                          || (r->failing_count > 0) || (r->at.presence != ARE_THERE)
                          || ((r->cut < NEVER) && (r->cut > r->at.position));
        r->at.alarm = busy ? -LIMIT : least(r->at.alarm, timers_next(&r->wake));
    }
}
