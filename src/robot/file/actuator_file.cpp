#include "robot/file/actuator_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>

#include "robot/description/cable_length.hpp"
#include "robot/file/goal_file.hpp"

namespace pliant::robot {
namespace {

using config::Reader;

/// A missing target is at rest beside a range; otherwise exactly one kind (`given`) must be named.
bool is_clear(const Reader& actuator, std::ptrdiff_t given) {
    return given == 1 || (!actuator.has("target") && actuator.has("range"));
}

/// Empty where it is not clear which kind of target is meant, which has been reported then.
std::optional<CableTarget> read_target(Reader& cable) {
    using Kind = CableTarget::Kind;
    Reader reader = cable.table("target", !cable.has("range"));  // default: the rest value
    CableTarget target;
    const int given = int{reader.has("length_ratio")} + int{reader.has("shortening")} + int{reader.has("tension")};
    if (cable.has("target") && given != 1) reader.problem("", "takes one of length_ratio, shortening and tension");
    if (reader.has("length_ratio")) {
        target = {Kind::length_ratio, reader.number("length_ratio")};
        const TargetLimits limits = target_limits(target.kind, false);
        if (!(target.value > 0 && target.value <= limits.high))
            reader.problem("length_ratio", fmt::format("{} is not possible: {}", target.value, limits.words));
    }
    if (reader.has("shortening")) target = {Kind::shortening_m, reader.quantity("shortening", Dimension::length)};
    if (reader.has("tension")) target = {Kind::tension_N, reader.quantity("tension", Dimension::force)};
    if (target.kind == Kind::tension_N && target.value < 0)
        reader.problem("tension", "must not be negative: a cable can only pull");
    for (const char* key : {"length_ratio", "shortening", "tension"}) (void)reader.raw(key);
    if (!is_clear(cable, given)) {
        (void)reader.raw("offset");
        reader.finish();
        return std::nullopt;
    }
    const bool force = target.kind == Kind::tension_N;
    target.offset = reader.quantity("offset", force ? Dimension::force : Dimension::length, 0);
    reader.finish();
    return target;
}

SteeredBy steered_by(const CableTarget& target, bool gap_elements) {
    std::optional<Dimension> dimension;
    if (target.kind == CableTarget::Kind::shortening_m) dimension = Dimension::length;
    if (target.kind == CableTarget::Kind::tension_N) dimension = Dimension::force;
    const TargetLimits limits = target_limits(target.kind, gap_elements);
    return {dimension, limits.low, limits.high, limits.words, "tension"};
}

SteeredBy steered_by(const ChamberTarget& target) {
    switch (target.kind) {
        case ChamberTarget::Kind::volume_change_m3:
            return {Dimension::volume, -1e300, 1e300, "volumes", "pressure"};
        case ChamberTarget::Kind::pressure_Pa:
            return {Dimension::pressure, -1e300, 1e300, "pressures", "pressure"};
        default:
            return {{}, 1e-6, 1e300, "above zero", "pressure"};
    }
}

/// Reads `points`; `kind` is for messages.
std::vector<Vec3> read_path(Reader& reader, std::string_view kind) {
    std::vector<Vec3> points = reader.vectors("points");
    if (reader.has("points") && points.size() < 2)
        reader.problem("points", fmt::format("a {} needs at least two points", kind));
    for (std::size_t i = 1; i < points.size(); ++i) {
        if (points[i] == points[i - 1])
            reader.problem("points", fmt::format("points {} and {} are the same", i, i + 1));
    }
    return points;
}

Anchor read_anchor(Reader& reader) {
    const std::string anchor = reader.choice("anchor", {"none", "first", "last"}, "none");
    return anchor == "first" ? Anchor::first : (anchor == "last" ? Anchor::last : Anchor::none);
}

/// Stiffness with which gap or air elements are held to their target (A.4), relative to the softest body.
std::optional<double> read_weight(Reader& reader) {
    if (!reader.has("weight")) return std::nullopt;
    const double weight = reader.number("weight");
    if (weight > 0 && weight <= largest_space_weight) return weight;
    reader.problem("weight",
                   fmt::format("is the stiffness of the elements relative to the softest Young's modulus: above 0 "
                               "and at most {:.6g}",
                               largest_space_weight));
    return std::nullopt;
}

void read_cable(Reader& reader, Context& context, CableSpec& cable) {
    cable.points = read_path(reader, "cable");
    cable.anchor = read_anchor(reader);
    cable.guides_at_crossings = reader.choice("guides", {"points", "crossings"}, "points") == "crossings";
    cable.gap_elements = reader.choice("model", {"length", "gap-elements"}, "length") == "gap-elements";
    cable.fill_notches = reader.boolean("fill_notches", false);
    if (cable.fill_notches && !cable.gap_elements)
        reader.problem("fill_notches", "fills them with gap elements, which act with model = \"gap-elements\" only");
    if (cable.fill_notches && context.robot.mesh.file)
        reader.problem("fill_notches", "cannot add elements to a mesh file; name their region in a [[gap]]");
    cable.eyelet_radius = reader.quantity("eyelet_radius", Dimension::length, 0) / context.robot.unit_m;
    if (cable.eyelet_radius < 0) reader.problem("eyelet_radius", "must not be negative");
    cable.friction = reader.number("friction", 0);
    if (!(cable.friction >= 0 && cable.friction <= 10))
        reader.problem("friction", fmt::format("{} is not possible; a coefficient from 0 to 10, a cord in a plastic "
                                               "tube has 0.1 to 0.3",
                                               cable.friction));
    const std::optional<CableTarget> target = read_target(reader);
    cable.target = target.value_or(CableTarget{});
    if (target) cable.steering = read_steering(reader, steered_by(*target, cable.gap_elements));
    if (!target) cable.steering = skip_steering(reader, cable.name, context);
    if (reader.has("weight") && !cable.gap_elements)
        reader.problem("weight", "is that of gap elements, which act with model = \"gap-elements\" only");
    cable.weight = read_weight(reader).value_or(cable.weight);
    if (cable.gap_elements && cable.friction > 0)
        reader.problem("friction", "model = \"gap-elements\" closes the gaps and has no guides; leave it out");
    if (cable.gap_elements && cable.target.kind == CableTarget::Kind::tension_N)
        reader.problem("target", "model = \"gap-elements\" takes lengths only: length_ratio or shortening");
    else if (cable.gap_elements && is_paid_out(cable.target))
        reader.problem("target",
                       "model = \"gap-elements\" closes gaps and cannot pay the cable out: use a length_ratio of "
                       "1 or less, or a shortening of 0 or more");
}

void read_spring(Reader& reader, Context& context, SpringSpec& spring) {
    spring.points = read_path(reader, "spring");
    spring.anchor = read_anchor(reader);
    spring.eyelet_radius = reader.quantity("eyelet_radius", Dimension::length, 0) / context.robot.unit_m;
    if (spring.eyelet_radius < 0) reader.problem("eyelet_radius", "must not be negative");
    spring.stiffness_N_m = reader.quantity("stiffness", Dimension::stiffness);
    if (reader.has("stiffness") && !(spring.stiffness_N_m > 0)) reader.problem("stiffness", "must be above zero");
    if (reader.has("free_length")) {
        spring.free_length = reader.quantity("free_length", Dimension::length) / context.robot.unit_m;
        if (*spring.free_length < 0) reader.problem("free_length", "must not be negative");
    }
    (void)reader.raw("free_length");
    spring.only_pulls = reader.boolean("only_pulls", false);
}

double read_ratio(Reader& reader, std::string_view key) {
    const double ratio = reader.number(key);
    if (!(ratio > 0)) reader.problem(key, fmt::format("a ratio of {} is not possible; it must be above zero", ratio));
    return ratio;
}

/// Empty as for a cable.
std::optional<ChamberTarget> read_chamber_target(Reader& chamber) {
    using Kind = ChamberTarget::Kind;
    constexpr std::array<std::string_view, 4> kinds = {"volume_ratio", "volume_change", "pressure", "gas_ratio"};
    Reader reader = chamber.table("target", !chamber.has("range"));
    const auto given = std::count_if(kinds.begin(), kinds.end(), [&](auto kind) { return reader.has(kind); });
    if (chamber.has("target") && given != 1)
        reader.problem("", "takes one of volume_ratio, volume_change, pressure and gas_ratio");
    ChamberTarget target;
    if (reader.has("volume_ratio")) target = {Kind::volume_ratio, read_ratio(reader, "volume_ratio")};
    if (reader.has("volume_change"))
        target = {Kind::volume_change_m3, reader.quantity("volume_change", Dimension::volume)};
    if (reader.has("pressure")) target = {Kind::pressure_Pa, reader.quantity("pressure", Dimension::pressure)};
    if (reader.has("gas_ratio")) target = {Kind::gas_ratio, read_ratio(reader, "gas_ratio")};
    for (const auto kind : kinds) (void)reader.raw(kind);
    if (!is_clear(chamber, given)) {
        (void)reader.raw("offset");
        reader.finish();
        return std::nullopt;
    }
    const bool volume = target.kind == Kind::volume_ratio || target.kind == Kind::volume_change_m3;
    if (target.kind != Kind::gas_ratio)
        target.offset = reader.quantity("offset", volume ? Dimension::volume : Dimension::pressure, 0);
    else if (reader.raw("offset") != nullptr)
        reader.problem("offset", "goes with pressure, volume_change and volume_ratio, not with a sealed chamber");
    reader.finish();
    return target;
}

/// surface = FILE, region = NAME (of the mesh file) or geometry = { shape }.
std::optional<Geometry> read_drawn_air(Reader& reader, Context& context) {
    std::optional<Geometry> air;
    if (reader.has("surface")) {
        air = SurfaceFile{need_file(reader, "surface", reader.text("surface"), context), "",
                          read_placement(reader, "place")};
    } else if (reader.has("region")) {
        air = MeshRegion{reader.text("region"), {}};
        if (!context.robot.mesh.file) reader.problem("region", "needs a tet mesh; add file = \"...\" to [mesh]");
    } else if (reader.has("geometry")) {
        air = read_shape(reader, context);
        if (context.robot.mesh.file)
            reader.problem("geometry", "cannot be cut out of a mesh file; name its region or give a surface");
    }
    for (const char* key : {"surface", "region", "geometry"}) (void)reader.raw(key);
    return air;
}

/// The air between the drawn bodies and the cap, as a region to be meshed.
Geometry enclosed_by_bodies(Reader& reader, const Vec3& point, std::vector<mesh::Solid> walls, const Context& context) {
    for (const BodySpec& body : context.robot.bodies) {
        if (const auto* solid = std::get_if<mesh::Solid>(&body.geometry)) {
            walls.push_back(*solid);
            continue;
        }
        reader.problem(
            "",
            fmt::format("body \"{}\" comes from a file: inside needs no cap and model = \"volume\" there", body.name));
        return MeshRegion{};
    }
    if (walls.empty()) return MeshRegion{};
    return std::make_shared<const mesh::SolidNode>(mesh::SolidNode{mesh::EnclosedSolid{point, std::move(walls)}});
}

/// inside = [x, y, z], and cap = { shape } if the cavity has a mouth.
Geometry read_cavity(Reader& reader, Context& context, bool meshed) {
    const Vec3 point = reader.vector("inside");
    std::vector<mesh::Solid> caps;
    if (const config::Value* cap = reader.raw("cap"))
        caps.push_back(mesh::read_solid(*cap, reader.path() + ".cap", context.shapes, context.problems));
    if (caps.empty() && !meshed) return CavityAt{point};
    return enclosed_by_bodies(reader, point, std::move(caps), context);
}

Geometry read_air(Reader& reader, Context& context) {
    const int given = int{reader.has("surface")} + int{reader.has("region")} + int{reader.has("geometry")};
    if (given != 1)
        reader.problem("",
                       "takes one of geometry (a shape that is cut out of the bodies), surface (a file) and region "
                       "(of the mesh file)");
    return read_drawn_air(reader, context).value_or(MeshRegion{});
}

void read_chamber(Reader& reader, Context& context, ChamberSpec& chamber) {
    chamber.elements = reader.choice("model", {"volume", "elements"}, "volume") == "elements";
    if (reader.has("inside")) {
        chamber.air = read_cavity(reader, context, chamber.elements);
        if (read_drawn_air(reader, context))
            reader.problem("inside", "finds a cavity of the bodies; leave geometry, surface and region out");
    } else {
        if (reader.raw("cap") != nullptr) reader.problem("cap", "closes a cavity that inside = [x, y, z] names");
        const int given = int{reader.has("surface")} + int{reader.has("region")} + int{reader.has("geometry")};
        if (given != 1)
            reader.problem(
                "",
                "takes one of geometry (a shape that is cut out of the bodies), surface (a file), region (of "
                "the mesh file) and inside (a point of a cavity of the bodies)");
        chamber.air = read_drawn_air(reader, context).value_or(MeshRegion{});
    }
    if (chamber.elements && std::holds_alternative<SurfaceFile>(chamber.air))
        reader.problem("surface", "model = \"elements\" needs meshed air: geometry or region");
    if (reader.has("weight") && !chamber.elements)
        reader.problem("weight", "is that of air elements, which act with model = \"elements\" only");
    chamber.weight = read_weight(reader).value_or(chamber.weight);
    const std::optional<ChamberTarget> target = read_chamber_target(reader);
    chamber.target = target.value_or(ChamberTarget{});
    if (target) chamber.steering = read_steering(reader, steered_by(*target));
    if (!target) chamber.steering = skip_steering(reader, chamber.name, context);
    const auto kind = chamber.target.kind;
    if (chamber.elements && kind != ChamberTarget::Kind::volume_ratio && kind != ChamberTarget::Kind::volume_change_m3)
        reader.problem("target", "model = \"elements\" takes volumes only: volume_ratio or volume_change");
}

void read_gap(Reader& reader, Context& context, GapSpec& gap) {
    gap.space = read_air(reader, context);
    if (std::holds_alternative<SurfaceFile>(gap.space))
        reader.problem("surface", "a gap must be meshed: give geometry or region");
    gap.weight = read_weight(reader);
}

/// Adds one gap for all notches, in addition to those of the file.
void add_notches(Reader& root, Robot& robot) {
    const auto asks =
        std::find_if(robot.cables.begin(), robot.cables.end(), [](const CableSpec& c) { return c.fill_notches; });
    if (asks == robot.cables.end()) return;
    for (const GapSpec& gap : robot.gaps) {
        if (gap.name == notches_name)
            root.problem("gap", fmt::format("the name \"{}\" belongs to what fill_notches fills", notches_name));
    }
    robot.gaps.push_back({std::string(notches_name), CrossedNotches{}, asks->line});
}

}  // namespace

void read_actuators(Reader& root, Context& context) {
    read_each(root, context, "cable", "cables", context.robot.cables, read_cable);
    read_each(root, context, "spring", "springs", context.robot.springs, read_spring);
    read_each(root, context, "chamber", "chambers", context.robot.chambers, read_chamber);
    read_each(root, context, "gap", "gaps", context.robot.gaps, read_gap);
    add_notches(root, context.robot);
    const auto& cables = context.robot.cables;
    const auto uses = [](const CableSpec& cable) { return cable.gap_elements; };
    if (context.robot.gaps.empty() && std::any_of(cables.begin(), cables.end(), uses))
        root.problem("",
                     "a cable has model = \"gap-elements\", but there is no [[gap]]; "
                     "fill_notches = true makes one of the notches that the cable crosses");
}

}  // namespace pliant::robot
