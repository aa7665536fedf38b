// From bodies to the images of a job.
#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "base/core/progress.hpp"
#include "printing/job/exposure.hpp"
#include "printing/job/image_stack.hpp"
#include "printing/job/job.hpp"
#include "printing/slice/light.hpp"
#include "printing/slice/slicer.hpp"

namespace pliant::job {

/// Hears of every layer as soon as it is stored: the manifest so far, how many layers there will be, the layer's images
/// (parallel to those of the manifest's last layer). Called in order, from any thread, one at a time.
using LayerWatch = std::function<void(const Manifest& so_far, int count, const std::vector<EncodedImage>& images)>;

struct JobSettings {
    std::string name;
    std::string pliant_version;
    int bottom_layers = 0;
    slice::Settings slicing;
    /// Resin and exposures of every material that a body names; model_volume_mm3 and model_area_mm2 are filled in.
    std::vector<Material> materials;
    int copies = 1;                  ///< of the part: how many pieces may touch each other nowhere
    slice::LightCorrection light{};  ///< of the stored images; areas and volumes are those before it
    double least_feature_um = 0;     ///< a warning tells what is narrower; 0: none
    /// Of materials whose layers are not all lit as JobSettings::bottom_layers says.
    std::map<std::string, ExposureRule> exposures{};
    bool any_vat = false;  ///< as in Manifest
    LayerWatch watch{};    ///< may be empty
};

struct MadeJob {
    Manifest manifest;  ///< materials in the order in which the bodies first name them; warnings of the slicer
    slice::Summary summary;
};

/// Slices bodies that stand on the platform and adds their images, and pictures of findings, to `writer`; the caller
/// then adds printer.toml, plan.json and job.gcode, and calls writer.finish(manifest). Layers are cut and encoded in
/// parallel, the archive does not depend on the number of threads. Errors: what slice::Slicer::prepare refuses, a
/// material without settings, the writer's, cancellation.
[[nodiscard]] Result<MadeJob> slice_to_job(std::span<const slice::Body> bodies, const JobSettings& settings,
                                           Writer& writer, Progress& progress);

/// Images of one material, of one file or folder.
struct MaterialStack {
    std::string material;
    ImageStack stack;
};

/// The same from images that exist: layers of settings.slicing.layer_um, each material once. Volumes are those of the
/// images. Where materials share a pixel it goes whole to the brighter, the later one on a tie, and a warning says how
/// much. Errors: a material without settings, images of another size than the raster, images that cannot be read.
[[nodiscard]] Result<MadeJob> stacks_to_job(std::span<const MaterialStack> stacks, const JobSettings& settings,
                                            Writer& writer, Progress& progress);

}  // namespace pliant::job
