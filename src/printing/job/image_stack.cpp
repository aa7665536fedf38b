#include "printing/job/image_stack.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <vector>

#include "base/core/files.hpp"
#include "base/core/letters.hpp"
#include "base/zip/zip_file.hpp"
#include "printing/job/png.hpp"
#include "printing/job/stack_height.hpp"

namespace pliant::job {
namespace fs = std::filesystem;

/// The file of a layer's image, and the number at the end of its name.
struct StackImage {
    std::string name;
    long number;
};

namespace {

constexpr std::uint64_t max_image_bytes = std::uint64_t{1} << 28;
constexpr std::uint64_t max_text_bytes = std::uint64_t{1} << 22;
constexpr std::uint64_t max_stack_files = 1 << 22;

/// "layers/cone_" and 12 of "layers/cone_0012.png".
std::optional<std::pair<std::string, long>> split_name(const std::string& name) {
    const std::string lower = lower_case(name);
    if (!lower.ends_with(".png") || lower.find("thumbnail") != std::string::npos ||
        lower.find("preview") != std::string::npos)
        return std::nullopt;
    const std::size_t end = name.size() - 4;
    std::size_t begin = end;
    while (begin > 0 && std::isdigit(static_cast<unsigned char>(name[begin - 1])) != 0) --begin;
    if (begin == end || end - begin > 9) return std::nullopt;
    return std::pair(name.substr(0, begin), std::stol(name.substr(begin, end - begin)));
}

/// Images whose names differ in their numbers alone, in order.
using Group = std::vector<StackImage>;

/// The largest group comes first; of those of one size, the first by name.
std::vector<Group> groups_of(const std::vector<std::string>& names) {
    std::map<std::string, Group> by_name;
    for (const std::string& name : names) {
        if (const auto split = split_name(name)) by_name[split->first].push_back({name, split->second});
    }
    std::vector<Group> groups;
    for (auto& [name, group] : by_name) {
        std::sort(group.begin(), group.end(),
                  [](const StackImage& l, const StackImage& r) { return l.number < r.number; });
        groups.push_back(std::move(group));
    }
    std::stable_sort(groups.begin(), groups.end(), [](const Group& l, const Group& r) { return l.size() > r.size(); });
    return groups;
}

/// Errors: what makes the largest group no stack.
Status check_stack(const std::vector<Group>& groups, const std::string& path) {
    if (groups.empty()) return input_error("{}: holds no layer images, PNG files whose names end with a number", path);
    const Group& largest = groups.front();
    if (largest.front().number > 1)
        return input_error("{}: the first image is {}, one with 0 or 1 is needed", path, largest.front().name);
    for (std::size_t i = 1; i < largest.size(); ++i) {
        if (largest[i].number != largest[i - 1].number + 1)
            return input_error("{}: {} follows {}: numbers must rise by one", path, largest[i].name,
                               largest[i - 1].name);
    }
    return {};
}

std::string text_of(const Group& group) {
    return fmt::format("{} images {} to {}", group.size(), group.front().name, group.back().name);
}

Result<std::vector<std::string>> names_in(const fs::path& path, const ZipReader* zip) {
    std::vector<std::string> names;
    if (zip != nullptr) {
        if (zip->entry_count() > max_stack_files)
            return input_error("{}: more than {} entries", path.string(), max_stack_files);
        for (std::uint64_t i = 0; i < zip->entry_count(); ++i) names.push_back(zip->name(i));
        return names;
    }
    std::error_code code;
    for (fs::directory_iterator it(path, code), end; !code && it != end; it.increment(code)) {
        if (it->is_regular_file()) names.push_back(it->path().filename().string());
        if (names.size() > max_stack_files)
            return input_error("{}: more than {} files", path.string(), max_stack_files);
    }
    if (code) return input_error("{}: {}", path.string(), code.message());
    return names;
}

}  // namespace

struct ImageStack::State {
    fs::path path;
    std::optional<ZipReader> zip;
    std::vector<StackImage> entries;
    std::string left_out;
    PngSize size;
    std::optional<double> layer_um, first_layer_um;
    std::optional<PixelSize> pixel;

