#include <map>
#include <utility>

#include "base/zip/zip_file.hpp"
#include "printing/job/job.hpp"
#include "printing/job/manifest.hpp"
#include "printing/job/png.hpp"
#include "printing/job/sha256.hpp"

namespace pliant::job {
namespace fs = std::filesystem;

struct Writer::State {
    fs::path path;
    ZipWriter zip;
    std::map<std::string, std::pair<int, int>> image_sizes;  ///< of the images added so far
    std::map<std::string, std::string> sha256;               ///< of all entries added so far
    bool finished = false;

    Status add(const std::string& file, std::string bytes, ZipWriter::Method method) {
        if (finished) return failure("{}: is already finished", path.string());
        if (!is_safe_entry_name(file))
            return input_error("{}: entry '{}' must be a plain relative path", path.string(), file);
        std::string hash = sha256_hex(bytes);
        if (Status added = zip.add(file, std::move(bytes), method); !added) return added;
        sha256[file] = std::move(hash);
        return {};
    }

    [[nodiscard]] Status check_images(const Manifest& manifest) const {
        for (const Layer& layer : manifest.layers) {
            for (const LayerImage& image : layer.images) {
                const auto found = image_sizes.find(image.file);
                if (found == image_sizes.end())
                    return input_error("{}: image '{}' of the manifest was not added", path.string(), image.file);
                if (found->second != std::pair(manifest.width_px, manifest.height_px))
                    return input_error("{}: image '{}' has {} x {} pixels, the manifest says {} x {}", path.string(),
                                       image.file, found->second.first, found->second.second, manifest.width_px,
                                       manifest.height_px);
            }
        }
        return {};
    }
};

EncodedImage encode(const Image& image) {
    return {image.width_px, image.height_px, encode_png(image)};
}

EncodedImage encode(const slice::RunImage& image) {
    return {image.width_px(), image.height_px(), encode_png(image)};
}

Writer::Writer(std::unique_ptr<State> state) : state_(std::move(state)) {}
Writer::Writer(Writer&&) noexcept = default;
Writer& Writer::operator=(Writer&&) noexcept = default;
Writer::~Writer() = default;

Result<Writer> Writer::create(const fs::path& path) {
    std::error_code code;
    const fs::path folder = fs::absolute(path, code).parent_path();
    if (!fs::is_directory(folder, code))
        return input_error("{}: there is no folder {}", path.string(), folder.string());
    auto zip = ZipWriter::create(path);
    if (!zip) return tl::unexpected(zip.error());
    return Writer(std::make_unique<State>(State{path, std::move(*zip), {}, {}, false}));
}

Status Writer::add_image(const std::string& file, const Image& image) {
    const long long count = static_cast<long long>(image.width_px) * image.height_px;
    if (image.width_px < 1 || image.height_px < 1 || count != static_cast<long long>(image.pixels.size()))
        return input_error("{}: image '{}' of {} x {} pixels holds {} values", state_->path.string(), file,
                           image.width_px, image.height_px, image.pixels.size());
    return add_image(file, encode(image));
}

Status Writer::add_image(const std::string& file, EncodedImage image) {
    if (auto status = state_->add(file, std::move(image.png), ZipWriter::Method::store); !status) return status;
    state_->image_sizes[file] = {image.width_px, image.height_px};
    return {};
}

Status Writer::add_file(const std::string& file, std::string_view bytes) {
    return state_->add(file, std::string(bytes), ZipWriter::Method::deflate);
}

Status Writer::finish(const Manifest& manifest) {
    if (auto status = check(manifest, state_->path.string()); !status) return status;
    if (auto status = state_->check_images(manifest); !status) return status;
    Manifest sealed = manifest;
    sealed.sha256 = state_->sha256;
    if (auto status = add_file("manifest.json", to_json(sealed)); !status) return status;
    state_->finished = true;
    return state_->zip.close();
}

}  // namespace pliant::job
