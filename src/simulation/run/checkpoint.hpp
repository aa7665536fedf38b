// A run that is kept on disk as it goes, and gone on with after it was stopped, or killed.
//
// A folder: `steps` has one record for each step, and is only ever added to; `state` is replaced after each, says how
// much of `steps` counts, and holds everything else. A kill at any moment leaves the last whole checkpoint.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "base/core/error.hpp"
#include "simulation/run/simulate.hpp"

namespace pliant::sim {

class Checkpoint {
public:
    /// Makes the folder, in place of an older checkpoint; anything else that stands there is an error. `origin` tells
    /// runs apart: a checkpoint is gone on with only by the same. `every`: steps between two checkpoints.
    [[nodiscard]] static Result<Checkpoint> create(const std::filesystem::path& folder, std::string origin, int every);

    /// The run as it was at the last checkpoint, and where to keep it from now on. Errors: there is none, it is of
    /// another origin, or it is damaged.
    struct Resumed;
    [[nodiscard]] static Result<Resumed> open(const std::filesystem::path& folder, std::string origin,
                                              const Model& model, const Program& program);

    /// Keeps `run`, whose first steps are those that were kept before.
    [[nodiscard]] Status keep(const Model& model, const RunState& run);
    [[nodiscard]] int every() const { return every_; }
    void set_every(int steps) { every_ = steps; }
    /// Deletes the folder.
    [[nodiscard]] Status remove() const;

private:
    Checkpoint(std::filesystem::path folder, std::string origin, int every)
        : folder_(std::move(folder)), origin_(std::move(origin)), every_(every) {}

    std::filesystem::path folder_;
    std::string origin_;
    int every_ = 1;
    std::uintmax_t bytes_ = 0;    ///< of `steps` that count
    std::size_t steps_ = 0;       ///< in them
    std::size_t iterations_ = 0;  ///< that their records have
};

struct Checkpoint::Resumed {
    Checkpoint checkpoint;
    RunState run;
};

}  // namespace pliant::sim
