#include "job_tools.hpp"

namespace pliant::app {

Result<OpenJob> open_job(const std::filesystem::path& path) {
    Result<job::Archive> archive = job::Archive::open(path);
    if (!archive) return tl::unexpected(archive.error());
    const Result<std::string> text = archive->file("printer.toml");
    if (!text) return input_error("{}: {}; slice the robot again with --printer", path.string(), text.error().message);
    Result<machine::Printer> printer = machine::parse_printer(*text, path / "printer.toml");
    if (!printer) return tl::unexpected(printer.error());
    return OpenJob{std::move(*archive), std::move(*printer)};
}

Result<job::Image> image_of(const job::Archive& archive, int layer, int material) {
    const auto& layers = archive.manifest().layers;
    if (layer >= 0 && layer < static_cast<int>(layers.size())) {
        for (const job::LayerImage& image : layers[static_cast<std::size_t>(layer)].images) {
            if (image.material == material) return archive.image(image.file);
        }
    }
    return input_error("layer {} has no image of material {}", layer, material);
}

}  // namespace pliant::app
