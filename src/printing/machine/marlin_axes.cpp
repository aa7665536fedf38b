#include "printing/machine/marlin_axes.hpp"

#include <algorithm>
#include <utility>

namespace pliant::machine {

std::vector<const AxisSpec*> extra_axes(const Printer& printer) {
    std::vector<const AxisSpec*> axes;
    for (const AxisSpec& axis : printer.axes) {
        const std::size_t at = marlin_letters.find(axis.letter);
        if (at != std::string_view::npos && at >= 3) axes.push_back(&axis);
    }
    std::sort(axes.begin(), axes.end(), [](const AxisSpec* a, const AxisSpec* b) {
        return std::pair(!a->rotary, a->letter) < std::pair(!b->rotary, b->letter);
    });
    return axes;
}

std::optional<char> marlin_place(const Printer& printer, const AxisSpec& axis) {
    const std::size_t letter = marlin_letters.find(axis.letter);
    if (letter < 3) return axis.letter;
    const std::vector<const AxisSpec*> extra = extra_axes(printer);
    const auto at = static_cast<std::size_t>(std::find(extra.begin(), extra.end(), &axis) - extra.begin());
    if (at >= std::min(extra.size(), marlin_extra_places.size())) return std::nullopt;
    return marlin_extra_places[at];
}

}  // namespace pliant::machine
