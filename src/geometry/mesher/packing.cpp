#include "geometry/mesher/packing.hpp"

#include <limits>
#include <memory>

#include "geometry/mesh/triangle_tree.hpp"
#include "geometry/shapes/flat_faces.hpp"

namespace pliant::mesh {
namespace {

constexpr int deepest = 200;  ///< nesting of solids; robot files have far less

void pack_solid(Packer& out, const Solid& solid);
Solid unpack_solid(Unpacker& in, int depth);

void pack_solids(Packer& out, const std::vector<Solid>& solids) {
    out.number<std::uint64_t>(solids.size());
    for (const Solid& solid : solids) pack_solid(out, solid);
}

std::vector<Solid> unpack_solids(Unpacker& in, int depth) {
    std::vector<Solid> solids;
    for (std::size_t left = in.count(1); left > 0 && in.good(); --left) solids.push_back(unpack_solid(in, depth + 1));
    return solids;
}

void pack_surface(Packer& out, const std::shared_ptr<const TriangleTree>& surface) {
    pack(out, surface ? surface->surface() : TriMesh{});
}

std::shared_ptr<const TriangleTree> unpack_surface(Unpacker& in) {
    TriMesh surface;
    unpack(in, surface);
    if (!in.good() || surface.triangles.empty()) return nullptr;  // a tree needs points that exist
    return std::make_shared<const TriangleTree>(std::move(surface));
}

void pack_faces(Packer& out, const FacetedSurface& faces) {
    out.list(faces.points);
    out.number<std::uint64_t>(faces.pieces.size());
    for (const FacetedSurface::Piece& piece : faces.pieces) {
        out.number<std::uint64_t>(piece.size());
        for (const FacetedSurface::Shell& shell : piece) {
            out.number<std::uint64_t>(shell.size());
            for (const FacetedSurface::Face& face : shell) {
                out.number<std::uint64_t>(face.size());
                for (const FacetedSurface::Loop& loop : face) out.list(loop);
            }
        }
    }
}

template <class Item, class Read>
std::vector<Item> unpack_items(Unpacker& in, const Read& read) {
    std::vector<Item> items;
    for (std::size_t left = in.count(sizeof(std::uint64_t)); left > 0 && in.good(); --left) items.push_back(read());
    return items;
}

std::shared_ptr<const FacetedSurface> unpack_faces(Unpacker& in) {
    auto faces = std::make_shared<FacetedSurface>();
    faces->points = in.list<Vec3>();
    const auto read_loop = [&] {
        FacetedSurface::Loop loop = in.list<int>();
        for (const int point : loop) {
            if (point < 0 || static_cast<std::size_t>(point) >= faces->points.size()) in.fail();
        }
        return loop;
    };
    const auto read_face = [&] { return unpack_items<FacetedSurface::Loop>(in, read_loop); };
    const auto read_shell = [&] { return unpack_items<FacetedSurface::Face>(in, read_face); };
    const auto read_piece = [&] { return unpack_items<FacetedSurface::Shell>(in, read_shell); };
    faces->pieces = unpack_items<FacetedSurface::Piece>(in, read_piece);
    return faces;
}

/// Writes a shape; its index in the variant has been written before.
struct ShapePacker {
    Packer& out;

    void operator()(const BoxSolid& s) const { points({s.low, s.high}); }
    void operator()(const SphereSolid& s) const {
        points({s.center});
        out.number(s.radius);
    }
    void operator()(const CylinderSolid& s) const {
        points({s.from, s.to});
        out.number(s.radius);
    }
    void operator()(const PrismSolid& s) const {
        out.list(s.polygon);
        for (const int axis : s.axes) out.number(axis);
        out.number(s.from);
        out.number(s.to);
    }
    void operator()(const CombinedSolid& s) const {
        out.number(static_cast<int>(s.operation));
        pack_solids(out, s.parts);
    }
    void operator()(const TranslatedSolid& s) const {
        pack_solid(out, s.of);
        points({s.offset});
    }
    void operator()(const RotatedSolid& s) const {
        pack_solid(out, s.of);
        points({s.center, s.axis});
        out.number(s.angle_rad);
    }
    void operator()(const RepeatedSolid& s) const {
        pack_solid(out, s.of);
        out.number(s.count);
        points({s.step});
    }
    void operator()(const EnclosedSolid& s) const {
        points({s.point});
        pack_solids(out, s.walls);
    }
    void operator()(const NotchesSolid& s) const {
        pack_solids(out, s.hulls);
        out.list(s.points);
        pack_solids(out, s.walls);
    }
    void operator()(const PolyhedronSolid& s) const {
        pack_faces(out, *s.faces);
        pack_surface(out, s.surface);
    }
    void operator()(const StepSolid& s) const {
        out.text(s.file);
        out.list(s.numbers);
        out.number(s.scale);
        pack_surface(out, s.surface);
    }

private:
    void points(std::initializer_list<Vec3> all) const {
        for (const Vec3& p : all) pack(out, p);
    }
};

/// Reads what a ShapePacker wrote into a shape of the same type.
struct ShapeUnpacker {
    Unpacker& in;
    int depth;

