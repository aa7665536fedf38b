// A job in JSON for the page: manifest, plan, findings of the slicer.
#pragma once

#include <string>

#include "studio/base/http.hpp"
#include "studio/make/make_session.hpp"

namespace pliant::studio {

/// The answer of GET /api/job. `saved`: it is in the project folder. Cost: that of a plan.
[[nodiscard]] std::string job_json(const OpenJob& open, bool saved);

/// Whether a request names the job that it means, by its key in ?job=; only then may browsers keep the answer.
[[nodiscard]] bool names_job(const Request& request);
/// Whether it means another job than this one, as a page may that has not yet heard of a new one.
[[nodiscard]] bool is_of_another_job(const OpenJob& open, const Request& request);

/// The image of the layer and material named in the request's path; 204 if it is_of_another_job.
[[nodiscard]] Response layer_image(OpenJob& open, const Request& request);

/// A whole number without any other characters; -1 for anything else.
[[nodiscard]] int whole_number(std::string_view text);

}  // namespace pliant::studio
