#include "measures.hpp"

#include <array>
#include <string_view>

namespace pliant::python {

Measure measure_of(const MeasureTuple& tuple) {
    static constexpr std::array<std::string_view, 12> kinds = {
        "marker",       "tension",       "pressure",     "length",   "length_ratio",  "volume",
        "volume_ratio", "spring_length", "spring_force", "reaction", "contact_force", "self_contact"};
    const auto& [kind, name, direction] = tuple;
    for (std::size_t k = 0; k < kinds.size(); ++k)
        if (kinds[k] == kind) return {static_cast<Measure::Of>(k), name, direction};
    std::string known;
    for (const std::string_view one : kinds) known += (known.empty() ? "" : ", ") + std::string(one);
    throw Failure(Failure::Kind::input, "\"" + kind + "\" cannot be measured; write one of " + known);
}

}  // namespace pliant::python
