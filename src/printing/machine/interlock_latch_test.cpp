// What the magnet and the retriever of a wall must never do.
#include <doctest/doctest.h>

#include "printing/machine/interlock.hpp"
#include "printing/machine/settling.hpp"

using namespace pliant;
using namespace pliant::machine;

namespace {

struct LatchBench {
    Printer printer;
    Interlock lock;

    explicit LatchBench(const char* name)
        : printer(load_printer(std::string("examples/printers/") + name + ".toml").value()), lock(printer) {
        for (const Axis axis : homing_order(printer)) must(lock.home(axis));
    }
    static void must(const Status& status) { REQUIRE_MESSAGE(status, (status ? "" : status.error().message)); }
    void go(Axis axis, int um) { must(try_go(axis, um)); }
    Status try_go(Axis axis, int um) {
        Position to = lock.position();
        to[axis] = um;
        return lock.move(to);
    }
    static void refused(const Status& status, std::string_view why) {
        INFO((status ? std::string("accepted") : status.error().message));
        const bool good = !status && status.error().message.find(why) != std::string::npos;
        CHECK(good);
    }
};

/// Fetches the vat of slot 1 with the magnet, as far as the tower.
void take_by_magnet(LatchBench& b) {
    b.go(Axis::tower, b.printer.level_um(1));
    b.go(Axis::carriage, b.printer.carriage.tower_um);
    b.must(b.lock.magnet(true));
}

}  // namespace

TEST_CASE("a magnet takes only the vat level with it, and releases it only in its slot") {
    LatchBench b("tower_magnet");
    b.refused(b.lock.magnet(true), "no vat before it");
    b.must(b.lock.magnet(false));
    b.go(Axis::tower, b.printer.level_um(5));  // an empty slot
    b.go(Axis::carriage, b.printer.carriage.tower_um);
    b.refused(b.lock.magnet(true), "no vat before it");
    b.go(Axis::carriage, 0);
    take_by_magnet(b);
    CHECK(b.lock.hooked_vat() == 0);
    CHECK_FALSE(b.lock.vat_in_slot(1));
    b.refused(b.try_go(Axis::tower, b.printer.level_um(1) - 1000), "the tower moves while a vat is hooked");
    b.go(Axis::carriage, 0);
    b.refused(b.lock.magnet(false), "switched off while it holds a vat outside its slot");
    CHECK(b.lock.magnet_holds());
    b.go(Axis::carriage, 100000);
    b.refused(b.lock.magnet(false), "outside its slot");
    b.go(Axis::carriage, b.printer.carriage.tower_um);
    b.must(b.lock.magnet(false));
    CHECK(b.lock.vat_in_slot(1) == 0);
    CHECK_FALSE(b.lock.hooked_vat());
    b.go(Axis::carriage, 0);
    b.go(Axis::tower, b.printer.level_um(2));
}

TEST_CASE("after a stop the carriage neither moves nor homes before the magnet is on again") {
    LatchBench b("tower_magnet");
    take_by_magnet(b);
    b.go(Axis::carriage, 0);
    b.lock.stopped_at(b.lock.position());
    CHECK(b.lock.hooked_vat() == 0);
    b.must(b.lock.home(Axis::platform));
    b.refused(b.lock.home(Axis::carriage), "that its magnet does not hold");
    b.must(b.lock.magnet(true));
    b.must(b.lock.home(Axis::carriage));
    const auto again = Interlock::restored(b.printer, b.lock.state());
    REQUIRE(again);
    CHECK(again->magnet_holds());
}

TEST_CASE("after a stop at the tower the magnet can take and release the vat that stands in its slot") {
    LatchBench b("tower_magnet");
    take_by_magnet(b);
    b.lock.stopped_at(b.lock.position());
    b.must(b.lock.magnet(false));
    CHECK(b.lock.vat_in_slot(1) == 0);
    CHECK_FALSE(b.lock.hooked_vat());
    b.must(b.lock.magnet(true));
    CHECK(b.lock.hooked_vat() == 0);
    b.must(b.lock.home(Axis::platform));
    b.must(b.lock.home(Axis::carriage));
    b.refused(b.lock.magnet(false), "switched off while it holds a vat outside its slot");
}

