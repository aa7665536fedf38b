// Valid and invalid messages of a page.
#include "studio/requests/message.hpp"

#include <doctest/doctest.h>

#include <string>

using namespace pliant::studio;

TEST_CASE("every kind of message is read") {
    const auto drive = parse_message(
        R"({"type":"drive","tag":3,"time":0.5,"actuators":[{"name":"flexor","kind":"length_ratio","value":0.8}]})");
    REQUIRE(drive);
    const auto& d = std::get<DriveMessage>(*drive);
    CHECK(d.tag == 3);
    CHECK(d.time == 0.5);
    REQUIRE(d.actuators.size() == 1);
    CHECK(d.actuators[0].name == "flexor");
    CHECK(d.actuators[0].value == 0.8);
    CHECK_FALSE(std::get<DriveMessage>(*parse_message(R"({"type":"drive","actuators":[]})")).time);
    const auto pull = parse_message(R"({"type":"pull","vertex":12,"to":[1,2.5,-3]})");
    REQUIRE(pull);
    CHECK(std::get<PullMessage>(*pull).vertex == 12);
    CHECK(std::get<PullMessage>(*pull).to_mm[2] == -3);
    CHECK(std::get<Hello>(*parse_message(R"({"type":"hello","page":"abcd-EF_1"})")).page == "abcd-EF_1");
    CHECK(std::get<Follow>(*parse_message(R"({"type":"follow","time":0.25})")).time == 0.25);
    CHECK_FALSE(std::get<Play>(*parse_message(R"({"type":"play","on":false})")).on);
    CHECK(std::get<FieldsMessage>(*parse_message(R"({"type":"fields","names":["J"]})")).names.size() == 1);
    CHECK(std::get<Steer>(*parse_message(R"({"type":"steer","action":"give"})")).action == Steer::Action::give);
    CHECK(std::holds_alternative<Rest>(*parse_message(R"({"type":"rest"})")));
    CHECK(std::holds_alternative<Release>(*parse_message(R"({"type":"release"})")));
    CHECK(std::holds_alternative<Ping>(*parse_message(R"({"type":"ping"})")));
}

TEST_CASE("every other message is refused, and the key is named") {
    const std::pair<const char*, const char*> cases[] = {
        {"", "object"},
        {"[]", "object"},
        {"{\"type\":", "object"},
        {R"({"type":"launch"})", "type"},
        {R"({"type":7})", "type"},
        {R"({"type":"hello","page":"short"})", "page"},
        {R"({"type":"hello","page":"abcdefgh<script>"})", "page"},
        {R"({"type":"follow","time":1e10})", "time"},
        {R"({"type":"follow","time":"1"})", "time"},
        {R"({"type":"follow","time":-0.1})", "time"},
        {R"({"type":"drive","time":-1,"actuators":[]})", "time"},
        {R"({"type":"drive","actuators":[{"name":"a","kind":"b"}]})", "actuators"},
        {R"({"type":"drive","actuators":[7]})", "actuators"},
        {R"({"type":"drive"})", "actuators"},
        {R"({"type":"pull","vertex":1.5,"to":[0,0,0]})", "vertex"},
        {R"({"type":"pull","vertex":-1,"to":[0,0,0]})", "vertex"},
        {R"({"type":"pull","vertex":1,"to":[0,0]})", "to"},
        {R"({"type":"lead","to":[0,0,1]})", "marker"},
        {R"({"type":"lead","marker":"tip","to":[0,0,"a"]})", "to"},
        {R"({"type":"play"})", "on"},
        {R"({"type":"steer","action":"seize"})", "action"},
    };
    for (const auto& [text, key] : cases) {
        const auto message = parse_message(text);
        REQUIRE_MESSAGE(!message, text);
        CHECK_MESSAGE(message.error().message.find(key) != std::string::npos, message.error().message);
    }
}

TEST_CASE("overlong and deeply nested messages are refused before they are parsed") {
    CHECK_FALSE(parse_message(std::string(longest_message + 1, ' ')));
    CHECK_FALSE(parse_message(R"({"type":"ping","x":)" + std::string(30000, '[') + std::string(30000, ']') + "}"));
    std::string many = R"({"type":"fields","names":["J")";
    for (int i = 0; i < 300; ++i) many += ",\"J\"";
    CHECK_FALSE(parse_message(many + "]}"));
}
