#include "prepare/settings.hpp"

#include <doctest/doctest.h>

#include <functional>

#include "prepare/test_order.hpp"

using namespace pliant;
using namespace pliant::prepare;
using namespace pliant::prepare::test;

namespace {

using Change = std::function<void(Order&)>;

job::JobSettings settings_of(const Change& change, Drawing drawing = two_blocks()) {
    Order order;
    change(order);
    const auto settings = job_settings(order, printer(), {}, drawing);
    REQUIRE_MESSAGE(settings.has_value(), (settings ? "" : settings.error().message));
    return *settings;
}

std::string refused(const Change& change) {
    Order order;
    change(order);
    Drawing drawing = two_blocks();
    const auto settings = job_settings(order, printer(), {}, drawing);
    REQUIRE(!settings.has_value());
    CHECK(settings.error().cause == Cause::input);
    return settings.error().message;
}

}  // namespace

TEST_CASE("what is not asked for is the printer's") {
    const job::JobSettings s = settings_of([](Order&) {});
    CHECK(s.name == "blocks");
    CHECK(s.slicing.layer_um == 50);
    CHECK(s.slicing.raster.width_px == 200);
    CHECK(s.slicing.raster.pixel_um == 100);
    CHECK(s.slicing.rules.anti_alias);
    CHECK(s.bottom_layers == 3);
    CHECK(s.least_feature_um == 0);
    CHECK(s.copies == 1);
    REQUIRE(s.materials.size() == 2);
    CHECK(s.materials[0].exposure_s == 2);
    CHECK(s.materials[0].bottom_exposure_s == 9);
    CHECK(s.materials[1].exposure_s == 4);
    CHECK(s.slicing.teeth.empty());
    CHECK(s.slicing.bonds.empty());
    CHECK(s.exposures.empty());
}

TEST_CASE("--layer and --least-feature") {
    CHECK(settings_of([](Order& o) { o.layer = "25 um"; }).slicing.layer_um == 25);
    CHECK(settings_of([](Order& o) { o.least_feature = "0.3 mm"; }).least_feature_um == doctest::Approx(300));
    CHECK(settings_of([](Order& o) { o.least_feature = "10 mm"; }).least_feature_um == doctest::Approx(10000));
    CHECK(refused([](Order& o) { o.layer = "0.5 um"; }).find("--layer 0.5 um: a whole number") == 0);
    CHECK(refused([](Order& o) { o.layer = "50"; }).find("--layer: ") == 0);
    CHECK(refused([](Order& o) { o.least_feature = "10.1 mm"; }) == "--least-feature 10.1 mm: must be 1e-06 to 10 mm");
    CHECK(refused([](Order& o) { o.least_feature = "0 mm"; }).find("--least-feature 0 mm: must be") == 0);
}

TEST_CASE("--interlock and --overlap name two materials, pixels and layers") {
    const auto s = settings_of([](Order& o) {
        o.interlocks = {"soft+firm=4", "firm+soft=3,2"};
        o.overlaps = {"soft+firm=2", "soft+firm=0,1"};
    });
    REQUIRE(s.slicing.teeth.size() == 2);
    CHECK(s.slicing.teeth[0].first == "soft");
    CHECK(s.slicing.teeth[0].second == "firm");
    CHECK(s.slicing.teeth[0].depth_px == 4);
    CHECK(s.slicing.teeth[0].layers == 1);
    CHECK(s.slicing.teeth[1].layers == 2);
    REQUIRE(s.slicing.bonds.size() == 2);
    CHECK(s.slicing.bonds[0].depth_px == 2);
    CHECK(s.slicing.bonds[0].layers == 0);
    CHECK(s.slicing.bonds[1].depth_px == 0);
    CHECK(s.slicing.bonds[1].layers == 1);
    for (const char* wrong : {"soft=4", "soft+firm", "soft=4+firm", ""})
        CHECK(refused([&](Order& o) { o.interlocks = {wrong}; }).find("write MATERIAL+MATERIAL=PIXELS") !=
              std::string::npos);
    for (const char* wrong : {"soft+firm=", "soft+firm=-1", "soft+firm=2,", "soft+firm=2,x", "soft+firm=1.5"})
        CHECK(refused([&](Order& o) { o.overlaps = {wrong}; }).find("must be whole numbers") != std::string::npos);
}

