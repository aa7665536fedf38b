// Ties what the robot file names by place (boxes, points, paths) to nodes of the mesh.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "mesh/cavity.hpp"
#include "mesh/surface_check.hpp"
#include "mesh/surface_file.hpp"
#include "robot/build.hpp"
#include "robot/build_contact.hpp"
#include "robot/passage.hpp"
#include "robot/regions.hpp"
#include "sim/attach.hpp"
#include "sim/loads.hpp"

namespace pliant::robot {
namespace {

/// Points this far outside, as a share of the robot's size, still count as on its surface.
constexpr double surface_share = 1e-3;
/// The wall of a surface file need not follow the mesh exactly: so far from the bodies, as a share of the robot's size.
constexpr double wall_reach = 0.03;

/// Distance from a point to a triangle (Ericson, Real-Time Collision Detection, 5.1.5).
double distance_to_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, ac = c - a, ap = p - a;
    const double d1 = dot(ab, ap), d2 = dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return norm(ap);
    const Vec3 bp = p - b;
    const double d3 = dot(ab, bp), d4 = dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return norm(bp);
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return norm(ap - (d1 / (d1 - d3)) * ab);
    const Vec3 cp = p - c;
    const double d5 = dot(ab, cp), d6 = dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return norm(cp);
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return norm(ap - (d2 / (d2 - d6)) * ac);
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return norm(bp - ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c - b));
    const double scale = 1 / (va + vb + vc);
    return norm(ap - (vb * scale) * ab - (vc * scale) * ac);
}

class ModelBuilder {
public:
    ModelBuilder(const Robot& robot, mesh::TetMesh mesh) : robot_(robot), whole_(std::move(mesh)), attacher_(nullptr) {
        std::vector<bool> keep;
        for (const Region& region : regions_of(robot)) keep.push_back(region.has_elements);
        mesh::Extract kept = mesh::extract_regions(whole_, keep);
        description_.mesh = std::move(kept.mesh);
        node_of_whole_ = std::move(kept.node);
        bodies_ = tets_of_bodies();
        for (const Vec3& p : description_.mesh.points) box_.add(p);
        tolerance_ = surface_share * box_.diagonal();
        // The nodes of a mesh file are the user's own numbers, taken as they are; those of our mesher carry rounding.
        box_margin_ = robot.mesh.file ? 0 : 1e-9 * box_.diagonal();
    }

    Result<sim::Model> build() {
        const sim::Attacher attacher(bodies_);
        attacher_ = &attacher;
        description_.gravity_m_s2 = robot_.gravity_m_s2;
        description_.gravity_share = robot_.gravity_share;
        description_.ambient_pressure_Pa = robot_.ambient_pressure_Pa;
        add_materials();
        for (const FixedSpec& fixed : robot_.fixed) add_support(fixed);
        for (const PlateSpec& plate : robot_.plates) add_plate(plate);
        for (const LoadSpec& load : robot_.loads) add_load(load);
        for (const CableSpec& cable : robot_.cables) add_cable(cable);
        for (const ChamberSpec& chamber : robot_.chambers) add_chamber(chamber);
        for (const MarkerSpec& marker : robot_.markers) add_marker(marker);
        if (!problems_.empty()) return tl::unexpected(Error{Cause::input, problems_});
        if (robot_.contact) {
            Result<sim::ContactRules> contact = build_contact(robot_, bodies_);
            if (!contact) return tl::unexpected(contact.error());
            description_.contact = std::move(*contact);
        }
        Result<sim::Model> model = sim::Model::create(std::move(description_));
        if (!model)
            return tl::unexpected(Error{model.error().cause, robot_.file.string() + ": " + model.error().message});
        return model;
    }

private:
    void problem(int line, std::string_view kind, std::string_view name, const std::string& text) {
        if (!problems_.empty()) problems_ += '\n';
        problems_ += fmt::format("{}:{}: {} \"{}\": {}", robot_.file.string(), line, kind, name, text);
    }

