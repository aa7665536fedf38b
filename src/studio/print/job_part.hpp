// The part that a job prints, coarse enough to be sent to a page and drawn at once.
#pragma once

#include <string>

#include "base/core/error.hpp"
#include "studio/make/make_session.hpp"

namespace pliant::studio {

/// A packet in the format of GrowingPart::packet(), of kind "drawn", cached with the job. If there are many layers only
/// some 250 of them are decoded, which takes a second or two for full HD. Errors: an image cannot be read.
[[nodiscard]] Result<std::string> job_part(OpenJob& open);

}  // namespace pliant::studio
