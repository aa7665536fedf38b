// The positions that markers can reach within the ranges of the inputs, and the tensions and pressures there.
//
// The boundary of the workspace lies among the images of the sheets of the input ranges, on which two inputs vary and
// all others are at one end, and of points where the motion folds back. Each sheet is solved on a grid, from the corner
// nearest to rest and then from neighbour to neighbour; further inputs, spread evenly, sample the interior.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/core/progress.hpp"
#include "simulation/inverse/input_space.hpp"

namespace pliant::sim::inverse {

struct WorkspaceOptions {
    int side = 9;       ///< samples along each input of a sheet; at least 2
    int between = 100;  ///< number of further samples, spread over the ranges; 0 or more
};

struct WorkspaceSample {
    std::vector<double> values;                    ///< (inputs) in the units of the targets
    bool found = false;                            ///< an equilibrium was found; otherwise everything below is empty
    std::vector<Vec3> markers;                     ///< (markers) m
    std::vector<double> tensions_N, pressures_Pa;  ///< (cables), (chambers)
};

/// An independent piece of the work: a sheet, or a group of further samples.
struct WorkspacePiece {
    int rows = 0, columns = 0;  ///< of a sheet's grid, stored row by row; 0: not a sheet. With one input: one row
    std::vector<WorkspaceSample> samples;
    std::string reason{};  ///< why the first sample for which no equilibrium was found has none; empty if all have one
};

struct Workspace {
    std::vector<WorkspacePiece> pieces;
    bool cancelled = false;
};

/// With more inputs than this there are too many sheets: only the spread samples are solved.
inline constexpr std::size_t most_inputs_with_sheets = 5;

/// Error: with these inputs and options there would be no sample.
[[nodiscard]] Status check_samples(const InverseTask& task, const WorkspaceOptions& options);

/// Of all pieces together.
[[nodiscard]] std::size_t sample_count(const InverseTask& task, const WorkspaceOptions& options);

/// As a sentence, where no sample has an equilibrium; empty if one has.
[[nodiscard]] std::string why_nothing_is_found(const Workspace& workspace);

/// `known`: returns a piece computed earlier, by its index, if there is one. `keep` receives each new piece; its error
/// ends the work. Both may be empty. The result does not depend on interruptions. Errors: those of check_samples() and
/// `keep`.
[[nodiscard]] Result<Workspace> find_workspace(const Model& model, const StepperOptions& stepping,
                                               const InverseTask& task, const WorkspaceOptions& options,
                                               const std::function<std::optional<WorkspacePiece>(std::size_t)>& known,
                                               const std::function<Status(std::size_t, const WorkspacePiece&)>& keep,
                                               Progress& progress);

}  // namespace pliant::sim::inverse
