#include "studio/print/print_session.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "base/core/test_folder.hpp"
#include "base/core/test_text.hpp"
#include "printing/prepare/slice_job.hpp"
#include "studio/make/slice_robot.hpp"
#include "studio/make/test_orders.hpp"

using namespace pliant;
using namespace pliant::studio;
using pliant::test::holds;
using studio::test::Events;
using studio::test::Json;
namespace fs = std::filesystem;

namespace {

struct PrintBench {
    const pliant::test::Folder folder;
    Events events;
    PrintSession session{[this](const std::string& json) { events.add(json); }};
    PrintSession::Order order{folder / "bar.zip", {"#123456"}};

    PrintBench() {
        Progress silent;
        JobUnderWay unseen;
        const auto made = slice_robot(studio::test::slice_order(), order.job, silent, unseen);
        REQUIRE_MESSAGE(made, (made ? "" : made.error().message));
    }
    [[nodiscard]] host::ApiAnswer command(const std::string& text) {
        return session.ask("POST", "/api/job", R"({"command":")" + text + "\"}");
    }
    [[nodiscard]] Json about() const { return Json::parse(session.describe()); }
    /// Waits for the end of the print and its verdict.
    [[nodiscard]] std::string verdict() const {
        for (int i = 0; i < 6000; ++i) {
            if (std::string said = session.verdict(); said != "null") return said;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        return "no verdict";
    }
    void wait_for_state(const std::string& state) {
        (void)events.wait_for(
            [&](const Json& e) { return e["type"] == "print" && e["current"]["state"]["text"] == state; });
    }
};

/// Until the machine that was connected has answered.
void wait_until_ready(const PrintSession& session) {
    for (int i = 0; i < 6000; ++i) {
        if (Json::parse(session.describe())["now"]["state"]["flags"]["ready"] == true) return;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    FAIL_CHECK("the machine is not ready");
}

}  // namespace

TEST_CASE("without a machine there is nothing to ask, to show or to control") {
    Events events;
    PrintSession session([&](const std::string& json) { events.add(json); });
    CHECK(session.describe() == R"({"machine":null})");
    CHECK(session.ask("GET", "/api/printer", "").status == 404);
    CHECK(session.part(0, 0).empty());
    CHECK_FALSE(session.image(0, 0).has_value());
    CHECK(session.verdict() == "null");
    CHECK(session.files().job.empty());
    CHECK(session.set_speed(10).error().message == "there is no virtual printer");
    CHECK(session.set_door(true).error().message == "there is no virtual printer");
    CHECK(session.give_back().has_value());
    CHECK(events.count("machine") == 0);
}

TEST_CASE("a job whose file has changed is not printed as the one that was shown") {
    PrintBench b;
    b.order.stamp = stamp_of(b.order.job);
    REQUIRE(b.session.take_twin(b.order, 1000).has_value());
    REQUIRE(write_file(b.order.job, read_file(b.order.job).value()).has_value());
    CHECK(holds(b.session.take_twin(b.order, 1000).error().message, "has changed since it was opened"));
    CHECK(b.session.files().job == b.order.job);  // still connected
    b.order.stamp = stamp_of(b.order.job);
    CHECK(b.session.take_twin(b.order, 1000).has_value());
}

TEST_CASE("invalid requests for a machine are refused with the reason, and the current machine stays") {
    PrintBench b;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double speed : {0.0, -1.0, 1e9, nan})
        CHECK(holds(b.session.take_twin(b.order, speed).error().message, "speed: "));
    CHECK(holds(b.session.take_twin({b.folder / "none.zip", {}}, 1).error().message, "none.zip"));
    CHECK(b.session.describe() == R"({"machine":null})");
    REQUIRE(b.session.take_twin(b.order, 1).has_value());
    CHECK(b.about()["taken"] == 1);
    const auto refused_port = [&](const std::string& device) {
        operate::PortOptions port;
        port.device = device;
        return b.session.take_port(b.order, port).error().message;
    };
    CHECK(holds(refused_port("/dev/no_such_port"), "device: there is no /dev/no_such_port"));
    CHECK(holds(refused_port(b.order.job.string()), "is not a serial port"));  // would be written to
    CHECK(holds(refused_port("/dev"), "is not a serial port"));
    for (const double speed : {0.0, nan}) CHECK(holds(b.session.set_speed(speed).error().message, "speed: "));
    CHECK(holds(b.session.set_door(true).error().message, "has no door"));
    CHECK(b.about()["taken"] == 1);
    CHECK(b.about()["twin"] == true);
    CHECK(b.session.set_speed(50).has_value());
    CHECK(b.about()["speed"] == 50);
}

