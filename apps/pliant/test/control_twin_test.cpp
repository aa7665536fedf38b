// A controlled print on the virtual printer, in one thread and on its clock: pauses, changes, cancelling, and resuming
// after every kind of interruption.
#include <doctest/doctest.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>

#include "base/core/files.hpp"
#include "base/core/near.hpp"
#include "control_bench.hpp"
#include "printing/host/control_api.hpp"

using namespace pliant;
using namespace pliant::app;

TEST_CASE("a print through the control gives the same part as a plain print, and keeps a journal") {
    ControlBench b;
    b.must_finish();
    CHECK(b.lights() == 10);
}

namespace {

/// The host may be killed at each of its device operations; bench/kill_print.cpp tries all of them.
const long moment_stride = std::getenv("PLIANT_EVERY_MOMENT") != nullptr ? 1 : 7;

/// The cured block, for comparison with an undisturbed print.
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

constexpr std::array both_releases = {machine::MarlinRelease::v2_1_1, machine::MarlinRelease::v2_1_2};

/// Alternates between firmware releases along the moments of a print.
machine::MarlinRelease release_at(long moment) {
    return both_releases[static_cast<std::size_t>(moment / moment_stride % 2)];
}

twin::Options options_of(machine::MarlinRelease release) {
    twin::Options options;
    options.release = release;
    return options;
}

twin::Options faulty(twin::Fault::Kind kind, int n, double amount = 0) {
    twin::Options options;
    options.faults = {{kind, n, amount}};
    return options;
}

/// False if a vat was stuck half-way on its hooks; else the part must equal the undisturbed one.
bool has_gone_on(ControlBench& b, const std::string& whole) {
    INFO(b.last_error());
    if (b.last_error().find("half-way on the hooks") != std::string::npos) return false;
    CHECK(b.snapshot().finished);
    CHECK(block_of(*b.twin) == whole);
    b.must_be_whole();
    return true;
}

}  // namespace

TEST_CASE("after a host is killed at any point, the next host finishes the same part") {
    ControlBench undisturbed;
    undisturbed.start();
    const std::string whole = block_of(*undisturbed.twin);
    const long deeds = undisturbed.life->deeds;
    MESSAGE(deeds << " deeds in a print");
    int resumed = 0;
    for (long n = 1; n < deeds; n += moment_stride) {
        ControlBench b(options_of(release_at(n)));
        b.life->dies_at = n;
        CAPTURE(n);
        REQUIRE_FALSE(b.start());
        b.new_host();
        if (!b.snapshot().can_resume) {
            b.start();  // the print had not begun
        } else {
            ++resumed;
            b.start({true, {}});
        }
        INFO(b.last_error());
        CHECK(b.snapshot().finished);
        CHECK(block_of(*b.twin) == whole);
        b.must_be_whole();
    }
    CHECK(resumed > deeds / moment_stride / 2);
}

TEST_CASE("after a controller restart anywhere the light is off; the print resumes unless a vat is half hooked") {
    ControlBench undisturbed;
    undisturbed.start();
    const std::string whole = block_of(*undisturbed.twin);
    const long deeds = undisturbed.life->deeds;
    int resumed = 0, refused = 0, before = 0;
    for (long n = 1; n < deeds; n += moment_stride) {
        ControlBench b(options_of(release_at(n)));
        b.life->at_deed = [&](long deed) {
            if (deed == n) b.twin->reset();
        };
        CAPTURE(n);
        REQUIRE(b.start());
        if (b.snapshot().finished) {  // killed before the first or after the last motion
            ++before;
            CHECK(block_of(*b.twin) == whole);
            continue;
        }
        CHECK_FALSE(b.projector->lit);
        b.life->at_deed = {};
        const bool begun = b.snapshot().can_resume;
        if (!begun) CHECK(b.twin->log().homings == 0);
        b.start({begun, {}});
        const bool went_on = has_gone_on(b, whole);
        ++(went_on ? resumed : refused);
        if (went_on) continue;
        b.start();
        CHECK(b.last_error().find("this job was interrupted and cannot be resumed: ") != std::string::npos);
        CHECK(b.last_error().find("delete the journal and start the print anew") != std::string::npos);
    }
    MESSAGE(resumed << " resumed, " << refused << " refused, " << before << " not disturbed");
    CHECK(resumed > deeds / moment_stride / 2);
    CHECK(refused < deeds / moment_stride / 10);
}

TEST_CASE("after a restart anywhere in a swap by magnet the print resumes, unless the vat was on its way") {
    const auto bench = [](const std::vector<twin::Fault>& faults) {
        twin::Options options;
        options.faults = faults;
        return std::make_unique<ControlBench>(std::move(options), "tower_magnet", 2);
    };
    const auto undisturbed = bench({});
    undisturbed->start();
    const std::string whole = block_of(*undisturbed->twin);
    // Of four exposures the last three begin with a swap; the second one is in the middle of the print.
    const auto lines = static_cast<int>(undisturbed->snapshot().lines_sent);
    int resumed = 0, on_its_way = 0;
    for (int n = lines * 3 / 10; n < lines * 7 / 10; ++n) {
        CAPTURE(n);
        const auto b = bench({{twin::Fault::Kind::reset, n, 0}});
        REQUIRE(b->start());
        REQUIRE(b->snapshot().can_resume);
        b->start({true, {}});
        INFO(b->last_error());
        if (b->last_error().find("which has let it go") != std::string::npos) {
            ++on_its_way;
            continue;
        }
        ++resumed;
        CHECK(b->snapshot().finished);
        CHECK(block_of(*b->twin) == whole);
        CHECK(b->twin->log().violations.empty());
    }
    MESSAGE(resumed << " resumed, " << on_its_way << " with a vat on its way");
    CHECK(resumed > 10);
    CHECK(on_its_way > 0);
    CHECK(on_its_way < resumed);
}

TEST_CASE("after a power cut anywhere the print resumes; only an exposure of unknown length is asked about") {
    ControlBench undisturbed;
    undisturbed.start();
    const std::string whole = block_of(*undisturbed.twin);
    const long deeds = undisturbed.life->deeds;
    int asked = 0, refused = 0, resumed = 0;
    for (long n = 1; n < deeds; n += moment_stride) {
        ControlBench b(options_of(release_at(n)));
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
        if (b.last_error().find("is not recorded") != std::string::npos) {
            ++asked;
            CHECK(b.snapshot().state == host::State::offline);  // the machine was not touched
            b.start({true, {lit_s, false}});
        }
        ++(has_gone_on(b, whole) ? resumed : refused);
    }
    MESSAGE(resumed << " resumed, " << asked << " asked about, " << refused << " refused");
    CHECK(asked > 10 / moment_stride);
}

namespace {

using host::PauseWhen;
using host::Snapshot;
using host::State;

/// A person at the machine: acts once, at a given point of the print, and resumes every pause.
struct Operator {
    ControlBench& b;
    std::function<bool(const Snapshot&)> reached;
    std::function<void()> action;
    bool acted = false;
    bool was_paused = false;
    int pauses = 0;
    bool lit_while_paused = false;
    std::vector<std::string> prompts;

