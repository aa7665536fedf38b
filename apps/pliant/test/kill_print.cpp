// Kills the host of a print repeatedly, or resets its controller, and compares what finally cured with an undisturbed
// print. Everything is as in production: `pliant print` is a process of its own, killed with SIGKILL at random moments;
// the virtual printer is at the other end of a pseudo-terminal and sees the light through a folder.
//
// The prints alternate between a Marlin 2.1.1 and a 2.1.2. Finally one is interrupted twice, which is an emergency
// stop.
//
//   pliant_kill_print PLIANT [--kills N] [--resets N] [--speed X] [--seed S] [--per-print N]
#include <fcntl.h>
#include <fmt/core.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>  // environ

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"
#include "printing/job/png.hpp"
#include "printing/operate/clock_file.hpp"
#include "printing/twin/inspect.hpp"
#include "printing/twin/serve.hpp"
#include "small_job.hpp"

namespace {

using namespace pliant;
namespace fs = std::filesystem;

using app::halves::height_px;
using app::halves::width_px;

constexpr int layers = 3;

struct Wanted {
    std::string program;
    int kills = 0;
    int resets = 0;
    double speed = 50;
    unsigned seed = 1;
    int per_print = 5;
};

[[noreturn]] void stop(const std::string& why) {
    fmt::print(stderr, "{}\n", why);
    std::exit(2);
}

template <class T>
T checked(Result<T> result) {
    if (!result) stop(result.error().message);
    return std::move(*result);
}

using Job = app::SmallJob;

/// A small job on the tower of the thesis.
Job make_job(const fs::path& folder) {
    return checked(app::write_small_job(folder, checked(read_file("examples/printers/tower.toml")), {layers, 1, 6, 1}));
}

twin::Options booting(machine::MarlinRelease release) {
    twin::Options options;
    options.boot_s = 1;
    options.release = release;
    return options;
}

/// The virtual printer, watching a folder for its light, in a thread.
class Machine {
public:
    Machine(const machine::Printer& printer, const fs::path& folder, double speed, machine::MarlinRelease release)
        : shown_(folder / "shown.png"),
          clock_(checked(operate::ClockFile::create(folder / "clock"))),
          pty_(checked(twin::Pty::open())),
          twin_(printer, booting(release)),
          thread_([this, speed] {
              twin::ServeOptions options;
              options.speed = speed;
              options.stop = [this] { return stop_.load(); };
              options.lights = [this](twin::Twin&) { return look(); };
              options.tick = [this](double now_s) { clock_.set(now_s); };
              options.longest_step_s = 0.1 / speed;
              (void)twin::serve(twin_, pty_, options);
          }) {}
    ~Machine() { (void)end(); }
    Machine(const Machine&) = delete;
    Machine& operator=(const Machine&) = delete;

    [[nodiscard]] const std::string& device() const { return pty_.device(); }
    void reset() { reset_ = true; }
    twin::Twin& end() {
        stop_ = true;
        if (thread_.joinable()) thread_.join();
        return twin_;
    }

private:
    Status look() {
        if (reset_.exchange(false)) twin_.reset();
        const bool is_lit = ::access(shown_.c_str(), F_OK) == 0;
        if (is_lit == lit_) return {};
        if (is_lit) {
            const auto bytes = read_file(shown_);
            if (!bytes) return {};
            const auto image = job::decode_png(*bytes, {width_px, height_px}, "shown.png");
            if (!image) return {};
            twin_.light_on(*image);
        } else {
            twin_.light_off();
        }
        lit_ = is_lit;
        return {};
    }