TEST_CASE("axes wait until a magnet or fork has finished taking or releasing a vat") {
    LatchBench b("tower_magnet");
    Settling settling(b.printer);
    const Position here = b.lock.position();
    Position away = here, up = here;
    away[Axis::carriage] += 1000;
    up[Axis::platform] -= 1000;
    settling.note(parse_command(b.printer.hooks.magnet.coil.on).value(), 10);
    CHECK_FALSE(settling.check(here, away, 10.19));
    CHECK(settling.check(here, away, 10.2));
    CHECK(settling.check(here, up, 10));
    settling.note(parse_command("M42 P11 S0").value(), 20);
    CHECK_FALSE(settling.check(here, away, 20.49));
    CHECK(settling.check(here, away, 20.5));
    const LatchBench wall("wall");
    Settling fork(wall.printer);
    Position along = here;
    along[Axis::table] += 1000;
    fork.note(parse_command(wall.printer.wall.fork.on).value(), 5);
    CHECK_FALSE(fork.check(here, along, 6.49));
    CHECK(fork.check(here, along, 6.5));
}

TEST_CASE("a retriever takes a vat from its place in the wall and brings it back") {
    LatchBench b("wall");
    const int row_um = b.printer.row_um(7), column_um = b.printer.column_um(7), low_um = row_um - 20000;
    CHECK(row_um == 50000 + 152400);         // slot 7: second row,
    CHECK(column_um == 20000 + 2 * 355600);  // third column
    b.refused(b.lock.fork(true), "where no place is before it");
    b.go(Axis::table, column_um);
    b.go(Axis::tower, row_um);
    b.refused(b.lock.fork(true), "with the lift not lowered");
    b.go(Axis::tower, low_um);
    b.must(b.lock.fork(true));
    b.refused(b.try_go(Axis::table, 0), "the rail moves with the fork in the wall");
    b.refused(b.try_go(Axis::tower, 0), "the lift leaves its place");
    b.refused(b.lock.home(Axis::tower), "with the fork in the wall");
    b.go(Axis::tower, low_um + 10000);
    b.refused(b.lock.fork(false), "with the lift not lowered");
    CHECK_FALSE(b.lock.tray_vat());
    b.go(Axis::tower, row_um);
    CHECK(b.lock.tray_vat() == 2);
    CHECK_FALSE(b.lock.vat_in_slot(7));
    b.must(b.lock.fork(false));
    b.refused(b.try_go(Axis::carriage, b.printer.carriage.tower_um), "with the hooks not clear");
    b.go(Axis::table, b.printer.wall.bay_rail_um);
    b.go(Axis::tower, b.printer.wall.bay_lift_um - b.printer.hooks.travel_um);
    b.go(Axis::carriage, b.printer.carriage.tower_um);
    b.refused(b.try_go(Axis::table, 0), "the rail moves while the carriage stands before it");
    b.go(Axis::tower, b.printer.wall.bay_lift_um);
    CHECK(b.lock.hooked_vat() == 2);
    b.refused(b.try_go(Axis::table, 0), "the rail moves while a vat is hooked");
    b.go(Axis::carriage, 0);
    // While the vat lies under the platform the retriever is free, but must be back for it.
    b.go(Axis::table, 0);
    b.refused(b.try_go(Axis::carriage, b.printer.carriage.tower_um), "no slot is level");
}

TEST_CASE("a retriever puts a vat only into an empty place, and takes none from an empty place") {
    LatchBench b("wall");
    const auto before = [&](int slot, int lower_um) {
        b.go(Axis::table, b.printer.column_um(slot));
        b.go(Axis::tower, b.printer.row_um(slot) - lower_um);
    };
    before(3, 20000);
    b.refused(b.lock.fork(true), "slot 3 is empty");
    before(1, 20000);
    b.must(b.lock.fork(true));
    b.go(Axis::tower, b.printer.row_um(1));
    b.must(b.lock.fork(false));
    before(2, 0);
    b.refused(b.lock.fork(true), "slot 2 is taken already");
    before(3, 0);
    b.must(b.lock.fork(true));
    b.go(Axis::tower, b.printer.row_um(3) - 20000);
    b.must(b.lock.fork(false));
    CHECK(b.lock.vat_in_slot(3) == 0);
    CHECK_FALSE(b.lock.tray_vat());
}
