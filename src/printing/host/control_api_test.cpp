#include "printing/host/control_api.hpp"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "printing/host/test_devices.hpp"

using namespace pliant;
using namespace pliant::host;
using namespace pliant::host::test;
using nlohmann::json;

namespace {

/// A control of a printer that behaves like a faultless Marlin, running in the calling thread.
struct ApiBench {
    CountingClock clock;
    RememberingProjector projector;
    ScriptedWire* wire = nullptr;
    Control control{setup()};

    ControlSetup setup() {
        Programs programs;
        programs.cancel = [](const machine::Interlock&) -> Result<std::string> { return "M107 P1\n"; };
        ControlSetup s{machine::load_printer("examples/printers/tower.toml").value(),
                       [this]() -> Result<std::unique_ptr<Wire>> {
                           auto made = std::make_unique<ScriptedWire>(clock, [](const std::string& line) {
                               if (line.find("M119") != std::string::npos)
                                   return std::string("x_min: open\nz_max: open\ny_min: open\nok\n");
                               return good_answer(line);
                           });
                           wire = made.get();
                           return made;
                       },
                       projector,
                       clock,
                       programs,
                       {},
                       {},
                       {},
                       nullptr};
        return s;
    }
    ApiAnswer post(const std::string& path, const json& body) { return handle_api(control, "POST", path, body.dump()); }
    json get(const std::string& path) {
        const ApiAnswer answer = handle_api(control, "GET", path, "");
        CHECK(answer.status == 200);
        return json::parse(answer.json);
    }
    void load() {
        PrintJob job;
        job.name = "a \"job\" \xff";
        job.gcode = "G28 Z\nG1 Z300 F600\n";
        job.images = [](int, int) -> Result<job::Image> { return input_error("none"); };
        job.materials = {"soft"};
        job.layers = 7;
        REQUIRE(control.load(std::move(job)));
        control.serve_until_idle();
    }
};

}  // namespace

TEST_CASE("wrong paths, methods and bodies have different statuses") {
    ApiBench b;
    CHECK(handle_api(b.control, "GET", "/api/none", "").status == 404);
    CHECK(handle_api(b.control, "DELETE", "/api/job", "").status == 405);
    CHECK(handle_api(b.control, "POST", "/api/job", "{").status == 400);
    CHECK(handle_api(b.control, "POST", "/api/job", "[1]").status == 400);
    CHECK(b.post("/api/job", {{"command", "fly"}}).status == 400);
    CHECK(b.post("/api/printer/vat", {{"slot", "two"}}).status == 400);
    CHECK(b.post("/api/printer/axes", {{"command", "home"}, {"axes", {"nose"}}}).status == 400);
    CHECK(b.post("/api/job/exposure", {{"material", 1e300}, {"seconds", 1}}).status == 400);
    CHECK(b.post("/api/job/exposure", {{"material", 0.5}, {"seconds", 1}}).status == 400);
    CHECK(b.post("/api/printer/vat", {{"slot", 2.5}}).status == 400);
    CHECK(b.post("/api/job/skip", {{"layer", 2.5}}).status == 400);
}

TEST_CASE("a value of the wrong type, an unknown key and a second axis are bad requests, not ignored") {
    ApiBench b;
    b.load();
    const auto refused = [&](const char* path, const json& body) {
        const ApiAnswer answer = b.post(path, body);
        CAPTURE(body.dump());
        CHECK(answer.status == 400);
        return json::parse(answer.json)["error"].get<std::string>();
    };
    CHECK(refused("/api/job", {{"command", "start"}, {"resume", "true"}}) == "\"resume\" must be true or false");
    CHECK(refused("/api/job", {{"command", "start"}, {"assumeLit", "2"}}) == "\"assumeLit\" must be a number");
    CHECK(refused("/api/job", {{"command", "start"}, {"assumeLit", nullptr}}) == "\"assumeLit\" must be a number");
    CHECK(refused("/api/job", {{"command", "start"}, {"assumeLit", 1e300}}) == "\"assumeLit\" is out of range");
    CHECK(refused("/api/job", {{"command", "start"}, {"assume_lit", 2}}) == "\"assume_lit\" has no meaning here");
    CHECK(refused("/api/job", {{"command", "pause"}, {"now", 1}}) == "\"now\" must be true or false");
    CHECK(refused("/api/job", {{"command", 7}}) == "\"command\" must be a text");
    CHECK(refused("/api/job/exposure", {{"material", 0}, {"seconds", 2}, {"layer", 3}}) ==
          "\"layer\" has no meaning here");
    CHECK(refused("/api/printer/axes", {{"command", "home"}, {"axes", "platform"}}) == "\"axes\" must be a list");
    CHECK(refused("/api/printer/axes", {{"command", "home"}, {"platform", 1}}) == "\"platform\" has no meaning here");
    for (const json& body : {json{{"command", "jog"}, {"platform", 1}, {"carriage", 1}}, json{{"command", "jog"}}})
        CHECK(refused("/api/printer/axes", body).find("one of \"platform\"") != std::string::npos);
    CHECK(refused("/api/printer/axes", {{"command", "jog"}, {"platform", 1}, {"speed", "fast"}}) ==
          "\"speed\" must be a number");
    CHECK(refused("/api/printer/axes", {{"command", "jog"}, {"platform", 1}, {"absolute", "yes"}}) ==
          "\"absolute\" must be true or false");
    CHECK(b.control.snapshot().state == State::offline);
}

