#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>

#include "base/core/counted.hpp"
#include "base/core/json.hpp"
#include "printing/twin/inspect.hpp"

namespace pliant::twin {
namespace {

using Json = nlohmann::ordered_json;

double rounded(double value) {
    return std::round(value * 1e6) / 1e6;
}

Json material_json(const MaterialReport& m) {
    return {{"name", m.name},
            {"resin", m.resin},
            {"model_mm3", rounded(m.model_mm3)},
            {"wanted_mm3", rounded(m.wanted_mm3)},
            {"cured_mm3", rounded(m.cured_mm3)},
            {"foreign_mm3", rounded(m.foreign_mm3)},
            {"missing_mm3", rounded(m.missing_mm3)},
            {"tolerance_mm3", rounded(m.tolerance_mm3)},
            {"passed", m.passed}};
}

/// Contamination as columns: one row for each vat of each layer.
Json contamination_json(const Report& r) {
    Json top = Json::array(), vat = Json::array(), foreign = Json::array(), residue = Json::array();
    for (const Contamination& c : r.contamination) {
        top.push_back(c.top_um);
        vat.push_back(c.vat);
        foreign.push_back(rounded(c.foreign));
        residue.push_back(rounded(c.residue));
    }
    return {{"worst_foreign", rounded(r.worst_foreign)},
            {"worst_residue", rounded(r.worst_residue)},
            {"layers_over_limit", r.contaminated_layers},
            {"top_um", std::move(top)},
            {"vat", std::move(vat)},
            {"foreign", std::move(foreign)},
            {"residue", std::move(residue)}};
}

/// A part full of small holes has thousands of them: the sums cover all, the list only the largest.
Json trapped_json(const Report& r) {
    constexpr std::size_t most = 50;
    Json spaces = Json::array();
    double pockets_ml = 0, cups_ml = 0;
    for (const Trapped& t : r.trapped) {
        (t.closed ? pockets_ml : cups_ml) += t.ml;
        if (spaces.size() == most) continue;
        spaces.push_back({{"kind", t.closed ? "pocket" : "cup"},
                          {"ml", rounded(t.ml)},
                          {"z_um", {t.z_begin_um, t.z_end_um}},
                          {"x_px", {t.x_begin_px, t.x_end_px}},
                          {"y_px", {t.y_begin_px, t.y_end_px}}});
    }
    return {{"pockets_ml", rounded(pockets_ml)},
            {"cups_ml", rounded(cups_ml)},
            {"count", r.trapped.size()},
            {"largest", std::move(spaces)}};
}

std::string trapped_text(const Report& r) {
    constexpr std::size_t most = 5;
    std::string text;
    for (std::size_t i = 0; i < std::min(most, r.trapped.size()); ++i) {
        const Trapped& t = r.trapped[i];
        text += fmt::format("  {:.3f} ml of resin stay in a {} at z {:.2f} to {:.2f} mm, pixels {} to {} by {} to {}\n",
                            t.ml, t.closed ? "closed pocket" : "cup", t.z_begin_um / 1000.0, t.z_end_um / 1000.0,
                            t.x_begin_px, t.x_end_px, t.y_begin_px, t.y_end_px);
    }
    if (r.trapped.size() > most) text += fmt::format("  and in {} smaller ones\n", r.trapped.size() - most);
    return text;
}

Json findings_json(const Report& r) {
    Json findings = Json::array();
    for (const Finding& f : r.findings)
        findings.push_back({{"name", finding_name(f.kind)}, {"text", f.text}, {"accepted", f.accepted}});
    return findings;
}

/// What is wrong. A cause that spoils every layer has a finding for each: a few of them tell it.
std::string findings_text(const Report& r) {
    constexpr std::ptrdiff_t most = 3;
    std::string text;
    for (auto f = r.findings.begin(); f != r.findings.end();) {
        const auto end =
            std::find_if(f, r.findings.end(), [&kind = f->kind, &accepted = f->accepted](const Finding& o) {
                return o.kind != kind || o.accepted != accepted;
            });
        const bool of_layers = f->kind == Finding::Kind::light || f->kind == Finding::Kind::interlock;
        const auto left = of_layers ? std::max<std::ptrdiff_t>(0, end - f - most) : 0;
        const std::string_view name = finding_name(f->kind);
        for (; f != end - left; ++f)
            text += fmt::format("  {} ({}): {}\n", f->accepted ? "accepted" : "wrong", name, f->text);
        if (left > 0) text += fmt::format("  and {} more ({})\n", left, name);
        f = end;
    }
    return text;
}

}  // namespace

std::string report_json(const Report& r) {
    Json materials = Json::array();
    for (const MaterialReport& m : r.materials) materials.push_back(material_json(m));
    Json resins = Json::array();
    for (const ResinReport& resin : r.resins) {
        resins.push_back({{"name", resin.name},
                          {"cured_mm3", rounded(resin.cured_mm3)},
                          {"left_ml", rounded(resin.left_ml)},
                          {"foreign_share", rounded(resin.foreign_share)},
                          {"overcure_mm3", rounded(resin.overcure_mm3)},
                          {"overcure_beyond_mm3", rounded(resin.overcure_beyond_mm3)},
                          {"allowed_overcure_um", rounded(resin.allowed_overcure_um)}});
    }
    const Json json = {{"passed", r.passed},
                       {"reasons", r.reasons},
                       {"findings", findings_json(r)},
                       {"first_deviation", r.first_deviation},
                       {"materials", std::move(materials)},
                       {"resins", std::move(resins)},
                       {"layers", r.layers},
                       {"missing_layers", r.missing_layers},
                       {"stray_layers", r.stray_layers},
                       {"wrong_thickness", r.wrong_thickness},
                       {"wrong_pixels", r.wrong_pixels},
                       {"missing_pixels", r.missing_pixels},
                       {"foreign_pixels", r.foreign_pixels},
                       {"stray_pixels", r.stray_pixels},
                       {"wrong_dose_pixels", r.wrong_dose_pixels},
                       {"least_dose", rounded(r.least_dose)},
                       {"most_dose", rounded(r.most_dose)},
                       {"wrong_images", r.wrong_images},
                       {"pixels_lit_twice", r.pixels_lit_twice},
                       {"overlit_pixels", r.log.overlit_pixels},
                       {"swaps", r.log.swaps},
                       {"short_cleanings", r.log.short_cleanings},
                       {"exposures", r.log.exposures},
                       {"contamination", contamination_json(r)},
                       {"washed_ml", rounded(r.washed_ml)},
                       {"brushed_ml", rounded(r.brushed_ml)},
                       {"solution",
                        {{"pumped_ml", rounded(r.solution_pumped_ml)},
                         {"used_ml", rounded(r.solution_used_ml)},
                         {"liquid_ml", rounded(r.solution_ml)},
                         {"resin_share", rounded(r.solution_resin_share)}}},
                       {"trapped", trapped_json(r)},
                       {"deepest_overcure_um", rounded(r.deepest_overcure_um)},
                       {"mishaps", r.log.mishaps},
                       {"violations", r.log.violations},
                       {"bad_lines", r.log.bad_lines},
                       {"resets", r.log.resets},
                       {"clock_s", rounded(r.clock_s)}};
    return json_text(json, 1) + "\n";
}

std::string report_text(const Report& r) {
    std::string text = fmt::format("virtual print {}: {}, {}, {}, {:.0f} s on the machine's clock\n",
                                   r.passed ? "passed" : "FAILED", counted(r.layers, "layer"),
                                   counted(r.log.exposures, "exposure"), counted(r.log.swaps, "swap"), r.clock_s);
    for (const MaterialReport& m : r.materials) {
        text += fmt::format("  {:<16}{:>12.3f} mm^3 cured {:>12.3f} drawn {:>10.3f} tolerance\n", m.name, m.cured_mm3,
                            m.model_mm3, m.tolerance_mm3);
    }
    for (const ResinReport& resin : r.resins) {
        if (resin.cured_mm3 <= 0) continue;
        text += fmt::format("  {:<16}{:>12.1f} ml left, {:.4f} % foreign; {:.2f} mm^3 overcured below overhangs\n",
                            resin.name, resin.left_ml, 100 * resin.foreign_share, resin.overcure_mm3);
    }
    text += trapped_text(r);
    if (!r.first_deviation.empty()) text += fmt::format("  first: {}\n", r.first_deviation);
    for (const std::string& mishap : r.log.mishaps) text += fmt::format("  fault: {}\n", mishap);
    return text + findings_text(r);
}

}  // namespace pliant::twin
