#include "printing/operate/job_file.hpp"

#include <algorithm>

#include "base/core/files.hpp"
#include "printing/job/png.hpp"

namespace pliant::operate {

Result<OpenJob> open_job(const std::filesystem::path& path) {
    Result<job::Archive> archive = job::Archive::open(path);
    if (!archive) return tl::unexpected(archive.error());
    const Result<std::string> text = archive->file("printer.toml");
    if (!text) return input_error("{}; slice the robot again with --printer", text.error().message);
    Result<machine::Printer> printer = machine::parse_printer(*text, path / "printer.toml");
    if (!printer) return tl::unexpected(printer.error());
    return OpenJob{std::move(*archive), std::move(*printer)};
}

Result<std::optional<job::Image>> load_mask(const machine::Projector& projector,
                                            const std::filesystem::path& printer_path) {
    if (projector.mask.empty()) return std::nullopt;
    const std::filesystem::path path = printer_path.parent_path() / projector.mask;
    const Result<std::string> png = read_file(path);
    if (!png) return input_error("{}: projector.mask: {}", printer_path.string(), png.error().message);
    Result<job::Image> mask = job::decode_png(*png, {projector.width_px, projector.height_px}, path.string());
    if (!mask) return tl::unexpected(mask.error());
    if (std::ranges::all_of(mask->pixels, [](std::uint8_t light) { return light == 0; }))
        return input_error("{}: is black everywhere: nothing would be exposed", path.string());
    return std::optional(std::move(*mask));
}

Result<std::optional<job::Image>> mask_of(const job::Archive& archive, const machine::Projector& projector) {
    if (projector.mask.empty()) return std::nullopt;
    Result<job::Image> mask = archive.image(job::mask_entry);
    if (!mask) return tl::unexpected(mask.error());
    return std::optional(std::move(*mask));
}

Result<job::Image> image_of(const job::Archive& archive, int layer, int material) {
    job::Image found;
    if (Status status = image_of(archive, layer, material, found); !status) return tl::unexpected(status.error());
    return found;
}

Status image_of(const job::Archive& archive, int layer, int material, job::Image& into) {
    const auto& layers = archive.manifest().layers;
    if (layer >= 0 && layer < static_cast<int>(layers.size())) {
        for (const job::LayerImage& image : layers[static_cast<std::size_t>(layer)].images) {
            if (image.material == material) return archive.image(image.file, into);
        }
    }
    return input_error("layer {} has no image of material {}", layer, material);
}

}  // namespace pliant::operate
