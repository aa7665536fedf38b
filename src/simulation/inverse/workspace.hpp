// Where markers can get within the ranges of the inputs, and what that takes.
//
// The boundary of all places is among the images of the sheets of the ranges, on which two inputs vary and all others
// stand at one of their ends, or where the motion turns back on itself. Each sheet is solved on a grid, from rest and
// then from neighbour to neighbour; other inputs, spread evenly, fill what lies between.
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
    int side = 9;       ///< places along each input of a sheet; at least 2
    int between = 100;  ///< inputs that are spread over the ranges; 0 or more
};

struct WorkspaceSample {
    std::vector<double> values;                    ///< (inputs) in what the targets name
    bool found = false;                            ///< there is an equilibrium; else all below is empty
    std::vector<Vec3> markers;                     ///< (markers) m
    std::vector<double> tensions_N, pressures_Pa;  ///< (cables), (chambers)
};

/// A piece of the work that does not depend on the others: a sheet, or some of the inputs in between.
struct WorkspacePiece {
    int rows = 0, columns = 0;  ///< of a sheet's grid, row by row; 0: no sheet. One input: one row.
    std::vector<WorkspaceSample> samples;
};

struct Workspace {
    std::vector<WorkspacePiece> pieces;
    bool cancelled = false;
};

/// More inputs than this have too many sheets: only what is spread over the ranges is solved then.
inline constexpr std::size_t most_inputs_with_sheets = 5;

/// `known`: gives a piece that was made before, by its index, if there is one; `keep` is given each new one, and its
/// error ends the work. Both may be empty. The same numbers however often it was interrupted.
[[nodiscard]] Result<Workspace> find_workspace(const Model& model, const StepperOptions& stepping,
                                               const InverseTask& task, const WorkspaceOptions& options,
                                               const std::function<std::optional<WorkspacePiece>(std::size_t)>& known,
                                               const std::function<Status(std::size_t, const WorkspacePiece&)>& keep,
                                               Progress& progress);

}  // namespace pliant::sim::inverse
