#include "printing/screen/screen_light.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <vector>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::host;

namespace {

/// A panel of a given rate that presents at its vertical blankings; some frames are delayed by some blankings.
struct CountingPanel final : Panel {
    int rate_hz = 60;
    std::map<int, int> late;  ///< present (from 0) -> blankings missed
    int fails_at = -1;
    int presents = 0;
    long blanking = 0;
    std::vector<bool> lit;  ///< by present

    [[nodiscard]] int width_px() const override { return 2; }
    [[nodiscard]] int height_px() const override { return 1; }
    [[nodiscard]] double frame_s() const override { return 1.0 / rate_hz; }
    Result<double> present(const job::Image* image) override {
        if (presents == fails_at) {
            ++presents;
            return failure("the panel is gone");
        }
        const auto found = late.find(presents++);
        blanking += 1 + (found == late.end() ? 0 : found->second);
        lit.push_back(image != nullptr);
        return static_cast<double>(blanking) / rate_hz;
    }
};

const job::Image half_lit{2, 1, {0, 255}};

Result<Light> light(
    CountingPanel& panel, double seconds, const std::function<bool()>& keep_on = [] { return true; }) {
    return keep_light(
        panel, half_lit, seconds, [] {}, keep_on);
}

}  // namespace

TEST_CASE("an exposure has the nearest number of frames to its time, at any frame rate") {
    for (const int rate : {24, 50, 60, 75, 120}) {
        for (const double seconds : {0.001, 0.02, 0.1, 0.25, 0.5, 1.0, 1.2345, 2.5, 12.0, 61.0}) {
            CountingPanel panel;
            panel.rate_hz = rate;
            const Result<Light> got = light(panel, seconds);
            REQUIRE(got);
            // To the nearest frame; ties are rounded down.
            const int frames = std::max(1, static_cast<int>(std::ceil(seconds * rate - 0.5 - 1e-9)));
            CHECK(got->frames == frames);
            CHECK(got->on_s == near(static_cast<double>(frames) / rate, {.relative = 1e-12}));
            if (seconds > 0.5 / rate) CHECK(std::abs(got->on_s - seconds) <= 0.5 / rate + 1e-9);
            CHECK_FALSE(panel.lit.back());
        }
    }
}

TEST_CASE("late frames do not lengthen an exposure, unless the last one is late") {
    CountingPanel panel;
    panel.late = {{10, 3}, {20, 6}};
    const Result<Light> got = light(panel, 1.0);
    REQUIRE(got);
    CHECK(got->on_s == near(1.0, {.relative = 1e-12}));
    CHECK(got->frames == 60 - 9);
    CHECK(got->longest_frame_s == near(7.0 / 60, {.relative = 1e-12}));

    CountingPanel stuck;  // two black frames, 60 lit ones, then the black one
    stuck.late = {{62, 5}};
    const Result<Light> late = light(stuck, 1.0);
    REQUIRE(late);
    CHECK(late->on_s == near(1.0 + 5.0 / 60, {.relative = 1e-12}));
    CHECK(late->longest_frame_s == near(6.0 / 60, {.relative = 1e-12}));
}

TEST_CASE("a cancelled exposure ends with the next frame") {
    CountingPanel panel;
    int asked = 0;
    const Result<Light> got = light(panel, 10, [&] { return ++asked < 30; });
    REQUIRE(got);
    CHECK(got->frames == 30);
    CHECK(got->on_s == near(0.5, {.relative = 1e-12}));
    CHECK_FALSE(panel.lit.back());
}

TEST_CASE("after a failed frame a black one is shown") {
    for (const int present : {0, 2, 5}) {
        CountingPanel panel;
        panel.fails_at = present;
        CHECK_FALSE(light(panel, 1));
        if (present >= 2) CHECK_FALSE(panel.lit.back());
        CHECK(panel.presents == present + (present >= 2 ? 2 : 1));
    }
}
