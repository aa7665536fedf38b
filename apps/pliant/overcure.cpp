#include "overcure.hpp"

#include <utility>

#include "printing/operate/job_file.hpp"
#include "printing/twin/planned_cure.hpp"

namespace pliant::app {

Result<std::vector<std::string>> overcure_warnings(const job::Archive& archive, const plan::Plan& plan,
                                                   const machine::Printer& printer) {
    const job::Manifest& manifest = archive.manifest();
    if (manifest.width_px != printer.projector.width_px || manifest.height_px != printer.projector.height_px)
        return input_error("the job's images are {} x {} pixels, the projector's {} x {}", manifest.width_px,
                           manifest.height_px, printer.projector.width_px, printer.projector.height_px);
    const machine::Printer filled = plan::filled_printer(plan, manifest, printer);
    Result<std::optional<job::Image>> mask = operate::mask_of(archive, filled.projector);
    if (!mask) return tl::unexpected(mask.error());
    const twin::RunSource images = [&](int layer, int material) {
        return operate::image_of(archive, layer, material).map(twin::runs_of);
    };
    const twin::Screen screen(filled.projector, std::move(*mask));
    const Result<twin::Cure> cure = twin::planned_cure(filled, manifest, images, screen);
    if (!cure) return tl::unexpected(cure.error());
    return twin::overcure_warnings(*cure, filled);
}

}  // namespace pliant::app
