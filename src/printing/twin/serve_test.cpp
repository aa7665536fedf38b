#include "printing/twin/serve.hpp"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <string>
#include <thread>

#include "base/core/test_folder.hpp"

using namespace pliant;
using namespace pliant::twin;

namespace {

/// A host's end of the device: sends a line, reads until `wanted` has arrived or five seconds have passed.
struct Host {
    int file;
    std::string heard;
    explicit Host(const std::string& device) : file(::open(device.c_str(), O_RDWR | O_NOCTTY)) { REQUIRE(file >= 0); }
    ~Host() { ::close(file); }
    bool hears(const std::string& wanted) {
        for (int i = 0; i < 500 && heard.find(wanted) == std::string::npos; ++i) {
            pollfd wait{file, POLLIN, 0};
            char bytes[256];
            if (::poll(&wait, 1, 10) <= 0) continue;
            const ssize_t got = ::read(file, bytes, sizeof bytes);
            if (got > 0) heard.append(bytes, static_cast<std::size_t>(got));
        }
        const std::size_t at = heard.find(wanted);
        heard.erase(0, at == std::string::npos ? heard.size() : at + wanted.size());
        return at != std::string::npos;
    }
    void say(const std::string& line) const {
        REQUIRE(::write(file, line.data(), line.size()) == static_cast<ssize_t>(line.size()));
    }
};

}  // namespace

TEST_CASE("a host can open the device like a serial port, home at 1000 times the speed, and connect again") {
    const auto printer = machine::load_printer("examples/printers/tower.toml").value();
    const pliant::test::Folder folder("serve");
    const std::filesystem::path link = folder / "printer";
    Twin twin(printer);
    std::atomic<bool> stop = false;
    {
        auto pty = Pty::open(link);
        REQUIRE_MESSAGE(pty, (pty ? "" : pty.error().message));
        std::thread machine([&] { CHECK(serve(twin, *pty, {1000, [&] { return stop.load(); }, {}, {}, {}})); });
        {
            Host host(link.string());
            CHECK(host.hears("start\n"));
            host.say("G28 Z\n");
            CHECK(host.hears("busy: processing\n"));
            CHECK(host.hears("\nok\n"));
        }
        Host again(pty->device());
        again.say("M114\n");
        CHECK(again.hears("Z:400.000"));
        CHECK(again.hears("ok\n"));
        stop = true;
        machine.join();
    }
    CHECK_FALSE(std::filesystem::is_symlink(link));
    CHECK(twin.interlock().homed(machine::Axis::platform));
}

TEST_CASE("a link does not replace an existing file") {
    const pliant::test::Folder folder("serve");
    CHECK_FALSE(Pty::open(folder.path()));
    CHECK_FALSE(Pty::open(folder / "no such folder" / "x"));
}

TEST_CASE("the link of a running twin is neither taken over nor removed; one left behind is replaced") {
    const pliant::test::Folder folder("pty_link");
    const auto link = folder / "port";
    {
        auto first = Pty::open(link);
        REQUIRE(first);
        const auto second = Pty::open(link);
        REQUIRE_FALSE(second);
        CHECK(second.error().message.find("leads to " + first->device() + ", which another twin serves") !=
              std::string::npos);
        CHECK(std::filesystem::read_symlink(link) == first->device());
        // Somebody has put another link in its place.
        std::filesystem::remove(link);
        std::filesystem::create_symlink("/dev/pts/999999", link);
    }
    CHECK(std::filesystem::is_symlink(link));
    {
        const auto next = Pty::open(link);
        REQUIRE(next);
        CHECK(std::filesystem::read_symlink(link) == next->device());
    }
    CHECK_FALSE(std::filesystem::is_symlink(link));
    std::filesystem::create_symlink(folder / "mine", link);
    CHECK_FALSE(Pty::open(link));
    CHECK(std::filesystem::is_symlink(link));
}