    Operator(ControlBench& bench, std::function<bool(const Snapshot&)> when, std::function<void()> what)
        : b(bench), reached(std::move(when)), action(std::move(what)) {
        b.life->at_look = [this] { look(); };
    }
    void look() {
        const Snapshot s = b.snapshot();
        if (!acted && reached(s)) acted = true, action();
        const bool paused = s.state == State::paused;
        lit_while_paused = lit_while_paused || (paused && b.projector->lit);
        if (paused && !was_paused) {
            ++pauses;
            prompts.push_back(s.prompt);
            CHECK(b.control->resume());
        }
        was_paused = paused;
    }
};

/// Between two exposures.
std::function<bool(const Snapshot&)> completion_above(double share) {
    return [share](const Snapshot& s) { return !s.lit && s.completion > share; };
}

std::function<bool(const Snapshot&)> lit_on_layer(int layer, double for_s = 0.5) {
    return [layer, for_s](const Snapshot& s) { return s.lit && s.layer == layer && s.lit_s > for_s; };
}

bool has_event(const ControlBench& b, const std::string& kind, const std::string& part) {
    for (const host::Event& event : b.control->events_since(0)) {
        if (event.kind == kind && event.text.find(part) != std::string::npos) return true;
    }
    return false;
}

}  // namespace

TEST_CASE("pausing, now or after the exposure, changes nothing in the part") {
    for (const auto how : {PauseWhen::now, PauseWhen::after_exposure}) {
        for (const double at : {0.05, 0.2, 0.31, 0.5, 0.77, 0.9}) {
            CAPTURE(at);
            ControlBench b;
            Operator person(b, completion_above(at), [&] { CHECK(b.control->pause(how)); });
            b.start();
            INFO(b.last_error());
            CHECK(person.pauses == 1);
            CHECK_FALSE(person.lit_while_paused);
            CHECK(b.snapshot().finished);
            b.must_be_whole();
            CHECK(b.lights() == 10);
        }
    }
}

TEST_CASE("a pause during an exposure: at once, with the rest exposed later, or after the exposure and the peel") {
    for (const auto how : {PauseWhen::now, PauseWhen::after_exposure}) {
        ControlBench b;
        Operator person(b, lit_on_layer(3), [&] { CHECK(b.control->pause(how)); });
        b.start();
        CHECK(person.pauses == 1);
        CHECK_FALSE(person.lit_while_paused);
        CHECK(b.lights() == (how == PauseWhen::now ? 11 : 10));
        b.must_be_whole();
        const twin::VatLayer& vat = b.twin->cured().layers()[3].vats[0];
        CHECK(vat.lit[0].seconds == near(2.5, {.relative = 0.01}));
    }
}

TEST_CASE("after cancelling anywhere the light is off, the machine is parked and every vat is in its slot") {
    for (double at = 0.02; at < 1; at += 0.07) {
        CAPTURE(at);
        ControlBench b;
        Operator person(b, completion_above(at), [&] { CHECK(b.control->cancel()); });
        b.start();
        INFO(b.last_error());
        CHECK(b.snapshot().state == State::idle);
        CHECK_FALSE(b.snapshot().finished);
        CHECK_FALSE(b.snapshot().can_resume);
        CHECK_FALSE(b.projector->lit);
        CHECK_FALSE(b.twin->interlock().hooked_vat());
        CHECK_FALSE(b.twin->interlock().pump_runs());
        CHECK(b.twin->log().violations.empty());
        b.start({true, {}});
        CHECK(b.last_error().find("cancelled") != std::string::npos);
    }
}

TEST_CASE("a suspended print parks the machine, and resumes from the same place") {
    for (const double at : {0.1, 0.35, 0.6, 0.85}) {
        CAPTURE(at);
        ControlBench b;
        Operator person(b, completion_above(at), [&] { CHECK(b.control->suspend()); });
        b.start();
        CHECK_FALSE(b.twin->interlock().hooked_vat());
        REQUIRE(b.snapshot().can_resume);
        CHECK_FALSE(b.control->home({}));  // no manual control while a print waits
        b.must_finish({true, {}});
    }
}

TEST_CASE("a print that is ended while it resumes parks once the axes are homed, and resumes from the same place") {
    for (const char* name : {"tower", "tower_magnet", "wall", "carousel", "rotary", "two_towers"}) {
        CAPTURE(std::string(name));
        ControlBench undisturbed({}, name, 3);
        undisturbed.start();
        const std::string whole = block_of(*undisturbed.twin);
        const auto until_suspended = [&] {
            auto b = std::make_unique<ControlBench>(twin::Options{}, name, 3);
            Operator person(*b, completion_above(0.55), [&] { CHECK(b->control->suspend()); });
            b->start();
            REQUIRE(b->snapshot().can_resume);
            b->new_host();
            return b;
        };
        // The looks of a host while it resumes, up to the first light.
        int first = 0, last = 0;
        {
            const auto b = until_suspended();
            const int lights = b->lights();
            int looks = 0;
            b->life->at_look = [&] {
                ++looks;
                const bool resumes = b->snapshot().message.starts_with("resuming: ");
                if (resumes && first == 0) first = looks;
                if (resumes && b->lights() == lights) last = looks;
            };
            b->must_finish({true, {}});
        }
        REQUIRE(last > first);
        for (int n = first; n <= last; n += std::max(1, (last - first) / 8)) {
            CAPTURE(n);
            const auto b = until_suspended();
            int looks = 0;
            b->life->at_look = [&] {
                if (++looks == n) CHECK(b->control->suspend());
            };
            b->start({true, {}});
            INFO(b->last_error());
            CHECK(b->snapshot().state == State::idle);
            REQUIRE(b->snapshot().can_resume);
            CHECK_FALSE(b->twin->interlock().pump_runs());
            if (b->printer.has_carriage()) CHECK_FALSE(b->twin->interlock().hooked_vat());
            b->life->at_look = {};
            b->must_finish({true, {}});
            CHECK(b->twin->log().violations.empty());
            CHECK(block_of(*b->twin) == whole);
        }
    }
}

TEST_CASE("a print that has resumed no longer says that it resumes, and tells at once where it was") {
    ControlBench b;
    Operator person(b, lit_on_layer(2), [&] { CHECK(b.control->suspend()); });
    b.start();
    b.new_host();
    std::string first, lit;
    std::optional<int> layer;
    b.life->at_look = [&] {
        const Snapshot s = b.snapshot();
        if (first.empty()) first = s.message;
        if (s.state == State::printing && !first.empty() && !layer) layer = s.layer;
        if (s.lit) lit += s.message;
    };
    b.must_finish({true, {}});
    CHECK(first.starts_with("resuming: "));
    CHECK(lit.empty());
    CHECK(layer == 2);
}

