#include <doctest/doctest.h>

#include <functional>

#include "base/core/near.hpp"
#include "printing/prepare/settings.hpp"
#include "printing/prepare/test_order.hpp"

using namespace pliant;
using namespace pliant::prepare;
using namespace pliant::prepare::test;

namespace {

struct Arranged {
    Drawing drawing;
    job::JobSettings settings;
    std::vector<std::string> notes;
    Status status;

    [[nodiscard]] Box3 box() const {
        Box3 all;
        for (const slice::Body& body : drawing.bodies) {
            if (body.filler) continue;
            for (const Vec3& p : body.surface_um.points) all.add(p);
        }
        return all;
    }
};

Arranged arranged(const std::function<void(Order&)>& change) {
    Order order;
    change(order);
    Arranged a{two_blocks(), {}, {}, {}};
    auto settings = job_settings(order, printer(), {}, a.drawing);
    REQUIRE_MESSAGE(settings.has_value(), (settings ? "" : settings.error().message));
    a.settings = std::move(*settings);
    Progress silent;
    a.status = arrange(order, a.settings, a.drawing, a.notes, silent);
    return a;
}

Arranged done(const std::function<void(Order&)>& change) {
    Arranged a = arranged(change);
    REQUIRE_MESSAGE(a.status.has_value(), (a.status ? "" : a.status.error().message));
    return a;
}

std::string refused(const std::function<void(Order&)>& change) {
    const Arranged a = arranged(change);
    REQUIRE(!a.status.has_value());
    CHECK(a.status.error().cause == Cause::input);
    return a.status.error().message;
}

}  // namespace

TEST_CASE("a part stands on the platform in its middle") {
    const Box3 box = done([](Order&) {}).box();
    CHECK(box.low == Vec3{-4000, -2000, 0});
    CHECK(box.high == Vec3{4000, 2000, 3000});
}

TEST_CASE("--turn, --copies and --spacing") {
    CHECK(done([](Order& o) { o.turn = {0, 90, 0}; }).box().high.z == near(8000, {.relative = 1e-12}));
    const Arranged two = done([](Order& o) {
        o.copies = 2;
        o.spacing = "1 mm";
    });
    CHECK(two.drawing.bodies.size() == 4);
    CHECK(two.box().size().x == near(17000, {.relative = 1e-12}));
    CHECK(done([](Order& o) {
              o.copies = 2;
              o.spacing = "0 mm";
          })
              .box()
              .size()
              .x == near(16000, {.relative = 1e-12}));
    CHECK(refused([](Order& o) { o.copies = 0; }).find("0 copies") == 0);
    CHECK(!refused([](Order& o) { o.copies = 1000; }).empty());  // no room
    CHECK(!refused([](Order& o) { o.spacing = "-1 mm"; }).empty());
    CHECK(refused([](Order& o) { o.spacing = "2"; }).find("--spacing: ") == 0);
    CHECK(!refused([](Order& o) { o.turn = {0, HUGE_VAL, 0}; }).empty());
}

TEST_CASE("--support, --lift and --raft") {
    const Arranged a = done([](Order& o) {
        o.support = "firm";
        o.lift = "2 mm";
    });
    CHECK(a.box().low.z == near(2000, {.relative = 1e-12}));
    CHECK(a.drawing.bodies.front().filler);
    REQUIRE(a.notes.size() == 1);
    CHECK(a.notes[0].find("supports: ") == 0);
    CHECK(done([](Order& o) {
              o.support = "firm";
              o.raft = "1 mm";
          })
              .box()
              .low.z == near(6000, {.relative = 1e-12}));  // 5 mm above the raft
    const auto supported = [](const char* lift, const char* raft) {
        return [=](Order& o) {
            o.support = "firm";
            o.lift = lift;
            o.raft = raft;
        };
    };
    CHECK(done(supported("1.5 mm", "1 mm")).box().low.z == near(1500, {.relative = 1e-12}));
    CHECK(refused(supported("1.49 mm", "1 mm")).find("--lift 1.49 mm: must be at least half a millimetre more") == 0);
    CHECK(refused(supported("101 mm", "")).find("must be 0 to 100 mm") != std::string::npos);
    CHECK(refused(supported("-1 mm", "")).find("must be 0 to 100 mm") != std::string::npos);
    CHECK(refused(supported("", "21 mm")).find("raft of") != std::string::npos);
    CHECK(refused([](Order& o) { o.lift = "2 mm"; }) == "--lift: needs --support MATERIAL");
    CHECK(refused([](Order& o) { o.raft = "2 mm"; }) == "--raft: needs --support MATERIAL");
}

TEST_CASE("--support-angle, -spacing, -tip and -pillar") {
    const auto with = [](std::string Order::*option, const char* text) {
        return [=](Order& o) {
            o.support = "firm";
            o.lift = "2 mm";
            o.*option = text;
        };
    };
    const auto tips = [&](const char* spacing) { return done(with(&Order::support_spacing, spacing)).notes.at(0); };
    CHECK(tips("1.5 mm") != tips("5 mm"));
    CHECK(!done(with(&Order::support_angle, "0")).notes.empty());
    CHECK(!done(with(&Order::support_angle, "89")).notes.empty());
    CHECK(refused(with(&Order::support_angle, "90")).find("must be 0 to 89") != std::string::npos);
    CHECK(refused(with(&Order::support_angle, "-1")).find("must be 0 to 89") != std::string::npos);
    CHECK(refused(with(&Order::support_angle, "nan")).find("a number of degrees is needed") != std::string::npos);
    CHECK(refused(with(&Order::support_angle, "45 deg")).find("--support-angle 45 deg") == 0);
    CHECK(refused(with(&Order::support_spacing, "0 mm")).find("must be above 0") != std::string::npos);
    CHECK(refused(with(&Order::support_tip, "51 mm")).find("at most 50 mm") != std::string::npos);
    CHECK(refused(with(&Order::support_tip, "1.1 mm")).find("wider than its pillar") != std::string::npos);
    CHECK(refused(with(&Order::support_pillar, "3")).find("--support-pillar: ") == 0);
}

TEST_CASE("--least-layer makes layers of many heights, --hollow cavities") {
    const Arranged a = done([](Order& o) { o.least_layer = "10 um"; });
    REQUIRE(!a.settings.slicing.tops_um.empty());
    CHECK(a.settings.slicing.tops_um.back() >= 3000);
    CHECK(refused([](Order& o) { o.least_layer = "10.5 um"; }).find("--least-layer 10.5 um: a whole number") == 0);
    CHECK(refused([](Order& o) { o.least_layer = "60 um"; }).find("--least-layer: layers of 60 to 50 um") == 0);
    const Arranged hollow = done([](Order& o) {
        o.hollow = "0.5 mm";
        o.drain = "0.6 mm";
    });
    CHECK(hollow.settings.slicing.removed != nullptr);
    REQUIRE(hollow.notes.size() == 1);
    CHECK(hollow.notes[0].find("hollow: 1 cavities of ") == 0);
    CHECK(refused([](Order& o) { o.drain = "1 mm"; }) == "--drain: needs --hollow");
    CHECK(refused([](Order& o) { o.hollow = "0 mm"; }).find("must be above 0") != std::string::npos);
    CHECK(refused([](Order& o) { o.hollow = "2 mm"; }).find("nothing of the part lies") != std::string::npos);
    CHECK(refused([](Order& o) { o.hollow = "101 mm"; }).find("at most 100 mm") != std::string::npos);
}
