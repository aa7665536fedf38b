#include "simulation/run/free_motion.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "base/core/disjoint_sets.hpp"
#include "base/linalg/dense.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/actuators/cable_path.hpp"

namespace pliant::sim {
namespace {

/// Nodes count as collinear if they deviate from a line by at most this share of their extent.
constexpr double straight = 1e-5;
/// With more parts than this, only those connected through faces are checked.
constexpr std::size_t most_parts = 100;

using Twists = Eigen::MatrixXd;  ///< (6, motions) each: velocity of the part's centre, then its angular velocity times
                                 ///< its size

/// A rigid part: tets connected through faces, a plate, or all supports (the ground, which is part 0).
struct Part {
    std::vector<int> nodes;
    Vec3 middle;
    double size = 0;
};

Vec3 vec3(const Eigen::Vector3d& v) {
    return {v[0], v[1], v[2]};
}

/// Sets of tets connected through faces.
DisjointSets sets_of_faces(const mesh::TetMesh& mesh) {
    struct Side {
        std::array<int, 3> corners;
        int tet;
    };
    std::vector<Side> sides;
    sides.reserve(4 * mesh.tet_count());
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        for (const auto& face : mesh::face_corners) {
            Side side{{mesh.tet(t)[face[0]], mesh.tet(t)[face[1]], mesh.tet(t)[face[2]]}, static_cast<int>(t)};
            std::sort(side.corners.begin(), side.corners.end());
            sides.push_back(side);
        }
    }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        return a.corners != b.corners ? a.corners < b.corners : a.tet < b.tet;
    });
    DisjointSets sets(mesh.tet_count());
    for (std::size_t k = 1; k < sides.size(); ++k) {
        if (sides[k].corners == sides[k - 1].corners) sets.join(sides[k].tet, sides[k - 1].tet);
    }
    return sets;
}

/// True if three of the nodes span a plane.
bool span_a_plane(const std::vector<int>& nodes, const std::vector<Vec3>& points) {
    if (nodes.size() < 3) return false;
    const Vec3& first = points[nodes[0]];
    Vec3 longest;
    for (const int node : nodes) {
        if (norm(points[node] - first) > norm(longest)) longest = points[node] - first;
    }
    double off = 0;
    for (const int node : nodes) off = std::max(off, norm(cross(longest, points[node] - first)));
    return off > straight * dot(longest, longest);
}

class Mechanism {
public:
    explicit Mechanism(const Description& d) : description_(d), mesh_(d.mesh) {
        add_ground(d);
        add_bodies();
        for (const RigidPlate& plate : d.plates) parts_.push_back({plate.nodes, {}, 0});
        for (Part& part : parts_) measure(part);
        join_rigidly();
    }

    /// The most mobile part, and its motion.
    [[nodiscard]] std::optional<std::string> describe() {
        if (free_.empty() || free_.size() > most_parts) return {};
        const Eigen::MatrixXd ways = kernel();
        if (ways.cols() == 0) return {};
        Eigen::Index most = 0;
        for (Eigen::Index k = 1; k < static_cast<Eigen::Index>(free_.size()); ++k) {
            if (ways.middleRows(6 * k, 6).norm() > ways.middleRows(6 * most, 6).norm()) most = k;
        }
        return say(static_cast<std::size_t>(free_[static_cast<std::size_t>(most)]), ways.middleRows(6 * most, 6));
    }

private:
    void add_ground(const Description& d) {
        Part ground;
        for (const Support& support : d.supports) {
            if (!support.directions.empty()) continue;  // a roller: add_rollers
            ground.nodes.insert(ground.nodes.end(), support.nodes.begin(), support.nodes.end());
        }
        parts_.push_back(std::move(ground));
    }

    void add_bodies() {
        DisjointSets sets = sets_of_faces(mesh_);
        std::map<int, std::size_t> part_of;
        for (std::size_t t = 0; t < mesh_.tet_count(); ++t) {
            const auto [entry, fresh] = part_of.try_emplace(sets.find(static_cast<int>(t)), parts_.size());
            if (fresh) parts_.emplace_back(), region_[entry->second] = mesh_.region[t];
            const auto nodes = mesh_.tet(t);
            parts_[entry->second].nodes.insert(parts_[entry->second].nodes.end(), nodes.begin(), nodes.end());
        }
    }

    void measure(Part& part) const {
        std::sort(part.nodes.begin(), part.nodes.end());
        part.nodes.erase(std::unique(part.nodes.begin(), part.nodes.end()), part.nodes.end());
        Box3 box;
        for (const int node : part.nodes) box.add(mesh_.points[node]);
        if (part.nodes.empty()) return;
        part.middle = 0.5 * (box.low + box.high);
        part.size = std::max(box.diagonal(), 1e-300);
    }

