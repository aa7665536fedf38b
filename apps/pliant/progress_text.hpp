// Text of a progress bar.
#pragma once

#include <string>
#include <string_view>

namespace pliant::app {

/// "simulate [=====   ] 42 %, about 20 s left": a stage at `fraction`, in [0, 1], after `elapsed_s`. The remaining time
/// is shown from 3 s and 2 % on: before that the estimate is unreliable.
[[nodiscard]] std::string progress_line(std::string_view stage, double fraction, double elapsed_s);

}  // namespace pliant::app