TEST_CASE("in a pause before an exposure the image is still the last one shown, and its time that of all its pieces") {
    ControlBench b;
    std::string before, paused;
    double lit_s = 0;
    b.life->at_look = [&] {
        const Snapshot s = b.snapshot();
        if (s.state == State::paused) {
            paused = s.image;
            lit_s = s.lit_s;
            (void)b.control->resume();
        }
        if (s.lit && s.layer == 2) before = s.image;
        if (!s.lit && s.layer == 3 && paused.empty()) (void)b.control->pause(PauseWhen::now);
    };
    b.start();
    CHECK(b.snapshot().finished);
    CHECK_FALSE(before.empty());
    CHECK(paused == before);
    CHECK(lit_s == near(2.5, {.relative = 0.01}));

    ControlBench pieces;
    Operator person(pieces, lit_on_layer(4, 1), [&] { CHECK(pieces.control->pause(PauseWhen::now)); });
    pieces.start();
    CHECK(person.pauses == 1);
    CHECK(pieces.snapshot().lit_s == near(2.5, {.relative = 0.01}));
}

TEST_CASE("after a print was resumed, a layer that had begun gets no changes, and resin is not asked for again") {
    ControlBench b;
    b.refills = {{3, 1, "refill the vat of slot 1 with x"}};
    b.new_host();
    std::vector<std::string> prompts;
    bool suspended = false, was_paused = false;
    const auto answer = [&](const Snapshot& s) {
        const bool paused = s.state == State::paused;
        if (paused && !std::exchange(was_paused, true) && b.control->resume()) prompts.push_back(s.prompt);
        was_paused = paused;
    };
    b.life->at_look = [&] {
        const Snapshot s = b.snapshot();
        answer(s);
        if (s.lit && s.layer == 3 && s.material == 0 && !std::exchange(suspended, true)) CHECK(b.control->suspend());
    };
    b.start();
    REQUIRE(b.snapshot().can_resume);
    REQUIRE(prompts.size() == 1);
    b.new_host();
    bool asked = false;
    b.life->at_look = [&] {
        answer(b.snapshot());
        if (b.snapshot().state != State::printing || std::exchange(asked, true)) return;
        CHECK(b.control->set_exposure(1, 3.5));
    };
    b.start({true, {}});
    INFO(b.last_error());
    CHECK(b.snapshot().finished);
    CHECK(prompts.size() == 1);
    CHECK(has_event(b, "log", "from layer 5 on, rigid is exposed for 3.5 s"));
    CHECK(b.twin->cured().layers()[3].vats[1].lit[0].seconds == near(2.5, {.relative = 0.01}));
    CHECK(b.twin->cured().layers()[4].vats[1].lit[0].seconds == near(3.5, {.relative = 0.01}));
}

TEST_CASE(
    "a refill that was asked for before the print was suspended is asked for again unless it is known to be done") {
    for (const bool has_refilled : {false, true}) {
        CAPTURE(has_refilled);
        ControlBench b;
        b.refills = {{3, 1, "refill the vat of slot 1 with x"}};
        b.new_host();
        bool suspended = false;
        b.life->at_look = [&] {
            if (b.snapshot().state == State::paused && !std::exchange(suspended, true)) CHECK(b.control->suspend());
        };
        b.start();
        REQUIRE(b.snapshot().can_resume);
        b.new_host();
        int prompts = 0;
        b.life->at_look = [&] {
            if (b.snapshot().state == State::paused && b.control->resume()) ++prompts;
        };
        b.start({true, {}, has_refilled});
        INFO(b.last_error());
        CHECK(b.snapshot().finished);
        CHECK((prompts == 0) == has_refilled);
        b.must_be_whole();
    }
}

TEST_CASE("a start that is refused because a print waits does not lose what it had come to") {
    ControlBench b;
    Operator person(b, lit_on_layer(2), [&] { CHECK(b.control->suspend()); });
    b.start();
    const Snapshot waits = b.snapshot();
    b.life->at_look = {};
    b.start();
    CHECK(b.last_error().find("--resume") != std::string::npos);
    CHECK(b.snapshot().layer == waits.layer);
    CHECK(b.snapshot().completion == waits.completion);
    b.must_finish({true, {}});
}

namespace {

/// Suspends a print half-way; its host then idles for ten minutes, asking for the switches.
void suspend_and_idle(ControlBench& b) {
    constexpr double idle_s = 600;
    Operator person(b, completion_above(0.5), [&] { CHECK(b.control->suspend()); });
    b.start();
    REQUIRE(b.snapshot().can_resume);
    const double until_s = b.twin->now() + idle_s;
    b.life->at_look = [&b, until_s] {
        if (b.twin->now() > until_s) throw Killed();
    };
    CHECK_THROWS_AS(b.control->serve(), Killed);
    b.life->at_look = {};
}

}  // namespace

TEST_CASE("a suspended print resumes however long its host has idled, there or on another host") {
    for (const auto release : both_releases) {
        for (const bool same_host : {true, false}) {
            CAPTURE(same_host);
            ControlBench b(options_of(release));
            suspend_and_idle(b);
            if (!same_host) b.new_host();
            b.must_finish({true, {}});
            CHECK(b.lights() == 10);
        }
    }
}

TEST_CASE("another program that uses the controller while its host idles is found, by either host") {
    for (const char* other : {"M110 N500\n", "M110 N90000000\n"}) {
        for (const bool same_host : {true, false}) {
            CAPTURE(same_host);
            ControlBench b;
            suspend_and_idle(b);
            b.twin->receive(other);
            b.twin->advance_to(b.twin->now() + 30);
            if (!same_host) b.new_host();
            b.start({true, {}});
            CHECK(b.last_error().find("another program has used") != std::string::npos);
            b.must_finish({true, {std::nullopt, true}});
        }
    }
}

TEST_CASE("an interrupted print can be cancelled for good") {
    ControlBench b;
    b.must_die(300);
    b.new_host();
    REQUIRE(b.control->connect());
    b.control->serve_until_idle();
    REQUIRE(b.control->cancel());
    b.control->serve_until_idle();
    INFO(b.last_error());
    CHECK_FALSE(b.snapshot().can_resume);
    CHECK_FALSE(b.twin->interlock().hooked_vat());
    CHECK(b.twin->log().violations.empty());
}

TEST_CASE("an emergency stop turns the light off and halts the board at once; after a reset the print resumes") {
    ControlBench b;
    double stopped_s = 0, dark_s = 0;
    Operator person(b, lit_on_layer(2), [&] {
        stopped_s = b.twin->now();
        b.control->emergency_stop();
    });
    b.life->at_deed = [&](long) {};
    b.start();
    dark_s = b.twin->now();
    CHECK(b.snapshot().state == State::halted);
    CHECK_FALSE(b.projector->lit);
    CHECK(dark_s - stopped_s < 0.1);
    CHECK(b.last_error().find("emergency stop: the board is halted; reset it") == 0);
    b.twin->reset();
    b.life->at_look = {};
    b.start({true, {}});
    INFO(b.last_error());
    CHECK(b.snapshot().finished);
    CHECK(b.lights() == 11);
    b.must_be_whole();
}

namespace {

class CountingLine final : public host::EmergencyLine {
public:
    [[nodiscard]] Status release() override {
        pulled = false;
        return works ? Status{} : Status(failure("emergency line: the device is gone"));
    }
    [[nodiscard]] Status pull() override {
        ++pulls;
        pulled = true;
        return release_before_m112 ? release_before_m112() : Status{};
    }
    int pulls = 0;
    bool pulled = false, works = true;
    std::function<Status()> release_before_m112;
};

}  // namespace