    /// For each pair of parts: the nodes that they share.
    [[nodiscard]] std::map<std::pair<int, int>, std::vector<int>> joints() const {
        std::map<int, std::vector<int>> users;
        for (std::size_t p = 0; p < parts_.size(); ++p) {
            for (const int node : parts_[p].nodes) users[node].push_back(static_cast<int>(p));
        }
        std::map<std::pair<int, int>, std::vector<int>> joints;
        for (const auto& [node, list] : users) {
            for (std::size_t i = 0; i < list.size(); ++i) {
                for (std::size_t j = i + 1; j < list.size(); ++j) joints[{list[i], list[j]}].push_back(node);
            }
        }
        return joints;
    }

    /// Merges parts that share three nodes which span a plane, until there are none.
    void join_rigidly() {
        for (bool again = true; again;) {
            again = false;
            DisjointSets sets(parts_.size());
            joints_ = joints();
            for (const auto& [pair, nodes] : joints_) {
                if (sets.find(pair.first) == sets.find(pair.second) || !span_a_plane(nodes, mesh_.points)) continue;
                sets.join(pair.first, pair.second);
                again = true;
            }
            if (again) unite(sets);
        }
        DisjointSets connected(parts_.size());
        for (const auto& [pair, nodes] : joints_) connected.join(pair.first, pair.second);
        part_of_node_.assign(mesh_.points.size(), 0);
        for (std::size_t p = parts_.size(); p-- > 0;) {
            for (const int node : parts_[p].nodes) part_of_node_[static_cast<std::size_t>(node)] = static_cast<int>(p);
        }
        for (const Support& support : description_.supports) {
            for (const int node : support.nodes) connected.join(0, part_at(node));
        }
        for (const Spring& spring : description_.springs) {
            for (const Attachment& point : spring.points) {
                const Attachment& first = spring.points.front();
                connected.join(point.nodes.empty() ? 0 : part_at(point.nodes.front()),
                               first.nodes.empty() ? 0 : part_at(first.nodes.front()));
            }
        }
        for (std::size_t p = 1; p < parts_.size(); ++p) {
            if (connected.find(static_cast<int>(p)) == connected.find(0)) free_.push_back(static_cast<int>(p));
        }
    }

    void unite(DisjointSets& sets) {
        std::map<int, std::size_t> part_of;
        std::vector<Part> united;
        std::map<std::size_t, int> region;
        for (std::size_t p = 0; p < parts_.size(); ++p) {
            const auto [entry, fresh] = part_of.try_emplace(sets.find(static_cast<int>(p)), united.size());
            if (fresh) united.emplace_back();
            Part& part = united[entry->second];
            part.nodes.insert(part.nodes.end(), parts_[p].nodes.begin(), parts_[p].nodes.end());
            if (region_.contains(p)) region.try_emplace(entry->second, region_[p]);
        }
        parts_ = std::move(united);
        region_ = std::move(region);
        for (Part& part : parts_) measure(part);
    }

    /// Velocity of a node for the six twists of a part.
    [[nodiscard]] Eigen::Matrix<double, 3, 6> speed(int part, int node) const {
        Eigen::Matrix<double, 3, 6> rows = Eigen::Matrix<double, 3, 6>::Zero();
        const Part& p = parts_[static_cast<std::size_t>(part)];
        const Eigen::Vector3d arm = linalg::vector(mesh_.points[node] - p.middle) / p.size;
        rows.leftCols<3>().setIdentity();
        for (int k = 0; k < 3; ++k) rows.col(3 + k) = Eigen::Vector3d::Unit(k).cross(arm);
        return rows;
    }

    /// Twists of all free parts, stacked, that keep shared nodes together; orthonormal columns.
    [[nodiscard]] Eigen::MatrixXd kernel() const {
        const auto size = static_cast<Eigen::Index>(6 * free_.size());
        Eigen::MatrixXd square = Eigen::MatrixXd::Zero(size, size);
        for (const auto& [pair, nodes] : joints_) {
            for (const int node : nodes) {
                Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(3, size);
                if (pair.first > 0) rows.middleCols(6 * place(pair.first), 6) += speed(pair.first, node);
                if (pair.second > 0) rows.middleCols(6 * place(pair.second), 6) -= speed(pair.second, node);
                square += rows.transpose() * rows / static_cast<double>(nodes.size());
            }
        }
        add_rollers(square);
        add_springs(square);
        const linalg::Eigenpairs eigen = linalg::symmetric_eigenpairs(square);
        const double none = straight * straight * eigen.values.maxCoeff();
        Eigen::Index count = 0;
        while (count < size && eigen.values[count] <= none) ++count;
        return eigen.vectors.leftCols(count);
    }

    /// The part of a node; the ground if it holds the node.
    [[nodiscard]] int part_at(int node) const { return part_of_node_[static_cast<std::size_t>(node)]; }

    /// Adds the component along `direction` of the velocity of a node, for all twists, to a row.
    void add_speed(int node, const Eigen::RowVector3d& direction, Eigen::RowVectorXd& row) const {
        const int part = part_at(node);
        if (part > 0 && std::binary_search(free_.begin(), free_.end(), part))
            row.segment(6 * place(part), 6) += direction * speed(part, node);
    }

