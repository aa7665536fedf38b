// Abaqus and CalculiX input: nodes, elements, element sets. Format: see inp_reader.cpp.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "base/core/letters.hpp"
#include "geometry/files/tet_writer.hpp"

namespace pliant::mesh {
namespace {

bool is_label(std::string_view name) {
    constexpr std::size_t longest = 60;
    if (name.empty() || name.size() > longest || !is_letter(name.front())) return false;
    return std::all_of(name.begin(), name.end(),
                       [](char c) { return is_letter(c) || is_digit(c) || c == '_' || c == '-'; });
}

}  // namespace

std::vector<std::string> inp_labels(const std::vector<std::string>& names) {
    std::vector<std::string> labels;
    std::set<std::string> taken;
    for (std::size_t r = 0; r < names.size(); ++r) taken.insert(fmt::format("r{}", r + 1));
    for (std::size_t r = 0; r < names.size(); ++r) {
        const bool own = is_label(names[r]) && taken.insert(lower_case(names[r])).second;
        labels.push_back(own ? names[r] : fmt::format("R{}", r + 1));
    }
    return labels;
}

std::string inp_name_comments(const std::vector<std::string>& names) {
    const std::vector<std::string> labels = inp_labels(names);
    std::string text;
    for (std::size_t r = 0; r < names.size(); ++r) {
        std::string name = names[r];
        for (char& c : name) c = c == '\n' ? ' ' : c;
        if (labels[r] != names[r]) text += fmt::format("** region {} \"{}\"\n", labels[r], name);
    }
    return text;
}

std::string inp_text(const TetMesh& mesh) {
    const std::vector<std::string> labels = inp_labels(mesh.region_names);
    std::string text = "*HEADING\npliant tet mesh\n" + inp_name_comments(mesh.region_names) + "*NODE, NSET=ALL\n";
    const auto out = std::back_inserter(text);
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        const Vec3& p = mesh.points[i];
        fmt::format_to(out, "{}, {}, {}, {}\n", i + 1, p.x, p.y, p.z);
    }
    for (std::size_t r = 0; r < labels.size(); ++r) {
        if (std::find(mesh.region.begin(), mesh.region.end(), static_cast<int>(r)) == mesh.region.end()) continue;
        fmt::format_to(out, "*ELEMENT, TYPE={}, ELSET={}\n", mesh.order == 2 ? "C3D10" : "C3D4", labels[r]);
        for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
            if (mesh.region[t] != static_cast<int>(r)) continue;
            fmt::format_to(out, "{}", t + 1);
            for (const int node : mesh.tet(t)) fmt::format_to(out, ", {}", node + 1);
            text += '\n';
        }
    }
    return text;
}

}  // namespace pliant::mesh
