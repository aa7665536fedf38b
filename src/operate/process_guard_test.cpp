#include "operate/process_guard.hpp"

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <ctime>
#include <fstream>
#include <functional>

#include "core/test_folder.hpp"

using namespace pliant;
using namespace pliant::operate;

namespace {

/// A host that does so much with light 17 and is killed.
void die(const ProcessGuard::Options& options, const std::function<void(ProcessGuard&)>& deeds) {
    const pid_t host = ::fork();
    if (host == 0) {
        auto guard = ProcessGuard::start(options);
        std::ofstream(options.shown) << "light";
        guard->announced(17);
        deeds(*guard);
        ::kill(::getpid(), SIGKILL);
    }
    ::waitpid(host, nullptr, 0);
}

double now_s() {
    timespec now{};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// What the next host hears of light 17; the guard of the last one may still be writing.
std::optional<double> heard(const ProcessGuard::Options& options) {
    auto guard = ProcessGuard::start(options);
    REQUIRE(guard);
    std::optional<double> at;
    for (int i = 0; i < 500 && !at; ++i, ::usleep(10000)) at = guard->dark_at(17);
    CHECK_FALSE(guard->dark_at(18));
    return at;
}

}  // namespace

TEST_CASE("when the host is killed in the light, the guard makes dark and says when") {
    const pliant::test::Folder folder;
    const ProcessGuard::Options options{folder.path() / "witness", folder.path() / "shown.png", 1};
    const double before_s = now_s();
    die(options, [](ProcessGuard& guard) { guard.lit(17); });
    const auto at = heard(options);
    CHECK_FALSE(std::filesystem::exists(options.shown));
    REQUIRE(at);
    CHECK(*at >= before_s - 1e-5);  // the file has microseconds
    CHECK(*at <= now_s());
}

TEST_CASE("a host that is killed between its note and the light has given none") {
    const pliant::test::Folder folder;
    const ProcessGuard::Options options{folder.path() / "witness", folder.path() / "shown.png", 1};
    die(options, [](ProcessGuard&) {});
    CHECK(heard(options) == host::Guard::never_lit);
    CHECK(std::filesystem::exists(options.shown));
}

TEST_CASE("a host that is killed between the end of the light and its note: the guard knows when it ended") {
    const pliant::test::Folder folder;
    const ProcessGuard::Options options{folder.path() / "witness", folder.path() / "shown.png", 1};
    const auto held = folder.path() / "held";
    // The guard looks at its pipe in its own time; it must have done so before the host dies.
    die(options, [&](ProcessGuard& guard) {
        guard.lit(17);
        guard.dark();
        ::usleep(300000);
        std::ofstream file(held);
        file.precision(17);
        file << now_s();
    });
    double died_s = 0;
    std::ifstream(held) >> died_s;
    const auto at = heard(options);
    REQUIRE(at);
    CHECK(*at > 0);
    CHECK(*at < died_s);
}

TEST_CASE("a host that ends in peace leaves no witness") {
    const pliant::test::Folder folder;
    const ProcessGuard::Options options{folder.path() / "witness", folder.path() / "shown.png", 1};
    {
        auto guard = ProcessGuard::start(options);
        REQUIRE(guard);
        guard->announced(3);
        guard->lit(3);
        guard->dark();
    }
    CHECK_FALSE(std::filesystem::exists(options.witness));
}

TEST_CASE("the guard keeps nothing open that the program had open") {
    const Folder folder;
    std::array<int, 2> ends{};
    REQUIRE(::pipe(ends.data()) == 0);
    auto guard = ProcessGuard::start({folder.path / "witness", folder.path / "shown.png", 1});
    REQUIRE(guard);
    ::close(ends[1]);
    char byte = 0;
    CHECK(::read(ends[0], &byte, 1) == 0);  // would wait for good if the guard held the other end
    ::close(ends[0]);
}
