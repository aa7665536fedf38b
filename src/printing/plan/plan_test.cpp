#include "printing/plan/plan.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/core/near.hpp"
#include "base/core/test_text.hpp"
#include "printing/machine/working_curve.hpp"
#include "printing/plan/check.hpp"
#include "printing/plan/departures.hpp"
#include "printing/plan/test_jobs.hpp"

using namespace pliant;
using namespace pliant::plan;
using pliant::plan::test::repeated;
using pliant::test::holds;

namespace {

const std::vector<std::string> two = {"semi-flex", "rigid-flex"};

Plan planned(const job::Manifest& job, const machine::Printer& printer) {
    auto plan = make_plan(job, printer);
    REQUIRE_MESSAGE(plan, (plan ? "" : plan.error().message));
    return *plan;
}

std::string plan_error(const job::Manifest& job, const machine::Printer& printer) {
    const auto plan = make_plan(job, printer);
    return plan ? "" : plan.error().message;
}

}  // namespace

TEST_CASE("two halves of 200 layers: 200 swaps, with their time and resin") {
    const machine::Printer printer = plan::test::tower();
    const job::Manifest job = plan::test::make_job(repeated({0, 1}, 200), two);
    const Plan plan = planned(job, printer);
    CHECK(plan.layers == 200);
    CHECK(plan.swaps == 200);
    CHECK(plan.swap_lower_bound == 200);
    CHECK(plan.order[0] == VatList{0, 1});
    CHECK(plan.order[1] == VatList{1, 0});
    CHECK(plan.warnings.empty());
    // 3 layers of 2 x 12 s, 197 of 2 x 2.5 s.
    CHECK(plan.seconds.expose == near(3 * 24 + 197 * 5, {.relative = 1e-12}));
    // 200 swaps and the final cleaning, 15 s each.
    CHECK(plan.seconds.clean == near(201 * 15, {.relative = 1e-3}));
    CHECK(plan.seconds.total ==
          near(plan.seconds.swap + plan.seconds.clean + plan.seconds.expose + plan.seconds.move, {.relative = 1e-12}));
    // 200 layers of 100 mm^2 x 50 um.
    REQUIRE(plan.vats.size() == 2);
    CHECK(plan.vats[0].resin_ml == near(1, {.relative = 1e-12}));
    CHECK(plan.vats[1].resin_ml == near(1, {.relative = 1e-12}));
}

TEST_CASE("a resin that no vat holds takes the next free vat, with a warning") {
    machine::Printer printer = plan::test::tower();
    const job::Manifest job = plan::test::make_job({{0, 1, 2}}, {"rubber", "semi-flex", "wax"});
    Plan plan = planned(job, printer);
    CHECK(plan.vat_of_material == std::vector<int>{1, 0, 2});
    REQUIRE(plan.warnings.size() == 2);
    CHECK(
        holds(plan.warnings[0], "no vat holds \"rubber\": fill it into the vat of slot 2, which holds \"rigid-flex\""));
    CHECK(plan.vats[1].refill);
    CHECK_FALSE(plan.vats[0].refill);
    printer.vats[3].resin = "";
    plan = planned(job, printer);
    CHECK(plan.vat_of_material == std::vector<int>{3, 0, 1});
    CHECK(filled_printer(plan, job, printer).vats[3].resin == "rubber");
    const machine::Printer filled = filled_printer(plan, job, printer);
    CHECK(filled.find_resin("rubber")->exposure_s == 2.5);
    // Its light is assumed to cure two layers, and Dp is half of that depth.
    const machine::WorkingCurve curve = machine::working_curve(filled, *filled.find_resin("rubber"));
    CHECK(curve.depth_um(2.5 * machine::irradiance_W_m2(filled)) == near(2 * printer.layer_um, {.relative = 1e-12}));
    CHECK(curve.penetration_um == printer.layer_um);
}

TEST_CASE("materials of one resin share a vat and need no swap") {
    const Plan plan = planned(plan::test::make_job(repeated({0, 1}, 4), {"tough", "tough"}), plan::test::tower());
    CHECK(plan.swaps == 0);
    CHECK(plan.vats.size() == 1);
    CHECK(plan.vats[0].materials == std::vector<int>{0, 1});
    CHECK(plan.order[0] == VatList{2});
}

