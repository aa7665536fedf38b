#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "base/core/json.hpp"
#include "printing/job/manifest.hpp"

namespace pliant::job {
namespace {

using Json = nlohmann::json;
using Ordered = nlohmann::ordered_json;

/// Reads the keys of one object; keeps the first problem and returns harmless values after it.
class Fields {
public:
    Fields(const Json& object, std::string path, std::string& problem)
        : object_(object), path_(std::move(path)), problem_(problem) {
        if (!object.is_object()) complain("", "an object is needed");
    }

    std::string text(const char* key) {
        const Json* value = find(key);
        if (value == nullptr) return {};
        if (value->is_string()) return value->get<std::string>();
        complain(key, "a text is needed");
        return {};
    }
    int integer(const char* key) {
        const Json* value = find(key);
        if (value == nullptr) return 0;
        // Unsigned first: JSON numbers beyond signed 64 bits are stored as unsigned.
        constexpr int most = std::numeric_limits<int>::max(), least = std::numeric_limits<int>::min();
        if (value->is_number_unsigned() && value->get<std::uint64_t>() <= most) return value->get<int>();
        if (value->is_number_integer() && !value->is_number_unsigned() && value->get<std::int64_t>() >= least)
            return value->get<int>();
        complain(key, "a whole number of at most 31 bits is needed");
        return 0;
    }
    double number(const char* key) {
        const Json* value = find(key);
        if (value == nullptr) return 0;
        if (value->is_number()) return value->get<double>();
        complain(key, "a number is needed");
        return 0;
    }
    [[nodiscard]] bool has(const char* key) const { return problem_.empty() && object_.contains(key); }
    double number_or_zero(const char* key) { return has(key) ? number(key) : 0; }
    bool flag(const char* key) {
        if (!has(key)) return false;
        const Json& value = object_.at(key);
        if (value.is_boolean()) return value.get<bool>();
        complain(key, "true or false is needed");
        return false;
    }
    /// Calls `read(entry, path)` for the entries of an array until a problem occurs.
    template <class Read>
    void each(const char* key, const Read& read) {
        const Json* value = find(key);
        if (value == nullptr) return;
        if (!value->is_array()) return complain(key, "an array is needed");
        for (std::size_t i = 0; i < value->size() && problem_.empty(); ++i)
            read((*value)[i], fmt::format("{}{}[{}]", path_, key, i));
    }
    /// An object whose values are texts.
    std::map<std::string, std::string> texts(const char* key) {
        std::map<std::string, std::string> result;
        const Json* value = find(key);
        if (value == nullptr) return result;
        if (!value->is_object()) return complain(key, "an object is needed"), result;
        for (const auto& [name, entry] : value->items()) {
            if (!entry.is_string()) return complain(key, fmt::format("\"{}\": a text is needed", name)), result;
            result.emplace(name, entry.get<std::string>());
        }
        return result;
    }
    void complain(std::string_view key, std::string_view text) {
        if (problem_.empty()) problem_ = fmt::format("{}{}: {}", path_, key, text);
    }

private:
    const Json* find(const char* key) {
        if (!problem_.empty()) return nullptr;
        const auto found = object_.find(key);
        if (found != object_.end()) return &*found;
        complain(key, "is missing");
        return nullptr;
    }

