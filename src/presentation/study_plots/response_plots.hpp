// Plots of a study: its results over its keys.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "loop/study/folder.hpp"
#include "loop/study/plan.hpp"

namespace pliant::report {

struct ResponsePlot {
    std::string file;  ///< "tension over modulus.png", with letters that every file system takes
    std::string png;
};

/// At most so many are drawn: those of the first results.
inline constexpr std::size_t most_response_plots = 60;

/// One for each result and each key of numbers: a point for each row that is done; a line where one key alone varies.
[[nodiscard]] Result<std::vector<ResponsePlot>> response_plots(const study::Plan& plan, const study::Collected& rows);

}  // namespace pliant::report
