#include "plan/timeline.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "plan/plan.hpp"
#include "plan/swap.hpp"

namespace pliant::plan {
namespace {

/// The changes of vats of a plan in order, as indices into Printer::vats.
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
    for (const auto& [axis, device] : {std::pair{machine::Axis::platform, Device::platform},
                                       {machine::Axis::carriage, Device::carriage},
                                       {machine::Axis::tower, Device::tower},
                                       {machine::Axis::table, Device::table}}) {
        if (printer.axis(axis).present()) devices.push_back(device);
    }
    if (!printer.pump.on.empty()) devices.push_back(Device::pump);
    if (!printer.fans.on.empty()) devices.push_back(Device::fans);
    return devices;
}

}  // namespace

std::string_view device_name(Device device) {
    constexpr std::array<std::string_view, device_count> names = {"platform", "cleaning vat", "tower", "table",
                                                                  "spray",    "fans",         "light"};
    return names[static_cast<std::size_t>(device)];
}

SwapTimeline longest_swap(const Plan& plan, const machine::Printer& printer) {
    const auto slot = [&](int vat) { return printer.vats[static_cast<std::size_t>(vat)].slot; };
    const auto all = changes(plan);
    std::map<std::pair<int, int>, double> seconds;
    for (const auto& change : all) {
        double& took = seconds[change];
        if (took == 0) took = swap_seconds(printer, slot(change.first), slot(change.second)).total;
    }
    constexpr double same = 1e-9;  // of seconds that were added up differently
    const auto found =
        std::max_element(all.begin(), all.end(), [&](auto& a, auto& b) { return seconds[a] + same < seconds[b]; });
    SwapTimeline timeline;
    if (found == all.end()) return timeline;
    timeline.from_slot = slot(found->first);
    timeline.to_slot = slot(found->second);
    timeline.devices = devices_of(printer);
    Sequence s = standing_at(printer, timeline.from_slot);
    const double begin_s = s.seconds().total;
    s.record(&timeline.stretches);
    swap_vat(s, timeline.from_slot, timeline.to_slot);
    timeline.seconds = s.seconds().total - begin_s;
    for (Stretch& stretch : timeline.stretches) {
        stretch.begin_s -= begin_s;
        stretch.end_s -= begin_s;
    }
    return timeline;
}

}  // namespace pliant::plan
