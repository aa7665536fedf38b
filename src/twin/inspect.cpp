#include "twin/inspect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

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

/// What is to be in a layer, and what is: the images of the job and the runs that cured, row by row.
class LayerComparison {
public:
    LayerComparison(Report& report, Resins& resins, int width_px)
        : report_(report), resins_(resins), width_(static_cast<std::size_t>(width_px)) {}

    void add_cured(int vat, const Runs& runs) { sources_.push_back({-1, resins_.of_vat(vat), &runs, 0, 0}); }
    void add_wanted(int material, const std::string& resin, const Runs& runs) {
        sources_.push_back({material, resins_.number(resin), &runs, 0, 0});
    }

    /// Compares all rows; `voxel_mm3` is that of a fully lit pixel. Precondition: all of a layer has been added.
    void compare(double voxel_mm3) {
        for (int row = next_row(); row >= 0; row = next_row()) compare_row(row);
        for (const Source& s : sources_) {
            if (s.material < 0) continue;
            MaterialReport& m = report_.materials[static_cast<std::size_t>(s.material)];
            m.wanted_mm3 += static_cast<double>(light_of(*s.runs)) / 255 * voxel_mm3;
            const double lost = static_cast<double>(s.lacking) / 255 * voxel_mm3;
            m.cured_mm3 += static_cast<double>(light_of(*s.runs) - s.lacking) / 255 * voxel_mm3;
            const double foreign = std::min(lost, static_cast<double>(foreign_[s.resin]) / 255 * voxel_mm3);
            m.foreign_mm3 += foreign;
            m.missing_mm3 += lost - foreign;
            if (lost > 0) first_lost(s.material, foreign, lost - foreign);
        }
    }

    /// The first material of the layer that is not as it should be, and what is wrong; "" if all is well.
    [[nodiscard]] const std::string& first_wrong() const { return first_wrong_; }
    [[nodiscard]] int first_material() const { return first_material_; }

private:
    struct Source {
        int material = -1;  ///< -1: it cured
        int resin = 0;
        const Runs* runs = nullptr;
        std::size_t at = 0;
        long long lacking = 0;  ///< grey values that were wanted and not found
    };

    int next_row() const {
        int row = -1;
        for (const Source& s : sources_) {
            if (s.at < s.runs->size() && (row < 0 || (*s.runs)[s.at].row < row)) row = (*s.runs)[s.at].row;
        }
        return row;
    }

    std::vector<int>& of(std::map<int, std::vector<int>>& values, int resin) const {
        std::vector<int>& v = values[resin];
        v.resize(width_);
        return v;
    }

    /// Takes from the cured resins what the images ask for; what no image claimed is wrong, and what was claimed in
    /// vain.
    void compare_row(int row) {
        for (auto* values : {&cured_, &lacking_}) {
            for (auto& [resin, v] : *values) std::fill(v.begin(), v.end(), 0);
        }
        for (Source& s : sources_) {
            if (s.material >= 0) continue;
            std::vector<int>& cured = of(cured_, s.resin);
            for_row(s, row, [&](std::size_t x, int value) { cured[x] += value; });
        }
        for (Source& s : sources_) {
            if (s.material < 0) continue;
            std::vector<int>& cured = of(cured_, s.resin);
            std::vector<int>& lacking = of(lacking_, s.resin);
            for_row(s, row, [&](std::size_t x, int value) {
                const int have = std::min(value, cured[x]);
                cured[x] -= have;
                lacking[x] += value - have;
                s.lacking += value - have;
            });
        }
        for (const auto* values : {&lacking_, &cured_}) {
            for (const auto& [resin, v] : *values)
                report_.wrong_pixels += std::count_if(v.begin(), v.end(), [](int value) { return value != 0; });
        }
        for (const auto& [resin, lacking] : lacking_) {
            for (const auto& [other, left] : cured_) {
                if (other == resin) continue;
                for (std::size_t x = 0; x < width_; ++x) foreign_[resin] += std::min(lacking[x], left[x]);
            }
        }
    }

    template <class Each>
    static void for_row(Source& s, int row, Each each) {
        for (; s.at < s.runs->size() && (*s.runs)[s.at].row == row; ++s.at) {
            const Run& run = (*s.runs)[s.at];
            for (int x = run.begin; x < run.end; ++x) each(static_cast<std::size_t>(x), run.value);
        }
    }

    void first_lost(int material, double foreign, double missing) {
        if (!first_wrong_.empty()) return;
        first_material_ = material;
        first_wrong_ = foreign > missing ? fmt::format("{:.3f} mm^3 cured in another resin (vat change)", foreign)
                                         : fmt::format("{:.3f} mm^3 missing (exposure)", missing);
    }

