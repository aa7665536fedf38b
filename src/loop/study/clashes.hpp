// Keys and results of a plan that stand in each other's way.
#pragma once

#include <string>
#include <vector>

#include "loop/study/plan.hpp"

namespace pliant::study {

struct Clash {
    std::string where;    ///< "key.pull" or "result.pull": the later of two
    std::string message;  ///< what it clashes with, and what would be right
};

/// Columns of results.csv that two keys or results would share, and keys that set the same thing, however they write
/// it: of these only one value would count. The .toml files of the command tell which spellings mean the same.
[[nodiscard]] std::vector<Clash> clashes(const Plan& plan);

}  // namespace pliant::study
