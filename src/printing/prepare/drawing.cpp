#include "printing/prepare/drawing.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "base/core/files.hpp"
#include "base/core/text.hpp"
#include "geometry/mesher/mesher.hpp"
#include "geometry/mesher/step_file.hpp"
#include "geometry/open/open_geometry.hpp"
#include "robot/bodies/body_notes.hpp"
#include "robot/bodies/build.hpp"
#include "robot/file/robot_file.hpp"

namespace pliant::prepare {
namespace {

constexpr double um_per_mm = 1e3;
constexpr double printable_um = 10;  // maximum deviation of chords from a curve, a fraction of a pixel

void add_resin(Drawing& drawing, const std::string& material, const std::string& resin) {
    const auto known = [&](const auto& pair) { return pair.first == material; };
    if (std::none_of(drawing.resin_of_material.begin(), drawing.resin_of_material.end(), known))
        drawing.resin_of_material.emplace_back(material, resin);
}

const robot::BodySpec& body_named(const robot::Robot& robot, const std::string& name) {
    return *std::find_if(robot.bodies.begin(), robot.bodies.end(),
                         [&](const robot::BodySpec& body) { return body.name == name; });
}

/// Squares with a length become whole pixels once the printer is known.
slice::Blend blend_of(const robot::Robot& robot, const robot::PrintBlend& blend) {
    const double um = robot.unit_m * 1e6;
    slice::Blend result{robot.materials[static_cast<std::size_t>(blend.material)].name, um * blend.from, um * blend.to,
                        blend.shares, 1};
    result.cell_um = um * blend.cell;
    return result;
}

std::vector<slice::OutlineSlice> in_um(const std::vector<threemf::Slice>& slices) {
    std::vector<slice::OutlineSlice> result;
    for (const threemf::Slice& s : slices) {
        result.push_back({s.bottom_mm * um_per_mm, s.top_mm * um_per_mm, s.contours});
        for (auto& outline : result.back().outlines_um) {
            for (auto& [x, y] : outline) {
                x *= um_per_mm;
                y *= um_per_mm;
            }
        }
    }
    return result;
}

/// `material`: of all bodies; if empty, the file's materials.
Status add_3mf(threemf::ThreeMf file, const std::string& material, Drawing& drawing) {
    drawing.warnings.insert(drawing.warnings.end(), file.warnings.begin(), file.warnings.end());
    drawing.items = std::max(drawing.items, file.items);
    for (threemf::Body& body : file.bodies)
        drawing.bodies.push_back({material.empty() ? body.material : material,
                                  mesh::scaled(std::move(body.mesh_mm), um_per_mm), body.name, in_um(body.slices)});
    return {};
}

Status add_tets(const mesh::TetMesh& tets, const std::string& material, Drawing& drawing) {
    for (std::size_t r = 0; r < tets.region_names.size(); ++r) {
        mesh::TriMesh surface = mesh::region_surface(tets, static_cast<int>(r));
        if (surface.triangles.empty()) continue;
        const std::string& region = tets.region_names[r];
        drawing.bodies.push_back(
            {material.empty() ? region : material, mesh::scaled(std::move(surface), um_per_mm), region});
    }
    return {};
}

Status add_surface(mesh::SurfaceFile surface, const std::filesystem::path& path, const std::string& material,
                   Drawing& drawing) {
    if (material.empty())
        return input_error("{}: has no materials of its own: write MATERIAL={}", path.string(), path.string());
    drawing.warnings.insert(drawing.warnings.end(), surface.warnings.begin(), surface.warnings.end());
    drawing.bodies.push_back({material, mesh::scaled(std::move(surface.mesh), um_per_mm), path.stem().string()});
    return {};
}

Status add_step(const std::filesystem::path& path, const std::string& material, Drawing& drawing) {
    if (material.empty())
        return input_error("{}: has no materials of its own: write MATERIAL={}", path.string(), path.string());
    const Result<mesh::Solid> solids = mesh::read_step(path, "", um_per_mm);
    if (!solids) return tl::unexpected(solids.error());
    Result<mesh::TriMesh> surface = mesh::tessellate(*solids, printable_um);
    if (!surface) return input_error("{}: {}", path.string(), surface.error().message);
    drawing.bodies.push_back({material, std::move(*surface), path.stem().string()});
    return {};
}

Status add_stack(const std::filesystem::path& path, const std::string& material, Drawing& drawing) {
    if (material.empty())
        return input_error("{}: layer images have no material of their own: write MATERIAL={}", path.string(),
                           path.string());
    const auto same = [&](const job::MaterialStack& s) { return s.material == material; };
    if (std::any_of(drawing.stacks.begin(), drawing.stacks.end(), same))
        return input_error("{}: material \"{}\" has layer images already", path.string(), material);
    Result<job::ImageStack> stack = job::ImageStack::open(path);
    if (!stack) return tl::unexpected(stack.error());
    if (!stack->left_out().empty()) drawing.warnings.push_back(stack->left_out());
    drawing.stacks.push_back({material, std::move(*stack)});
    add_resin(drawing, material, material);
    return {};
}

Status add_file(const std::string& input, Drawing& drawing) {
    const std::size_t equals = input.find('=');
    if (equals == 0) return input_error("{}: write MATERIAL=FILE with a material in front", input);
    const bool whole = equals == std::string::npos || std::filesystem::exists(input);
    const std::string material = whole ? "" : input.substr(0, equals);
    const std::filesystem::path path = whole ? input : input.substr(equals + 1);
    if (drawing.name.empty()) drawing.name = path.stem().string();
    if (job::is_image_stack(path)) return add_stack(path, material, drawing);
    if (job::is_job(path))
        return input_error(
            "{0}: is a job of Pliant, sliced already; `pliant export {0} --as zip -o FOLDER` writes its "
            "images, one file for each material, which can be sliced",
            path.string());
    Result<mesh::Geometry> geometry = mesh::open_geometry(path);
    if (!geometry) return tl::unexpected(geometry.error());
    if (auto* plate = std::get_if<threemf::ThreeMf>(&*geometry)) return add_3mf(std::move(*plate), material, drawing);
    if (std::holds_alternative<mesh::StepPath>(*geometry)) return add_step(path, material, drawing);
    if (const auto* tets = std::get_if<mesh::TetMesh>(&*geometry)) return add_tets(*tets, material, drawing);
    return add_surface(std::get<mesh::SurfaceFile>(std::move(*geometry)), path, material, drawing);
}

/// "#rrggbb"; "": the material has no colour of its own.
std::string colour_text(const robot::MaterialSpec& material) {
    if (!material.colour) return "";
    std::string text = "#";
    for (const double channel : *material.colour) text += fmt::format("{:02x}", std::lround(255 * channel));
    return text;
}

}  // namespace

Result<Drawing> drawing_of(const robot::Robot& robot, Progress& progress) {
    Result<std::vector<robot::BodySurface>> surfaces = robot::body_surfaces(robot, progress);
    if (!surfaces) return tl::unexpected(surfaces.error());
    Drawing drawing;
    drawing.name = robot.name;
    for (robot::BodySurface& body : *surfaces) {
        const robot::MaterialSpec& material = robot.materials[static_cast<std::size_t>(body.material)];
        const robot::BodySpec& spec = body_named(robot, body.body);
        std::string name = material.name;
        // A body with an exposure of its own becomes a separate material in the same resin.
        if (spec.exposure_s > 0) {
            name += " of " + spec.name;
            add_resin(drawing, name, material.resin);
            drawing.made_of[name] = material.name;
            drawing.exposure_of_material[name] = {spec.exposure_s, material.bottom_exposure_s};
        }
        if (const std::string colour = colour_text(material); !colour.empty())
            drawing.colour_of_material[name] = colour;
        drawing.warnings.insert(drawing.warnings.end(), body.notes.begin(), body.notes.end());
        drawing.bodies.push_back({name, mesh::scaled(std::move(body.surface_m), 1e6), body.body});
        drawing.bodies.back().chord_um = body.chord_m * 1e6;
        for (mesh::TriMesh& air : body.air_m) drawing.bodies.back().air_um.push_back(mesh::scaled(std::move(air), 1e6));
        if (spec.blend) drawing.bodies.back().blend = blend_of(robot, *spec.blend);
    }
    drawing.notes = robot::overlap_notes(robot, progress);
    for (const robot::MaterialSpec& material : robot.materials) {
        add_resin(drawing, material.name, material.resin);
        if (material.exposure_s > 0 || material.bottom_exposure_s > 0)
            drawing.exposure_of_material[material.name] = {material.exposure_s, material.bottom_exposure_s};
    }
    return drawing;
}

Result<Drawing> read_drawing(const std::vector<std::string>& inputs, const std::vector<std::string>& assignments,
                             Progress& progress) {
    if (inputs.size() == 1 && lower_extension(inputs.front()) == ".toml") {
        const Result<robot::Robot> robot = robot::load_robot(inputs.front(), assignments);
        if (!robot) return tl::unexpected(robot.error());
        return drawing_of(*robot, progress);
    }
    if (!assignments.empty())
        return input_error("--set {}: changes the keys of a robot file, and there is none", assignments.front());
    Drawing drawing;
    for (const std::string& input : inputs) {
        if (lower_extension(input) == ".toml")
            return input_error("{}: a robot file must be the only input; for other files write MATERIAL=FILE", input);
        if (auto status = add_file(input, drawing); !status) return tl::unexpected(status.error());
    }
    if (!drawing.stacks.empty() && !drawing.bodies.empty())
        return input_error("layer images and bodies cannot be printed together: slice the bodies first");
    for (const slice::Body& body : drawing.bodies) add_resin(drawing, body.material, body.material);
    return drawing;
}

bool has_body_of(const Drawing& drawing, const std::string& material) {
    return std::ranges::any_of(drawing.bodies, [&](const slice::Body& body) {
        return body.material == material || (body.blend && body.blend->second == material);
    });
}

Status set_resins(const std::vector<std::string>& choices, Drawing& drawing) {
    std::map<std::string, std::string> given;
    for (const std::string& choice : choices) {
        const std::size_t equals = choice.find('=');
        const std::string material = choice.substr(0, equals);
        const auto found = std::find_if(drawing.resin_of_material.begin(), drawing.resin_of_material.end(),
                                        [&](const auto& pair) { return pair.first == material; });
        if (equals == std::string::npos || equals + 1 == choice.size())
            return input_error("--resin {}: write MATERIAL=RESIN", choice);
        if (found == drawing.resin_of_material.end()) {
            std::vector<std::string> names;
            for (const auto& pair : drawing.resin_of_material) names.push_back(pair.first);
            return input_error("--resin {}: there is no material \"{}\", only {}", choice, material, join_names(names));
        }
        if (!given.emplace(material, choice.substr(equals + 1)).second)
            return input_error("--resin {}: the resin of \"{}\" is given twice", choice, material);
    }
    for (auto& [material, resin] : drawing.resin_of_material) {
        auto choice = given.find(material);
        const auto whole = drawing.made_of.find(material);
        if (choice == given.end() && whole != drawing.made_of.end()) choice = given.find(whole->second);
        if (choice != given.end()) resin = choice->second;
    }
    return {};
}

}  // namespace pliant::prepare
