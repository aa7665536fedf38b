// From bodies to the images of a job.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/core/progress.hpp"
#include "printing/job/exposure.hpp"
#include "printing/job/image_stack.hpp"
#include "printing/job/job.hpp"
#include "printing/job/platform_edge.hpp"
#include "printing/slice/light.hpp"
#include "printing/slice/slicer.hpp"

namespace pliant::job {

/// Called for every layer once it is stored: the manifest so far, the total number of layers, the layer's images
/// (parallel to those of the manifest's last layer). Called in order, from any thread, never concurrently.
using LayerWatch = std::function<void(const Manifest& so_far, int count, const std::vector<EncodedImage>& images)>;

struct JobSettings {
    std::string name;
    std::string pliant_version;
    int bottom_layers = 0;  ///< as in Manifest
    slice::Settings slicing;
    /// Resin and exposures of every material of a body; model_volume_mm3 and model_area_mm2 are filled in.
    std::vector<Material> materials;
    int copies = 1;                  ///< of the part: this many pieces need not touch each other
    slice::LightCorrection light{};  ///< applied to the stored images; areas and volumes are those before it
    double least_feature_um = 0;     ///< narrower features give a warning; 0: none
    /// For materials whose layers are not all exposed as their bottom layers say.
    std::map<std::string, ExposureRule> exposures{};
    bool any_vat = false;                         ///< as in Manifest
    std::optional<PlatformEdge> edge{};           ///< light beyond it is an error; nothing: not known
    LayerWatch watch{};                           ///< may be empty
    double most_exposure_s = longest_exposure_s;  ///< of any image
    std::string printer{};                        ///< whose limit that is
    int build_height_um = 0;                      ///< of that printer; 0: not known
    int items = 1;                                ///< that a 3MF file places, each perhaps a part of its own
};

struct MadeJob {
    Manifest manifest;  ///< materials in the order in which bodies first name them; warnings of the slicer
    slice::Summary summary;
};

/// Slices bodies placed on the platform and adds their images, and pictures of findings, to `writer`; the caller then
/// adds printer.toml, plan.json and job.gcode, and calls writer.finish(manifest). Layers are cut and encoded in
/// parallel; the archive does not depend on the number of threads. Errors: those of slice::Slicer::prepare, a material
/// without settings, an exposure over the limit, the writer's, cancellation.
[[nodiscard]] Result<MadeJob> slice_to_job(std::span<const slice::Body> bodies, const JobSettings& settings,
                                           Writer& writer, Progress& progress);

/// Layer images of one material, from a file or folder.
struct MaterialStack {
    std::string material;
    ImageStack stack;
};

/// The same from existing images: layers as settings.slicing says, each material once. Volumes are those of the
/// images. A pixel shared by materials goes entirely to the brighter one, on a tie to the later one, and a warning says
/// how much was shared. Errors: a material without settings, images whose size differs from the raster, unreadable
/// images.
[[nodiscard]] Result<MadeJob> stacks_to_job(std::span<const MaterialStack> stacks, const JobSettings& settings,
                                            Writer& writer, Progress& progress);

}  // namespace pliant::job
