#include "job/make_job.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/parallel.hpp"
#include "core/text.hpp"
#include "slice/inspect.hpp"

namespace pliant::job {
namespace {

/// One layer on its way from the slicer to the archive.
struct Prepared {
    slice::SlicedLayer sliced;         ///< its images without their runs, which are encoded
    std::vector<EncodedImage> images;  ///< parallel to sliced.images
    slice::LayerShape shape;
};

Prepared prepare_layer(const slice::Slicer& slicer, const slice::LightCorrection& light, int k) {
    Prepared prepared{slicer.layer(k), {}, {}};
    prepared.shape = slice::shape_of(prepared.sliced, slicer.settings().raster.width_px);
    for (slice::MaterialImage& m : prepared.sliced.images) {
        prepared.images.push_back(encode(light.none() ? m.image : corrected(m.image, light)));
        m.image = {};
    }
    return prepared;
}

Result<std::vector<Material>> used_materials(std::span<const slice::Body> bodies, const slice::Slicer& slicer,
                                             const std::vector<Material>& known) {
    std::vector<Material> used;
    for (const std::string& name : slicer.materials()) {
        const auto found = std::find_if(known.begin(), known.end(), [&](const Material& m) { return m.name == name; });
        if (found == known.end()) return input_error("material '{}' has no resin and exposure", name);
        used.push_back(*found);
        used.back().model_volume_mm3 = used.back().model_area_mm2 = 0;
        for (std::size_t b = 0; b < bodies.size(); ++b) {
            if (bodies[b].material != name) continue;
            used.back().model_volume_mm3 += slicer.measures()[b].volume_mm3;
            used.back().model_area_mm2 += slicer.measures()[b].area_mm2;
        }
    }
    return used;
}

/// What the materials are called in file names: different even where only odd characters tell them apart.
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

Result<Layer> store(Prepared& prepared, int k, const Manifest& manifest, const std::vector<std::string>& words,
                    int layer_um, Writer& writer) {
    const double pixel_mm2 = manifest.pixel_um * manifest.pixel_um / 1e6;
    Layer layer{(k + 1) * layer_um, layer_um, {}};
    for (std::size_t i = 0; i < prepared.images.size(); ++i) {
        const slice::MaterialImage& m = prepared.sliced.images[i];
        const std::string file = image_file_name(k, words[m.material]);
        if (auto status = writer.add_image(file, std::move(prepared.images[i])); !status)
            return tl::unexpected(status.error());
        layer.images.push_back({m.material, file, static_cast<double>(m.value_sum) / 255 * pixel_mm2});
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

/// Materials that cost swaps for next to nothing.
void note_rare_materials(Manifest& manifest) {
    constexpr std::size_t few = 3;
    for (std::size_t m = 0; manifest.materials.size() > 1 && m < manifest.materials.size(); ++m) {
        const std::vector<std::size_t> layers = layers_of(manifest, static_cast<int>(m));
        if (!layers.empty() && layers.size() <= few && manifest.layers.size() > 10 * few)
            manifest.warnings.push_back(
                fmt::format("material \"{}\" occurs in {} of {} layers only, the first is layer {}",
                            manifest.materials[m].name, layers.size(), manifest.layers.size(), layers.front()));
    }
}

/// The images must hold the volume that was drawn.
void note_volume(Manifest& manifest) {
    double drawn = 0, lit = 0;
    for (const Material& m : manifest.materials) drawn += m.model_volume_mm3;
    for (const Layer& layer : manifest.layers) {
        for (const LayerImage& image : layer.images) lit += image.area_mm2 * layer.thickness_um / 1000;
    }
    constexpr double tolerance = 1e-3;
    if (std::fabs(lit - drawn) > tolerance * drawn)
        manifest.warnings.push_back(fmt::format("the images hold {:.6g} mm^3, the bodies {:.6g} mm^3: {:+.2f} %", lit,
                                                drawn, 100 * (lit / drawn - 1)));
}

void note_findings(const slice::Findings& findings, const JobSettings& settings, Manifest& manifest) {
    for (std::string& line : describe(findings, settings.slicing.raster, settings.slicing.layer_um))
        manifest.warnings.push_back(std::move(line));
    if (static_cast<int>(findings.pieces.size()) > settings.copies)
        manifest.warnings.push_back(
            fmt::format("{} pieces touch each other nowhere; {} expected", findings.pieces.size(), settings.copies));
    note_rare_materials(manifest);
    note_volume(manifest);
}

}  // namespace

Result<MadeJob> slice_to_job(std::span<const slice::Body> bodies, const JobSettings& settings, Writer& writer,
                             Progress& progress) {
    const auto slicer = slice::Slicer::prepare(bodies, settings.slicing);
    if (!slicer) return tl::unexpected(slicer.error());
    auto materials = used_materials(bodies, *slicer, settings.materials);
    if (!materials) return tl::unexpected(materials.error());
    const slice::Raster& raster = settings.slicing.raster;
    MadeJob job;
    job.manifest = {settings.name,
                    settings.pliant_version,
                    raster.width_px,
                    raster.height_px,
                    raster.pixel_um,
                    settings.bottom_layers,
                    std::move(*materials),
                    {},
                    {}};
    const std::vector<std::string> words = file_words(job.manifest.materials);
    slice::Tally tally(*slicer);
    slice::Inspector inspector;
    constexpr int batch = slice::layers_at_once;
    const int count = slicer->layer_count();
    for (int first = 0; first < count; first += batch) {
        if (progress.cancelled()) return cancelled();
        progress.advance("slice", static_cast<double>(first) / count);
        std::vector<Prepared> layers(static_cast<std::size_t>(std::min(batch, count - first)));
        parallel_for(layers.size(), 1, [&](std::size_t begin, std::size_t) {
            layers[begin] = prepare_layer(*slicer, settings.light, first + static_cast<int>(begin));
        });
        for (std::size_t i = 0; i < layers.size(); ++i) {
            const int k = first + static_cast<int>(i);
            tally.add(k, layers[i].sliced);
            inspector.add(std::move(layers[i].shape));
            auto layer = store(layers[i], k, job.manifest, words, settings.slicing.layer_um, writer);
            if (!layer) return tl::unexpected(layer.error());
            job.manifest.layers.push_back(std::move(*layer));
        }
    }
    progress.advance("slice", 1);
    job.summary = tally.summary();
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        for (Material& m : job.manifest.materials) {
            if (m.name == bodies[b].material)
                m.model_volume_mm3 = std::max(0.0, m.model_volume_mm3 - job.summary.lost_mm3[b]);
        }
    }
    job.manifest.warnings = job.summary.warnings;
    note_findings(inspector.finish(), settings, job.manifest);
    return job;
}

}  // namespace pliant::job
