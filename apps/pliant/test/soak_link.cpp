// Tests the host's link on a wire that damages lines, loses bytes and swallows answers: many lines, each executed
// exactly once in effect, with an exact end position; then whole prints on the same wire, which the oracle must pass.
//
// Two kinds of Marlin answer in turn: 2.1.1, and 2.1.2, which silently drops repeated lines.
//
//   pliant_soak_link [LINES] [SEED]              1 % of the lines with a flipped bit, 1 % with a lost byte
//   pliant_soak_link [LINES] [SEED] byte SHARE   that share of all bytes flipped and as many lost (0.01: 1 %)
//   pliant_soak_link throughput [LINES]         lines per second over a pseudo-terminal to a fast virtual printer
#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>
#include <thread>

#include "printing/machine/gcode.hpp"
#include "printing/plan/plan.hpp"
#include "printing/twin/inspect.hpp"
#include "printing/twin/serve.hpp"
#include "printing/wire/link.hpp"
#include "printing/wire/serial.hpp"
#include "printing/wire/steady_clock.hpp"
#include "virtual_bench.hpp"

namespace {

using namespace pliant;
using machine::Axis;
using Release = machine::MarlinRelease;

struct Noise {
    double flipped = 0.01;  ///< share of lines (or bytes) with a flipped bit
    double lost = 0.01;     ///< share of lines (or bytes) that lose a byte
    double lost_oks = 0.005;
    bool per_byte = false;
};

struct Damage {
    long flipped = 0, lost = 0, lost_oks = 0;
};

class NoisyWire final : public host::Wire {
public:
    NoisyWire(std::unique_ptr<host::Wire> wire, const Noise& noise, unsigned seed)
        : wire_(std::move(wire)), noise_(noise), random_(seed) {}
    NoisyWire(twin::Twin& twin, const Noise& noise, unsigned seed)
        : NoisyWire(std::make_unique<rehearse::TwinWire>(twin), noise, seed) {}

    [[nodiscard]] Status write(std::string_view bytes) override {
        std::string line(bytes);
        if (noise_.per_byte) {
            for (std::size_t i = line.size(); i-- > 0;) damage(line, i);
        } else if (!line.empty()) {
            damage(line, random_() % line.size());
        }
        return wire_->write(line);
    }
    [[nodiscard]] Result<std::string> read(double timeout_s) override {
        auto said = wire_->read(timeout_s);
        if (!said) return said;
        std::string heard;
        for (std::string_view rest = *said; !rest.empty();) {
            const std::string_view line = rest.substr(0, rest.find('\n') + 1);
            rest.remove_prefix(line.size());
            if (line.substr(0, 2) == "ok" && hits(noise_.lost_oks))
                ++damage_.lost_oks;
            else
                heard += line;
        }
        return heard;
    }
    [[nodiscard]] const Damage& damage() const { return damage_; }

private:
    bool hits(double share) { return std::uniform_real_distribution<double>(0, 1)(random_) < share; }
    void damage(std::string& line, std::size_t at) {
        if (hits(noise_.flipped)) {
            line[at] = static_cast<char>(line[at] ^ (1 << random_() % 7));
            ++damage_.flipped;
        }
        if (hits(noise_.lost)) {
            line.erase(at, 1);
            ++damage_.lost;
        }
    }

    std::unique_ptr<host::Wire> wire_;
    Noise noise_;
    std::mt19937 random_;
    Damage damage_;
};

host::LinkOptions patient() {
    host::LinkOptions options;
    options.most_repeats = options.most_connects = 60;
    return options;
}

/// Moves the platform to random heights and tracks what the machine must have done.
class Mover {
public:
    Mover(const machine::Printer& printer, twin::Twin& twin, host::Link& link, unsigned seed)
        : printer_(printer), twin_(twin), link_(link), random_(seed) {}