TEST_CASE("too many resins, another projector, a part too tall, layers out of order, no exposure: errors") {
    const machine::Printer printer = plan::test::tower();
    CHECK(holds(plan_error(plan::test::make_job({{0, 1, 2, 3, 4}}, {"a", "b", "c", "d", "e"}), printer),
                "needs 5 resins"));
    job::Manifest job = plan::test::make_job(repeated({0}, 3), two);
    job.width_px = 100;
    CHECK(holds(plan_error(job, printer), "slice it again"));
    job = plan::test::make_job(repeated({0}, 3), two);
    job.layers[2].z_um = 304801;
    CHECK(holds(plan_error(job, printer), "builds 304.80 mm"));
    job.layers[2].z_um = 50;
    CHECK(holds(plan_error(job, printer), "layer 3 at 50 um does not lie above 100 um"));
    job = plan::test::make_job(repeated({0}, 3), two);
    job.layers[1].images[0].material = 2;
    CHECK(holds(plan_error(job, printer), "prints material 2, there are 2"));
    job.layers[1].images[0] = {0, "a\nG28", 1};
    CHECK(holds(plan_error(job, printer), "without a usable name"));
    job = plan::test::make_job(repeated({0}, 3), two);
    job.materials[0].exposure_s = 0;
    CHECK(holds(plan_error(job, printer), "needs exposures"));
}

TEST_CASE("warnings: a material that prints nothing, and a vat that holds too little resin") {
    machine::Printer printer = plan::test::tower();
    printer.vats[0].fill_ml = 60.01;  // of which 60 must stay
    const Plan plan = planned(plan::test::make_job({{0}, {0}, {}, {}, {0}}, two), printer);
    REQUIRE(plan.warnings.size() == 3);
    CHECK(holds(plan.warnings[0], "\"m1\" prints nothing"));
    CHECK(holds(plan.warnings[1],
                "the vat of slot 1 gives under 0.1 ml of \"semi-flex\" at a time: refill it before layer 5"));
    CHECK(holds(plan.warnings[2], "1 layer would have to be cured deeper"));
    const auto json = nlohmann::json::parse(plan_json(plan));
    REQUIRE(json["vats"].size() == 1);
    CHECK(json["vats"][0]["refill"] == false);  // the printer file has that resin there
    CHECK(json["vats"][0]["refills"] == nlohmann::json::parse(R"([{"layer": 4}])"));
}

TEST_CASE("layers that a longer exposure cures deep enough are not counted as too thick") {
    machine::Printer printer = plan::test::tower();
    machine::Resin& resin = printer.resins[0];
    resin.penetration_um = resin.critical_J_m2 = 0;
    resin.exposure_s = 2.5;
    const auto last_warning = [&](int cure_depth_um) {
        resin.cure_depth_um = cure_depth_um;
        const Plan plan = planned(plan::test::make_job(repeated({0}, 10), {resin.name}), printer);
        return plan.warnings.empty() ? std::string() : plan.warnings.back();
    };
    CHECK(holds(last_warning(40), "7 layers would have to be cured deeper"));  // three have the bottom exposure
    CHECK(!holds(last_warning(50), "cured deeper"));
}

TEST_CASE("the G-code passes the interlocks, is absolute, and shows each image once, after M400") {
    const machine::Printer printer = plan::test::tower();
    const job::Manifest job =
        plan::test::make_job({{0, 1, 2}, {0, 2}, {}, {1}, {0, 1, 2}}, {"semi-flex", "rigid-flex", "tough"});
    const Plan plan = planned(job, printer);
    const std::string text = write_gcode(plan, job, printer);
    const Status checked = check_gcode(text, printer);
    CHECK_MESSAGE(checked, (checked ? "" : checked.error().message));
    CHECK_FALSE(holds(text, "G91"));
    CHECK_FALSE(holds(text, "G92"));
    std::size_t fences = 0;
    for (std::size_t at = text.find(";@expose"); at != std::string::npos; at = text.find(";@expose", at + 1)) {
        CHECK(text.substr(at - 5, 5) == "M400\n");
        ++fences;
    }
    CHECK(fences == 9);
    CHECK(holds(text, ";@expose layer=0 material=0 seconds=12.000 image=layers/0_m0.png"));
    CHECK(holds(text, ";@expose layer=3 material=1 seconds=2.500 image=layers/3_m1.png"));
    CHECK(holds(text, ";@stop M107 P1"));
}

TEST_CASE("an empty job homes the axes and does nothing else") {
    const machine::Printer printer = plan::test::tower();
    const job::Manifest job = plan::test::make_job({}, two);
    const Plan plan = planned(job, printer);
    CHECK(plan.swaps == 0);
    CHECK(plan.seconds.swap == 0);
    CHECK(check_gcode(write_gcode(plan, job, printer), printer));
}

