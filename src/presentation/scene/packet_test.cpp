#include "presentation/scene/packet.hpp"

#include <doctest/doctest.h>

#include <cstring>
#include <nlohmann/json.hpp>

using namespace pliant::view;

TEST_CASE("a packet holds its head and its arrays, each aligned to four bytes") {
    for (const char* head : {"{}", R"({"a":1})", R"({"a":12})", R"({"a":123})", R"({"a":1234})"}) {
        Packet packet;
        packet.add("positions", std::vector<float>{1.5F, -2, 3});
        packet.add("triangles", std::vector<std::uint32_t>{0, 1, 70000});
        packet.add("nothing", std::vector<float>{});
        const std::string bytes = packet.finish(head);
        CHECK(bytes.substr(0, 4) == "PLN1");
        std::uint32_t length = 0;
        std::memcpy(&length, bytes.data() + 4, 4);
        CHECK(length % 4 == 0);
        const auto json = nlohmann::json::parse(bytes.substr(8, length));
        CHECK(json["head"] == nlohmann::json::parse(head));
        CHECK(json["arrays"].size() == 3);
        CHECK(json["arrays"][1]["name"] == "triangles");
        CHECK(json["arrays"][1]["count"] == 3);
        REQUIRE(bytes.size() == 8 + length + 24);
        float second = 0;
        std::memcpy(&second, bytes.data() + 8 + length + 4, 4);
        CHECK(second == -2);
        std::uint32_t last = 0;
        std::memcpy(&last, bytes.data() + 8 + length + 20, 4);
        CHECK(last == 70000);
    }
}
