#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
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

Arranged arranged(const std::function<void(Order&)>& change, Drawing drawing = two_blocks(),
                  const machine::Printer& machine = printer()) {
    Order order;
    change(order);
    Arranged a{std::move(drawing), {}, {}, {}};
    auto settings = job_settings(order, machine, {}, a.drawing);
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

TEST_CASE("a part is centred on the platform") {
    const Box3 box = done([](Order&) {}).box();
    CHECK(box.low == Vec3{-4000, -2000, 0});
    CHECK(box.high == Vec3{4000, 2000, 3000});
}

TEST_CASE("--turn, --copies and --spacing arrange the part") {
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
    CHECK(refused([](Order& o) { o.spacing = "-1 mm"; }) == "--spacing -1 mm: must be 0 or more");
    CHECK(refused([](Order& o) { o.spacing = "2"; }).find("--spacing: ") == 0);
    CHECK(!refused([](Order& o) { o.turn = {0, HUGE_VAL, 0}; }).empty());
}

TEST_CASE("a part, its copies and its supports must stand on the platform, not only in the image") {
    machine::Printer narrow = printer();  // its image is 20 x 10 mm
    narrow.platform.width_um = 18000;
    narrow.platform.depth_um = 6000;
    const auto message = [&](const std::function<void(Order&)>& change) {
        const Arranged a = arranged(change, two_blocks(), narrow);
        return a.status ? std::string() : a.status.error().message;
    };
    CHECK(message([](Order&) {}).empty());
    CHECK(message([](Order& o) { o.at = {5, -1}; }).empty());
    CHECK(message([](Order& o) {
              o.at = {1e9, 10};
          }) == "--at 1e+09 10: must be -1000 to 1000 mm from the middle of the platform");
    CHECK(message([](Order& o) { o.at = {5}; }).find("two numbers in mm are needed") != std::string::npos);
    CHECK(message([](Order& o) {
              o.at = {0, -1.5};
          }) ==
          "body 'left' (soft): lies 0.500 mm beyond the platform at -y, which reaches from -3.000 to 3.000 mm there; "
          "move, turn or scale the part");
    CHECK(message([](Order& o) {
              o.at = {5.25, 0};
          }).find("body 'right' (firm): lies 0.250 mm beyond the platform at +x") == 0);
    CHECK(message([](Order& o) { o.scale = 2; }).find("lies 1.000 mm beyond the platform at -y") != std::string::npos);
    CHECK(message([](Order& o) { o.copies = 2; }).empty());
    CHECK(message([](Order& o) { o.copies = 3; }).find("do not fit the platform of 18.000 x 6.000 mm: 2 do") !=
          std::string::npos);
    const auto raft = [](Order& o) {
        o.support = "firm";
        o.raft = "1 mm";
        o.support_pillar = "2 mm";
        o.at = {3.9, 0};
    };
    narrow.projector.width_px = 400;
    narrow.projector.height_px = 200;
    narrow.platform.depth_um = 20000;
    CHECK(message(raft).find("body 'support' (firm): lies ") == 0);
    CHECK(message(raft).find(" beyond the platform at +x") != std::string::npos);
    // Without a size of the platform the image is the limit.
    CHECK(arranged([](Order& o) { o.at = {5.25, 0}; }).status.has_value());
}

TEST_CASE("a part too tall for the machine is refused before it is hollowed or supported") {
    machine::Printer low = printer();
    low.name = "low";
    const auto message = [&](int build_height_um, const std::function<void(Order&)>& change) {
        low.platform.build_height_um = build_height_um;
        const Arranged a = arranged(change, two_blocks(), low);
        return a.status ? std::string() : a.status.error().message;
    };
    CHECK(message(3000, [](Order&) {}).empty());
    CHECK(message(2960, [](Order&) {}) == "blocks is 3.00 mm tall, low builds 2.96 mm");
    CHECK(message(3000, [](Order& o) {
              o.support = "firm";
              o.lift = "1 mm";
          }) == "blocks is 4.00 mm tall, low builds 3.00 mm");
}

TEST_CASE("--support, --lift and --raft add supports") {
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
    CHECK(refused([](Order& o) { o.support_angle = "30"; }) == "--support-angle: needs --support MATERIAL");
}

TEST_CASE("--support-angle, -spacing, -tip and -pillar change the supports") {
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

TEST_CASE("--least-layer gives layers of different heights, and --hollow a cavity") {
    const Arranged a = done([](Order& o) { o.least_layer = "10 um"; });
    REQUIRE(!a.settings.slicing.tops_um.empty());
    CHECK(a.settings.slicing.tops_um.back() >= 3000);
    CHECK(refused([](Order& o) { o.least_layer = "10.5 um"; }).find("--least-layer 10.5 um: a whole number") == 0);
    CHECK(refused([](Order& o) {
              o.least_layer = "60 um";
          }).find("--least-layer 60 um: must be 1 um to the layer height, 50 um") == 0);
    const Arranged hollow = done([](Order& o) {
        o.hollow = "0.5 mm";
        o.drain = "0.6 mm";
    });
    CHECK(hollow.settings.slicing.removed != nullptr);
    REQUIRE(hollow.notes.size() == 1);
    CHECK(hollow.notes[0].find("hollow: 1 cavity of ") == 0);
    CHECK(refused([](Order& o) { o.drain = "1 mm"; }) == "--drain: needs --hollow");
    CHECK(refused([](Order& o) { o.hollow = "0 mm"; }) == "--hollow 0 mm: must be above 0 and at most 100 mm");
    CHECK(refused([](Order& o) {
              o.hollow = "1 mm";
              o.drain = "-1 mm";
          }) == "--drain -1 mm: must be 0 to 100 mm");
    CHECK(refused([](Order& o) { o.hollow = "2 mm"; }).find("nothing of the part lies") != std::string::npos);
    CHECK(refused([](Order& o) { o.hollow = "101 mm"; }).find("at most 100 mm") != std::string::npos);
}

TEST_CASE("what compensation moves over the edge of the platform is refused as if it were drawn there") {
    const auto moved = [](int um, std::optional<job::PlatformEdge> edge) {
        Drawing drawing = two_blocks();
        machine::Printer p = printer();
        for (machine::Resin& resin : p.resins) resin.xy_compensation_um = um;
        auto settings = job_settings({}, p, {}, drawing);
        REQUIRE(settings.has_value());
        settings->edge = std::move(edge);
        std::vector<std::string> notes;
        Progress silent;
        const Status status = arrange({}, *settings, drawing, notes, silent);
        return status ? std::string() : status.error().message;
    };
    // The blocks are 8 x 4 mm.
    const slice::Raster raster{200, 100, 100};
    CHECK(moved(50, job::PlatformEdge(raster, 8100, 4100)).empty());
    CHECK(moved(-500, job::PlatformEdge(raster, 8000, 4000)).empty());
    CHECK(moved(70, job::PlatformEdge(raster, 8100, 4200)) ==
          "body 'left' (soft), grown by its xy_compensation of 0.07 mm: lies 0.020 mm beyond the platform at -x, which "
          "reaches from -4.050 to 4.050 mm there; move, turn or scale the part");
}

TEST_CASE("--scale and --at scale and move the part") {
    const Box3 larger = done([](Order& o) { o.scale = 1.5; }).box();
    CHECK(larger.size().x == near(12000, {.relative = 1e-12}));
    CHECK(larger.size().z == near(4500, {.relative = 1e-12}));
    CHECK(larger.center().x == near(0, {.absolute = 1e-9}));
    const Box3 aside = done([](Order& o) { o.at = {3, -1.5}; }).box();
    CHECK(aside.low == Vec3{-1000, -3500, 0});
    CHECK(aside.high == Vec3{7000, 500, 3000});
    CHECK(refused([](Order& o) { o.scale = 0; }) == "--scale: a scale of 0: must be 0.001 to 1000");
    CHECK(refused([](Order& o) { o.at = {3}; }).find("--at: two numbers in mm") == 0);
    CHECK(refused([](Order& o) { o.at = {3, 1e300}; }).find("--at 3 1e+300: must be -1000 to 1000 mm") == 0);
}

namespace {

/// A table of 6 x 4 mm on a column of 2 mm, 3 mm high.
Arranged table_with(const std::function<void(Order&)>& change) {
    Drawing drawing = two_blocks();
    drawing.bodies = {{"soft", box_um({2000, 1000, 0}, {4000, 3000, 3000}), "column"},
                      {"soft", box_um({0, 0, 3000}, {6000, 4000, 4000}), "top"}};
    const auto on_supports = [&](Order& order) {
        order.support = "firm";
        change(order);
    };
    return arranged(on_supports, std::move(drawing));
}

/// Centres of all supports.
std::vector<Vec3> supports_of(const Arranged& a) {
    std::vector<Vec3> middles;
    for (const slice::Body& body : a.drawing.bodies) {
        if (body.filler) middles.push_back(mesh::bounds(body.surface_um).center());
    }
    return middles;
}

const std::string table_head = "wish,x (mm),y (mm),z (mm),nx,ny,nz,radius (mm)\n";

}  // namespace

TEST_CASE("--support-paint is turned, scaled and copied with the part") {
    // In drawn coordinates: blocked everywhere, enforced at the corner x = 5.5, y = 3.5 under the top.
    const std::string paint = table_head + "block,3,2,3,0,0,-1,9\nenforce,5.5,3.5,3,0,0,-1,0.4\n";
    const Arranged plain = table_with([&](Order& o) { o.support_paint = paint; });
    REQUIRE_MESSAGE(plain.status.has_value(), (plain.status ? "" : plain.status.error().message));
    const auto at = supports_of(plain);
    REQUIRE(at.size() == 1);
    CHECK(at[0].x == near(2500, {.absolute = 450}));
    CHECK(at[0].y == near(1500, {.absolute = 450}));
    CHECK(plain.notes.back() == "painted supports: 1 of the tips");
    // After half a turn about z it is at the opposite corner; at twice the scale, twice as far out.
    const Arranged turned = table_with([&](Order& o) {
        o.support_paint = paint;
        o.turn = {0, 0, 180};
        o.scale = 2;
    });
    const auto there = supports_of(turned);
    REQUIRE(!there.empty());
    for (const Vec3& p : there) {
        CHECK(p.x == near(-5000, {.absolute = 900}));
        CHECK(p.y == near(-3000, {.absolute = 900}));
    }
    const Arranged two = table_with([&](Order& o) {
        o.support_paint = paint;
        o.copies = 2;
        o.spacing = "1 mm";
    });
    CHECK(two.notes.back() == "painted supports: 2 of the tips");
    CHECK(supports_of(two).size() == 2);
    CHECK(two.drawing.bodies.size() == 6);
    // Upside down, no part of it faces down.
    const Arranged over = table_with([&](Order& o) {
        o.support_paint = table_head + "enforce,5.5,3.5,3,0,0,-1,0.4\n";
        o.turn = {180, 0, 0};
    });
    CHECK(supports_of(over).empty());
    REQUIRE(!over.drawing.warnings.empty());
    CHECK(over.drawing.warnings.back() ==
          "painted supports: no place to be supported lies on an underside of the part");
    for (const std::string& warning : plain.drawing.warnings) CHECK(warning.find("painted") == std::string::npos);
}

TEST_CASE("--support-paint without --support, or with an invalid table, is refused") {
    CHECK(refused([](Order& o) { o.support_paint = table_head + "block,3,2,3,0,0,-1,9\n"; }) ==
          "--support-paint: needs --support MATERIAL");
    const std::string text = refused([](Order& o) {
        o.support = "firm";
        o.support_paint = "wish\nblock\n";
        o.support_paint_file = "mine.csv";
    });
    CHECK(text == "mine.csv:1: there is no column \"x (mm)\"");
}

TEST_CASE("pillars of supports that touch each other are a warning") {
    const auto warned = [](const char* spacing) {
        const Arranged a = table_with([&](Order& o) { o.support_spacing = spacing; });
        return std::ranges::count(a.drawing.warnings,
                                  fmt::format("--support-spacing {}: pillars of 1 mm touch each other and may close "
                                              "cavities; wider spacing or thinner pillars stand apart",
                                              spacing));
    };
    CHECK(warned("1 mm") == 1);
    CHECK(warned("1.01 mm") == 0);
}

TEST_CASE("hollow walls of less than two pixels or layers are a warning") {
    const auto warned = [](const char* wall, const char* layer) {
        const Arranged a = done([&](Order& o) {
            o.hollow = wall;
            o.layer = layer;
        });
        const auto found =
            std::ranges::find_if(a.drawing.warnings, [](const std::string& w) { return w.find("--hollow") == 0; });
        return found == a.drawing.warnings.end() ? "" : *found;
    };
    CHECK(warned("0.2 mm", "100 um").empty());
    CHECK(warned("0.15 mm", "50 um") == "--hollow 0.15 mm: is less than two pixels of 100 um; walls become thicker");
    CHECK(warned("0.25 mm", "150 um") ==
          "--hollow 0.25 mm: is less than two layers of 150 um; floors and ceilings become thicker");
}

TEST_CASE("a raft that no layer would show is an error, tips below two pixels a warning") {
    const auto with = [](const char* raft, const char* tip) {
        return table_with([&](Order& o) {
            o.raft = raft;
            o.support_tip = tip;
        });
    };
    const Status thin = with("0.024 mm", "").status;  // layers of 50 um
    REQUIRE(!thin.has_value());
    CHECK(thin.error().message ==
          "--raft 0.024 mm: is less than half of the first layer and would not be printed: give at least 50 um");
    CHECK(with("0.025 mm", "").status.has_value());
    const auto warned = [](const Arranged& a) {
        return std::ranges::count_if(a.drawing.warnings,
                                     [](const std::string& w) { return w.find("--support-tip") == 0; });
    };
    CHECK(warned(with("", "0.2 mm")) == 0);
    const Arranged fine = with("", "0.15 mm");
    REQUIRE(warned(fine) == 1);
    CHECK(std::ranges::count(fine.drawing.warnings,
                             "--support-tip 0.15 mm: is less than two pixels; tips are 0.2 mm wide") == 1);
}
