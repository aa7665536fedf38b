#include "twin/inspect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "twin/layer_comparison.hpp"

namespace pliant::twin {
namespace {

/// Resins by number; vats of the same resin are one, and so are materials.
class Resins {
public:
    explicit Resins(const machine::Printer& printer) {
        for (const machine::Vat& vat : printer.vats) of_vat_.push_back(number(vat.resin));
    }
    int number(const std::string& name) {
        const auto found = std::find(names_.begin(), names_.end(), name);
        if (found != names_.end()) return static_cast<int>(found - names_.begin());
        names_.push_back(name);
        return static_cast<int>(names_.size()) - 1;
    }
    [[nodiscard]] int of_vat(int vat) const { return of_vat_[static_cast<std::size_t>(vat)]; }

private:
    std::vector<std::string> names_;
    std::vector<int> of_vat_;
};

const CuredLayer* layer_at(const std::vector<CuredLayer>& layers, int z_um) {
    const auto found =
        std::find_if(layers.begin(), layers.end(), [z_um](const CuredLayer& l) { return l.top_um == z_um; });
    return found == layers.end() ? nullptr : &*found;
}

/// Names the first deviation of the print; later ones change nothing.
void note_first(Report& report, const job::Manifest& job, int layer, int material, const std::string& what) {
    if (!report.first_deviation.empty()) return;
    const std::string who =
        material >= 0 ? fmt::format(", material \"{}\"", job.materials[static_cast<std::size_t>(material)].name) : "";
    report.first_deviation = fmt::format("layer {}{}: {}", layer, who, what);
}

/// Whether the layer is somewhere else, or nowhere.
std::string why_missing(Twin& twin, const job::Manifest& job, int z_um) {
    for (const CuredLayer& cured : twin.cured().layers()) {
        const bool wanted =
            std::any_of(job.layers.begin(), job.layers.end(), [&](auto& l) { return l.z_um == cured.top_um; });
        if (!wanted && std::abs(cured.top_um - z_um) <= cured.thickness_um)
            return fmt::format("cured at {} um instead of {} (platform height)", cured.top_um, z_um);
    }
    return fmt::format("nothing cured at {} um (exposure)", z_um);
}

/// The layers of a job beside those of the block.
class LayerInspection {
public:
    LayerInspection(Report& report, Twin& twin, const job::Manifest& job, const RunSource& images, double slack_s)
        : report_(report), twin_(twin), job_(job), images_(images), slack_s_(slack_s), resins_(twin.printer()) {
        const machine::Projector& projector = twin.printer().projector;
        pixel_mm2_ = projector.pixel_um * projector.pixel_um / 1e6;
        exact_images_ = !twin.screen().corrects() && projector.mask.empty();
    }

    Status run() {
        for (std::size_t i = 0; i < job_.layers.size(); ++i) {
            if (job_.layers[i].images.empty()) continue;
            if (Status status = layer(i); !status) return status;
            below_um_ = job_.layers[i].z_um;
        }
        return {};
    }
    /// Whether any image has pixels that are neither full nor dark.
    [[nodiscard]] bool grey() const { return grey_; }
    /// Whether an image's pixels are its coverage.
    [[nodiscard]] bool exact_images() const { return exact_images_; }

private:
    Status layer(std::size_t index) {
        const job::Layer& layer = job_.layers[index];
        const int thickness_um = layer.z_um - below_um_;
        const CuredLayer* cured = layer_at(twin_.cured().layers(), layer.z_um);
        judge_height(static_cast<int>(index), cured, thickness_um);
        std::vector<ShownPicture> shown;
        if (cured != nullptr) {
            for (const VatLayer& vat : cured->vats) {
                for (const Lit& lit : vat.lit) shown.push_back({resins_.of_vat(vat.vat), &lit.light, lit.seconds});
            }
        }
        Result<std::vector<AskedImage>> asked = asked_of(index);
        if (!asked) return tl::unexpected(asked.error());
        const LayerDifference found = difference(*asked, shown, slack_s_);
        add_volumes(layer, found, pixel_mm2_ * (cured != nullptr ? cured->thickness_um : thickness_um) / 1000);
        add_pixels(found);
        note_difference(static_cast<int>(index), found);
        judge_areas(static_cast<int>(index), found);
        return {};
    }

