// Cancelled simulations: what they keep and report.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <atomic>

#include "simulation/run/test_problems.hpp"

using namespace pliant;
using namespace pliant::sim;

namespace {

/// Cancels after a number of queries.
class Asked final : public Progress {
public:
    explicit Asked(int most) : most_(most) {}
    [[nodiscard]] bool cancelled() const override { return ++count_ > most_; }
    [[nodiscard]] int count() const { return count_; }

private:
    int most_;
    mutable std::atomic<int> count_ = 0;
};

Trajectory inflated(Progress& progress) {
    Description d = testing::hollow_block(1);
    d.chambers[0].target = {ChamberTarget::Kind::volume_ratio, 1.5};
    const auto model = Model::create(std::move(d));
    REQUIRE(model);
    return run(*model, {.steps = 8}, progress);
}

}  // namespace

TEST_CASE("a program cancelled at any time keeps its finished steps, equal to those of a whole run") {
    Asked whole(1 << 30);
    const Trajectory all = inflated(whole);
    REQUIRE_MESSAGE(all.converged, all.message);
    REQUIRE(whole.count() > 16);  // in the iterations, not only between steps
    for (const double share : {0.0, 0.2, 0.5, 0.8}) {
        CAPTURE(share);
        Asked progress(static_cast<int>(share * whole.count()));
        const Trajectory part = inflated(progress);
        CHECK_FALSE(part.converged);
        const std::size_t kept = part.steps.size() - 1;
        CHECK(kept < 8);
        if (share == 0) CHECK(kept == 0);
        if (share > 0.4) CHECK(kept > 0);
        CHECK(part.message == fmt::format("cancelled at step {} of 8", kept + 1));
        CHECK(part.warnings.empty());
        for (std::size_t k = 0; k <= kept; ++k) {
            CHECK(part.steps[k].converged);
            CHECK(part.steps[k].positions == all.steps[k].positions);
        }
        // It stops at the current iteration: a few more queries while unwinding, but no other attempt.
        CHECK(progress.count() < static_cast<int>(share * whole.count()) + 12);
    }
}
