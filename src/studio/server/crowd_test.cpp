#include "studio/server/crowd.hpp"

#include <doctest/doctest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <vector>

using namespace pliant::studio;

TEST_CASE("of many connections without a request the oldest are hung up; one at work stays, and a new one") {
    const int server = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t length = sizeof address;
    REQUIRE(bind(server, reinterpret_cast<sockaddr*>(&address), length) == 0);
    REQUIRE(listen(server, 64) == 0);
    REQUIRE(getsockname(server, reinterpret_cast<sockaddr*>(&address), &length) == 0);
    const int port = ntohs(address.sin_port);

    Crowd crowd;
    std::vector<int> calling, answering;
    const auto call = [&] {
        calling.push_back(socket(AF_INET, SOCK_STREAM, 0));
        REQUIRE(connect(calling.back(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
        answering.push_back(accept(server, nullptr, nullptr));
        REQUIRE(answering.back() >= 0);
    };
    const auto is_open = [&](std::size_t k) {
        char byte = 0;
        return recv(calling[k], &byte, 1, MSG_DONTWAIT) < 0;  // 0: hung up
    };
    call();
    sockaddr_in own{};
    length = sizeof own;
    REQUIRE(getsockname(calling[0], reinterpret_cast<sockaddr*>(&own), &length) == 0);
    crowd.begin({"127.0.0.1", ntohs(own.sin_port)});
    while (calling.size() < 1 + Crowd::most_waiting) call();
    crowd.thin(port);
    for (std::size_t k = 0; k < calling.size(); ++k) CHECK(is_open(k));
    call();  // one too many
    crowd.thin(port);
    std::size_t open = 0;
    for (std::size_t k = 0; k < calling.size(); ++k) open += is_open(k) ? 1 : 0;
    CHECK(open == calling.size() - 1);
    CHECK(is_open(0));
    CHECK(is_open(calling.size() - 1));
    for (const int file : calling) close(file);
    for (const int file : answering) close(file);
    close(server);
}
