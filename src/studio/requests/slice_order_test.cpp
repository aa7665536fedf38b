#include "studio/requests/slice_order.hpp"

#include <doctest/doctest.h>

using namespace pliant;
using namespace pliant::studio;

namespace {

std::string refused(const char* json) {
    const auto order = read_slice_order(json);
    return order ? "" : order.error().message;
}

}  // namespace

TEST_CASE("a slice order of the page equals that of the command line") {
    const auto order = read_slice_order(R"({"printer": "tower", "layer": "100 um", "copies": 3, "turn": [90, 0, 0],
        "exposure": ["soft=2 s"], "overlap": ["soft+firm=4,2"], "support": "firm", "support-tip": "0.5 mm",
        "hollow": "2 mm", "drain": "3 mm", "no-anti-alias": true, "any-vat": true, "threshold": 0.4})");
    REQUIRE(order);
    CHECK(order->layer == "100 um");
    CHECK(order->copies == 3);
    CHECK(order->turn == std::vector<double>{90, 0, 0});
    CHECK(order->exposures == std::vector<std::string>{"soft=2 s"});
    CHECK(order->overlaps == std::vector<std::string>{"soft+firm=4,2"});
    CHECK(order->support == "firm");
    CHECK(order->support_tip == "0.5 mm");
    CHECK(order->hollow == "2 mm");
    CHECK(order->drain == "3 mm");
    CHECK(order->any_vat);
    const auto placed = read_slice_order(R"({"scale": 1.5, "at": [3, -4.5], "support-paint": "wish\n"})");
    REQUIRE(placed);
    CHECK(placed->scale == 1.5);
    CHECK(placed->at == std::vector<double>{3, -4.5});
    CHECK(placed->support_paint == "wish\n");
    CHECK(order->no_anti_alias);
    CHECK(order->threshold == 0.4);
    CHECK(order->spacing == "2 mm");
    CHECK(read_slice_order(R"({"layer_um": 80})")->layer == "80 um");
    CHECK(read_slice_order(R"({"robot": "name = 1"})").has_value());
    CHECK(robot_text_of(R"({"robot": "name = 1"})").value() == "name = 1");
    CHECK(robot_text_of("{}").value() == std::nullopt);
    CHECK_FALSE(robot_text_of(R"({"robot": 1})").has_value());
    CHECK(printer_name_of("{}").value() == "tower");
    CHECK(printer_name_of(R"({"printer": "my/p.toml"})").value() == "my/p.toml");
}

TEST_CASE("an error in a slice order names its option") {
    CHECK(refused("[]") == "a JSON object is needed");
    CHECK(refused(R"({"layer": 100})").starts_with("--layer: "));
    CHECK(refused(R"({"copies": 0})").starts_with("--copies: "));
    CHECK(refused(R"({"copies": 1.5})").starts_with("--copies: "));
    CHECK(refused(R"({"copies": 99999999999999999999})").starts_with("--copies: "));
    CHECK(refused(R"({"turn": [1, 2]})").starts_with("--turn: "));
    CHECK(refused(R"({"scale": "2"})") == "--scale: a number from 0.001 to 1000 is needed");
    CHECK(refused(R"({"at": [1]})").starts_with("--at: "));
    CHECK(refused(R"({"support-paint": ["block"]})").starts_with("--support-paint: "));
    CHECK(refused(R"({"overlap": "a+b=1"})").starts_with("--overlap: "));
    CHECK(refused(R"({"threshold": 0})").starts_with("--threshold: "));
    CHECK(refused(R"({"threshold": "0.5"})").starts_with("--threshold: "));
    CHECK(refused(R"({"suport": "soft"})") == "--suport: there is no such option");
    CHECK_FALSE(printer_name_of(R"({"printer": 3})"));
}