    /// In the robot file's unit, for messages.
    std::string show(const Vec3& p_m) const {
        const Vec3 p = p_m / robot_.unit_m;
        return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z);
    }
    std::string show_bounds() const {
        return fmt::format("the robot reaches from {} to {}", show(box_.low), show(box_.high));
    }

    /// Meshed space resists as much as the softest body, with a Poisson ratio of zero.
    void add_materials() {
        for (const MaterialSpec& m : robot_.materials)
            description_.materials.push_back({m.name, m.law, m.density_kg_m3});
        for (const BodySpec& body : robot_.bodies) description_.material_of_region.push_back(body.material);
        for (const Region& region : regions_of(robot_)) {
            if (region.use == Region::Use::body || !region.has_elements) continue;
            description_.material_of_region.push_back(static_cast<int>(description_.materials.size()));
            description_.materials.push_back({std::string(region.name), material::ScaledTarget{softest_Pa(robot_)}, 0});
        }
    }

    /// The tets that carry material, on the nodes of the description's mesh.
    mesh::TetMesh tets_of_bodies() const {
        const mesh::TetMesh& all = description_.mesh;
        mesh::TetMesh bodies{all.order, all.points, {}, {}, all.region_names, {}};
        for (std::size_t t = 0; t < all.tet_count(); ++t) {
            if (all.region[t] >= static_cast<int>(robot_.bodies.size())) continue;
            bodies.region.push_back(all.region[t]);
            bodies.nodes.insert(bodies.nodes.end(), all.tet(t).begin(), all.tet(t).end());
        }
        return bodies;
    }

    /// Index of a region of the whole mesh among those that were kept, whose material is its target shape.
    int material_of(std::size_t region) const {
        const auto regions = regions_of(robot_);
        std::size_t kept = 0;
        for (std::size_t r = 0; r < region; ++r) kept += regions[r].has_elements ? 1 : 0;
        return description_.material_of_region[kept];
    }

    Box3 box_of(const BoxSelector& selector) const {
        return {robot_.unit_m * selector.low, robot_.unit_m * selector.high};
    }

    /// The nodes that a selector catches; `kind`, `name` and `line` are for messages.
    std::vector<int> select(const Selector& selector, std::string_view kind, const std::string& name, int line) {
        const auto& points = description_.mesh.points;
        std::vector<int> nodes;
        const auto collect = [&](const auto& inside) {
            for (std::size_t n = 0; n < points.size(); ++n) {
                if (inside(points[n])) nodes.push_back(static_cast<int>(n));
            }
        };
        if (const auto* box = std::get_if<BoxSelector>(&selector)) {
            collect([&, b = box_of(*box)](const Vec3& p) { return b.contains(p, box_margin_); });
        } else if (const auto* plane = std::get_if<PlaneSelector>(&selector)) {
            const Vec3 normal = plane->normal / norm(plane->normal);
            collect(
                [&](const Vec3& p) { return std::fabs(dot(normal, p - robot_.unit_m * plane->point)) < tolerance_; });
        } else if (const auto* sphere = std::get_if<SphereSelector>(&selector)) {
            collect([&](const Vec3& p) {
                return norm(p - robot_.unit_m * sphere->center) <= robot_.unit_m * sphere->radius + box_margin_;
            });
        } else if (const auto* surface = std::get_if<SurfaceSelector>(&selector)) {
            nodes = select_on_surface(*surface, kind, name, line);
        } else {
            nodes = std::get<NodeSelector>(selector).nodes;
            for (const int node : nodes) {
                if (node < static_cast<int>(points.size())) continue;
                problem(line, kind, name, fmt::format("node {} does not exist, the mesh has {}", node, points.size()));
                return {};
            }
        }
        return nodes;
    }

    std::vector<int> select_on_surface(const SurfaceSelector& selector, std::string_view kind, const std::string& name,
                                       int line) {
        const Result<mesh::SurfaceFile> file = mesh::read_surface(selector.path);
        std::vector<int> nodes;
        if (!file) {
            problem(line, kind, name, file.error().message);
            return nodes;
        }
        const mesh::TriMesh surface = mesh::scaled(file->mesh, robot_.unit_m);
        const Box3 bounds = mesh::bounds(surface);
        for (std::size_t n = 0; n < description_.mesh.points.size(); ++n) {
            const Vec3& p = description_.mesh.points[n];
            if (!bounds.contains(p, tolerance_)) continue;
            const bool near = std::any_of(surface.triangles.begin(), surface.triangles.end(), [&](const auto& t) {
                return distance_to_triangle(p, surface.points[t[0]], surface.points[t[1]], surface.points[t[2]]) <
                       tolerance_;
            });
            if (near) nodes.push_back(static_cast<int>(n));
        }
        return nodes;
    }

    void add_support(const FixedSpec& fixed) {
        const std::size_t before = problems_.size();
        std::vector<int> nodes = select(fixed.selector, "fixed", fixed.name, fixed.line);
        if (nodes.empty() && problems_.size() == before) {
            problem(fixed.line, "fixed", fixed.name, "catches no node of the mesh; " + show_bounds());
        }
        constexpr double radians = std::numbers::pi / 180;
        const sim::Turn turn{radians * fixed.rotate_deg, fixed.rotation_axis, robot_.unit_m * fixed.rotation_center};
        description_.supports.push_back({fixed.name, std::move(nodes), robot_.unit_m * fixed.move, fixed.share, turn});
    }

    void add_plate(const PlateSpec& plate) {
        const std::size_t before = problems_.size();
        std::vector<int> nodes = select(plate.selector, "plate", plate.name, plate.line);
        if (nodes.empty() && problems_.size() == before)
            problem(plate.line, "plate", plate.name, "catches no node of the mesh; " + show_bounds());
        if (!nodes.empty()) description_.plates.push_back({plate.name, std::move(nodes)});
    }

    void add_load(const LoadSpec& load) {
        const Box3 box = box_of(load.box);
        std::vector<mesh::Face> faces;
        for (const mesh::Face& face : mesh::boundary_faces(bodies_)) {
            const auto inside = [&](int i) {
                return box.contains(description_.mesh.points[face.nodes[i]], box_margin_);
            };
            if (inside(0) && inside(1) && inside(2)) faces.push_back(face);
        }
        if (faces.empty()) {
            problem(load.line, "load", load.name, "no face of the outer surface lies inside the box; " + show_bounds());
            return;
        }
        if (load.pressure_Pa) {
            description_.pressures.push_back({load.name, pressed_wall(faces), *load.pressure_Pa, load.share});
            return;
        }
        sim::SurfaceShares shares = sim::surface_shares(description_.mesh, faces);
        description_.loads.push_back(
            {load.name, std::move(shares.nodes), std::move(shares.shares), load.force_N, load.share});
    }

    /// Faces of the outer surface as the air outside sees them: their normals point into the body.
    sim::Wall pressed_wall(std::vector<mesh::Face> faces) const {
        for (mesh::Face& face : faces) {
            std::swap(face.nodes[1], face.nodes[2]);
            std::swap(face.nodes[3], face.nodes[5]);
        }
        std::vector<int> same(description_.mesh.points.size());
        std::iota(same.begin(), same.end(), 0);
        return sim::wall_of_faces(description_.mesh, faces, same);
    }

    void add_chamber(const ChamberSpec& spec) {
        sim::Chamber chamber{spec.name, {}, spec.target};
        if (const auto* file = std::get_if<SurfaceFile>(&spec.air))
            chamber.wall = wall_of_file(spec, file->path);
        else if (const auto* cavity = std::get_if<CavityAt>(&spec.air))
            chamber.wall = wall_of_cavity(spec, *cavity);
        else
            chamber.wall = wall_of_region(spec);
        if (chamber.wall.faces.empty()) return;
        if (spec.elements) {
            const std::size_t region = region_of(Region::Use::chamber, spec.name);
            const auto actuator = static_cast<int>(description_.cables.size() + description_.chambers.size());
            description_.growths.push_back({material_of(region), {}, actuator});
        }
        description_.chambers.push_back(std::move(chamber));
    }

    std::size_t region_of(Region::Use use, std::string_view name) const {
        const auto regions = regions_of(robot_);
        const auto found = std::find_if(regions.begin(), regions.end(),
                                        [&](const Region& r) { return r.use == use && r.name == name; });
        return static_cast<std::size_t>(found - regions.begin());
    }

    /// T3.5: every gap that the cable passes shrinks along it.
    void drive_by_gaps(const CableSpec& spec, const std::vector<Vec3>& points) {
        const std::size_t before = description_.growths.size();
        for (const GapSpec& gap : robot_.gaps) {
            const std::size_t region = region_of(Region::Use::gap, gap.name);
            const Passage passage = passage_through(whole_, static_cast<int>(region), points);
            const auto actuator = static_cast<int>(description_.cables.size());
            if (passage.length > 0) description_.growths.push_back({material_of(region), passage.direction, actuator});
        }
        if (description_.growths.size() == before)
            problem(spec.line, "cable", spec.name, "passes no [[gap]], which model = \"gap-elements\" needs");
    }

    /// The boundary of a meshed chamber. A mouth that no body closes must lie in a support that stays where it is.
    sim::Wall wall_of_region(const ChamberSpec& spec) {
        const int region = static_cast<int>(region_of(Region::Use::chamber, spec.name));
        const std::vector<mesh::Face> faces = mesh::region_faces(whole_, region);
        sim::Wall wall = sim::wall_of_faces(whole_, faces, node_of_whole_);
        if (faces.empty()) {
            problem(spec.line, "chamber", spec.name, "is empty");
            return {};
        }
        check_mouth(spec, wall);
        return wall;
    }

    void check_mouth(const ChamberSpec& spec, const sim::Wall& wall) {
        std::vector<bool> held(description_.mesh.points.size(), false);
        for (const sim::Support& support : description_.supports) {
            for (const int node : support.nodes) held[static_cast<std::size_t>(node)] = !support.moves();
        }
        std::size_t loose = 0;
        for (const sim::WallFace& face : wall.faces) {
            bool open = false;
            bool fast = true;
            for (const int point : face) {
                if (point < 0) continue;
                const auto& nodes = wall.points[static_cast<std::size_t>(point)].nodes;
                open = open || nodes.empty();
                fast = fast && (nodes.empty() || held[static_cast<std::size_t>(nodes[0])]);
            }
            loose += open && !fast ? 1 : 0;
        }
        if (loose > 0)
            problem(spec.line, "chamber", spec.name,
                    fmt::format("{} faces of its wall belong to no body: the chamber is open; close it with a body, or "
                                "let its mouth lie in a [[fixed]] without move or rotate",
                                loose));
    }

    sim::Wall wall_of_cavity(const ChamberSpec& spec, const CavityAt& cavity) {
        const Vec3 point = robot_.unit_m * cavity.point;
        Result<std::vector<mesh::Face>> faces = mesh::cavity_faces(bodies_, point);
        if (faces) return pressed_wall(std::move(*faces));
        problem(spec.line, "chamber", spec.name,
                fmt::format("inside: the point {} {}", show(point), faces.error().message));
        return {};
    }

    /// A closed surface whose points ride on the tets that hold them.
    sim::Wall wall_of_file(const ChamberSpec& spec, const std::filesystem::path& path) {
        const Result<mesh::SurfaceFile> file = mesh::read_surface(path);
        if (!file) {
            problem(spec.line, "chamber", spec.name, file.error().message);
            return {};
        }
        const mesh::TriMesh surface = mesh::scaled(file->mesh, robot_.unit_m);
        if (Status closed = mesh::check_closed(surface); !closed) {
            problem(spec.line, "chamber", spec.name, closed.error().message);
            return {};
        }
        sim::Wall wall;
        for (const Vec3& p : surface.points) {
            Result<sim::Attachment> attachment = attacher_->carried_by_tet(p, wall_reach * box_.diagonal());
            if (!attachment) {
                problem(spec.line, "chamber", spec.name,
                        fmt::format("its wall at {} is far from every body; {}", show(p), show_bounds()));
                return {};
            }
            wall.points.push_back(std::move(*attachment));
        }
        const bool outwards = mesh::signed_volume(surface) > 0;
        for (const auto& t : surface.triangles)
            wall.faces.push_back({t[0], outwards ? t[1] : t[2], outwards ? t[2] : t[1], -1, -1, -1});
        return wall;
    }

    /// Where a straight line from a to b passes through the outer surface, in order, without its ends.
    std::vector<Vec3> crossings(const Vec3& a, const Vec3& b) const {
        std::vector<double> hits;
        const auto& p = description_.mesh.points;
        const Vec3 d = b - a;
        for (const mesh::Face& face : mesh::boundary_faces(bodies_)) {
            // Moeller and Trumbore 1997; edges count, so that no hit falls between two triangles.
            const Vec3 e1 = p[face.nodes[1]] - p[face.nodes[0]];
            const Vec3 e2 = p[face.nodes[2]] - p[face.nodes[0]];
            const Vec3 h = cross(d, e2);
            const double determinant = dot(e1, h);
            if (std::fabs(determinant) < 1e-12 * norm(d) * norm(e1) * norm(e2)) continue;
            const Vec3 s = a - p[face.nodes[0]];
            const double u = dot(s, h) / determinant;
            const Vec3 q = cross(s, e1);
            const double v = dot(d, q) / determinant;
            const double t = dot(e2, q) / determinant;
            if (u > -1e-9 && v > -1e-9 && u + v < 1 + 1e-9) hits.push_back(t);
        }
        std::sort(hits.begin(), hits.end());
        const double near = tolerance_ / norm(d);
        std::vector<Vec3> points;
        double last = 0;
        for (const double t : hits) {
            if (t < near || t > 1 - near || t < last + near) continue;
            points.push_back(a + t * d);
            last = t;
        }
        return points;
    }

    /// The guide points of a cable, metres: as given, with the crossings between them where asked for.
    std::vector<Vec3> guide_points(const CableSpec& spec) const {
        std::vector<Vec3> points;
        for (const Vec3& given : spec.points) {
            const Vec3 point = robot_.unit_m * given;
            if (spec.guides_at_crossings && !points.empty()) {
                const auto between = crossings(points.back(), point);
                points.insert(points.end(), between.begin(), between.end());
            }
            points.push_back(point);
        }
        return points;
    }

    void add_cable(const CableSpec& spec) {
        sim::Cable cable{spec.name, {}, spec.target, spec.friction, spec.anchor != CableSpec::Anchor::last};
        const auto points = guide_points(spec);
        for (std::size_t k = 0; k < points.size(); ++k) {
            const bool anchored = (k == 0 && spec.anchor == CableSpec::Anchor::first) ||
                                  (k + 1 == points.size() && spec.anchor == CableSpec::Anchor::last);
            if (anchored) {
                cable.points.push_back({{}, {}, points[k]});
                continue;
            }
            Result<sim::Attachment> attachment =
                attacher_->spread(points[k], robot_.unit_m * spec.eyelet_radius, tolerance_);
            if (!attachment) {
                const bool end = k == 0 || k + 1 == points.size();
                problem(spec.line, "cable", spec.name,
                        fmt::format("{} {} at {} lies outside every body{}",
                                    spec.guides_at_crossings ? "guide point" : "point", k + 1, show(points[k]),
                                    end ? "; anchor = \"first\" or \"last\" fixes an end in space" : ""));
                continue;
            }
            cable.points.push_back(std::move(*attachment));
        }
        check_shortening(spec, points);
        if (spec.gap_elements) drive_by_gaps(spec, points);
        description_.cables.push_back(std::move(cable));
    }

    void check_shortening(const CableSpec& spec, const std::vector<Vec3>& points) {
        double length = 0;
        for (std::size_t k = 1; k < points.size(); ++k) length += norm(points[k] - points[k - 1]);
        if (spec.target.kind == sim::CableTarget::Kind::shortening_m && spec.target.value >= length) {
            problem(spec.line, "cable", spec.name,
                    fmt::format("cannot be shortened by {:.6g} mm, it is {:.6g} mm long", 1e3 * spec.target.value,
                                1e3 * length));
        }
    }

    void add_marker(const MarkerSpec& spec) {
        if (const auto* point = std::get_if<Vec3>(&spec.place)) {
            Result<sim::Attachment> attachment = attacher_->carried_by_tet(robot_.unit_m * *point, tolerance_);
            if (!attachment) {
                problem(spec.line, "marker", spec.name,
                        fmt::format("the point {} lies outside every body; {}", show(robot_.unit_m * *point),
                                    show_bounds()));
                return;
            }
            description_.markers.push_back({spec.name, std::move(*attachment)});
            return;
        }
        const Box3 box = box_of(std::get<BoxSelector>(spec.place));
        std::vector<bool> corner(description_.mesh.points.size(), false);
        for (std::size_t t = 0; t < bodies_.tet_count(); ++t) {
            for (std::size_t a = 0; a < 4; ++a) corner[bodies_.tet(t)[a]] = true;
        }
        sim::Attachment mean;
        for (std::size_t n = 0; n < corner.size(); ++n) {
            if (corner[n] && box.contains(description_.mesh.points[n], box_margin_))
                mean.nodes.push_back(static_cast<int>(n));
        }
        if (mean.nodes.empty()) {
            problem(spec.line, "marker", spec.name, "the box holds no corner node of the mesh; " + show_bounds());
            return;
        }
        mean.weights.assign(mean.nodes.size(), 1.0 / static_cast<double>(mean.nodes.size()));
        description_.markers.push_back({spec.name, std::move(mean)});
    }

    const Robot& robot_;
    mesh::TetMesh whole_;             ///< regions as in regions_of()
    std::vector<int> node_of_whole_;  ///< (nodes of whole_) index in the description's mesh, or -1
    mesh::TetMesh bodies_;            ///< the description's mesh without actuated space
    const sim::Attacher* attacher_;
    sim::Description description_;
    Box3 box_;
    double tolerance_ = 0;   ///< for what should lie on the surface
    double box_margin_ = 0;  ///< for what should lie in a box
    std::string problems_;
};

}  // namespace

Result<sim::Model> build_model(const Robot& robot, mesh::TetMesh mesh) {
    return ModelBuilder(robot, std::move(mesh)).build();
}

}  // namespace pliant::robot
