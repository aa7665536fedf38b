#include "job/export_texts.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace pliant::job {
namespace {

using Ordered = nlohmann::ordered_json;

constexpr const char* no_date = "1980-01-01 at 00:00:00 UTC";  // equal jobs give equal bytes

/// One line without what ends a value of an .ini file.
std::string one_line(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < 32 || c == 127; }, ' ');
    return text;
}

std::string json_text(const Ordered& value) {
    return value.dump(1, ' ', false, Ordered::error_handler_t::replace) + "\n";
}

}  // namespace

double StackFacts::total_area_mm2() const {
    double sum = 0;
    for (const double a : area_mm2) sum += a;
    return sum;
}

double StackFacts::volume_mm3() const {
    double sum = 0;
    for (std::size_t k = 0; k < area_mm2.size(); ++k) sum += area_mm2[k] * manifest.layers[k].thickness_um / 1000;
    return sum;
}

std::vector<NamedText> sl1_texts(const StackFacts& s) {
    const Manifest& m = s.manifest;
    const Material& material = m.materials[static_cast<std::size_t>(s.material)];
    const double pixel_mm = m.pixel_um / 1000, layer_mm = s.layer_um / 1000;
    const double seconds = static_cast<double>(m.layers.size()) * material.exposure_s +
                           m.bottom_layers * (material.bottom_exposure_s - material.exposure_s);
    const std::string config = fmt::format(
        "action = print\nexpTime = {}\nexpTimeFirst = {}\nexpUserProfile = 0\nfileCreationTimestamp = {}\nhollow = 0\n"
        "jobDir = {}\nlayerHeight = {}\nmaterialName = {}\nnumFade = {}\nnumFast = {}\nnumSlow = 0\n"
        "printProfile = Pliant\nprintTime = {:.3f}\nprinterModel = SL1\nprinterProfile = Pliant\nprinterVariant = "
        "default\n"
        "prusaSlicerVersion = Pliant {}\nusedMaterial = {:.6f}\n",
        material.exposure_s, material.bottom_exposure_s, no_date, s.image_prefix, layer_mm, one_line(material.resin),
        m.bottom_layers, m.layers.size(), seconds, m.pliant_version, s.volume_mm3() / 1000);
    double height_mm = 0;
    if (!m.layers.empty()) height_mm = m.layers.back().z_um / 1000.0;
    const std::string settings = fmt::format(
        "printer_technology = SLA\nbottle_cost = 0\nbottle_volume = 1000\nbottle_weight = 1\n"
        "display_height = {}\ndisplay_mirror_x = 0\ndisplay_mirror_y = 0\ndisplay_orientation = landscape\n"
        "display_pixels_x = {}\ndisplay_pixels_y = {}\ndisplay_width = {}\nexposure_time = {}\nfaded_layers = {}\n"
        "gamma_correction = 1\ninitial_exposure_time = {}\ninitial_layer_height = {}\nlayer_height = {}\n"
        "max_print_height = {}\nprinter_notes = \n",
        pixel_mm * m.height_px, m.width_px, m.height_px, pixel_mm * m.width_px, material.exposure_s, m.bottom_layers,
        material.bottom_exposure_s, layer_mm, layer_mm, std::max(height_mm, 1.0));
    return {{"config.ini", config}, {"prusaslicer.ini", settings}};
}

std::vector<NamedText> nanodlp_texts(const StackFacts& s) {
    const Manifest& m = s.manifest;
    const Material& material = m.materials[static_cast<std::size_t>(s.material)];
    const double pixel_mm = m.pixel_um / 1000;
    const int count = static_cast<int>(m.layers.size());
    const double z_mm = m.layers.empty() ? 0 : m.layers.back().z_um / 1000.0;
    Ordered info = Ordered::array();
    for (const double area : s.area_mm2)
        info.push_back({{"TotalSolidArea", area},
                        {"LargestArea", area},
                        {"SmallestArea", area},
                        {"MinX", 0},
                        {"MinY", 0},
                        {"MaxX", m.width_px - 1},
                        {"MaxY", m.height_px - 1},
                        {"AreaCount", area > 0 ? 1 : 0}});
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
                        {"TotalSolidArea", s.total_area_mm2()},
                        {"XMin", -pixel_mm * m.width_px / 2},
                        {"XMax", pixel_mm * m.width_px / 2},
                        {"YMin", -pixel_mm * m.height_px / 2},
                        {"YMax", pixel_mm * m.height_px / 2},
                        {"ZMin", 0},
                        {"ZMax", z_mm},
                        {"MultiMaterial", false}};
    const Ordered profile{{"ProfileID", 1},
                          {"Title", material.resin},
                          {"Depth", s.layer_um},
                          {"CureTime", material.exposure_s},
                          {"SupportCureTime", material.bottom_exposure_s},
                          {"SupportDepth", s.layer_um},
                          {"SupportLayerNumber", m.bottom_layers},
                          {"TransitionalLayer", 0}};
    const Ordered slicer{{"PWidth", m.width_px},   {"PHeight", m.height_px},  {"XPixelSize", pixel_mm},
                         {"YPixelSize", pixel_mm}, {"Thickness", s.layer_um}, {"ImageMirror", 0},
                         {"LayerCount", count},    {"MultiMaterial", false}};
    return {{"meta.json", json_text(meta)},
            {"plate.json", json_text(plate)},
            {"profile.json", json_text(profile)},
            {"slicer.json", json_text(slicer)},
            {"info.json", json_text(info)}};
}

}  // namespace pliant::job
