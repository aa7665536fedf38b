/// @file
/// Where the markers of a robot can get within the ranges of its actuators, and what that takes.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pliant/base.hpp"
#include "pliant/inverse.hpp"
#include "pliant/simulation.hpp"

namespace pliant {

/// How workspace() searches.
struct WorkspaceOptions {
    int side = 9;       ///< places along each input of a sheet; at least 2
    int between = 100;  ///< inputs that are spread over the ranges beside the sheets
    /// Folder in which pieces are kept as they are done, so that the search can be gone on with; empty: they are not.
    std::filesystem::path checkpoint{};
    /// Goes on from the checkpoint; the results are those of a search that was never stopped.
    bool resume = false;
};

/// One equilibrium of a workspace.
struct WorkspaceSample {
    std::size_t piece = 0;             ///< that it belongs to: a sheet, or some of the inputs in between
    std::vector<double> inputs;        ///< (Workspace::inputs()) SI
    bool found = false;                ///< there is an equilibrium; else all below is empty
    std::vector<Point> markers;        ///< (Model::markers()) m
    std::vector<double> tensions_N;    ///< (Model::cables())
    std::vector<double> pressures_Pa;  ///< (Model::chambers())
};

/// Triangles that share points.
struct Surface {
    std::vector<Point> points;                  ///< m
    std::vector<std::array<int, 3>> triangles;  ///< indices into points
};

/// Where markers can get. A value; copies share what never changes.
class PLIANT_API Workspace {
public:
    /// What was moved.
    [[nodiscard]] const std::vector<SteeredInput>& inputs() const;
    /// Samples of all pieces.
    [[nodiscard]] std::size_t sample_count() const;
    /// A sample, from 0.
    /// @throws Failure where there is none of that index.
    [[nodiscard]] WorkspaceSample sample(std::size_t index) const;
    /// The sheets that a marker can get to, on which two inputs vary and all others stand at one of their ends; empty
    /// where there are none.
    /// @throws Failure where there is no such marker.
    [[nodiscard]] Surface sheets(std::size_t marker) const;
    /// Number of samples and box of each marker, as in workspace.json.
    [[nodiscard]] std::string json() const;
    /// Writes the folder that `pliant workspace -o` writes, whole or not at all, in place of an older one: tables,
    /// surfaces and a picture.
    /// @throws Failure of the disk; cancelled.
    void write(const std::filesystem::path& folder, const Watch& watch = {}) const;
    /// Deletes the checkpoint of the search, if it has one.
    /// @throws Failure of the disk.
    void remove_checkpoint() const;

    /// @cond
    struct Data;
    explicit Workspace(std::shared_ptr<const Data> data);

private:
    std::shared_ptr<const Data> data_;
    /// @endcond
};

/// Solves for equilibria on sheets of the ranges and in between.
/// @throws Failure where no actuator has a range, of the options, of the checkpoint; cancelled.
[[nodiscard]] PLIANT_API Workspace workspace(const Model& model, const WorkspaceOptions& options = {},
                                             const Watch& watch = {});

}  // namespace pliant