TEST_CASE("after an emergency stop in a move the axis stops there; resuming before a reset gives the remedy") {
    for (const auto release : both_releases) {
        ControlBench b(options_of(release));
        int moving_um = 0;
        Operator person(b, completion_above(0.4), [&] {
            b.twin->advance_to(b.twin->now() + 0.1);
            moving_um = b.twin->motors_position()[machine::Axis::platform];
            b.control->emergency_stop();
        });
        b.start();
        CHECK(person.acted);
        CHECK(b.twin->interlock().position()[machine::Axis::platform] == moving_um);
        CHECK(b.snapshot().can_resume);
        b.life->at_look = {};
        for (const bool same_host : {true, false}) {
            if (!same_host) b.new_host();
            const double before_s = b.twin->now();
            b.start({true, {}});
            CHECK(b.twin->now() - before_s < 15);
            CHECK(b.last_error().find("was halted, and has not been reset since") != std::string::npos);
            CHECK(b.last_error().find("baud") == std::string::npos);
            CHECK(b.snapshot().can_resume);
        }
        b.twin->reset();
        b.start({true, {}});
        if (b.last_error().find("half-way on the hooks") != std::string::npos) continue;
        CHECK(b.snapshot().finished);
        b.must_be_whole();
    }
}

TEST_CASE("homing to a dead switch stops within the time of the axis' travel, and the error names the switch") {
    for (const int which : {1, 2, 3}) {
        CAPTURE(which);
        ControlBench b(faulty(twin::Fault::Kind::dead_switch, which));
        b.start();
        const char* name = which == 1   ? "the carriage did not reach its switch (x_min)"
                           : which == 2 ? "the platform did not reach its switch (z_max)"
                                        : "the tower did not reach its switch (y_min)";
        CHECK(b.last_error().find("homing failed: ") == 0);
        CHECK(b.last_error().find(name) != std::string::npos);
        CHECK(b.last_error().find("reset the board") != std::string::npos);
        const machine::AxisSpec& spec = b.printer.axis(which == 1   ? machine::Axis::carriage
                                                       : which == 2 ? machine::Axis::platform
                                                                    : machine::Axis::tower);
        const double travel_s = (spec.max_um - spec.min_um) / 1000.0 / spec.homing_speed_mm_s;
        CHECK(b.twin->log().pushed_s > 0);
        CHECK(b.twin->log().pushed_s < 1.1 * travel_s + 10);
        b.twin->receive("M105\n");
        CHECK(b.twin->take_output().find("ok") == std::string::npos);  // halted
    }
    // Homing so fast that Marlin gives up before the host does: its message must not be lost.
    ControlBench b(faulty(twin::Fault::Kind::dead_switch, 1), "tower", 2, [](machine::Printer& printer) {
        printer.axes[static_cast<std::size_t>(machine::Axis::carriage)].homing_speed_mm_s = 200;
    });
    b.start();
    CHECK(b.last_error().find("homing failed: the carriage did not reach its switch (x_min)") == 0);
}

TEST_CASE("a failed start at the wrong port leaves no journal: the next start prints") {
    ControlBench b;
    b.life->unplugged = true;
    b.start();
    CHECK(b.last_error().find("the device is gone") != std::string::npos);
    CHECK_FALSE(b.snapshot().can_resume);
    b.life->unplugged = false;
    b.must_finish();
    // The same for a host killed before the first motion.
    ControlBench killed;
    killed.must_die(3);
    killed.new_host();
    CHECK_FALSE(killed.snapshot().can_resume);
    killed.must_finish();
}

TEST_CASE("a failed start leaves the journal of the print that finished before it") {
    ControlBench b;
    b.must_finish();
    const std::string finished = read_file(b.journal()).value();
    REQUIRE_FALSE(finished.empty());
    b.life->unplugged = true;
    b.start();
    CHECK(b.last_error().find("the device is gone") != std::string::npos);
    CHECK_FALSE(b.snapshot().begun_s);
    CHECK(read_file(b.journal()).value() == finished);
    CHECK_FALSE(b.snapshot().can_resume);
}

TEST_CASE("a board just started, one that resets when its port opens, and one losing 10 % of its oks all print") {
    for (const auto release : both_releases) {
        CAPTURE(machine::name_of(release));
        twin::Options options = options_of(release);
        options.boot_s = 1.5;
        options.homes_first = true;
        ControlBench fresh(options);
        fresh.must_finish();
        CHECK(fresh.snapshot().resends == 0);
        ControlBench resets(options);
        resets.at_open = [&] { resets.twin->reset(); };
        resets.must_die(300);
        resets.new_host();
        resets.must_finish({true, {}});
        CHECK(resets.twin->log().resets == 2);
        for (int n = 3; n < 3000; n += 10) options.faults.push_back({twin::Fault::Kind::lose_ok, n, 0});
        ControlBench lossy(options);
        lossy.must_finish();
        CHECK(lossy.snapshot().resends == 0);
    }
}

TEST_CASE("an ok that belongs to a killed host is not counted for the next host") {
    for (const auto release : both_releases) {
        for (long n = 200; n < 260; n += 7) {
            CAPTURE(n);
            twin::Options options = options_of(release);
            options.advanced_ok = true;
            ControlBench b(options);
            b.must_die(n);
            b.new_host();
            b.must_finish({true, {}});
            CHECK(b.snapshot().resends == 0);
        }
    }
}

TEST_CASE("the progress never stops for 10 s, never decreases and never passes what has been sent") {
    ControlBench b;
    double last = 0, longest_s = 0, moved_s = 0;
    b.life->at_look = [&] {
        const Snapshot s = b.snapshot();
        if (s.state != State::printing || s.completion >= 1) return;
        CHECK(s.completion >= last - 1e-12);
        if (s.completion > last) moved_s = b.twin->now();
        longest_s = std::max(longest_s, b.twin->now() - moved_s);
        last = s.completion;
    };
    b.start();
    CHECK(b.snapshot().finished);
    CHECK(last > 0.9);
    CHECK(longest_s < 10);
}

TEST_CASE("by hand: a second command during a long move stops the move; then the axes must be homed again") {
    ControlBench b;
    const auto serve = [&](Status status) {
        REQUIRE(status);
        b.control->serve_until_idle();
    };
    serve(b.control->connect());
    serve(b.control->home({}));
    const int top_um = b.snapshot().position[machine::Axis::platform];
    const double begin_s = b.twin->now();
    int refused = 0;
    b.life->at_look = [&] {
        if (b.twin->now() < begin_s + 3 || b.snapshot().state != State::working) return;
        const Status second = b.control->jog(machine::Axis::platform, 1000, 5);
        if (!second && second.error().message.find("is stopped instead") != std::string::npos) ++refused;
    };
    serve(b.control->jog(machine::Axis::platform, -200000, 5));
    b.life->at_look = {};
    CHECK(refused == 1);
    CHECK(b.snapshot().state == State::idle);
    CHECK(b.snapshot().message.find("stopped on its way") != std::string::npos);
    CHECK(b.twin->now() - begin_s < 6);  // not 40 s
    const int at_um = b.twin->interlock().position()[machine::Axis::platform];
    CHECK(top_um - at_um > 10000);
    CHECK(top_um - at_um < 20000);
    CHECK(b.snapshot().position[machine::Axis::platform] == near(at_um, {.relative = 0.0001}));
    serve(b.control->jog(machine::Axis::platform, -1000, 5));
    CHECK(b.snapshot().message.find("before it is homed") != std::string::npos);
    serve(b.control->home({}));
    serve(b.control->jog(machine::Axis::platform, -1000, 5));
    CHECK(b.snapshot().message.empty());
    CHECK(b.twin->log().violations.empty());
}

