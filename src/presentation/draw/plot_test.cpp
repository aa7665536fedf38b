#include "presentation/draw/plot.hpp"

#include <doctest/doctest.h>

#include <cmath>

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
