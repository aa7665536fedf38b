#include "presentation/report/identified.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::report;

namespace {

sim::identify::Channel channel(const char* column, const char* unit) {
    sim::identify::Channel result;
    result.column = column;
    result.unit = unit;
    return result;
}

/// Values that begin at 100 and are met to 2 before and to 0.5 after.
sim::identify::Identification found(const std::vector<sim::identify::Channel>& channels) {
    sim::identify::Identification result;
    result.channels = channels;
    for (const double time : {0.5, 0.25, 1.0}) {
        for (std::size_t c = 0; c < channels.size(); ++c) {
            const double value = 100 + 8 * (time - 0.25);
            result.values.push_back({{1, time, c, value}, value + 2, value + 0.5});
        }
    }
    return result;
}

}  // namespace

TEST_CASE("few columns are plotted over time, in their order, one plot per unit") {
    const auto plots = identified_plots(found({channel("tip_x_mm", "mm"), channel("a_tension_N", "N")}));
    REQUIRE(plots.size() == 2);
    CHECK(plots[0].file == "measured_mm.png");
    CHECK(plots[1].file == "measured_N.png");
    const Plot& plot = plots[0].plot;
    CHECK(plot.x_label == "time");
    CHECK(plot.y_label == "change since the first row (mm)");
    REQUIRE(plot.series.size() == 3);
    CHECK(plot.series[0].name == "tip_x_mm, measured");
    CHECK(plot.series[0].dots);
    CHECK(plot.series[0].points[0].x == near(0.25, {.relative = 1e-12}));
    CHECK(plot.series[0].points[2].y == near(6, {.relative = 1e-12}));
    CHECK(plot.series[1].points[0].y == near(2, {.relative = 1e-12}));
    CHECK(plot.series[2].points[2].y == near(6.5, {.relative = 1e-12}));
    CHECK(plot_png(plot));
}

TEST_CASE("many columns are plotted simulated against measured, beside the diagonal") {
    const std::vector<sim::identify::Channel> ratios(5, channel("c_length_ratio", ""));
    const auto plots = identified_plots(found(ratios));
    REQUIRE(plots.size() == 1);
    CHECK(plots[0].file == "measured_ratio.png");
    const Plot& plot = plots[0].plot;
    CHECK(plot.y_label == "simulated, change since the first row");
    REQUIRE(plot.series.size() == 3);
    CHECK(plot.series[0].points.size() == 15);
    CHECK(plot.series[1].points[0].y - plot.series[1].points[0].x == near(0.5, {.relative = 1e-12}));
    CHECK(plot.series[2].points[1].x == near(6, {.relative = 1e-12}));
}
