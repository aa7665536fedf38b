// Backward traversal of steps: all of them, in order, from the right states, and no more often than promised.
#include "simulation/gradient/backwards.hpp"

#include <doctest/doctest.h>

#include <vector>

using namespace pliant;
using namespace pliant::sim;

namespace {

struct Walk {
    std::vector<int> back;   ///< steps, in the order of the backward pass
    std::vector<int> times;  ///< (steps) how often each was computed forwards
    int most_states = 0;
};

/// A state that counts how many of its kind exist.
struct Counted {
    int at = 0;
    int* alive = nullptr;
    int* most = nullptr;
    Counted(int start, int& alive_now, int& most_ever) : at(start), alive(&alive_now), most(&most_ever) { count(); }
    Counted(const Counted& other) : at(other.at), alive(other.alive), most(other.most) { count(); }
    Counted(Counted&& other) noexcept : at(other.at), alive(other.alive), most(other.most) { count(); }
    Counted& operator=(const Counted&) = delete;
    Counted& operator=(Counted&&) = delete;
    ~Counted() { --*alive; }
    void count() const {
        ++*alive;
        *most = std::max(*most, *alive);
    }
};

Walk walk(int steps, int kept) {
    Walk result;
    result.times.assign(static_cast<std::size_t>(steps), 0);
    int alive = 0;
    const Status status = go_back<Counted>(
        Counted(0, alive, result.most_states), 0, steps, kept,
        [&](Counted& state, int k) -> Status {
            REQUIRE(state.at == k - 1);
            state.at = k;
            ++result.times[static_cast<std::size_t>(k - 1)];
            return {};
        },
        [&](const Counted& state, int k) -> Status {
            REQUIRE(state.at == k - 1);
            result.back.push_back(k);
            return {};
        });
    REQUIRE(status);
    return result;
}

}  // namespace

TEST_CASE("every step is traversed backwards once, the last first") {
    for (const int kept : {0, 1, 2, 5, 8}) {
        for (const int steps : {1, 2, 3, 7, 50}) {
            const Walk w = walk(steps, kept);
            REQUIRE(w.back.size() == static_cast<std::size_t>(steps));
            for (int k = 0; k < steps; ++k) CHECK(w.back[static_cast<std::size_t>(k)] == steps - k);
        }
    }
}

TEST_CASE("with a limited number of kept states the repeated steps are the fewest possible") {
    for (const int kept : {1, 2, 3, 5, 8}) {
        for (const int steps : {2, 5, 20, 100, 165, 495}) {
            if (kept == 1 && steps > 100) continue;
            CAPTURE(kept);
            CAPTURE(steps);
            const Walk w = walk(steps, kept);
            CHECK(*std::max_element(w.times.begin(), w.times.end()) <= times_forward(steps, kept));
            CHECK(w.most_states <= 2 * (kept + 2));  // each is passed on once
        }
    }
    CHECK(times_forward(220, 8) == 3);
    CHECK(times_forward(221, 8) == 4);
    CHECK(reach_back(2, 2) == 6);
}

TEST_CASE("an error ends the traversal") {
    int taken = 0;
    const Status status = go_back<int>(
        0, 0, 20, 3,
        [&](int& at, int k) -> Status {
            if (k == 7) return failure("step 7");
            at = k;
            ++taken;
            return {};
        },
        [](const int&, int) -> Status { return {}; });
    REQUIRE_FALSE(status);
    CHECK(status.error().message == "step 7");
    CHECK(taken < 20);
}
