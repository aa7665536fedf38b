#include "printing/job/export_texts.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/core/json.hpp"

namespace pliant::job {
namespace {

using Ordered = nlohmann::ordered_json;

constexpr const char* no_date = "1980-01-01 at 00:00:00 UTC";  // equal jobs give equal bytes

/// One line, without characters that end a value in an .ini file.
std::string one_line(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < 32 || c == 127; }, ' ');
    return text;
}

std::string file_text(const Ordered& value) {
    return json_text(value, 1) + "\n";
}

/// A line of info.json.
Ordered layer_info(const ImageAreas& areas, double pixel_mm2) {
    return {{"TotalSolidArea", areas.total_px * pixel_mm2},
            {"LargestArea", areas.largest_px * pixel_mm2},
            {"SmallestArea", areas.smallest_px * pixel_mm2},
            {"MinX", areas.min_x},
            {"MinY", areas.min_y},
            {"MaxX", areas.max_x},
            {"MaxY", areas.max_y},
            {"AreaCount", areas.count}};
}

/// First and last lit pixel over all layers, as one component; none if all are dark.
ImageAreas whole(const std::vector<ImageAreas>& layers) {
    ImageAreas all;
    for (const ImageAreas& a : layers) {
        if (a.count == 0) continue;
        all.min_x = all.count == 0 ? a.min_x : std::min(all.min_x, a.min_x);
        all.min_y = all.count == 0 ? a.min_y : std::min(all.min_y, a.min_y);
        all.max_x = std::max(all.max_x, a.max_x);
        all.max_y = std::max(all.max_y, a.max_y);
        all.total_px += a.total_px;
        all.count = 1;
    }
    return all;
}

/// Bottom of the lowest and top of the highest layer with light, mm.
std::pair<double, double> z_mm(const Manifest& m, const std::vector<ImageAreas>& layers) {
    double low = 0, high = 0;
    for (std::size_t k = 0; k < layers.size(); ++k) {
        if (layers[k].count == 0) continue;
        if (high == 0) low = (m.layers[k].z_um - m.layers[k].thickness_um) / 1000.0;
        high = m.layers[k].z_um / 1000.0;
    }
    return {low, high};
}

}  // namespace

double StackFacts::volume_mm3() const {
    double sum = 0;
    for (std::size_t k = 0; k < area_mm2.size(); ++k) sum += area_mm2[k] * manifest.layers[k].thickness_um / 1000;
    return sum;
}

double StackFacts::first_light_s() const {
    return bottom_layers(manifest, of()) > 0 ? of().bottom_exposure_s : of().exposure_s;
}

int StackFacts::fading_layers() const {
    constexpr double longest = 10000;
    const double normal = of().exposure_s, first = of().bottom_exposure_s;
    const double low = std::min(normal, first), high = std::max(normal, first);
    const auto bottom = static_cast<std::size_t>(std::max(0, bottom_layers(manifest, of())));
    std::size_t end = bottom;
    bool ended = false;
    for (std::size_t k = bottom; k < light_s.size() && !ended; ++k) {
        if (area_mm2[k] == 0) continue;  // dark: no information
        ended = light_s[k] <= low || light_s[k] >= high;
        if (!ended) end = k + 1;
    }
    if (ended || end == bottom) return static_cast<int>(end - bottom);
    // The part ends before the fade does: its slope tells how long it would be.
    const double fallen = (light_s[end - 1] - first) / (normal - first);
    const double steps = static_cast<double>(end - bottom) / fallen;
    return static_cast<int>(std::clamp(std::round(steps) - 1, static_cast<double>(end - bottom), longest));
}

