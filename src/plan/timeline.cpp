#include "plan/timeline.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

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

}  // namespace

std::string_view device_name(Device device) {
    constexpr std::array<std::string_view, device_count> names = {"platform", "cleaning vat", "tower",
                                                                  "spray",    "fans",         "light"};
    return names[static_cast<std::size_t>(device)];
}

SwapTimeline longest_swap(const Plan& plan, const machine::Printer& printer) {
    const auto slot = [&](int vat) { return printer.vats[static_cast<std::size_t>(vat)].slot; };
    const auto way = [&](const std::pair<int, int>& c) {
        return std::abs(printer.level_um(slot(c.first)) - printer.level_um(slot(c.second)));
    };
    const auto all = changes(plan);
    const auto found = std::max_element(all.begin(), all.end(), [&](auto& a, auto& b) { return way(a) < way(b); });
    SwapTimeline timeline;
    if (found == all.end()) return timeline;
    timeline.from_slot = slot(found->first);
    timeline.to_slot = slot(found->second);
    Sequence s(printer);
    s.move(machine::Axis::platform, printer.clear_um(0));
    load_vat(s, timeline.from_slot);
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
