// Positions on disk are unchanged, and a run that uses them gives the same bits.
#include "simulation/run/position_file.hpp"

#include <doctest/doctest.h>

#include <cstdlib>

#include "base/core/test_variable.hpp"
#include "simulation/run/test_problems.hpp"

using namespace pliant;
using namespace pliant::sim;

TEST_CASE("stored positions stay readable as long as something refers to them") {
    NodePositions last;
    {
        auto file = PositionFile::make(1000, 500);
        REQUIRE(file);
        std::vector<Vec3> points(500);
        for (std::size_t step = 0; step < 1000; ++step) {
            points[step % 500] = {static_cast<double>(step), 1, 2};
            last = file->keep(step, points);
        }
        CHECK(last == NodePositions(points));
    }
    CHECK(last[499].x == 999);
    CHECK(last.size() == 500);
}

TEST_CASE("if no file can be made there is no position file") {
    const pliant::test::Variable nowhere("TMPDIR", "/nowhere");
    CHECK(PositionFile::make(10, 10) == nullptr);
}

TEST_CASE("a run that stores its positions on disk gives the same bits") {
    Description d = testing::hollow_block(1);
    d.chambers[0].target = {ChamberTarget::Kind::volume_ratio, 1.2, {}};
    const auto model = Model::create(std::move(d));
    REQUIRE(model);
    Progress silent;
    const Trajectory in_memory = run(*model, {.steps = 5}, silent);
    RunOptions options;
    options.memory_bytes = 0;
    const Trajectory on_disk = run(*model, {.steps = 5}, silent, std::move(options));
    REQUIRE(on_disk.steps.size() == in_memory.steps.size());
    for (std::size_t k = 0; k < on_disk.steps.size(); ++k)
        CHECK(on_disk.steps[k].positions == in_memory.steps[k].positions);
}
