#include "print_live.hpp"

#include <fmt/core.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "base/core/files.hpp"
#include "interrupt.hpp"
#include "presentation/print_report/print_report.hpp"
#include "print_vats.hpp"
#include "printed.hpp"
#include "printing/host/control.hpp"
#include "printing/host/replace_journal.hpp"
#include "printing/operate/job_file.hpp"
#include "printing/operate/layer_command.hpp"
#include "printing/operate/port_station.hpp"
#include "printing/operate/print_job.hpp"
#include "printing/operate/resume_hint.hpp"
#include "printing/plan/plan.hpp"
#include "printing/rehearse/memory_file.hpp"
#include "printing/twin/inspect.hpp"
#include "printing/twin/serve.hpp"
#include "printing/wire/scaled_time.hpp"
#include "printing/wire/steady_clock.hpp"
#include "shared_light.hpp"

namespace pliant::app {
namespace {

/// Reads single keys during its lifetime, if standard input is a terminal.
class Keys {
public:
    Keys() {
        if (isatty(STDIN_FILENO) != 1 || tcgetattr(STDIN_FILENO, &before_) != 0) return;
        termios raw = before_;
        raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
        active_ = tcsetattr(STDIN_FILENO, TCSANOW, &raw) == 0;
    }
    ~Keys() {
        if (active_) tcsetattr(STDIN_FILENO, TCSANOW, &before_);
    }
    Keys(const Keys&) = delete;
    Keys& operator=(const Keys&) = delete;

    [[nodiscard]] bool active() const { return active_; }

    /// Waits for a key up to the timeout; 0: none was pressed.
    [[nodiscard]] char next(int timeout_ms) const {
        pollfd wait{active_ ? STDIN_FILENO : -1, POLLIN, 0};
        char key = 0;
        if (::poll(&wait, 1, timeout_ms) <= 0 || ::read(STDIN_FILENO, &key, 1) != 1) return 0;
        return key;
    }

private:
    termios before_{};
    bool active_ = false;
};

/// The virtual printer on a pseudo-terminal, in a thread of its own.
class LiveTwin {
public:
    LiveTwin(const machine::Printer& printer, twin::Options wanted, twin::Pty pty, double speed)
        : pty_(std::move(pty)), twin_(printer, std::move(wanted)), thread_([this, speed] {
              twin::ServeOptions options;
              options.speed = speed;
              options.stop = [this] { return stop_.load(); };
              options.lights = [this](twin::Twin& t) { return light.look(t); };
              (void)twin::serve(twin_, pty_, options);
          }) {}
    ~LiveTwin() { end(); }
    LiveTwin(const LiveTwin&) = delete;
    LiveTwin& operator=(const LiveTwin&) = delete;

    [[nodiscard]] const std::string& device() const { return pty_.device(); }
    twin::Twin& end() {
        stop_ = true;
        if (thread_.joinable()) thread_.join();
        return twin_;
    }

    SharedLight light;

private:
    twin::Pty pty_;
    twin::Twin twin_;
    std::atomic<bool> stop_ = false;
    std::thread thread_;
};

/// Display for a person: a rewritten line on a terminal, otherwise the events.
class Display {
public:
    /// `goes_on`: whether a pause can be ended without another command.
    Display(const Output& output, bool goes_on)
        : quiet_(output.quiet), line_(!output.quiet && isatty(STDERR_FILENO) == 1), goes_on_(goes_on) {}

    void show(host::Control& control) {
        for (const host::Event& event : control.events_since(seen_)) {
            seen_ = event.number;
            const bool tell = event.kind == "error" || event.kind == "log" || event.kind == "prompt" ||
                              event.kind == "state" || (event.kind == "layer" && !line_);
            if (!tell || (quiet_ && event.kind != "error")) continue;
            clear();
            fmt::print(stderr, "{} {}\n", event.kind, event.text);
            if (event.kind == "prompt" && !goes_on_)
                fmt::print(stderr,
                           "without a terminal no key resumes: stop this program (SIGTERM), do that, --resume\n");
        }
        if (line_) progress(control.snapshot());
        std::fflush(stderr);
    }
    void clear() {
        if (shown_) std::fputs("\r\033[K", stderr);
        shown_ = false;
    }

private:
    void progress(const host::Snapshot& s) {
        using host::State;
        if (s.state != State::printing && s.state != State::paused && s.state != State::pausing) return clear();
        shown_ = true;
        fmt::print(stderr, "\r\033[Klayer {}/{}  {:4.1f} %  {} left  {}{}", s.layer + 1, s.layers, 100 * s.completion,
                   plan::clock_text(s.seconds_left), host::state_text(s),
                   s.lit ? fmt::format("  light {:.1f}/{:.1f} s", s.lit_s, s.exposure_s) : "");
    }

