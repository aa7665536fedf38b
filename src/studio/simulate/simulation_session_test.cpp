#include "studio/simulate/simulation_session.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <cstring>
#include <future>

#include "base/core/near.hpp"
#include "base/core/test_text.hpp"
#include "studio/base/test_events.hpp"

using namespace pliant;
using namespace pliant::studio;
using pliant::test::holds;
using studio::test::bar;
using studio::test::Events;
using studio::test::Json;

namespace {

struct Bench {
    Events events, frames;
    SimulationSession session{
        {[this](const std::string& json) { events.add(json); },
         [this](const std::shared_ptr<const std::string>& packet) { frames.add(head_of(*packet).dump()); },
         [] { return std::set<std::string>{}; }}};

    static Json head_of(const std::string& packet) {
        std::uint32_t length = 0;
        std::memcpy(&length, packet.data() + 4, 4);
        return Json::parse(packet.substr(8, length))["head"];
    }
    void open(const std::string& text, Accuracy accuracy = Accuracy::preview) {
        session.open({"bar.toml", text, accuracy});
    }
    void drive(double tag, const std::string& name, const std::string& kind, double value) {
        session.drive({tag, std::nullopt, {{name, kind, value}}});
    }
    /// The frame that shows input `tag` at equilibrium.
    Json arrived(double tag) {
        return frames.wait_for([&](const Json& f) { return f["tag"] == tag && f["arrived"] == true; });
    }
    /// Of the last event about problems.
    [[nodiscard]] Json problem() const {
        for (const std::string& news : session.news()) {
            const Json event = Json::parse(news);
            if (event["type"] == "problem") return event["lines"];
        }
        return nullptr;
    }
};

const char* const wall = R"(
[[obstacle]]
name = "wall"
geometry = { box = [[50, 0, 0], [51, 3, 2]] }
)";

std::string renamed(const std::string& name) {
    std::string text = bar;
    return text.replace(text.find("\"bar\""), 5, "\"" + name + "\"");
}

}  // namespace

TEST_CASE("before a robot is opened there is no state, and input does no harm") {
    Bench b;
    CHECK(b.session.built() == nullptr);
    CHECK(b.session.scene() == nullptr);
    CHECK(b.session.last_frame() == nullptr);
    CHECK(b.session.history().steps.empty());
    CHECK(b.session.news().empty());
    b.drive(1, "flexor", "shortening_mm", 0.1);
    b.session.pull({2, 0, {1, 2, 3}});
    b.session.lead({3, "tip", {1, 2, 3}});
    b.session.play(true);
    b.session.rest();
    b.session.release();
    b.session.show_again();
}

TEST_CASE("a robot is bent and its states are kept; returning to rest clears them") {
    Bench b;
    b.open(bar);
    REQUIRE(b.session.wait_until_built());
    CHECK(b.session.built()->robot.name == "bar");
    CHECK(b.session.built()->model.mesh().order == 1);  // a preview
    b.drive(1, "flexor", "shortening_mm", 0.2);
    CHECK(b.arrived(1)["cables"][0]["length_mm"].get<double>() == near(3.8, {.relative = 1e-6}));
    const sim::Trajectory bent = b.session.history();
    REQUIRE(bent.steps.size() >= 2);
    CHECK(bent.steps.front().cables[0].length_ratio == near(1, {.relative = 1e-9}));
    CHECK(bent.steps.back().cables[0].length_ratio == near(0.95, {.relative = 1e-6}));
    b.frames.clear();
    b.session.rest();
    (void)b.frames.wait_for([](const Json& f) { return f["cables"][0]["length_mm"].get<double>() > 3.9999; });
    CHECK(b.session.history().steps.size() <= 1);
}

