// A checkpoint that a run has left behind: one forgotten option must not throw away hours.
#pragma once

#include <filesystem>
#include <optional>

#include "library/simulation/data.hpp"

namespace pliant::library {

/// The last step that is kept in `folder` of the run of this model's program, if that run is not finished: more than
/// its rest state, and less than its end. Nothing where no such run can be resumed from there.
[[nodiscard]] std::optional<int> unfinished_step(const Model::Data& model, const std::filesystem::path& folder);

}  // namespace pliant::library
