#include "printing/prepare/printed_together.hpp"

#include <algorithm>
#include <set>

#include "printing/slice/mask.hpp"

namespace pliant::job {
namespace {

template <class Value>
bool same(const std::map<std::string, Value>& of, const std::string& a, const std::string& b) {
    const auto first = of.find(a), second = of.find(b);
    if (first == of.end() || second == of.end()) return first == second;
    return first->second == second->second;
}

bool bonded(const std::string& material, const JobSettings& settings) {
    return std::any_of(settings.slicing.bonds.begin(), settings.slicing.bonds.end(),
                       [&](const slice::Bond& b) { return b.first == material || b.second == material; });
}

bool lit_alike(const Material& a, const Material& b, const JobSettings& settings) {
    return !a.resin.empty() && a.resin == b.resin && a.exposure_s == b.exposure_s &&
           a.bottom_exposure_s == b.bottom_exposure_s && a.bottom_layers == b.bottom_layers &&
           same(settings.exposures, a.name, b.name) && same(settings.slicing.compensation, a.name, b.name) &&
           !bonded(a.name, settings) && !bonded(b.name, settings);
}

/// "a+b", "a+b+c+4 more"; never the name of another material.
std::string joint_name(const std::vector<MaterialPart>& parts, std::set<std::string>& taken) {
    constexpr std::size_t most_names = 3;
    std::string name;
    for (std::size_t i = 0; i < std::min(parts.size(), most_names); ++i) name += (i > 0 ? "+" : "") + parts[i].name;
    if (parts.size() > most_names) name += fmt::format("+{} more", parts.size() - most_names);
    while (!taken.insert(name).second) name += "+";
    return name;
}

}  // namespace

PrintedTogether printed_together(std::span<const Material> drawn, const JobSettings& settings) {
    PrintedTogether result;
    std::vector<Material> first;  // per printed material, the first of its parts
    for (const Material& material : drawn) {
        const auto like = std::find_if(first.begin(), first.end(),
                                       [&](const Material& known) { return lit_alike(known, material, settings); });
        result.printed_as.push_back(static_cast<int>(like - first.begin()));
        if (like == first.end()) {
            first.push_back(material);
            result.materials.push_back(material);
            result.materials.back().parts.clear();
        }
        result.materials[static_cast<std::size_t>(result.printed_as.back())].parts.push_back(
            {material.name, material.model_volume_mm3, material.model_area_mm2});
    }
    std::set<std::string> taken;
    for (const Material& material : drawn) taken.insert(material.name);
    for (Material& material : result.materials) {
        if (material.parts.size() == 1) {
            material.parts.clear();
            continue;
        }
        material.name = joint_name(material.parts, taken);
        material.model_volume_mm3 = material.model_area_mm2 = 0;
        for (const MaterialPart& part : material.parts) {
            material.model_volume_mm3 += part.model_volume_mm3;
            material.model_area_mm2 += part.model_area_mm2;
        }
    }
    return result;
}

void put_together(slice::ComposedLayer& layer, std::span<const int> printed_as) {
    std::vector<slice::MaterialImage> images;
    for (slice::MaterialImage& own : layer.images) {
        own.material = printed_as[static_cast<std::size_t>(own.material)];
        const auto known = std::find_if(images.begin(), images.end(),
                                        [&](const slice::MaterialImage& m) { return m.material == own.material; });
        if (known == images.end()) {
            images.push_back(std::move(own));
            continue;
        }
        known->image = slice::together(known->image, own.image);
        known->value_sum += own.value_sum;
        known->shared_sum += own.shared_sum;
    }
    std::sort(images.begin(), images.end(),
              [](const slice::MaterialImage& a, const slice::MaterialImage& b) { return a.material < b.material; });
    layer.images = std::move(images);
}

}  // namespace pliant::job
