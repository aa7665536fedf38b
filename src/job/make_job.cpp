#include "job/make_job.hpp"

#include <algorithm>
#include <set>

#include "core/parallel.hpp"
#include "core/text.hpp"

namespace pliant::job {
namespace {

/// One layer on its way from the slicer to the archive.
struct Prepared {
    slice::SlicedLayer sliced;         ///< its images without their runs, which are encoded
    std::vector<EncodedImage> images;  ///< parallel to sliced.images
};

Prepared prepare_layer(const slice::Slicer& slicer, const slice::LightCorrection& light, int k) {
    Prepared prepared{slicer.layer(k), {}};
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
    return job;
}

}  // namespace pliant::job