    Report& report_;
    Resins& resins_;
    std::size_t width_;
    std::vector<Source> sources_;
    std::map<int, std::vector<int>> cured_, lacking_;  ///< by resin, of the row
    std::map<int, long long> foreign_;                 ///< by resin that lacks: others where it should be
    std::string first_wrong_;
    int first_material_ = -1;
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

double asked_s(const job::Manifest& job, int layer, int material) {
    const job::Material& m = job.materials[static_cast<std::size_t>(material)];
    return layer < job.bottom_layers ? m.bottom_exposure_s : m.exposure_s;
}

/// A light that was given in several pieces must be no more than one light: a doubled exposure shows here.
void count_too_long(Report& report, const CuredLayer& cured, const Runs& wanted, double seconds) {
    constexpr double most_share = 1.5;
    for (const VatLayer& vat : cured.vats) {
        for (const Lit& lit : vat.lit) {
            if (lit.pieces < 2 || lit.seconds <= most_share * seconds || lit.light != wanted) continue;
            for (const Run& run : lit.light) report.pixels_lit_twice += run.end - run.begin;
        }
    }
}

Status compare_layer(Report& report, Twin& twin, const job::Manifest& job, const RunSource& images, Resins& resins,
                     int index, int below_um) {
    const job::Layer& layer = job.layers[static_cast<std::size_t>(index)];
    const machine::Projector& projector = twin.printer().projector;
    const CuredLayer* cured = layer_at(twin.cured().layers(), layer.z_um);
    const int thickness_um = layer.z_um - below_um;
    if (cured == nullptr) {
        ++report.missing_layers;
        note_first(report, job, index, -1, why_missing(twin, job, layer.z_um));
    } else if (cured->thickness_um != thickness_um) {
        ++report.wrong_thickness;
        note_first(report, job, index, -1,
                   fmt::format("{} um thick instead of {} (platform height)", cured->thickness_um, thickness_um));
    }
    LayerComparison comparison(report, resins, projector.width_px);
    if (cured != nullptr) {
        for (const VatLayer& vat : cured->vats) comparison.add_cured(vat.vat, vat.runs);
    }
    std::vector<Runs> wanted;
    wanted.reserve(layer.images.size());
    bool shared = false;
    for (const job::LayerImage& listed : layer.images) {
        auto image = images(index, listed.material);
        if (!image) return tl::unexpected(image.error());
        wanted.push_back(twin.screen().coverage(*image).runs);
        shared = shared || listed.shared_mm2 > 0;
        report.materials[static_cast<std::size_t>(listed.material)].asked_mm3 +=
            listed.area_mm2 * layer.thickness_um / 1000;
        comparison.add_wanted(listed.material, job.materials[static_cast<std::size_t>(listed.material)].resin,
                              wanted.back());
        if (cured != nullptr) count_too_long(report, *cured, wanted.back(), asked_s(job, index, listed.material));
    }
    if (shared) {
        for (const Run& run : sum_of(wanted, projector.width_px)) {
            if (run.value > 255) report.pixels_lit_twice -= run.end - run.begin;
        }
    }
    const double pixel_mm2 = projector.pixel_um * projector.pixel_um / 1e6;
    const long wrong_before = report.wrong_pixels;
    comparison.compare(pixel_mm2 * (cured != nullptr ? cured->thickness_um : thickness_um) / 1000);
    if (!comparison.first_wrong().empty())
        note_first(report, job, index, comparison.first_material(), comparison.first_wrong());
    else if (report.wrong_pixels > wrong_before)
        note_first(report, job, index, -1, "pixels cured that no image asks for (exposure)");
    return {};
}

Status compare_layers(Report& report, Twin& twin, const job::Manifest& job, const RunSource& images) {
    Resins resins(twin.printer());
    int below_um = 0;
    for (std::size_t i = 0; i < job.layers.size(); ++i) {
        if (job.layers[i].images.empty()) continue;
        Status status = compare_layer(report, twin, job, images, resins, static_cast<int>(i), below_um);
        if (!status) return status;
        below_um = job.layers[i].z_um;
    }
    return {};
}

/// Foreign resin and what cleaning left, against what the machine allows.
void judge_contamination(Report& report, Twin& twin, const job::Manifest& job) {
    const double most = twin.printer().cleaning.most_contamination;
    for (const Contamination& c : twin.contamination()) {
        report.worst_foreign = std::max(report.worst_foreign, c.foreign);
        report.worst_residue = std::max(report.worst_residue, c.residue);
        if (most <= 0 || c.foreign <= most) continue;
        ++report.contaminated_layers;
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
        report.resins.push_back({printer.vats[v].resin, 0, twin.cured().left_ml()[v],
                                 twin.fluids().foreign_share(static_cast<int>(v)), twin.cured().overcure_mm3()[v]});
    }
    for (const CuredLayer& layer : twin.cured().layers()) {
        for (const VatLayer& vat : layer.vats) {
            const auto light = static_cast<double>(light_of(vat.runs));
            report.resins[static_cast<std::size_t>(vat.vat)].cured_mm3 +=
                light / 255 * pixel_mm * pixel_mm * layer.thickness_um / 1000;
        }
    }
}

void judge_materials(Report& report, const job::Manifest& job) {
    for (std::size_t i = 0; i < job.materials.size(); ++i) {
        const job::Material& drawn = job.materials[i];
        MaterialReport& m = report.materials[i];
        if (job.compensated) m.model_mm3 = m.asked_mm3;
        // Showing rounds grey to whole values; a job made for another projector is further off.
        if (std::abs(m.wanted_mm3 - m.asked_mm3) > 0.01 * m.asked_mm3)
            report.reasons.push_back(
                fmt::format("{}: on this projector the images hold {:.3f} mm^3, the job says {:.3f} (grey, mask)",
                            m.name, m.wanted_mm3, m.asked_mm3));
        m.tolerance_mm3 = 0.01 * drawn.model_volume_mm3 + drawn.model_area_mm2 * job.pixel_um / 2000;
        const double off = m.model_mm3 > 0 ? std::abs(m.cured_mm3 - m.model_mm3) : 0;
        m.passed = off <= m.tolerance_mm3 && m.foreign_mm3 == 0 && m.missing_mm3 == 0;
        if (off > m.tolerance_mm3) {
            report.reasons.push_back(fmt::format("{}: {:.3f} mm^3 cured, the model has {:.3f}, tolerance {:.3f}",
                                                 m.name, m.cured_mm3, m.model_mm3, m.tolerance_mm3));
        }
        if (m.foreign_mm3 > 0) {
            report.reasons.push_back(fmt::format("{}: {:.3f} mm^3 cured in another resin", m.name, m.foreign_mm3));
        }
        if (m.missing_mm3 > 0) report.reasons.push_back(fmt::format("{}: {:.3f} mm^3 missing", m.name, m.missing_mm3));
    }
}

void judge(Report& report, Twin& twin) {
    const auto count = [&](long n, std::string_view what) {
        if (n > 0) report.reasons.push_back(fmt::format("{} {}", n, what));
    };
    count(report.missing_layers, "layers missing");
    count(report.stray_layers, "layers at heights where the job has none");
    count(report.wrong_thickness, "layers of the wrong thickness");
    count(report.wrong_pixels, "pixels with more or less of a resin than asked for");
    count(report.pixels_lit_twice, "pixels lit twice on one layer");
    count(report.log.overlit_pixels, "pixels shown more light than a whole one needs (mask)");
    count(report.contaminated_layers, "layers printed in a vat with more foreign resin than allowed");
    count(report.log.short_cleanings, "swaps with too little cleaning");
    for (const std::string& fault : twin.cured().faults()) report.reasons.push_back(fault);
    for (const std::string& violation : report.log.violations) report.reasons.push_back("interlock: " + violation);
    report.passed = report.reasons.empty();
    if (!report.passed && report.first_deviation.empty()) report.first_deviation = report.reasons.front();
}

}  // namespace

