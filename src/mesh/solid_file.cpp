// Reads solid expressions from a robot file.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/text.hpp"
#include "mesh/solid.hpp"

namespace pliant::mesh {
namespace {

using config::Problems;
using config::Reader;
using config::Value;

constexpr int max_depth = 32;
constexpr int max_copies = 1000;
constexpr int most_shapes = 20000;

Solid make(decltype(SolidNode::shape) shape) {
    return std::make_shared<const SolidNode>(SolidNode{std::move(shape)});
}

/// What an expression with a problem stands for: something valid.
Solid placeholder() {
    return make(BoxSolid{{0, 0, 0}, {1, 1, 1}});
}

bool segments_cross(const std::array<double, 2>& a, const std::array<double, 2>& b, const std::array<double, 2>& c,
                    const std::array<double, 2>& d) {
    const auto side = [](const auto& p, const auto& q, const auto& r) {
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    };
    return side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;
}

double signed_area(const std::vector<std::array<double, 2>>& polygon) {
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
                                   ? "is no shape" + (near.empty() ? "; a shape is one of " + join_names(kinds)
                                                                   : "; did you mean \"" + near + "\"?")
                                   : "is two shapes at once: " + join_names(given));
            return placeholder();
        }
        if (depth > max_depth) {
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
        const std::size_t n = prism.polygon.size();
        if (n > 2000) {
            reader.problem("prism", "has more than 2000 corners; draw such a part as STL or STEP");
            return placeholder();
        }
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = i + 2; j < n; ++j) {
                if (!segments_cross(prism.polygon[i], prism.polygon[(i + 1) % n], prism.polygon[j],
                                    prism.polygon[(j + 1) % n]))
                    continue;
                reader.problem("prism", fmt::format("the polygon crosses itself: edge {} and edge {}", i + 1, j + 1));
                return placeholder();
            }
        }
        if (!(prism.to > prism.from)) {
            if (reader.has("from") && reader.has("to")) reader.problem("to", "must be above \"from\"");
            return placeholder();
        }
        const double area = signed_area(prism.polygon);
        if (area == 0) {
            reader.problem("prism", "the polygon has no area");
            return placeholder();
        }
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
            // A list in a list doubles with each level: the budget stops what nesting alone would not.
            if (++read_shapes_ > most_shapes) {
                if (read_shapes_ == most_shapes + 1)
                    reader.problem(kind, fmt::format("too many shapes: more than {}", most_shapes));
                break;
            }
            solid.parts.push_back(read((*parts)[i], fmt::format("{}.{}[{}]", reader.path(), kind, i), depth + 1));
        }
        if (solid.parts.empty()) return placeholder();
        return make(std::move(solid));
    }

    const NamedShapes& shapes_;
    Problems& problems_;
    int read_shapes_ = 0;
};

}  // namespace

Solid read_solid(const config::Value& value, const std::string& path, const NamedShapes& shapes,
                 config::Problems& problems) {
    return SolidReader(shapes, problems).read(value, path, 0);
}

}  // namespace pliant::mesh
