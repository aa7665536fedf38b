#include "printing/prepare/make_job.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "base/core/parallel.hpp"
#include "base/core/text.hpp"
#include "printing/job/image_volumes.hpp"
#include "printing/plan/plan.hpp"
#include "printing/prepare/finding_pictures.hpp"
#include "printing/prepare/printed_together.hpp"
#include "printing/prepare/thumbnail.hpp"
#include "printing/slice/inspect.hpp"
#include "printing/slice/layer_text.hpp"
#include "printing/slice/thin.hpp"

namespace pliant::job {
namespace {

/// One layer on its way from the slicer to the archive.
struct Prepared {
    slice::SlicedLayer sliced;         ///< its images without their runs, which are already encoded
    std::vector<EncodedImage> images;  ///< parallel to sliced.images
    slice::LayerShape shape;
    std::vector<slice::ThinSpot> thin;
    std::vector<Thumbnail::Spot> seen;       ///< for the thumbnail
    std::map<int, std::int64_t> drawn_sums;  ///< sum of pixel values, by drawn material
    std::vector<std::int64_t> dark_sums;     ///< parallel to sliced.images: what the projector's mask takes away
    bool lit = false;                        ///< whether any pixel is, behind the mask
};

/// The source of layers, with an image per drawn material. `layer` is called from any thread; layers in [0, count).
struct LayerSource {
    int count = 0;
    std::function<Result<slice::SlicedLayer>(int)> layer;
    std::vector<int> printed_as;  ///< (drawn materials), index into the job's
    bool parallel = true;
};

/// No image lights anything beside the platform.
Status check_light(const slice::SlicedLayer& layer, const JobSettings& settings, int k) {
    if (!settings.edge) return {};
    for (const slice::MaterialImage& m : layer.images) {
        const Beyond beyond = settings.edge->beyond(m.image);
        if (beyond.um > 0) return input_error("{}: light {}", slice::layer_text(k), settings.edge->text(beyond));
    }
    return {};
}

Result<Prepared> prepare_layer(const LayerSource& source, const JobSettings& settings, const Thumbnail& thumbnail,
                               int k) {
    auto sliced = source.layer(k);
    if (!sliced) return tl::unexpected(sliced.error());
    if (Status status = check_light(*sliced, settings, k); !status) return tl::unexpected(status.error());
    Prepared prepared{std::move(*sliced), {}, {}, {}, {}, {}, {}};
    for (const slice::MaterialImage& m : prepared.sliced.images) prepared.drawn_sums[m.material] = m.value_sum;
    put_together(prepared.sliced, source.printed_as);
    prepared.shape = slice::shape_of(prepared.sliced, settings.slicing.raster.width_px);
    prepared.thin = thin_spots(prepared.sliced, k, settings.least_feature_um, settings.slicing.raster);
    prepared.seen = thumbnail.row(prepared.sliced);
    for (slice::MaterialImage& m : prepared.sliced.images) {
        prepared.dark_sums.push_back(darkened_sum(m.image, settings.light));
        const slice::RunImage shown = settings.light.none() ? std::move(m.image) : corrected(m.image, settings.light);
        prepared.lit = prepared.lit || !shown.blank();
        prepared.images.push_back(encode(shown));
        m.image = {};
    }
    return prepared;
}

Result<Material> find_material(const std::vector<Material>& known, const std::string& name) {
    const auto found = std::find_if(known.begin(), known.end(), [&](const Material& m) { return m.name == name; });
    if (found == known.end()) return input_error("material \"{}\" has no resin and exposure", name);
    return *found;
}

Result<std::vector<Material>> used_materials(const slice::Slicer& slicer, const std::vector<Material>& known) {
    std::vector<Material> used;
    for (const std::string& name : slicer.materials()) {
        const Result<Material> found = find_material(known, name);
        if (!found) return tl::unexpected(found.error());
        used.push_back(*found);
        used.back().model_volume_mm3 = used.back().model_area_mm2 = 0;
    }
    return used;
}

/// Adds to a material, and to its part that was drawn under this name.
void add_drawn(const std::string& name, double volume_mm3, double area_mm2, std::vector<Material>& materials) {
    for (Material& m : materials) {
        const auto part =
            std::find_if(m.parts.begin(), m.parts.end(), [&](const MaterialPart& p) { return p.name == name; });
        if (m.parts.empty() ? m.name != name : part == m.parts.end()) continue;
        m.model_volume_mm3 += volume_mm3;
        m.model_area_mm2 += area_mm2;
        if (part == m.parts.end()) continue;
        part->model_volume_mm3 += volume_mm3;
        part->model_area_mm2 += area_mm2;
    }
}

/// The drawn amount of each material: volumes minus air and what other bodies keep, those of a blend as divided.
void measure(std::span<const slice::Body> bodies, const slice::Slicer& slicer, const slice::Summary& summary,
             std::vector<Material>& materials) {
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const slice::Measures& drawn = slicer.measures()[b];
        const double taken_mm3 = summary.lost_mm3[b] + summary.doubled_mm3[b] + summary.air_mm3[b];
        const double volume_mm3 = std::max(0.0, drawn.volume_mm3 - taken_mm3);
        const double second = summary.second_share[b];
        add_drawn(bodies[b].material, volume_mm3 * (1 - second), drawn.area_mm2, materials);
        if (bodies[b].blend) add_drawn(bodies[b].blend->second, volume_mm3 * second, drawn.area_mm2, materials);
    }
}

/// The materials' names in file names: unique even if they differ only in replaced characters.
std::vector<std::string> file_words(const std::vector<Material>& materials) {
    std::vector<std::string> words;
    std::set<std::string> taken;
    for (std::size_t i = 0; i < materials.size(); ++i) {
        std::string word = materials[i].name;
        for (std::size_t n = i; !taken.insert(image_file_name(0, word)).second; ++n)
            word = fmt::format("{}_{}", materials[i].name.substr(0, 80), n);
        words.push_back(word);
    }
    return words;
}

/// The exposure of an image if it differs from its material's; else 0.
double own_exposure_s(const JobSettings& settings, const Material& material, int k, int thickness_um) {
    const auto rule = settings.exposures.find(material.parts.empty() ? material.name : material.parts.front().name);
    if (rule == settings.exposures.end()) return 0;
    const double seconds = exposure_s(material, rule->second, k, thickness_um);
    const double usual =
        k < material.bottom_layers.value_or(settings.bottom_layers) ? material.bottom_exposure_s : material.exposure_s;
    return seconds == usual ? 0 : seconds;
}

/// Thicker layers get longer exposures, thinner ones shorter ones.
Status check_exposure(const JobSettings& settings, const Material& material, int k, int thickness_um) {
    const auto rule = settings.exposures.find(material.parts.empty() ? material.name : material.parts.front().name);
    if (rule == settings.exposures.end()) return {};
    const double seconds = exposure_s(material, rule->second, k, thickness_um);
    if (seconds < shortest_exposure_s)
        return input_error("material \"{}\": {}, {} um thick, needs an exposure of less than a millisecond",
                           material.name, slice::layer_text(k), thickness_um);
    if (seconds <= settings.most_exposure_s) return {};
    const double thickest_um =
        std::floor(thickness_um + rule->second.penetration_um * std::log(settings.most_exposure_s / seconds));
    const std::string allowed = rule->second.penetration_um > 0 && thickest_um >= 1
                                    ? fmt::format(", which allows layers of up to {:.0f} um", thickest_um)
                                    : std::string();
    return input_error("material \"{}\": {}, {} um thick, needs an exposure of {:.4g} s; the limit of {} is {:g} s{}",
                       material.name, slice::layer_text(k), thickness_um, seconds, settings.printer,
                       settings.most_exposure_s, allowed);
}

Result<Layer> store(Prepared& prepared, int k, const Manifest& manifest, const std::vector<std::string>& words,
                    const JobSettings& settings, const slice::Layers& layers, Writer& writer) {
    const double value_mm2 = manifest.pixel_um * manifest.pixel_um / 1e6 / 255;
    Layer layer{layers.top_um(k), layers.thickness_um(k), {}};
    for (std::size_t i = 0; i < prepared.images.size(); ++i) {
        const slice::MaterialImage& m = prepared.sliced.images[i];
        const std::string file = image_file_name(k, words[m.material]);
        const Material& material = manifest.materials[m.material];
        if (auto status = check_exposure(settings, material, k, layer.thickness_um); !status)
            return tl::unexpected(status.error());
        if (auto status = writer.add_image(file, std::move(prepared.images[i])); !status)
            return tl::unexpected(status.error());
        layer.images.push_back({m.material, file, static_cast<double>(m.value_sum) * value_mm2,
                                own_exposure_s(settings, material, k, layer.thickness_um),
                                static_cast<double>(m.shared_sum) * value_mm2});
    }
    return layer;
}

/// One layer of several stacks. A pixel goes entirely to the brightest material, on a tie to the later one.
Result<slice::SlicedLayer> stacked_layer(std::span<const MaterialStack> stacks, int k) {
    std::vector<slice::Image> images(stacks.size());
    slice::SlicedLayer layer;
    layer.lost_px.assign(stacks.size(), 0.0);
    for (std::size_t i = 0; i < stacks.size(); ++i) {
        if (k >= stacks[i].stack.layer_count()) continue;
        auto image = stacks[i].stack.image(k);
        if (!image) return tl::unexpected(image.error());
        images[i] = std::move(*image);
    }
    for (std::size_t i = 0; i < images.size(); ++i) {
        for (std::size_t j = i + 1; j < images.size(); ++j) {
            auto &a = images[i].pixels, &b = images[j].pixels;
            for (std::size_t p = 0; p < std::min(a.size(), b.size()); ++p) {
                if (a[p] == 0 || b[p] == 0) continue;
                const int both = a[p] + b[p];
                const bool later = b[p] >= a[p];
                layer.lost_px[later ? i : j] += std::max(0, both - 255) / 255.0;
                (later ? b[p] : a[p]) = static_cast<std::uint8_t>(std::min(255, both));
                (later ? a[p] : b[p]) = 0;
            }
        }
    }
    for (std::size_t i = 0; i < images.size(); ++i) {
        if (images[i].pixels.empty()) continue;
        slice::RunImage runs = slice::RunImage::from_image(images[i]);
        const std::int64_t sum = runs.value_sum();
        if (sum > 0) layer.images.push_back({static_cast<int>(i), std::move(runs), sum, 0});
    }
    return layer;
}

std::vector<std::size_t> layers_of(const Manifest& manifest, int material) {
    std::vector<std::size_t> layers;
    for (std::size_t k = 0; k < manifest.layers.size(); ++k) {
        for (const LayerImage& image : manifest.layers[k].images) {
            if (image.material == material) layers.push_back(k);
        }
    }
    return layers;
}

/// Notes materials that cost swaps for very little volume.
void note_rare_materials(Manifest& manifest) {
    constexpr std::size_t few = 3;
    for (std::size_t m = 0; manifest.materials.size() > 1 && m < manifest.materials.size(); ++m) {
        const std::vector<std::size_t> layers = layers_of(manifest, static_cast<int>(m));
        if (!layers.empty() && layers.size() <= few && manifest.layers.size() > 10 * few)
            manifest.warnings.push_back(fmt::format("material \"{}\" occurs in {} of {} layers only, the first is {}",
                                                    manifest.materials[m].name, layers.size(), manifest.layers.size(),
                                                    slice::layer_text(static_cast<int>(layers.front()))));
    }
}

/// Notes a difference of more than `tolerance` of the drawn volume; none is known of layer images.
void note_difference(const std::string& of, double lit_mm3, double drawn_mm3, double tolerance, Manifest& manifest) {
    if (drawn_mm3 > 0 && std::fabs(lit_mm3 - drawn_mm3) > tolerance * drawn_mm3)
        manifest.warnings.push_back(fmt::format("the images{} hold {:.6g} mm^3, the bodies {:.6g} mm^3: {:+.2f} %", of,
                                                lit_mm3, drawn_mm3, 100 * (lit_mm3 / drawn_mm3 - 1)));
}

/// The images must contain the drawn volume, unless outlines were compensated. Where materials meet, whole pixels
/// belong to one of them, so each may differ by more than all together.
void note_volumes(Manifest& manifest) {
    constexpr double tolerance = 1e-3, tolerance_of_material = 1e-2;
    if (manifest.compensated) return;
    const std::vector<double> lit_mm3 = image_volumes_mm3(manifest);
    double lit = 0, drawn = 0;
    for (std::size_t m = 0; m < lit_mm3.size(); ++m) {
        const Material& material = manifest.materials[m];
        lit += lit_mm3[m];
        drawn += material.model_volume_mm3;
        if (lit_mm3.size() > 1)
            note_difference(fmt::format(" of material \"{}\"", material.name), lit_mm3[m], material.model_volume_mm3,
                            tolerance_of_material, manifest);
    }
    note_difference("", lit, drawn, tolerance, manifest);
}

void note_thin(const std::vector<slice::ThinSpot>& thin, const JobSettings& settings, Manifest& manifest) {
    std::vector<std::string> names;
    for (const Material& m : manifest.materials) names.push_back(m.name);
    for (std::string& line : describe(thin, names, settings.least_feature_um, settings.slicing.raster))
        manifest.warnings.push_back(std::move(line));
}

void note_pieces(std::size_t pieces, const JobSettings& settings, Manifest& manifest) {
    if (static_cast<int>(pieces) <= settings.copies) return;
    const std::string items = settings.items < 2
                                  ? ""
                                  : fmt::format(
                                        ". The 3MF file has {} items, which are printed where they stand in it: "
                                        "move together there what is one part, or take out what is not to be "
                                        "printed",
                                        settings.items);
    manifest.warnings.push_back(
        fmt::format("the part falls apart into {} separate pieces; {} expected{}", pieces, settings.copies, items));
}

void note_findings(const slice::Findings& findings, const std::vector<slice::ThinSpot>& thin,
                   const JobSettings& settings, Manifest& manifest) {
    note_thin(thin, settings, manifest);
    for (std::string& line : describe(findings, settings.slicing.raster)) manifest.warnings.push_back(std::move(line));
    note_pieces(findings.pieces.size(), settings, manifest);
    note_rare_materials(manifest);
    note_volumes(manifest);
}

/// Records findings as warnings, and adds their pictures.
Status keep_findings(const slice::Findings& findings, const std::vector<slice::ThinSpot>& thin,
                     const LayerSource& source, const JobSettings& settings, Manifest& manifest, Writer& writer) {
    note_findings(findings, thin, settings, manifest);
    const slice::Raster& raster = settings.slicing.raster;
    manifest.findings = listed(findings, thin, raster);
    return add_pictures(manifest.findings, raster, source.layer, writer);
}

/// Layer images may be corrected already: nobody can see it in them.
void note_light(const slice::LightCorrection& light, Manifest& manifest) {
    if (light.none()) return;
    const char* const what = !light.mask ? "grey is" : light.grey ? "grey and mask are" : "mask is";
    manifest.warnings.push_back(
        fmt::format("the printer file's {} applied to the layer images; images exported from a job for this "
                    "printer are corrected already, and would be corrected twice",
                    what));
}

/// Adds up what a black mask of the projector leaves dark: the images' areas and volumes are those before the mask.
class MaskedLight {
public:
    explicit MaskedLight(const JobSettings& settings)
        : heights_(settings.slicing.layers()), pixel_mm2_(std::pow(settings.slicing.raster.pixel_um / 1000, 2)) {}

