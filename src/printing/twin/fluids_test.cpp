#include "printing/twin/fluids.hpp"

#include <doctest/doctest.h>

#include "base/core/near.hpp"
#include "printing/twin/fault.hpp"

using namespace pliant;
using namespace pliant::twin;

namespace {

machine::Printer printer_with_film() {
    auto printer = machine::load_printer("examples/printers/tower.toml").value();
    printer.cleaning.film_um = 100;
    return printer;
}

}  // namespace

TEST_CASE("the part of the film that the spray leaves mixes into the next vat") {
    const auto printer = printer_with_film();
    Fluids fluids(printer);
    CHECK(fluids.leave(0, 1000) == near(0.1, {.relative = 1e-12}));  // 1000 mm^2 under 100 um: 100 ul
    fluids.clean(15);
    // Spray of 15 s leaves 5.25 % (mean of table 4.2).
    CHECK(fluids.enter(1, 99.99475) == near(0.00525, {.relative = 1e-12}));
    CHECK(fluids.foreign_share(1) == near(0.00525 / 100, {.relative = 1e-9}));
    CHECK(fluids.share(1, 0) == near(0.00525 / 100, {.relative = 1e-12}));
    CHECK(fluids.foreign_share(0) == 0);
    CHECK(fluids.washed_ml() == near(0.09475, {.relative = 1e-12}));
    CHECK(fluids.enter(2, 100) == 0);
}

TEST_CASE("a brush returns its share to the vat: less is lost, washed off and carried over") {
    const auto printer = printer_with_film();
    Fluids fluids(printer);
    CHECK(fluids.leave(0, 1000, 0.29) == near(0.071, {.relative = 1e-12}));
    CHECK(fluids.brushed_ml() == near(0.029, {.relative = 1e-12}));
    fluids.clean(15);
    CHECK(fluids.washed_ml() / (0.071 * 0.9475) == near(1, {.relative = 1e-12}));
    CHECK(fluids.enter(1, 100) / (0.071 * 0.0525) == near(1, {.relative = 1e-12}));
}

TEST_CASE("solution that holds resin cleans less, and carries resins into other vats") {
    auto printer = printer_with_film();
    printer.solution = {100, 100, 0, 0, 0, 0, 1, 0, 0};
    Fluids fluids(printer);
    for (int i = 0; i < 200; ++i) {
        fluids.leave(0, 1000);
        fluids.clean(15);
        fluids.wipe();
    }
    const double c = fluids.solution().resin_share();
    CHECK(c > 0.1);
    CHECK(c < 0.17);  // 200 times 0.09475 ml, less what stays on the part, in 100 ml
    fluids.leave(1, 1000);
    CHECK(fluids.clean(15) / (1 - 0.9475 * (1 - c)) == near(1, {.relative = 1e-12}));
    fluids.enter(2, 100);
    CHECK(fluids.share(2, 0) / (0.1 * 0.9475 * c / 100) == near(1, {.relative = 1e-3}));
    CHECK(fluids.share(2, 1) / (0.1 * 0.0525 / 100) == near(1, {.relative = 1e-3}));
    fluids.care(machine::SolutionCare::change);
    fluids.leave(1, 1000);
    CHECK(fluids.clean(15) == near(0.0525, {.relative = 1e-12}));
}

TEST_CASE("resin in used solution counts as foreign resin") {
    auto printer = printer_with_film();
    printer.solution = {100, 100, 0.2, 0, 0, 0, 1, 0, 0};
    Fluids fluids(printer);
    fluids.leave(0, 1000);
    fluids.clean(15);
    CHECK(fluids.enter(1, 100) / (0.1 * (0.0525 + 0.9475 * 0.2)) == near(1, {.relative = 1e-12}));
    CHECK(fluids.foreign_share(1) > 0.0002);
}

TEST_CASE("without cleaning the whole film is carried over, from vat to vat") {
    const auto printer = printer_with_film();
    Fluids fluids(printer);
    fluids.leave(0, 1000);
    fluids.enter(1, 0.9);
    CHECK(fluids.foreign_share(1) == near(0.1, {.relative = 1e-12}));
    fluids.leave(1, 1000);
    fluids.enter(2, 0.9);
    CHECK(fluids.share(2, 1) == near(0.09, {.relative = 1e-12}));
    CHECK(fluids.share(2, 0) == near(0.01, {.relative = 1e-12}));
}

TEST_CASE("fresh resin dilutes contamination; removing the part removes its film") {
    const auto printer = printer_with_film();
    Fluids fluids(printer);
    fluids.leave(0, 1000);
    fluids.enter(1, 0.9);
    REQUIRE(fluids.foreign_share(1) == near(0.1, {.relative = 1e-12}));
    fluids.pour(1, 1, 3);
    CHECK(fluids.foreign_share(1) == near(0.025, {.relative = 1e-12}));
    fluids.pour(1, 4, 0);
    CHECK(fluids.foreign_share(1) == near(0.025, {.relative = 1e-12}));
    fluids.leave(1, 1000);
    fluids.wipe();
    CHECK(fluids.enter(2, 100) == 0);
}

TEST_CASE("faults are parsed from the command line") {
    CHECK(parse_fault("stall:40:90")->kind == Fault::Kind::stall);
    CHECK(parse_fault("stall:40:90")->n == 40);
    CHECK(parse_fault("stall:40:90")->amount == 90);
    CHECK(parse_fault("dead-pump")->n == 1);
    for (const char* bad : {"", "dead", "stall:0", "stall:x", "stall:1:-3", "stall:1:nan", "stall:1:2:3"}) {
        CHECK_FALSE(parse_fault(bad));
    }
    CHECK(parse_fault("pump").error().message.find("dead-pump") != std::string::npos);
}
