#include "presentation/draw/plot.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "presentation/draw/test_pixels.hpp"

using namespace pliant::report;

TEST_CASE("ticks are round numbers, cover the range, and number 4 to 11") {
    CHECK(ticks(0, 6) == std::vector<double>{0, 1, 2, 3, 4, 5, 6});
    for (const auto& [low, high] :
         {std::pair(0.013, 0.94), std::pair(-3e6, 8e7), std::pair(5.0, 5.0), std::pair(0.0, 0.0)}) {
        const auto marks = ticks(low, high);
        CHECK(marks.front() <= low);
        CHECK(marks.back() >= high);
        CHECK(marks.size() >= 4);
        CHECK(marks.size() <= 11);
    }
    CHECK(ticks(NAN, 1).size() == 2);
}

TEST_CASE("logarithmic ticks cover the range") {
    CHECK(log_ticks(1, 1000) == std::vector<double>{1, 10, 100, 1000});
    CHECK(log_ticks(0.02, 0.03).size() == 2);
    const auto many = log_ticks(3e-17, 4e9);
    CHECK(many.front() <= 3e-17);
    CHECK(many.back() >= 4e9);
    CHECK(many.size() <= 11);
    CHECK(log_ticks(0, 1).size() == 2);
}

TEST_CASE("a logarithmic axis leaves out values that are not above zero") {
    Plot plot{"title", "x", "y", {{"line", {{1, 1}, {10, 1e-3}, {1000, 1e-6}}, false}}, true, true};
    const auto png = plot_png(plot);
    REQUIRE(png);
    plot.series[0].points.push_back({0, 1e-6});
    plot.series[0].points.push_back({1000, -1});
    CHECK(*plot_png(plot) == *png);
    plot.log_x = false;
    CHECK(*plot_png(plot) != *png);
}

TEST_CASE("the legend stands where it covers least of the curves") {
    // Dark pixels inside the axes are the legend's letters: 0 upper left, 1 upper right, 2 lower left, 3 lower right.
    const auto corner_of_legend = [](const Plot& plot) {
        const auto png = plot_png(plot);
        REQUIRE(png);
        const auto pixels = test::decode(*png);
        std::array<int, 4> dark{};
        for (int y = 80; y < 700; ++y) {
            for (int x = 120; x < 1160; ++x) {
                const std::string colour = pixels.colour(x, y);
                const bool is_dark =
                    std::ranges::all_of(colour, [](char c) { return static_cast<unsigned char>(c) < 80; });
                dark[(x < 640 ? 0 : 1) + (y < 390 ? 0 : 2)] += is_dark ? 1 : 0;
            }
        }
        return std::ranges::max_element(dark) - dark.begin();
    };
    using Points = std::vector<Point2>;
    const Points falling{{0, 0.95}, {0.5, 0.95}, {0.5, 0.05}, {1, 0.05}},
        rising{{0, 0.05}, {0.5, 0.05}, {0.5, 0.95}, {1, 0.95}};
    const auto plot_of = [](const Points& points) { return Plot{"title", "x", "y", {{"a legend", points, false}}}; };
    CHECK(corner_of_legend(plot_of(rising)) == 0);
    CHECK(corner_of_legend(plot_of(falling)) == 1);
    // Points near all corners but one.
    for (const std::size_t left_out : {0, 1, 2, 3}) {
        Plot plot{"title", "x", "y", {{"a legend", {}, true}}};
        for (std::size_t corner = 0; corner < 4; ++corner) {
            const double x = corner % 2 == 0 ? 0.08 : 0.92, y = corner < 2 ? 0.96 : 0.06;
            if (corner != left_out) plot.series[0].points.push_back({x, y});
        }
        plot.series[0].points.insert(plot.series[0].points.end(), {{0.5, 0}, {0.5, 1}, {0, 0.5}, {1, 0.5}});
        CHECK(corner_of_legend(plot) == static_cast<std::ptrdiff_t>(left_out));
    }
}

TEST_CASE("a plot is a PNG of the given size that shows its lines") {
    const Plot plot{"title", "x", "y", {{"line", {{0, 0}, {1, 2}}, false}, {"points", {{0.5, 1.5}, {NAN, 1}}, true}}};
    const auto png = plot_png(plot);
    REQUIRE(png);
    CHECK(png->substr(1, 3) == "PNG");
    CHECK(static_cast<unsigned char>((*png)[18]) * 256 + static_cast<unsigned char>((*png)[19]) == 1200);
    Plot empty = plot;
    empty.series[0].points.clear();
    const auto other = plot_png(empty);
    REQUIRE(other);
    CHECK(*other != *png);
}