    void add(int k, const Prepared& prepared) {
        lit_ = lit_ || prepared.lit;
        for (std::size_t i = 0; i < prepared.dark_sums.size(); ++i) {
            if (prepared.dark_sums[i] == 0) continue;
            dark_mm3_[prepared.sliced.images[i].material] +=
                static_cast<double>(prepared.dark_sums[i]) / 255 * pixel_mm2_ * heights_.thickness_um(k) / 1000;
        }
    }

    Status note(Manifest& manifest) const {
        if (!lit_ && !dark_mm3_.empty())
            return input_error("nothing is printed: the projector's mask is black under the whole part");
        for (const auto& [material, mm3] : dark_mm3_)
            manifest.warnings.push_back(
                fmt::format("material \"{}\": {:.4g} mm^3 get no light: the projector's mask is black there",
                            manifest.materials[static_cast<std::size_t>(material)].name, mm3));
        return {};
    }

private:
    slice::Layers heights_;
    double pixel_mm2_;
    bool lit_ = false;
    std::map<int, double> dark_mm3_;  ///< by material of the job
};

Manifest empty_manifest(const JobSettings& settings, std::vector<Material> materials) {
    const slice::Settings& slicing = settings.slicing;
    const slice::Raster& raster = slicing.raster;
    return {settings.name,
            settings.pliant_version,
            raster.width_px,
            raster.height_px,
            raster.pixel_um,
            settings.bottom_layers,
            std::move(materials),
            {},
            {},
            !slicing.compensation.empty() || slicing.removed,
            {},
            settings.any_vat};
}

/// Teeth between materials whose images are put together cannot be seen in the part.
void note_joint_teeth(const std::vector<slice::Teeth>& teeth, const slice::Summary& summary,
                      std::span<const int> printed_as, Manifest& manifest) {
    const auto printed = [&](const std::string& name) {
        const auto at = std::find(summary.materials.begin(), summary.materials.end(), name);
        return printed_as[static_cast<std::size_t>(at - summary.materials.begin())];
    };
    for (std::size_t i = 0; i < teeth.size(); ++i) {
        if (!summary.interlocked[i] || printed(teeth[i].first) != printed(teeth[i].second)) continue;
        manifest.warnings.push_back(
            fmt::format("interlock: {} and {} are printed from one vat and exposed together, it changes nothing",
                        teeth[i].first, teeth[i].second));
    }
}

/// Before layers are made, which takes long for a tall part.
Status check_top(const JobSettings& settings, int layer_count) {
    if (settings.build_height_um <= 0 || layer_count == 0) return {};
    return plan::check_height(settings.name, settings.slicing.layers().top_um(layer_count - 1), settings.printer,
                              settings.build_height_um);
}

/// Handles finished layers, in order: passed to `note`, stored, listed in the manifest.
class LayerKeeper {
public:
    using Note = std::function<void(int, Prepared&)>;
    LayerKeeper(const JobSettings& settings, int count, Manifest& manifest, Writer& writer, const Note& note)
        : settings_(settings),
          count_(count),
          heights_(settings.slicing.layers()),
          words_(file_words(manifest.materials)),
          thumbnail_(manifest.width_px),
          manifest_(manifest),
          writer_(writer),
          note_(note) {}

