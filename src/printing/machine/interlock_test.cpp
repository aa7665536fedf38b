#include "printing/machine/interlock.hpp"

#include <doctest/doctest.h>

using namespace pliant;
using namespace pliant::machine;

namespace {

/// The tower of examples/printers/tower.toml: X 0..355.6 mm, hooks 29.5 mm, slot n at 30 + (n-1) 203.2 mm.
struct Bench {
    Printer printer = load_printer("examples/printers/tower.toml").value();
    Interlock lock{printer, {{100000, 50000, 300000}}};

    Status go(Axis axis, int um) {
        Position to = lock.position();
        to[axis] = um;
        return lock.move(to);
    }
    void must(Axis axis, int um) {
        const Status status = go(axis, um);
        REQUIRE_MESSAGE(status, (status ? "" : status.error().message));
    }
    bool refused(Axis axis, int um, std::string_view why) {
        const Position before = lock.position();
        const Status status = go(axis, um);
        CHECK(lock.position() == before);
        INFO((status ? std::string("accepted") : status.error().message));
        const bool good = !status && status.error().message.find(why) != std::string::npos;
        CHECK(good);
        return good;
    }
    void home() {
        REQUIRE(lock.home(Axis::platform));
        REQUIRE(lock.home(Axis::carriage));
        REQUIRE(lock.home(Axis::tower));
    }
    /// Fetches the vat of slot 1 and brings it under the platform.
    void load() {
        must(Axis::tower, 500);  // 30 - 29.5 mm
        must(Axis::carriage, 355600);
        must(Axis::tower, 30000);
        must(Axis::carriage, 0);
    }
};

}  // namespace

TEST_CASE("an axis moves only after homing, and axes are homed in order") {
    Bench b;
    CHECK(b.refused(Axis::tower, 10000, "before it is homed"));
    CHECK_FALSE(b.lock.home(Axis::carriage));
    CHECK_FALSE(b.lock.home(Axis::tower));
    CHECK(b.lock.home(Axis::platform));
    CHECK_FALSE(b.lock.home(Axis::tower));
    CHECK(b.lock.home(Axis::carriage));
    CHECK(b.lock.home(Axis::tower));
    CHECK(b.lock.position() == Position{{0, 400000, 0}});
}

TEST_CASE("no axis moves outside its travel") {
    Bench b;
    b.home();
    CHECK(b.refused(Axis::platform, -1, "outside its travel"));
    CHECK(b.refused(Axis::platform, 400001, "outside its travel"));
    CHECK(b.refused(Axis::tower, 1460001, "outside its travel"));
}

TEST_CASE("a vat is taken from its slot and put back") {
    Bench b;
    b.home();
    b.load();
    CHECK(b.lock.hooked_vat() == 0);
    CHECK_FALSE(b.lock.vat_in_slot(1));
    b.must(Axis::carriage, 355600);
    b.must(Axis::tower, 500);
    CHECK_FALSE(b.lock.hooked_vat());
    CHECK(b.lock.vat_in_slot(1) == 0);
}

TEST_CASE("the tower does not move while a vat is hooked or the carriage is at the tower") {
    Bench b;
    b.home();
    b.must(Axis::tower, 500);
    b.must(Axis::carriage, 355600);
    CHECK(b.refused(Axis::tower, 203700, "the carriage stands at it"));
    b.must(Axis::tower, 30000);
    CHECK(b.refused(Axis::tower, 40000, "a vat is hooked"));
    b.must(Axis::carriage, 200000);
    CHECK(b.refused(Axis::tower, 29000, "a vat is hooked"));
    b.must(Axis::carriage, 0);
    CHECK(b.refused(Axis::tower, 0, "a vat is hooked"));
}

TEST_CASE("the carriage enters the tower only with clear hooks, or with a vat for a level, empty slot") {
    Bench b;
    b.home();
    CHECK(b.refused(Axis::carriage, 355600, "hooks not clear"));
    b.must(Axis::carriage, 340600);
    CHECK(b.refused(Axis::carriage, 340601, "hooks not clear"));
    b.must(Axis::carriage, 0);
    b.load();
    b.must(Axis::carriage, 355600);
    b.must(Axis::tower, 20000);  // half off the hooks
    CHECK(b.refused(Axis::carriage, 340600, "no slot is level"));
}

TEST_CASE("with the platform in the vat the carriage moves only within the shear stroke") {
    Bench b;
    b.home();
    b.load();
    b.must(Axis::platform, 50);
    b.must(Axis::carriage, 2000);
    CHECK(b.refused(Axis::carriage, 2001, "the platform is down"));
    b.must(Axis::carriage, 0);
    b.must(Axis::platform, 84550);
    b.must(Axis::carriage, 2001);
    CHECK(b.refused(Axis::platform, 84549, "the platform is down"));
}