TEST_CASE("an emergency stop pulls the emergency line before it sends M112; connecting again releases the line") {
    CountingLine line;
    ControlBench b;
    b.emergency_line = &line;
    b.new_host();
    bool alive = false;
    line.release_before_m112 = [&]() -> Status {
        alive = !b.twin->log().power_cut;  // M112 would have switched off the board's own relay
        return {};
    };
    Operator person(b, lit_on_layer(1), [&] { b.control->emergency_stop(); });
    b.start();
    CHECK(line.pulls == 1);
    CHECK(line.pulled);
    CHECK(alive);
    CHECK(b.twin->log().power_cut);
    CHECK_FALSE(b.projector->lit);
    b.twin->reset();
    b.life->at_look = {};
    b.start({true, {}});
    CHECK_FALSE(line.pulled);
    CHECK(b.snapshot().finished);
    b.must_be_whole();
}

TEST_CASE("an emergency line whose device is gone is reported before anything moves") {
    CountingLine line;
    line.works = false;
    ControlBench b;
    b.emergency_line = &line;
    b.new_host();
    b.start();
    CHECK(b.last_error().find("the device is gone") != std::string::npos);
    CHECK(b.twin->log().homings == 0);
}

namespace {

void with_door(machine::Printer& printer) {
    printer.door.input = "y_max";
}

/// A person who constantly tries to resume, with a record of what happened.
struct OperatorAtOpenDoor {
    ControlBench& b;
    int refused = 0, paused = 0;
    bool lit_behind_door = false, moved = false;
    machine::Position at;

    explicit OperatorAtOpenDoor(ControlBench& bench) : b(bench) {
        b.life->at_look = [this] { look(); };
    }
    void look() {
        const Snapshot s = b.snapshot();
        if (s.state != State::paused) return;
        if (++paused == 1) at = b.twin->interlock().position();
        const bool open = b.twin->door_is_open();
        moved = moved || (open && b.twin->interlock().position() != at);
        lit_behind_door = lit_behind_door || (open && b.projector->lit);
        if (!b.control->resume()) ++refused;
    }
};

}  // namespace

namespace {

/// At every question of a paused or exposing host: kills it after 45 s there.
struct KilledLate {
    ControlBench& b;
    bool in_pause;
    std::optional<double> since_s;

    void look() {
        constexpr double late_s = 45;
        const Snapshot s = b.snapshot();
        if (in_pause && s.state == State::printing && s.completion > 0.5) (void)b.control->pause(PauseWhen::now);
        if (!in_pause && s.state == State::printing) (void)b.control->set_exposure(1, 1.3 * late_s);
        const bool there = in_pause ? s.state == State::paused : s.lit;
        if (!there) since_s.reset();
        if (there && !since_s) since_s = b.twin->now();
        if (there && b.twin->now() > *since_s + late_s) b.life->die();
    }
};

}  // namespace

TEST_CASE("after a host is killed late in a long pause or exposure, the next host finishes the print") {
    for (const auto release : both_releases) {
        for (const bool in_pause : {true, false}) {
            CAPTURE(in_pause);
            ControlBench b(options_of(release), "tower", 5, with_door);
            KilledLate person{b, in_pause, {}};
            b.life->at_look = [&] { person.look(); };
            REQUIRE_FALSE(b.start());
            b.new_host();
            b.start({true, {}});
            INFO(b.last_error());
            CHECK(b.snapshot().finished);
        }
    }
}

TEST_CASE("door opened during an exposure: dark within 0.5 s, no motion, and the print resumes when it is shut") {
    for (const int light : {1, 4, 7}) {
        CAPTURE(light);
        ControlBench b(faulty(twin::Fault::Kind::door_open, light, 40), "tower", 5, with_door);
        OperatorAtOpenDoor person(b);
        b.start();
        INFO(b.last_error());
        CHECK(b.snapshot().finished);
        CHECK(b.twin->log().lit_while_open_s > 0);
        CHECK(b.twin->log().lit_while_open_s < 0.5);
        CHECK(person.refused > 10);
        CHECK_FALSE(person.moved);
        CHECK_FALSE(person.lit_behind_door);
        CHECK(b.lights() == 11);
        b.must_be_whole();
        const std::string journal = read_file(b.journal()).value();
        CHECK(journal.find(" door open=1\n") < journal.find(" door open=0\n"));
        CHECK(journal.find(" door open=0\n") != std::string::npos);
    }
}

TEST_CASE("if a host is killed while the door is open, the next host refuses to resume until the door is shut") {
    ControlBench b(faulty(twin::Fault::Kind::door_open, 5, 100), "tower", 5, with_door);
    b.life->at_deed = [&](long deed) {
        if (b.life->dies_at < 0 && b.snapshot().state == State::paused) b.life->dies_at = deed + 5;
    };
    REQUIRE_FALSE(b.start());
    b.new_host();
    b.start({true, {}});
    CHECK(b.last_error() == "the door is open: close it");
    CHECK(b.twin->log().violations.empty());
    b.twin->advance_to(b.twin->now() + 100);
    b.must_finish({true, {}});
}

TEST_CASE("with an open door a suspended print stays in place; a cancelled one parks when the door is shut") {
    for (const bool cancel : {true, false}) {
        ControlBench b(faulty(twin::Fault::Kind::door_open, 5, 60), "tower", 5, with_door);
        b.life->at_look = [&] {
            if (b.snapshot().state != State::paused) return;
            CHECK((cancel ? b.control->cancel() : b.control->suspend()));
        };
        b.start();
        INFO(b.last_error());
        CHECK(b.snapshot().state == State::idle);
        CHECK(b.twin->door_is_open() == !cancel);
        CHECK(b.twin->interlock().hooked_vat().has_value() == !cancel);
        CHECK(b.snapshot().can_resume == !cancel);
        if (cancel) continue;
        b.life->at_look = {};
        b.twin->advance_to(b.twin->now() + 60);
        b.must_finish({true, {}});
    }
}

TEST_CASE("with an open door no print starts, and no journal is left") {
    ControlBench b(faulty(twin::Fault::Kind::door_open, 1, 200), "tower", 5, with_door);
    b.twin->light_on(halves::image(0, 0).value());  // opens it
    b.twin->light_off();
    b.twin->advance_to(10);
    REQUIRE(b.twin->door_is_open());
    b.start();
    CHECK(b.last_error() == "the door is open: close it");
    CHECK_FALSE(b.snapshot().can_resume);
    CHECK(b.twin->log().homings == 0);
    CHECK(b.lights() == 1);
}

