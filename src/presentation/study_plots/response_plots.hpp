// Response plots of a study: its results over its keys.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "loop/study/folder.hpp"
#include "loop/study/plan.hpp"

namespace pliant::report {

struct ResponsePlot {
    std::string file;  ///< "tension over modulus.png", with characters allowed on every file system
    std::string png;
};

/// Limit: only the plots of the first results are drawn.
inline constexpr std::size_t most_response_plots = 60;

/// One plot for each result and each numeric key: a point for each completed row; a line if only one key varies.
[[nodiscard]] Result<std::vector<ResponsePlot>> response_plots(const study::Plan& plan, const study::Collected& rows);

}  // namespace pliant::report
