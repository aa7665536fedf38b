#include "geometry/mesher/step_file.hpp"

#include <algorithm>
#include <memory>
#include <vector>

#include "base/core/files.hpp"
#include "base/core/text.hpp"
#include "geometry/mesh/tri_mesh.hpp"
#include "geometry/mesh/triangle_tree.hpp"
#include "geometry/mesher/mesh_worker.hpp"
#include "geometry/mesher/packing.hpp"

namespace pliant::mesh {
namespace {

/// All solids of a file. Open CASCADE dereferences null pointers left by a damaged file: only its process crashes then.
Result<StepContent> solids_of(const std::string& file, double scale) {
    Packer request;
    request.text(std::filesystem::absolute(file).string());
    request.number(scale);
    Progress silent;
    const Result<std::string> answer =
        ask_mesher(MessageKind::read_step, request.take(),
                   "the STEP file is damaged: Open CASCADE or Gmsh crashes on it; export it anew", silent);
    return unpacked<StepContent>(answer);
}

/// A part that the file does not hold.
tl::unexpected<Error> no_such_part(const std::string& file, const std::string& part,
                                   const std::vector<std::string>& names) {
    std::vector<std::string> known;
    for (const std::string& name : names) {
        if (!name.empty() && std::find(known.begin(), known.end(), name) == known.end()) known.push_back(name);
    }
    return input_error("{}: has no solid \"{}\"; {}", file, part,
                       known.empty() ? "its solids have no names: leave out the part, and all are taken"
                                     : "it has " + join_names(known));
}

}  // namespace

bool looks_like_step(std::string_view bytes) {
    const std::size_t begin = bytes.find_first_not_of(" \t\r\n");
    return begin != std::string_view::npos && bytes.substr(begin).starts_with("ISO-10303-21");
}

Result<Solid> read_step(const std::filesystem::path& path, const std::string& part, double scale) {
    const Result<std::string> bytes = read_file(path);
    if (!bytes) return tl::unexpected(bytes.error());
    if (!looks_like_step(*bytes)) return input_error("{}: is no STEP file", path.string());
    if (bytes->find("END-ISO-10303-21") == std::string::npos)
        return input_error("{}: the file is cut off: END-ISO-10303-21 is missing", path.string());
    const auto is_text = [](char c) {
        return c == '\t' || c == '\n' || c == '\r' || static_cast<unsigned char>(c) >= 32;
    };
    for (const char* const keyword : {"HEADER;", "DATA;", "ENDSEC;"}) {
        if (bytes->find(keyword) == std::string::npos)
            return input_error("{}: is no STEP file: {} is missing", path.string(), keyword);
    }
    if (!std::all_of(bytes->begin(), bytes->end(), is_text))
        return input_error("{}: is damaged: it holds bytes that are no text", path.string());
    const Result<StepContent> content = solids_of(path.string(), scale);
    if (!content) return tl::unexpected(Error{content.error().cause, path.string() + ": " + content.error().message});
    StepSolid step{path.string(), {}, scale, {}};
    TriMesh surface;
    for (std::size_t i = 0; i < content->names.size(); ++i) {
        if (!part.empty() && content->names[i] != part) continue;
        step.numbers.push_back(static_cast<int>(i));
        append(surface, content->surfaces[i]);
    }
    if (step.numbers.empty()) return no_such_part(path.string(), part, content->names);
    step.surface = std::make_shared<const TriangleTree>(std::move(surface));
    return std::make_shared<const SolidNode>(SolidNode{std::move(step)});
}

}  // namespace pliant::mesh
