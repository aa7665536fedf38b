// The settings that made a job, for the job to keep.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "printing/prepare/make_job.hpp"

namespace pliant::job {

/// What was asked for beside JobSettings.
struct Request {
    std::vector<std::string> inputs;       ///< as given: FILE or MATERIAL=FILE
    std::vector<std::string> assignments;  ///< KEY=VALUE, changes of the robot file
    std::vector<double> turn_deg;          ///< about x, y and z; empty: none
    std::string spacing;                   ///< between copies, with its unit
    int least_layer_um = 0;                ///< of layers that follow the slope; 0: all are alike
    /// Options of supports, raft, hollowing and drains that were given, as they were given.
    std::vector<std::pair<std::string, std::string>> supports{};
    double scale = 1;
    std::vector<double> at_mm{};  ///< of the part's middle from the platform's; empty: in the middle
};

/// settings.json, as docs/reference/job.md describes it. Folders of inputs are left out, so that the same files give
/// the same bytes wherever they lie.
[[nodiscard]] std::string settings_json(const JobSettings& settings, const Request& request);

}  // namespace pliant::job