    fs::path shown_;
    operate::ClockFile clock_;
    twin::Pty pty_;
    twin::Twin twin_;
    std::atomic<bool> stop_ = false, reset_ = false;
    bool lit_ = false;
    std::thread thread_;
};

/// `pliant print` as a process; its output goes to a file.
class Host {
public:
    Host(const Wanted& wanted, const Job& job, const std::string& device, const fs::path& folder, bool resume) {
        std::vector<std::string> words = {wanted.program,  "print",   job.file.string(),
                                          "--port",        device,    "--projector",
                                          folder.string(), "--speed", fmt::format("{}", wanted.speed)};
        words.insert(words.end(), {"--clock", (folder / "clock").string()});
        if (resume) words.emplace_back("--resume");
        std::vector<char*> arguments;
        arguments.reserve(words.size() + 1);
        for (std::string& word : words) arguments.push_back(word.data());
        arguments.push_back(nullptr);
        const std::string log = (folder / "host.log").string();
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
        posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
        if (::posix_spawn(&process_, words[0].c_str(), &actions, nullptr, arguments.data(), environ) != 0)
            stop(wanted.program + ": cannot be started");
        posix_spawn_file_actions_destroy(&actions);
    }
    /// True if it ends within this time.
    bool ends_within(double seconds) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
        do {
            if (::waitpid(process_, &status_, WNOHANG) == process_) return true;
            ::usleep(1000);
        } while (std::chrono::steady_clock::now() < end);
        return false;
    }
    void interrupt() const { ::kill(process_, SIGINT); }
    void kill() {
        ::kill(process_, SIGKILL);
        ::waitpid(process_, &status_, 0);
    }
    [[nodiscard]] bool succeeded() const { return WIFEXITED(status_) && WEXITSTATUS(status_) == 0; }

private:
    pid_t process_ = 0;
    int status_ = 0;
};

std::string block_of(twin::Twin& twin) {
    std::string text;
    for (const twin::CuredLayer& layer : twin.cured().layers()) {
        text += fmt::format("{} {}:", layer.top_um, layer.thickness_um);
        for (const twin::VatLayer& vat : layer.vats) {
            for (const twin::Run& run : vat.runs)
                text += fmt::format(" {}/{}/{}-{}={}", vat.vat, run.row, run.begin, run.end, run.value);
        }
        text += '\n';
    }
    return text;
}

struct Count {
    int kills = 0, resets = 0, prints = 0, refused = 0, wrong = 0, pieces = 0;
};

/// One print that is killed several times. False if the result differs from an undisturbed print.
class Round {
public:
    Round(const Wanted& wanted, const Job& job, const fs::path& folder, std::mt19937& random, double print_s)
        : wanted_(wanted), job_(job), folder_(folder), random_(random), print_s_(print_s) {}

    std::string print(int ends, bool resets, Count& count) {
        constexpr double longest_s = 300;
        for (const char* rest : {"halves.zip.journal", "halves.zip.journal.guard", "shown.png"})
            fs::remove(folder_ / rest);
        Machine machine(job_.printer, folder_, wanted_.speed, release);
        bool begun = false;
        std::uniform_real_distribution<double> when(0.05, print_s_ * 0.9);
        for (int i = 0; i <= ends; ++i) {
            Host host(wanted_, job_, machine.device(), folder_, begun);
            const bool last = i == ends;
            if (!host.ends_within(last ? longest_s : when(random_))) {
                if (last) host.kill(), stop("the print does not end");
                if (resets)
                    machine.reset(), ++count.resets;
                else
                    host.kill(), ++count.kills;
                if (resets && !host.ends_within(longest_s)) stop("the host does not notice the reset");
            }
            if (host.succeeded()) break;
            const std::string said = read_file(folder_ / "host.log").value_or("");
            if (said.find("half-way on the hooks") != std::string::npos) return ++count.refused, "";
            if (said.find("it is complete") != std::string::npos) break;  // killed after the last record
            if (last) return "the print failed: " + said;
            begun = fs::exists(folder_ / "halves.zip.journal") && fs::file_size(folder_ / "halves.zip.journal") > 0;
        }
        return judge(machine.end(), count);
    }

    /// Ctrl-C twice: an immediate emergency stop. Without a reset the next host says that one is needed; after one it
    /// finishes the part.
    std::string interrupt_twice(Count& count) {
        constexpr double between_s = 0.1, at_once_s = 3, soon_s = 30, longest_s = 300;
        const auto said = [&] { return read_file(folder_ / "host.log").value_or(""); };
        for (const char* rest : {"halves.zip.journal", "halves.zip.journal.guard", "shown.png"})
            fs::remove(folder_ / rest);
        Machine machine(job_.printer, folder_, wanted_.speed, release);
        Host host(wanted_, job_, machine.device(), folder_, false);
        while (said().find("layer 1") == std::string::npos) {
            if (host.ends_within(0.005)) return "the print ended before it was interrupted: " + said();
        }
        host.interrupt();
        if (host.ends_within(between_s)) return "it did not wait to be parked: " + said();
        host.interrupt();
        if (!host.ends_within(at_once_s)) return host.kill(), "the second Ctrl-C did not end it";
        if (said().find("emergency stop: the board is halted") == std::string::npos) return "no way on: " + said();
        Host deaf(wanted_, job_, machine.device(), folder_, true);
        if (!deaf.ends_within(soon_s)) return deaf.kill(), "it waits for a halted board";
        if (said().find("has not been reset since") == std::string::npos) return "no word of a reset: " + said();
        machine.reset();
        Host last(wanted_, job_, machine.device(), folder_, true);
        if (!last.ends_within(longest_s)) return last.kill(), "the print does not end";
        if (said().find("half-way on the hooks") != std::string::npos) return ++count.refused, "";
        return last.succeeded() ? judge(machine.end(), count) : "the print failed: " + said();
    }

