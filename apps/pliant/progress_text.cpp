#include "progress_text.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace pliant::app {
namespace {

constexpr double told_after_s = 3, told_from = 0.02;

std::string rounded_time(double seconds) {
    return seconds < 100 ? fmt::format("about {:.0f} s", std::max(seconds, 1.0))
                         : fmt::format("about {:.0f} min", seconds / 60);
}

}  // namespace

std::string progress_line(std::string_view stage, double fraction, double elapsed_s) {
    const double share = std::clamp(fraction, 0.0, 1.0);
    const std::string filled(static_cast<std::size_t>(30 * share), '=');
    std::string line = fmt::format("{:>9} [{:<30}] {:3.0f} %", stage, filled, 100 * share);
    if (elapsed_s >= told_after_s && share >= told_from && share < 1)
        line += fmt::format(", {} left", rounded_time(elapsed_s * (1 - share) / share));
    return line;
}

}  // namespace pliant::app
