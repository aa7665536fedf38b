#include "studio/print/print_news.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <thread>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"

using namespace pliant;
using namespace pliant::studio;

namespace {

host::Snapshot printing() {
    host::Snapshot s;
    s.state = host::State::printing;
    s.job = "finger";
    s.layer = 11;
    s.layers = 240;
    return s;
}

}  // namespace

TEST_CASE("news are sent when a print ends, stops or waits for somebody, once each") {
    const host::Snapshot before = printing();
    CHECK_FALSE(news_between(before, before));
    host::Snapshot later = before;
    later.layer = 12;
    CHECK_FALSE(news_between(before, later));

    host::Snapshot done = before;
    done.finished = true;
    done.state = host::State::idle;
    REQUIRE(news_between(before, done));
    CHECK(news_between(before, done)->event == "finished");
    CHECK(news_between(before, done)->text == "finger is printed");
    CHECK_FALSE(news_between(done, done));

    host::Snapshot halted = before;
    halted.state = host::State::halted;
    halted.failed = true;
    halted.message = "emergency stop";
    REQUIRE(news_between(before, halted));
    CHECK(news_between(before, halted)->event == "stopped");
    CHECK(news_between(before, halted)->text == "finger: the machine has stopped, layer 12 of 240: emergency stop");

    host::Snapshot failed = before;
    failed.failed = true;
    REQUIRE(news_between(before, failed));
    CHECK(news_between(before, failed)->event == "failed");

    // A person who has paused the print knows it; one who must refill resin does not.
    host::Snapshot paused = before;
    paused.state = host::State::paused;
    CHECK_FALSE(news_between(before, paused));
    paused.prompt = "refill the vat of slot 1";
    REQUIRE(news_between(before, paused));
    CHECK(news_between(before, paused)->event == "waiting");
    CHECK(news_between(before, paused)->text == "finger waits for you, layer 12 of 240: refill the vat of slot 1");
    CHECK_FALSE(news_between(paused, paused));
}

TEST_CASE("a news command gets event, text and job in its environment") {
    const pliant::test::Folder folder;
    const auto file = folder / "heard";
    const std::string command = "printf '%s|%s|%s' \"$PLIANT_EVENT\" \"$PLIANT_TEXT\" \"$PLIANT_JOB\" > " +
                                file.string() + ".partial && mv " + file.string() + ".partial " + file.string();
    REQUIRE(tell_by_command(command, {"waiting", "it's \"so\" $HOME"}, "bar"));
    for (int i = 0; i < 500 && !std::filesystem::exists(file); ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    CHECK(read_file(file).value() == "waiting|it's \"so\" $HOME|bar");
}
