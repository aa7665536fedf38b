#include "simulation/model/held_nodes.hpp"

#include <algorithm>
#include <cmath>

#include "base/linalg/dense.hpp"
#include "base/linalg/vectors.hpp"
#include "simulation/parts/description.hpp"

namespace pliant::sim {
namespace {

/// A direction counts as in the span of others if the sine of its angle is below this.
constexpr double same_direction = 1e-6;

/// Orthonormal rows that span the held directions; all three axes if the support names none.
Eigen::Matrix<double, Eigen::Dynamic, 3> span_of(const Support& support) {
    if (support.directions.empty()) return Eigen::Matrix3d::Identity();
    Eigen::Matrix<double, Eigen::Dynamic, 3> rows(0, 3);
    for (const Vec3& direction : support.directions) {
        Eigen::Vector3d rest = linalg::vector(direction).normalized();
        // Twice is enough to be orthogonal to rounding (Kahan and Parlett).
        for (int round = 0; round < 2; ++round) rest -= rows.transpose() * (rows * rest);
        if (rest.norm() < same_direction) continue;
        rows.conservativeResize(rows.rows() + 1, 3);
        rows.row(rows.rows() - 1) = rest.normalized();
    }
    return rows;
}

Status check_support(const Support& support, int node_count) {
    if (support.nodes.empty()) return input_error("fixed \"{}\": catches no node", support.name);
    const Turn& turn = support.turn;
    if (!is_finite(support.move_m) || !std::isfinite(turn.angle_rad) || !is_finite(turn.center_m))
        return input_error("fixed \"{}\": the prescribed motion is not finite", support.name);
    if (!is_finite(turn.axis) || !(norm(turn.axis) > 0))
        return input_error("fixed \"{}\": the axis of its rotation must not be zero", support.name);
    for (const Vec3& direction : support.directions) {
        if (!is_finite(direction) || !(norm(direction) > 0))
            return input_error("fixed \"{}\": a direction must not be zero", support.name);
    }
    for (const int node : support.nodes) {
        if (node < 0 || node >= node_count)
            return input_error("fixed \"{}\": node {} does not exist", support.name, node);
    }
    return {};
}

/// Projector onto what is orthogonal to the rows.
Eigen::Matrix3d complement_of(const Eigen::Matrix<double, Eigen::Dynamic, 3>& rows) {
    const Eigen::MatrixXd q = linalg::column_basis(rows.transpose(), same_direction);
    return Eigen::Matrix3d::Identity() - q * q.transpose();
}

}  // namespace

Result<HeldNodes> HeldNodes::create(std::span<const Support> supports, int node_count) {
    HeldNodes held;
    held.fixed_.assign(static_cast<std::size_t>(node_count), false);
    std::vector<std::vector<int>> holders(static_cast<std::size_t>(node_count));
    for (std::size_t s = 0; s < supports.size(); ++s) {
        if (Status status = check_support(supports[s], node_count); !status) return tl::unexpected(status.error());
        held.directions_.push_back(span_of(supports[s]));
        for (const int node : supports[s].nodes) {
            std::vector<int>& mine = holders[static_cast<std::size_t>(node)];
            if (mine.empty() || mine.back() != static_cast<int>(s)) mine.push_back(static_cast<int>(s));
        }
    }
    held.alone_.resize(supports.size());
    for (int node = 0; node < node_count; ++node) {
        const std::vector<int>& mine = holders[static_cast<std::size_t>(node)];
        if (mine.empty()) continue;
        if (mine.size() > 1) {
            if (Status status = held.add_shared(supports, node, mine); !status) return tl::unexpected(status.error());
            continue;
        }
        const auto s = static_cast<std::size_t>(mine[0]);
        held.alone_[s].push_back(node);
        if (held.directions_[s].rows() == 3)
            held.fixed_[static_cast<std::size_t>(node)] = true;
        else
            held.rollers_.push_back({node, complement_of(held.directions_[s])});
    }
    return held;
}

Status HeldNodes::add_shared(std::span<const Support> supports, int node, const std::vector<int>& holders) {
    Shared shared{node, holders, Directions(0, 3)};
    for (const int s : holders) {
        const Directions& rows = directions_[static_cast<std::size_t>(s)];
        shared.directions.conservativeResize(shared.directions.rows() + rows.rows(), 3);
        shared.directions.bottomRows(rows.rows()) = rows;
    }
    if (Status status = check_shared(supports, holders); !status) return status;
    const Eigen::Matrix3d free = complement_of(shared.directions);
    if (free.trace() < 0.5)
        fixed_[static_cast<std::size_t>(node)] = true;
    else
        rollers_.push_back({node, free});
    shared_.push_back(std::move(shared));
    return {};
}

/// Two supports must not both hold a node in all directions, nor in the same one while one of them moves.
Status HeldNodes::check_shared(std::span<const Support> supports, const std::vector<int>& holders) const {
    for (const int s : holders) {
        for (const int t : holders) {
            if (s >= t) continue;
            const Support &first = supports[static_cast<std::size_t>(s)],
                          &second = supports[static_cast<std::size_t>(t)];
            const Directions &a = directions_[static_cast<std::size_t>(s)],
                             &b = directions_[static_cast<std::size_t>(t)];
            if (a.rows() == 3 && b.rows() == 3)
                return input_error("fixed \"{}\" and fixed \"{}\" share nodes; let each node belong to one", first.name,
                                   second.name);
            Directions both(a.rows() + b.rows(), 3);
            both << a, b;
            const auto held = static_cast<Eigen::Index>(std::lround(3 - complement_of(both).trace()));
            if (held < both.rows() && (first.moves() || second.moves()))
                return input_error(
                    "fixed \"{}\" and fixed \"{}\" hold the same nodes in the same direction while one of them moves; "
                    "let each node belong to one, or give them other directions",
                    first.name, second.name);
        }
    }
    return {};
}

void HeldNodes::place(std::span<const Support> supports, std::span<const Vec3> rest, std::span<const double> shares,
                      Eigen::VectorXd& x) const {
    move(
        [&](std::size_t s, int node) -> Eigen::Vector3d {
            return linalg::vector(supports[s].position(rest[static_cast<std::size_t>(node)], shares[s]));
        },
        x);
}

Eigen::VectorXd HeldNodes::motion(const Wanted& wanted) const {
    Eigen::VectorXd motion = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(fixed_.size()));
    move(wanted, motion);
    return motion;
}

