// A shell command after every layer, for example to take a picture.
#pragma once

#include <string>

#include "base/core/error.hpp"

namespace pliant::operate {

/// Runs `command` in a shell with the layer's number (from 0) in PLIANT_LAYER and waits for it, at most `most_s`; then
/// it is killed with all its child processes. Errors: it could not be started, failed, or took too long.
[[nodiscard]] Status run_layer_command(const std::string& command, int layer, double most_s = 10);

}  // namespace pliant::operate