    void add_rollers(Eigen::MatrixXd& square) const {
        for (const Support& support : description_.supports) {
            for (const Vec3& direction : support.directions) {
                for (const int node : support.nodes) {
                    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(square.rows());
                    add_speed(node, linalg::vector(unit(direction)).transpose(), row);
                    square += row.transpose() * row / static_cast<double>(support.nodes.size());
                }
            }
        }
    }

    /// A spring resists a change of its length.
    void add_springs(Eigen::MatrixXd& square) const {
        std::vector<double> rest;
        for (const Vec3& p : mesh_.points) rest.insert(rest.end(), {p.x, p.y, p.z});
        for (const Spring& spring : description_.springs) {
            Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(square.rows());
            for (const auto& [node, g] : CablePath(spring.points, rest).gradient(rest))
                add_speed(node, linalg::vector(g).transpose(), row);
            square += row.transpose() * row;
        }
    }

    [[nodiscard]] Eigen::Index place(int part) const {
        return std::lower_bound(free_.begin(), free_.end(), part) - free_.begin();
    }

    /// Without a unit, and without the rounding errors that would show as tiny parts or a minus zero.
    [[nodiscard]] static std::string direction(const Eigen::Vector3d& along) {
        const Eigen::Vector3d d = 1e-3 * (1e3 * along.normalized()).array().round() + 0.0;
        return fmt::format("({:.3g}, {:.3g}, {:.3g})", d[0], d[1], d[2]);
    }

    [[nodiscard]] static std::string show(const Vec3& p) {
        // A coordinate that is zero up to rounding is shown as zero.
        const auto mm = [](double m) { return std::fabs(m) < 1e-9 ? 0.0 : 1e3 * m; };
        return fmt::format("({:.4g}, {:.4g}, {:.4g}) mm", mm(p.x), mm(p.y), mm(p.z));
    }

    [[nodiscard]] std::string say(std::size_t part, const Twists& ways) const {
        const auto region = region_.find(part);
        const std::string who =
            region == region_.end()
                ? std::string("a plate")
                : fmt::format("body \"{}\"", mesh_.region_names[static_cast<std::size_t>(region->second)]);
        const Part& p = parts_[part];
        const auto [U, s, V] = linalg::svd(ways, linalg::SvdParts::thin_left);
        Eigen::Index rank = 0;
        while (rank < s.size() && s[rank] > 1e-6 * s[0]) ++rank;
        const Twists basis = U.leftCols(rank);
        if (rank == 1) return fmt::format("{} {}", who, one_way(p, basis.col(0)));
        if (const auto point = common_point(p, basis))
            return fmt::format("{} can turn freely about the point {}, the only one that holds it; hold it by a face",
                               who, show(*point));
        return fmt::format("{} can move freely in {} ways; hold it by a face", who, rank);
    }

    [[nodiscard]] static std::string one_way(const Part& p, const Eigen::VectorXd& twist) {
        const Eigen::Vector3d speed = twist.head<3>();
        const Eigen::Vector3d turn = twist.tail<3>() / p.size;
        if (turn.norm() * p.size < 1e-6 * speed.norm())
            return fmt::format("can slide freely along {}; hold it by a face", direction(speed));
        const Vec3 on = p.middle + vec3(turn.cross(speed) / turn.squaredNorm());
        const Vec3 other = on + vec3(0.5 * p.size * turn.normalized());
        return fmt::format(
            "can turn freely about the line through {} and {}: the nodes that hold it, of a support or of an edge that "
            "it shares, all lie on that line; hold it by a face",
            show(on), show(other));
    }

    /// The fixed point of all motions, if there is exactly one.
    [[nodiscard]] static std::optional<Vec3> common_point(const Part& p, const Twists& basis) {
        const Eigen::Index ways = basis.cols();
        Eigen::MatrixXd A(3 * ways, 3);
        Eigen::VectorXd b(3 * ways);
        for (Eigen::Index k = 0; k < ways; ++k) {
            const Eigen::Vector3d turn = basis.col(k).tail<3>();
            for (int c = 0; c < 3; ++c) A.block<3, 1>(3 * k, c) = turn.cross(Eigen::Vector3d::Unit(c));
            b.segment<3>(3 * k) = -basis.col(k).head<3>();
        }
        const Eigen::Vector3d at = linalg::least_squares(A, b);
        if ((A * at - b).norm() > 1e-6) return {};
        return p.middle + p.size * vec3(at);
    }

    const Description& description_;
    const mesh::TetMesh& mesh_;
    std::vector<Part> parts_;            ///< the ground first
    std::map<std::size_t, int> region_;  ///< for parts with tets
    std::map<std::pair<int, int>, std::vector<int>> joints_;
    std::vector<int> part_of_node_;
    std::vector<int> free_;  ///< parts connected to the ground, but not rigidly; ascending
};

}  // namespace

std::optional<std::string> free_motion(const Description& description) {
    return Mechanism(description).describe();
}

}  // namespace pliant::sim
