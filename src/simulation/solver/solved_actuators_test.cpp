// Which cables are taut.
#include "simulation/solver/solved_actuators.hpp"

#include <doctest/doctest.h>

using namespace pliant::sim;

namespace {

/// Two cables and a chamber of prescribed volume.
SolvedActuators two_cables_and_a_chamber() {
    return {std::vector<Drive>(3, Drive{.kind = Drive::Kind::measure}), {true, true, false}, {0.1, 0.1, 1e-6}};
}

}  // namespace

TEST_CASE("cables that pull or are too long are taut, chambers always hold their volume") {
    const SolvedActuators solved = two_cables_and_a_chamber();
    using Three = Eigen::Vector3d;
    CHECK(solved.taut(Three(2, 0, 0), Three(-1, -1, -1)) == std::vector{true, false, true});
    CHECK(solved.taut(Three(0, 0, -5), Three(0, 1e-3, 0)) == std::vector{false, true, true});
}

TEST_CASE("a cable that would push goes slack, a slack one that would be too long becomes taut") {
    const SolvedActuators solved = two_cables_and_a_chamber();
    using Three = Eigen::Vector3d;
    std::vector<bool> taut{true, false, true};
    CHECK_FALSE(solved.settle(taut, Three(-1, 0, -1), Three(0, 1e-3, 0)));
    CHECK(taut == std::vector{false, true, true});
    CHECK(solved.settle(taut, Three(0, 1, -1), Three(-1e-3, 0, 0)));
    CHECK(taut == std::vector{false, true, true});
}