    [[nodiscard]] Result<std::string> read(const std::string& name, std::uint64_t most) const {
        return zip ? zip->read(name, most) : read_file(path / name, most);
    }
    [[nodiscard]] Result<std::string> bytes(std::size_t i) const { return read(entries[i].name, max_image_bytes); }
    [[nodiscard]] Result<PngSize> size_of(const std::string& name) const {
        const auto bytes = read(name, max_image_bytes);
        if (!bytes) return tl::unexpected(bytes.error());
        return any_png_size(*bytes, fmt::format("{}: {}", path.string(), name));
    }
};

ImageStack::ImageStack(std::unique_ptr<State> state) : state_(std::move(state)) {}
ImageStack::ImageStack(ImageStack&&) noexcept = default;
ImageStack& ImageStack::operator=(ImageStack&&) noexcept = default;
ImageStack::~ImageStack() = default;

Result<ImageStack> ImageStack::open(const fs::path& path) {
    auto state = std::make_unique<State>();
    state->path = path;
    if (!fs::is_directory(path)) {
        auto zip = ZipReader::open(path);
        if (!zip) return tl::unexpected(zip.error());
        state->zip = std::move(*zip);
    }
    const auto names = names_in(path, state->zip ? &*state->zip : nullptr);
    if (!names) return tl::unexpected(names.error());
    std::vector<Group> groups = groups_of(*names);
    if (Status status = check_stack(groups, path.string()); !status) return tl::unexpected(status.error());
    state->entries = std::move(groups.front());
    const SideText side_text = [&](const std::string& name) { return state->read(name, max_text_bytes); };
    const auto layer_um = stated_layer_um(*names, side_text);
    if (!layer_um) return input_error("{}: {}", path.string(), layer_um.error().message);
    state->layer_um = *layer_um;
    const auto first_layer_um = stated_first_layer_um(*names, side_text);
    if (!first_layer_um) return input_error("{}: {}", path.string(), first_layer_um.error().message);
    state->first_layer_um = *first_layer_um;
    const auto pixel = stated_pixel(*names, side_text);
    if (!pixel) return input_error("{}: {}", path.string(), pixel.error().message);
    state->pixel = *pixel;
    const auto size = state->size_of(state->entries[0].name);
    if (!size) return tl::unexpected(size.error());
    state->size = *size;
    if (groups.size() > 1 && groups[1].size() > 1) {
        const auto other = state->size_of(groups[1].front().name);
        if (other && other->width_px == size->width_px && other->height_px == size->height_px)
            state->left_out = fmt::format("{}: the layers are the {}; the {}, which have the same size, are left out",
                                          path.string(), text_of(state->entries), text_of(groups[1]));
    }
    return ImageStack(std::move(state));
}

int ImageStack::layer_count() const {
    return static_cast<int>(state_->entries.size());
}

int ImageStack::width_px() const {
    return state_->size.width_px;
}

int ImageStack::height_px() const {
    return state_->size.height_px;
}

std::optional<double> ImageStack::layer_um() const {
    return state_->layer_um;
}

std::optional<double> ImageStack::first_layer_um() const {
    return state_->first_layer_um;
}

std::optional<PixelSize> ImageStack::pixel() const {
    return state_->pixel;
}

const std::string& ImageStack::left_out() const {
    return state_->left_out;
}

Result<slice::Image> ImageStack::image(int layer) const {
    const auto i = static_cast<std::size_t>(layer);
    const auto bytes = state_->bytes(i);
    if (!bytes) return tl::unexpected(bytes.error());
    return decode_any_png(*bytes, state_->size, fmt::format("{}: {}", state_->path.string(), state_->entries[i].name));
}

bool is_image_stack(const fs::path& path) {
    if (fs::is_directory(path)) return true;
    const auto zip = ZipReader::open(path);
    if (!zip || zip->has("_rels/.rels") || zip->has("manifest.json")) return false;
    const auto names = names_in(path, &*zip);
    return names && std::any_of(names->begin(), names->end(),
                                [](const std::string& n) { return lower_case(n).ends_with(".png"); });
}

}  // namespace pliant::job
