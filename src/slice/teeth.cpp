#include "slice/teeth.hpp"

#include <algorithm>

#include "slice/run_set.hpp"

namespace pliant::slice {
namespace {

/// Runs of an image inside a set, or outside of it.
void add_masked(const RunImage& image, int row, const RunSet& mask, bool inside, std::vector<Run>& runs) {
    const auto spans = mask.row(row);
    auto span = spans.begin();
    for (const Run& run : image.row(row)) {
        int at = run.begin;
        while (at < run.end) {
            while (span != spans.end() && span->end <= at) ++span;
            const bool in = span != spans.end() && span->begin <= at;
            const int change = span == spans.end() ? run.end : in ? span->end : span->begin;
            const int end = std::min<int>(run.end, change);
            if (in == inside)
                runs.push_back({static_cast<std::uint16_t>(at), static_cast<std::uint16_t>(end), run.value});
            at = end;
        }
    }
}

RunImage image_of(const RunImage& like, int first_row, int end_row, const auto& fill_row) {
    RunImage result(like.width_px(), like.height_px());
    std::vector<Run> runs;
    for (int row = first_row; row < end_row; ++row) {
        runs.clear();
        fill_row(row, runs);
        std::sort(runs.begin(), runs.end(), [](const Run& l, const Run& r) { return l.begin < r.begin; });
        for (const Run& run : runs) result.append(row, run.begin, run.end, run.value);
    }
    return result;
}

MaterialImage* find(ComposedLayer& layer, int material) {
    const auto found = std::find_if(layer.images.begin(), layer.images.end(),
                                    [&](const MaterialImage& m) { return m.material == material; });
    return found == layer.images.end() ? nullptr : &*found;
}

}  // namespace

Status check(const Teeth& teeth) {
    if (teeth.first == teeth.second)
        return input_error("interlock '{}' with '{}': two different materials are needed", teeth.first, teeth.second);
    if (teeth.depth_px < 1 || teeth.depth_px > 1000)
        return input_error("interlock '{}' with '{}': depth of {} pixels: must be 1 to 1000", teeth.first, teeth.second,
                           teeth.depth_px);
    if (teeth.layers < 1 || teeth.layers > 10000)
        return input_error("interlock '{}' with '{}': {} layers: must be 1 to 10000", teeth.first, teeth.second,
                           teeth.layers);
    return {};
}

void take_teeth(ComposedLayer& layer, int taker, int giver, int depth_px) {
    MaterialImage *to = find(layer, taker), *from = find(layer, giver);
    if (to == nullptr || from == nullptr) return;
    const RunSet taken = common(grown(RunSet::lit(to->image), depth_px), RunSet::lit(from->image));
    if (taken.empty()) return;
    const int first = std::min(to->image.first_row(), from->image.first_row());
    const int end = std::max(to->image.end_row(), from->image.end_row());
    RunImage more = image_of(to->image, first, end, [&](int row, std::vector<Run>& runs) {
        runs.assign(to->image.row(row).begin(), to->image.row(row).end());
        add_masked(from->image, row, taken, true, runs);
    });
    from->image = image_of(from->image, first, end,
                           [&](int row, std::vector<Run>& runs) { add_masked(from->image, row, taken, false, runs); });
    to->image = std::move(more);
    to->value_sum = to->image.value_sum();
    from->value_sum = from->image.value_sum();
    std::erase_if(layer.images, [](const MaterialImage& m) { return m.image.blank(); });
}

}  // namespace pliant::slice
