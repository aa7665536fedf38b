// What each rank has of a robot: its tets, their nodes, and what acts on them.
#pragma once

#include <vector>

#include "simulation/model/held_nodes.hpp"
#include "simulation/parts/description.hpp"

namespace pliant::sim::distributed {

/// What all ranks know of the whole robot.
struct Whole {
    int nodes = 0, tets = 0;
    double volume_m3 = 0;
    double farthest_m = 0;             ///< largest coordinate at rest
    double stiffest_Pa = 0;            ///< of the bounds of all laws
    std::vector<char> pressure_skews;  ///< (pressure loads) true where the patch has a rim that is free to move
};

/// A part of a robot as a robot. Every tet, every face of a chamber's wall and every load on a node belongs to one
/// rank, so that forces, energies, lengths and volumes are sums over the ranks; a cable belongs to one rank whole,
/// which knows all its nodes. Every node belongs to one rank too, and is known to those whose tets or actuators use it.
struct Share {
    Whole whole;
    /// Nodes: first those that belong to this rank, then the others. Supports, loads, cables, chambers, pressure loads
    /// and markers are as many as the robot has, in its order: without nodes, points or faces where none are here.
    Description part;
    int owned = 0;                  ///< nodes that belong to this rank
    std::vector<int> number;        ///< (nodes) over all ranks: those of rank 0 first, each rank's in its own order
    std::vector<int> node_in_file;  ///< (nodes) in the whole mesh
    std::vector<int> tet_in_file;   ///< (tets) in the whole mesh
    std::vector<char> fixed;        ///< (nodes) held in all directions, or used by no tet
    std::vector<int> watched;       ///< owned nodes of the surface with which the robot may meet itself
};

/// Cuts a robot into shares.
class Cutter {
public:
    /// `owner` (nodes) in [0, ranks); `held` as check() gives it. All must outlive it.
    Cutter(const Description& description, const HeldNodes& held, const std::vector<int>& owner, int ranks);

    /// One rank after the other, so that no more than one share is in memory beside the whole.
    [[nodiscard]] Share share_of(int rank);
    /// Ranks that have no tet: there are more of them than the mesh has parts.
    [[nodiscard]] int idle_ranks() const;

private:
    void give_tets();
    void number_nodes();
    void find_fixed(const HeldNodes& held);
    void find_watched();
    void add_mesh(int rank, Share& share);
    int local(int node, Share& share);
    [[nodiscard]] int rank_of(const Attachment& point) const;
    [[nodiscard]] int rank_of(const std::vector<Attachment>& points) const;
    void localise(Attachment& point, Share& share);
    [[nodiscard]] Wall part_of(const Wall& wall, int rank, Share& share);
    void add_actuators(int rank, Share& share);
    void add_loads(int rank, Share& share);
    void add_supports(Share& share);

    const Description& d_;
    const std::vector<int>& owner_;
    int ranks_;
    Whole whole_;
    std::vector<std::vector<int>> tets_, nodes_;  ///< (ranks), nodes in the order of their numbers
    std::vector<int> number_;                     ///< (nodes)
    std::vector<char> fixed_, watched_;           ///< (nodes)
    std::vector<int> local_;                      ///< (nodes) in the share at hand, or -1
};

}  // namespace pliant::sim::distributed
