#include <set>

#include "base/zip/zip_file.hpp"
#include "printing/job/job.hpp"
#include "printing/job/manifest.hpp"
#include "printing/job/png.hpp"
#include "printing/job/sha256.hpp"

namespace pliant::job {
namespace {

constexpr std::uint64_t max_entries = 1 << 22;
constexpr std::uint64_t max_manifest_bytes = std::uint64_t{64} << 20;
constexpr std::uint64_t max_file_bytes = std::uint64_t{1} << 30;

Status check_entries(const ZipReader& zip, const std::string& path) {
    if (zip.entry_count() > max_entries)
        return input_error("{}: {} entries, at most {} are allowed", path, zip.entry_count(), max_entries);
    std::set<std::string> names;
    for (std::uint64_t i = 0; i < zip.entry_count(); ++i) {
        std::string name = zip.name(i);
        if (name.ends_with('/')) name.pop_back();  // a folder
        if (!is_safe_entry_name(name)) return input_error("{}: entry '{}' must be a plain relative path", path, name);
        // Another program might read the other one.
        if (!names.insert(name).second) return input_error("{}: entry '{}' is there twice", path, name);
    }
    return {};
}

Status check_image_sizes(const ZipReader& zip, const Manifest& manifest, const std::string& path) {
    std::set<std::string_view> seen;
    for (const Layer& layer : manifest.layers) {
        for (const LayerImage& image : layer.images) {
            if (!seen.insert(image.file).second) continue;
            const auto head = zip.read_head(image.file, png_head_bytes);
            if (!head) return tl::unexpected(head.error());
            const auto size = png_size(*head, path + ": " + image.file);
            if (!size) return tl::unexpected(size.error());
            if (size->width_px != manifest.width_px || size->height_px != manifest.height_px)
                return input_error("{}: {}: {} x {} pixels, the manifest says {} x {}", path, image.file,
                                   size->width_px, size->height_px, manifest.width_px, manifest.height_px);
        }
    }
    return {};
}

/// Checks that every entry with a hash exists.
Status check_listed(const ZipReader& zip, const Manifest& manifest, const std::string& path) {
    for (const auto& [file, hash] : manifest.sha256) {
        if (!zip.has(file))
            return input_error("{}: {}: is missing, though the manifest has its fingerprint", path, file);
    }
    return {};
}

Status check_entry_sha256(const Manifest& manifest, const std::string& file, std::string_view bytes,
                          const std::string& path) {
    if (manifest.sha256.empty() || file == "manifest.json") return {};
    const auto listed = manifest.sha256.find(file);
    if (listed == manifest.sha256.end())
        return input_error("{}: {}: the manifest has no fingerprint (sha256) of it, so it was not made with the job",
                           path, file);
    if (listed->second == sha256_hex(bytes)) return {};
    return input_error(
        "{}: {}: was damaged or changed since the job was made (its sha256 is not the manifest's); slice it again",
        path, file);
}

}  // namespace

struct Archive::State {
    std::string path;
    ZipReader zip;
    Manifest manifest;
};

Archive::Archive(std::unique_ptr<State> state) : state_(std::move(state)) {}
Archive::Archive(Archive&&) noexcept = default;
Archive& Archive::operator=(Archive&&) noexcept = default;
Archive::~Archive() = default;

Result<Archive> Archive::open(const std::filesystem::path& path) {
    auto zip = ZipReader::open(path);
    if (!zip) return tl::unexpected(zip.error());
    const std::string name = path.string();
    if (auto status = check_entries(*zip, name); !status) return tl::unexpected(status.error());
    const auto json = zip->read("manifest.json", max_manifest_bytes);
    if (!json) return tl::unexpected(json.error());
    auto manifest = manifest_from_json(*json, name + ": manifest.json");
    if (!manifest) return tl::unexpected(manifest.error());
    if (auto status = check_image_sizes(*zip, *manifest, name); !status) return tl::unexpected(status.error());
    if (auto status = check_listed(*zip, *manifest, name); !status) return tl::unexpected(status.error());
    return Archive(std::make_unique<State>(State{name, std::move(*zip), std::move(*manifest)}));
}

const Manifest& Archive::manifest() const {
    return state_->manifest;
}

bool Archive::has_file(const std::string& file) const {
    return state_->zip.has(file);
}

Result<std::string> Archive::file(const std::string& file) const {
    auto bytes = state_->zip.read(file, max_file_bytes);
    if (!bytes) return bytes;
    if (auto status = check_entry_sha256(state_->manifest, file, *bytes, state_->path); !status)
        return tl::unexpected(status.error());
    return bytes;
}

Result<Image> Archive::image(const std::string& file) const {
    Image found;
    if (Status status = image(file, found); !status) return tl::unexpected(status.error());
    return found;
}

Status Archive::image(const std::string& file, Image& into) const {
    const auto png = this->file(file);
    if (!png) return tl::unexpected(png.error());
    const PngSize size{state_->manifest.width_px, state_->manifest.height_px};
    return decode_png(*png, size, state_->path + ": " + file, into);
}

bool is_job(const std::filesystem::path& path) {
    constexpr std::uint64_t head_bytes = 4096;  // the format is the first key
    const auto zip = ZipReader::open(path);
    if (!zip || !zip->has("manifest.json")) return false;
    const auto head = zip->read_head("manifest.json", head_bytes);
    return head && head->find("\"format\"") != std::string::npos;
}

}  // namespace pliant::job