    void judge_height(int index, const CuredLayer* cured, int thickness_um) {
        if (cured == nullptr) {
            ++report_.missing_layers;
            note_first(report_, job_, index, -1,
                       why_missing(twin_, job_, job_.layers[static_cast<std::size_t>(index)].z_um));
        } else if (cured->thickness_um != thickness_um) {
            ++report_.wrong_thickness;
            note_first(report_, job_, index, -1,
                       fmt::format("{} um thick instead of {} (platform height)", cured->thickness_um, thickness_um));
        }
    }

    /// What the job's images and the manifest's times ask for, whatever the program did with them.
    Result<std::vector<AskedImage>> asked_of(std::size_t index) {
        const job::Layer& layer = job_.layers[index];
        std::vector<AskedImage> asked;
        asked.reserve(layer.images.size());
        bool shared = false;
        for (std::size_t k = 0; k < layer.images.size(); ++k) {
            const job::LayerImage& listed = layer.images[k];
            Result<Runs> image = images_(static_cast<int>(index), listed.material);
            if (!image) return tl::unexpected(image.error());
            const std::string& resin = job_.materials[static_cast<std::size_t>(listed.material)].resin;
            asked.push_back(
                {resins_.number(resin), twin_.screen().coverage(*image).runs, job::exposure_s(job_, index, k)});
            const Runs& runs = asked.back().runs;
            grey_ = grey_ || std::any_of(runs.begin(), runs.end(), [](const Run& run) { return run.value != 255; });
            shared = shared || listed.shared_mm2 > 0;
        }
        if (shared) allow_shared(asked);
        return asked;
    }

    /// Pixels that several images ask for are to be lit twice.
    void allow_shared(const std::vector<AskedImage>& asked) {
        std::vector<Runs> all;
        for (const AskedImage& image : asked) all.push_back(image.runs);
        for (const Run& run : sum_of(all, twin_.printer().projector.width_px)) {
            if (run.value > 255) report_.pixels_lit_twice -= run.end - run.begin;
        }
    }

    void add_volumes(const job::Layer& layer, const LayerDifference& found, double voxel_mm3) {
        for (std::size_t k = 0; k < layer.images.size(); ++k) {
            const LayerDifference::OfImage& image = found.images[k];
            MaterialReport& m = report_.materials[static_cast<std::size_t>(layer.images[k].material)];
            const auto volume_mm3 = [&](long long light) { return static_cast<double>(light) / 255 * voxel_mm3; };
            m.asked_mm3 += layer.images[k].area_mm2 * layer.thickness_um / 1000;
            m.wanted_mm3 += volume_mm3(image.light);
            m.cured_mm3 += volume_mm3(image.light - image.foreign - image.missing);
            m.foreign_mm3 += volume_mm3(image.foreign);
            m.missing_mm3 += volume_mm3(image.missing);
        }
    }

    void add_pixels(const LayerDifference& found) {
        report_.wrong_pixels += found.wrong_px;
        report_.missing_pixels += found.missing_px;
        report_.foreign_pixels += found.foreign_px;
        report_.stray_pixels += found.stray_px;
        report_.wrong_dose_pixels += found.wrong_dose_px;
        report_.least_dose = std::min(report_.least_dose, found.least_share);
        report_.most_dose = std::max(report_.most_dose, found.most_share);
    }

