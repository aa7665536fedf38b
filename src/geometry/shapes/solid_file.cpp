// Reads solid expressions from a robot file.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/core/text.hpp"
#include "geometry/shapes/solid.hpp"

namespace pliant::mesh {
namespace {

using config::Problems;
using config::Reader;
using config::Value;

constexpr int max_depth = 32;
constexpr int max_copies = 1000;
constexpr int most_shapes = 20000;
constexpr double most_primitives = 2000;  // this many on one face take Open CASCADE minutes
constexpr double farthest = 1e9;          // beyond, lengths lose precision

Solid make(decltype(SolidNode::shape) shape) {
    return std::make_shared<const SolidNode>(SolidNode{std::move(shape)});
}

/// A valid stand-in for an expression with a problem.
Solid placeholder() {
    return make(BoxSolid{{0, 0, 0}, {1, 1, 1}});
}

using Corner = std::array<double, 2>;

/// Twice the signed area of the triangle p, q, r; positive if r is to the left of p -> q.
double side(const Corner& p, const Corner& q, const Corner& r) {
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
}

bool on_segment(const Corner& p, const Corner& q, const Corner& r) {
    return side(p, q, r) == 0 && std::min(p[0], q[0]) <= r[0] && r[0] <= std::max(p[0], q[0]) &&
           std::min(p[1], q[1]) <= r[1] && r[1] <= std::max(p[1], q[1]);
}

/// True if the segments a-b and c-d cross or touch.
bool segments_meet(const Corner& a, const Corner& b, const Corner& c, const Corner& d) {
    if (on_segment(a, b, c) || on_segment(a, b, d) || on_segment(c, d, a) || on_segment(c, d, b)) return true;
    const auto apart = [](double x, double y) { return (x > 0 && y > 0) || (x < 0 && y < 0); };
    return !apart(side(a, b, c), side(a, b, d)) && !apart(side(c, d, a), side(c, d, b));
}

/// Why the polygon is not a simple outline, or "".
std::string polygon_fault(const std::vector<Corner>& polygon) {
    const std::size_t n = polygon.size();
    for (std::size_t i = 0; i < n; ++i) {
        if (polygon[i] == polygon[(i + 1) % n]) return fmt::format("corner {} is repeated", i + 1);
    }
    for (std::size_t i = 0; i < n; ++i) {
        const Corner& a = polygon[i];
        const Corner& b = polygon[(i + 1) % n];
        const Corner& c = polygon[(i + 2) % n];
        const double ahead = (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]);
        if (side(a, b, c) == 0 && ahead < 0)
            return fmt::format("the polygon turns back on itself at corner {}", (i + 1) % n + 1);
    }
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = i + 2; j < n; ++j) {
            if ((j + 1) % n == i) continue;
            if (segments_meet(polygon[i], polygon[(i + 1) % n], polygon[j], polygon[(j + 1) % n]))
                return fmt::format("the polygon crosses or touches itself: edge {} and edge {}", i + 1, j + 1);
        }
    }
    return "";
}

double signed_area(const std::vector<Corner>& polygon) {
    double sum = 0;
    for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
        sum += polygon[j][0] * polygon[i][1] - polygon[i][0] * polygon[j][1];
    }
    return sum / 2;
}

class SolidReader {
public:
    SolidReader(const NamedShapes& shapes, Problems& problems) : shapes_(shapes), problems_(problems) {}