    [[nodiscard]] const Thumbnail& thumbnail() const { return thumbnail_; }

    Status keep(std::vector<Result<Prepared>>& layers) {
        for (Result<Prepared>& made : layers) {
            if (!made) return tl::unexpected(made.error());
            const int k = static_cast<int>(manifest_.layers.size());
            note_(k, *made);
            thumbnail_.add(made->seen);
            const std::vector<EncodedImage> seen =
                settings_.watch ? made->images : std::vector<EncodedImage>{};  // storing moves them
            auto layer = store(*made, k, manifest_, words_, settings_, heights_, writer_);
            if (!layer) return tl::unexpected(layer.error());
            manifest_.layers.push_back(std::move(*layer));
            if (settings_.watch) settings_.watch(manifest_, count_, seen);
        }
        return {};
    }

    Status finish() { return writer_.add_image(thumbnail_file, thumbnail_.picture(heights_, manifest_.pixel_um)); }

private:
    const JobSettings& settings_;
    int count_;
    slice::Layers heights_;
    std::vector<std::string> words_;
    Thumbnail thumbnail_;
    Manifest& manifest_;
    Writer& writer_;
    const Note& note_;
};

/// Makes layers in parallel batches and stores them in order. One core stores a batch while the others make the next.
Status make_layers(const LayerSource& source, const JobSettings& settings, Manifest& manifest, Writer& writer,
                   Progress& progress, const LayerKeeper::Note& note) {
    for (const auto& [name, rule] : settings.exposures) {
        if (auto status = check(rule, "material '" + name + "'"); !status) return status;
    }
    LayerKeeper keeper(settings, source.count, manifest, writer, note);
    constexpr int batch = slice::layers_at_once;
    std::vector<Result<Prepared>> made;
    for (int first = 0; first < source.count; first += batch) {
        if (progress.cancelled()) return cancelled();
        progress.advance("slice", static_cast<double>(first) / source.count);
        const auto size = static_cast<std::size_t>(std::min(batch, source.count - first));
        std::vector<Result<Prepared>> next(size);
        Status kept;
        parallel_for(size + 1, source.parallel ? 1 : size + 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                if (i == 0) {
                    kept = keeper.keep(made);
                } else {
                    next[i - 1] = prepare_layer(source, settings, keeper.thumbnail(), first + static_cast<int>(i) - 1);
                }
            }
        });
        if (!kept) return kept;
        made = std::move(next);
    }
    if (auto kept = keeper.keep(made); !kept) return kept;
    progress.advance("slice", 1);
    return keeper.finish();
}

}  // namespace

