/// @file
/// Runs the program of a robot file from rest to its end, and writes what came of it: what `pliant simulate` does.
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
    int index = 0;                 ///< 0: at rest
    double time = 0;               ///< of the program
    StepResult result;             ///< how it was reached
    Observation observed;          ///< what it is like
    std::vector<Point> positions;  ///< (nodes) m
};

/// How a program is run.
struct RunOptions {
    /// Called with each step as it comes, the rest state first.
    std::function<void(const ProgramStep&)> on_step{};
    /// CSV of measured markers, columns as in markers.csv, to be compared with the simulated ones.
    std::filesystem::path measured{};
    /// Folder in which the run is kept as it goes, so that it can be gone on with after a stop; empty: it is not kept.
    std::filesystem::path checkpoint{};
    /// Steps from one checkpoint to the next; 0 with `resume`: as before.
    int checkpoint_every = 0;
    /// Goes on from the checkpoint; the results are those of a run that was never stopped.
    bool resume = false;
    /// Called once with the last step that the checkpoint has.
    std::function<void(int step)> on_resume{};
};

/// Which pictures a results folder has.
enum class Pictures {
    none,  ///< no pictures
    few,   ///< the last state over the rest shape
    all,   ///< also the rest state, states on the way, and stress
};

/// What a results folder is to have.
struct ResultsOptions {
    Pictures pictures = Pictures::few;            ///< drawing them takes longest
    std::array<int, 2> picture_size_px = {0, 0};  ///< width and height, 100 to 10000; 0: 800 x 500, of all 1600 x 1000
    bool film = false;                            ///< also film.gif, the motion as an animated GIF
    std::optional<Point> towards_eye{};           ///< direction from the robot to the eye; else where motion shows best
    std::function<bool()> enough_pictures{};      ///< asked while they are drawn; true leaves all of them out
};

/// What came of a program. A value; the steps are shared by all copies, and in a file where they are large.
class PLIANT_API ProgramResult {
public:
    /// It ran to its end.
    [[nodiscard]] bool converged() const;
    /// Where and why it stopped, if it did.
    [[nodiscard]] const std::string& message() const;
    /// Where the answer should not be trusted, a sentence each.
    [[nodiscard]] const std::vector<std::string>& warnings() const;
    /// The solver that was asked for or chosen, by name.
    [[nodiscard]] const std::string& solver() const;
    /// Wall time of solving, s.
    [[nodiscard]] double solve_s() const;
    /// Steps that were accepted, the rest state among them; at least 1.
    [[nodiscard]] std::size_t step_count() const;
    /// A step, 0 at rest.
    /// @throws Failure where there is none of that index.
    [[nodiscard]] ProgramStep step(std::size_t index) const;
    /// A line for each marker that was measured: how far the measured points lie from the simulated way.
    [[nodiscard]] std::vector<std::string> deviations() const;
    /// All figures, as in summary.json.
    [[nodiscard]] std::string summary_json() const;

    /// Writes the folder that `pliant simulate -o` writes, whole or not at all, in place of an older one: summary.json,
    /// tables, frames for ParaView, robot.glb, pictures, report.html. False: without the pictures, because
    /// `enough_pictures` said so.
    /// @throws Failure of the options, of the disk; or something else stands in the folder's place; cancelled.
    bool write(const std::filesystem::path& folder, const ResultsOptions& options = {}, const Watch& watch = {});
    /// Deletes the checkpoint of the run, if it has one.
    /// @throws Failure of the disk.
    void remove_checkpoint() const;

    /// @cond
    struct Data;
    explicit ProgramResult(std::shared_ptr<Data> data);

private:
    std::shared_ptr<Data> data_;
    /// @endcond
};

/// Runs the robot's program from rest, or from where it was kept. A program that gets stuck or is cancelled is no
/// Failure: the result says so and has the steps until then.
/// @throws Failure of the measured markers, or of the checkpoint.
PLIANT_API ProgramResult run(const Model& model, const RunOptions& options = {}, const Watch& watch = {});

}  // namespace pliant
