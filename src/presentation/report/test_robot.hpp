// The robot of the report's tests: a bar of two materials that bends into a circle, in closed form.
#pragma once

#include "presentation/report/simulation.hpp"

namespace pliant::report::test {

/// Owns what a Simulation refers to.
struct Robot {
    mesh::TetMesh mesh;
    sim::Trajectory result;
    std::vector<std::vector<std::vector<Vec3>>> cable_points;

    [[nodiscard]] Simulation simulation() const;
};

/// 100 x 20 x 15 mm, x from 0; region "grip" is x < 60 mm, "tip" the rest. In `steps` steps it bends upwards by 90
/// degrees in all; cable "flexor" runs 2.5 mm under the top; markers "tip" and "middle" sit on the axis.
[[nodiscard]] Robot bent_bar(int steps, int order);

}  // namespace pliant::report::test