Result<MadeJob> slice_to_job(std::span<const slice::Body> bodies, const JobSettings& settings, Writer& writer,
                             Progress& progress) {
    const auto slicer = slice::Slicer::prepare(bodies, settings.slicing);
    if (!slicer) return tl::unexpected(slicer.error());
    const auto materials = used_materials(*slicer, settings.materials);
    if (!materials) return tl::unexpected(materials.error());
    if (Status low = check_top(settings, slicer->layer_count()); !low) return tl::unexpected(low.error());
    PrintedTogether printed = printed_together(*materials, settings);
    MadeJob job{empty_manifest(settings, std::move(printed.materials)), {}};
    slice::Tally tally(*slicer);
    slice::Inspector inspector(settings.slicing.layers());
    std::vector<slice::ThinSpot> thin;
    MaskedLight masked(settings);
    const LayerSource source{slicer->layer_count(),
                             [&](int k) -> Result<slice::SlicedLayer> { return slicer->layer(k); },
                             std::move(printed.printed_as)};
    const Status made = make_layers(source, settings, job.manifest, writer, progress, [&](int k, Prepared& prepared) {
        tally.add(k, prepared.sliced);
        inspector.add(std::move(prepared.shape));
        masked.add(k, prepared);
        thin.insert(thin.end(), prepared.thin.begin(), prepared.thin.end());
    });
    if (!made) return tl::unexpected(made.error());
    job.summary = tally.summary();
    measure(bodies, *slicer, job.summary, job.manifest.materials);
    job.manifest.warnings = job.summary.warnings;
    const std::vector<bool>& overlapped = job.summary.overlapped;
    if (std::find(overlapped.begin(), overlapped.end(), true) != overlapped.end()) job.manifest.compensated = true;
    note_joint_teeth(settings.slicing.teeth, job.summary, source.printed_as, job.manifest);
    if (auto status = masked.note(job.manifest); !status) return tl::unexpected(status.error());
    if (auto status = keep_findings(inspector.finish(), joined(thin), source, settings, job.manifest, writer); !status)
        return tl::unexpected(status.error());
    return job;
}

