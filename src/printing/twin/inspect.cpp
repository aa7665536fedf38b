#include "printing/twin/inspect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/core/counted.hpp"
#include "printing/machine/image_room.hpp"
#include "printing/twin/layer_inspection.hpp"

namespace pliant::twin {
namespace {

/// Compares foreign resin and cleaning residue with the machine's limits.
void judge_contamination(Report& report, Twin& twin, const job::Manifest& job, bool accepted) {
    const double most = twin.printer().cleaning.most_contamination;
    for (const Contamination& c : twin.contamination()) {
        report.worst_foreign = std::max(report.worst_foreign, c.foreign);
        report.worst_residue = std::max(report.worst_residue, c.residue);
        if (most <= 0 || c.foreign <= most) continue;
        ++report.contaminated_layers;
        if (accepted) continue;
        const auto layer =
            std::find_if(job.layers.begin(), job.layers.end(), [&](auto& l) { return l.z_um == c.top_um; });
        note_first(report, job, static_cast<int>(layer - job.layers.begin()), -1,
                   fmt::format("{:.2f} % foreign resin in the vat of slot {} (cleaning)", 100 * c.foreign,
                               twin.printer().slot_of(c.vat)));
    }
    report.contamination = twin.contamination();
}

void count_stray_layers(Report& report, Twin& twin, const job::Manifest& job) {
    for (const CuredLayer& cured : twin.cured().layers()) {
        const bool wanted = std::any_of(job.layers.begin(), job.layers.end(), [&](const job::Layer& l) {
            return l.z_um == cured.top_um && !l.images.empty();
        });
        if (wanted) continue;
        ++report.stray_layers;
    }
}

void measure_solution(Report& report, const Fluids& fluids) {
    const machine::SolutionCircuit& solution = fluids.solution();
    report.washed_ml = fluids.washed_ml();
    report.brushed_ml = fluids.brushed_ml();
    report.solution_pumped_ml = solution.pumped_ml();
    report.solution_used_ml = solution.used_ml();
    report.solution_ml = solution.liquid_ml();
    report.solution_resin_share = solution.resin_share();
}

void measure_resins(Report& report, Twin& twin) {
    const machine::Printer& printer = twin.printer();
    const double pixel_mm = printer.projector.pixel_um / 1000;
    for (std::size_t v = 0; v < printer.vats.size(); ++v) {
        const machine::Resin* resin = printer.find_resin(printer.vats[v].resin);
        report.resins.push_back({printer.vats[v].resin, 0, twin.cured().left_ml()[v],
                                 twin.fluids().foreign_share(static_cast<int>(v)), twin.cured().overcure_mm3()[v],
                                 twin.cured().overcure_beyond_mm3()[v],
                                 resin != nullptr ? allowed_overcure_um(*resin) : 0});
    }
    for (const CuredLayer& layer : twin.cured().layers()) {
        for (const VatLayer& vat : layer.vats) {
            const auto light = static_cast<double>(light_of(vat.runs));
            report.resins[static_cast<std::size_t>(vat.vat)].cured_mm3 +=
                light / 255 * pixel_mm * pixel_mm * layer.thickness_um / 1000;
        }
    }
}

/// Collects findings; accepted ones do not fail the print.
class Verdict {
public:
    Verdict(Report& report, const Judgement& judgement) : report_(report), judgement_(judgement) {}

    [[nodiscard]] bool accepts(Finding::Kind kind) const {
        return std::find(judgement_.accepted.begin(), judgement_.accepted.end(), kind) != judgement_.accepted.end();
    }
    void add(Finding::Kind kind, std::string text) {
        const bool accepted = accepts(kind);
        if (!accepted) report_.reasons.push_back(text);
        report_.findings.push_back({kind, std::move(text), accepted});
    }
    /// `word`: what is counted, in the singular.
    void count(Finding::Kind kind, long n, std::string_view word, std::string_view what) {
        if (n > 0) add(kind, fmt::format("{} {}", counted(static_cast<std::size_t>(n), word), what));
    }

