// A job as it will stand, coarse enough to be sent to a page and drawn in one piece.
#pragma once

#include <string>

#include "base/core/error.hpp"
#include "presentation/studio/make_session.hpp"

namespace pliant::studio {

/// A packet as GrowingPart::packet() makes it, of kind "drawn", kept with the job. Of many layers every so many are
/// looked at: some 250 images are decoded, which takes a second or two for full HD. Errors: an image cannot be read.
[[nodiscard]] Result<std::string> job_part(OpenJob& open);

}  // namespace pliant::studio
