// A job as a page is told of it: manifest, plan, what the slicer has found.
#pragma once

#include <string>

#include "presentation/studio/http.hpp"
#include "presentation/studio/make_session.hpp"

namespace pliant::studio {

/// What GET /api/job answers. `saved`: it lies in the project folder. Cost: that of a plan.
[[nodiscard]] std::string job_json(const OpenJob& open, bool saved);

/// The image of the layer and the material that the request's path names.
[[nodiscard]] Response layer_image(OpenJob& open, const Request& request);

/// A whole number without anything around it; -1 for anything else.
[[nodiscard]] int whole_number(std::string_view text);

}  // namespace pliant::studio