StackFacts facts_of(const Manifest& manifest, int material, const std::string& image_prefix) {
    const std::size_t count = manifest.layers.size();
    StackFacts facts{
        manifest, material, image_prefix, std::vector<double>(count, 0.0), 0, std::vector<double>(count, 0.0)};
    if (count > 0) facts.layer_um = manifest.layers.front().thickness_um;
    for (std::size_t k = 0; k < count; ++k) {
        const bool bottom = static_cast<int>(k) < bottom_layers(manifest, facts.of());
        facts.light_s[k] = bottom ? facts.of().bottom_exposure_s : facts.of().exposure_s;
        for (std::size_t i = 0; i < manifest.layers[k].images.size(); ++i) {
            if (manifest.layers[k].images[i].material != material) continue;
            facts.area_mm2[k] = manifest.layers[k].images[i].area_mm2;
            facts.light_s[k] = exposure_s(manifest, k, i);
        }
    }
    return facts;
}

std::vector<double> sl1_lights_s(const StackFacts& s) {
    const double normal = s.of().exposure_s, first = s.first_light_s();
    const int fading = s.fading_layers();
    std::vector<double> lights_s;
    for (std::size_t k = 0; k < s.light_s.size(); ++k) {
        const double left = std::max(0.0, 1 - static_cast<double>(k) / (fading + 1));
        lights_s.push_back(normal + left * (first - normal));
    }
    return lights_s;
}

std::vector<double> nanodlp_lights_s(const StackFacts& s) {
    const double normal = s.of().exposure_s, bottom = s.of().bottom_exposure_s;
    const int fading = s.fading_layers();
    std::vector<double> lights_s;
    for (std::size_t k = 0; k < s.light_s.size(); ++k) {
        const double above = static_cast<double>(k) + 1 - std::max(0, bottom_layers(s.manifest, s.of()));
        const double left = std::clamp(1 - above / (fading + 1), 0.0, 1.0);
        lights_s.push_back(normal + left * (bottom - normal));
    }
    return lights_s;
}

int layers_of_other_light(const StackFacts& s, const std::vector<double>& said_s) {
    constexpr double rounding = 1e-3;
    int count = 0;
    for (std::size_t k = 0; k < s.light_s.size(); ++k) {
        if (s.area_mm2[k] == 0) continue;
        count += std::fabs(s.light_s[k] - said_s[k]) > rounding * s.of().exposure_s ? 1 : 0;
    }
    return count;
}

std::vector<NamedText> sl1_texts(const StackFacts& s) {
    const Manifest& m = s.manifest;
    const Material& material = s.of();
    const double pixel_mm = m.pixel_um / 1000, layer_mm = s.layer_um / 1000;
    double seconds = 0;
    for (const double light : s.light_s) seconds += light;
    const std::string config = fmt::format(
        "action = print\nexpTime = {}\nexpTimeFirst = {}\nexpUserProfile = 0\nfileCreationTimestamp = {}\nhollow = 0\n"
        "jobDir = {}\nlayerHeight = {}\nmaterialName = {}\nnumFade = {}\nnumFast = {}\nnumSlow = 0\n"
        "printProfile = Pliant\nprintTime = {:.3f}\nprinterModel = SL1\nprinterProfile = Pliant\nprinterVariant = "
        "default\n"
        "prusaSlicerVersion = Pliant {}\nusedMaterial = {:.6f}\n",
        material.exposure_s, s.first_light_s(), no_date, s.image_prefix, layer_mm, one_line(material.resin),
        s.fading_layers(), m.layers.size(), seconds, m.pliant_version, s.volume_mm3() / 1000);
    double height_mm = 0;
    if (!m.layers.empty()) height_mm = m.layers.back().z_um / 1000.0;
    const std::string settings = fmt::format(
        "printer_technology = SLA\nbottle_cost = 0\nbottle_volume = 1000\nbottle_weight = 1\n"
        "display_height = {}\ndisplay_mirror_x = 0\ndisplay_mirror_y = 0\ndisplay_orientation = landscape\n"
        "display_pixels_x = {}\ndisplay_pixels_y = {}\ndisplay_width = {}\nexposure_time = {}\nfaded_layers = {}\n"
        "gamma_correction = 1\ninitial_exposure_time = {}\ninitial_layer_height = {}\nlayer_height = {}\n"
        "max_print_height = {}\nprinter_notes = \n",
        pixel_mm * m.height_px, m.width_px, m.height_px, pixel_mm * m.width_px, material.exposure_s, s.fading_layers(),
        s.first_light_s(), layer_mm, layer_mm, std::max(height_mm, 1.0));
    return {{"config.ini", config}, {"prusaslicer.ini", settings}};
}

