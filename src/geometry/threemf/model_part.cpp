#include "geometry/threemf/model_part.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "geometry/threemf/properties.hpp"
#include "geometry/threemf/remarks.hpp"

namespace pliant::threemf {
namespace {

constexpr std::string_view known_extensions[] = {"http://schemas.microsoft.com/3dmanufacturing/material/2015/02",
                                                 "http://schemas.microsoft.com/3dmanufacturing/production/2015/06",
                                                 "http://schemas.microsoft.com/3dmanufacturing/slice/2015/07",
                                                 "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"};

constexpr std::string_view object_types[] = {"model", "support", "solidsupport", "surface", "other"};

double unit_mm(std::string_view unit) {
    if (unit.empty() || unit == "millimeter") return 1;
    if (unit == "micron") return 1e-3;
    if (unit == "centimeter") return 10;
    if (unit == "inch") return 25.4;
    if (unit == "foot") return 304.8;
    return unit == "meter" ? 1000 : 0;
}

/// Reads one part; the first error goes to `problem_`.
class Reader {
public:
    explicit Reader(const XmlPart& part) : part_(part) {}

    Result<ModelPart> read() {
        const pugi::xml_node root = part_.root();
        model_.name = part_.name();
        model_.warnings = remarks_on(part_);
        if (!part_.is(root, Space::core, "model"))
            return input_error("{}", part_.at(root, "is no <model> of the 3MF core specification"));
        read_head(root);
        const auto resources = part_.child(root, Space::core, "resources");
        const auto build = part_.child(root, Space::core, "build");
        if (!resources) problem_.note(part_.at(root, "needs <resources>"));
        if (!build) problem_.note(part_.at(root, "needs <build>"));
        for (const pugi::xml_node& node : resources.children()) {
            if (problem_.found()) break;
            if (node.type() == pugi::node_element) read_resource(node);
        }
        for (const pugi::xml_node& node : part_.children(build, Space::core, "item"))
            model_.items.push_back(read_placed(node));
        if (problem_.found()) return input_error("{}", problem_.text());
        return std::move(model_);
    }

private:
    void read_head(const pugi::xml_node& root) {
        model_.mm_per_unit = unit_mm(root.attribute("unit").value());
        if (model_.mm_per_unit == 0)
            problem_.note(
                part_.at(root, fmt::format("unit=\"{}\" must be micron, millimeter, centimeter, inch, foot or meter",
                                           root.attribute("unit").value())));
        for (const std::string_view prefix : words(root.attribute("requiredextensions").value())) {
            const std::string_view address = part_.address_of_prefix(prefix);
            if (std::find(std::begin(known_extensions), std::end(known_extensions), address) ==
                std::end(known_extensions))
                problem_.note(part_.at(root, fmt::format("requires the extension {} ({}), which Pliant does not know",
                                                         prefix, address.empty() ? "no namespace" : address)));
        }
        for (const pugi::xml_node& node : part_.children(root, Space::core, "metadata"))
            (void)part_.needed(node, "name", problem_);
    }

    void read_resource(const pugi::xml_node& node) {
        const int id = part_.index(node, "id", problem_);
        if (problem_.found()) return;
        if (std::find(ids_.begin(), ids_.end(), id) != ids_.end())
            return problem_.note(part_.at(node, fmt::format("id {} is used twice", id)));
        ids_.push_back(id);
        if (part_.is(node, Space::core, "object")) {
            model_.objects[id] = read_object(node, id);
        } else if (part_.is(node, Space::slice, "slicestack")) {
            model_.stacks[id] = read_slice_stack(part_, node, problem_, model_.warnings);
        } else {
            (void)read_property_group(part_, node, id, properties_, textures_, problem_);
        }
    }

    Object read_object(const pugi::xml_node& node, int id) {
        Object object;
        object.name = node.attribute("name") ? node.attribute("name").value() : fmt::format("object {}", id);
        object.type = node.attribute("type") ? node.attribute("type").value() : "model";
        if (std::find(std::begin(object_types), std::end(object_types), object.type) == std::end(object_types))
            problem_.note(part_.at(
                node, fmt::format("type=\"{}\" must be model, support, solidsupport, surface or other", object.type)));
        const int group = part_.index_or(node, "pid", -1, problem_);
        const int property = part_.index_or(node, "pindex", group < 0 ? -1 : 0, problem_);
        if (group < 0 && property >= 0) problem_.note(part_.at(node, "a pindex needs a pid"));
        if (group >= 0) object.material = material(node, group, property);
        const std::string_view stack = part_.attribute(node, Space::slice, "slicestackid");
        if (!stack.empty()) {
            const auto [end, code] = std::from_chars(stack.data(), stack.data() + stack.size(), object.slice_stack);
            if (code != std::errc() || end != stack.data() + stack.size() ||
                !model_.stacks.contains(object.slice_stack))
                problem_.note(part_.at(node, fmt::format("slicestackid: there is no slice stack {} before it", stack)));
        }
        const auto mesh = part_.child(node, Space::core, "mesh");
        const auto components = part_.child(node, Space::core, "components");
        if (!mesh == !components) problem_.note(part_.at(node, "needs either <mesh> or <components>"));
        if (mesh) read_mesh(mesh, group, property, object);
        for (const pugi::xml_node& c : part_.children(components, Space::core, "component"))
            object.components.push_back(read_placed(c));
        return object;
    }