Result<Report> inspect(Twin& twin, const job::Manifest& job, const RunSource& images) {
    Report report;
    for (const job::Material& m : job.materials) {
        report.materials.push_back({m.name, m.resin, m.model_volume_mm3, 0, 0, 0, 0, 0, 0, false});
    }
    if (Status status = compare_layers(report, twin, job, images); !status) return tl::unexpected(status.error());
    report.layers = static_cast<int>(twin.cured().layers().size());
    report.pixels_lit_twice = std::max(0L, report.pixels_lit_twice + twin.cured().pixels_lit_twice());
    report.deepest_overcure_um = twin.cured().deepest_overcure_um();
    report.log = twin.log();
    report.clock_s = twin.now();
    count_stray_layers(report, twin, job);
    judge_contamination(report, twin, job);
    measure_resins(report, twin);
    const machine::Projector& projector = twin.printer().projector;
    report.trapped = trapped_resin(twin.cured().layers(), projector.width_px, projector.height_px, projector.pixel_um);
    judge_materials(report, job);
    judge(report, twin);
    return report;
}

Result<Report> inspect(Twin& twin, const job::Manifest& job, const ImageSource& images) {
    const machine::Projector& projector = twin.printer().projector;
    return inspect(twin, job, RunSource([&](int layer, int material) -> Result<Runs> {
                       const auto image = images(layer, material);
                       if (!image) return tl::unexpected(image.error());
                       if (image->width_px != projector.width_px || image->height_px != projector.height_px)
                           return input_error("the image of layer {} is not of the projector's size", layer);
                       return runs_of(*image);
                   }));
}

}  // namespace pliant::twin
