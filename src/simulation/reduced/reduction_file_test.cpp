// Reductions in files: the same bits when read again, and no damage that passes or crashes.
#include "simulation/reduced/reduction_file.hpp"

#include <doctest/doctest.h>

#include <random>

#include "simulation/inverse/test_robots.hpp"
#include "simulation/reduced/reduced_solver.hpp"
#include "simulation/stepper/cbor_numbers.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::reduced;
using inverse::testing::bar;
using inverse::testing::made;
using inverse::testing::task_for;
using inverse::testing::tight;

namespace {

const Model& model() {
    static const Model model = made(bar(1));
    return model;
}

const std::string& bytes() {
    static const std::string bytes = [] {
        Progress silent;
        const auto reduction = reduce(model(), tight, task_for(model(), {{0.85, 1}}), {.samples = 8}, silent);
        REQUIRE(reduction);
        return reduction_bytes(*reduction, "this one");
    }();
    return bytes;
}

std::string refusal(const Model& of, std::string_view damaged, const std::string& origin = "this one") {
    const auto read = reduction_from_bytes(of, damaged, origin);
    return read ? "" : read.error().message;
}

}  // namespace

TEST_CASE("reduction file: what is read again is the same") {
    const auto read = reduction_from_bytes(model(), bytes(), "this one");
    REQUIRE(read);
    CHECK(reduction_bytes(*read, "this one") == bytes());
    CHECK(ReducedModel::create(model(), *read));
}

TEST_CASE("reduction file: other robots, other origins, other files") {
    CHECK(refusal(model(), bytes(), "another").find("made for another robot") != std::string::npos);
    CHECK(refusal(made(bar(1, 2)), bytes()).find("damaged") != std::string::npos);
    CHECK(refusal(made(bar(2)), bytes()).find("damaged") != std::string::npos);
    CHECK(refusal(model(), "solid part").find("not a reduced model") != std::string::npos);
    CHECK(refusal(model(), "").find("not a reduced model") != std::string::npos);
}

TEST_CASE("reduction file: a single bit that has changed is refused") {
    std::mt19937 random(4);
    for (int k = 0; k < 200; ++k) {
        std::string damaged = bytes();
        damaged[random() % damaged.size()] ^= static_cast<char>(1U << random() % 8);
        CHECK(refusal(model(), damaged) == "not a reduced model, or damaged");
    }
    CHECK_FALSE(refusal(model(), bytes().substr(0, bytes().size() - 1)).empty());
}

TEST_CASE("reduction file: wrong content with a right checksum is refused, or harmless") {
    std::mt19937 random(3);
    for (int k = 0; k < 400; ++k) {
        std::string damaged(cbor::unsealed(bytes()).value());
        if (k % 2 == 0) damaged.resize(random() % damaged.size());
        for (int flips = 0; flips < 3 && !damaged.empty(); ++flips)
            damaged[random() % std::min<std::size_t>(damaged.size(), k % 4 == 1 ? 200 : damaged.size())] ^=
                static_cast<char>(1U << random() % 8);
        const auto read = reduction_from_bytes(model(), cbor::sealed(std::move(damaged)), "this one");
        if (!read) continue;  // in one line
        const auto reduced = ReducedModel::create(model(), *read);
        if (!reduced) continue;
        ReducedSolver solver(*reduced);
        ReducedState state = solver.start(read->samples.front().inputs);
        (void)solver.solve(state, read->samples.back().inputs);
    }
}
