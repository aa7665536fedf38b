#include "geometry/threemf/properties.hpp"

#include <algorithm>
#include <charconv>

namespace pliant::threemf {
namespace {

using Kind = PropertyGroup::Kind;

std::vector<int> indices(const XmlPart& part, const pugi::xml_node& node, const char* key, Problem& problem) {
    std::vector<int> found;
    for (const std::string_view word : words(part.needed(node, key, problem))) {
        int value = -1;
        const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (code != std::errc() || end != word.data() + word.size() || value < 0)
            problem.note(part.at(node, fmt::format("{}: \"{}\" must be a whole number of at least 0", key, word)));
        found.push_back(value);
    }
    return found;
}

/// "#RRGGBB" or "#RRGGBBAA", in capitals and without alpha.
std::string colour(const XmlPart& part, const pugi::xml_node& node, const char* key, Problem& problem) {
    std::string text(part.needed(node, key, problem));
    const bool digits = text.size() > 1 && std::all_of(text.begin() + 1, text.end(),
                                                       [](unsigned char c) { return std::isxdigit(c) != 0; });
    if (!problem.found() && (!digits || text[0] != '#' || (text.size() != 7 && text.size() != 9)))
        problem.note(part.at(node, fmt::format("{}=\"{}\" must be #RRGGBB or #RRGGBBAA", key, text)));
    text.resize(std::min<std::size_t>(text.size(), 7));
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
    return text;
}

const PropertyGroup* group(const XmlPart& part, const pugi::xml_node& node, const char* key, int id,
                           const Properties& properties, Problem& problem) {
    const auto found = properties.find(id);
    if (found != properties.end()) return &found->second;
    problem.note(part.at(node, fmt::format("{}: there is no property group {} before this one", key, id)));
    return nullptr;
}

PropertyGroup read_base(const XmlPart& part, const pugi::xml_node& node, Problem& problem) {
    PropertyGroup result{Kind::base, {}};
    for (const pugi::xml_node& base : part.children(node, Space::core, "base")) {
        result.materials.emplace_back(part.needed(base, "name", problem));
        (void)colour(part, base, "displaycolor", problem);
    }
    return result;
}

PropertyGroup read_colours(const XmlPart& part, const pugi::xml_node& node, Problem& problem) {
    PropertyGroup result{Kind::colour, {}};
    for (const pugi::xml_node& c : part.children(node, Space::material, "color"))
        result.materials.push_back(colour(part, c, "color", problem));
    return result;
}

PropertyGroup read_texture_group(const XmlPart& part, const pugi::xml_node& node,
                                 const std::map<int, std::string>& textures, Problem& problem) {
    const int texture = part.index(node, "texid", problem);
    if (!problem.found() && !textures.contains(texture))
        problem.note(part.at(node, fmt::format("texid: there is no texture {}", texture)));
    const auto count = part.children(node, Space::material, "tex2coord").size();
    return {Kind::texture, std::vector<std::string>(count, "default")};
}

PropertyGroup read_composites(const XmlPart& part, const pugi::xml_node& node, const Properties& properties,
                              Problem& problem) {
    PropertyGroup result{Kind::composite, {}};
    const int id = part.index(node, "matid", problem);
    const std::vector<int> used = indices(part, node, "matindices", problem);
    const PropertyGroup* base = group(part, node, "matid", id, properties, problem);
    if (base == nullptr || problem.found()) return result;
    if (base->kind != Kind::base)
        problem.note(part.at(node, fmt::format("matid: {} is not a group of base materials", id)));
    std::string name;
    for (const int i : used) {
        if (i >= static_cast<int>(base->materials.size())) {
            problem.note(part.at(node, fmt::format("matindices: group {} has no material {}", id, i)));
            return result;
        }
        name += (name.empty() ? "" : "+") + base->materials[static_cast<std::size_t>(i)];
    }
    result.materials.assign(part.children(node, Space::material, "composite").size(), name);
    return result;
}

PropertyGroup read_multi(const XmlPart& part, const pugi::xml_node& node, const Properties& properties,
                         const std::map<int, std::string>& textures, Problem& problem) {
    PropertyGroup result{Kind::multi, {}};
    const PropertyGroup* material = nullptr;
    std::size_t place = 0, n = 0, colours = 0;
    for (const int id : indices(part, node, "pids", problem)) {
        ++n;
        if (textures.contains(id)) continue;
        const PropertyGroup* layer = group(part, node, "pids", id, properties, problem);
        if (layer == nullptr || problem.found()) return result;
        if (layer->kind == Kind::multi)
            problem.note(part.at(node, fmt::format("pids: {} is a group of multiproperties itself", id)));
        if (layer->kind == Kind::colour && ++colours > 1)
            problem.note(part.at(node, "pids: more than one group of colours, at most one is allowed"));
        if (layer->kind == Kind::base || layer->kind == Kind::composite) {
            if (material != nullptr)
                problem.note(part.at(node, "pids: more than one group of materials, at most one is allowed"));
            material = layer;
            place = n - 1;
        }
    }
    auto entries = part.children(node, Space::material, "multi");
    if (entries.empty()) entries = part.children(node, Space::core, "multi");  // found in some files
    for (const pugi::xml_node& multi : entries) {
        const std::vector<int> used = indices(part, multi, "pindices", problem);
        const std::size_t i = place < used.size() && used[place] >= 0 ? static_cast<std::size_t>(used[place]) : 0;
        const bool known = material != nullptr && i < material->materials.size();
        result.materials.push_back(known ? material->materials[i] : "default");
    }
    return result;
}

void read_texture(const XmlPart& part, const pugi::xml_node& node, int id, std::map<int, std::string>& textures,
                  Problem& problem) {
    textures[id] = part.needed(node, "path", problem);
    const std::string_view type = part.needed(node, "contenttype", problem);
    if (!problem.found() && type != "image/png" && type != "image/jpeg")
        problem.note(part.at(node, fmt::format("contenttype=\"{}\" must be image/png or image/jpeg", type)));
}

}  // namespace

bool read_property_group(const XmlPart& part, const pugi::xml_node& node, int id, Properties& properties,
                         std::map<int, std::string>& textures, Problem& problem) {
    if (part.is(node, Space::material, "texture2d")) {
        read_texture(part, node, id, textures, problem);
    } else if (part.is(node, Space::core, "basematerials")) {
        properties[id] = read_base(part, node, problem);
    } else if (part.is(node, Space::material, "colorgroup")) {
        properties[id] = read_colours(part, node, problem);
    } else if (part.is(node, Space::material, "texture2dgroup")) {
        properties[id] = read_texture_group(part, node, textures, problem);
    } else if (part.is(node, Space::material, "compositematerials")) {
        properties[id] = read_composites(part, node, properties, problem);
    } else if (part.is(node, Space::material, "multiproperties")) {
        properties[id] = read_multi(part, node, properties, textures, problem);
    } else {
        return false;
    }
    return true;
}

}  // namespace pliant::threemf
