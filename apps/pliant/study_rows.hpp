// The worker process that runs rows of a study: this program, started by itself.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pliant::app {

/// The first argument of such a process; the second is "one-core" or "all-cores".
inline constexpr std::string_view study_rows_word = "--study-rows";

/// Runs rows received over standard input, which is a socket, until it closes.
int serve_study_rows(const std::vector<std::string>& words);

}  // namespace pliant::app
