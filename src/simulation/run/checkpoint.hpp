// Saves a run to disk as it proceeds, so that it can be resumed after it was stopped or killed.
//
// A folder: `steps` has one record per step, and is only appended to; `state` is replaced after each checkpoint, says
// how much of `steps` is valid, and holds everything else. A kill or a power cut at any moment leaves the last complete
// checkpoint.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "base/core/checkpoint_folder.hpp"
#include "base/core/error.hpp"
#include "simulation/run/simulate.hpp"

namespace pliant::sim {

class Checkpoint {
public:
    /// Creates the folder, replacing an older checkpoint; an error if anything else is there, or if another process is
    /// at work on that checkpoint. `origin` identifies the run: a checkpoint can only be resumed by a run of the same
    /// origin. `every`: steps between checkpoints. No other process can work on it until release() or the end.
    [[nodiscard]] static Result<Checkpoint> create(const std::filesystem::path& folder, std::string origin, int every);

    /// The run at its last checkpoint, and where to continue saving it. Errors: there is none, another process is at
    /// work on it, its origin differs, or it is damaged.
    struct Resumed;
    [[nodiscard]] static Result<Resumed> open(const std::filesystem::path& folder, std::string origin,
                                              const Model& model, const Program& program);

    /// Saves `run`, whose first steps are those already saved.
    [[nodiscard]] Status keep(const Model& model, const RunState& run);
    [[nodiscard]] int every() const { return every_; }
    void set_every(int steps) { every_ = steps; }
    /// The run has ended: another process may resume it.
    void release() { folder_.release(); }
    /// Deletes the folder, unless another process is at work on it since release().
    [[nodiscard]] Status remove() const { return folder_.remove(); }

private:
    Checkpoint(CheckpointFolder folder, std::string origin, int every)
        : folder_(std::move(folder)), origin_(std::move(origin)), every_(every) {}

    CheckpointFolder folder_;
    std::string origin_;
    int every_ = 1;
    std::uintmax_t bytes_ = 0;    ///< valid bytes of `steps`
    std::size_t steps_ = 0;       ///< number of steps in them
    std::size_t iterations_ = 0;  ///< number of iterations in them
};

struct Checkpoint::Resumed {
    Checkpoint checkpoint;
    RunState run;
};

}  // namespace pliant::sim