    Solid read(const Value& value, const std::string& path, int depth) {
        if (given_up_) return placeholder();
        if (!std::holds_alternative<config::Table>(value.data)) {
            problems_.add(value.line, path, "a shape is a table such as { box = [[0,0,0],[1,1,1]] }");
            return placeholder();
        }
        Reader reader(value, problems_, path);
        static const std::vector<std::string> kinds = {"box",    "sphere",       "cylinder",   "prism",
                                                       "union",  "intersection", "difference", "translate",
                                                       "rotate", "repeat",       "use"};
        std::vector<std::string> given;
        for (const std::string& kind : kinds) {
            if (reader.has(kind)) given.push_back(kind);
        }
        if (given.size() != 1) {
            const auto keys = reader.keys();
            const std::string near = keys.empty() ? "" : nearest_name(keys.front(), kinds);
            reader.problem("", given.empty()
                                   ? "is not a shape; " + (near.empty() ? "" : "did you mean \"" + near + "\"? ") +
                                         "a shape is one of " + join_names(kinds)
                                   : "is two shapes at once: " + join_names(given));
            return placeholder();
        }
        if (depth > max_depth) {
            given_up_ = true;  // one message is enough; a doubling shape would give thousands
            reader.problem("", "shapes nested too deep, or a shape that uses itself");
            return placeholder();
        }
        Solid solid = read_kind(reader, given.front(), depth);
        reader.finish();
        return solid;
    }

private:
    Solid read_kind(Reader& reader, const std::string& kind, int depth) {
        if (kind == "box") return read_box(reader);
        if (kind == "sphere") return read_sphere(reader);
        if (kind == "cylinder") return read_cylinder(reader);
        if (kind == "prism") return read_prism(reader);
        if (kind == "translate") return make(TranslatedSolid{read_of(reader, depth), reader.vector("translate")});
        if (kind == "rotate") return read_rotation(reader, depth);
        if (kind == "repeat") return read_repetition(reader, depth);
        if (kind == "use") return read_use(reader, depth);
        using Operation = CombinedSolid::Operation;
        return read_combination(reader, kind,
                                kind == "union"          ? Operation::unite
                                : kind == "intersection" ? Operation::intersect
                                                         : Operation::subtract,
                                depth);
    }

    static Solid read_box(Reader& reader) {
        const auto corners = reader.vectors("box");
        if (corners.size() != 2) {
            reader.problem("box", "needs two corners [[x, y, z], [x, y, z]]");
            return placeholder();
        }
        const Vec3 size = corners[1] - corners[0];
        if (!(size.x > 0 && size.y > 0 && size.z > 0)) {
            reader.problem("box", "the second corner must be above the first on every axis");
            return placeholder();
        }
        return make(BoxSolid{corners[0], corners[1]});
    }

    static bool positive(Reader& reader, double radius) {
        if (radius > 0) return true;
        if (reader.has("radius")) reader.problem("radius", "must be above zero");
        return false;
    }

    static Solid read_sphere(Reader& reader) {
        Reader sphere = reader.table("sphere");
        const SphereSolid solid{sphere.vector("center"), sphere.number("radius")};
        sphere.finish();
        return positive(sphere, solid.radius) ? make(solid) : placeholder();
    }

    static Solid read_cylinder(Reader& reader) {
        Reader cylinder = reader.table("cylinder");
        const CylinderSolid solid{cylinder.vector("from"), cylinder.vector("to"), cylinder.number("radius")};
        cylinder.finish();
        if (!positive(cylinder, solid.radius)) return placeholder();
        if (solid.from == solid.to) {
            cylinder.problem("to", "is the same point as \"from\"");
            return placeholder();
        }
        return make(solid);
    }

    static Solid read_prism(Reader& reader) {
        PrismSolid prism{};
        const std::string plane = reader.choice("plane", {"xy", "xz", "yz"}, "xy");
        prism.axes = plane == "xy" ? std::array{0, 1, 2} : (plane == "xz" ? std::array{0, 2, 1} : std::array{1, 2, 0});
        prism.from = reader.number("from");
        prism.to = reader.number("to");
        const Value* list = reader.raw("prism");
        const auto* corners = list != nullptr ? std::get_if<config::Array>(&list->data) : nullptr;
        bool good = corners != nullptr;
        for (std::size_t i = 0; good && i < corners->size(); ++i) {
            const config::Value wrapped{config::Table{{"corner", (*corners)[i]}}, list->line};
            Problems scratch("");
            Reader corner(wrapped, scratch);
            const auto uv = corner.numbers("corner", 2);
            good = scratch.empty();
            prism.polygon.push_back({uv[0], uv[1]});
        }
        if (!good || prism.polygon.size() < 3) {
            reader.problem("prism", "needs a list of at least three corners [u, v]");
            return placeholder();
        }
        return checked_prism(reader, std::move(prism));
    }

    static Solid checked_prism(Reader& reader, PrismSolid prism) {
        if (prism.polygon.size() > 2000) {
            reader.problem("prism", "has more than 2000 corners; draw such a part as STL or STEP");
            return placeholder();
        }
        if (const std::string fault = polygon_fault(prism.polygon); !fault.empty()) {
            reader.problem("prism", fault);
            return placeholder();
        }
        if (!(prism.to > prism.from)) {
            if (reader.has("from") && reader.has("to")) reader.problem("to", "must be above \"from\"");
            return placeholder();
        }
        const double area = signed_area(prism.polygon);
        if (area < 0) std::reverse(prism.polygon.begin(), prism.polygon.end());
        return make(std::move(prism));
    }

