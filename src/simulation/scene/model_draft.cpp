#include "simulation/scene/model_draft.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "base/core/disjoint_sets.hpp"

namespace pliant::robot {
namespace {

/// Points this far outside, as a share of the robot's size, still count as on the surface.
constexpr double surface_share = 1e-3;

/// As a share of the mean edge: the distance by which a chord as long as the radius cuts off an arc.
constexpr double reach_share = 1.0 / 8;

/// Gives every notch of a region except the first a new region at the end; returns those.
std::vector<int> part_notches(mesh::TetMesh& mesh, int region) {
    DisjointSets sets(mesh.points.size());
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        if (mesh.region[t] != region) continue;
        for (const int node : mesh.tet(t)) sets.join(node, mesh.tet(t)[0]);
    }
    std::map<int, int> region_of_set;
    std::vector<int> added;
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        if (mesh.region[t] != region) continue;
        const auto next = static_cast<int>(mesh.region_names.size());
        const auto [entry, fresh] = region_of_set.try_emplace(sets.find(mesh.tet(t)[0]),
                                                              added.empty() && region_of_set.empty() ? region : next);
        mesh.region[t] = entry->second;
        if (!fresh || entry->second == region) continue;
        added.push_back(next);
        mesh.region_names.push_back(
            fmt::format("{} {}", mesh.region_names[static_cast<std::size_t>(region)], added.size() + 1));
    }
    return added;
}

}  // namespace

double mean_edge(const mesh::TetMesh& mesh) {
    double sum = 0;
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        for (const auto& [a, b] : mesh::edge_corners)
            sum += norm(mesh.points[mesh.tet(t)[a]] - mesh.points[mesh.tet(t)[b]]);
    }
    return sum / std::max(6.0 * static_cast<double>(mesh.tet_count()), 1.0);
}

mesh::TetMesh tets_of_bodies(const Robot& robot, const mesh::TetMesh& all) {
    mesh::TetMesh bodies{all.order, all.points, {}, {}, all.region_names, {}};
    for (std::size_t t = 0; t < all.tet_count(); ++t) {
        if (all.region[t] >= static_cast<int>(robot.bodies.size())) continue;
        bodies.region.push_back(all.region[t]);
        bodies.nodes.insert(bodies.nodes.end(), all.tet(t).begin(), all.tet(t).end());
    }
    return bodies;
}

ModelDraft::ModelDraft(const Robot& the_robot, mesh::TetMesh mesh) : robot(the_robot), whole(std::move(mesh)) {
    std::vector<bool> keep;
    for (const Region& region : regions_of(robot)) keep.push_back(region.has_elements);
    mesh::Extract extract = mesh::extract_regions(whole, keep);
    description.mesh = std::move(extract.mesh);
    node_of_whole = std::move(extract.node);
    for (const GapSpec& gap : robot.gaps) {
        if (std::holds_alternative<CrossedNotches>(gap.space))
            notches = part_notches(description.mesh, kept_region(region_of(Region::Use::gap, gap.name)));
    }
    bodies = tets_of_bodies(robot, description.mesh);
    for (const Vec3& p : description.mesh.points) box.add(p);
    tolerance = surface_share * box.diagonal();
    point_reach = std::max(
        tolerance, robot.mesh.point_reach ? robot.unit_m * *robot.mesh.point_reach : reach_share * mean_edge(bodies));
    // The nodes of a mesh file are the user's own numbers, taken exactly; those of our mesher have rounding errors.
    box_margin = robot.mesh.file ? 0 : 1e-9 * box.diagonal();
}

void ModelDraft::problem(int line, std::string_view kind, std::string_view name, const std::string& text) {
    problems.push_back({robot.file.string(), line, fmt::format("{} \"{}\"", kind, name), text});
}

std::string ModelDraft::show(const Vec3& p_m) const {
    const Vec3 p = p_m / robot.unit_m;
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z);
}

std::string ModelDraft::show_bounds() const {
    return fmt::format("the robot reaches from {} to {}", show(box.low), show(box.high));
}

void ModelDraft::count_point(std::string_view kind, double distance_m) {
    Points& counted = points[std::string(kind)];
    ++counted.all;
    if (distance_m <= tolerance) return;
    ++counted.outside;
    counted.farthest_m = std::max(counted.farthest_m, distance_m);
}

std::vector<std::string> ModelDraft::notes_on_points() const {
    std::vector<std::string> notes;
    for (const auto& [kind, counted] : points) {
        if (counted.outside == 0) continue;
        notes.push_back(
            fmt::format("{} of {} {} lie outside the mesh, by up to {:.3g} mm; the "
                        "nearest tetrahedra carry them (mesh.point_reach is {:.3g} mm)",
                        counted.outside, counted.all, kind, 1e3 * counted.farthest_m, 1e3 * point_reach));
    }
    return notes;
}

Box3 ModelDraft::box_of(const BoxSelector& selector) const {
    return {robot.unit_m * selector.low, robot.unit_m * selector.high};
}

std::size_t ModelDraft::region_of(Region::Use use, std::string_view name) const {
    const auto regions = regions_of(robot);
    const auto found =
        std::find_if(regions.begin(), regions.end(), [&](const Region& r) { return r.use == use && r.name == name; });
    return static_cast<std::size_t>(found - regions.begin());
}

int ModelDraft::kept_region(std::size_t region) const {
    const auto regions = regions_of(robot);
    int before = 0;
    for (std::size_t r = 0; r < region; ++r) before += regions[r].has_elements ? 1 : 0;
    return before;
}

std::vector<int> ModelDraft::regions_of_gap(const GapSpec& gap) const {
    std::vector<int> regions = {kept_region(region_of(Region::Use::gap, gap.name))};
    if (std::holds_alternative<CrossedNotches>(gap.space))
        regions.insert(regions.end(), notches.begin(), notches.end());
    return regions;
}

int ModelDraft::material_of(std::size_t region) const {
    return description.material_of_region[static_cast<std::size_t>(kept_region(region))];
}

}  // namespace pliant::robot