    void note_difference(int index, const LayerDifference& found) {
        const job::Layer& layer = job_.layers[static_cast<std::size_t>(index)];
        for (std::size_t k = 0; k < layer.images.size(); ++k) {
            const LayerDifference::OfImage& image = found.images[k];
            if (image.foreign == 0 && image.missing == 0) continue;
            const bool foreign = image.foreign > image.missing;
            return note_first(
                report_, job_, index, layer.images[k].material,
                fmt::format("{:.1f} pixels {}", static_cast<double>(foreign ? image.foreign : image.missing) / 255,
                            foreign ? "cured in another resin (vat change)" : "missing (exposure)"));
        }
        if (found.wrong_px > 0)
            note_first(report_, job_, index, -1, "pixels cured that no image asks for (exposure)");
        else if (found.wrong_dose_px > 0)
            note_first(report_, job_, index, -1,
                       fmt::format("{} pixels lit {} times as long as the job says (exposure)", found.wrong_dose_px,
                                   share_text(found)));
    }

    static std::string share_text(const LayerDifference& found) {
        const bool longer = found.most_share - 1 >= 1 - found.least_share;
        return fmt::format("{:.3g}", longer ? found.most_share : found.least_share);
    }

    /// Images of a corrected projector hold light, which is coverage to a rounding: judge_materials adds them up.
    void judge_areas(int index, const LayerDifference& found) {
        if (!exact_images_) return;
        const job::Layer& layer = job_.layers[static_cast<std::size_t>(index)];
        const double pixel_mm2 = job_.pixel_um * job_.pixel_um / 1e6;
        for (std::size_t k = 0; k < layer.images.size(); ++k) {
            const double stated_px = layer.images[k].area_mm2 / pixel_mm2;
            const double held_px = static_cast<double>(found.images[k].light) / 255;
            constexpr double half_grey = 0.5 / 255;
            if (std::abs(held_px - stated_px) <= half_grey + 1e-12 * stated_px) continue;
            const std::string text =
                fmt::format("the image holds {:.2f} pixels, the manifest says {:.2f} (image)", held_px, stated_px);
            if (++report_.wrong_images == 1) note_first(report_, job_, index, layer.images[k].material, text);
        }
    }

    Report& report_;
    Twin& twin_;
    const job::Manifest& job_;
    const RunSource& images_;
    double slack_s_;
    Resins resins_;
    double pixel_mm2_ = 0;
    bool exact_images_ = true;
    bool grey_ = false;
    int below_um_ = 0;  ///< top of the layer before
};

/// Foreign resin and what cleaning left, against what the machine allows.
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
                               twin.printer().vats[static_cast<std::size_t>(c.vat)].slot));
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

/// Collects findings; an accepted one does not count.
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
    void count(Finding::Kind kind, long n, std::string_view what) {
        if (n > 0) add(kind, fmt::format("{} {}", n, what));
    }

private:
    Report& report_;
    const Judgement& judgement_;
};

void judge_material(MaterialReport& m, bool exact_images, Verdict& verdict) {
    using Kind = Finding::Kind;
    // Showing rounds grey to whole values; a job made for another projector is further off.
    if (!exact_images && std::abs(m.wanted_mm3 - m.asked_mm3) > 0.01 * m.asked_mm3)
        verdict.add(Kind::image, fmt::format("{}: on this projector the images hold {:.3f} mm^3, the job says {:.3f} "
                                             "(grey, mask)",
                                             m.name, m.wanted_mm3, m.asked_mm3));
    const double off = m.model_mm3 > 0 ? std::abs(m.cured_mm3 - m.model_mm3) : 0;
    m.passed = off <= m.tolerance_mm3 && m.foreign_mm3 == 0 && m.missing_mm3 == 0;
    if (off > m.tolerance_mm3)
        verdict.add(Kind::volume, fmt::format("{}: {:.3f} mm^3 cured, the model has {:.3f}, tolerance {:.3f}", m.name,
                                              m.cured_mm3, m.model_mm3, m.tolerance_mm3));
    if (m.foreign_mm3 > 0)
        verdict.add(Kind::foreign, fmt::format("{}: {:.6f} mm^3 cured in another resin", m.name, m.foreign_mm3));
    if (m.missing_mm3 > 0) verdict.add(Kind::missing, fmt::format("{}: {:.6f} mm^3 missing", m.name, m.missing_mm3));
}

