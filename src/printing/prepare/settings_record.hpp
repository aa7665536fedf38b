// The settings that made a job, recorded in the job.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "printing/prepare/make_job.hpp"

namespace pliant::job {

/// What was requested in addition to JobSettings.
struct Request {
    std::vector<std::string> inputs;       ///< as given: FILE or MATERIAL=FILE
    std::vector<std::string> assignments;  ///< KEY=VALUE, changes of the robot file
    std::vector<double> turn_deg;          ///< about x, y and z; empty: none
    std::string spacing;                   ///< between copies, with its unit
    int least_layer_um = 0;                ///< minimum for adaptive layers; 0: all layers are equal
    /// Options given for supports, raft, hollowing and drains, verbatim.
    std::vector<std::pair<std::string, std::string>> supports{};
    double scale = 1;
    std::vector<double> at_mm{};  ///< part's centre from the platform's; empty: centred
};

/// settings.json, as docs/reference/job.md describes it. Folders of inputs are left out, so that the same files give
/// the same bytes wherever they are.
[[nodiscard]] std::string settings_json(const JobSettings& settings, const Request& request);

}  // namespace pliant::job