    std::string undisturbed;
    machine::MarlinRelease release = machine::MarlinRelease::v2_1_1;

private:
    std::string judge(twin::Twin& twin, Count& count) {
        const twin::Judgement judgement{{}, 0.05 * wanted_.speed};  // a busy computer may be late by 50 ms
        const twin::Report report =
            checked(twin::inspect(twin, job_.manifest, twin::ImageSource(app::halves::image), judgement));
        for (const twin::CuredLayer& layer : twin.cured().layers()) {
            for (const twin::VatLayer& vat : layer.vats) {
                for (const twin::Lit& lit : vat.lit) count.pieces += lit.pieces > 1 ? 1 : 0;
            }
        }
        if (!report.passed) return twin::report_text(report);
        if (undisturbed.empty()) undisturbed = block_of(twin);
        return undisturbed == block_of(twin) ? "" : "another part than the undisturbed print";
    }

    const Wanted& wanted_;
    const Job& job_;
    const fs::path& folder_;
    std::mt19937& random_;
    double print_s_;
};

void tell_count(const Count& count) {
    fmt::print(
        "{} kills, {} resets in {} prints: {} wrong, {} refused (vat half-way on the hooks), {} lights in pieces\n",
        count.kills, count.resets, count.prints, count.wrong, count.refused, count.pieces);
}

int kill_and_resume(const Wanted& wanted) {
    constexpr int tell_every = 20;
    const pliant::test::Folder own("kill");
    const fs::path& folder = own.path();
    const Job job = make_job(folder);
    std::mt19937 random(wanted.seed);
    Count count;
    const auto begin = std::chrono::steady_clock::now();
    Round first(wanted, job, folder, random, 1);
    if (const std::string wrong = first.print(0, false, count); !wrong.empty()) stop(wrong);
    const double print_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    fmt::print("an undisturbed print takes {:.1f} s at {:g} times the speed\n", print_s, wanted.speed);
    while (count.kills < wanted.kills || count.resets < wanted.resets) {
        const bool resets = count.kills >= wanted.kills;
        Round round(wanted, job, folder, random, print_s);
        round.undisturbed = first.undisturbed;
        round.release = count.prints % 2 == 0 ? machine::MarlinRelease::v2_1_2 : machine::MarlinRelease::v2_1_1;
        const int left = resets ? wanted.resets - count.resets : wanted.kills - count.kills;
        const std::string wrong = round.print(std::min(left, wanted.per_print), resets, count);
        ++count.prints;
        if (!wrong.empty()) ++count.wrong, fmt::print("print {}: {}\n", count.prints, wrong);
        if (count.prints % tell_every == 0) tell_count(count);
        std::fflush(stdout);
    }
    tell_count(count);
    Wanted slow = wanted;  // parking must last until the second signal
    slow.speed = std::min(wanted.speed, 50.0);
    Round twice(slow, job, folder, random, print_s * wanted.speed / slow.speed);
    twice.undisturbed = first.undisturbed;
    if (const std::string wrong = twice.interrupt_twice(count); !wrong.empty())
        ++count.wrong, fmt::print("interrupted twice: {}\n", wrong);
    return count.wrong == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) stop("pliant_kill_print PLIANT [--kills N] [--resets N] [--speed X] [--seed S] [--per-print N]");
    Wanted wanted;
    wanted.program = argv[1];
    for (int i = 2; i + 1 < argc; i += 2) {
        const std::string key = argv[i];
        const double value = std::atof(argv[i + 1]);
        if (key == "--kills") wanted.kills = static_cast<int>(value);
        if (key == "--resets") wanted.resets = static_cast<int>(value);
        if (key == "--speed") wanted.speed = value;
        if (key == "--seed") wanted.seed = static_cast<unsigned>(value);
        if (key == "--per-print") wanted.per_print = static_cast<int>(value);
    }
    return kill_and_resume(wanted);
}
