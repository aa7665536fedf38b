#include "operate/process_guard.hpp"

#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <fstream>

using namespace pliant;
using namespace pliant::operate;

namespace {

struct Folder {
    std::filesystem::path path;
    Folder() {
        std::string name = (std::filesystem::temp_directory_path() / "pliant_guard_XXXXXX").string();
        path = ::mkdtemp(name.data());
    }
    ~Folder() { std::filesystem::remove_all(path); }
};

/// A host that lights and is killed; whether its picture is gone a moment later.
void die_lit(const ProcessGuard::Options& options, bool dark_before) {
    const pid_t host = ::fork();
    if (host == 0) {
        auto guard = ProcessGuard::start(options);
        std::ofstream(options.shown) << "light";
        guard->lit(17);
        if (dark_before) guard->dark();
        ::kill(::getpid(), SIGKILL);
    }
    ::waitpid(host, nullptr, 0);
}

}  // namespace

TEST_CASE("when the host is killed in the light, the guard makes dark and says when") {
    const Folder folder;
    const ProcessGuard::Options options{folder.path / "witness", folder.path / "shown.png", 1};
    die_lit(options, false);
    for (int i = 0; i < 500 && !std::filesystem::exists(options.witness); ++i) ::usleep(10000);
    CHECK_FALSE(std::filesystem::exists(options.shown));
    auto guard = ProcessGuard::start(options);
    REQUIRE(guard);
    std::optional<double> at;
    for (int i = 0; i < 500 && !at; ++i, ::usleep(10000)) at = guard->dark_at(17);
    timespec now{};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    REQUIRE(at);
    CHECK(*at > 0);
    CHECK(*at <= static_cast<double>(now.tv_sec) + 1);
    CHECK_FALSE(guard->dark_at(18));
}

TEST_CASE("a host that ends in the dark leaves no witness") {
    const Folder folder;
    const ProcessGuard::Options options{folder.path / "witness", folder.path / "shown.png", 1};
    die_lit(options, true);
    {
        auto guard = ProcessGuard::start(options);
        REQUIRE(guard);
        guard->lit(3);
        guard->dark();
    }
    CHECK_FALSE(std::filesystem::exists(options.witness));
    CHECK(std::filesystem::exists(options.shown));
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
