// Cost of linear systems.
#pragma once

namespace pliant::sim::distributed {

struct LinearWork {
    int matrices = 0, solutions = 0, iterations = 0;
    double assemble_s = 0, set_up_s = 0, solve_s = 0;
};

}  // namespace pliant::sim::distributed
