#include "machine/printer.hpp"

#include <algorithm>

namespace pliant::machine {

std::string_view axis_name(Axis axis) {
    constexpr std::string_view names[axis_count] = {"carriage", "platform", "tower"};
    return names[static_cast<std::size_t>(axis)];
}

const Resin* Printer::find_resin(std::string_view resin) const {
    const auto found = std::find_if(resins.begin(), resins.end(), [&](const Resin& r) { return r.name == resin; });
    return found == resins.end() ? nullptr : &*found;
}

const Vat* Printer::vat_of_slot(int slot) const {
    const auto found = std::find_if(vats.begin(), vats.end(), [&](const Vat& v) { return v.slot == slot; });
    return found == vats.end() ? nullptr : &*found;
}

}  // namespace pliant::machine
