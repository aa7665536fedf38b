#include "studio/print/printer_files.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"
#include "base/core/test_text.hpp"
#include "printing/machine/built_in_printers.hpp"

using namespace pliant;
using namespace pliant::studio;
using pliant::test::holds;
using Json = nlohmann::json;

namespace {

struct PrinterBench {
    const pliant::test::Folder at;
    const ProjectFolder folder = ProjectFolder::open(at.path()).value();

    [[nodiscard]] std::string text(const std::string& name) const { return read_file(at / name).value(); }
    [[nodiscard]] std::string refused(const PrinterChanges& changes, const std::string& name = "mine.toml") const {
        const Status status = change_printer(folder, name, changes);
        return status ? "" : status.error().message;
    }
};

}  // namespace

TEST_CASE("a new printer file is a copy of a built-in one, and overwrites nothing") {
    const PrinterBench b;
    REQUIRE(new_printer(b.folder, "tower", "mine.toml").has_value());
    CHECK(b.text("mine.toml") == find_file(machine::built_in_printers(), "tower")->text);
    CHECK(holds(new_printer(b.folder, "tower", "mine.toml").error().message, "exists"));
    CHECK(holds(new_printer(b.folder, "tower", "mine.txt").error().message, "ends with .toml"));
    CHECK(holds(new_printer(b.folder, "tower", "../mine.toml").error().message, ".."));
    CHECK(holds(new_printer(b.folder, "tower", "tower").error().message, "is built in"));
    CHECK_FALSE(new_printer(b.folder, "no_such.toml", "other.toml").has_value());
    REQUIRE(new_printer(b.folder, "mine.toml", "second.toml").has_value());
}

TEST_CASE("changes of a printer file that come at once are all made") {
    const PrinterBench b;
    REQUIRE(new_printer(b.folder, "tower", "mine.toml").has_value());
    const std::vector<std::pair<std::string, std::string>> changes = {{"name", "\"our tower\""},
                                                                      {"projector.pixel", "\"49.3 um\""},
                                                                      {"resin.semi-flex.exposure", "\"2.75 s\""},
                                                                      {"controller.baud_rate", "250000"}};
    std::vector<std::thread> pages;
    for (const auto& change : changes)
        pages.emplace_back([&b, &change] { (void)change_printer(b.folder, "mine.toml", {change}); });
    for (std::thread& page : pages) page.join();
    const std::string text = b.text("mine.toml");
    for (const auto& [key, value] : changes) CHECK(holds(text, value));
}

TEST_CASE("values of a printer file change in place, and everything else stays as written") {
    const PrinterBench b;
    REQUIRE(new_printer(b.folder, "tower", "mine.toml").has_value());
    const std::string before = b.text("mine.toml");
    CHECK(b.refused({{"name", "\"our tower\""},
                     {"projector.pixel", "\"49.3 um\""},
                     {"resin.semi-flex.exposure", "\"2.75 s\""},
                     {"axis.carriage.travel", "[\"0 mm\", \"360 mm\"]"},
                     {"controller.baud_rate", "250000"}}) == "");
    const std::string after = b.text("mine.toml");
    CHECK(holds(after, "# The prototype of the thesis"));
    CHECK(holds(after, "# rack and pinion, 99:1"));
    CHECK(std::count(after.begin(), after.end(), '\n') == std::count(before.begin(), before.end(), '\n'));
    const auto printer = read_printer(b.folder, "mine.toml");
    REQUIRE(printer.has_value());
    CHECK(printer->printer.name == "our tower");
    CHECK(printer->printer.projector.pixel_um == 49.3);
    CHECK(printer->printer.find_resin("semi-flex")->exposure_s == 2.75);
    CHECK(printer->printer.axis(machine::Axis::carriage).max_um == 360000);
    CHECK(printer->printer.controller.baud_rate == 250000);
}

TEST_CASE("an invalid change of a printer file is refused, and nothing is written") {
    const PrinterBench b;
    REQUIRE(new_printer(b.folder, "tower", "mine.toml").has_value());
    const std::string before = b.text("mine.toml");
    CHECK(holds(b.refused({{"projector.pixel", "50"}}), "pixel"));
    CHECK(holds(b.refused({{"projector.pixle", "\"50 um\""}}), "pixle"));
    CHECK_FALSE(b.refused({{"name", "\"ours\""}, {"axis.carriage.travel", "[\"0 mm\", \"3 mm\"]"}}).empty());
    CHECK_FALSE(b.refused({{"name", "\"unfinished"}}).empty());
    CHECK_FALSE(b.refused({{"projector.mask", "\"../../etc/passwd\""}}).empty());
    CHECK(holds(b.refused({{"name", "\"ours\""}}, "tower"), "is built in"));
    CHECK_FALSE(b.refused({{"name", "\"ours\""}}, "none.toml").empty());
    CHECK(b.text("mine.toml") == before);
}

TEST_CASE("the page gets a printer's settings, and a board's answers compared with them") {
    const PrinterBench b;
    const auto file = read_printer(b.folder, "tower");
    REQUIRE(file.has_value());
    const Json told = Json::parse(printer_setup_json("tower", file->printer, true));
    CHECK(told["built_in"] == true);
    CHECK(told["axes"].size() == 3);
    CHECK(told["axes"][0]["name"] == "carriage");
    CHECK(told["axes"][0]["max"] == 358);
    CHECK(told["resins"].size() >= 2);
    CHECK(told["baud_rate"] == 115200);
    CHECK(Json::parse(built_in_printers_json()).size() == machine::built_in_printers().size());
    const Json board = Json::parse(board_json(
        "FIRMWARE_NAME:Marlin 2.1.2 (Jan 1 2024) PROTOCOL_VERSION:1.0\nCap:EMERGENCY_PARSER:1\nok\n", file->printer));
    CHECK(holds(board["firmware"].get<std::string>(), "Marlin 2.1.2"));
    CHECK(board["capabilities"]["EMERGENCY_PARSER"] == true);
    CHECK(board["problems"].is_array());
    CHECK(Json::parse(board_json("", file->printer))["firmware"] == "");
}