    [[nodiscard]] Status begin() {
        Status status = link_.connect();
        for (const char* line : {"M84 S0", "G90", "G28 Z", "G28 X"}) {
            if (status) status = link_.send(line);
        }
        if (status) status = link_.fence();
        at_ = twin_.interlock().position();
        path_ = twin_.log().path;
        moves_ = twin_.log().moves;
        return status;
    }
    [[nodiscard]] Status move() {
        machine::Position to = at_;
        to[Axis::platform] = 100000 + static_cast<int>(random_() % 290000);
        if (to == at_) return {};
        const double speed_mm_s = printer_.axis(Axis::platform).speed_mm_s;
        const Status status = link_.send(machine::write_move(printer_, at_, to, speed_mm_s));
        at_ = to;
        path_ = twin::path_after(path_, to);
        ++moves_;
        return status;
    }
    [[nodiscard]] long moves() const { return moves_; }
    /// After synchronisation: the machine has followed the same path, and no other.
    [[nodiscard]] bool path_is_right() const { return twin_.log().path == path_; }
    [[nodiscard]] bool well() const { return path_is_right() && twin_.log().violations.empty(); }
    [[nodiscard]] bool exact() const {
        return well() && twin_.interlock().position() == at_ && twin_.log().moves == moves_;
    }

private:
    const machine::Printer& printer_;
    twin::Twin& twin_;
    host::Link& link_;
    std::mt19937 random_;
    machine::Position at_;
    std::uint64_t path_ = 0;
    long moves_ = 0;
};

/// Sends random heights of the platform, one per line; true if all were executed correctly.
bool soak_moves(const machine::Printer& printer, long lines, unsigned seed, const Noise& noise, Release release,
                bool advanced_ok) {
    twin::Options twin_options;
    twin_options.release = release;
    twin_options.advanced_ok = advanced_ok;
    twin::Twin twin(printer, twin_options);
    NoisyWire wire(twin, noise, seed);
    rehearse::TwinClock clock(twin);
    host::Link link(wire, clock, patient());
    Mover mover(printer, twin, link, seed);
    const auto begin = std::chrono::steady_clock::now();
    Status status = mover.begin();
    for (long i = 0; status && i < lines; ++i) status = mover.move();
    if (status) status = link.fence();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const bool exact = mover.exact();
    fmt::print("{}: {} lines{}: {} bits flipped, {} bytes lost, {} oks lost; {} bad lines, {} resent, {:.1f} s: {}\n",
               machine::name_of(release), lines, advanced_ok ? " (ADVANCED_OK)" : "", wire.damage().flipped,
               wire.damage().lost, wire.damage().lost_oks, twin.log().bad_lines, link.resends(), seconds,
               !status ? status.error().message
               : exact ? "each carried out once, end position exact"
                       : "WRONG");
    if (!exact && status)
        fmt::print("  {} moves of {}, path {}, {} violations\n", twin.log().moves, mover.moves(),
                   mover.path_is_right() ? "right" : "other", twin.log().violations.size());
    return status && exact;
}

struct Session {
    long lines = 0;
    bool wrong = false;    ///< a line was not executed as it was sent
    bool stopped = false;  ///< the link has given up on the wire
    std::string why;
};

/// A fresh machine, moved until an error occurs or `lines` have been sent. Every few moves the machine's own log is
/// checked, so that a damaged line with a valid checksum is detected at once.
Session soak_session(const machine::Printer& printer, long lines, unsigned seed, const Noise& noise, Release release,
                     bool judged) {
    constexpr int together = 10;
    twin::Options twin_options;
    twin_options.release = release;
    twin::Twin twin(printer, twin_options);
    NoisyWire wire(twin, noise, seed);
    rehearse::TwinClock clock(twin);
    host::LinkOptions options = patient();
    if (!judged) options.most_refused = 1e9;
    host::Link link(wire, clock, options);
    Mover mover(printer, twin, link, seed);
    Session session;
    Status status = mover.begin();
    while (status && session.lines < lines && mover.well()) {
        for (int i = 0; status && i < together; ++i) status = mover.move();
        if (status) status = link.fence();
        session.lines = link.lines_sent();
    }
    session.stopped = !status && status.error().message.find("the wire damages") == 0;
    session.wrong = !session.stopped && (!status || !mover.well());
    if (session.stopped) session.wrong = !twin.log().violations.empty();
    if (!status) session.why = status.error().message;
    return session;
}

/// Noise on single bytes: how often a damaged line passes the 8-bit checksum, and how the link handles it. True if the
/// link with its usual settings executed every line as sent, to the end.
bool soak_bytes(const machine::Printer& printer, long lines, unsigned seed, const Noise& noise, Release release) {
    bool good = true;
    for (const bool judged : {false, true}) {
        long sent = 0;
        int sessions = 0, wrong = 0, stopped = 0;
        std::string last;
        for (; sent < lines && sessions < 10000; ++sessions) {
            const Session s =
                soak_session(printer, lines - sent, seed + static_cast<unsigned>(sessions), noise, release, judged);
            sent += std::max(1L, s.lines);
            wrong += s.wrong ? 1 : 0;
            stopped += s.stopped ? 1 : 0;
            if (!s.why.empty()) last = s.why;
            if (judged && s.stopped && sessions >= 200) break;
        }
        fmt::print(
            "{}: {:g} % of bytes flipped, as many lost; {}: {} lines in {} sessions, {} with a line that was carried "
            "out damaged ({}), {} stopped by the link{}\n",
            machine::name_of(release), 100 * noise.flipped,
            judged ? "the link as it is" : "the link does not judge the wire", sent, sessions, wrong,
            wrong > 0 ? fmt::format("one in {} lines", sent / wrong) : "none", stopped,
            last.empty() ? "" : "; last: " + last);
        good = wrong == 0 && stopped == 0;
    }
    return good;
}

constexpr int width = 8, height = 6;

Result<job::Image> image_of(int, int material) {
    job::Image image{width, height, std::vector<std::uint8_t>(width * height)};
    for (int i = 0; i < width * height; ++i)
        image.pixels[static_cast<std::size_t>(i)] = (i % width < 4) == (material == 0) ? 255 : 0;
    return image;
}

/// Prints until this many lines have been sent.
bool soak_prints(machine::Printer printer, long lines, unsigned seed, const Noise& noise, Release release) {
    printer.controller.firmware = release;
    printer.projector.width_px = width;
    printer.projector.height_px = height;
    job::Manifest job;
    job.name = "halves";
    job.width_px = width;
    job.height_px = height;
    job.pixel_um = printer.projector.pixel_um;
    const double half_mm2 = 24 * job.pixel_um * job.pixel_um / 1e6;
    job.materials = {{"soft", "semi-flex", half_mm2 * 0.25, 0, 2.5, 2.5},
                     {"rigid", "rigid-flex", half_mm2 * 0.25, 0, 2.5, 2.5}};
    for (int i = 0; i < 5; ++i)
        job.layers.push_back({50 * (i + 1), 50, {{0, "a.png", half_mm2}, {1, "b.png", half_mm2}}});
    const auto plan = plan::make_plan(job, printer);
    if (!plan) return false;
    const std::string gcode = plan::write_gcode(*plan, job, printer);
    long sent = 0, resent = 0;
    int prints = 0, wrong = 0;
    for (; sent < lines; ++prints) {
        rehearse::Options options;
        options.link = patient();
        options.wire = [&](std::unique_ptr<host::Wire> wire) {
            return std::make_unique<NoisyWire>(std::move(wire), noise, seed + static_cast<unsigned>(prints));
        };
        const app::Printed printed(printer, job, app::print_job(job, gcode, image_of), image_of, std::move(options));
        const host::Snapshot last = printed.print->snapshot();
        sent += std::max(1L, last.lines_sent);
        resent += last.resends;
        if (printed.status && printed.report.passed) continue;
        ++wrong;
        fmt::print("print {}: {}\n", prints,
                   !printed.status ? printed.status.error().message : printed.report.first_deviation);
    }
    fmt::print("{}: {} prints of {} lines in all, {} resent: {} wrong\n", machine::name_of(release), prints, sent,
               resent, wrong);
    return wrong == 0;
}

/// Measures how many lines per second are acknowledged over a pseudo-terminal, with a machine that takes no time.
bool measure_throughput(const machine::Printer& printer, long lines) {
    auto pty = twin::Pty::open();
    if (!pty) return false;
    twin::Twin twin(printer);
    std::atomic<bool> stop = false;
    std::thread machine([&] {
        twin::ServeOptions options;
        options.speed = 1e6;
        options.stop = [&] { return stop.load(); };
        (void)twin::serve(twin, *pty, options);
    });
    auto wire = host::SerialWire::open(pty->device(), 250000);
    host::SteadyClock clock;
    Status status = wire ? Status{} : tl::unexpected(wire.error());
    double seconds = 0;
    if (status) {
        host::Link link(*wire, clock);
        status = link.connect();
        for (const char* line : {"M84 S0", "G90", "G28 Z"}) {
            if (status) status = link.send(line);
        }
        if (status) status = link.fence();
        const double begin_s = clock.now();
        for (long i = 0; status && i < lines; ++i) status = link.send(i % 2 == 0 ? "G1 Z300 F1200" : "G1 Z310 F1200");
        if (status) status = link.fence();
        seconds = clock.now() - begin_s;
    }
    stop = true;
    machine.join();
    fmt::print("{} lines acknowledged in {:.2f} s: {:.0f} a second{}\n", lines, seconds,
               static_cast<double>(lines) / seconds, status ? "" : ": " + status.error().message);
    return status.has_value();
}

}  // namespace

