// One model part of a 3MF package: its objects, build items and slice stacks.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "geometry/threemf/read_3mf.hpp"
#include "geometry/threemf/slice_stack.hpp"
#include "geometry/threemf/xml_part.hpp"

namespace pliant::threemf {

/// [x y z 1] times a matrix of four rows of three, as 3MF writes it.
struct Transform {
    std::array<double, 12> m{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};

    [[nodiscard]] Vec3 operator()(const Vec3& p) const;
    [[nodiscard]] double determinant() const;
    /// First this, then `after`.
    [[nodiscard]] Transform then(const Transform& after) const;
};

/// A placed object, in another part if `path` is not empty.
struct Placed {
    int object = 0;
    std::string path;
    Transform transform;
    std::string where;      ///< for messages
    bool printable = true;  ///< an item that PrusaSlicer excludes from printing is not
};

struct Object {
    std::string name, type;
    mesh::TriMesh mesh;                     ///< in the part's unit
    std::vector<std::string> materials;     ///< referenced by its triangles
    std::vector<int> material_of_triangle;  ///< (m), into materials
    std::string material;                   ///< of the object; "" if it names none
    std::vector<Placed> components;
    int slice_stack = -1;
};

struct ModelPart {
    std::string name;
    double mm_per_unit = 1;
    std::map<int, Object> objects;
    std::map<int, SliceStack> stacks;
    std::vector<Placed> items;
    std::vector<std::string> warnings;
};

/// Errors: violations of the specification, with the line; a required extension that is not supported.
[[nodiscard]] Result<ModelPart> read_model_part(const XmlPart& part);

}  // namespace pliant::threemf
