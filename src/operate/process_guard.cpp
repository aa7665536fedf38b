#include "operate/process_guard.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>

namespace pliant::operate {
namespace {

constexpr long it_is_dark = 0;
constexpr long farewell = -1;

std::string boot_name() {
    std::ifstream file("/proc/sys/kernel/random/boot_id");
    std::string name;
    std::getline(file, name);
    return name.empty() ? "-" : name;
}

double monotonic_s() {
    timespec now{};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

/// What the guard does when the host has died with a light on. The picture goes first.
void make_dark(const ProcessGuard::Options& options, const std::string& boot, long light) {
    if (!options.shown.empty()) ::unlink(options.shown.c_str());
    std::array<char, 160> line{};
    const double now_s = options.clock != nullptr ? options.clock->now() : monotonic_s() * options.clock_speed;
    const int length = std::snprintf(line.data(), line.size(), "%s %ld %.6f\n", boot.c_str(), light, now_s);
    const int file = ::open(options.witness.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
    if (file < 0) return;
    if (::write(file, line.data(), static_cast<std::size_t>(length)) == length) ::fsync(file);
    ::close(file);
}

/// What else this program has open (sockets, the journal, other guards' pipes) must not stay open in the guard.
void close_all_but(int kept) {
    if (kept > 3) ::close_range(3, static_cast<unsigned>(kept) - 1, 0);
    ::close_range(static_cast<unsigned>(kept) + 1, ~0U, 0);
}

/// The guard's life. Nothing here waits for another thread: of those the guard has none, whatever they held.
[[noreturn]] void stand_guard(int pipe, const ProcessGuard::Options& options, const std::string& boot) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) std::signal(signal, SIG_IGN);
    ::setsid();
    long light = it_is_dark;
    for (;;) {
        long message = it_is_dark;
        const ssize_t got = ::read(pipe, &message, sizeof message);
        if (got < 0 && errno == EINTR) continue;
        if (got != sizeof message) break;
        if (message == farewell) ::_exit(0);
        light = message;
    }
    if (light != it_is_dark) make_dark(options, boot, light);
    ::_exit(0);
}

}  // namespace

Result<ProcessGuard> ProcessGuard::start(const Options& options) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) return failure("no guard: {}", std::strerror(errno));
    const std::string boot = boot_name();
    const pid_t process = ::fork();
    if (process < 0) return failure("no guard: {}", std::strerror(errno));
    if (process == 0) {
        close_all_but(ends[0]);
        stand_guard(ends[0], options, boot);
    }
    ::close(ends[0]);
    return ProcessGuard(ends[1], process, options);
}

ProcessGuard::ProcessGuard(ProcessGuard&& other) noexcept
    : pipe_(std::exchange(other.pipe_, -1)),
      process_(std::exchange(other.process_, -1)),
      options_(std::move(other.options_)) {}

ProcessGuard::~ProcessGuard() {
    if (pipe_ < 0) return;
    tell(farewell);
    ::close(pipe_);
    ::waitpid(process_, nullptr, 0);
}

/// Short enough to arrive whole or not at all.
void ProcessGuard::tell(long message) const {
    ssize_t put = 0;
    do {
        put = ::write(pipe_, &message, sizeof message);
    } while (put < 0 && errno == EINTR);
}

void ProcessGuard::lit(long light) {
    tell(light);
}

void ProcessGuard::dark() {
    tell(it_is_dark);
}

std::optional<double> ProcessGuard::dark_at(long light) {
    const std::string boot = boot_name();
    std::ifstream file(options_.witness);
    std::optional<double> found;
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string when_booted;
        long seen = 0;
        double at_s = 0;
        if (words >> when_booted >> seen >> at_s && when_booted == boot && seen == light) found = at_s;
    }
    return found;
}

}  // namespace pliant::operate
