#include "printing/plan/timeline.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "printing/plan/plan.hpp"
#include "printing/plan/print_sequence.hpp"
#include "printing/plan/swap.hpp"

namespace pliant::plan {
namespace {

/// The swaps of a plan in order, as indices into Printer::vats.
std::vector<std::pair<int, int>> changes(const Plan& plan) {
    std::vector<std::pair<int, int>> all;
    int loaded = -1;
    for (const VatList& layer : plan.order) {
        for (const int vat : layer) {
            if (loaded >= 0 && loaded != vat) all.emplace_back(loaded, vat);
            loaded = vat;
        }
    }
    return all;
}

std::vector<Device> devices_of(const machine::Printer& printer) {
    std::vector<Device> devices;
    using machine::Axis;
    for (const Axis axis : {Axis::platform, Axis::carriage, Axis::tower, Axis::table}) {
        if (printer.axis(axis).present()) devices.push_back(device_of(printer, axis));
    }
    if (printer.store() == machine::Store::wall) devices.push_back(Device::fork);
    if (printer.hooks.magnet.present()) devices.push_back(Device::magnet);
    if (printer.has_brush()) devices.push_back(Device::brush);
    if (!printer.pump.on.empty()) devices.push_back(Device::pump);
    if (!printer.fans.empty()) devices.push_back(Device::fans);
    return devices;
}

}  // namespace

Device device_of(const machine::Printer& printer, machine::Axis axis) {
    const bool wall = printer.store() == machine::Store::wall;
    switch (axis) {
        case machine::Axis::carriage:
            return Device::carriage;
        case machine::Axis::tower:
            return wall ? Device::lift : Device::tower;
        case machine::Axis::table:
            return wall ? Device::rail : Device::table;
        case machine::Axis::platform:
            break;
    }
    return Device::platform;
}

std::string_view device_name(Device device) {
    constexpr std::array<std::string_view, device_count> names = {"platform", "cleaning vat", "tower", "table",
                                                                  "spray",    "fans",         "light", "brush",
                                                                  "lift",     "rail",         "fork",  "magnet"};
    return names[static_cast<std::size_t>(device)];
}

SwapTimeline longest_swap(const Plan& plan, const machine::Printer& printer) {
    const auto all = changes(plan);
    std::map<std::pair<int, int>, double> seconds;
    for (const auto& change : all) {
        double& took = seconds[change];
        if (took == 0)
            took = swap_seconds(printer, printer.slot_of(change.first), printer.slot_of(change.second)).total;
    }
    constexpr double same = 1e-9;  // tolerance for sums of seconds in different orders
    const auto found =
        std::max_element(all.begin(), all.end(), [&](auto& a, auto& b) { return seconds[a] + same < seconds[b]; });
    if (found == all.end()) return {};
    return swap_timeline(printer, printer.slot_of(found->first), printer.slot_of(found->second));
}

SwapTimeline swap_timeline(const machine::Printer& printer, int from_slot, int to_slot) {
    SwapTimeline timeline;
    timeline.from_slot = from_slot;
    timeline.to_slot = to_slot;
    timeline.devices = devices_of(printer);
    Sequence s = standing_at(printer, from_slot);
    s.record(&timeline.stretches);
    swap_vat(s, from_slot, to_slot);
    timeline.seconds = s.seconds().total;
    return timeline;
}

JobTimeline job_timeline(const Plan& plan, const job::Manifest& job, const machine::Printer& printer) {
    JobTimeline timeline;
    timeline.devices = devices_of(printer);
    timeline.devices.push_back(Device::light);
    const machine::Printer filled = filled_printer(plan, job, printer);
    timeline.seconds = print_sequence(plan, job, filled, &timeline).seconds().total;
    return timeline;
}

}  // namespace pliant::plan
