/* Ranges of positions, in order, none touching another. */
#ifndef RVMON_RANGES_H
#define RVMON_RANGES_H

#include "state.h"

int32_t range_from(const ranges *r, int64_t position);
int32_t range_around(const ranges *r, int64_t position);
int64_t last_up_to(const ranges *r, int64_t position);
void ranges_put(rv_monitor *m, ranges *r, int32_t place, int64_t first, int64_t last);
void ranges_insert(rv_monitor *m, ranges *r, int32_t i, int64_t first, int64_t last);
void ranges_cut(rv_monitor *m, ranges *r, int64_t first, int64_t last);
void ranges_drop(ranges *r, int64_t before);
void ranges_empty(ranges *r);
void ranges_copy(rv_monitor *m, ranges *made, const ranges *r);
bool ranges_alike(const ranges *one, const ranges *other);

#endif
