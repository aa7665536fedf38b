// What a progress bar says.
#pragma once

#include <string>
#include <string_view>

namespace pliant::app {

/// "simulate [=====   ] 42 %, about 20 s left": a stage that has reached `fraction`, in [0, 1], after `elapsed_s`. What
/// is left is told from 3 s and 2 % on: before that it would be a guess.
[[nodiscard]] std::string progress_line(std::string_view stage, double fraction, double elapsed_s);

}  // namespace pliant::app
