// A thin C++11 wrapper of core.h: a movable Monitor that owns an rv_monitor and frees it, and functions
// that build updates. Nothing here throws; memory comes from malloc, or from a block of the caller's.
#ifndef RVMON_CORE_HPP
#define RVMON_CORE_HPP

#include "core.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <initializer_list>
#include <utility>

namespace rvmon {

// Updates for Monitor::step. A NaN is an unknown value.
inline rv_update whole(std::int32_t signal, std::int64_t value)
{
    rv_update made = {signal, RV_SAYS_YES, {RV_WHOLE, {0}}, nullptr};
    made.value.as.whole = value;
    return made;
}

inline rv_update unknown(std::int32_t name)
{
    return {name, RV_SAYS_UNKNOWN, {RV_UNKNOWN, {0}}, nullptr};
}

inline rv_update real(std::int32_t signal, double value)
{
    rv_update made = unknown(signal);
    if (value == value) {
        made.says = RV_SAYS_YES;
        made.value.kind = RV_REAL;
        made.value.as.real = value;
    }
    return made;
}

inline rv_update occurs(std::int32_t event, const rv_number *fields = nullptr)
{
    return {event, RV_SAYS_YES, {RV_UNKNOWN, {0}}, fields};
}

class Monitor {
public:
    // Memory from the heap. The plan is not copied: it has to outlive the monitor.
    Monitor(const void *plan, std::size_t size)
        : monitor_(rv_new(plan, size, rv_memory{std::malloc, std::realloc, std::free, nullptr, 0}))
    {
    }

    // Memory from a block of `room` bytes, which has to outlive the monitor.
    Monitor(const void *plan, std::size_t size, void *block, std::size_t room)
        : monitor_(rv_new(plan, size, rv_memory{nullptr, nullptr, nullptr, block, room}))
    {
    }

    Monitor(Monitor &&other) noexcept : monitor_(other.monitor_) { other.monitor_ = nullptr; }
    Monitor &operator=(Monitor &&other) noexcept
    {
        std::swap(monitor_, other.monitor_);
        return *this;
    }
    Monitor(const Monitor &) = delete;
    Monitor &operator=(const Monitor &) = delete;
    ~Monitor() { rv_free(monitor_); }

    // False: the plan is invalid, or memory was short; then nothing else may be called.
    explicit operator bool() const { return monitor_ != nullptr; }

    int step(std::int64_t t, std::initializer_list<rv_update> updates)
    {
        return rv_step(monitor_, t, updates.begin(), static_cast<std::int32_t>(updates.size()));
    }

    int advance(std::int64_t t) { return rv_advance(monitor_, t); }
    int lose(std::int64_t since, std::initializer_list<std::int32_t> names)
    {
        return rv_lose(monitor_, since, names.begin(), static_cast<std::int32_t>(names.size()));
    }

    int found(std::int64_t at, std::initializer_list<std::int32_t> names)
    {
        return rv_found(monitor_, at, names.begin(), static_cast<std::int32_t>(names.size()));
    }

    int finish(std::int64_t t = RV_NO_TIME) { return rv_finish(monitor_, t); }
    int reset() { return rv_reset(monitor_); }

    // Call `take(const rv_record &)` for each attempt decided since the last call.
    template <typename Take> void records(Take take)
    {
        const rv_record *records = nullptr;
        const std::int64_t count = rv_records(monitor_, &records);
        for (std::int64_t i = 0; i < count; i++) {
            take(records[i]);
        }
        rv_forget_records(monitor_);
    }

    int verdict(std::int32_t requirement) const { return rv_verdict(monitor_, requirement); }

    // For everything else that core.h offers; the Monitor keeps owning it.
    rv_monitor *get() const { return monitor_; }

private:
    rv_monitor *monitor_;
};

} // namespace rvmon

#endif