TEST_CASE("the plan as JSON has the keys that programs read") {
    const Plan plan = planned(plan::test::make_job(repeated({0, 1}, 2), {"semi-flex", "wax"}), plan::test::tower());
    const auto json = nlohmann::json::parse(plan_json(plan));
    CHECK(json["layers"] == 2);
    CHECK(json["swaps"] == 2);
    CHECK(json["swap_lower_bound"] == 2);
    CHECK(json["order"] == nlohmann::json::parse("[[1, 2], [2, 1]]"));
    CHECK(json["resin_ml"]["2"].get<double>() == near(0.01, {.relative = 1e-12}));
    CHECK(json["warnings"].size() == 1);
    for (const char* key : {"total", "swap", "clean", "expose", "move"}) CHECK(json["seconds"][key].is_number());
}

TEST_CASE("the plan as text shows times as h:mm:ss") {
    CHECK(clock_text(3723.4) == "1:02:03");
    CHECK(clock_text(0) == "0:00:00");
    const std::string text = plan_text(planned(plan::test::make_job(repeated({0, 1}, 2), two), plan::test::tower()));
    CHECK(holds(text, "minimum 2"));
    CHECK(holds(text, "slot 2"));
}

TEST_CASE("jobs with known swap counts: naive order and best order agree with the table") {
    const machine::Printer printer = machine::load_printer("examples/printers/tower8.toml").value();
    std::vector<std::string> resins;
    for (const machine::Vat& vat : printer.vats) resins.push_back(vat.resin);
    const auto counts = [&](const std::vector<std::vector<int>>& layers) {
        const Plan plan = planned(plan::test::make_job(layers, resins), printer);
        CHECK(plan.swap_lower_bound == plan.compared.back().swaps);
        return std::pair(plan.compared.front().swaps, plan.swaps);
    };
    std::vector<std::vector<int>> stack, bands;
    for (int m = 0; m < 4; ++m) stack.insert(stack.end(), 40, {m});
    for (int band = 0; band < 10; ++band) bands.insert(bands.end(), 20, {band % 2});
    CHECK(counts(repeated({0, 1}, 200)) == std::pair(399, 200));                      // two_halves
    CHECK(counts(stack) == std::pair(3, 3));                                          // stack4
    CHECK(counts(bands) == std::pair(9, 9));                                          // alternating_bands
    CHECK(counts(repeated({0, 1, 2, 3, 4, 5, 6, 7}, 200)) == std::pair(1599, 1400));  // checker8
}

TEST_CASE("a resin in no vat is an error with the nearest name, unless any vat may be used") {
    const machine::Printer printer = plan::test::tower();
    job::Manifest job = plan::test::make_job({{0}, {0, 1}}, {"semiflex", "rigid-flex"});
    CHECK(make_plan(job, printer).has_value());
    job.any_vat = false;
    const auto refused = make_plan(job, printer);
    REQUIRE(!refused.has_value());
    CHECK(refused.error().cause == Cause::input);
    CHECK(refused.error().message ==
          "no vat of tower prototype holds the resin \"semiflex\" of \"m0\": did you mean \"semi-flex\"? Slice with "
          "--resin MATERIAL=RESIN, or with --any-vat to fill it into a free vat");
    job.materials[0].resin = "zzz";
    CHECK(make_plan(job, printer)
              .error()
              .message.find("they hold semi-flex, rigid-flex, tough and elastomer. Slice with") != std::string::npos);
    job.materials[0].resin = "";
    CHECK(!make_plan(job, printer).has_value());
    job.layers = {};  // a material that prints nothing needs no vat
    CHECK(make_plan(job, printer).has_value());
}

TEST_CASE("the list of vats says what to fill in") {
    job::Manifest job = plan::test::make_job({{0}, {0, 1}}, {"glue", "rigid-flex"});
    const Plan plan = make_plan(job, plan::test::tower()).value();
    CHECK(vat_lines(plan) ==
          std::vector<std::string>{"slot 1: glue, at least 61 ml (under 0.1 ml printed, under 0.1 ml wasted), to be "
                                   "filled in: the printer file has another resin "
                                   "there, or none",
                                   "slot 2: rigid-flex, at least 61 ml (under 0.1 ml printed, under 0.1 ml wasted)"});
}