TEST_CASE("two limit switches of one axis pressed at once: the print is refused before any axis is homed") {
    ControlBench b(faulty(twin::Fault::Kind::stuck_switch, 4), "tower", 2, [](machine::Printer& printer) {
        printer.limit_switches.push_back({machine::Axis::carriage, true, false});
    });
    b.start();  // the carriage is parked at its other switch
    CHECK(b.last_error().find("both limit switches of the carriage are pressed") == 0);
    CHECK(b.twin->log().homings == 0);
}

TEST_CASE("a stuck limit switch is found right after its axis is homed, before any exposure") {
    for (const int which : {1, 2, 3}) {
        CAPTURE(which);
        ControlBench b(faulty(twin::Fault::Kind::stuck_switch, which));
        b.start();
        CHECK(b.last_error().find("limit switch of the") != std::string::npos);
        CHECK(b.last_error().find("is pressed, but the") != std::string::npos);
        CHECK(b.lights() == 0);
        CHECK(b.twin->log().homings == (which == 2 ? 1 : which == 1 ? 2 : 3));
        CHECK(b.twin->log().violations.empty());
    }
}

TEST_CASE("a controller that restarts just before an exposure gets no light, even while it still boots") {
    twin::Options options;
    options.boot_s = 2;  // silent for longer than booting takes
    ControlBench b(options);
    int reset_before = 0;
    b.life->at_deed = [&](long) {
        const std::string journal = read_file(b.journal()).value_or("");
        const std::size_t last = journal.rfind(" light step=");
        const bool noted = last != std::string::npos && journal.find(" dark ", last) == std::string::npos;
        if (!noted || b.projector->lit || reset_before > 0 || b.lights() != 4) return;
        reset_before = b.lights();
        b.twin->reset();
    };
    b.start();
    CHECK(reset_before == 4);
    CHECK(b.lights() == 4);
    CHECK_FALSE(b.snapshot().finished);
    CHECK(read_file(b.journal()).value().find("on=0 done=0 by=host") != std::string::npos);
    b.life->at_deed = {};
    b.start({true, {}});
    INFO(b.last_error());
    CHECK(b.snapshot().finished);
    CHECK(b.lights() == 10);
    b.must_be_whole();
}

TEST_CASE("a firmware without emergency parser is found by its capabilities, and is stopped by a reset") {
    twin::Options options;
    options.emergency_parser = false;
    ControlBench b(options);
    Operator person(b, completion_above(0.3), [&] { b.control->emergency_stop(); });
    b.start();
    CHECK(has_event(b, "log", "no EMERGENCY_PARSER"));
    CHECK(b.life->resets == 1);
    CHECK(b.snapshot().state == State::halted);
}

TEST_CASE("a changed exposure takes effect at the next layer and is kept across a restart of the host") {
    ControlBench b;
    Operator person(b, lit_on_layer(2), [&] {
        CHECK(b.control->set_exposure(0, 3.5));
        CHECK_FALSE(b.control->set_exposure(2, 3));
        CHECK_FALSE(b.control->set_exposure(0, 61));  // the machine's limit is 60 s
    });
    b.life->on_death = [&] { b.guard->host_died(), b.twin->light_off(); };
    b.life->at_deed = [&](long deed) {
        if (person.acted && b.life->dies_at < 0 && b.snapshot().layer == 3) b.life->dies_at = deed + 20;
    };
    REQUIRE_FALSE(b.start());
    b.new_host();
    b.start({true, {}});
    INFO(b.last_error());
    REQUIRE(b.snapshot().finished);
    CHECK(b.snapshot().exposures_s[0] == 3.5);
    const auto& layers = b.twin->cured().layers();
    REQUIRE(layers.size() == 5);
    for (std::size_t i = 0; i < 5; ++i) {
        const double bottom = i < 2 ? 12 : 2.5;
        CHECK(layers[i].vats[0].lit[0].seconds == near(i > 2 ? 3.5 : bottom, {.relative = 0.001}));
        CHECK(layers[i].vats[1].lit[0].seconds == near(bottom, {.relative = 0.001}));
    }
}

TEST_CASE("a changed exposure changes that of bottom layers by the same factor, up to what the machine allows") {
    for (const double seconds : {3.0, 20.0}) {
        ControlBench b;
        Operator person(b, lit_on_layer(0), [&] { CHECK(b.control->set_exposure(0, seconds)); });
        b.start();
        INFO(b.last_error());
        REQUIRE(b.snapshot().finished);
        CHECK(has_event(b, "log", "layers with another exposure keep their share"));
        const auto& layers = b.twin->cured().layers();
        REQUIRE(layers.size() == 5);
        const auto lit = [&](std::size_t layer, std::size_t vat) { return layers[layer].vats[vat].lit[0].seconds; };
        CHECK(lit(0, 0) == near(12, {.relative = 0.001}));
        CHECK(lit(1, 0) == near(seconds == 3 ? 14.4 : 60, {.relative = 0.001}));  // 12 s of 2.5 s; the limit is 60 s
        CHECK(lit(2, 0) == near(seconds, {.relative = 0.001}));
        CHECK(lit(1, 1) == near(12, {.relative = 0.001}));
    }
}

TEST_CASE("the host reports every exposure that ended, broken off or complete") {
    ControlBench b(faulty(twin::Fault::Kind::door_open, 4, 40), "tower", 5, with_door);
    const OperatorAtOpenDoor person(b);
    b.start();
    REQUIRE(b.snapshot().finished);
    std::size_t whole = 0, broken = 0;
    for (const host::Given& given : b.ended) ++(given.complete ? whole : broken);
    CHECK(whole == 10);
    CHECK(broken == 1);
    CHECK(b.ended.front().layer == 0);
    CHECK(b.ended.back().layer == 4);
    // The duration of a resumed exposure is the sum of its pieces.
    for (std::size_t k = 1; k < b.ended.size(); ++k) {
        if (b.ended[k - 1].complete) continue;
        CHECK(b.ended[k].seconds == near(12, {.relative = 0.01}));
    }
}

TEST_CASE("a skipped layer is not exposed") {
    ControlBench b;
    Operator person(b, lit_on_layer(1), [&] {
        CHECK(b.control->skip_layer(3));
        CHECK_FALSE(b.control->skip_layer(1));
        CHECK_FALSE(b.control->skip_layer(5));
    });
    b.start();
    CHECK(b.snapshot().finished);
    CHECK(b.lights() == 8);
    CHECK(has_event(b, "log", "the exposure of layer 4 is skipped"));
    CHECK(b.report().missing_layers == 1);
}

