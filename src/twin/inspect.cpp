#include "twin/inspect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace pliant::twin {
namespace {

using Values = std::vector<int>;  ///< (height, width), sums of grey values

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

/// One layer of the job beside what cured there.
class LayerComparison {
public:
    LayerComparison(Report& report, Resins& resins, std::size_t pixels)
        : report_(report), resins_(resins), pixels_(pixels) {}

    void add_cured(const CuredLayer& layer, int width_px) {
        for (const VatLayer& vat : layer.vats) {
            Values& values = of(cured_, resins_.of_vat(vat.vat));
            for (const Run& run : vat.runs) {
                const auto begin = values.begin() + static_cast<std::ptrdiff_t>(run.row) * width_px;
                std::for_each(begin + run.begin, begin + run.end, [&](int& v) { v += run.value; });
            }
        }
    }

    /// Takes from the cured resin what the material's image asks for; the rest of the image is foreign or missing.
    void claim(int material, const job::Image& image, double voxel_mm3) {
        MaterialReport& m = report_.materials[static_cast<std::size_t>(material)];
        const int resin = resins_.number(m.resin);
        Values& lacking = of(wanted_, resin);
        Values& cured = of(cured_, resin);
        long long wanted = 0, right = 0;
        for (std::size_t i = 0; i < pixels_; ++i) {
            const int value = image.pixels[i];
            const int have = std::min(value, cured[i]);
            wanted += value;
            right += have;
            cured[i] -= have;
            lacking[i] += value - have;
        }
        m.wanted_mm3 += static_cast<double>(wanted) / 255 * voxel_mm3;
        m.cured_mm3 += static_cast<double>(right) / 255 * voxel_mm3;
        lacking_.emplace_back(material, wanted - right);
    }

    /// What no image claimed is wrong, and so is what was claimed in vain.
    void close(double voxel_mm3) {
        for (const auto& [material, lacking] : lacking_) {
            if (lacking == 0) continue;
            MaterialReport& m = report_.materials[static_cast<std::size_t>(material)];
            const double lost = static_cast<double>(lacking) / 255 * voxel_mm3;
            const double foreign =
                std::min(lost, static_cast<double>(foreign_light(resins_.number(m.resin))) / 255 * voxel_mm3);
            m.foreign_mm3 += foreign;
            m.missing_mm3 += lost - foreign;
        }
        for (const auto* values : {&wanted_, &cured_}) {
            for (const auto& [resin, sums] : *values) {
                report_.wrong_pixels += std::count_if(sums.begin(), sums.end(), [](int v) { return v != 0; });
            }
        }
    }

private:
    Values& of(std::map<int, Values>& values, int resin) {
        Values& v = values[resin];
        v.resize(pixels_);
        return v;
    }
    /// Grey values that other resins left over where this one is lacking.
    long long foreign_light(int resin) {
        long long light = 0;
        const Values& lacking = wanted_[resin];
        for (const auto& [other, left] : cured_) {
            if (other == resin) continue;
            for (std::size_t i = 0; i < pixels_; ++i) light += std::min(lacking[i], left[i]);
        }
        return light;
    }

