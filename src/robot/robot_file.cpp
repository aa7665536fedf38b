#include <algorithm>
#include <cmath>
#include <set>

#include "core/config.hpp"
#include "core/text.hpp"
#include "robot/contact_file.hpp"
#include "robot/material_file.hpp"
#include "robot/material_library.hpp"
#include "robot/program_file.hpp"
#include "robot/robot.hpp"

namespace pliant::robot {
namespace {

namespace fs = std::filesystem;
using config::Problems;
using config::Reader;

/// Everything that the readers of single tables share.
struct Context {
    Robot& robot;
    Problems& problems;
    mesh::NamedShapes shapes;  ///< [shape.NAME]: solids that others may use
};

fs::path beside(const Context& context, const std::string& file) {
    const fs::path path(file);
    return path.is_absolute() ? path : context.robot.file.parent_path() / path;
}

void need_file(Reader& reader, std::string_view key, const fs::path& path) {
    std::error_code code;
    if (!fs::is_regular_file(path, code)) reader.problem(key, "there is no file " + path.string());
}

/// A name that is unique among its kind.
std::string read_name(Reader& reader, std::set<std::string>& taken, std::string_view kind) {
    const std::string name = reader.text("name");
    if (name.empty()) return name;
    if (!taken.insert(name).second) reader.problem("name", fmt::format("there are two {} named \"{}\"", kind, name));
    return name;
}

MaterialSpec read_one_material(Reader& reader, const std::string& name) {
    MaterialSpec material = read_material(reader, name);
    reader.finish();
    return material;
}

void read_materials(Reader& root, Context& context) {
    const config::Value* tables = root.raw("material");
    for (auto& [name, reader] : root.named_tables("material")) {
        if (!reader.has("base")) {
            context.robot.materials.push_back(read_one_material(reader, name));
            (void)reader.raw("base");
            continue;
        }
        const std::string base = reader.text("base");
        if (const Result<LibraryMaterial> found = library_material(base); !found) {
            if (!base.empty()) reader.problem("base", found.error().message);
            context.robot.materials.emplace_back().name = name;
            continue;
        }
        for (const auto& [key, own] : std::get<config::Table>(tables->data)) {
            if (key != name) continue;
            const config::Value merged = with_base(own, base);
            Reader whole(merged, context.problems, reader.path());
            context.robot.materials.push_back(read_one_material(whole, name));
        }
    }
}

/// A material of the robot file, or else of the library.
int find_material(Reader& reader, Context& context) {
    const std::string wanted = reader.text("material");
    std::vector<MaterialSpec>& materials = context.robot.materials;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < materials.size(); ++i) {
        names.push_back(materials[i].name);
        if (names.back() == wanted) return static_cast<int>(i);
    }
    if (wanted.empty()) return 0;
    if (Result<LibraryMaterial> found = library_material(wanted)) {
        materials.push_back(std::move(found->spec));
        return static_cast<int>(materials.size()) - 1;
    }
    const std::string near = nearest_name(wanted, names);
    if (!near.empty())
        reader.problem("material", fmt::format("no material \"{}\"; did you mean \"{}\"?", wanted, near));
    else if (names.empty())
        reader.problem("material", fmt::format("no material \"{}\" in the library{}", wanted, library_hint(wanted)));
    else
        reader.problem("material", fmt::format("no material \"{}\"; there is {}, and the library{}", wanted,
                                               join_names(names), library_hint(wanted)));
    return 0;
}

BoxSelector read_box(Reader& reader) {
    const auto corners = reader.vectors("box");
    if (corners.size() != 2) {
        if (reader.has("box")) reader.problem("box", "needs two corners [[x, y, z], [x, y, z]]");
        return {};
    }
    const auto& [a, b] = std::pair(corners[0], corners[1]);
    if (a.x > b.x || a.y > b.y || a.z > b.z)
        reader.problem("box", "the first corner must be the lower one on every axis");
    return {a, b};
}

Geometry read_geometry(Reader& reader, Context& context) {
    const bool has_mesh_file = context.robot.mesh.file.has_value();
    if (reader.has("region")) {
        const std::string region = reader.text("region");
        if (!has_mesh_file) reader.problem("region", "needs a tet mesh; add file = \"...\" to [mesh]");
        if (reader.has("box")) return MeshRegion{region, read_box(reader)};
        return MeshRegion{region, {}};
    }
    if (has_mesh_file) {
        reader.problem("", "with a mesh file a body names its region: region = \"...\" or region = \"all\"");
        (void)reader.raw("geometry");
        return MeshRegion{"all", {}};
    }
    const config::Value* geometry = reader.raw("geometry");
    if (geometry == nullptr) {
        reader.problem("",
                       "\"geometry\" is missing; it is a file such as \"finger.stl\" or a shape such as { box = "
                       "[[0,0,0],[1,1,1]] }");
        return MeshRegion{"all", {}};
    }
    if (std::holds_alternative<std::string>(geometry->data)) {
        const SurfaceFile surface{beside(context, std::get<std::string>(geometry->data))};
        need_file(reader, "geometry", surface.path);
        return surface;
    }
    return mesh::read_solid(*geometry, reader.path() + ".geometry", context.shapes, context.problems);
}

void read_bodies(Reader& root, Context& context) {
    std::set<std::string> taken;
    for (Reader& reader : root.tables("body")) {
        BodySpec body;
        body.line = reader.line();
        body.name = read_name(reader, taken, "bodies");
        body.material = find_material(reader, context);
        body.geometry = read_geometry(reader, context);
        reader.finish();
        context.robot.bodies.push_back(std::move(body));
    }
    if (context.robot.bodies.empty()) root.problem("", "there is no body; add [[body]]");
}

void read_mesh(Reader& root, Context& context) {
    Reader reader = root.table("mesh", false);
    MeshSpec& mesh = context.robot.mesh;
    mesh.line = reader.line();
    mesh.order = static_cast<int>(reader.integer("order", 2));
    if (mesh.order != 1 && mesh.order != 2)
        reader.problem("order", "is 1 (linear tets, fast preview) or 2 (quadratic tets)");
    if (reader.has("file")) {
        mesh.file = beside(context, reader.text("file"));
        need_file(reader, "file", *mesh.file);
        if (reader.has("size")) reader.problem("size", "has no meaning beside a mesh file");
    }
    if (reader.has("size")) mesh.size = reader.quantity("size", Dimension::length, 1) / context.robot.unit_m;
    (void)reader.raw("size");
    if (reader.has("size") && !(mesh.size > 0)) reader.problem("size", "must be above zero");
    reader.finish();
}

Selector read_selector(Reader& reader, const Context& context) {
    constexpr std::string_view kinds[] = {"box", "plane", "sphere", "surface", "nodes"};
    std::vector<std::string> given;
    for (const std::string_view kind : kinds) {
        if (reader.has(kind)) given.emplace_back(kind);
    }
    if (given.size() != 1) {
        for (const std::string& kind : given) (void)reader.raw(kind);
        reader.problem("", given.empty() ? std::string("says nothing to hold; add box, plane, sphere, surface or nodes")
                                         : "takes only one of " + join_names(given));
        return BoxSelector{};
    }
    if (given[0] == "box") return read_box(reader);
    if (given[0] == "plane") {
        Reader plane = reader.table("plane");
        const PlaneSelector selector{plane.vector("point"), plane.vector("normal")};
        if (plane.has("normal") && norm(selector.normal) == 0) plane.problem("normal", "must not be zero");
        plane.finish();
        return selector;
    }
    if (given[0] == "sphere") {
        Reader sphere = reader.table("sphere");
        const SphereSelector selector{sphere.vector("center"), sphere.number("radius")};
        if (sphere.has("radius") && !(selector.radius > 0)) sphere.problem("radius", "must be above zero");
        sphere.finish();
        return selector;
    }
    if (given[0] == "surface") {
        const SurfaceSelector selector{beside(context, reader.text("surface"))};
        need_file(reader, "surface", selector.path);
        return selector;
    }
    NodeSelector selector;
    for (const double value : reader.numbers("nodes")) {
        if (value < 0 || value != std::floor(value) || value > 2e9)
            reader.problem("nodes", "holds a value that is no node number");
        else
            selector.nodes.push_back(static_cast<int>(value));
    }
    return selector;
}

/// rotate = { angle = 90, axis = [x, y, z], center = [x, y, z] }; degrees, as in shapes.
void read_rotation(Reader& reader, FixedSpec& fixed) {
    if (!reader.has("rotate")) return (void)reader.raw("rotate");
    Reader rotate = reader.table("rotate");
    fixed.rotate_deg = rotate.number("angle");
    fixed.rotation_axis = rotate.vector("axis");
    if (rotate.has("axis") && norm(fixed.rotation_axis) == 0) rotate.problem("axis", "must not be zero");
    fixed.rotation_center = rotate.vector("center", Vec3{});
    rotate.finish();
}

void read_supports(Reader& root, Context& context) {
    std::set<std::string> taken;
    for (Reader& reader : root.tables("fixed")) {
        FixedSpec fixed;
        fixed.line = reader.line();
        fixed.name = read_name(reader, taken, "[[fixed]]");
        fixed.selector = read_selector(reader, context);
        fixed.move = reader.vector("move", Vec3{});
        read_rotation(reader, fixed);
        reader.finish();
        context.robot.fixed.push_back(std::move(fixed));
    }
    if (context.robot.fixed.empty())
        root.problem("", "nothing is fixed; add [[fixed]] with a box that holds one end of the robot");
}

void read_plates(Reader& root, Context& context) {
    std::set<std::string> taken;
    for (Reader& reader : root.tables("plate")) {
        PlateSpec plate;
        plate.line = reader.line();
        plate.name = read_name(reader, taken, "plates");
        plate.selector = read_selector(reader, context);
        reader.finish();
        context.robot.plates.push_back(std::move(plate));
    }
}

void read_loads(Reader& root, Context& context) {
    std::set<std::string> taken;
    for (Reader& reader : root.tables("load")) {
        LoadSpec load;
        load.line = reader.line();
        load.name = read_name(reader, taken, "loads");
        load.box = read_box(reader);
        if (reader.has("pressure")) {
            load.pressure_Pa = reader.quantity("pressure", Dimension::pressure);
            if (reader.has("force")) reader.problem("force", "give either force or pressure");
            (void)reader.raw("force");
        } else {
            const auto force = reader.quantities("force", Dimension::force, 3);
            if (!reader.has("force"))
                reader.problem("",
                               "\"force\" is missing; it is a list such as [\"0 N\", \"0 N\", \"0.06 N\"] (or "
                               "give pressure = \"3 kPa\")");
            load.force_N = {force[0], force[1], force[2]};
            (void)reader.raw("pressure");
        }
        reader.finish();
        context.robot.loads.push_back(std::move(load));
    }
}

sim::CableTarget read_target(Reader& cable) {
    using Kind = sim::CableTarget::Kind;
    Reader reader = cable.table("target");
    sim::CableTarget target;
    const int given = int{reader.has("length_ratio")} + int{reader.has("shortening")} + int{reader.has("tension")};
    if (cable.has("target") && given != 1) reader.problem("", "takes one of length_ratio, shortening and tension");
    if (reader.has("length_ratio")) {
        target = {Kind::length_ratio, reader.number("length_ratio")};
        if (!(target.value > 0 && target.value <= 1)) {
            reader.problem("length_ratio",
                           fmt::format("{} is not possible; a cable gets shorter: above 0, at most 1", target.value));
        }
    }
    if (reader.has("shortening")) target = {Kind::shortening_m, reader.quantity("shortening", Dimension::length)};
    if (reader.has("tension")) target = {Kind::tension_N, reader.quantity("tension", Dimension::force)};
    if (target.kind != Kind::length_ratio && target.value < 0) {
        reader.problem("", "must not be negative: a cable can only pull");
    }
    for (const char* key : {"length_ratio", "shortening", "tension"}) (void)reader.raw(key);
    reader.finish();
    return target;
}

void read_cables(Reader& root, Context& context) {
    std::set<std::string> taken;
    for (Reader& reader : root.tables("cable")) {
        CableSpec cable;
        cable.line = reader.line();
        cable.name = read_name(reader, taken, "cables");
        cable.points = reader.vectors("points");
        if (reader.has("points") && cable.points.size() < 2)
            reader.problem("points", "a cable needs at least two points");
        for (std::size_t i = 1; i < cable.points.size(); ++i) {
            if (cable.points[i] == cable.points[i - 1])
                reader.problem("points", fmt::format("points {} and {} are the same", i, i + 1));
        }
        const std::string anchor = reader.choice("anchor", {"none", "first", "last"}, "none");
        cable.anchor = anchor == "first" ? CableSpec::Anchor::first
                                         : (anchor == "last" ? CableSpec::Anchor::last : CableSpec::Anchor::none);
        cable.guides_at_crossings = reader.choice("guides", {"points", "crossings"}, "points") == "crossings";
        cable.gap_elements = reader.choice("model", {"length", "gap-elements"}, "length") == "gap-elements";
        cable.eyelet_radius = reader.quantity("eyelet_radius", Dimension::length, 0) / context.robot.unit_m;
        if (cable.eyelet_radius < 0) reader.problem("eyelet_radius", "must not be negative");
        cable.friction = reader.number("friction", 0);
        if (!(cable.friction >= 0 && cable.friction <= 10))
            reader.problem("friction", "is a coefficient: 0 or more, a cord in a plastic tube has 0.1 to 0.3");
        cable.target = read_target(reader);
        if (cable.gap_elements && cable.target.kind == sim::CableTarget::Kind::tension_N)
            reader.problem("target", "model = \"gap-elements\" knows lengths only: length_ratio or shortening");
        reader.finish();
        context.robot.cables.push_back(std::move(cable));
    }
}

sim::ChamberTarget read_chamber_target(Reader& chamber) {
    using Kind = sim::ChamberTarget::Kind;
    constexpr std::array<std::string_view, 4> kinds = {"volume_ratio", "volume_change", "pressure", "gas_ratio"};
    Reader reader = chamber.table("target");
    const auto given = std::count_if(kinds.begin(), kinds.end(), [&](auto kind) { return reader.has(kind); });
    if (chamber.has("target") && given != 1)
        reader.problem("", "takes one of volume_ratio, volume_change, pressure and gas_ratio");
    sim::ChamberTarget target;
    if (reader.has("volume_ratio")) target = {Kind::volume_ratio, reader.number("volume_ratio")};
    if (reader.has("volume_change"))
        target = {Kind::volume_change_m3, reader.quantity("volume_change", Dimension::volume)};
    if (reader.has("pressure")) target = {Kind::pressure_Pa, reader.quantity("pressure", Dimension::pressure)};
    if (reader.has("gas_ratio")) target = {Kind::gas_ratio, reader.number("gas_ratio")};
    if ((target.kind == Kind::volume_ratio || target.kind == Kind::gas_ratio) && !(target.value > 0))
        reader.problem("", fmt::format("a ratio of {} is not possible; it must be above zero", target.value));
    for (const auto kind : kinds) (void)reader.raw(kind);
    reader.finish();
    return target;
}

/// surface = FILE, region = NAME (of the mesh file) or geometry = { shape }, exactly one.
Geometry read_air(Reader& reader, Context& context) {
    const int given = int{reader.has("surface")} + int{reader.has("region")} + int{reader.has("geometry")};
    Geometry air = MeshRegion{};
    if (given != 1)
        reader.problem("",
                       "takes one of geometry (a shape that is cut out of the bodies), surface (a file) and region "
                       "(of the mesh file)");
    if (reader.has("surface")) {
        const SurfaceFile file{beside(context, reader.text("surface"))};
        need_file(reader, "surface", file.path);
        air = file;
    } else if (reader.has("region")) {
        air = MeshRegion{reader.text("region"), {}};
        if (!context.robot.mesh.file) reader.problem("region", "needs a tet mesh; add file = \"...\" to [mesh]");
    } else if (reader.has("geometry")) {
        air = mesh::read_solid(*reader.raw("geometry"), reader.path() + ".geometry", context.shapes, context.problems);
        if (context.robot.mesh.file)
            reader.problem("geometry", "cannot be cut out of a mesh file; name its region or give a surface");
    }
    for (const char* key : {"surface", "region", "geometry"}) (void)reader.raw(key);
    return air;
}

void read_chambers(Reader& root, Context& context) {
    std::set<std::string> taken;
    for (Reader& reader : root.tables("chamber")) {
        ChamberSpec chamber;
        chamber.line = reader.line();
        chamber.name = read_name(reader, taken, "chambers");
        chamber.air = read_air(reader, context);
        chamber.elements = reader.choice("model", {"volume", "elements"}, "volume") == "elements";
        if (chamber.elements && std::holds_alternative<SurfaceFile>(chamber.air))
            reader.problem("surface", "model = \"elements\" needs meshed air: geometry or region");
        chamber.target = read_chamber_target(reader);
        const auto kind = chamber.target.kind;
        if (chamber.elements && kind != sim::ChamberTarget::Kind::volume_ratio &&
            kind != sim::ChamberTarget::Kind::volume_change_m3)
            reader.problem("target", "model = \"elements\" knows volumes only: volume_ratio or volume_change");
        reader.finish();
        context.robot.chambers.push_back(std::move(chamber));
    }
}

void read_gaps(Reader& root, Context& context) {
    std::set<std::string> taken;
    for (Reader& reader : root.tables("gap")) {
        GapSpec gap;
        gap.line = reader.line();
        gap.name = read_name(reader, taken, "gaps");
        gap.space = read_air(reader, context);
        if (std::holds_alternative<SurfaceFile>(gap.space))
            reader.problem("surface", "a gap must be meshed: give geometry or region");
        reader.finish();
        context.robot.gaps.push_back(std::move(gap));
    }
    const auto& cables = context.robot.cables;
    const auto uses = [](const CableSpec& cable) { return cable.gap_elements; };
    if (context.robot.gaps.empty() && std::any_of(cables.begin(), cables.end(), uses))
        root.problem("", "a cable has model = \"gap-elements\", but there is no [[gap]]");
}

void read_markers(Reader& root, Context& context) {
    std::set<std::string> taken;
    for (Reader& reader : root.tables("marker")) {
        MarkerSpec marker;
        marker.line = reader.line();
        marker.name = read_name(reader, taken, "markers");
        if (reader.has("box")) {
            marker.place = read_box(reader);
            if (reader.has("point")) reader.problem("point", "give either point or box");
            (void)reader.raw("point");
        } else {
            marker.place = reader.vector("point");
            (void)reader.raw("box");
        }
        reader.finish();
        context.robot.markers.push_back(std::move(marker));
    }
}

Result<Robot> read_robot(config::Document document, const std::vector<std::string>& assignments) {
    for (const std::string& assignment : assignments) {
        if (Status status = config::set(document, assignment); !status) return tl::unexpected(status.error());
    }
    if (Status status = config::resolve_parameters(document); !status) return tl::unexpected(status.error());

    Problems problems(document.file.string());
    Reader root(document.root, problems);
    Robot robot;
    robot.file = document.file;
    robot.name = root.text("name");
    const std::string unit = root.text("length_unit");
    if (const Result<double> factor = unit_factor(unit, Dimension::length))
        robot.unit_m = *factor;
    else if (root.has("length_unit"))
        root.problem("length_unit", factor.error().message);

    Context context{robot, problems, {}};
    if (const config::Value* shapes = root.raw("shape"); shapes != nullptr) {
        if (const auto* table = std::get_if<config::Table>(&shapes->data)) {
            for (const auto& [name, value] : *table) context.shapes.emplace_back(name, &value);
        } else {
            root.problem("shape", "write [shape.NAME] for each shape");
        }
    }
    read_materials(root, context);
    read_mesh(root, context);
    read_bodies(root, context);
    read_supports(root, context);
    read_plates(root, context);
    read_loads(root, context);
    read_cables(root, context);
    read_chambers(root, context);
    read_gaps(root, context);
    read_contact(root, robot, context.shapes, problems);
    read_markers(root, context);
    read_program(root, robot);
    root.finish();
    if (Status status = problems.status(); !status) return tl::unexpected(status.error());
    return robot;
}

}  // namespace

Result<Robot> load_robot(const fs::path& file, const std::vector<std::string>& assignments) {
    Result<config::Document> document = config::load(file);
    if (!document) return tl::unexpected(document.error());
    return read_robot(std::move(*document), assignments);
}

Result<Robot> parse_robot(std::string_view text, const fs::path& file, const std::vector<std::string>& assignments) {
    Result<config::Document> document = config::parse(text, file);
    if (!document) return tl::unexpected(document.error());
    return read_robot(std::move(*document), assignments);
}

}  // namespace pliant::robot