std::vector<NamedText> zip_texts(const StackFacts& s) {
    const Manifest& m = s.manifest;
    const double pixel_mm = m.pixel_um / 1000;
    const double height_mm = m.layers.empty() ? 0 : m.layers.back().z_um / 1000.0;
    return {{"manifest.uvtools",
             fmt::format("<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<Manifest>\n  <LayerHeight>{}</LayerHeight>\n"
                         "  <ResolutionX>{}</ResolutionX>\n  <ResolutionY>{}</ResolutionY>\n"
                         "  <DisplayWidth>{}</DisplayWidth>\n  <DisplayHeight>{}</DisplayHeight>\n"
                         "  <MachineZ>{}</MachineZ>\n</Manifest>\n",
                         s.layer_um / 1000, m.width_px, m.height_px, pixel_mm * m.width_px, pixel_mm * m.height_px,
                         std::max(height_mm, 1.0))}};
}

std::vector<NamedText> nanodlp_texts(const StackFacts& s, const std::vector<ImageAreas>& areas) {
    const Manifest& m = s.manifest;
    const Material& material = s.of();
    const double pixel_mm = m.pixel_um / 1000, pixel_mm2 = pixel_mm * pixel_mm;
    const int count = static_cast<int>(m.layers.size());
    Ordered info = Ordered::array();
    for (const ImageAreas& layer : areas) info.push_back(layer_info(layer, pixel_mm2));
    // The part's box, from the middle of the image; y upwards.
    const ImageAreas all = whole(areas);
    const double x_mm = pixel_mm * m.width_px / 2, y_mm = pixel_mm * m.height_px / 2;
    const auto [z_low, z_high] = z_mm(m, areas);
    const int past = all.count;  // one past the last pixel, if there is one
    const Ordered meta{
        {"FormatVersion", 1}, {"Distro", "generic"}, {"Program", "Pliant"}, {"Version", m.pliant_version},
        {"OS", ""},           {"Arch", ""},          {"Profile", true}};
    const Ordered plate{{"PlateID", 1},
                        {"ProfileID", 1},
                        {"Path", m.name},
                        {"LayersCount", count},
                        {"XRes", m.width_px},
                        {"YRes", m.height_px},
                        {"ZRes", s.layer_um},
                        {"TotalSolidArea", all.total_px * pixel_mm2},
                        {"XMin", past * (all.min_x * pixel_mm - x_mm)},
                        {"XMax", past * ((all.max_x + 1) * pixel_mm - x_mm)},
                        {"YMin", past * (y_mm - (all.max_y + 1) * pixel_mm)},
                        {"YMax", past * (y_mm - all.min_y * pixel_mm)},
                        {"ZMin", z_low},
                        {"ZMax", z_high},
                        {"MultiMaterial", false}};
    const Ordered profile{{"ProfileID", 1},
                          {"Title", material.resin},
                          {"Depth", s.layer_um},
                          {"CureTime", material.exposure_s},
                          {"SupportCureTime", material.bottom_exposure_s},
                          {"SupportDepth", s.layer_um},
                          {"SupportLayerNumber", bottom_layers(m, material)},
                          {"TransitionalLayer", s.fading_layers()},
                          {"WaitBeforePrint", 0},
                          {"WaitAfterPrint", 0},
                          {"TopWait", 0}};
    const Ordered slicer{{"PWidth", m.width_px},   {"PHeight", m.height_px},  {"XPixelSize", pixel_mm},
                         {"YPixelSize", pixel_mm}, {"Thickness", s.layer_um}, {"ImageMirror", 0},
                         {"LayerCount", count},    {"MultiMaterial", false}};
    return {{"meta.json", file_text(meta)},
            {"plate.json", file_text(plate)},
            {"profile.json", file_text(profile)},
            {"slicer.json", file_text(slicer)},
            {"info.json", file_text(info)}};
}

}  // namespace pliant::job
