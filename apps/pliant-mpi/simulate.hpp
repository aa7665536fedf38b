// pliant-mpi simulate: runs the actuation program of a robot file on many ranks.
#pragma once

#include <string>
#include <vector>

#include "base/core/error.hpp"
#include "simulation/distributed/linear_solver.hpp"
#include "simulation/distributed/ranks.hpp"

namespace pliant::app {

/// Exit status, as that of pliant.
enum Exit { exit_done = 0, exit_failed = 1, exit_bad_input = 2 };

struct Options {
    std::string robot;
    std::string folder;
    int steps = 0;
    std::vector<std::string> assignments;
    sim::distributed::Preconditioner preconditioner = sim::distributed::Preconditioner::gamg;
    int frames_every = 1;      ///< 0: none
    int checkpoint_every = 1;  ///< 0: none
    bool resume = false;
    bool quiet = false;
    bool json = false;
};

/// Returns the exit status; root prints errors. Collective.
[[nodiscard]] Result<int> simulate(const sim::distributed::Ranks& ranks, const Options& options);

}  // namespace pliant::app