    void count_faults(const Twin& twin) {
        if (!judgement_.faults_must_occur) return;
        for (const std::string& fault : twin.missed_faults())
            add(Finding::Kind::fault, fmt::format("the fault {} did not occur", fault));
    }

private:
    Report& report_;
    const Judgement& judgement_;
};

/// Showing an image with `grey` or a mask rounds its pixels to whole values: less than this share of a material.
constexpr double shown_rounding = 0.01;

void judge_material(MaterialReport& m, bool exact_images, Verdict& verdict) {
    using Kind = Finding::Kind;
    // A larger difference means a job for another projector.
    if (!exact_images && std::abs(m.wanted_mm3 - m.asked_mm3) > shown_rounding * m.asked_mm3)
        verdict.add(Kind::image, fmt::format("{}: on this projector the images hold "
                                             "{:.3f} mm^3, the job says {:.3f} (grey, mask)",
                                             m.name, m.wanted_mm3, m.asked_mm3));
    const double off = m.model_mm3 > 0 ? std::abs(m.cured_mm3 - m.model_mm3) : 0;
    m.passed = off <= m.tolerance_mm3 && m.foreign_mm3 == 0 && m.missing_mm3 == 0;
    // A thin part's tolerance can exceed its volume.
    const bool nothing = m.model_mm3 > 0 && m.cured_mm3 == 0;
    m.passed = m.passed && !nothing;
    if (nothing)
        verdict.add(Kind::volume,
                    fmt::format("{}: nothing is printed, the model has {:.6g} mm^3", m.name, m.model_mm3));
    else if (off > m.tolerance_mm3)
        verdict.add(Kind::volume, fmt::format("{}: {:.3f} mm^3 cured, the model has {:.3f}, tolerance {:.3f}", m.name,
                                              m.cured_mm3, m.model_mm3, m.tolerance_mm3));
    if (m.foreign_mm3 > 0)
        verdict.add(Kind::foreign, fmt::format("{}: {:.6g} mm^3 cured in another resin", m.name, m.foreign_mm3));
    if (m.missing_mm3 > 0) verdict.add(Kind::missing, fmt::format("{}: {:.6g} mm^3 missing", m.name, m.missing_mm3));
}

void judge_materials(Report& report, const job::Manifest& job, const ImageKind& images, Verdict& verdict) {
    int layer_um = 0;
    for (const job::Layer& layer : job.layers) layer_um = std::max(layer_um, layer.thickness_um);
    const double border_um = border_error_um(job.pixel_um, images.grey, job.materials.size() > 1);
    for (std::size_t i = 0; i < job.materials.size(); ++i) {
        MaterialReport& m = report.materials[i];
        if (job.compensated) m.model_mm3 = m.asked_mm3;
        // Layer images have no drawn surface that explains a difference: only their rounding does.
        const double area_mm2 = job.materials[i].model_area_mm2;
        const double rounding = images.exact || area_mm2 > 0 ? 1e-9 : shown_rounding;
        m.tolerance_mm3 =
            rounding * m.model_mm3 + m.interface_mm3 + volume_tolerance_mm3(area_mm2, border_um, layer_um);
        judge_material(m, images.exact, verdict);
    }
}

void judge_overcure(Report& report, const job::Manifest& job, Verdict& verdict) {
    for (const ResinReport& resin : report.resins) {
        if (resin.overcure_beyond_mm3 <= 0) continue;
        verdict.add(
            Finding::Kind::overcure,
            fmt::format("{}: {:.3f} mm^3 cured more than {:.0f} um below undersides, at most {:.0f} um", resin.name,
                        resin.overcure_beyond_mm3, resin.allowed_overcure_um, report.deepest_overcure_um));
        if (verdict.accepts(Finding::Kind::overcure)) continue;
        const Cure::Place& place = report.deepest_overcure;
        const auto above = std::find_if(job.layers.begin(), job.layers.end(),
                                        [&](const job::Layer& layer) { return layer.z_um > place.z_um; });
        note_first(report, job, static_cast<int>(above - job.layers.begin()), -1,
                   fmt::format("{:.0f} um cured below the underside at row {}, column {} (exposure)",
                               report.deepest_overcure_um, place.row, place.column));
    }
}

/// Nothing holds what cures beside the platform.
void judge_edge(Report& report, Twin& twin, const job::Manifest& job, Verdict& verdict) {
    const job::PlatformEdge edge = machine::platform_edge(twin.printer());
    job::Beyond most;
    int first_um = 0;
    for (const CuredLayer& layer : twin.cured().layers()) {
        for (const VatLayer& vat : layer.vats) {
            for (const Run& run : vat.runs) most.merge(edge.beyond(run.row, run.begin, run.end));
        }
        if (most.um > 0 && first_um == 0) first_um = layer.top_um;
    }
    if (most.um <= 0) return;
    verdict.add(Finding::Kind::platform, "the part " + edge.text(most));
    const auto layer = std::find_if(job.layers.begin(), job.layers.end(), [&](auto& l) { return l.z_um == first_um; });
    note_first(report, job, static_cast<int>(layer - job.layers.begin()), -1, "cured beside the platform");
}

void judge(Report& report, Twin& twin, Verdict& verdict) {
    using Kind = Finding::Kind;
    if (report.layers == 0) verdict.add(Kind::missing, "nothing is printed");
    verdict.count(Kind::missing, report.missing_layers, "layer", "missing");
    verdict.count(Kind::height, report.stray_layers, "layer", "at heights where the job has none");
    verdict.count(Kind::height, report.wrong_thickness, "layer", "of the wrong thickness");
    verdict.count(Kind::missing, report.missing_pixels, "pixel", "with less of a resin than asked for");
    verdict.count(Kind::foreign, report.foreign_pixels, "pixel", "with another resin than asked for");
    verdict.count(Kind::stray, report.stray_pixels, "pixel", "with more of a resin than asked for");
    if (report.wrong_dose_pixels > 0)
        verdict.add(Kind::dose, fmt::format("{} lit longer or shorter than the job says: {:.3g} to {:.3g} times",
                                            counted(static_cast<std::size_t>(report.wrong_dose_pixels), "pixel"),
                                            report.least_dose, report.most_dose));
    verdict.count(Kind::image, report.wrong_images, "image", "with another area than the manifest states");
    verdict.count(Kind::dose, report.pixels_lit_twice, "pixel", "lit twice on one layer");
    verdict.count(Kind::dose, report.log.overlit_pixels, "pixel", "shown more light than a whole one needs (mask)");
    verdict.count(Kind::contamination, report.contaminated_layers, "layer",
                  "printed in a vat with more foreign resin than allowed");
    verdict.count(Kind::cleaning, report.log.short_cleanings, "swap", "with too little cleaning");
    for (const std::string& fault : twin.cured().faults()) verdict.add(Kind::light, fault);
    for (const std::string& violation : report.log.violations) verdict.add(Kind::interlock, "interlock: " + violation);
    verdict.count_faults(twin);
    report.passed = report.reasons.empty();
    if (!report.passed && report.first_deviation.empty()) report.first_deviation = report.reasons.front();
}

}  // namespace

double border_error_um(double pixel_um, bool grey, bool several_materials) {
    if (!grey) return pixel_um / 2;
    constexpr double closed_gap_um = 20;  // slice::ComposeRules
    const double rounding_um = std::numbers::sqrt2 * pixel_um / 510;
    return rounding_um + (several_materials ? std::min(closed_gap_um, pixel_um / 2) : 0);
}

double volume_tolerance_mm3(double area_mm2, double border_um, double layer_um) {
    return area_mm2 * std::hypot(layer_um / 2, border_um) / 1000;
}

Result<Report> inspect(Twin& twin, const job::Manifest& job, const RunSource& images, const Judgement& judgement) {
    Report report;
    for (const job::Material& m : job.materials)
        report.materials.push_back({m.name, m.resin, m.model_volume_mm3, 0, 0, 0, 0, 0, 0, 0, false});
    const Result<ImageKind> kind = inspect_layers(report, twin, job, images, judgement.light_slack_s);
    if (!kind) return tl::unexpected(kind.error());
    const Cure& cured = twin.cured();
    report.layers = static_cast<int>(cured.layers().size());
    report.pixels_lit_twice = std::max(0L, report.pixels_lit_twice + cured.pixels_lit_twice());
    report.deepest_overcure_um = cured.deepest_overcure_um();
    report.deepest_overcure = cured.deepest_overcure();
    report.log = twin.log();
    report.clock_s = twin.now();
    count_stray_layers(report, twin, job);
    Verdict verdict(report, judgement);
    judge_contamination(report, twin, job, verdict.accepts(Finding::Kind::contamination));
    measure_resins(report, twin);
    measure_solution(report, twin.fluids());
    const machine::Projector& projector = twin.printer().projector;
    report.trapped = trapped_resin(cured.layers(), projector.width_px, projector.height_px, projector.pixel_um);
    judge_materials(report, job, *kind, verdict);
    judge_overcure(report, job, verdict);
    judge_edge(report, twin, job, verdict);
    judge(report, twin, verdict);
    return report;
}

Result<Report> inspect(Twin& twin, const job::Manifest& job, const ImageSource& images, const Judgement& judgement) {
    const machine::Projector& projector = twin.printer().projector;
    const RunSource runs = [&](int layer, int material) -> Result<Runs> {
        const auto image = images(layer, material);
        if (!image) return tl::unexpected(image.error());
        if (image->width_px != projector.width_px || image->height_px != projector.height_px)
            return input_error("the image of layer {} is not of the projector's size", layer + 1);
        return runs_of(*image);
    };
    return inspect(twin, job, runs, judgement);
}

}  // namespace pliant::twin