TEST_CASE("a dragged marker moves the cable, and stays where it is released") {
    Bench b;
    b.open(bar);
    REQUIRE(b.session.wait_until_built());
    b.drive(1, "flexor", "shortening_mm", 0.3);
    const Json wanted = b.arrived(1)["markers"][0];
    b.frames.clear();
    b.session.rest();
    (void)b.frames.wait_for([](const Json& f) { return f["cables"][0]["length_mm"].get<double>() > 3.9999; });
    const auto at = [](const Json& p) {
        return std::array{p[0].get<double>(), p[1].get<double>(), p[2].get<double>()};
    };
    b.session.lead({2, "tip", at(wanted)});
    const Json there = b.arrived(2);
    CHECK(there["lead"]["reached"] == true);
    CHECK(there["lead"]["error_mm"].get<double>() <= 0.1);
    CHECK(there["wanted"]["actuators"][0]["name"] == "flexor");
    const double pulled = there["wanted"]["actuators"][0]["value"].get<double>();
    CHECK(there["cables"][0]["ratio"].get<double>() < 0.99);

    b.frames.clear();
    b.session.release();
    const Json free = b.frames.wait_for([](const Json& f) { return !f.contains("lead"); });
    CHECK(free["markers"] == there["markers"]);
    CHECK(free["wanted"]["actuators"][0]["value"].get<double>() == near(pulled, {.relative = 1e-12}));

    b.session.lead({3, "tip", {0, 0, 100}});
    const Json far = b.arrived(3);
    CHECK(far["lead"]["reached"] == false);
    REQUIRE(far["lead"]["limits"].size() == 1);
    CHECK(holds(far["lead"]["limits"][0].get<std::string>(), "flexor is at the"));
    b.drive(4, "flexor", "shortening_mm", 0.1);  // a slider takes over
    const Json driven = b.arrived(4);
    CHECK_FALSE(driven.contains("lead"));
    CHECK(driven["cables"][0]["length_mm"].get<double>() == near(3.9, {.relative = 1e-6}));
    b.session.lead({5, "nose", {0, 0, 0}});
    CHECK_FALSE(b.arrived(5).contains("lead"));
}

TEST_CASE("by default answers come from quadratic tets, and answers from linear tets say so") {
    // Coarse and nearly incompressible: linear tets lock, and their tension is three times as large. What the robot
    // could touch, far away, keeps it from being reduced.
    const std::string with_wall = std::string(bar) + wall;
    const auto tension = [](const Json& f) { return f["cables"][0]["tension_N"].get<double>(); };
    Bench fine, linear, automatic;
    fine.open(with_wall, Accuracy::fine);
    linear.open(with_wall, Accuracy::preview);
    automatic.open(with_wall, Accuracy::automatic);
    for (Bench* b : {&fine, &linear, &automatic}) {
        REQUIRE(b->session.wait_until_built());
        b->drive(1, "flexor", "shortening_mm", 0.3);
    }
    const Json right = fine.arrived(1), rough = linear.arrived(1), answer = automatic.arrived(1);
    REQUIRE(tension(rough) > 1.1 * tension(right));
    CHECK(answer["order"] == 2);
    CHECK(answer["refining"] == false);
    CHECK(tension(answer) == near(tension(right), {.relative = 1e-3}));
    const Json before = automatic.frames.wait_for([](const Json& f) { return f["tag"] == 1 && f["refining"] == true; });
    CHECK(before["order"] == 1);
    CHECK(before["arrived"] == false);
    CHECK(tension(before) == near(tension(rough), {.relative = 1e-3}));
    CHECK(before["sequence"] < answer["sequence"]);
    // Exported states never come from the preview.
    for (const sim::Step& step : automatic.session.history().steps)
        CHECK(step.positions.size() == automatic.session.built()->model.mesh().points.size());
    CHECK(automatic.session.history().steps.back().cables[0].tension_N == near(tension(right), {.relative = 1e-3}));
}

TEST_CASE(
    "once the reduced model is ready, it moves the sliders, nearly as the quadratic tets and never as their answer") {
    Bench b;
    b.open(bar, Accuracy::automatic);
    REQUIRE(b.session.wait_until_built());
    REQUIRE(b.session.built()->preview != nullptr);
    Json near_frame;
    const auto until = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    for (int tag = 1; near_frame.is_null() && std::chrono::steady_clock::now() < until; ++tag) {
        b.frames.clear();
        b.drive(tag, "flexor", "shortening_mm", 0.2 + 0.001 * (tag % 50));
        const Json frame = b.frames.wait_for([&](const Json& f) { return f["tag"] == tag; });
        if (frame.contains("reduced_error_mm")) near_frame = frame;
    }
    REQUIRE(!near_frame.is_null());
    CHECK(near_frame["order"] == 2);
    CHECK(near_frame["arrived"] == false);
    CHECK(near_frame["reduced_error_mm"].get<double>() < 0.05);
    const Json exact = b.arrived(near_frame["tag"]);
    CHECK(!exact.contains("reduced_error_mm"));
    CHECK(near_frame["cables"][0]["tension_N"].get<double>() ==
          near(exact["cables"][0]["tension_N"].get<double>(), {.relative = 0.01}));
    CHECK(near_frame["markers"][0][2].get<double>() == near(exact["markers"][0][2].get<double>(), {.absolute = 0.01}));
    // A point that is pulled is not among its modes.
    b.session.pull({1000, 0, {0, 0, 1}});
    const Json pulled = b.frames.wait_for([](const Json& f) { return f["tag"] == 1000; });
    CHECK(!pulled.contains("reduced_error_mm"));
}

