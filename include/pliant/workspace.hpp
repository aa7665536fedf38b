/// @file
/// The workspace of the markers: where they can get within the ranges of the actuators, at which tensions and
/// pressures.
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

/// Options of workspace().
struct WorkspaceOptions {
    int side = 9;       ///< samples along each input of a sheet, 2 to 1000
    int between = 100;  ///< number of further samples, spread over the ranges, 0 to 1,000,000; none with one input
    /// Folder in which completed pieces are stored, so that the search can be resumed; empty: nothing is stored. An
    /// older checkpoint there is replaced, unless the search resumes from it or it is of the same search, unfinished.
    /// Nothing else may work on it meanwhile.
    std::filesystem::path checkpoint{};
    /// Resumes from the checkpoint; the results are those of an uninterrupted search.
    bool resume = false;
};

/// One equilibrium of a workspace.
struct WorkspaceSample {
    std::size_t piece = 0;             ///< the piece it belongs to: a sheet, or a group of the further samples
    std::vector<double> inputs;        ///< (Workspace::inputs()) value of each, in its SteeredInput::unit;
                                       ///< Workspace::inputs_at() gives them to a Stepper
    bool found = false;                ///< an equilibrium was found; otherwise everything below is empty
    std::vector<Point> markers;        ///< (Model::markers()) m
    std::vector<double> tensions_N;    ///< (Model::cables())
    std::vector<double> pressures_Pa;  ///< (Model::chambers())
};

/// A triangle surface.
struct Surface {
    std::vector<Point> points;                  ///< m
    std::vector<std::array<int, 3>> triangles;  ///< indices into points
};

/// The workspace of all markers. A value; copies share immutable data.
class PLIANT_API Workspace {
public:
    /// The inputs that were varied.
    [[nodiscard]] const std::vector<SteeredInput>& inputs() const;
    /// Why no sample has an equilibrium, one sentence; empty if one has.
    [[nodiscard]] const std::string& message() const;
    /// Reasons not to trust a sample, one sentence each.
    [[nodiscard]] const std::vector<std::string>& warnings() const;
    /// Number of samples in all pieces.
    [[nodiscard]] std::size_t sample_count() const;
    /// One sample, counted from 0.
    /// @throws Failure if the index is out of range.
    [[nodiscard]] WorkspaceSample sample(std::size_t index) const;
    /// All inputs of the robot at a sample, as Stepper::step() takes them: its values, and for everything that is not
    /// varied those at the end of the robot's program.
    /// @throws Failure if the index is out of range.
    [[nodiscard]] Inputs inputs_at(std::size_t index) const;
    /// The sheets reached by a marker: on each, two inputs vary and all others are at one end of their range. Empty if
    /// there are none.
    /// @throws Failure if there is no such marker.
    [[nodiscard]] Surface sheets(std::size_t marker) const;
    /// Number of samples and bounding box of each marker, and the warnings, as in workspace.json.
    [[nodiscard]] std::string json() const;
    /// Writes the folder that `pliant workspace -o` writes, whole or not at all, replacing an older one: tables,
    /// surfaces and a picture.
    /// @throws Failure if a file cannot be written, or when cancelled.
    void write(const std::filesystem::path& folder, const Watch& watch = {}) const;
    /// Deletes the checkpoint of the search, if there is one and nothing else works on it by now.
    /// @throws Failure if it cannot be deleted.
    void remove_checkpoint() const;

    /// @cond
    struct Data;
    explicit Workspace(std::shared_ptr<const Data> data);

private:
    SharedData<const Data> data_;
    /// @endcond
};

/// Solves for equilibria on sheets of the input ranges and at further samples between them.
/// @throws Failure if no actuator has a range, the robot moves in time, the options or the checkpoint are invalid,
/// there would be no sample, or the checkpoint cannot be written; or when cancelled.
[[nodiscard]] PLIANT_API Workspace workspace(const Model& model, const WorkspaceOptions& options = {},
                                             const Watch& watch = {});

}  // namespace pliant
