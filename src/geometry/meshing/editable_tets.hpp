// Tets that can be exchanged for others, and nodes that can be moved, step by step and back again.
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

/// The smallest sine of a dihedral angle; not above zero for a flat or folded tet.
[[nodiscard]] double smallest_sine(const std::array<Vec3, 4>& p);

/// A face between a region and another, or the outside.
struct Border {
    Triangle nodes;
    Vec3 normal;  ///< of length 1
};

/// Tets that take the place of others.
struct Exchange {
    std::vector<int> removed;
    std::vector<Tet> added;
};

/// The tets of a linear mesh while they are worked on: each with its region, each node with the tets around it.
class EditableTets {
public:
    explicit EditableTets(const TetMesh& mesh);

    [[nodiscard]] int tet_count() const { return static_cast<int>(tets_.size()); }  ///< with those that are gone
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

    /// The tets that hold both nodes.
    [[nodiscard]] std::vector<int> around(int a, int b) const;
    /// The tet behind face f of t; -1: none.
    [[nodiscard]] int behind(int t, std::size_t f) const;
    /// Face f of t where it lies between regions or on the outside. Of the two sides of a face between regions, the one
    /// with the lower number tells.
    [[nodiscard]] std::optional<Border> border(int t, std::size_t f) const;
    [[nodiscard]] std::vector<Border> borders(int v) const;

    /// Tries a place for a node; keep_move() makes a step of it that undo() takes back.
    void place(int v, const Vec3& p) { points_[index(v)] = p; }
    void keep_move(int v, const Vec3& from) { log_.push_back({{}, 0, v, from}); }
    /// False, and nothing done, where the volume would change by more than the tolerance times an edge cubed.
    /// `regions`: of the added tets; empty: that of the first removed one.
    bool apply(const Exchange& change, double tolerance, const std::vector<int>& regions = {});
    [[nodiscard]] int add_node(const Vec3& p);
    /// Of the last nodes, after undo() has freed them.
    void drop_nodes(std::size_t count) { points_.resize(count), star_.resize(count); }

    [[nodiscard]] std::size_t steps() const { return log_.size(); }
    /// The tets of `first_new` on, and those around the nodes that were moved after step `mark`.
    [[nodiscard]] std::vector<int> touched_since(std::size_t mark, int first_new) const;
    void undo(std::size_t mark);

    /// Back into the mesh, without what is gone.
    void store(TetMesh& mesh) const;

private:
    static std::size_t index(int i) { return static_cast<std::size_t>(i); }

    /// One change, so that it can be undone: tets for others, or a node moved.
    struct Step {
        std::vector<std::pair<int, int>> removed;  ///< tets and their regions
        std::size_t added = 0;                     ///< the last tets
        int moved = -1;
        Vec3 from{};
    };

    std::vector<Vec3> points_;
    std::vector<Tet> tets_;
    std::vector<int> region_;             ///< per tet; -1: gone
    std::vector<std::vector<int>> star_;  ///< per node, its tets
    std::vector<Step> log_;
};

}  // namespace pliant::mesh
