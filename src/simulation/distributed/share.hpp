// The share of each rank in a robot: its tets, their nodes, and what acts on them.
#pragma once

#include <vector>

#include "simulation/model/held_nodes.hpp"
#include "simulation/parts/description.hpp"

namespace pliant::sim::distributed {

/// Properties of the whole robot, on all ranks.
struct Whole {
    int nodes = 0, tets = 0;
    double volume_m3 = 0;
    double farthest_m = 0;             ///< largest coordinate at rest
    double stiffest_Pa = 0;            ///< largest stiffness bound of all laws
    std::vector<char> pressure_skews;  ///< (pressure loads) true if the patch has a free rim
};

/// A part of a robot, itself a robot. Every tet, every face of a chamber's wall and every load on a node belongs to one
/// rank, so that forces, energies, lengths and volumes are sums over the ranks; a cable belongs to one rank as a whole.
/// Every node is owned by one rank. The local nodes of a rank are those that it owns and those that its tets and
/// actuators use, which are ghosts.
struct Share {
    Whole whole;
    /// Nodes: first the owned ones, then the ghosts. It has all supports, loads, cables, chambers, pressure loads and
    /// markers of the robot, in its order: without nodes, points or faces if none are here.
    Description part;
    int owned = 0;                   ///< nodes
    std::vector<int> number;         ///< (nodes) index over all ranks: first the owned ones of rank 0, in its order
    std::vector<int> node_in_file;   ///< (nodes) index in the whole mesh
    std::vector<int> tet_in_file;    ///< (tets) index in the whole mesh
    std::vector<char> fixed;         ///< (nodes) held in all directions, or used by no tet
    std::vector<int> contact_nodes;  ///< owned nodes of the surface that is checked for self-contact
};

/// Divides a robot into shares.
class ShareBuilder {
public:
    /// `owner` (nodes) in [0, ranks); `held`: from check(). All must outlive it.
    ShareBuilder(const Description& description, const HeldNodes& held, const std::vector<int>& owner, int ranks);

    /// For one rank at a time, so that only one share is in memory besides the whole.
    [[nodiscard]] Share share_of(int rank);
    /// Number of ranks without tets.
    [[nodiscard]] int idle_ranks() const;

private:
    void give_tets();
    void number_nodes();
    void find_fixed(const HeldNodes& held);
    void find_contact_nodes();
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
    std::vector<char> fixed_, contact_nodes_;     ///< (nodes)
    std::vector<int> local_;                      ///< (nodes) index in the current share, or -1
};

}  // namespace pliant::sim::distributed