TEST_CASE("a vat needs what is printed and wasted before its first refill, and what must stay in it") {
    machine::Printer printer = plan::test::tower();  // 60 ml must stay
    job::Manifest job = plan::test::make_job(repeated({0}, 4), two);
    for (job::Layer& layer : job.layers) layer.images[0].area_mm2 = 5e4;  // 2.5 ml a layer
    const VatUse whole = planned(job, printer).vats.front();
    CHECK(whole.resin_ml == near(10, {.relative = 1e-12}));
    CHECK(whole.waste_ml == near(2.13, {.relative = 1e-9}));  // of a film of 60 um on 500 cm^2 the brush leaves 71 %
    CHECK(whole.needed_ml == near(70 + whole.waste_ml, {.relative = 1e-12}));
    CHECK(needed_text(whole) == "at least 73 ml");
    printer.vats[0].fill_ml = 68;  // three layers; cleaned after the fourth
    const Plan refilled = planned(job, printer);
    CHECK(refilled.vats.front().needed_ml == near(67.5, {.relative = 1e-12}));
    REQUIRE(vat_lines(refilled).size() == 1);
    CHECK(holds(vat_lines(refilled)[0], "slot 1: semi-flex, at least 68 ml (10.0 ml printed, "));
    CHECK(holds(vat_lines(refilled)[0], " wasted), refilled 1 time during the print"));
    CHECK(nlohmann::json::parse(plan_json(refilled))["vats"][0]["needed_ml"] == 67.5);
}

TEST_CASE("a layer that needs more than a full vat gives is an error of the plan") {
    machine::Printer printer = plan::test::tower();  // 60 ml must stay
    job::Manifest job = plan::test::make_job(repeated({0}, 4), two);
    job.layers[2].images[0].area_mm2 = 5e4;  // 2.5 ml
    printer.vats[0].fill_ml = 62.5;
    CHECK(make_plan(job, printer).has_value());
    printer.vats[0].fill_ml = 62;
    CHECK(plan_error(job, printer) ==
          "job: layer 3 needs 2.5 ml of \"semi-flex\", the vat of slot 1 gives 2.0 ml: of its fill of 62 ml, 60 ml "
          "must stay in it");
    printer.vats[0].fill_ml = 0;
    CHECK(holds(plan_error(job, printer), "the vat of slot 1 gives 0.0 ml"));
}

TEST_CASE("an empty vat without a fill is filled with all that it can hold") {
    machine::Printer printer = plan::test::tower();
    printer.vats[3].resin = "";
    printer.vats[3].fill_ml = 0;
    const job::Manifest job = plan::test::make_job(repeated({0, 1}, 4), {"rubber", "semi-flex"});
    const Plan plan = planned(job, printer);
    CHECK(plan.vat_of_material == std::vector<int>{3, 0});
    CHECK(plan.refills.empty());
    CHECK(filled_printer(plan, job, printer).vats[3].fill_ml == printer.vat_shape.free_volume_ml);
    printer.vats[3].fill_ml = 100;  // what the file says counts
    CHECK(filled_printer(plan, job, printer).vats[3].fill_ml == 100);
}

TEST_CASE("resin of pixels that two images expose comes from the vat that is first in its layer") {
    const machine::Printer printer = plan::test::tower();
    job::Manifest job = plan::test::make_job(repeated({0, 1}, 2), two);
    for (job::Layer& layer : job.layers) layer.images[0].shared_mm2 = 40;
    Plan plan = planned(job, printer);
    CHECK(plan.order[0] != plan.order[1]);  // 100 and 60 mm^2, then 60 and 100
    CHECK(plan.vats[0].resin_ml == near(0.008, {.relative = 1e-12}));
    CHECK(plan.vats[1].resin_ml == near(0.008, {.relative = 1e-12}));
    job.layers.resize(1);
    plan = planned(job, printer);
    const auto first = static_cast<std::size_t>(plan.order[0].front());
    CHECK(plan.vats[first].resin_ml == near(0.005, {.relative = 1e-12}));
    CHECK(plan.vats[1 - first].resin_ml == near(0.003, {.relative = 1e-12}));
    // Of three images none says whose pixels it shares; in all there is light on 260 mm^2.
    job = plan::test::make_job({{0, 1, 2}}, {"semi-flex", "rigid-flex", "tough"});
    job.layers[0].images[1].shared_mm2 = 40;
    plan = planned(job, printer);
    CHECK(plan.vats[0].resin_ml + plan.vats[1].resin_ml + plan.vats[2].resin_ml == near(0.013, {.relative = 1e-12}));
}

