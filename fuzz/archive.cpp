// Whole jobs: libzip reads files only, so the input takes the way over one.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "input.hpp"
#include "job/job.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto path = std::filesystem::temp_directory_path() / ("pliant_fuzz_" + std::to_string(getpid()) + ".zip");
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    const auto archive = pliant::job::Archive::open(path);
    if (archive) {
        for (const auto& layer : archive->manifest().layers) {
            for (const auto& image : layer.images) (void)archive->image(image.file);
        }
        (void)archive->file("printer.toml");
    }
    std::filesystem::remove(path);
    return 0;
}