TEST_CASE("with a brush the part may be 1 mm above the rim, only while the vat goes into the tower") {
    Bench b;
    b.home();
    b.load();
    b.must(Axis::platform, 1000);
    REQUIRE(b.lock.light_on(false));
    b.lock.light_off();
    // A part of 1 mm above the vat's wall of 82.55 mm, 1 mm above the rim.
    b.must(Axis::platform, 84549);
    CHECK(b.refused(Axis::carriage, 355600, "the platform is down"));
    b.must(Axis::platform, 84550);
    b.must(Axis::carriage, 355600);
    CHECK(b.refused(Axis::carriage, 300000, "the platform is down"));  // not back under the brush
    b.must(Axis::tower, 500);
    CHECK(b.refused(Axis::carriage, 340600, "the platform is down"));
    b.must(Axis::platform, 85550);
    b.must(Axis::carriage, 340600);
    CHECK(b.refused(Axis::platform, 85549, "the platform is down"));
}

TEST_CASE("the height needed above a vat grows with the part, and the part is not pressed onto the floor") {
    Bench b;
    b.printer.cleaning.brush = false;
    b.home();
    b.load();
    b.must(Axis::platform, 1000);
    REQUIRE(b.lock.light_on(false));
    b.lock.light_off();
    CHECK(b.lock.part_height_um() == 1000);
    CHECK(b.refused(Axis::platform, 999, "press a part"));
    b.must(Axis::platform, 85549);
    CHECK(b.refused(Axis::carriage, 355600, "the platform is down"));
    b.must(Axis::platform, 85550);
    b.must(Axis::carriage, 355600);
}

TEST_CASE("an exposure needs a vat under the platform and no motion, and nothing moves during it") {
    Bench b;
    CHECK_FALSE(b.lock.light_on(false));
    b.home();
    CHECK_FALSE(b.lock.light_on(false));
    b.load();
    CHECK_FALSE(b.lock.light_on(true));
    CHECK_FALSE(b.lock.light_on(false));  // the platform is still at its home
    b.must(Axis::platform, 50);
    b.must(Axis::carriage, 1000);
    CHECK_FALSE(b.lock.light_on(false));
    b.must(Axis::carriage, 0);
    REQUIRE(b.lock.light_on(false));
    CHECK(b.refused(Axis::carriage, 1000, "light is on"));
    CHECK_FALSE(b.lock.home(Axis::platform));
    b.lock.light_off();
    b.must(Axis::carriage, 1000);
}

TEST_CASE("after an emergency stop the axes must be homed again") {
    Bench b;
    b.home();
    b.lock.stopped_at({{100, 300000, 0}});
    CHECK(b.refused(Axis::carriage, 0, "before"));
    CHECK(b.lock.position()[Axis::platform] == 300000);
}

TEST_CASE("after a restart a vat outside the tower is kept: the axes home, and the vat can be put back") {
    Bench b;
    b.home();
    b.load();
    b.must(Axis::carriage, 100000);  // half-way back into the tower, which is level
    b.lock.stopped_at({{90000, 200000, 30000}});
    REQUIRE(b.lock.home(Axis::platform));
    REQUIRE(b.lock.home(Axis::carriage));
    CHECK(b.lock.hooked_vat() == 0);
    REQUIRE(b.lock.home(Axis::tower));
    CHECK(b.refused(Axis::tower, 40000, "a vat is hooked"));   // no slot is level there
    CHECK(b.refused(Axis::tower, 233200, "a vat is hooked"));  // slot 2 is taken
    b.must(Axis::tower, 30000);
    b.must(Axis::carriage, 355600);
}

TEST_CASE("with a vat half-way on its hooks carriage and tower are not homed") {
    Bench b;
    b.home();
    b.load();
    b.must(Axis::carriage, 355600);
    b.lock.stopped_at({{355600, 200000, 20000}});
    CHECK(b.lock.in_hooks_stroke());
    REQUIRE(b.lock.home(Axis::platform));
    CHECK_FALSE(b.lock.home(Axis::carriage));
    CHECK_FALSE(b.lock.home(Axis::tower));
}

TEST_CASE("the interlocks' state is saved and restored") {
    Bench b;
    b.home();
    b.load();
    const Interlock::State state = b.lock.state();
    const Interlock again = Interlock::restored(b.printer, state).value();
    CHECK(again.hooked_vat() == 0);
    CHECK_FALSE(again.vat_in_slot(1));
    CHECK(again.vat_in_slot(2) == 1);
    CHECK(again.homed(Axis::tower));
    CHECK(again.position() == b.lock.position());
    Interlock::State wrong = state;
    wrong.hooked_vat = 9;
    CHECK_FALSE(Interlock::restored(b.printer, wrong));
    wrong = state;
    wrong.slots.pop_back();
    CHECK_FALSE(Interlock::restored(b.printer, wrong));
}
