// A job in JSON for the page: manifest, plan, findings of the slicer.
#pragma once

#include <string>

#include "presentation/studio/http.hpp"
#include "presentation/studio/make_session.hpp"

namespace pliant::studio {

/// The answer of GET /api/job. `saved`: it is in the project folder. Cost: that of a plan.
[[nodiscard]] std::string job_json(const OpenJob& open, bool saved);

/// The image of the layer and material named in the request's path.
[[nodiscard]] Response layer_image(OpenJob& open, const Request& request);

/// A whole number without any other characters; -1 for anything else.
[[nodiscard]] int whole_number(std::string_view text);

}  // namespace pliant::studio
