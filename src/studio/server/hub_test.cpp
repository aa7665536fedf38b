// Which page is in control, and what a slow page receives.
#include "studio/server/hub.hpp"

#include <doctest/doctest.h>

#include <string>

using namespace pliant::studio;

namespace {

Bytes bytes(const char* text) {
    return std::make_shared<const std::string>(text);
}

/// The last text that waits for a page.
std::string last_text(const std::shared_ptr<Connection>& connection) {
    std::string last;
    connection->send_text(bytes("end"));
    for (auto out = connection->next(); out && *out->bytes != "end"; out = connection->next()) last = *out->bytes;
    return last;
}

bool says(const std::string& json, const char* part) {
    return json.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("the first page is in control; another page can ask for control, and gets it when it is given") {
    Hub hub;
    const auto a = hub.join(), b = hub.join();
    hub.hello(a, "page_aaaa");
    hub.hello(b, "page_bbbb");
    CHECK(hub.may_steer("page_aaaa"));
    CHECK_FALSE(hub.may_steer("page_bbbb"));
    CHECK_FALSE(hub.may_steer(""));
    hub.give(b);  // b is not in control
    hub.ask(b);
    CHECK_FALSE(hub.may_steer("page_bbbb"));
    CHECK(says(last_text(a), R"("asked":true)"));
    CHECK(says(last_text(b), R"("waiting":true)"));
    hub.give(a);
    CHECK(hub.may_steer("page_bbbb"));
    CHECK_FALSE(hub.may_steer("page_aaaa"));
    CHECK(says(last_text(b), R"("you":true)"));
    hub.let_go(b);
    CHECK(hub.may_steer("page_aaaa"));
}

TEST_CASE("a page that disconnects keeps control for ten seconds") {
    Hub::Clock::time_point now{};
    Hub hub([&] { return now; });
    const auto a = hub.join(), b = hub.join();
    hub.hello(a, "page_aaaa");
    hub.hello(b, "page_bbbb");
    hub.leave(a);
    now += std::chrono::seconds(9);
    CHECK_FALSE(hub.may_steer("page_bbbb"));
    const auto again = hub.join();
    hub.hello(again, "page_aaaa");
    now += std::chrono::seconds(60);
    CHECK(hub.may_steer("page_aaaa"));
    CHECK_FALSE(hub.may_steer("page_bbbb"));
    hub.leave(again);
    now += std::chrono::seconds(11);
    CHECK(hub.may_steer("page_bbbb"));

    hub.hello(hub.join(), "page_aaaa");  // returns too late
    CHECK_FALSE(hub.may_steer("page_aaaa"));
}

TEST_CASE("a slow page gets the latest frame only, but every text in order") {
    Hub hub;
    const auto page = hub.join();
    hub.send_text("one");
    hub.send_frame(bytes("frame 1"));
    hub.send_frame(bytes("frame 2"));
    hub.send_text("two");
    CHECK(*page->next()->bytes == "one");
    CHECK(*page->next()->bytes == "two");
    const auto frame = page->next();
    CHECK(frame->binary);
    CHECK(*frame->bytes == "frame 2");
    page->close();
    CHECK_FALSE(page->next());
}

TEST_CASE("a page that no longer reads is disconnected") {
    Hub hub;
    const auto page = hub.join();
    for (int i = 0; i < 2000; ++i) hub.send_text("text");
    CHECK_FALSE(page->next());
}

TEST_CASE("frames carry the fields that any page has asked for") {
    Hub hub;
    const auto a = hub.join(), b = hub.join();
    hub.want_fields(a, {"J"});
    hub.want_fields(b, {"J", "energy"});
    CHECK(hub.fields() == std::set<std::string>{"J", "energy"});
    hub.leave(b);
    CHECK(hub.fields() == std::set<std::string>{"J"});
}

TEST_CASE("two robots have separate latest frames, and neither waits for the other") {
    Hub hub;
    const auto page = hub.join();
    const auto bytes = [](const char* text) { return std::make_shared<const std::string>(text); };
    for (const char* text : {"a1", "a2", "a3"}) hub.send_frame(bytes(text));
    for (const char* text : {"b1", "b2"}) hub.send_frame_beside(bytes(text));
    CHECK(*page->next()->bytes == "a3");
    hub.send_frame(bytes("a4"));
    CHECK(*page->next()->bytes == "b2");
    CHECK(*page->next()->bytes == "a4");
    hub.send_frame_beside(bytes("b3"));
    CHECK(*page->next()->bytes == "b3");
    hub.close_all();
    CHECK_FALSE(page->next());
}

TEST_CASE("a new page gets control at once if the page in control has no connection") {
    Hub hub;
    const auto a = hub.join();
    hub.hello(a, "page_aaaa");
    hub.leave(a);  // its browser has crashed
    const auto b = hub.join();
    hub.hello(b, "page_bbbb");
    CHECK(says(last_text(b), R"("you":true)"));
    CHECK(hub.may_steer("page_bbbb"));
    CHECK_FALSE(hub.may_steer("page_aaaa"));
}

TEST_CASE("a page that watches gets control without a request once the lost one's ten seconds are over") {
    Hub::Clock::time_point now{};
    Hub hub([&] { return now; });
    const auto a = hub.join(), b = hub.join();
    hub.hello(a, "page_aaaa");
    hub.hello(b, "page_bbbb");
    hub.ping();
    CHECK(says(last_text(b), R"("you":false)"));
    hub.leave(a);
    now += std::chrono::seconds(9);
    hub.ping();
    CHECK(says(last_text(b), R"("you":false)"));
    now += std::chrono::seconds(2);
    hub.ping();
    CHECK(says(last_text(b), R"("you":true)"));
}

TEST_CASE("a page that is closed hands control to one that watches; to none if it is the last") {
    Hub hub;
    const auto a = hub.join(), b = hub.join();
    hub.hello(a, "page_aaaa");
    hub.hello(b, "page_bbbb");
    hub.let_go(a);
    hub.leave(a);
    CHECK(says(last_text(b), R"("you":true)"));
    hub.let_go(b);
    CHECK(says(last_text(b), R"("you":false,"held":false)"));
}