int main(int argc, char** argv) {
    const long lines = argc > 1 ? std::atol(argv[1]) : 100000;
    const auto seed = static_cast<unsigned>(argc > 2 ? std::atol(argv[2]) : 1);
    if (argc > 1 && std::strcmp(argv[1], "throughput") == 0) {
        const auto printer = machine::load_printer("examples/printers/tower.toml");
        return printer && measure_throughput(*printer, argc > 2 ? std::atol(argv[2]) : 20000) ? 0 : 1;
    }
    Noise noise;
    noise.per_byte = argc > 3 && std::strcmp(argv[3], "byte") == 0;
    if (noise.per_byte && argc > 4) noise.flipped = noise.lost = std::atof(argv[4]);
    const auto printer = machine::load_printer("examples/printers/tower.toml");
    if (!printer) {
        fmt::print(stderr, "{}\n", printer.error().message);
        return 2;
    }
    bool good = true;
    for (const Release release : {Release::v2_1_1, Release::v2_1_2}) {
        if (noise.per_byte) {
            good = soak_bytes(*printer, lines, seed, noise, release) && good;
            continue;
        }
        good = soak_moves(*printer, lines, seed, noise, release, false) && good;
        good = soak_moves(*printer, lines, seed, noise, release, true) && good;
        good = soak_prints(*printer, lines, seed, noise, release) && good;
    }
    return good ? 0 : 1;
}