Result<MadeJob> stacks_to_job(std::span<const MaterialStack> stacks, const JobSettings& settings, Writer& writer,
                              Progress& progress) {
    std::vector<Material> materials;
    LayerSource source{0, {}, {}, false};
    for (const MaterialStack& s : stacks) {
        const Result<Material> known = find_material(settings.materials, s.material);
        if (!known) return tl::unexpected(known.error());
        const slice::Raster& raster = settings.slicing.raster;
        if (s.stack.width_px() != raster.width_px || s.stack.height_px() != raster.height_px)
            return input_error("images of '{}' have {} x {} pixels, the projector {} x {}", s.material,
                               s.stack.width_px(), s.stack.height_px(), raster.width_px, raster.height_px);
        materials.push_back(*known);
        source.count = std::max(source.count, s.stack.layer_count());
    }
    if (Status low = check_top(settings, source.count); !low) return tl::unexpected(low.error());
    source.layer = [&](int k) { return stacked_layer(stacks, k); };
    PrintedTogether printed = printed_together(materials, settings);
    source.printed_as = std::move(printed.printed_as);
    MadeJob job{empty_manifest(settings, std::move(printed.materials)), {}};
    slice::Inspector inspector(settings.slicing.layers());
    std::vector<slice::ThinSpot> thin;
    MaskedLight masked(settings);
    const double pixel_um = settings.slicing.raster.pixel_um;
    const slice::Layers heights = settings.slicing.layers();
    const auto voxel_mm3 = [&](int k) { return pixel_um * pixel_um * heights.thickness_um(k) / 1e9; };
    std::vector<double> lost_mm3(stacks.size(), 0.0), lit_mm3(stacks.size(), 0.0);
    const Status made = make_layers(source, settings, job.manifest, writer, progress, [&](int k, Prepared& prepared) {
        inspector.add(std::move(prepared.shape));
        masked.add(k, prepared);
        thin.insert(thin.end(), prepared.thin.begin(), prepared.thin.end());
        for (std::size_t i = 0; i < stacks.size(); ++i) lost_mm3[i] += prepared.sliced.lost_px[i] * voxel_mm3(k);
        for (const auto& [drawn, sum] : prepared.drawn_sums)
            lit_mm3[drawn] += static_cast<double>(sum) / 255 * voxel_mm3(k);
    });
    if (!made) return tl::unexpected(made.error());
    note_light(settings.light, job.manifest);
    if (auto status = masked.note(job.manifest); !status) return tl::unexpected(status.error());
    for (std::size_t i = 0; i < stacks.size(); ++i) {
        add_drawn(stacks[i].material, lit_mm3[i], 0, job.manifest.materials);
        if (lost_mm3[i] > voxel_mm3(source.count))  // more than a pixel of a layer
            job.manifest.warnings.push_back(
                fmt::format("images of \"{}\": {:.4g} mm^3 are exposed by other materials too, which keep them",
                            stacks[i].material, lost_mm3[i]));
    }
    job.summary.layer_count = source.count;
    if (auto status = keep_findings(inspector.finish(), joined(thin), source, settings, job.manifest, writer); !status)
        return tl::unexpected(status.error());
    return job;
}

}  // namespace pliant::job