    void operator()(BoxSolid& s) const { points({&s.low, &s.high}); }
    void operator()(SphereSolid& s) const {
        points({&s.center});
        s.radius = in.number<double>();
    }
    void operator()(CylinderSolid& s) const {
        points({&s.from, &s.to});
        s.radius = in.number<double>();
    }
    void operator()(PrismSolid& s) const {
        s.polygon = in.list<std::array<double, 2>>();
        for (int& axis : s.axes) {
            axis = in.number<int>();
            if (axis < 0 || axis > 2) in.fail();
        }
        s.from = in.number<double>();
        s.to = in.number<double>();
    }
    void operator()(CombinedSolid& s) const {
        const int operation = in.number<int>();
        if (operation < 0 || operation > static_cast<int>(CombinedSolid::Operation::subtract)) in.fail();
        s.operation = static_cast<CombinedSolid::Operation>(operation);
        s.parts = unpack_solids(in, depth);
        if (s.parts.empty()) in.fail();
    }
    void operator()(TranslatedSolid& s) const {
        s.of = unpack_solid(in, depth + 1);
        points({&s.offset});
    }
    void operator()(RotatedSolid& s) const {
        s.of = unpack_solid(in, depth + 1);
        points({&s.center, &s.axis});
        s.angle_rad = in.number<double>();
    }
    void operator()(RepeatedSolid& s) const {
        s.of = unpack_solid(in, depth + 1);
        s.count = in.number<int>();
        if (s.count < 1) in.fail();
        points({&s.step});
    }
    void operator()(EnclosedSolid& s) const {
        points({&s.point});
        s.walls = unpack_solids(in, depth);
    }
    void operator()(NotchesSolid& s) const {
        s.hulls = unpack_solids(in, depth);
        s.points = in.list<Vec3>();
        s.walls = unpack_solids(in, depth);
    }
    void operator()(PolyhedronSolid& s) const {
        s.faces = unpack_faces(in);
        s.surface = unpack_surface(in);
        if (!s.surface) in.fail();
    }
    void operator()(StepSolid& s) const {
        s.file = in.text();
        s.numbers = in.list<int>();
        s.scale = in.number<double>();
        s.surface = unpack_surface(in);
        if (!s.surface) in.fail();
    }

private:
    void points(std::initializer_list<Vec3*> all) const {
        for (Vec3* p : all) unpack(in, *p);
    }
};

void pack_solid(Packer& out, const Solid& solid) {
    out.number<std::uint8_t>(static_cast<std::uint8_t>(solid->shape.index()));
    std::visit(ShapePacker{out}, solid->shape);
}

using Shape = decltype(SolidNode::shape);

/// Reads the shape with index `index` of the variant.
template <std::size_t Index = 0>
Shape unpack_shape(std::size_t index, const ShapeUnpacker& reader) {
    if constexpr (Index < std::variant_size_v<Shape>) {
        if (index != Index) return unpack_shape<Index + 1>(index, reader);
        std::variant_alternative_t<Index, Shape> shape{};
        reader(shape);
        return shape;
    } else {
        reader.in.fail();
        return BoxSolid{};
    }
}

Solid unpack_solid(Unpacker& in, int depth) {
    if (depth > deepest) in.fail();
    const auto index = in.number<std::uint8_t>();
    if (!in.good()) return std::make_shared<const SolidNode>(SolidNode{BoxSolid{}});
    return std::make_shared<const SolidNode>(SolidNode{unpack_shape(index, {in, depth})});
}

}  // namespace

std::size_t Unpacker::count(std::size_t least_bytes) {
    const auto claimed = number<std::uint64_t>();
    if (claimed <= rest_.size() / least_bytes) return static_cast<std::size_t>(claimed);
    fail();
    return 0;
}

void pack(Packer& out, double value) {
    out.number(value);
}

void unpack(Unpacker& in, double& value) {
    value = in.number<double>();
}

void pack(Packer& out, const Vec3& value) {
    for (const double v : {value.x, value.y, value.z}) out.number(v);
}

void unpack(Unpacker& in, Vec3& value) {
    for (double* v : {&value.x, &value.y, &value.z}) *v = in.number<double>();
}

void pack(Packer& out, const std::string& value) {
    out.text(value);
}

void unpack(Unpacker& in, std::string& value) {
    value = in.text();
}

void pack(Packer& out, const TriMesh& value) {
    out.list(value.points);
    out.list(value.triangles);
}

void unpack(Unpacker& in, TriMesh& value) {
    value.points = in.list<Vec3>();
    value.triangles = in.list<std::array<int, 3>>();
    for (const auto& triangle : value.triangles) {
        for (const int point : triangle) {
            if (point < 0 || static_cast<std::size_t>(point) >= value.points.size()) return in.fail();
        }
    }
}

void pack(Packer& out, const TetMesh& value) {
    out.number(value.order);
    out.list(value.points);
    out.list(value.nodes);
    out.list(value.region);
    pack(out, value.region_names);
    pack(out, value.notes);
}

void unpack(Unpacker& in, TetMesh& value) {
    value.order = in.number<int>();
    value.points = in.list<Vec3>();
    value.nodes = in.list<int>();
    value.region = in.list<int>();
    unpack(in, value.region_names);
    unpack(in, value.notes);
    if (value.order != 1 && value.order != 2) return in.fail();
    if (value.nodes.size() != value.region.size() * static_cast<std::size_t>(value.nodes_per_tet())) return in.fail();
    for (const int node : value.nodes) {
        if (node < 0 || static_cast<std::size_t>(node) >= value.points.size()) return in.fail();
    }
}

void pack(Packer& out, const Solid& value) {
    pack_solid(out, value);
}

void unpack(Unpacker& in, Solid& value) {
    value = unpack_solid(in, 0);
}

void pack(Packer& out, const BodyGeometry& value) {
    out.text(value.name);
    const auto* solid = std::get_if<Solid>(&value.shape);
    out.flag(solid != nullptr);
    if (solid != nullptr) {
        pack(out, *solid);
    } else {
        pack(out, std::get<TriMesh>(value.shape));
    }
    out.flag(value.air);
    out.number(value.size);
}

void unpack(Unpacker& in, BodyGeometry& value) {
    value.name = in.text();
    if (in.flag()) {
        unpack(in, value.shape.emplace<Solid>());
    } else {
        unpack(in, value.shape.emplace<TriMesh>());
    }
    value.air = in.flag();
    value.size = in.number<double>();
}

void pack(Packer& out, const MeshSettings& value) {
    out.number(value.size);
    out.number(value.order);
    out.number(value.angle_deg);
    out.number(value.through_wall);
    out.flag(value.judge_walls);
    out.number(value.close_gaps);
    out.number(value.size_near_cables);
    out.number<std::uint64_t>(value.cables.size());
    for (const std::vector<Vec3>& cable : value.cables) out.list(cable);
}

void unpack(Unpacker& in, MeshSettings& value) {
    value.size = in.number<double>();
    value.order = in.number<int>();
    value.angle_deg = in.number<double>();
    value.through_wall = in.number<int>();
    value.judge_walls = in.flag();
    value.close_gaps = in.number<double>();
    value.size_near_cables = in.number<double>();
    value.cables = unpack_items<std::vector<Vec3>>(in, [&] { return in.list<Vec3>(); });
}

void pack(Packer& out, const StepContent& value) {
    pack(out, value.names);
    pack(out, value.surfaces);
}

void unpack(Unpacker& in, StepContent& value) {
    unpack(in, value.names);
    unpack(in, value.surfaces);
    if (value.names.size() != value.surfaces.size()) in.fail();
}

void pack(Packer& out, const Notch& value) {
    pack(out, value.hull);
    for (const Vec3& p : {value.point, value.from, value.to}) pack(out, p);
}

void unpack(Unpacker& in, Notch& value) {
    unpack(in, value.hull);
    for (Vec3* p : {&value.point, &value.from, &value.to}) unpack(in, *p);
}

void pack(Packer& out, const Diagnostic& value) {
    out.text(value.file);
    out.number(value.line);
    out.text(value.key);
    out.text(value.text);
}

void unpack(Unpacker& in, Diagnostic& value) {
    value.file = in.text();
    value.line = in.number<int>();
    value.key = in.text();
    value.text = in.text();
}

void pack(Packer& out, const Error& value) {
    out.number(static_cast<std::uint8_t>(value.cause));
    out.text(value.message);
    pack(out, value.problems);
}

void unpack(Unpacker& in, Error& value) {
    const auto cause = in.number<std::uint8_t>();
    if (cause > static_cast<std::uint8_t>(Cause::cancelled)) in.fail();
    value.cause = static_cast<Cause>(cause);
    value.message = in.text();
    unpack(in, value.problems);
}

}  // namespace pliant::mesh
