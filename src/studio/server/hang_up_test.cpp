#include "studio/server/hang_up.hpp"

#include <doctest/doctest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <string_view>
#include <thread>

using namespace pliant::studio;

namespace {

/// A socket that listens on a free port of this machine.
struct Listening {
    int file = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};

    Listening() {
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t length = sizeof address;
        REQUIRE(bind(file, reinterpret_cast<sockaddr*>(&address), length) == 0);
        REQUIRE(listen(file, 4) == 0);
        REQUIRE(getsockname(file, reinterpret_cast<sockaddr*>(&address), &length) == 0);
    }
    Listening(const Listening&) = delete;
    Listening& operator=(const Listening&) = delete;
    ~Listening() { close(file); }

    [[nodiscard]] int port() const { return ntohs(address.sin_port); }
    [[nodiscard]] int call() const {
        const int caller = socket(AF_INET, SOCK_STREAM, 0);
        REQUIRE(connect(caller, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
        return caller;
    }
};

}  // namespace

TEST_CASE(
    "threads that wait on the sockets of a port go on, and what was written arrives; other ports are left alone") {
    const Listening server, other;
    const int caller = server.call(), answering = accept(server.file, nullptr, nullptr);
    const int elsewhere = other.call(), there = accept(other.file, nullptr, nullptr);
    REQUIRE(write(answering, "last", 4) == 4);

    ssize_t read_bytes = -1;
    int accepted = 0;
    std::thread reader([&] {
        char byte = 0;
        read_bytes = read(answering, &byte, 1);
    });
    std::thread acceptor([&] { accepted = accept(server.file, nullptr, nullptr); });
    // It may be called before they wait.
    hang_up(server.port());
    reader.join();
    acceptor.join();
    CHECK(read_bytes == 0);
    CHECK(accepted == -1);

    std::array<char, 8> got{};
    CHECK(read(caller, got.data(), got.size()) == 4);
    CHECK(std::string_view(got.data(), 4) == "last");
    CHECK(write(elsewhere, "x", 1) == 1);
    CHECK(read(there, got.data(), 1) == 1);
    for (const int file : {caller, answering, elsewhere, there}) close(file);
}