    Report& report_;
    Resins& resins_;
    std::size_t pixels_;
    std::map<int, Values> wanted_, cured_;  ///< by resin: not yet found, not yet claimed
    std::vector<std::pair<int, long long>> lacking_;
};

const CuredLayer* layer_at(const std::vector<CuredLayer>& layers, int z_um) {
    const auto found =
        std::find_if(layers.begin(), layers.end(), [z_um](const CuredLayer& l) { return l.top_um == z_um; });
    return found == layers.end() ? nullptr : &*found;
}

Status compare_layers(Report& report, Twin& twin, const job::Manifest& job, const ImageSource& images) {
    const machine::Projector& projector = twin.printer().projector;
    const std::size_t pixels =
        static_cast<std::size_t>(projector.width_px) * static_cast<std::size_t>(projector.height_px);
    const double pixel_mm2 = projector.pixel_um * projector.pixel_um / 1e6;
    Resins resins(twin.printer());
    int below_um = 0;
    for (std::size_t i = 0; i < job.layers.size(); ++i) {
        const job::Layer& layer = job.layers[i];
        if (layer.images.empty()) continue;
        const CuredLayer* cured = layer_at(twin.cured().layers(), layer.z_um);
        const int thickness_um = layer.z_um - below_um;
        below_um = layer.z_um;
        if (cured == nullptr) ++report.missing_layers;
        if (cured != nullptr && cured->thickness_um != thickness_um) ++report.wrong_thickness;
        LayerComparison comparison(report, resins, pixels);
        if (cured != nullptr) comparison.add_cured(*cured, projector.width_px);
        const double voxel_mm3 = pixel_mm2 * (cured != nullptr ? cured->thickness_um : thickness_um) / 1000;
        for (const job::LayerImage& listed : layer.images) {
            const auto image = images(static_cast<int>(i), listed.material);
            if (!image) return tl::unexpected(image.error());
            if (image->pixels.size() != pixels) return input_error("{} is not of the projector's size", listed.file);
            comparison.claim(listed.material, *image, voxel_mm3);
        }
        comparison.close(voxel_mm3);
    }
    return {};
}

void count_stray_layers(Report& report, Twin& twin, const job::Manifest& job) {
    for (const CuredLayer& cured : twin.cured().layers()) {
        const bool wanted = std::any_of(job.layers.begin(), job.layers.end(), [&](const job::Layer& l) {
            return l.z_um == cured.top_um && !l.images.empty();
        });
        if (!wanted) ++report.stray_layers;
    }
}

void measure_resins(Report& report, Twin& twin) {
    const machine::Printer& printer = twin.printer();
    const double pixel_mm = printer.projector.pixel_um / 1000;
    for (std::size_t v = 0; v < printer.vats.size(); ++v) {
        report.resins.push_back({printer.vats[v].resin, 0, twin.cured().left_ml()[v]});
    }
    for (const CuredLayer& layer : twin.cured().layers()) {
        for (const VatLayer& vat : layer.vats) {
            double light = 0;
            for (const Run& run : vat.runs) light += static_cast<double>(run.value) * (run.end - run.begin);
            report.resins[static_cast<std::size_t>(vat.vat)].cured_mm3 +=
                light / 255 * pixel_mm * pixel_mm * layer.thickness_um / 1000;
        }
    }
}

void judge_materials(Report& report, const job::Manifest& job) {
    for (std::size_t i = 0; i < job.materials.size(); ++i) {
        const job::Material& drawn = job.materials[i];
        MaterialReport& m = report.materials[i];
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
    count(report.log.short_cleanings, "swaps with too little cleaning");
    count(report.log.resets, "resets of the controller");
    for (const std::string& fault : twin.cured().faults()) report.reasons.push_back(fault);
    for (const std::string& violation : report.log.violations) report.reasons.push_back("interlock: " + violation);
    report.passed = report.reasons.empty();
}

}  // namespace

Result<Report> inspect(Twin& twin, const job::Manifest& job, const ImageSource& images) {
    Report report;
    for (const job::Material& m : job.materials) {
        report.materials.push_back({m.name, m.resin, m.model_volume_mm3, 0, 0, 0, 0, 0, false});
    }
    if (Status status = compare_layers(report, twin, job, images); !status) return tl::unexpected(status.error());
    report.layers = static_cast<int>(twin.cured().layers().size());
    report.pixels_lit_twice = twin.cured().pixels_lit_twice();
    report.log = twin.log();
    report.clock_s = twin.now();
    count_stray_layers(report, twin, job);
    measure_resins(report, twin);
    judge_materials(report, job);
    judge(report, twin);
    return report;
}

}  // namespace pliant::twin
