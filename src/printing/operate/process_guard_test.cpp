#include "printing/operate/process_guard.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "base/core/near.hpp"
#include "base/core/test_folder.hpp"

using namespace pliant;
using namespace pliant::operate;

namespace {

/// A host that goes so far with exposure 17 and is then killed.
void run_killed_host(const ProcessGuard::Options& options, const std::function<void(ProcessGuard&)>& actions) {
    const pid_t host = ::fork();
    if (host == 0) {
        auto guard = ProcessGuard::start(options);
        std::ofstream(options.shown) << "light";
        (void)guard->announced(17);
        actions(*guard);
        ::kill(::getpid(), SIGKILL);
    }
    ::waitpid(host, nullptr, 0);
}

/// The processes that this one has started.
std::vector<pid_t> children() {
    std::vector<pid_t> found;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
        std::ifstream file(entry.path() / "status");
        for (std::string line; std::getline(file, line);)
            if (line == fmt::format("PPid:\t{}", ::getpid())) found.push_back(std::stoi(entry.path().filename()));
    }
    return found;
}

double now_s() {
    timespec now{};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// What the next host learns of exposure 17; the guard of the previous one may still be writing.
std::optional<double> recorded_exposure_s(const ProcessGuard::Options& options) {
    auto guard = ProcessGuard::start(options);
    REQUIRE(guard);
    std::optional<double> on_s;
    for (int i = 0; i < 500 && !on_s; ++i, ::usleep(10000)) on_s = guard->lit_s(17);
    CHECK_FALSE(guard->lit_s(18));
    return on_s;
}

}  // namespace

TEST_CASE("a host without its guard hears so, and lives on") {
    const pliant::test::Folder folder;
    auto guard = ProcessGuard::start({folder.path() / "witness", folder.path() / "shown.png", 1});
    REQUIRE(guard);
    CHECK(guard->announced(1));
    const std::vector<pid_t> processes = children();
    REQUIRE(processes.size() == 1);
    ::kill(processes[0], SIGKILL);
    siginfo_t ended{};
    ::waitid(P_PID, static_cast<id_t>(processes[0]), &ended, WEXITED | WNOWAIT);
    const Status told = guard->announced(2);
    REQUIRE_FALSE(told);
    CHECK(told.error().message.find("the guard process has ended") == 0);
    guard->lit(1);
    guard->dark(2);
}

TEST_CASE("if the host is killed during an exposure, the guard turns it off and reports its length") {
    const pliant::test::Folder folder;
    const ProcessGuard::Options options{folder.path() / "witness", folder.path() / "shown.png", 1};
    const double before_s = now_s();
    run_killed_host(options, [](ProcessGuard& guard) {
        guard.lit(now_s());
        ::usleep(200000);
    });
    const auto on_s = recorded_exposure_s(options);
    CHECK_FALSE(std::filesystem::exists(options.shown));
    REQUIRE(on_s);
    CHECK(*on_s > 0.19);
    CHECK(*on_s <= now_s() - before_s);
}

TEST_CASE("a host killed between its journal entry and the exposure: 0 s of light") {
    const pliant::test::Folder folder;
    const ProcessGuard::Options options{folder.path() / "witness", folder.path() / "shown.png", 1};
    run_killed_host(options, [](ProcessGuard&) {});
    CHECK(recorded_exposure_s(options) == 0);
    CHECK(std::filesystem::exists(options.shown));
    // A later print may have an exposure of the same number.
    auto guard = ProcessGuard::start(options);
    REQUIRE(guard);
    guard->forget();
    CHECK_FALSE(guard->lit_s(17));
}

TEST_CASE("a host killed between an exposure and its journal entry: the whole exposure counts") {
    const pliant::test::Folder folder;
    const ProcessGuard::Options options{folder.path() / "witness", folder.path() / "shown.png", 1};
    run_killed_host(options, [&](ProcessGuard& guard) {
        guard.lit(100);
        guard.dark(102.5);
    });
    const auto on_s = recorded_exposure_s(options);
    REQUIRE(on_s);
    CHECK(*on_s == near(2.5, {.relative = 1e-12}));
}

TEST_CASE("a host that ends normally leaves no record of the guard") {
    const pliant::test::Folder folder;
    const ProcessGuard::Options options{folder.path() / "witness", folder.path() / "shown.png", 1};
    {
        auto guard = ProcessGuard::start(options);
        REQUIRE(guard);
        REQUIRE(guard->announced(3));
        guard->lit(1);
        guard->dark(2);
    }
    CHECK_FALSE(std::filesystem::exists(options.witness));
}

TEST_CASE("the guard inherits no open files of the program") {
    const pliant::test::Folder folder;
    std::array<int, 2> ends{};
    REQUIRE(::pipe(ends.data()) == 0);
    auto guard = ProcessGuard::start({folder.path() / "witness", folder.path() / "shown.png", 1});
    REQUIRE(guard);
    ::close(ends[1]);
    char byte = 0;
    CHECK(::read(ends[0], &byte, 1) == 0);  // would block forever if the guard held the other end
    ::close(ends[0]);
}