    std::string material(const pugi::xml_node& node, int group, int property) {
        const auto found = properties_.find(group);
        if (found == properties_.end()) {
            problem_.note(part_.at(node, fmt::format("pid: there is no property group {} before it", group)));
            return {};
        }
        const auto& names = found->second.materials;
        if (property < static_cast<int>(names.size())) return names[static_cast<std::size_t>(property)];
        problem_.note(
            part_.at(node, fmt::format("group {} has no property {}, only {}", group, property, names.size())));
        return {};
    }

    void read_mesh(const pugi::xml_node& mesh, int group, int property, Object& object) {
        for (const pugi::xml_node& v :
             part_.children(part_.child(mesh, Space::core, "vertices"), Space::core, "vertex")) {
            object.mesh.points.push_back(
                {part_.number(v, "x", problem_), part_.number(v, "y", problem_), part_.number(v, "z", problem_)});
            if (problem_.found()) return;
        }
        for (const pugi::xml_node& t :
             part_.children(part_.child(mesh, Space::core, "triangles"), Space::core, "triangle")) {
            const std::array<int, 3> corners{part_.index(t, "v1", problem_), part_.index(t, "v2", problem_),
                                             part_.index(t, "v3", problem_)};
            if (problem_.found()) return;
            const int count = static_cast<int>(object.mesh.points.size());
            if (const int most = *std::max_element(corners.begin(), corners.end()); most >= count)
                return problem_.note(part_.at(t, fmt::format("there is no vertex {}, only {}", most, count)));
            object.mesh.triangles.push_back(corners);
            object.material_of_triangle.push_back(material_of(t, group, property, object));
        }
    }

    int material_of(const pugi::xml_node& triangle, int group, int property, Object& object) {
        std::string name = object.material;
        if (triangle.attribute("pid") || triangle.attribute("p1")) {
            const int pid = part_.index_or(triangle, "pid", group, problem_);
            const int p1 = part_.index_or(triangle, "p1", property, problem_);
            if (pid < 0 || p1 < 0) problem_.note(part_.at(triangle, "a p1 needs a pid, and a pid a p1"));
            if (!problem_.found()) name = material(triangle, pid, p1);
        }
        if (name.empty()) name = "default";
        const auto known = std::find(object.materials.begin(), object.materials.end(), name);
        const auto index = static_cast<int>(known - object.materials.begin());
        if (known == object.materials.end()) object.materials.push_back(name);
        return index;
    }

    Placed read_placed(const pugi::xml_node& node) {
        Placed placed;
        placed.object = part_.index(node, "objectid", problem_);
        placed.path = part_.attribute(node, Space::production, "path");
        placed.where = part_.at(node, "");
        const std::string_view printable = node.attribute("printable").value();
        placed.printable = printable != "0" && printable != "false";
        if (problem_.found()) return placed;
        if (placed.path.empty() && !model_.objects.contains(placed.object))
            problem_.note(part_.at(node, fmt::format("objectid: there is no object {} before it", placed.object)));
        if (const pugi::xml_attribute t = node.attribute("transform"))
            read_transform(node, t.value(), placed.transform);
        return placed;
    }

    void read_transform(const pugi::xml_node& node, std::string_view text, Transform& transform) {
        const auto numbers = words(text);
        bool good = numbers.size() == transform.m.size();
        for (std::size_t i = 0; good && i < numbers.size(); ++i) {
            const std::string_view n = numbers[i];
            const auto [end, code] = std::from_chars(n.data(), n.data() + n.size(), transform.m[i]);
            good = code == std::errc() && end == n.data() + n.size() && std::isfinite(transform.m[i]);
        }
        if (!good) problem_.note(part_.at(node, fmt::format("transform=\"{}\" must be 12 finite numbers", text)));
        if (good && transform.determinant() == 0) problem_.note(part_.at(node, "transform flattens the object"));
    }

    const XmlPart& part_;
    ModelPart model_;
    Properties properties_;
    std::map<int, std::string> textures_;
    std::vector<int> ids_;
    Problem problem_;
};

}  // namespace

Vec3 Transform::operator()(const Vec3& p) const {
    return {p.x * m[0] + p.y * m[3] + p.z * m[6] + m[9], p.x * m[1] + p.y * m[4] + p.z * m[7] + m[10],
            p.x * m[2] + p.y * m[5] + p.z * m[8] + m[11]};
}

double Transform::determinant() const {
    return dot(Vec3{m[0], m[1], m[2]}, cross(Vec3{m[3], m[4], m[5]}, Vec3{m[6], m[7], m[8]}));
}

Transform Transform::then(const Transform& after) const {
    Transform both;
    for (std::size_t row = 0; row < 4; ++row) {
        for (std::size_t column = 0; column < 3; ++column) {
            double sum = row == 3 ? after.m[9 + column] : 0;
            for (std::size_t k = 0; k < 3; ++k) sum += m[3 * row + k] * after.m[3 * k + column];
            both.m[3 * row + column] = sum;
        }
    }
    return both;
}

Result<ModelPart> read_model_part(const XmlPart& part) {
    return Reader(part).read();
}

}  // namespace pliant::threemf
