#include "printing/job/stack_height.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string_view>

#include "base/core/json.hpp"

namespace pliant::job {
namespace {

constexpr double um_per_mm = 1000;

/// Values of a key as written in a file; several if it occurs several times.
using Values = std::vector<std::string>;

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view blanks = " \t\r\n\"";
    text.remove_prefix(std::min(text.size(), text.find_first_not_of(blanks)));
    const std::size_t last = text.find_last_not_of(blanks);
    return text.substr(0, last == std::string_view::npos ? 0 : last + 1);
}

/// "key = value" lines.
Values ini_values(std::string_view text, std::string_view key) {
    Values values;
    while (!text.empty()) {
        const std::string_view line = text.substr(0, text.find('\n'));
        text.remove_prefix(std::min(text.size(), line.size() + 1));
        const std::size_t equals = line.find('=');
        if (equals == std::string_view::npos || trimmed(line.substr(0, equals)) != key) continue;
        const std::string_view value = line.substr(equals + 1);
        values.emplace_back(trimmed(value.substr(0, value.find('#'))));
    }
    return values;
}

/// <key>value</key>
Values xml_values(std::string_view text, std::string_view key) {
    Values values;
    const std::string open = fmt::format("<{}>", key);
    for (std::size_t at = text.find(open); at != std::string_view::npos; at = text.find(open, at + 1)) {
        const std::string_view rest = text.substr(at + open.size());
        values.emplace_back(trimmed(rest.substr(0, rest.find('<'))));
    }
    return values;
}

/// The member of a JSON object; none if the text is not JSON.
Values json_values(std::string_view text, std::string_view key) {
    const auto json = parse_json(text);
    if (!json.is_object()) return {};
    const auto found = json.find(key);
    if (found == json.end()) return {};
    return {std::string(trimmed(json_text(*found)))};
}

struct Source {
    std::string_view file;  ///< whole name, or after a '*' its ending
    std::string_view key;
    Values (*values)(std::string_view text, std::string_view key);
    double um;  ///< per unit of the value
};
constexpr std::array<Source, 7> sources = {Source{"config.ini", "layerHeight", ini_values, um_per_mm},
                                           Source{"prusaslicer.ini", "layer_height", ini_values, um_per_mm},
                                           Source{"slicer.json", "Thickness", json_values, 1},
                                           Source{"profile.json", "Depth", json_values, 1},
                                           Source{"slice.conf", "thickness", ini_values, um_per_mm},
                                           Source{"*.slicing", "SliceHeight", xml_values, um_per_mm},
                                           Source{"manifest.uvtools", "LayerHeight", xml_values, um_per_mm}};

bool is_named(const std::string& name, std::string_view pattern) {
    return pattern.starts_with('*') ? name.ends_with(pattern.substr(1)) : name == pattern;
}

Result<double> height_um(const std::string& value, const Source& source, const std::string& file) {
    constexpr double most_um = 10000;
    char* end = nullptr;
    const double um = std::strtod(value.c_str(), &end) * source.um;
    if (value.empty() || *end != '\0' || !(um > 0 && um < most_um))
        return input_error("{}: {} = \"{}\": a layer height above 0 and below 10 mm is needed", file, source.key,
                           value);
    return um;
}

/// nullopt: there is no such file, or it does not have the key.
Result<std::optional<double>> height_from(const Source& source, const std::vector<std::string>& names,
                                          const SideText& text) {
    const auto file =
        std::find_if(names.begin(), names.end(), [&](const std::string& n) { return is_named(n, source.file); });
    if (file == names.end()) return std::nullopt;
    const Result<std::string> content = text(*file);
    if (!content) return tl::unexpected(content.error());
    std::optional<double> found;
    for (const std::string& value : source.values(*content, source.key)) {
        const Result<double> um = height_um(value, source, *file);
        if (!um) return tl::unexpected(um.error());
        constexpr double same_um = 1e-3;
        if (found && std::fabs(*found - *um) > same_um)
            return input_error("{}: {} is {:g} um and {:g} um: layers of one height are needed", *file, source.key,
                               *found, *um);
        found = *um;
    }
    return found;
}

}  // namespace

Result<std::optional<double>> stated_layer_um(const std::vector<std::string>& names, const SideText& text) {
    for (const Source& source : sources) {
        Result<std::optional<double>> found = height_from(source, names, text);
        if (!found || *found) return found;
    }
    return std::nullopt;
}

Result<std::optional<double>> stated_first_layer_um(const std::vector<std::string>& names, const SideText& text) {
    return height_from({"prusaslicer.ini", "initial_layer_height", ini_values, um_per_mm}, names, text);
}

namespace {

/// A pixel is `size` / `count` mm, or 1 / `count` where the size is "", or `size` where the count is "".
struct PixelSource {
    std::string_view file;
    Values (*values)(std::string_view text, std::string_view key);
    std::string_view size_x, count_x, size_y, count_y;
};
constexpr std::array<PixelSource, 4> pixel_sources = {
    PixelSource{"prusaslicer.ini", ini_values, "display_width", "display_pixels_x", "display_height",
                "display_pixels_y"},
    PixelSource{"slicer.json", json_values, "XPixelSize", "", "YPixelSize", ""},
    PixelSource{"*.slicing", xml_values, "", "DotsPermmX", "", "DotsPermmY"},
    PixelSource{"manifest.uvtools", xml_values, "DisplayWidth", "ResolutionX", "DisplayHeight", "ResolutionY"}};

/// 1 without a key; 0 where the file does not say, as programs write for what they do not know.
double amount(const PixelSource& source, const std::string& text, std::string_view key) {
    if (key.empty()) return 1;
    const Values values = source.values(text, key);
    if (values.size() != 1) return 0;
    char* end = nullptr;
    const double value = std::strtod(values.front().c_str(), &end);
    return *end == '\0' && std::isfinite(value) && value > 0 ? value : 0;
}

}  // namespace

Result<std::optional<PixelSize>> stated_pixel(const std::vector<std::string>& names, const SideText& text) {
    for (const PixelSource& source : pixel_sources) {
        const auto file =
            std::find_if(names.begin(), names.end(), [&](const std::string& n) { return is_named(n, source.file); });
        if (file == names.end()) continue;
        const Result<std::string> content = text(*file);
        if (!content) return tl::unexpected(content.error());
        const auto edge_um = [&](std::string_view size, std::string_view count) {
            const double pixels = amount(source, *content, count);
            return pixels > 0 ? um_per_mm * amount(source, *content, size) / pixels : 0;
        };
        const PixelSize pixel{edge_um(source.size_x, source.count_x), edge_um(source.size_y, source.count_y)};
        if (pixel.x_um > 0 && pixel.y_um > 0) return pixel;
    }
    return std::nullopt;
}

}  // namespace pliant::job