TEST_CASE("a jog distance beyond the range of int micrometres is refused, not wrapped") {
    ApiBench b;
    REQUIRE(b.post("/api/connection", {{"command", "connect"}}).status == 204);
    b.control.serve_until_idle();
    for (const double mm : {4294967.396, -4294967.296, 1.1e5}) {
        const ApiAnswer answer = b.post("/api/printer/axes", {{"command", "jog"}, {"platform", mm}});
        CHECK(answer.status == 400);
        CHECK(answer.json.find("no machine is so large") != std::string::npos);
    }
}

TEST_CASE("a command that the state does not allow is a conflict (409), with the reason") {
    ApiBench b;
    for (const char* command : {"start", "pause", "cancel", "resume", "suspend"}) {
        const ApiAnswer answer = b.post("/api/job", {{"command", command}});
        CHECK(answer.status == 409);
        CHECK_FALSE(json::parse(answer.json)["error"].get<std::string>().empty());
    }
    CHECK(b.post("/api/printer/axes", {{"command", "home"}}).status == 409);
    b.load();
    const ApiAnswer resumed = b.post("/api/job", {{"command", "start"}, {"resume", true}});
    CHECK(resumed.status == 409);
    CHECK(resumed.json.find("there is no interrupted print of this job that can be resumed") != std::string::npos);
}

TEST_CASE("connect, look, start: the answers follow OctoPrint's API") {
    ApiBench b;
    CHECK(b.get("/api/connection")["current"]["state"] == "Offline");
    CHECK(b.post("/api/connection", {{"command", "connect"}}).status == 204);
    CHECK(b.get("/api/connection")["current"]["state"] == "Connecting");
    b.control.serve_until_idle();
    CHECK(b.get("/api/connection")["current"]["state"] == "Operational");
    CHECK(b.get("/api/printer")["state"]["flags"]["ready"] == true);
    CHECK(b.get("/api/job")["job"]["file"]["name"].is_null());
    b.load();
    json job = b.get("/api/job");
    CHECK(job["progress"]["completion"] == 0);
    CHECK(job["job"]["layers"] == 7);
    CHECK(job["progress"]["printTimeLeft"].get<double>() > 10);
    const double planned_s = job["job"]["estimatedPrintTime"];
    CHECK(planned_s == job["progress"]["printTimeLeft"]);
    CHECK(b.post("/api/job", {{"command", "start"}}).status == 204);
    CHECK(b.get("/api/job")["state"] == "Connecting");
    CHECK(b.get("/api/printer")["state"]["flags"]["printing"] == true);
    CHECK(b.post("/api/job", {{"command", "start"}}).status == 409);
    b.control.serve_until_idle();
    job = b.get("/api/job");
    CHECK(job["state"] == "Operational");
    CHECK(job["progress"]["finished"] == true);
    CHECK(job["progress"]["completion"] == 100);
    CHECK(job["job"]["estimatedPrintTime"] == planned_s);  // whatever time it took
    CHECK(b.get("/api/printer")["machine"]["axes"]["platform"]["position"] == 300);
    CHECK(b.get("/api/printer")["machine"]["axes"].size() == 3);  // a tower has no table
}

TEST_CASE("the feed gives the history, then what is new, each event once") {
    ApiBench b;
    long seen = 0;
    json message = json::parse(history_message(b.control, seen));
    CHECK(message["history"]["state"]["text"] == "Offline");
    CHECK(message["history"]["events"].empty());
    b.load();
    REQUIRE(b.control.connect());
    b.control.serve_until_idle();
    message = json::parse(current_message(b.control, seen));
    const std::size_t events = message["current"]["events"].size();
    CHECK(events >= 3);
    CHECK(seen == b.control.snapshot().last_event);
    CHECK(message["current"]["events"].back()["number"] == seen);
    CHECK(json::parse(current_message(b.control, seen))["current"]["events"].empty());
    long other = 0;
    CHECK(json::parse(history_message(b.control, other))["history"]["events"].size() == events);
    CHECK(other == seen);
}

TEST_CASE("loading a job does not change the state") {
    ApiBench b;
    b.load();
    for (const Event& event : b.control.events_since(0)) CHECK(event.kind != "state");
    CHECK(b.control.snapshot().state == State::offline);
    REQUIRE(b.control.connect());
    b.control.serve_until_idle();
    const long before = b.control.snapshot().last_event;
    b.load();
    for (const Event& event : b.control.events_since(before)) CHECK(event.kind != "state");
    CHECK(b.control.snapshot().state == State::idle);
}

TEST_CASE("the emergency stop is one request, and writes M112 at once") {
    ApiBench b;
    REQUIRE(b.control.connect());
    b.control.serve_until_idle();
    CHECK(b.post("/api/printer/stop", json::object()).status == 204);
    CHECK(b.wire->written.back() == "M112");
}
