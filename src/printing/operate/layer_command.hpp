// A command of the shell after every layer, for a picture of it.
#pragma once

#include <string>

#include "base/core/error.hpp"

namespace pliant::operate {

/// Runs `command` in a shell with the layer's number (from 0) in PLIANT_LAYER and waits until it ends, at most for
/// `most_s`; then it is ended with all that it has started. Errors: it could not be started, failed, or took too long.
[[nodiscard]] Status run_layer_command(const std::string& command, int layer, double most_s = 10);

}  // namespace pliant::operate
