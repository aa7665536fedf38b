#include "printing/twin/layer_inspection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "printing/twin/layer_comparison.hpp"

namespace pliant::twin {
namespace {

/// Numbers resins; vats with the same resin share a number, and so do materials.
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

/// Whether the layer is at another height, or missing.
std::string why_missing(Twin& twin, const job::Manifest& job, int z_um) {
    for (const CuredLayer& cured : twin.cured().layers()) {
        const bool wanted =
            std::any_of(job.layers.begin(), job.layers.end(), [&](auto& l) { return l.z_um == cured.top_um; });
        if (!wanted && std::abs(cured.top_um - z_um) <= cured.thickness_um)
            return fmt::format("cured at {} um instead of {} (platform height)", cured.top_um, z_um);
    }
    return fmt::format("nothing cured at {} um (exposure)", z_um);
}

/// Compares the layers of a job with those of the block.
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
    [[nodiscard]] ImageKind images() const { return {exact_images_, grey_}; }

private:
    Status layer(std::size_t index) {
        const job::Layer& layer = job_.layers[index];
        const int thickness_um = layer.z_um - below_um_;
        const CuredLayer* cured = layer_at(twin_.cured().layers(), layer.z_um);
        judge_height(static_cast<int>(index), cured, thickness_um);
        std::vector<ShownPicture> shown;
        if (cured != nullptr) {
            for (const VatLayer& vat : cured->vats) {
                for (const Lit& lit : vat.lit)
                    shown.push_back({resins_.of_vat(vat.vat), &lit.light, lit.seconds, lit.pieces});
            }
        }
        Result<std::vector<AskedImage>> asked = asked_of(index);
        if (!asked) return tl::unexpected(asked.error());
        const LayerDifference found = difference(*asked, shown, slack_s_);
        // After empty layers the gap is thicker than what the job asks for.
        const double asked_voxel_mm3 = pixel_mm2_ * layer.thickness_um / 1000;
        const double cured_voxel_mm3 = cured != nullptr ? pixel_mm2_ * cured->thickness_um / 1000 : 0;
        add_volumes(layer, found, asked_voxel_mm3, cured_voxel_mm3);
        add_interfaces(layer, *asked, asked_voxel_mm3);
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

    /// What the job's images and the manifest's times require, independent of the program.
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

    /// Pixels in several images may be exposed twice.
    void allow_shared(const std::vector<AskedImage>& asked) {
        std::vector<Runs> all;
        for (const AskedImage& image : asked) all.push_back(image.runs);
        for (const Run& run : sum_of(all, twin_.printer().projector.width_px)) {
            if (run.value > 255) report_.pixels_lit_twice -= run.end - run.begin;
        }
    }

    /// What the job wants is as thick as its layer, what has cured as thick as the gap was.
    void add_volumes(const job::Layer& layer, const LayerDifference& found, double asked_voxel_mm3,
                     double cured_voxel_mm3) {
        const auto volume_mm3 = [](long long light, double voxel_mm3) {
            return static_cast<double>(light) / 255 * voxel_mm3;
        };
        for (std::size_t k = 0; k < layer.images.size(); ++k) {
            const LayerDifference::OfImage& image = found.images[k];
            MaterialReport& m = report_.materials[static_cast<std::size_t>(layer.images[k].material)];
            m.asked_mm3 += layer.images[k].area_mm2 * layer.thickness_um / 1000;
            m.wanted_mm3 += volume_mm3(image.light, asked_voxel_mm3);
            m.cured_mm3 += volume_mm3(image.light - image.foreign - image.missing, cured_voxel_mm3);
            m.foreign_mm3 += volume_mm3(image.foreign, cured_voxel_mm3);
            m.missing_mm3 += volume_mm3(image.missing, asked_voxel_mm3);
        }
    }

    /// A pixel in which materials meet is exposed for the one that has most of it.
    void add_interfaces(const job::Layer& layer, const std::vector<AskedImage>& asked, double voxel_mm3) {
        const auto material = [&](std::size_t k) -> MaterialReport& {
            return report_.materials[static_cast<std::size_t>(layer.images[k].material)];
        };
        for (std::size_t k = 0; k < asked.size(); ++k) {
            for (std::size_t j = 0; j < k; ++j) {
                const double moved_mm3 =
                    0.5 * voxel_mm3 * static_cast<double>(common_sides(asked[j].runs, asked[k].runs));
                material(j).interface_mm3 += moved_mm3;
                material(k).interface_mm3 += moved_mm3;
            }
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

    /// With a corrected projector images hold light, which equals coverage only up to rounding: judge_materials adds it
    /// up.
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
    int below_um_ = 0;  ///< top of the previous layer
};

}  // namespace

void note_first(Report& report, const job::Manifest& job, int layer, int material, const std::string& what) {
    if (!report.first_deviation.empty()) return;
    const std::string who =
        material >= 0 ? fmt::format(", material \"{}\"", job.materials[static_cast<std::size_t>(material)].name) : "";
    report.first_deviation = fmt::format("layer {}{}: {}", layer + 1, who, what);
}

Result<ImageKind> inspect_layers(Report& report, Twin& twin, const job::Manifest& job, const RunSource& images,
                                 double light_slack_s) {
    LayerInspection layers(report, twin, job, images, light_slack_s);
    if (Status status = layers.run(); !status) return tl::unexpected(status.error());
    return layers.images();
}

}  // namespace pliant::twin
