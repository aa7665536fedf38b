#include "presentation/print_report/printers_page.hpp"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "base/core/near.hpp"

using namespace pliant;

namespace {

std::vector<machine::Printer> shipped() {
    std::vector<machine::Printer> all;
    for (const char* name : {"tower", "tower8", "two_towers", "carousel", "rotary", "linear", "single"}) {
        all.push_back(machine::load_printer(std::string("examples/printers/") + name + ".toml").value());
    }
    return all;
}

}  // namespace

TEST_CASE("the page holds every printer and loads nothing from outside") {
    std::vector<machine::Printer> printers = shipped();
    printers[0].name = "<b>tower</b>";
    const auto page = report::printers_page(printers);
    REQUIRE(page);
    CHECK(page->find("<b>tower</b>") == std::string::npos);
    CHECK(page->find("&lt;b&gt;tower") != std::string::npos);
    CHECK(page->find("http://") == std::string::npos);
    CHECK(page->find("data:image/png;base64,") != std::string::npos);
    CHECK(page->find("62 or 63 s") != std::string::npos);
    CHECK(page->find("under ultrasound 120 s it prints 57 %, they give 89 % (57 % is theirs for ultrasound 15 s)") !=
          std::string::npos);
    CHECK(page->find("23.7 + 15.0 + 23.7 = 62.4 s") != std::string::npos);
    // The bed of 6 in, and one twice as long: 2 (711.2 / 15.2 + 15.2 / 50) + 15 s.
    CHECK(page->find("<td>152 mm</td><td>62.4 s</td>") != std::string::npos);
    CHECK(page->find("<td>305 mm</td><td>109.2 s</td>") != std::string::npos);
}

TEST_CASE("a page for one printer, or none, is made too") {
    CHECK(report::printers_page({shipped().back()}));
    CHECK(report::printers_page({}));
}

TEST_CASE("the printers' data as JSON") {
    const auto json = nlohmann::json::parse(report::printers_json(shipped()));
    CHECK(json.size() == 7);
    CHECK(json[0]["area_in2"].get<double>() == near(72, {.relative = 1e-12}));
    CHECK(json[4]["swap_s"].get<double>() == near(180, {.relative = 0.02}));
    CHECK(json[6]["swap_s"] == 0);
}