TEST_CASE("--exposure: of a material, of its first layers, of some layers") {
    auto s = settings_of([](Order& o) { o.exposures = {"soft=3 s"}; });
    CHECK(s.materials[0].exposure_s == 3);
    CHECK(s.materials[0].bottom_exposure_s == 9);  // still the longer one
    CHECK(s.materials[1].exposure_s == 4);
    s = settings_of([](Order& o) { o.exposures = {"soft=20 s"}; });
    CHECK(s.materials[0].bottom_exposure_s == 20);
    s = settings_of([](Order& o) { o.exposures = {"soft=20 s,5 s"}; });
    CHECK(s.materials[0].bottom_exposure_s == 5);
    s = settings_of([](Order& o) { o.exposures = {"firm:2-5=6 s", "firm:7=1 s"}; });
    REQUIRE(s.exposures.contains("firm"));
    const auto& spans = s.exposures.at("firm").spans;
    REQUIRE(spans.size() == 2);
    CHECK(spans[0].first == 2);
    CHECK(spans[0].last == 5);
    CHECK(spans[0].seconds == 6);
    CHECK(spans[1].first == 7);
    CHECK(spans[1].last == 7);
    CHECK(s.materials[1].exposure_s == 4);
    CHECK(settings_of([](Order& o) { o.exposures = {"soft=1 h"}; }).materials[0].exposure_s == 3600);
    for (const char* wrong : {"soft", "=3 s", ""})
        CHECK(refused([&](Order& o) { o.exposures = {wrong}; }).find("write MATERIAL=TIME") != std::string::npos);
    for (const char* wrong : {"soft=0 s", "soft=-1 s", "soft=3601 s", "soft=2 s,0 s"})
        CHECK(refused([&](Order& o) { o.exposures = {wrong}; }).find("must be above 0 s and at most an hour") !=
              std::string::npos);
    for (const char* wrong : {"soft:5-2=3 s", "soft:-1-2=3 s", "soft:=3 s", "soft:1-=3 s", "soft:1-2=3 s,4 s"})
        CHECK(refused([&](Order& o) { o.exposures = {wrong}; }).find("layers are FIRST-LAST") != std::string::npos);
    CHECK(refused([](Order& o) { o.exposures = {"hard=3 s"}; }).find("there is no material \"hard\"") !=
          std::string::npos);
    CHECK(refused([](Order& o) { o.exposures = {"soft=3 mm"}; }).find("--exposure soft=3 mm: ") == 0);
}

TEST_CASE("--resin: another resin with its exposures; one that the printer does not know is told") {
    Drawing drawing = two_blocks();
    Order order;
    order.resins = {"soft=firm"};
    auto s = job_settings(order, printer(), {}, drawing);
    REQUIRE(s.has_value());
    CHECK(s->materials[0].resin == "firm");
    CHECK(s->materials[0].exposure_s == 4);
    CHECK(drawing.warnings.empty());
    drawing = two_blocks();
    order.resins = {"soft=glue"};
    s = job_settings(order, printer(), {}, drawing);
    REQUIRE(s.has_value());
    CHECK(s->materials[0].exposure_s == 4);  // the longest that is known
    CHECK(s->materials[0].bottom_exposure_s == 9);
    REQUIRE(drawing.warnings.size() == 1);
    CHECK(drawing.warnings[0].find("resin \"glue\" is not in the printer file") == 0);
    CHECK(refused([](Order& o) { o.resins = {"hard=firm"}; }).find("hard") != std::string::npos);
    CHECK(!refused([](Order& o) { o.resins = {"soft"}; }).empty());
}

TEST_CASE("what the resins of the printer ask for reaches their materials") {
    machine::Printer p = printer();
    p.resins[1].xy_compensation_um = -40;
    p.resins[0].transition_layers = 5;
    p.projector.grey = {0, 0.5, 1};
    Drawing drawing = two_blocks();
    const auto s = job_settings({}, p, {}, drawing);
    REQUIRE(s.has_value());
    REQUIRE(s->slicing.compensation.size() == 1);
    CHECK(s->slicing.compensation.at("firm").grow_um == -40);
    REQUIRE(s->exposures.size() == 1);
    CHECK(s->exposures.at("soft").transition_layers == 5);
    CHECK(s->exposures.at("soft").bottom_layers == 3);
    CHECK(!s->light.none());
}

TEST_CASE("--support with a material that no body has takes the resin of its name; the record keeps what was asked") {
    Order order;
    order.support = "firm";
    Drawing drawing = two_blocks();
    REQUIRE(job_settings(order, printer(), {}, drawing).has_value());
    CHECK(drawing.resin_of_material.size() == 2);
    order.support = "brittle";
    order.raft = "1 mm";
    const auto s = job_settings(order, printer(), {}, drawing);
    REQUIRE(s.has_value());
    CHECK(s->materials.size() == 3);
    CHECK(s->materials[2].resin == "brittle");
    const job::Request request = request_of(order, *s);
    REQUIRE(request.supports.size() == 2);
    CHECK(request.supports[0] == std::pair<std::string, std::string>{"support", "brittle"});
    CHECK(request.supports[1] == std::pair<std::string, std::string>{"raft", "1 mm"});
}

TEST_CASE("--no-anti-alias and --threshold reach the rules") {
    const auto s = settings_of([](Order& o) {
        o.no_anti_alias = true;
        o.threshold = 0.3;
    });
    CHECK(!s.slicing.rules.anti_alias);
    CHECK(s.slicing.rules.threshold == 0.3);
}