TEST_CASE("after dragging on, the final answer agrees with quadratic tets, also with program and pull") {
    Bench fine, automatic;
    fine.open(bar, Accuracy::fine);
    automatic.open(bar, Accuracy::automatic);
    const auto both = [&](const auto& act) {
        for (Bench* b : {&fine, &automatic}) act(b->session);
    };
    const auto same = [&](double tag, double within_mm = 2e-3) {
        const Json a = fine.arrived(tag), b = automatic.arrived(tag);
        CHECK(b["order"] == 2);
        for (std::size_t k = 0; k < 3; ++k)
            CHECK(b["markers"][0][k].get<double>() == near(a["markers"][0][k].get<double>(), {.absolute = within_mm}));
    };
    both([](SimulationSession& s) { REQUIRE(s.wait_until_built()); });
    for (int i = 1; i <= 30; ++i)
        both([&](SimulationSession& s) { s.drive({1.0 * i, std::nullopt, {{"flexor", "shortening_mm", 0.01 * i}}}); });
    same(30);
    both([](SimulationSession& s) { s.pull({31, 3, {4.5, 2, 2.5}}); });
    same(31, 0.02);  // a spring settles to within a share of its force
    both([](SimulationSession& s) { s.release(); });
    both([](SimulationSession& s) { s.follow({32, 0.5}); });
    same(32);
    both([](SimulationSession& s) { s.drive({33, 0.5, {{"flexor", "tension_N", 0.02}}}); });
    same(33);
}

TEST_CASE("input with unknown actuators, kinds or impossible values is ignored") {
    Bench b;
    b.open(bar);
    REQUIRE(b.session.wait_until_built());
    double tag = 1;
    for (const auto& [name, kind, value] : {std::tuple("nobody", "length_ratio", 0.9),
                                            {"flexor", "volume_ratio", 0.9},
                                            {"flexor", "no_such_kind", 0.9},
                                            {"flexor", "length_ratio", 0.0},
                                            {"flexor", "length_ratio", -2.0},
                                            {"flexor", "shortening_mm", 5.0}}) {
        INFO(name << " " << kind << " " << value);
        b.drive(tag, name, kind, value);
        const Json frame = b.arrived(tag++);
        CHECK(frame["wanted"]["actuators"].empty());
        CHECK(frame["cables"][0]["length_mm"].get<double>() == near(4, {.relative = 1e-9}));
    }
}

TEST_CASE("only the last input counts") {
    Bench b;
    b.open(bar);
    REQUIRE(b.session.wait_until_built());
    for (int i = 1; i <= 50; ++i) b.drive(i, "flexor", "shortening_mm", 0.004 * i);
    CHECK(b.arrived(50)["cables"][0]["length_mm"].get<double>() == near(3.8, {.relative = 1e-6}));
    CHECK(b.frames.count("frame") < 50);
}

TEST_CASE("an error is reported with its line and the previous robot stays; a correct text clears the error") {
    Bench b;
    b.open(renamed("first"));
    REQUIRE(b.session.wait_until_built());
    std::string wrong = bar;
    b.open(wrong.replace(wrong.find("shortening"), 10, "shortenin_"));
    CHECK(b.session.wait_until_built());
    const Json problem = b.problem();
    REQUIRE(problem.is_array());
    CHECK(problem[0]["line"] == 11);
    CHECK(problem[0]["text"] == "cable[0].target: takes one of length_ratio, shortening and tension");
    CHECK(b.session.built()->robot.name == "first");
    b.open(renamed("third"));
    CHECK(b.session.wait_until_built());
    CHECK(b.problem() == nullptr);
    CHECK(b.session.built()->robot.name == "third");
    CHECK(b.session.built()->revision == 2);  // the invalid one has none
}

TEST_CASE("a first robot with an error leaves no robot") {
    Bench b;
    b.open("name = 1");
    CHECK_FALSE(b.session.wait_until_built());
    CHECK(b.session.built() == nullptr);
    CHECK(b.problem().is_array());
}

TEST_CASE("a robot replaced during its build is dropped, and a waiting caller gets the last one") {
    std::promise<void> go;
    std::shared_future<void> may_go(go.get_future());
    bool first = true;
    SimulationSession session({[&](const std::string& json) {
                                   if (!holds(json, "\"read\"") || !first) return;
                                   first = false;
                                   may_go.wait();  // the first build lasts until the second request has arrived
                               },
                               [](const std::shared_ptr<const std::string>&) {},
                               [] { return std::set<std::string>{}; }});
    session.open({"bar.toml", renamed("first"), Accuracy::preview});
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    session.open({"bar.toml", renamed("second"), Accuracy::fine});
    go.set_value();
    REQUIRE(session.wait_until_built());
    CHECK(session.built()->robot.name == "second");
    CHECK(session.built()->model.mesh().order == 2);
}
