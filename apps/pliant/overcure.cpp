#include "overcure.hpp"

#include <utility>

#include "printing/operate/job_file.hpp"
#include "printing/twin/planned_cure.hpp"

namespace pliant::app {

Result<std::vector<std::string>> overcure_warnings(const job::Archive& archive, const plan::Plan& plan,
                                                   const machine::Printer& printer, Progress& progress) {
    const job::Manifest& manifest = archive.manifest();
    if (manifest.width_px != printer.projector.width_px || manifest.height_px != printer.projector.height_px)
        return input_error("the job's images are {} x {} pixels, the projector's {} x {}", manifest.width_px,
                           manifest.height_px, printer.projector.width_px, printer.projector.height_px);
    const machine::Printer filled = plan::filled_printer(plan, manifest, printer);
    Result<std::optional<job::Image>> mask = operate::mask_of(archive, filled.projector);
    if (!mask) return tl::unexpected(mask.error());
    job::Image image;  // its memory serves for all layers
    const twin::RunSource images = [&](int layer, int material) -> Result<twin::Runs> {
        if (Status read = operate::image_of(archive, layer, material, image); !read)
            return tl::unexpected(read.error());
        return twin::runs_of(image);
    };
    const twin::Screen screen(filled.projector, std::move(*mask));
    const Result<twin::Cure> cure = twin::planned_cure(filled, manifest, images, screen, progress);
    if (!cure) return tl::unexpected(cure.error());
    return twin::overcure_warnings(*cure, filled);
}

}  // namespace pliant::app