void HeldNodes::move(const Wanted& wanted, Eigen::VectorXd& x) const {
    for (std::size_t s = 0; s < directions_.size(); ++s) {
        const bool whole = directions_[s].rows() == 3;
        for (const int node : alone_[s]) {
            auto place = x.segment<3>(3 * node);
            if (whole)
                place = wanted(s, node);
            else
                place += directions_[s].transpose() * (directions_[s] * (wanted(s, node) - place));
        }
    }
    for (const Shared& shared : shared_) {
        auto place = x.segment<3>(3 * shared.node);
        Eigen::VectorXd off(shared.directions.rows());
        Eigen::Index row = 0;
        for (const int s : shared.supports) {
            const Directions& rows = directions_[static_cast<std::size_t>(s)];
            off.segment(row, rows.rows()) = rows * (wanted(static_cast<std::size_t>(s), shared.node) - place);
            row += rows.rows();
        }
        place += linalg::shortest_least_squares(shared.directions, off);
    }
}

void HeldNodes::visit_weights(const Eigen::VectorXd& weights, const TakeWeight& take) const {
    for (std::size_t s = 0; s < directions_.size(); ++s) {
        const Directions& rows = directions_[s];
        for (const int node : alone_[s]) take(s, node, rows.transpose() * (rows * weights.segment<3>(3 * node)));
    }
    for (const Shared& shared : shared_) {
        const Eigen::VectorXd along =
            linalg::shortest_least_squares(shared.directions.transpose(), weights.segment<3>(3 * shared.node));
        Eigen::Index row = 0;
        for (const int s : shared.supports) {
            const Directions& rows = directions_[static_cast<std::size_t>(s)];
            take(static_cast<std::size_t>(s), shared.node, rows.transpose() * along.segment(row, rows.rows()));
            row += rows.rows();
        }
    }
}

std::vector<Vec3> HeldNodes::reactions(std::span<const Support> supports, const Eigen::VectorXd& out_of_balance) const {
    std::vector<Eigen::Vector3d> sums(supports.size(), Eigen::Vector3d::Zero());
    for (std::size_t s = 0; s < supports.size(); ++s) {
        for (const int node : alone_[s]) sums[s] += out_of_balance.segment<3>(3 * node);
        if (directions_[s].rows() < 3) sums[s] = directions_[s].transpose() * (directions_[s] * sums[s]);
    }
    for (const Shared& shared : shared_) {
        const Eigen::VectorXd along =
            linalg::shortest_least_squares(shared.directions.transpose(), out_of_balance.segment<3>(3 * shared.node));
        Eigen::Index row = 0;
        for (const int s : shared.supports) {
            const Directions& rows = directions_[static_cast<std::size_t>(s)];
            sums[static_cast<std::size_t>(s)] += rows.transpose() * along.segment(row, rows.rows());
            row += rows.rows();
        }
    }
    std::vector<Vec3> forces;
    for (const Eigen::Vector3d& sum : sums) forces.push_back({sum[0], sum[1], sum[2]});
    return forces;
}

}  // namespace pliant::sim
