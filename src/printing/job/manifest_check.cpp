#include <algorithm>
#include <cmath>
#include <set>

#include "base/core/letters.hpp"
#include "printing/job/exposure.hpp"
#include "printing/job/manifest.hpp"
#include "printing/job/sha256.hpp"

namespace pliant::job {
namespace {

constexpr std::size_t max_materials = 255;
constexpr std::size_t max_layers = 1000000;

bool is_amount(double value) {
    return std::isfinite(value) && value >= 0;
}

/// "#rrggbb"
bool is_colour(std::string_view text) {
    return text.size() == 7 && text[0] == '#' &&
           text.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string_view::npos;
}

/// Names go to terminals, and into comments of programs.
bool has_control(std::string_view name) {
    return std::any_of(name.begin(), name.end(), is_control);
}

Status check_material(const Material& m, std::size_t i, std::string_view where) {
    if (m.name.empty()) return input_error("{}: materials[{}].name: must not be empty", where, i);
    const auto odd_part = [](const MaterialPart& part) { return has_control(part.name); };
    if (has_control(m.name) || has_control(m.resin) || std::any_of(m.parts.begin(), m.parts.end(), odd_part))
        return input_error("{}: materials[{}]: name or resin has a line break or another control character", where, i);
    const std::pair<const char*, double> amounts[] = {{"model_volume_mm3", m.model_volume_mm3},
                                                      {"model_area_mm2", m.model_area_mm2},
                                                      {"exposure_s", m.exposure_s},
                                                      {"bottom_exposure_s", m.bottom_exposure_s}};
    for (const auto& [key, value] : amounts) {
        if (!is_amount(value)) return input_error("{}: materials[{}].{}: {} must be 0 or more", where, i, key, value);
    }
    if (m.bottom_layers.value_or(0) < 0)
        return input_error("{}: materials[{}].bottom_layers: {} must be 0 or more", where, i, *m.bottom_layers);
    if (!m.colour.empty() && !is_colour(m.colour))
        return input_error("{}: materials[{}].colour: '{}' must be like #rrggbb", where, i, m.colour);
    if (m.parts.size() == 1)
        return input_error("{}: materials[{}].parts: has one entry; it lists two or more materials, or is left out",
                           where, i);
    for (std::size_t p = 0; p < m.parts.size(); ++p) {
        const MaterialPart& part = m.parts[p];
        if (part.name.empty() || !is_amount(part.model_volume_mm3) || !is_amount(part.model_area_mm2))
            return input_error("{}: materials[{}].parts[{}]: needs a name, a volume and an area of 0 or more", where, i,
                               p);
    }
    return {};
}

Status check_materials(const std::vector<Material>& materials, std::string_view where) {
    if (materials.size() > max_materials)
        return input_error("{}: {} materials, at most {} are allowed", where, materials.size(), max_materials);
    std::set<std::string_view> names;
    for (std::size_t i = 0; i < materials.size(); ++i) {
        if (auto status = check_material(materials[i], i, where); !status) return status;
        if (!names.insert(materials[i].name).second)
            return input_error("{}: materials[{}].name: '{}' is named twice", where, i, materials[i].name);
    }
    return {};
}

Status check_images(const Manifest& manifest, std::size_t k, std::string_view where) {
    int previous = -1;
    const int count = static_cast<int>(manifest.materials.size());
    for (std::size_t i = 0; i < manifest.layers[k].images.size(); ++i) {
        const LayerImage& image = manifest.layers[k].images[i];
        const std::string key = fmt::format("layers[{}].images[{}]", k, i);
        if (image.material < 0 || image.material >= count)
            return input_error("{}: {}.material: {} is not one of the {} materials", where, key, image.material, count);
        if (image.material <= previous)
            return input_error("{}: {}.material: {} after {}; each material comes once, in order", where, key,
                               image.material, previous);
        if (!is_safe_entry_name(image.file))
            return input_error("{}: {}.file: '{}' must be a plain relative path inside the archive", where, key,
                               image.file);
        if (!is_amount(image.area_mm2))
            return input_error("{}: {}.area_mm2: {} must be 0 or more", where, key, image.area_mm2);
        if (!(is_amount(image.exposure_s) && image.exposure_s <= longest_exposure_s))
            return input_error("{}: {}.exposure_s: {} must be above 0 and at most {}", where, key, image.exposure_s,
                               longest_exposure_s);
        if (!(is_amount(image.shared_mm2) && image.shared_mm2 <= image.area_mm2 * (1 + 1e-9)))
            return input_error("{}: {}.shared_mm2: {} must be 0 to area_mm2, {}", where, key, image.shared_mm2,
                               image.area_mm2);
        previous = image.material;
    }
    return {};
}

Status check_layers(const Manifest& manifest, std::string_view where) {
    if (manifest.layers.size() > max_layers)
        return input_error("{}: {} layers, at most {} are allowed", where, manifest.layers.size(), max_layers);
    int below_um = 0;
    for (std::size_t k = 0; k < manifest.layers.size(); ++k) {
        const Layer& layer = manifest.layers[k];
        if (layer.z_um <= below_um)
            return input_error("{}: layers[{}].z_um: {} must be above the layer before, {}", where, k, layer.z_um,
                               below_um);
        if (layer.thickness_um < 1 || layer.thickness_um > layer.z_um)
            return input_error("{}: layers[{}].thickness_um: {} must be 1 to z_um, {}", where, k, layer.thickness_um,
                               layer.z_um);
        if (layer.thickness_um != layer.z_um - below_um)
            return input_error("{}: layers[{}].thickness_um: {} must be the step of z_um, {}", where, k,
                               layer.thickness_um, layer.z_um - below_um);
        if (auto status = check_images(manifest, k, where); !status) return status;
        below_um = layer.z_um;
    }
    return {};
}

Status check_findings(const Manifest& m, std::string_view where) {
    const int layers = static_cast<int>(m.layers.size());
    for (std::size_t i = 0; i < m.findings.size(); ++i) {
        const Finding& f = m.findings[i];
        if (f.first_layer < 0 || f.last_layer < f.first_layer || f.last_layer >= layers)
            return input_error("{}: findings[{}]: layers {} to {}, counted from 0, are not layers of the {} there are",
                               where, i, f.first_layer, f.last_layer, layers);
        if (f.row < 0 || f.row >= m.height_px || f.column < 0 || f.column >= m.width_px)
            return input_error("{}: findings[{}]: row {}, column {} lies outside the image", where, i, f.row, f.column);
        if (!is_amount(f.area_mm2) || !is_amount(f.volume_mm3))
            return input_error("{}: findings[{}]: its area and volume must be 0 or more", where, i);
        if (f.count < 1) return input_error("{}: findings[{}].count: {} must be 1 or more", where, i, f.count);
        if (!f.picture.empty() && !is_safe_entry_name(f.picture))
            return input_error("{}: findings[{}].picture: '{}' must be a plain relative path inside the archive", where,
                               i, f.picture);
    }
    return {};
}

/// A manifest with hashes must have one for every image.
Status check_sha256(const Manifest& m, std::string_view where) {
    if (m.sha256.empty()) return {};
    for (const auto& [file, hash] : m.sha256) {
        if (!is_safe_entry_name(file) || file == "manifest.json" || !is_sha256_hex(hash))
            return input_error("{}: sha256: \"{}\": \"{}\" must be an entry with 64 hex digits in lower case", where,
                               file, hash);
    }
    for (std::size_t k = 0; k < m.layers.size(); ++k) {
        for (const LayerImage& image : m.layers[k].images) {
            if (!m.sha256.contains(image.file))
                return input_error("{}: sha256: \"{}\", an image of layer {}, is missing", where, image.file, k + 1);
        }
    }
    return {};
}

}  // namespace

bool is_safe_entry_name(std::string_view name) {
    if (name.empty() || name.size() > 200) return false;
    const auto unsafe = [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127 || c == '\\' || c == ':'; };
    if (std::any_of(name.begin(), name.end(), unsafe)) return false;
    for (std::size_t begin = 0; begin <= name.size();) {
        const std::size_t end = std::min(name.find('/', begin), name.size());
        const std::string_view part = name.substr(begin, end - begin);
        if (part.empty() || part == "." || part == "..") return false;
        begin = end + 1;
    }
    return true;
}

Status check(const Manifest& manifest, std::string_view where) {
    constexpr int max_side_px = 65535;
    const int width = manifest.width_px, height = manifest.height_px;
    if (width < 1 || height < 1 || width > max_side_px || height > max_side_px ||
        static_cast<long long>(width) * height > (1LL << 28))
        return input_error("{}: width_px, height_px: {} x {} must be 1 to {} each and 2^28 pixels in all", where, width,
                           height, max_side_px);
    if (!(manifest.pixel_um > 0 && manifest.pixel_um <= 10000))
        return input_error("{}: pixel_um: {} must be above 0 and at most 10000", where, manifest.pixel_um);
    if (has_control(manifest.name))
        return input_error("{}: name: has a line break or another control character", where);
    if (manifest.bottom_layers < 0)
        return input_error("{}: bottom_layers: {} must be 0 or more", where, manifest.bottom_layers);
    if (auto status = check_materials(manifest.materials, where); !status) return status;
    if (auto status = check_layers(manifest, where); !status) return status;
    if (auto status = check_findings(manifest, where); !status) return status;
    return check_sha256(manifest, where);
}

std::string image_file_name(int layer, std::string_view material) {
    std::string name;
    for (const char c : material.substr(0, 100)) {
        const bool plain =
            (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
        name.push_back(plain ? c : '_');
    }
    return fmt::format("layers/{:05}_{}.png", layer, name);
}

}  // namespace pliant::job