    Solid read_of(Reader& reader, int depth) {
        const Value* of = reader.raw("of");
        if (of == nullptr) {
            reader.problem("", "\"of\" is missing; it is the shape that is moved");
            return placeholder();
        }
        return read(*of, reader.path() + ".of", depth + 1);
    }

    Solid read_rotation(Reader& reader, int depth) {
        RotatedSolid solid{read_of(reader, depth), reader.vector("center", Vec3{}), reader.vector("axis"),
                           reader.number("rotate") * std::numbers::pi / 180};
        if (norm(solid.axis) == 0) {
            if (reader.has("axis")) reader.problem("axis", "must not be zero");
            return placeholder();
        }
        return make(std::move(solid));
    }

    Solid read_repetition(Reader& reader, int depth) {
        const auto count = reader.integer("repeat");
        RepeatedSolid solid{read_of(reader, depth), static_cast<int>(std::clamp<std::int64_t>(count, 1, max_copies)),
                            reader.vector("step")};
        if (count < 1 || count > max_copies)
            reader.problem("repeat", fmt::format("{} copies; 1 to {} are possible", count, max_copies));
        return make(std::move(solid));
    }

    Solid read_use(Reader& reader, int depth) {
        const std::string wanted = reader.text("use");
        std::vector<std::string> names;
        for (const auto& [name, value] : shapes_) {
            if (name == wanted) return read(*value, "shape." + name, depth + 1);
            names.push_back(name);
        }
        const std::string near = nearest_name(wanted, names);
        reader.problem("use", near.empty() ? fmt::format("there is no [shape.{}]", wanted)
                                           : fmt::format("there is no [shape.{}]; did you mean \"{}\"?", wanted, near));
        return placeholder();
    }

    Solid read_combination(Reader& reader, const std::string& kind, CombinedSolid::Operation operation, int depth) {
        const Value* list = reader.raw(kind);
        const auto* parts = std::get_if<config::Array>(&list->data);
        if (parts == nullptr || parts->empty()) {
            reader.problem(kind, "needs a list of shapes");
            return placeholder();
        }
        CombinedSolid solid{operation, {}};
        for (std::size_t i = 0; i < parts->size(); ++i) {
            // A list in a list doubles with each level: a limit on the nesting alone would not be enough.
            if (++read_shapes_ > most_shapes && !given_up_) {
                given_up_ = true;
                reader.problem(kind, fmt::format("too many shapes: more than {}", most_shapes));
            }
            if (given_up_) break;
            solid.parts.push_back(read((*parts)[i], fmt::format("{}.{}[{}]", reader.path(), kind, i), depth + 1));
        }
        if (solid.parts.empty()) return placeholder();
        return make(std::move(solid));
    }

    const NamedShapes& shapes_;
    Problems& problems_;
    int read_shapes_ = 0;
    bool given_up_ = false;
};

/// Number of primitive shapes after all copies are made; stops counting soon after `most`.
double primitive_count(const Solid& solid, double most);

struct PrimitiveCount {
    double most;
    double operator()(const CombinedSolid& s) const {
        double sum = 0;
        for (const Solid& part : s.parts) {
            if (sum <= most) sum += primitive_count(part, most);
        }
        return sum;
    }
    double operator()(const TranslatedSolid& s) const { return primitive_count(s.of, most); }
    double operator()(const RotatedSolid& s) const { return primitive_count(s.of, most); }
    double operator()(const RepeatedSolid& s) const { return s.count * primitive_count(s.of, most); }
    template <class Primitive>
    double operator()(const Primitive&) const {
        return 1;
    }
};

double primitive_count(const Solid& solid, double most) {
    return std::visit(PrimitiveCount{most}, solid->shape);
}

}  // namespace

Solid read_solid(const config::Value& value, const std::string& path, const NamedShapes& shapes,
                 config::Problems& problems) {
    Solid solid = SolidReader(shapes, problems).read(value, path, 0);
    if (const double count = primitive_count(solid, most_primitives); count > most_primitives) {
        problems.add(value.line, path,
                     fmt::format("repeats come to {} shapes in all; {} are possible", count, most_primitives));
        return placeholder();
    }
    const Box3 box = bounds(solid);
    for (const Vec3& corner : {box.low, box.high}) {
        if (is_finite(corner) && norm(corner) <= farthest) continue;
        problems.add(value.line, path, fmt::format("reaches beyond {:.0e} length units", farthest));
        return placeholder();
    }
    return solid;
}

}  // namespace pliant::mesh
