// A robot as the solver sees it: mesh, laws, supports, loads, cables, markers. Built once, validated, never changed.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "core/vec3.hpp"
#include "material/law.hpp"
#include "mesh/tet_mesh.hpp"

namespace pliant::sim {

class Elements;

/// A point that rides on the mesh: sum of weights[i] * x[nodes[i]]. Without nodes it is fixed in space at `fixed`.
struct Attachment {
    std::vector<int> nodes;
    std::vector<double> weights;  ///< sum 1
    Vec3 fixed;                   ///< metres
};

struct Material {
    std::string name;
    material::Law law;
    double density_kg_m3 = 0;
};

/// Nodes whose motion is prescribed: from rest to rest + move, in proportion to time.
struct Support {
    std::string name;
    std::vector<int> nodes;
    Vec3 move_m;
};

/// A force that keeps its direction and grows in proportion to time.
struct Load {
    std::string name;
    std::vector<int> nodes;
    std::vector<double> shares;  ///< of the total force, sum 1
    Vec3 force_N;
};

/// What a cable is driven by, reached in proportion to time.
struct CableTarget {
    enum class Kind { length_ratio, shortening_m, tension_N };
    Kind kind = Kind::length_ratio;
    double value = 1;
};

/// A frictionless cable through guide points; its length is that of the polyline.
struct Cable {
    std::string name;
    std::vector<Attachment> points;  ///< at least two
    CableTarget target;
};

/// A point of the material whose position is reported.
struct Marker {
    std::string name;
    Attachment point;
};

struct Description {
    mesh::TetMesh mesh;                   ///< metres, positive volumes
    std::vector<Material> materials;      ///< at least one
    std::vector<int> material_of_region;  ///< (regions)
    std::vector<Support> supports;
    std::vector<Load> loads;
    std::vector<Cable> cables;
    std::vector<Marker> markers;
    Vec3 gravity_m_s2;
};

class Model {
public:
    /// Checks indices, weights, volumes, that something holds the robot, and that no node belongs to two supports.
    [[nodiscard]] static Result<Model> create(Description description);
    Model(Model&&) noexcept;
    Model& operator=(Model&&) noexcept;
    ~Model();

    [[nodiscard]] const Description& description() const { return description_; }
    [[nodiscard]] const mesh::TetMesh& mesh() const { return description_.mesh; }
    [[nodiscard]] const Elements& elements() const { return *elements_; }
    [[nodiscard]] int node_count() const { return static_cast<int>(description_.mesh.points.size()); }
    [[nodiscard]] int free_count() const { return free_count_; }
    /// (n), index among the free nodes, or -1 for nodes held by a support.
    [[nodiscard]] const std::vector<int>& free_index() const { return free_index_; }

private:
    Model();
    Description description_;
    std::unique_ptr<Elements> elements_;
    std::vector<int> free_index_;
    int free_count_ = 0;
};

/// Position of an attachment for node positions `x` (3n).
[[nodiscard]] Vec3 position(const Attachment& point, std::span<const double> x);

}  // namespace pliant::sim