TEST_CASE("what the part carries off counts in how long a vat lasts") {
    machine::Printer printer = plan::test::tower();
    job::Manifest job = plan::test::make_job(repeated({0}, 4), two);
    for (job::Layer& layer : job.layers) layer.images[0].area_mm2 = 5e4;
    printer.vats[0].fill_ml = 71;  // enough for the 10 ml that are printed, not for the 2.1 ml on the finished part
    const Plan plan = planned(job, printer);
    CHECK(plan.refills_of(1) == std::vector<int>{3});
    CHECK(plan.vats.front().needed_ml == near(67.5, {.relative = 1e-12}));
}

TEST_CASE("a warning of several refills names each layer") {
    machine::Printer printer = plan::test::tower();
    job::Manifest job = plan::test::make_job(repeated({0}, 8), two);
    for (job::Layer& layer : job.layers) layer.images[0].area_mm2 = 5e4;  // 2.5 ml
    printer.vats[0].fill_ml = 71;
    const Plan plan = planned(job, printer);
    const std::vector<int> layers = plan.refills_of(1);
    REQUIRE(layers.size() == 2);
    const std::string end = fmt::format(": refill it before layers {} and {}", layers[0] + 1, layers[1] + 1);
    CHECK(std::ranges::any_of(plan.warnings, [&](const std::string& warning) { return warning.ends_with(end); }));
}

TEST_CASE("no vat falls below its least while vats change in every layer") {
    machine::Printer printer = plan::test::tower();
    job::Manifest job = plan::test::make_job(repeated({0, 1}, 9), two);
    for (std::size_t i = 0; i < job.layers.size(); ++i) {
        for (job::LayerImage& image : job.layers[i].images) image.area_mm2 = 3e4 + 1e4 * static_cast<double>(i % 3);
    }
    std::size_t refills = 0;
    for (double fill_ml = 72; fill_ml < 110; fill_ml += 0.7) {  // above what a layer takes at most
        CAPTURE(fill_ml);
        for (machine::Vat& vat : printer.vats) vat.fill_ml = fill_ml;
        if (printer.vats.size() > 2) printer.vats[2].resin = printer.vats[0].resin;  // takes over
        const Plan plan = planned(job, printer);
        refills += plan.refills.size();
        std::vector<double> left_ml(printer.vats.size(), fill_ml);
        const std::vector<Departure> all = departures(plan.order, plan.vat_of_image, job, printer);
        auto next = all.begin();
        const auto leave = [&](std::size_t layer, int vat) {
            if (next == all.end() || next->layer != layer || next->next != vat) return;
            left_ml[static_cast<std::size_t>(next->vat)] -= next->film_ml * (1 - printer.brushed_share());
            ++next;
        };
        for (std::size_t i = 0; i < plan.order.size(); ++i) {
            for (const RefillBefore& refill : plan.refills) {
                for (std::size_t v = 0; v < left_ml.size(); ++v) {
                    if (refill.layer == static_cast<int>(i) && printer.vats[v].slot == refill.slot)
                        left_ml[v] = fill_ml;
                }
            }
            for (const int vat : plan.order[i]) {
                leave(i, vat);
                for (std::size_t k = 0; k < job.layers[i].images.size(); ++k) {
                    if (plan.vat_of_image[i][k] == vat)
                        left_ml[static_cast<std::size_t>(vat)] -= job.layers[i].images[k].area_mm2 * 50 / 1e6;
                }
            }
            leave(i, -1);
            for (const double ml : left_ml) CHECK(ml >= printer.vat_shape.least_ml - 1e-9);
        }
        CHECK(next == all.end());
        for (const VatUse& use : plan.vats) CHECK(use.needed_ml <= fill_ml + 1e-9);
    }
    CHECK(refills > 20);
}

TEST_CASE("an amount that is not none is not printed as none") {
    CHECK(ml_text(0) == "0.0 ml");
    CHECK(ml_text(0.004) == "under 0.1 ml");
    CHECK(ml_text(0.06) == "0.1 ml");
    CHECK(ml_text(12.34) == "12.3 ml");
}

TEST_CASE("no name can add a line to the program") {
    machine::Printer printer = plan::test::tower();
    job::Manifest job = plan::test::make_job(repeated({0, 1}, 2), two);
    const auto lines = [&] {
        const std::string text = write_gcode(planned(job, printer), job, printer);
        return std::count(text.begin(), text.end(), '\n');
    };
    const auto plain = lines();
    job.name = "rob\nM42 P4 S255\n;";
    printer.name = "tower\r\nM42 P4 S255";
    CHECK(lines() == plain);
    CHECK(holds(write_gcode(planned(job, printer), job, printer), "rob M42 P4 S255 ; on tower"));
}
