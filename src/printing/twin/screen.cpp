#include "printing/twin/screen.hpp"

#include <algorithm>
#include <cmath>

namespace pliant::twin {
namespace {

/// The largest coverage, as a fraction, at which the curve through evenly spaced points is at most `light`.
double coverage_at(const std::vector<double>& grey, double light) {
    const auto above = std::upper_bound(grey.begin(), grey.end(), light);
    if (above == grey.end()) return 1;
    const auto i = static_cast<double>(above - grey.begin() - 1);
    const double low = *(above - 1), high = *above;
    return (i + (light - low) / (high - low)) / static_cast<double>(grey.size() - 1);
}

void append(Runs& runs, const Run& run) {
    if (run.value == 0) return;
    if (!runs.empty() && runs.back().row == run.row && runs.back().end == run.begin && runs.back().value == run.value)
        runs.back().end = run.end;
    else
        runs.push_back(run);
}

}  // namespace

Screen::Screen(const machine::Projector& projector, std::optional<job::Image> mask) : mask_(std::move(mask)) {
    if (projector.grey.empty()) return;
    covered_.emplace();
    for (std::size_t light = 0; light < covered_->size(); ++light)
        (*covered_)[light] =
            static_cast<std::uint8_t>(std::lround(255 * coverage_at(projector.grey, static_cast<double>(light) / 255)));
    (*covered_)[0] = 0;
}

std::uint16_t Screen::coverage_of(int shown, int mask, long& overlit_px) const {
    if (mask == 0) return 0;
    // The shown value is rounded, so the light is known to half a step.
    if (2 * shown > 2 * mask + 1) ++overlit_px;
    const int light = std::min(255, (shown * 255 + mask / 2) / mask);
    return covered_ ? (*covered_)[static_cast<std::size_t>(light)] : static_cast<std::uint16_t>(light);
}

Screen::Picture Screen::coverage(const Runs& shown) const {
    Picture picture;
    if (!covered_ && !mask_) {
        picture.runs = shown;
        return picture;
    }
    for (const Run& run : shown) {
        if (!mask_) {
            append(picture.runs, {run.row, run.begin, run.end, coverage_of(run.value, 255, picture.overlit_px)});
            continue;
        }
        for (int column = run.begin; column < run.end; ++column) {
            const int mask = mask_->at(run.row, column);
            append(picture.runs, {run.row, column, column + 1, coverage_of(run.value, mask, picture.overlit_px)});
        }
    }
    return picture;
}

}  // namespace pliant::twin
