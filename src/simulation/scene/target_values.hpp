// Every value that an actuator is asked for, wherever it is written, so that one limit can be held against all.
#pragma once

#include <fmt/format.h>

#include <string>
#include <vector>

#include "robot/description/goal.hpp"

namespace pliant::robot {

struct TargetValue {
    std::string where;  ///< begins a message: "program.key at 2 s: "; "" for what the target says
    double value = 0;   ///< without the offset
};

/// Those of a cable or chamber: at rest, if an offset acts there; of the target, the keys and the range.
template <class Spec>
[[nodiscard]] std::vector<TargetValue> target_values(const Spec& spec) {
    const auto& target = spec.target;
    std::vector<TargetValue> values = {{"", target.value}};
    using Kind = decltype(target.kind);
    const double rest = target.kind == Kind{} ? 1 : 0;  // a ratio, the first of the kinds
    if (target.offset != 0) values.push_back({"target.offset: ", rest});
    for (std::size_t k = 0; target.keys && k < target.keys->value.size(); ++k)
        values.push_back({fmt::format("program.key at {:g} s: ", target.keys->time[k]), target.keys->value[k]});
    if (spec.steering) {
        values.push_back({"range: ", spec.steering->low});
        values.push_back({"range: ", spec.steering->high});
    }
    return values;
}

/// Ends the words of a value to which an offset has been added.
[[nodiscard]] inline std::string with_offset(double offset) {
    return offset != 0 ? " with its offset" : "";
}

}  // namespace pliant::robot
