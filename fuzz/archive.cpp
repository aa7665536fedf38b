// Whole jobs, through a file because libzip reads only files.
#include "file.hpp"
#include "input.hpp"
#include "printing/job/job.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const TemporaryFile file(as_text(data, size), ".zip");
    const auto archive = pliant::job::Archive::open(file.path());
    if (!archive) return 0;
    for (const auto& layer : archive->manifest().layers) {
        for (const auto& image : layer.images) (void)archive->image(image.file);
    }
    (void)archive->file("printer.toml");
    return 0;
}