TEST_CASE("a job is printed on the virtual printer and inspected; then the machine is released") {
    PrintBench b;
    REQUIRE(b.session.take_twin(b.order, 10000).has_value());
    CHECK(b.about()["job"] == "bar");
    CHECK(b.about()["file"] == "bar.zip");
    CHECK(b.about()["materials"][0]["colour"] == "#123456");
    CHECK(b.session.files().job == b.order.job);
    CHECK(b.session.image(0, 0).value().substr(1, 3) == "PNG");
    CHECK_FALSE(b.session.image(99, 0).has_value());
    CHECK(b.session.verdict() == "null");
    b.wait_for_state("Operational");
    REQUIRE(b.command("start").status < 300);
    CHECK(b.verdict() == R"({"passed":true,"reasons":[]})");
    CHECK_FALSE(b.session.part(0, 0).empty());
    CHECK(fs::exists(b.session.files().journal));
    const fs::path scratch = b.session.files().journal.parent_path();
    REQUIRE(b.session.give_back().has_value());
    CHECK(b.session.describe() == R"({"machine":null})");
    CHECK(b.events.count("machine") == 2);  // taken, given back
    CHECK(b.command("start").status == 404);
}

TEST_CASE("a machine cannot be released or replaced during a print") {
    PrintBench b;
    REQUIRE(b.session.take_twin(b.order, 1).has_value());
    b.wait_for_state("Operational");
    REQUIRE(b.command("start").status < 300);
    b.wait_for_state("Printing");
    CHECK(holds(b.session.give_back().error().message, "a print is under way"));
    CHECK(holds(b.session.take_twin(b.order, 1).error().message, "a print is under way"));
    CHECK(b.about()["taken"] == 1);
    REQUIRE(b.session.set_speed(10000).has_value());
    CHECK(b.verdict() == R"({"passed":true,"reasons":[]})");
    CHECK(b.session.take_twin(b.order, 1).has_value());
    CHECK(b.about()["taken"] == 2);
}

TEST_CASE("an interrupted virtual print with a journal is resumed by the next studio, or discarded") {
    PrintBench b;
    b.order.journal = b.folder / "bar.zip.virtual.journal";
    const auto layer_of = [](const Json& about) { return about["now"]["progress"]["layer"]; };
    {
        PrintSession first([](const std::string&) {});
        REQUIRE(first.take_twin(b.order, 200).has_value());
        wait_until_ready(first);
        REQUIRE(first.ask("POST", "/api/job", R"({"command":"start"})").status == 204);
        for (int i = 0; i < 6000; ++i) {
            const Json about = Json::parse(first.describe());
            if (layer_of(about).is_number() && layer_of(about) >= 3) break;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
    }  // ends during the print
    REQUIRE(fs::exists(b.order.journal));
    const std::string broken_off = read_file(b.order.journal).value();
    REQUIRE(b.session.take_twin(b.order, 10000).has_value());
    CHECK(b.about()["now"]["job"]["canResume"] == true);
    // The printed part is available again, as soon as the session has looked at the machine.
    for (int i = 0; i < 1000 && b.session.part(0, 0).size() <= 200; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    CHECK(b.session.part(0, 0).size() > 200);
    REQUIRE(b.session.ask("POST", "/api/job", R"({"command":"start","resume":true})").status == 204);
    CHECK(Json::parse(b.verdict())["passed"] == true);
    CHECK(b.session.discard().error().message == "there is no interrupted print");
    REQUIRE(b.session.give_back().has_value());

    REQUIRE(write_file(b.order.journal, broken_off).has_value());
    REQUIRE(b.session.take_twin(b.order, 10000).has_value());
    CHECK(b.about()["now"]["job"]["canResume"] == true);
    REQUIRE(b.session.discard().has_value());
    CHECK(b.about()["now"]["job"]["canResume"] == false);
    CHECK(b.about()["speed"] == 10000);
    CHECK_FALSE(fs::exists(b.order.journal));
    // Wherever the vats were then, the next print begins on a machine that is ready.
    wait_until_ready(b.session);
    REQUIRE(b.session.ask("POST", "/api/job", R"({"command":"start"})").status == 204);
    CHECK(Json::parse(b.verdict())["passed"] == true);
}
