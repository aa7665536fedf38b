// A run on many ranks that is kept on disk as it goes, and gone on with on any number of them.
#pragma once

#include <filesystem>
#include <string>

#include "base/core/error.hpp"
#include "simulation/distributed/balance.hpp"
#include "simulation/distributed/file_order.hpp"
#include "simulation/distributed/run.hpp"

namespace pliant::sim::distributed {

/// One file, state.h5, in a folder that is there: positions in the order of the whole mesh, and all else that a run
/// needs. It is written aside and renamed, so that a kill at any moment leaves the last whole one. All functions are
/// collective.
class Checkpoint {
public:
    /// `balance` must outlive it. `origin` tells runs apart: a checkpoint is gone on with only by the same.
    Checkpoint(const Balance& balance, std::filesystem::path folder, std::string origin);

    [[nodiscard]] Status keep(const RunState& run) const;
    /// Errors: there is none, it is of another origin, or it is damaged.
    [[nodiscard]] Result<RunState> read(const Program& program) const;

private:
    [[nodiscard]] std::filesystem::path file() const { return folder_ / "state.h5"; }
    [[nodiscard]] std::vector<double> sorted(const Eigen::VectorXd& x) const;

    const Balance& balance_;
    std::filesystem::path folder_;
    std::string origin_;
    FileOrder nodes_;
};

}  // namespace pliant::sim::distributed
