#include "simulation/elements/node_sums.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "base/core/aligned_array.hpp"
#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::sim;

TEST_CASE("forces of tets are summed at their nodes, whatever nodes they share, in one run and in many") {
    constexpr std::size_t lanes = batch_lanes;
    std::mt19937 random(3);
    for (const std::size_t nodes_per_tet : {4U, 10U}) {
        for (const auto& [batches, node_count] : {std::pair<std::size_t, std::size_t>{1, 12}, {70, 3000}, {33, 1}}) {
            const std::size_t width = nodes_per_tet * lanes;
            std::uniform_int_distribution<int> node(0, static_cast<int>(node_count) - 1);
            std::uniform_real_distribution<double> number(-1, 1);
            std::vector<int> nodes(batches * width);
            for (int& n : nodes) n = node(random);
            AlignedArray<double> forces(3 * nodes.size());
            std::vector<double> expected(3 * node_count, 1.0), result = expected;
            for (std::size_t b = 0; b < batches; ++b) {
                for (std::size_t a = 0; a < nodes_per_tet; ++a) {
                    for (std::size_t i = 0; i < 3; ++i) {
                        for (std::size_t lane = 0; lane < lanes; ++lane) {
                            double& force = forces[((b * nodes_per_tet + a) * 3 + i) * lanes + lane];
                            force = number(random);
                            expected[3 * static_cast<std::size_t>(nodes[b * width + a * lanes + lane]) + i] += force;
                        }
                    }
                }
            }
            const NodeSums sums(nodes, nodes_per_tet, node_count);
            AlignedArray<double> lists(sums.space());
            std::vector<int> seen(batches, 0);
            sums.for_pieces([&](std::size_t piece, std::size_t begin, std::size_t end) {
                sums.clear(piece, lists.data());
                for (std::size_t b = begin; b < end; ++b, ++seen[b - 1])
                    sums.add(b, forces.data() + 3 * b * width, lists.data());
            });
            for (const int times : seen) CHECK(times == 1);
            sums.gather(lists.data(), result);
            for (std::size_t k = 0; k < expected.size(); ++k)
                CHECK(result[k] == near(expected[k], {.relative = 1e-12}));
        }
    }
}
