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

TEST_CASE("slack cables need no solution as long as none becomes too long") {
    const SolvedActuators solved = two_cables_and_a_chamber();
    using Three = Eigen::Vector3d;
    CHECK(solved.list() == SolvedActuators::List{0, 1, 2});
    const SolvedActuators::List acting{0, 2};
    CHECK_FALSE(solved.is_too_long_beside(acting, Three(1e-3, -1e-3, 1e-3)));
    CHECK(solved.is_too_long_beside(acting, Three(0, 1e-3, 0)));

    // The second cable is slack: what the others change is what they change in the whole system.
    Eigen::Matrix3d S;
    S << 4, 1, 0.5, 1, 3, -0.2, 0.5, -0.2, 2;
    const Three violation(2e-3, -1e-2, 1e-3), now(1e-3, 0, -2e-3);
    const Eigen::VectorXd whole = solved.change(solved.list(), S, violation, now);
    CHECK(whole[1] == 0);
    const Eigen::VectorXd part = solved.change(acting, S(acting, acting), violation(acting), now(acting));
    CHECK((part - whole(acting)).norm() < 1e-12 * whole.norm());
}