TEST_CASE("a request to skip a layer that had begun before the print was resumed is answered, not dropped") {
    ControlBench b;
    Operator person(b, lit_on_layer(2), [&] { CHECK(b.control->suspend()); });
    b.start();
    b.new_host();
    REQUIRE(b.control->start({true, {}}));
    CHECK(b.control->skip_layer(1));  // the host does not know yet how far the print has come
    b.control->serve_until_idle();
    CHECK(has_event(b, "log", "layer 2 has begun, it is not skipped"));
    CHECK(b.snapshot().finished);
    b.must_be_whole();
}

TEST_CASE("resin is asked for before the layer that needs it, and a picture is taken after every layer") {
    ControlBench b;
    b.refills = {{3, 1, "refill the vat of slot 1 with x"}};
    std::vector<int> pictures;
    b.after_layer = [&](int layer) { pictures.push_back(layer); };
    b.new_host();
    Operator person(
        b, [](const Snapshot&) { return false; }, [] {});
    b.start();
    INFO(b.last_error());
    CHECK(b.snapshot().finished);
    REQUIRE(person.prompts.size() == 1);
    CHECK(person.prompts[0] == "refill the vat of slot 1 with x");
    CHECK(pictures == std::vector<int>{0, 1, 2, 3, 4});
    b.must_be_whole();
}

TEST_CASE("the picture of a layer is taken after resuming if its print ended before the layer was peeled") {
    for (const bool killed : {false, true}) {
        CAPTURE(killed);
        ControlBench b;
        std::vector<int> pictures;
        b.after_layer = [&](int layer) { pictures.push_back(layer); };
        b.new_host();
        std::size_t ended = 0;
        b.life->at_look = [&] {
            // The last exposure of layer 2 is over, and nothing has moved since.
            if (ended > 0 || b.projector->lit || b.ended.size() != 6) return;
            ended = b.ended.size();
            if (killed) b.life->die();
            CHECK(b.control->suspend());
        };
        CHECK(b.start() == !killed);
        REQUIRE(ended == 6);
        CHECK(pictures == std::vector<int>{0, 1});
        b.new_host();
        int taken_at_um = 0;
        b.after_layer = [&](int layer) {
            if (layer == 2) taken_at_um = b.twin->motors_position()[machine::Axis::platform];
            pictures.push_back(layer);
        };
        b.must_finish({true, {}});
        CHECK(pictures == std::vector<int>{0, 1, 2, 3, 4});
        CHECK(taken_at_um > 200);  // risen from the floor
    }
}

TEST_CASE("a layer that had its picture gets no second one when the print resumes") {
    ControlBench b;
    std::vector<int> pictures;
    b.after_layer = [&](int layer) { pictures.push_back(layer); };
    b.new_host();
    Operator person(
        b, [&](const Snapshot& s) { return s.layer == 2 && pictures.size() == 3; },
        [&] { CHECK(b.control->suspend()); });
    b.start();
    CHECK(person.acted);
    b.new_host();
    b.must_finish({true, {}});
    CHECK(pictures == std::vector<int>{0, 1, 2, 3, 4});
}

TEST_CASE("manual control: home, bring and put away a vat, clean, jog; interlocks still apply") {
    ControlBench b;
    const auto done = [&](Status status) {
        if (status) b.control->serve_until_idle();
        INFO((status ? "" : status.error().message) << b.snapshot().message);
        CHECK(status);
        CHECK(b.snapshot().message.empty());
    };
    done(b.control->connect());
    CHECK(b.snapshot().firmware == "Pliant twin, Marlin dialect");
    REQUIRE(b.control->jog(machine::Axis::platform, -1000, 5));
    b.control->serve_until_idle();
    CHECK(b.snapshot().message.find("before it is homed") != std::string::npos);
    done(b.control->home({}));
    done(b.control->bring_vat(2));
    CHECK(b.snapshot().slot == 2);
    done(b.control->bring_vat(1));
    CHECK(b.snapshot().slot == 1);
    REQUIRE(b.control->clean(5));
    b.control->serve_until_idle();
    CHECK(b.snapshot().message.find("put away first") != std::string::npos);
    done(b.control->bring_vat(0));
    done(b.control->clean(5));
    done(b.control->prime(3));
    done(b.control->jog(machine::Axis::platform, 1500, 5));
    CHECK(b.snapshot().position[machine::Axis::platform] == b.twin->interlock().position()[machine::Axis::platform]);
    CHECK(b.twin->log().violations.empty());
    CHECK(b.twin->log().homings == 3);
}

TEST_CASE("commands that the current state does not allow are refused") {
    ControlBench b;
    CHECK_FALSE(b.control->pause(PauseWhen::now));
    CHECK_FALSE(b.control->resume());
    CHECK_FALSE(b.control->cancel());
    CHECK_FALSE(b.control->home({}));
    CHECK_FALSE(b.control->set_exposure(0, 2));
    Operator person(b, completion_above(0.3), [&] {
        CHECK_FALSE(b.control->start({}));
        CHECK_FALSE(b.control->home({}));
        CHECK_FALSE(b.control->disconnect());
        CHECK_FALSE(b.control->load({}));
        CHECK_FALSE(b.control->resume());
    });
    b.start();
    CHECK(b.snapshot().finished);
}

TEST_CASE("a request that follows the start at once is not lost: nothing moves, and the print has not begun") {
    for (const bool cancels : {false, true}) {
        ControlBench b;
        REQUIRE(b.control->start({}));
        CHECK(host::state_text(b.snapshot()) == "Connecting");
        CHECK((cancels ? b.control->cancel() : b.control->suspend()));
        b.control->serve_until_idle();
        CHECK(b.snapshot().state == State::offline);
        CHECK(b.snapshot().message == "ended before anything moved");
        CHECK_FALSE(b.snapshot().finished);
        CHECK_FALSE(b.snapshot().failed);
        CHECK_FALSE(b.snapshot().can_resume);
        CHECK(b.lights() == 0);
        CHECK(b.twin->log().homings == 0);
        b.must_finish();
    }
}

TEST_CASE("a print that is ended while its host connects to resume it still waits to be resumed") {
    ControlBench b;
    b.must_die(400);
    b.new_host();
    const int homings = b.twin->log().homings;
    int looks = 0;
    b.life->at_look = [&] {
        if (++looks == 3) CHECK(b.control->suspend());
    };
    b.start({true, {}});
    CHECK(b.snapshot().state == State::offline);
    CHECK(b.snapshot().can_resume);
    CHECK(b.twin->log().homings == homings);
    b.life->at_look = {};
    b.must_finish({true, {}});
}

TEST_CASE("a connection under way cannot be ended; then it can, and nothing moves without one") {
    ControlBench b;
    REQUIRE(b.control->connect());
    CHECK_FALSE(b.control->disconnect());
    b.control->serve_until_idle();
    CHECK(b.snapshot().state == State::idle);
    REQUIRE(b.control->disconnect());
    b.control->serve_until_idle();
    CHECK(b.snapshot().state == State::offline);
    CHECK_FALSE(b.control->home({}));
    REQUIRE(b.control->connect());
    b.control->serve_until_idle();
    CHECK(b.snapshot().state == State::idle);
}

