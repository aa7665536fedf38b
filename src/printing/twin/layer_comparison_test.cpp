#include "printing/twin/layer_comparison.hpp"

#include <doctest/doctest.h>

#include <random>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::twin;

namespace {

constexpr double slack_s = 0.01;

/// Two images of resin 0 and 1 side by side in one row of 10 pixels; they share the grey pixel 4.
const Runs left_runs{{0, 0, 4, 255}, {0, 4, 5, 100}};
const Runs right_runs{{0, 4, 5, 155}, {0, 5, 10, 255}};
const std::vector<AskedImage> both{{0, left_runs, 2.5}, {1, right_runs, 2.5}};

}  // namespace

TEST_CASE("correct layers have no difference, in any order of exposures") {
    const LayerDifference d = difference(both, {{1, &right_runs, 2.5}, {0, &left_runs, 2.5}}, slack_s);
    CHECK(d.wrong_px == 0);
    CHECK(d.wrong_dose_px == 0);
    CHECK(d.images[0].light == 4 * 255 + 100);
    CHECK(d.images[1].light == 5 * 255 + 155);
    CHECK(d.images[0].missing == 0);
}

TEST_CASE("missing, stray and foreign pixels are distinguished") {
    const Runs darker{{0, 0, 3, 255}, {0, 4, 5, 100}};
    const LayerDifference missing = difference(both, {{0, &darker, 2.5}, {1, &right_runs, 2.5}}, slack_s);
    CHECK(missing.missing_px == 1);
    CHECK(missing.wrong_px == 1);
    CHECK(missing.images[0].missing == 255);
    const Runs brighter{{0, 0, 4, 255}, {0, 4, 5, 101}};
    const LayerDifference stray = difference(both, {{0, &brighter, 2.5}, {1, &right_runs, 2.5}}, slack_s);
    CHECK(stray.stray_px == 1);
    CHECK(stray.wrong_px == 1);
    CHECK(stray.missing_px == 0);
    const LayerDifference foreign = difference(both, {{2, &left_runs, 2.5}, {1, &right_runs, 2.5}}, slack_s);
    CHECK(foreign.foreign_px == 5);
    CHECK(foreign.images[0].foreign == 4 * 255 + 100);
    CHECK(foreign.missing_px == 0);
    CHECK(foreign.stray_px == 0);
    const LayerDifference dark = difference(both, {}, slack_s);
    CHECK(dark.missing_px == 11);  // the shared pixel lacks both resins
}

TEST_CASE("an exposure longer or shorter than asked is a wrong dose of its pixels") {
    for (const double seconds : {0.25, 2.4, 2.6, 25.0}) {
        const LayerDifference d = difference(both, {{0, &left_runs, seconds}, {1, &right_runs, 2.5}}, slack_s);
        CHECK(d.wrong_px == 0);
        CHECK(d.wrong_dose_px == 5);
        CHECK((seconds < 2.5 ? d.least_share : d.most_share) == near(seconds / 2.5, {.relative = 1e-12}));
    }
    CHECK(difference(both, {{0, &left_runs, 2.53}, {1, &right_runs, 2.47}}, slack_s).wrong_dose_px == 0);
    // With an inaccurate clock, an exposure in one piece may be longer; one in two pieces must not be a double
    // exposure.
    for (const int pieces : {1, 2})
        CHECK(difference(both, {{0, &left_runs, 5, pieces}, {1, &right_runs, 2.5}}, 10).wrong_dose_px ==
              (pieces > 1 ? 5 : 0));
}

TEST_CASE("images of one resin may be shown as one; grey is a share of the pixel, not of the time") {
    const std::vector<AskedImage> same{{0, left_runs, 2.5}, {0, right_runs, 2.5}};
    const Runs whole{{0, 0, 10, 255}};
    const LayerDifference merged = difference(same, {{0, &whole, 2.5}}, slack_s);
    CHECK(merged.wrong_px == 0);
    CHECK(merged.wrong_dose_px == 0);
    CHECK(difference(same, {{0, &whole, 5}}, slack_s).wrong_dose_px == 10);
    CHECK(difference(same, {{0, &left_runs, 5}, {0, &right_runs, 2.5}}, slack_s).wrong_dose_px == 5);
}

TEST_CASE("property: images shown as asked pass, and any one changed voxel is found and counted once") {
    std::mt19937 random(5);
    const auto pick = [&](int most) { return static_cast<int>(random() % static_cast<unsigned>(most + 1)); };
    constexpr int width = 9, height = 4;
    for (int trial = 0; trial < 400; ++trial) {
        std::vector<job::Image> images;
        std::vector<AskedImage> asked;
        for (int i = 0; i <= pick(2); ++i) {
            job::Image image{width, height, std::vector<std::uint8_t>(width * height)};
            for (std::uint8_t& pixel : image.pixels)
                pixel = static_cast<std::uint8_t>(pick(2) == 0 ? pick(255) : 255 * pick(1));
            asked.push_back({i, runs_of(image), 1.0 + pick(30) / 10.0});
            images.push_back(std::move(image));
        }
        std::vector<Runs> pictures;
        for (const AskedImage& a : asked) pictures.push_back(a.runs);
        const auto shown = [&] {
            std::vector<ShownPicture> all;
            for (std::size_t i = 0; i < asked.size(); ++i)
                all.push_back({asked[i].resin, &pictures[i], asked[i].seconds});
            return all;
        };
        CHECK(difference(asked, shown(), slack_s).wrong_px == 0);
        const auto which = static_cast<std::size_t>(pick(static_cast<int>(asked.size()) - 1));
        std::uint8_t& pixel = images[which].pixels[static_cast<std::size_t>(pick(width * height - 1))];
        pixel = static_cast<std::uint8_t>(pixel ^ (1 << pick(7)));
        pictures[which] = runs_of(images[which]);
        const LayerDifference d = difference(asked, shown(), slack_s);
        CHECK(d.wrong_px == 1);
        CHECK(d.missing_px + d.foreign_px + d.stray_px == 1);
        CHECK(d.wrong_dose_px == 0);
    }
}
