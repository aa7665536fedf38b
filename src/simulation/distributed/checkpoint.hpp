// Checkpoints of a run on many ranks, which can be resumed on any number of ranks.
#pragma once

#include <filesystem>
#include <string>

#include "base/core/error.hpp"
#include "simulation/distributed/distributed_equilibrium.hpp"
#include "simulation/distributed/file_order.hpp"
#include "simulation/distributed/run.hpp"

namespace pliant::sim::distributed {

/// One file, state.h5, in an existing folder: positions in the order of the whole mesh, and everything else that a run
/// needs to continue. It is written under another name and then renamed, so that a kill at any moment leaves the last
/// complete one. All functions are collective.
class Checkpoint {
public:
    /// `system` must outlive it. `origin` identifies the robot and its mesh: only a run with the same origin can
    /// resume.
    Checkpoint(const DistributedEquilibrium& system, std::filesystem::path folder, std::string origin);

    [[nodiscard]] Status keep(const RunState& run) const;
    /// Errors: there is no checkpoint, its origin is another, or it is damaged.
    [[nodiscard]] Result<RunState> read(const Program& program) const;

private:
    [[nodiscard]] std::filesystem::path file() const { return folder_ / "state.h5"; }
    [[nodiscard]] std::vector<double> sorted(const Eigen::VectorXd& x) const;

    const DistributedEquilibrium& system_;
    std::filesystem::path folder_;
    std::string origin_;
    FileOrder nodes_;
};

}  // namespace pliant::sim::distributed
