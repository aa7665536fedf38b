// What a step of a block of six tetrahedra takes in C++: what bench/python.py puts beside the same step in Python.
//   pliant_python_calls      prints microseconds
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <vector>

#include "pliant/simulation.hpp"

namespace {

/// Of 10 mm, around a diagonal; as BLOCK and cube() of python/test/robots.py.
pliant::Model block() {
    pliant::Mesh cube;
    for (int k = 0; k < 8; ++k) cube.points.push_back({0.01 * (k & 1), 0.01 * (k >> 1 & 1), 0.01 * (k >> 2)});
    cube.tets = {0, 1, 3, 7, 0, 3, 2, 7, 0, 2, 6, 7, 0, 6, 4, 7, 0, 4, 5, 7, 0, 5, 1, 7};
    return {pliant::Robot::parse(R"(
        name = "block"
        length_unit = "mm"
        material.soft = { youngs_modulus = "1 MPa", poisson_ratio = 0.3 }
        mesh = { file = "memory:", order = 1 }
        body = [{ name = "block", material = "soft", region = "all" }]
        fixed = [{ name = "bottom", box = [[0, 0, 0], [10, 10, 0]] }]
        load = [{ name = "push", box = [[0, 0, 10], [10, 10, 10]], force = ["0 N", "0 N", "-0.1 N"] }]
        marker = [{ name = "top", point = [5, 5, 10] }]
        cable = [{ name = "side", points = [[5, 0, 0], [5, 0, 10]], anchor = "first", target = { length_ratio = 0.9 } }]
    )"),
            cube};
}

}  // namespace

int main() try {
    using Clock = std::chrono::steady_clock;
    const pliant::Model model = block();
    pliant::Stepper stepper(model);
    pliant::State state = stepper.rest();
    pliant::Inputs inputs = state.inputs();
    std::vector<double> rounds;
    for (int round = 0; round < 15; ++round) {
        constexpr int steps = 400;
        const auto begin = Clock::now();
        for (int k = 0; k < steps; ++k) {
            inputs.cables[0].value = k % 2 == 0 ? 0.0095 : 0.0096;
            if (!stepper.step(state, inputs).arrived) return 1;
        }
        rounds.push_back(std::chrono::duration<double, std::micro>(Clock::now() - begin).count() / steps);
    }
    std::printf("%.3f\n", *std::min_element(rounds.begin(), rounds.end()));
    return 0;
} catch (const pliant::Failure& failure) {
    std::fprintf(stderr, "%s\n", failure.what());
    return 1;
}