    bool quiet_;
    bool line_;
    bool goes_on_;
    bool shown_ = false;
    long seen_ = 0;
};

bool is_over(const host::Snapshot& s) {
    return s.state == host::State::idle || s.state == host::State::offline || s.state == host::State::halted;
}

void press(host::Control& control, char key) {
    if (key == ' ' && control.snapshot().state == host::State::paused)
        (void)control.resume();
    else if (key == ' ')
        (void)control.pause(host::PauseWhen::after_exposure);
    if (key == 'c') (void)control.cancel();
    if (key == 'e') control.emergency_stop();
}

/// Runs until the print has ended. Ctrl-C and SIGTERM suspend it; a later Ctrl-C is an emergency stop.
void attend(host::Control& control, const LiveOptions& options) {
    const Keys keys;
    Display display(options.output, keys.active() || options.port.empty());
    bool suspended = false, stopped = false;
    do {
        press(control, keys.next(100));
        if (interrupted() && !std::exchange(suspended, true)) (void)control.suspend();
        if (pressed_again() && !std::exchange(stopped, true)) control.emergency_stop();
        display.show(control);
    } while (!is_over(control.snapshot()));
    display.show(control);
    display.clear();
}

/// How the print ended, and what was known then.
struct Ended {
    int status = exit_failed;
    host::Snapshot last;
};

Result<Ended> print_to_end(host::Control& control, const LiveOptions& options, operate::ReadyJob& ready) {
    if (Status status = control.load(ready.job); !status) return tl::unexpected(status.error());
    control.serve_until_idle();
    host::StartOptions start;
    start.resume = options.resume;
    start.has_refilled = options.resume;  // confirmed with the vats
    start.assume.lit_s = options.assume_lit_s;
    start.assume.vats_untouched = options.assume_vats_untouched;
    if (Status status = control.start(start); !status) return tl::unexpected(status.error());
    on_signal(OnSignal::ask_twice);
    std::thread worker([&] { control.serve(); });
    attend(control, options);
    Ended ended{exit_failed, control.snapshot()};
    control.quit();
    worker.join();
    if (ended.last.finished) ended.status = exit_done;
    return ended;
}

/// The report of the print, even if incomplete; `block`: the cured part of the virtual printer, or null.
Status write_report(const LiveOptions& options, const operate::ReadyJob& ready, const host::Snapshot& last,
                    std::shared_ptr<const report::CuredBlock> block) {
    if (options.report.empty()) return {};
    const report::PrintExtras extras{options.port.empty() ? "virtual printer" : options.port, last.firmware,
                                     last.lines_sent, last.resends, std::move(block)};
    const Result<std::string> page = report::print_report(options.job, ready.job.journal, extras);
    if (!page) return tl::unexpected(page.error());
    return write_file(options.report, *page);
}

/// Tells and writes the findings of the virtual printer, and returns the exit status.
Result<int> verdict(const LiveOptions& options, const twin::Report& report, int status) {
    const std::string json = twin::report_json(report);
    if (!options.verdict.empty()) {
        if (Status written = write_file(options.verdict, json + "\n"); !written) return tl::unexpected(written.error());
    }
    if (options.output.json)
        fmt::print("{}\n", json);
    else if (!options.output.quiet)
        fmt::print("{}", twin::report_text(report));
    return report.passed ? status : static_cast<int>(exit_failed);
}

/// Compares the virtual printer's block with the job; a report includes it.
Result<int> judge(const LiveOptions& options, const operate::ReadyJob& ready, const Ended& ended, twin::Twin& twin) {
    const job::Manifest& manifest = ready.archive->manifest();
    const twin::RunSource images = [&](int layer, int material) {
        return operate::image_of(*ready.archive, layer, material).map(twin::runs_of);
    };
    constexpr double wall_clock_s = 0.05;  // allowed delay on a busy computer
    const twin::Judgement judgement{options.accepted, wall_clock_s * std::max(1.0, options.speed), true};
    if (options.report.empty())
        return twin::inspect(twin, manifest, images, judgement).and_then([&](const twin::Report& report) {
            return verdict(options, report, ended.status);
        });
    Result<report::CuredBlock> made = report::cured_block(twin, manifest, images, judgement);
    if (!made) return tl::unexpected(made.error());
    const auto block = std::make_shared<const report::CuredBlock>(std::move(*made));
    if (Status written = write_report(options, ready, ended.last, block); !written)
        return tl::unexpected(written.error());
    return verdict(options, block->report, ended.status);
}

Result<int> print_on_live_twin(const LiveOptions& options, operate::ReadyJob& ready, host::Clock& clock) {
    if (!options.journal.empty()) {
        if (Status may = host::may_replace_journal(options.journal); !may) return tl::unexpected(may.error());
    }
    Result<twin::Pty> pty = twin::Pty::open();
    if (!pty) return tl::unexpected(pty.error());
    twin::Options wanted;
    Result<std::optional<job::Image>> mask = operate::mask_of(*ready.archive, ready.printer.projector);
    if (!mask) return tl::unexpected(mask.error());
    wanted.mask = std::move(*mask);
    if (Status status = twin::check_faults(options.faults, ready.printer); !status)
        return tl::unexpected(status.error());
    wanted.faults = options.faults;
    LiveTwin machine(ready.printer, std::move(wanted), std::move(*pty), options.speed);
    // This printer is gone when the program ends, so its prints cannot be resumed.
    const Result<rehearse::MemoryFile> journal = rehearse::MemoryFile::make();
    if (!journal) return tl::unexpected(journal.error());
    ready.job.journal = journal->path();
    ready.job.sync_journal = false;
    host::ControlSetup setup =
        operate::port_setup(machine.device(), options.speed, ready.printer, machine.light, clock, nullptr);
    setup.after_layer = layer_hook(options);
    host::Control control(std::move(setup));
    const Result<Ended> ended = print_to_end(control, options, ready);
    if (!ended) return tl::unexpected(ended.error());
    if (!options.journal.empty()) {
        const Status kept = read_file(journal->path()).and_then([&](const std::string& text) {
            return host::replace_journal(options.journal, text);
        });
        if (!kept) return tl::unexpected(kept.error());
    }
    return judge(options, ready, *ended, machine.end());
}

/// Says how to resume, if the print can be: not where the same command has just been refused. `before`: the last record
/// of the print that was to be resumed.
void show_hint(const operate::PrintCall& call, const operate::ReadyJob& ready, std::optional<long> before) {
    const auto now = operate::interrupted_at(ready.job.journal, ready.job.digest, ready.printer.name);
    if (!now || (call.resumed && now == before)) return;
    if (Status way = operate::check_resumable(ready); !way)
        return fmt::print(stderr, "cannot be resumed: {}\n", way.error().message);
    fmt::print(stderr, "resume with: {}\n", operate::resume_command(call));
}

nlohmann::json result_at_port(const Ended& ended) {
    const host::Snapshot& last = ended.last;
    return {{"finished", last.finished},     {"can_resume", last.can_resume},  {"message", last.message},
            {"layers", last.layers},         {"layers_begun", last.layer + 1}, {"seconds", last.seconds_done},
            {"lines_sent", last.lines_sent}, {"resends", last.resends}};
}

Result<int> print_on_port(const LiveOptions& options, operate::ReadyJob& ready) {
    if (options.resume) {
        if (Status there = operate::expect_journal(ready.job.journal, options.job); !there)
            return tl::unexpected(there.error());
    }
    const operate::PortOptions port{options.port, options.projector, options.speed, options.clock_file,
                                    options.emergency_line};
    const auto before = operate::interrupted_at(ready.job.journal, ready.job.digest, ready.printer.name);
    auto station = operate::PortStation::open(port, ready);
    if (!station) return tl::unexpected(station.error());
    host::ControlSetup setup = (*station)->setup(ready.printer);
    setup.after_layer = layer_hook(options);
    host::Control control(std::move(setup));
    const Result<Ended> ended = print_to_end(control, options, ready);
    if (!ended) return tl::unexpected(ended.error());
    if (!ended->last.finished && !options.output.quiet)
        show_hint({options.job, port, options.journal, options.after_layer, options.report, options.resume}, ready,
                  before);
    if (ended->last.begun_s) {  // else the journal and an older page are of another print
        if (Status written = write_report(options, ready, ended->last, nullptr); !written)
            return tl::unexpected(written.error());
    }
    if (options.output.json) print_json(result_at_port(*ended));
    return ended->status;
}

}  // namespace

host::LayerHook layer_hook(const LiveOptions& options) {
    if (options.after_layer.empty()) return {};
    return [command = options.after_layer](int layer) {
        if (const Status status = operate::run_layer_command(command, layer); !status)
            fmt::print(stderr, "{}\n", status.error().message);
    };
}

Result<int> print_live(const LiveOptions& options) {
    if (Status status = host::check_speed(options.speed); !status) return tl::unexpected(status.error());
    Result<operate::ReadyJob> ready = operate::load_job(options.job);
    if (!ready) return tl::unexpected(ready.error());
    if (!options.journal.empty()) ready->job.journal = options.journal;
    show_vats(ready->plan, ready->warnings, options.output);
    if (!options.port.empty()) {
        if (options.resume && !options.output.quiet) {
            for (const std::string& text : operate::asked_before(*ready))
                fmt::print(stderr, "before it goes on: {}\n", text);
        }
        if (Status asked = options.yes ? Status{} : ask_for_vats(options.output); !asked)
            return tl::unexpected(asked.error());
        return print_on_port(options, *ready);
    }
    host::SteadyClock steady;
    host::ScaledClock clock(steady, options.speed);
    return print_on_live_twin(options, *ready, clock);
}

}  // namespace pliant::app
