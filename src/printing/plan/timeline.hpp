// What each part of the machine does when: the bars of a picture of the plan.
#pragma once

#include <string_view>
#include <vector>

#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::plan {

struct Plan;

enum class Device { platform, carriage, tower, table, pump, fans, light, brush, lift, rail, fork, magnet };
inline constexpr int device_count = 12;

/// What drives an axis: of a wall's retriever lift and rail.
[[nodiscard]] Device device_of(const machine::Printer& printer, machine::Axis axis);

/// What a person calls it.
[[nodiscard]] std::string_view device_name(Device device);

/// A device that is moving or switched on from begin_s to end_s.
struct Stretch {
    Device device = Device::platform;
    double begin_s = 0;
    double end_s = 0;
};

/// One change of vats.
struct SwapTimeline {
    int from_slot = 0;
    int to_slot = 0;
    double seconds = 0;
    std::vector<Device> devices;     ///< that this machine has, but for the light
    std::vector<Stretch> stretches;  ///< in the order of their ends; moves without a pause between them are one
};

/// A vat under the platform for one layer: down, light, up.
struct Visit {
    int layer = 0;
    int slot = 0;
    double begin_s = 0;
    double end_s = 0;
};

/// The whole print.
struct JobTimeline {
    double seconds = 0;
    std::vector<Device> devices;     ///< that this machine has, with the light
    std::vector<Stretch> stretches;  ///< as in SwapTimeline
    std::vector<Visit> visits;       ///< in order; what lies between two is a change of vats
};

/// The whole print, device by device. `job` and `printer` must be those of make_plan(). Cost: that of write_gcode().
[[nodiscard]] JobTimeline job_timeline(const Plan& plan, const job::Manifest& job, const machine::Printer& printer);

/// The first of the changes of vats that take longest; without any swap `stretches` is empty.
/// `printer` must be that of make_plan().
[[nodiscard]] SwapTimeline longest_swap(const Plan& plan, const machine::Printer& printer);

/// One change of vats, from slot to slot.
[[nodiscard]] SwapTimeline swap_timeline(const machine::Printer& printer, int from_slot, int to_slot);

}  // namespace pliant::plan
