// A tet mesh for local editing: tets can be replaced and nodes moved, step by step with undo.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/mesh/tet_mesh.hpp"

namespace pliant::mesh {

using Tet = std::array<int, 4>;
using Triangle = std::array<int, 3>;

/// The smallest sine of a dihedral angle; zero or negative for a flat or inverted tet.
[[nodiscard]] double smallest_sine(const std::array<Vec3, 4>& p);

/// A face between a region and another one or the outside.
struct Border {
    Triangle nodes;
    Vec3 normal;  ///< of length 1
};

/// Tets that replace others.
struct Exchange {
    std::vector<int> removed;
    std::vector<Tet> added;
};

/// A linear mesh being edited: the region of each tet, and the tets around each node.
class EditableTets {
public:
    explicit EditableTets(const TetMesh& mesh);

    [[nodiscard]] int tet_count() const { return static_cast<int>(tets_.size()); }  ///< including removed ones
    [[nodiscard]] std::size_t node_count() const { return points_.size(); }
    [[nodiscard]] const Tet& tet(int t) const { return tets_[index(t)]; }
    [[nodiscard]] bool alive(int t) const { return region_[index(t)] >= 0; }
    [[nodiscard]] int region(int t) const { return region_[index(t)]; }
    [[nodiscard]] const Vec3& at(int v) const { return points_[index(v)]; }
    [[nodiscard]] const std::vector<int>& star(int v) const { return star_[index(v)]; }  ///< the tets around a node
    [[nodiscard]] bool holds(int t, int v) const { return std::find(tet(t).begin(), tet(t).end(), v) != tet(t).end(); }
    [[nodiscard]] double quality(const Tet& n) const { return smallest_sine({at(n[0]), at(n[1]), at(n[2]), at(n[3])}); }
    [[nodiscard]] double quality(int t) const { return quality(tet(t)); }
    template <class Tets>
    [[nodiscard]] double worst(const Tets& tets) const {
        double least = 1;
        for (const auto& t : tets) least = std::min(least, quality(t));
        return least;
    }
    [[nodiscard]] double tet_volume(const Tet& n) const {
        return signed_tet_volume(at(n[0]), at(n[1]), at(n[2]), at(n[3]));
    }
    /// The corners of face f of t.
    [[nodiscard]] Triangle face(int t, std::size_t f) const;
    [[nodiscard]] Vec3 normal(const Triangle& n) const;

    /// The tets that contain both nodes.
    [[nodiscard]] std::vector<int> around(int a, int b) const;
    /// The tet on the other side of face f of t; -1: none.
    [[nodiscard]] int behind(int t, std::size_t f) const;
    /// Face f of t if it lies between regions or on the outside. A face between regions is reported on one side only,
    /// that of the lower region number.
    [[nodiscard]] std::optional<Border> border(int t, std::size_t f) const;
    [[nodiscard]] std::vector<Border> borders(int v) const;

    /// Tries a position for a node; keep_move() records it as a step for undo().
    void place(int v, const Vec3& p) { points_[index(v)] = p; }
    void keep_move(int v, const Vec3& from) { log_.push_back({{}, 0, v, from}); }
    /// Replaces tets. False, and no change, if the volume would change by more than the tolerance times an edge cubed.
    /// `regions`: of the added tets; empty: that of the first removed one.
    bool apply(const Exchange& change, double tolerance, const std::vector<int>& regions = {});
    [[nodiscard]] int add_node(const Vec3& p);
    /// Removes the last nodes, after undo() has freed them.
    void drop_nodes(std::size_t count) { points_.resize(count), star_.resize(count); }

    [[nodiscard]] std::size_t steps() const { return log_.size(); }
    /// The tets from `first_new` on, and those around nodes moved after step `mark`.
    [[nodiscard]] std::vector<int> touched_since(std::size_t mark, int first_new) const;
    void undo(std::size_t mark);

    /// Writes the result to the mesh, without removed tets.
    void store(TetMesh& mesh) const;

private:
    static std::size_t index(int i) { return static_cast<std::size_t>(i); }

    /// One change that can be undone: tets replaced, or a node moved.
    struct Step {
        std::vector<std::pair<int, int>> removed;  ///< tets and their regions
        std::size_t added = 0;                     ///< number of tets added at the end
        int moved = -1;
        Vec3 from{};
    };

    std::vector<Vec3> points_;
    std::vector<Tet> tets_;
    std::vector<int> region_;             ///< per tet; -1: removed
    std::vector<std::vector<int>> star_;  ///< per node, its tets
    std::vector<Step> log_;
};

}  // namespace pliant::mesh
