// When each part of the machine works: the bars of a chart of the plan.
#pragma once

#include <string_view>
#include <vector>

#include "printing/job/job.hpp"
#include "printing/machine/printer.hpp"

namespace pliant::plan {

struct Plan;

enum class Device { platform, carriage, tower, table, pump, fans, light, brush, lift, rail, fork, magnet };
inline constexpr int device_count = 12;

/// The device that drives an axis: of a wall's retriever, lift and rail.
[[nodiscard]] Device device_of(const machine::Printer& printer, machine::Axis axis);

/// Its name for people.
[[nodiscard]] std::string_view device_name(Device device);

/// A device that moves or is switched on from begin_s to end_s.
struct Stretch {
    Device device = Device::platform;
    double begin_s = 0;
    double end_s = 0;
};

/// One swap.
struct SwapTimeline {
    int from_slot = 0;
    int to_slot = 0;
    double seconds = 0;
    std::vector<Device> devices;     ///< that this machine has, without the light
    std::vector<Stretch> stretches;  ///< sorted by end; consecutive moves without a pause are merged
};

/// A vat under the platform for one layer: down, exposure, up.
struct Visit {
    int layer = 0;
    int slot = 0;
    double begin_s = 0;
    double end_s = 0;
};

/// The whole print.
struct JobTimeline {
    double seconds = 0;
    std::vector<Device> devices;     ///< that this machine has, including the light
    std::vector<Stretch> stretches;  ///< as in SwapTimeline
    std::vector<Visit> visits;       ///< in order; between two of them is a vat change
};

/// The whole print by device. `job` and `printer` must be those of make_plan(). Cost: that of write_gcode().
[[nodiscard]] JobTimeline job_timeline(const Plan& plan, const job::Manifest& job, const machine::Printer& printer);

/// The longest swap (the first of several); without any swap `stretches` is empty.
/// `printer` must be that of make_plan().
[[nodiscard]] SwapTimeline longest_swap(const Plan& plan, const machine::Printer& printer);

/// One swap, from slot to slot.
[[nodiscard]] SwapTimeline swap_timeline(const machine::Printer& printer, int from_slot, int to_slot);

}  // namespace pliant::plan