TEST_CASE("a second host on the same job is refused, and so is starting an interrupted job without --resume") {
    ControlBench b;
    Operator person(b, completion_above(0.3), [&] {
        CHECK(host::Journal::open(b.journal(), false).error().message.find("another host") != std::string::npos);
    });
    b.must_die(400);
    CHECK(person.acted);
    b.new_host();
    const host::ApiAnswer asked = host::handle_api(*b.control, "POST", "/api/job", R"({"command": "start"})");
    CHECK(asked.status == 409);
    CHECK(asked.json.find("was interrupted: resume or cancel it first") != std::string::npos);
    b.start();
    CHECK(b.last_error().find("--resume") != std::string::npos);
    CHECK(b.snapshot().state == State::offline);
}

TEST_CASE("another program that used the controller after the interruption is found by its line number") {
    ControlBench b;
    b.must_die(400);
    b.twin->receive("M110 N500\n");
    b.twin->advance_to(b.twin->now() + 30);
    b.new_host();
    b.start({true, {}});
    CHECK(b.last_error().find("another program has used") != std::string::npos);
    b.must_finish({true, {std::nullopt, true}});
}

TEST_CASE("another program that used higher line numbers is found too") {
    ControlBench b;
    b.must_die(400);
    b.twin->receive("M110 N90000000\n");
    b.twin->advance_to(b.twin->now() + 30);
    b.new_host();
    b.start({true, {}});
    CHECK(b.last_error().find("another program has used") != std::string::npos);
}

TEST_CASE("a host that connects first and resumes later finishes the same part as one that resumes at once") {
    ControlBench undisturbed;
    undisturbed.start();
    const std::string whole = block_of(*undisturbed.twin);
    const long deeds = undisturbed.life->deeds;
    int resumed = 0;
    for (long n = 40; n < deeds; n += 6 * moment_stride) {
        ControlBench b(options_of(release_at(n)));
        b.life->dies_at = n;
        CAPTURE(n);
        REQUIRE_FALSE(b.start());
        b.new_host();
        if (!b.snapshot().can_resume) continue;
        ++resumed;
        REQUIRE(b.control->connect());
        b.control->serve_until_idle();
        REQUIRE(b.snapshot().state == host::State::idle);
        b.start({true, {}});
        INFO(b.last_error());
        CHECK(b.snapshot().finished);
        CHECK((block_of(*b.twin) == whole));
    }
    CHECK(resumed > 5);
}

TEST_CASE("a print under control survives every kind of fault on the wire") {
    using twin::Fault;
    for (const auto kind :
         {Fault::Kind::corrupt_byte, Fault::Kind::lose_line, Fault::Kind::lose_ok, Fault::Kind::lose_byte,
          Fault::Kind::flip_byte, Fault::Kind::resend_loop, Fault::Kind::lose_number}) {
        for (const int n : {7, 40, 123, 260, 391}) {
            for (const auto release : both_releases) {
                CAPTURE(static_cast<int>(kind));
                CAPTURE(n);
                ControlBench b({.advanced_ok = n % 2 == 0, .faults = {{kind, n, 0}}, .release = release});
                b.must_finish();
            }
        }
    }
}

TEST_CASE("on every kind of machine a print resumes after its host was killed") {
    for (const char* name : {"tower8", "two_towers", "carousel", "tower_magnet", "wall", "rotary", "linear"}) {
        CAPTURE(std::string(name));
        long deeds = 0;
        {
            ControlBench b({}, name, 3);
            b.start();
            CHECK(b.snapshot().finished);
            deeds = b.life->deeds;
        }
        for (long n = 20; n < deeds; n += deeds / 6) {
            for (const bool reset : {false, true}) {
                CAPTURE(n);
                CAPTURE(reset);
                ControlBench b({}, name, 3);
                b.must_die(n);
                if (reset) b.twin->reset();
                b.new_host();
                if (!b.snapshot().can_resume) continue;
                b.start({true, {}});
                INFO(b.last_error());
                const std::string error = b.last_error();
                const auto refused = [&](const char* why) { return error.find(why) != std::string::npos; };
                if (refused("half-way on the hooks") || refused("which has let it go")) continue;
                CHECK(b.snapshot().finished);
                b.must_be_whole();
            }
        }
    }
}

namespace {

/// Simulates a disk that is full for files above a size, during its lifetime.
struct FullDisk {
    rlimit before{};
    explicit FullDisk(std::uintmax_t bytes) {
        std::signal(SIGXFSZ, SIG_IGN);
        REQUIRE(::getrlimit(RLIMIT_FSIZE, &before) == 0);
        const rlimit small{bytes, before.rlim_max};
        REQUIRE(::setrlimit(RLIMIT_FSIZE, &small) == 0);
    }
    ~FullDisk() { ::setrlimit(RLIMIT_FSIZE, &before); }
    FullDisk(const FullDisk&) = delete;
    FullDisk& operator=(const FullDisk&) = delete;
};

}  // namespace

TEST_CASE("a full disk stops the print with light, pump and axes off; it resumes when there is space again") {
    for (const double at : {0.2, 0.33, 0.45, 0.6, 0.75, 0.9}) {
        CAPTURE(at);
        ControlBench b;
        std::unique_ptr<FullDisk> full;
        Operator person(b, completion_above(at),
                        [&] { full = std::make_unique<FullDisk>(std::filesystem::file_size(b.journal())); });
        b.start();
        full.reset();
        CHECK(b.last_error().find("the journal cannot be written") != std::string::npos);
        CHECK_FALSE(b.projector->lit);
        CHECK_FALSE(b.twin->interlock().pump_runs());
        CHECK(b.twin->log().violations.empty());
        b.life->at_look = {};
        b.must_finish({true, {}});
    }
}

TEST_CASE("disk full during an exposure: the light goes off, and resuming needs --assume-lit") {
    ControlBench b;
    std::unique_ptr<FullDisk> full;
    Operator person(b, lit_on_layer(2, 1),
                    [&] { full = std::make_unique<FullDisk>(std::filesystem::file_size(b.journal())); });
    b.start();
    full.reset();
    CHECK_FALSE(b.projector->lit);
    b.life->at_look = {};
    b.start({true, {}});
    CHECK(b.last_error().find("--assume-lit") != std::string::npos);
    for (const double impossible_s : {-1.0, 25.0}) {
        b.start({true, {impossible_s, false}});
        CHECK(b.last_error().find("the exposure that was in progress lasts from 0 to ") != std::string::npos);
    }
    b.start({true, {2.5, false}});
    INFO(b.last_error());
    CHECK(b.snapshot().finished);
    CHECK(b.lights() == 10);
    b.must_be_whole();
}

TEST_CASE("an unplugged USB cable stops the print with the light off; plugged in again, the print resumes") {
    for (const double at : {0.15, 0.3, 0.55, 0.8}) {
        CAPTURE(at);
        ControlBench b;
        Operator person(b, completion_above(at), [&] { b.life->unplugged = true; });
        b.start();
        CHECK(b.last_error().find("the device is gone") != std::string::npos);
        CHECK(b.snapshot().state == State::halted);
        CHECK_FALSE(b.projector->lit);
        b.life->unplugged = false;
        b.life->at_look = {};
        b.must_finish({true, {}});
    }
}