    const Json& object_;
    std::string path_;  ///< prefix of keys in messages
    std::string& problem_;
};

Material read_material(const Json& object, const std::string& path, std::string& problem) {
    Fields f(object, path + ".", problem);
    Material material{f.text("name"),
                      f.text("resin"),
                      f.number("model_volume_mm3"),
                      f.number("model_area_mm2"),
                      f.number("exposure_s"),
                      f.number("bottom_exposure_s")};
    if (f.has("colour")) material.colour = f.text("colour");
    if (f.has("bottom_layers")) material.bottom_layers = f.integer("bottom_layers");
    if (!f.has("parts")) return material;
    f.each("parts", [&](const Json& entry, const std::string& entry_path) {
        Fields part(entry, entry_path + ".", problem);
        material.parts.push_back({part.text("name"), part.number("model_volume_mm3"), part.number("model_area_mm2")});
    });
    return material;
}

Layer read_layer(const Json& object, const std::string& path, std::string& problem) {
    Fields f(object, path + ".", problem);
    Layer layer{f.integer("z_um"), f.integer("thickness_um"), {}};
    f.each("images", [&](const Json& entry, const std::string& entry_path) {
        Fields g(entry, entry_path + ".", problem);
        layer.images.push_back({g.integer("material"), g.text("file"), g.number("area_mm2"),
                                g.number_or_zero("exposure_s"), g.number_or_zero("shared_mm2")});
    });
    return layer;
}

Finding read_finding(const Json& object, const std::string& path, std::string& problem) {
    Fields f(object, path + ".", problem);
    Finding finding{f.text("kind"),
                    f.integer("first_layer"),
                    f.integer("last_layer"),
                    f.integer("row"),
                    f.integer("column"),
                    f.number_or_zero("area_mm2"),
                    f.number_or_zero("volume_mm3"),
                    {},
                    {},
                    1};
    if (f.has("picture")) finding.picture = f.text("picture");
    if (f.has("severity")) finding.severity = f.text("severity");
    if (f.has("count")) finding.count = f.integer("count");
    return finding;
}

Manifest read_manifest(const Json& root, std::string& problem) {
    Manifest m;
    Fields f(root, "", problem);
    const int format = f.integer("format");
    if (format != plain_format && format != sealed_format)
        f.complain("format", fmt::format("only formats {} and {} are known", plain_format, sealed_format));
    m.name = f.text("name");
    m.pliant_version = f.text("pliant_version");
    m.width_px = f.integer("width_px");
    m.height_px = f.integer("height_px");
    m.pixel_um = f.number("pixel_um");
    m.bottom_layers = f.integer("bottom_layers");
    f.each("materials", [&](const Json& entry, const std::string& path) {
        m.materials.push_back(read_material(entry, path, problem));
    });
    f.each("layers",
           [&](const Json& entry, const std::string& path) { m.layers.push_back(read_layer(entry, path, problem)); });
    f.each("warnings", [&](const Json& entry, const std::string& path) {
        if (entry.is_string()) return m.warnings.push_back(entry.get<std::string>());
        Fields(root, path, problem).complain("", "a text is needed");
    });
    m.compensated = f.flag("compensated");
    m.any_vat = f.flag("any_vat");
    if (format == sealed_format) {
        m.sha256 = f.texts("sha256");
        if (m.sha256.empty()) f.complain("sha256", "must not be empty");
    }
    if (!f.has("findings")) return m;
    f.each("findings", [&](const Json& entry, const std::string& path) {
        m.findings.push_back(read_finding(entry, path, problem));
    });
    return m;
}

/// "line 3, column 7", from the library's text about an error.
std::string place_in(std::string_view error) {
    const std::size_t begin = error.find("line ");
    return begin == std::string_view::npos ? "" : std::string(error.substr(begin, error.find(':', begin) - begin));
}

Result<Json> parse(std::string_view text, std::string_view where) {
    // No valid manifest is nested deeper; without the limit a file of brackets would take sixty times its size in
    // memory.
    constexpr int max_depth = 8;
    bool too_deep = false;
    const auto shallow = [&](int depth, Json::parse_event_t, Json&) {
        too_deep = too_deep || depth > max_depth;
        return depth <= max_depth;
    };
    try {
        Json root = Json::parse(text, shallow);
        if (too_deep) return input_error("{}: nested deeper than {} levels", where, max_depth);
        return root;
    } catch (const Json::exception& e) {
        const std::string place = place_in(e.what());
        if (place.empty()) return input_error("{}: {}", where, e.what());
        return input_error("{}: is not JSON: an error at {}", where, place);
    }
}

Ordered material_json(const Material& material) {
    Ordered entry{{"name", material.name},
                  {"resin", material.resin},
                  {"model_volume_mm3", material.model_volume_mm3},
                  {"model_area_mm2", material.model_area_mm2},
                  {"exposure_s", material.exposure_s},
                  {"bottom_exposure_s", material.bottom_exposure_s}};
    if (material.bottom_layers) entry["bottom_layers"] = *material.bottom_layers;
    if (!material.colour.empty()) entry["colour"] = material.colour;
    for (const MaterialPart& part : material.parts)
        entry["parts"].push_back({{"name", part.name},
                                  {"model_volume_mm3", part.model_volume_mm3},
                                  {"model_area_mm2", part.model_area_mm2}});
    return entry;
}

Ordered layer_json(const Layer& layer) {
    Ordered images = Ordered::array();
    for (const LayerImage& i : layer.images) {
        Ordered image{{"material", i.material}, {"file", i.file}, {"area_mm2", i.area_mm2}};
        if (i.exposure_s > 0) image["exposure_s"] = i.exposure_s;
        if (i.shared_mm2 > 0) image["shared_mm2"] = i.shared_mm2;
        images.push_back(std::move(image));
    }
    return {{"z_um", layer.z_um}, {"thickness_um", layer.thickness_um}, {"images", std::move(images)}};
}

Ordered finding_json(const Finding& f) {
    Ordered entry{{"kind", f.kind},
                  {"first_layer", f.first_layer},
                  {"last_layer", f.last_layer},
                  {"row", f.row},
                  {"column", f.column}};
    if (f.area_mm2 > 0) entry["area_mm2"] = f.area_mm2;
    if (f.volume_mm3 > 0) entry["volume_mm3"] = f.volume_mm3;
    if (!f.picture.empty()) entry["picture"] = f.picture;
    if (!f.severity.empty()) entry["severity"] = f.severity;
    if (f.count != 1) entry["count"] = f.count;
    return entry;
}

}  // namespace

std::string to_json(const Manifest& m) {
    Ordered root{{"format", m.sha256.empty() ? plain_format : sealed_format},
                 {"name", m.name},
                 {"pliant_version", m.pliant_version},
                 {"width_px", m.width_px},
                 {"height_px", m.height_px},
                 {"pixel_um", m.pixel_um},
                 {"bottom_layers", m.bottom_layers}};
    Ordered& materials = root["materials"] = Ordered::array();
    for (const Material& material : m.materials) materials.push_back(material_json(material));
    root["warnings"] = m.warnings;
    if (m.compensated) root["compensated"] = true;
    if (m.any_vat) root["any_vat"] = true;
    if (!m.sha256.empty()) root["sha256"] = m.sha256;
    if (!m.findings.empty()) {
        Ordered& findings = root["findings"] = Ordered::array();
        for (const Finding& finding : m.findings) findings.push_back(finding_json(finding));
    }
    Ordered& layers = root["layers"] = Ordered::array();
    for (const Layer& layer : m.layers) layers.push_back(layer_json(layer));
    return json_text(root, 1) + "\n";
}

Result<Manifest> manifest_from_json(std::string_view text, std::string_view where) {
    const auto root = parse(text, where);
    if (!root) return tl::unexpected(root.error());
    std::string problem;
    Manifest manifest = read_manifest(*root, problem);
    if (!problem.empty()) return input_error("{}: {}", where, problem);
    if (auto status = check(manifest, where); !status) return tl::unexpected(status.error());
    return manifest;
}

}  // namespace pliant::job
