#include "printing/machine/solution.hpp"

#include <doctest/doctest.h>

#include "base/core/files.hpp"
#include "base/core/near.hpp"
#include "base/core/test_text.hpp"

using namespace pliant;
using namespace pliant::machine;
using pliant::test::holds;
using pliant::test::replaced;

namespace {

/// 1 l in the reservoir, 2 ml a second pumped, of which a tenth evaporates; nothing is filtered.
Printer printer_with_reservoir() {
    Printer p = load_printer("examples/printers/tower.toml").value();
    p.cleaning.solvent_ml_s = 2;
    p.solution = {1000, 1000, 0, 100, 0.1, 0, 0.05, 0, 0};
    return p;
}

std::string tower_error(const std::string& from, const std::string& to) {
    const std::string text = read_file("examples/printers/tower.toml").value();
    const auto printer = parse_printer(replaced(text, from, to), "p.toml");
    return printer ? "" : printer.error().message;
}

}  // namespace

TEST_CASE("reused solution: evaporation is lost, washed-off resin collects, until it must be changed") {
    const Printer p = printer_with_reservoir();
    SolutionCircuit c(p);
    c.clean(15, 1);
    CHECK(c.pumped_ml() == near(30, {.relative = 1e-12}));
    CHECK(c.used_ml() == near(3, {.relative = 1e-12}));
    CHECK(c.liquid_ml() == near(1000 - 3 + 1, {.relative = 1e-12}));
    CHECK(c.resin_share() / (1.0 / 998) == near(1, {.relative = 1e-12}));
    CHECK_FALSE(c.needs());
    int cleanings = 1;
    for (; !c.needs(); ++cleanings) c.clean(15, 1);
    // n / (1000 - 2 n) reaches 0.05 at n = 50 / 1.1 = 45.45.
    CHECK(cleanings == 46);
    CHECK(c.needs() == SolutionCare::change);
    const double in_it = c.liquid_ml() - c.resin_ml();
    c.care(SolutionCare::change);
    CHECK(c.liquid_ml() == 1000);
    CHECK(c.resin_share() == 0);
    CHECK(c.used_ml() == near(46 * 3 + in_it, {.relative = 1e-12}));
}

TEST_CASE("evaporation leaves the resin behind, and a low reservoir is refilled") {
    Printer p = printer_with_reservoir();
    p.solution.resin_share = 0.01;
    p.solution.evaporation_ml_h = 90;
    SolutionCircuit c(p);
    c.wait(3600);
    CHECK(c.liquid_ml() == near(910, {.relative = 1e-12}));
    CHECK(c.resin_share() / (10.0 / 910) == near(1, {.relative = 1e-12}));
    c.wait(9 * 3600.0 + 60);
    CHECK(c.draws_air());
    CHECK(c.needs() == SolutionCare::change);  // it also has too much resin, which is more urgent
    p.solution.spent_share = 1;
    CHECK(SolutionCircuit(c).needs() == SolutionCare::top_up);
    c.care(SolutionCare::top_up);
    CHECK(c.liquid_ml() == 1000);
    CHECK(c.resin_ml() == near(10, {.relative = 1e-12}));
    c.wait(1e9);
    CHECK(c.liquid_ml() == near(10, {.relative = 1e-12}));  // never less than its resin
}

TEST_CASE("a filter removes its share of resin until it is full") {
    Printer p = printer_with_reservoir();
    p.solution.filter_share = 0.5;
    p.solution.filter_ml = 2;
    SolutionCircuit c(p);
    c.clean(1, 3);
    CHECK(c.filter_ml() == near(1.5, {.relative = 1e-12}));
    CHECK(c.resin_ml() == near(1.5, {.relative = 1e-12}));
    CHECK_FALSE(c.needs());
    c.clean(1, 3);
    CHECK(c.filter_ml() == near(2, {.relative = 1e-12}));
    CHECK(c.resin_ml() == near(4, {.relative = 1e-12}));
    CHECK(c.needs() == SolutionCare::clean_filter);
    c.care(SolutionCare::clean_filter);
    CHECK_FALSE(c.needs());
}

TEST_CASE("without a reservoir every cleaning uses fresh solution") {
    Printer p = printer_with_reservoir();
    p.solution = {};
    SolutionCircuit c(p);
    c.clean(15, 1);
    c.wait(1e6);
    CHECK(c.used_ml() == near(30, {.relative = 1e-12}));
    CHECK(c.resin_share() == 0);
    CHECK_FALSE(c.needs());
    CHECK_FALSE(c.draws_air());
}

TEST_CASE("a reservoir is read from the printer file, and mistakes are named") {
    const Printer tower = load_printer("examples/printers/tower.toml").value();
    CHECK(tower.solution.volume_ml == near(5000, {.relative = 1e-12}));
    CHECK(tower.solution.fill_ml == near(5000, {.relative = 1e-12}));
    CHECK(tower.solution.spent_share == 0.1);
    const std::string key = "volume = \"5 l\"";
    CHECK(tower_error(key, key + "\nfill = \"4 l\"\nresin_share = 0.03") == "");
    CHECK(holds(tower_error(key, key + "\nfill = \"6 l\""), "solution.fill: must be from 0 to volume"));
    CHECK(holds(tower_error(key, "volume = \"0 l\""), "solution.volume: must be above 0"));
    CHECK(holds(tower_error(key, "volume = \"400 ml\""), "solution.least: must be less than volume"));
    CHECK(holds(tower_error("spent = 0.1", "spent = 0"), "solution.spent: must be a share above 0"));
    CHECK(holds(tower_error("spray_loss = 0.02", "spray_loss = 2"), "solution.spray_loss: must be a share"));
    CHECK(holds(tower_error("filter_share = 0.2", "#"), "solution.filter: and filter_share go together"));
    const std::string single = read_file("examples/printers/single.toml").value();
    const auto alone = parse_printer(single + "\n[solution]\nvolume = \"1 l\"\n", "p.toml");
    REQUIRE_FALSE(alone);
    CHECK(holds(alone.error().message, "solution: belongs to a machine that cleans"));
}