void judge_materials(Report& report, const job::Manifest& job, bool exact_images, bool grey, Verdict& verdict) {
    int layer_um = 0;
    for (const job::Layer& layer : job.layers) layer_um = std::max(layer_um, layer.thickness_um);
    const double border_um = border_error_um(job.pixel_um, grey, job.materials.size() > 1);
    for (std::size_t i = 0; i < job.materials.size(); ++i) {
        MaterialReport& m = report.materials[i];
        if (job.compensated) m.model_mm3 = m.asked_mm3;
        constexpr double rounding = 1e-9;
        m.tolerance_mm3 =
            rounding * m.model_mm3 + volume_tolerance_mm3(job.materials[i].model_area_mm2, border_um, layer_um);
        judge_material(m, exact_images, verdict);
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

void judge(Report& report, Twin& twin, Verdict& verdict) {
    using Kind = Finding::Kind;
    verdict.count(Kind::missing, report.missing_layers, "layers missing");
    verdict.count(Kind::height, report.stray_layers, "layers at heights where the job has none");
    verdict.count(Kind::height, report.wrong_thickness, "layers of the wrong thickness");
    verdict.count(Kind::missing, report.missing_pixels, "pixels with less of a resin than asked for");
    verdict.count(Kind::foreign, report.foreign_pixels, "pixels with another resin than asked for");
    verdict.count(Kind::stray, report.stray_pixels, "pixels with more of a resin than asked for");
    if (report.wrong_dose_pixels > 0)
        verdict.add(Kind::dose, fmt::format("{} pixels lit longer or shorter than the job says: {:.3g} to {:.3g} times",
                                            report.wrong_dose_pixels, report.least_dose, report.most_dose));
    verdict.count(Kind::image, report.wrong_images, "images that have not the area which the manifest states");
    verdict.count(Kind::dose, report.pixels_lit_twice, "pixels lit twice on one layer");
    verdict.count(Kind::dose, report.log.overlit_pixels, "pixels shown more light than a whole one needs (mask)");
    verdict.count(Kind::contamination, report.contaminated_layers,
                  "layers printed in a vat with more foreign resin than allowed");
    verdict.count(Kind::cleaning, report.log.short_cleanings, "swaps with too little cleaning");
    for (const std::string& fault : twin.cured().faults()) verdict.add(Kind::light, fault);
    for (const std::string& violation : report.log.violations) verdict.add(Kind::interlock, "interlock: " + violation);
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
        report.materials.push_back({m.name, m.resin, m.model_volume_mm3, 0, 0, 0, 0, 0, 0, false});
    LayerInspection layers(report, twin, job, images, judgement.light_slack_s);
    if (Status status = layers.run(); !status) return tl::unexpected(status.error());
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
    const machine::Projector& projector = twin.printer().projector;
    report.trapped = trapped_resin(cured.layers(), projector.width_px, projector.height_px, projector.pixel_um);
    judge_materials(report, job, layers.exact_images(), layers.grey(), verdict);
    judge_overcure(report, job, verdict);
    judge(report, twin, verdict);
    return report;
}

Result<Report> inspect(Twin& twin, const job::Manifest& job, const ImageSource& images, const Judgement& judgement) {
    const machine::Projector& projector = twin.printer().projector;
    const RunSource runs = [&](int layer, int material) -> Result<Runs> {
        const auto image = images(layer, material);
        if (!image) return tl::unexpected(image.error());
        if (image->width_px != projector.width_px || image->height_px != projector.height_px)
            return input_error("the image of layer {} is not of the projector's size", layer);
        return runs_of(*image);
    };
    return inspect(twin, job, runs, judgement);
}

}  // namespace pliant::twin
