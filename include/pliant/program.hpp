/// @file
/// Runs the program of a robot file from rest to its end, and writes the results, as `pliant simulate` does.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pliant/base.hpp"
#include "pliant/simulation.hpp"

namespace pliant {

/// A step of a program.
struct ProgramStep {
    int index = 0;                 ///< 0: the rest state
    double time = 0;               ///< program time; in seconds for a motion in time
    StepResult result;             ///< result of the solver
    Observation observed;          ///< measurable quantities of the state
    std::vector<Point> positions;  ///< (nodes) m
};

/// Options of run().
struct RunOptions {
    /// Called with each step as soon as it is solved, the rest state first.
    std::function<void(const ProgramStep&)> on_step{};
    /// CSV of measured marker positions, with the columns of markers.csv, for comparison with the simulated ones.
    std::filesystem::path measured{};
    /// Folder in which the run is saved as it proceeds, so that it can be resumed; empty: the run is not saved. An
    /// older checkpoint there is replaced, unless the run resumes from it or it is of the same run, unfinished. Nothing
    /// else may work on it meanwhile.
    std::filesystem::path checkpoint{};
    /// Steps between checkpoints, not negative; 0: a checkpoint after every step or, with `resume`, as often as before.
    /// A run that stops early or is cancelled saves nothing more: the steps since the last checkpoint are solved again
    /// when it is resumed.
    int checkpoint_every = 0;
    /// Resumes from the checkpoint; the results are those of an uninterrupted run.
    bool resume = false;
    /// Called once if the run resumes, with the last step stored in the checkpoint.
    std::function<void(int step)> on_resume{};
};

/// Which pictures a results folder contains.
enum class Pictures {
    none,  ///< no pictures
    few,   ///< the final state over the rest shape
    all,   ///< also the rest state, intermediate states and stress
};

/// Contents of a results folder.
struct ResultsOptions {
    Pictures pictures = Pictures::few;            ///< drawing them takes most of the time
    std::array<int, 2> picture_size_px = {0, 0};  ///< width and height, 100 to 10000; 0: 800 x 500, or 1600 x 1000 for
                                                  ///< `all`
    bool film = false;                            ///< also film.gif, the motion as an animated GIF
    std::optional<Point> towards_eye{};           ///< direction from the robot to the camera; default: where the motion
                                                  ///< shows best
    std::function<bool()> enough_pictures{};      ///< polled while drawing, by several threads at once; must not throw;
                                                  ///< true leaves out all pictures
};

/// Result of a program. A value; copies share the steps, which are kept in a file if they are large.
class PLIANT_API ProgramResult {
public:
    /// True if the program ran to its end.
    [[nodiscard]] bool converged() const;
    /// Where and why the program stopped early; otherwise empty.
    [[nodiscard]] const std::string& message() const;
    /// Reasons not to trust the result, one sentence each. write() adds one if nothing could be drawn.
    [[nodiscard]] const std::vector<std::string>& warnings() const;
    /// Name of the solver that was requested or chosen.
    [[nodiscard]] const std::string& solver() const;
    /// Wall time of solving, s.
    [[nodiscard]] double solve_s() const;
    /// Number of accepted steps, including the rest state; at least 1.
    [[nodiscard]] std::size_t step_count() const;
    /// One step; 0 is the rest state.
    /// @throws Failure if the index is out of range.
    [[nodiscard]] ProgramStep step(std::size_t index) const;
    /// One line per measured marker: the distance of the measured points from the simulated path.
    [[nodiscard]] std::vector<std::string> deviations() const;
    /// All figures, as in summary.json.
    [[nodiscard]] std::string summary_json() const;

    /// Writes the folder that `pliant simulate -o` writes, whole or not at all, replacing an older one: summary.json,
    /// tables, frames for ParaView, robot.glb, pictures, report.html. Returns false if the pictures were left out
    /// because `enough_pictures` returned true.
    /// @throws Failure if the options are invalid, a file cannot be written, or something else is at that path; or when
    /// cancelled.
    bool write(const std::filesystem::path& folder, const ResultsOptions& options = {}, const Watch& watch = {});
    /// Deletes the checkpoint of the run, if there is one and nothing else works on it by now.
    /// @throws Failure if it cannot be deleted.
    void remove_checkpoint() const;

    /// @cond
    struct Data;
    explicit ProgramResult(std::shared_ptr<Data> data);

private:
    SharedData<Data> data_;
    /// @endcond
};

/// Runs the robot's program from rest, or from a checkpoint. A program that stops early, is cancelled, or can no longer
/// write its checkpoint is not a Failure: the result says so and holds the steps up to then.
/// @throws Failure if the measured markers cannot be read or are invalid, `checkpoint_every` is negative, no folder is
/// named for a checkpoint that is asked for, or the checkpoint cannot be made or resumed, as one that is in use, or
/// would replace that of the same run, unfinished.
PLIANT_API ProgramResult run(const Model& model, const RunOptions& options = {}, const Watch& watch = {});

}  // namespace pliant
