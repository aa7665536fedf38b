#include "studio/simulate/state_history.hpp"

#include <doctest/doctest.h>

#include <vector>

using namespace pliant;

TEST_CASE("a long history keeps rest and every other, later every fourth state, by their numbers") {
    sim::Step step;
    step.positions = std::vector<Vec3>(1'000'000);  // 24 MB: the fifth state is one too many
    studio::StateHistory history;
    std::vector<std::vector<int>> kept;
    for (int k = 0; k < 10; ++k) {
        history.add(step);
        std::vector<int>& now = kept.emplace_back();
        for (const sim::Step& s : history.states().steps) now.push_back(s.index);
    }
    CHECK(kept[3] == std::vector{0, 1, 2, 3});
    CHECK(kept[4] == std::vector{0, 2, 4});
    CHECK(kept[7] == std::vector{0, 2, 4, 6});
    CHECK(kept[9] == std::vector{0, 4, 8});
}
