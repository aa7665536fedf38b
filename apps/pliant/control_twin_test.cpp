// A print under control against the virtual printer, in one thread and on its clock: pauses, changes, cancelling, and
// resuming after every way to end.
#include <doctest/doctest.h>

#include <cstdlib>

#include "control_bench.hpp"

using namespace pliant;
using namespace pliant::app;

TEST_CASE("a print under control comes out as the plain one, and keeps a journal") {
    ControlBench b;
    b.start();
    CHECK(b.snapshot().finished);
    INFO(b.last_error());
    b.must_be_whole();
    CHECK(b.lights() == 10);
}

namespace {

/// Every deed of the host at its devices is a moment at which it may end; bench/kill_print.cpp takes all of them.
const long every = std::getenv("PLIANT_EVERY_MOMENT") != nullptr ? 1 : 7;

/// What cured, to be held against an undisturbed print.
std::string block_of(twin::Twin& twin) {
    std::string text;
    for (const twin::CuredLayer& layer : twin.cured().layers()) {
        text += fmt::format("{} {}\n", layer.top_um, layer.thickness_um);
        for (const twin::VatLayer& vat : layer.vats) {
            text += fmt::format(" vat {}:", vat.vat);
            for (const twin::Run& run : vat.runs)
                text += fmt::format(" {}/{}-{}={}", run.row, run.begin, run.end, run.value);
            text += "\n";
        }
    }
    return text;
}

}  // namespace

TEST_CASE("a host that is killed anywhere is followed by one that finishes the same part") {
    ControlBench undisturbed;
    undisturbed.start();
    const std::string whole = block_of(*undisturbed.twin);
    const long deeds = undisturbed.life->deeds;
    MESSAGE(deeds << " deeds in a print");
    int resumed = 0;
    for (long n = 1; n < deeds; n += every) {
        ControlBench b;
        b.life->dies_at = n;
        CAPTURE(n);
        REQUIRE_FALSE(b.start());
        b.new_host();
        if (!b.snapshot().can_resume) {
            b.start();  // nothing had begun
        } else {
            ++resumed;
            b.start({true, {}});
        }
        INFO(b.last_error());
        CHECK(b.snapshot().finished);
        CHECK(block_of(*b.twin) == whole);
        b.must_be_whole();
    }
    CHECK(resumed > deeds / every / 2);
}

TEST_CASE("the controller restarts anywhere: the print stops dark, and goes on if no vat hung half on its hooks") {
    ControlBench undisturbed;
    undisturbed.start();
    const std::string whole = block_of(*undisturbed.twin);
    const long deeds = undisturbed.life->deeds;
    int resumed = 0, refused = 0, before = 0;
    for (long n = 1; n < deeds; n += every) {
        ControlBench b;
        b.life->at_deed = [&](long deed) {
            if (deed == n) b.twin->reset();
        };
        CAPTURE(n);
        REQUIRE(b.start());
        if (b.snapshot().finished) {  // before anything had moved, or after it had
            ++before;
            CHECK(block_of(*b.twin) == whole);
            continue;
        }
        CHECK_FALSE(b.projector->lit);
        b.life->at_deed = {};
        REQUIRE(b.snapshot().can_resume);
        b.start({true, {}});
        INFO(b.last_error());
        if (b.last_error().find("half-way on the hooks") != std::string::npos) {
            ++refused;
            continue;
        }
        ++resumed;
        CHECK(b.snapshot().finished);
        CHECK(block_of(*b.twin) == whole);
        b.must_be_whole();
    }
    MESSAGE(resumed << " resumed, " << refused << " refused, " << before << " not disturbed");
    CHECK(resumed > deeds / every / 2);
    CHECK(refused < deeds / every / 10);
}

TEST_CASE("a power cut anywhere: a light that nobody saw the end of is asked about, all else goes on") {
    ControlBench undisturbed;
    undisturbed.start();
    const std::string whole = block_of(*undisturbed.twin);
    const long deeds = undisturbed.life->deeds;
    int asked = 0, refused = 0, resumed = 0;
    for (long n = 1; n < deeds; n += every) {
        ControlBench b;
        b.guarded = false;
        b.new_host();
        double lit_since_s = 0, lit_s = 0;
        b.life->dies_at = n;
        b.life->at_deed = [&](long) {
            if (!b.projector->lit) lit_since_s = b.twin->now();
        };
        b.life->on_death = [&] {
            lit_s = b.projector->lit ? b.twin->now() - lit_since_s : 0;
            b.twin->light_off();
            b.twin->reset();
        };
        CAPTURE(n);
        REQUIRE_FALSE(b.start());
        b.new_host();
        if (!b.snapshot().can_resume) continue;
        b.start({true, {}});
        if (b.last_error().find("nobody saw how long") != std::string::npos) {
            ++asked;
            CHECK(b.snapshot().state == host::State::offline);  // nothing has been touched
            b.start({true, {lit_s, false}});
        }
        INFO(b.last_error());
        if (b.last_error().find("half-way on the hooks") != std::string::npos) {
            ++refused;
            continue;
        }
        ++resumed;
        CHECK(b.snapshot().finished);
        CHECK(block_of(*b.twin) == whole);
        b.must_be_whole();
    }
    MESSAGE(resumed << " resumed, " << asked << " asked about, " << refused << " refused");
    CHECK(asked > 10 / every);
}
