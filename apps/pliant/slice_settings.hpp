// The options of `pliant slice`, and what they ask the slicer for.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "command.hpp"
#include "job/make_job.hpp"
#include "job/settings_record.hpp"
#include "machine/printer.hpp"
#include "slice_input.hpp"

namespace pliant::app {

struct SliceOptions {
    std::vector<std::string> inputs;
    std::string printer;
    std::string layer, least_layer;
    std::string job;
    std::string picture;
    std::vector<std::string> assignments, resins, interlocks, overlaps, exposures;
    int copies = 1;
    std::string spacing = "2 mm";
    std::vector<double> turn;
    std::string least_feature;
    bool no_anti_alias = false;
    double threshold = 0.5;
    std::string support, support_angle, support_spacing, support_tip, support_pillar, lift, raft;
    std::string hollow, drain;
    Output output;
};

/// All that follows from options, drawing and printer before the part is placed: materials with resins and exposures,
/// raster, layer height, compensations, pairs, light. `drawing.warnings` tells what was assumed. Errors name the
/// option.
[[nodiscard]] Result<job::JobSettings> job_settings(const SliceOptions& options, const machine::Printer& printer,
                                                    Drawing& drawing);

/// Turns the part, lays out its copies, stands them on the platform (or above it, on supports), gives layers their
/// heights, hollows the part out and adds supports, as far as options ask for it. Lines of what was made go to `notes`.
[[nodiscard]] Status arrange(const SliceOptions& options, job::JobSettings& settings, Drawing& drawing,
                             std::vector<std::string>& notes, Progress& progress);

/// What settings.json keeps of the options.
[[nodiscard]] job::Request request_of(const SliceOptions& options, const job::JobSettings& settings);

/// The options as `pliant slice --help` shows them.
void add_slice_options(CLI::App& command, SliceOptions& options);

}  // namespace pliant::app
