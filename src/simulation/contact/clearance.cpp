#include "simulation/contact/clearance.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "base/linalg/vectors.hpp"

namespace pliant::sim::contact {

namespace {

/// Regions at least this many times their size apart are treated as one pair.
constexpr double far_share = 0.5;

/// Allowed relative change of a distance: from 1.8 to 0.2 of it, the largest ratio is a ninth.
constexpr double room_share = 0.8;

double room(double apart_m, double reach_m) {
    return std::min(apart_m - reach_m, room_share * apart_m);
}

double squared_gap(const Bounds& a, const Bounds& b) {
    double squared = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double apart = std::max({a.low[k] - b.high[k], b.low[k] - a.high[k], 0.0});
        squared += apart * apart;
    }
    return squared;
}

double longest_side(const Bounds& box) {
    return std::max({box.high[0] - box.low[0], box.high[1] - box.low[1], box.high[2] - box.low[2]});
}

/// The largest squared difference between a vector in `a` and one in `b`.
double squared_difference(const Bounds& a, const Bounds& b) {
    double squared = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double most = std::max(a.high[k] - b.low[k], b.high[k] - a.low[k]);
        squared += most * most;
    }
    return squared;
}

using Points = std::span<const int>;
using State = std::span<const double>;

Eigen::Vector3d mean(Points points, State x) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const int p : points) sum += linalg::view(x, p);
    return sum / static_cast<double>(points.size());
}

/// Axes along one side of a triangle, across it in its plane, and along its normal.
Eigen::Matrix3d axes(const std::array<Eigen::Vector3d, 3>& corners) {
    Eigen::Matrix3d axes;
    axes.col(0) = (corners[1] - corners[0]).normalized();
    axes.col(2) = axes.col(0).cross(corners[2] - corners[0]).normalized();
    axes.col(1) = axes.col(2).cross(axes.col(0));
    return axes;
}

}  // namespace

Clearance::Clearance(std::span<const Side> sides, std::span<const Meeting> meetings, State x, double seen_m,
                     double reach_m)
    : x_(x.begin(), x.end()), seen_m_(seen_m), reach_m_(reach_m) {
    for (const Side& side : sides) {
        const auto& regions = side.regions->nodes();
        Reference& reference = sides_.emplace_back(
            Reference{side.regions, side.regions->boxes(*side.surface, x), std::vector<Ball>(regions.size())});
        for (std::size_t n = 0; n < regions.size(); ++n) {
            if (!regions[n].is_leaf()) continue;
            const Points points = side.regions->points_of(regions[n]);
            Ball& ball = reference.balls[n] = {mean(points, x), 0};
            for (const int p : points)
                ball.radius_m = std::max(ball.radius_m, (linalg::view(x, p) - ball.centre).norm());
        }
    }
    for (const Meeting& meeting : meetings) {
        Cover& cover = covers_.emplace_back(Cover{meeting, {}, {}});
        if (sides_[meeting.first].boxes.empty() || sides_[meeting.second].boxes.empty()) continue;
        add_pairs(cover, 0, 0);
        std::sort(cover.near.begin(), cover.near.end(), [](const Pair& a, const Pair& b) {
            return std::pair(a.first, a.second) < std::pair(b.first, b.second);
        });
    }
}

double Clearance::gap(const Cover& cover, std::size_t a, std::size_t b) const {
    return std::sqrt(squared_gap(sides_[cover.sides.first].boxes[a], sides_[cover.sides.second].boxes[b]));
}

bool Clearance::halve_first(const Cover& cover, std::size_t a, std::size_t b) const {
    const Reference &first = sides_[cover.sides.first], &second = sides_[cover.sides.second];
    if (second.regions->nodes()[b].is_leaf()) return true;
    return !first.regions->nodes()[a].is_leaf() && longest_side(first.boxes[a]) > longest_side(second.boxes[b]);
}

void Clearance::add_pairs(Cover& cover, std::size_t a, std::size_t b) const {
    const Reference &first = sides_[cover.sides.first], &second = sides_[cover.sides.second];
    const auto &mine = first.regions->nodes()[a], &theirs = second.regions->nodes()[b];
    const double apart = gap(cover, a, b);
    const bool near = apart <= seen_m_;
    const double size = std::max(longest_side(first.boxes[a]), longest_side(second.boxes[b]));
    if (mine.is_leaf() && theirs.is_leaf()) {
        (near ? cover.near : cover.far).push_back({a, b, room(std::max(apart, seen_m_), reach_m_)});
    } else if (!near && apart > far_share * size) {
        cover.far.push_back({a, b, room(apart, reach_m_)});
    } else if (cover.sides.first == cover.sides.second && a == b) {
        add_pairs(cover, mine.left, mine.left);
        add_pairs(cover, mine.left, mine.right);
        add_pairs(cover, mine.right, mine.right);
    } else if (halve_first(cover, a, b)) {
        add_pairs(cover, mine.left, b);
        add_pairs(cover, mine.right, b);
    } else {
        add_pairs(cover, a, theirs.left);
        add_pairs(cover, a, theirs.right);
    }
}

void Clearance::offer(std::size_t m, Points first, Points second, double apart_m, double reach_m) {
    Cover& cover = covers_[m];
    const Regions &mine = *sides_[cover.sides.first].regions, &theirs = *sides_[cover.sides.second].regions;
    for (const int p : first) {
        for (const int q : second) {
            std::pair key(mine.leaf_of(p), theirs.leaf_of(q));
            // For a surface with itself, each pair of regions occurs once, the lower index first.
            if (&mine == &theirs && key.first > key.second) std::swap(key.first, key.second);
            const auto found = std::lower_bound(
                cover.near.begin(), cover.near.end(), key,
                [](const Pair& pair, const auto& wanted) { return std::pair(pair.first, pair.second) < wanted; });
            found->room_m = std::min(found->room_m, room(apart_m, reach_m));
        }
    }
}

/// One evaluation of holds().
class Clearance::Look {
public:
    Look(const Clearance& clearance, State x, State dx) : clearance_(clearance), x_(x), dx_(dx) {
        for (const Reference& side : clearance.sides_)
            motions_.push_back({side.regions->displacements(clearance.x_, x, dx), {}, {}});
    }

    [[nodiscard]] bool holds(const Cover& cover) {
        const auto near = [&](const Pair& pair) {
            return moved_less(cover, pair) || turned_back_moved_less(cover, pair);
        };
        const auto far = [&](const Pair& pair) { return far_holds(cover, pair); };
        return std::all_of(cover.near.begin(), cover.near.end(), near) &&
               std::all_of(cover.far.begin(), cover.far.end(), far);
    }

private:
    [[nodiscard]] bool moved_less(const Cover& cover, const Pair& pair) const {
        return squared_difference(motions_[cover.sides.first].displacement[pair.first],
                                  motions_[cover.sides.second].displacement[pair.second]) <= pair.room_m * pair.room_m;
    }

    /// If a pair has moved too much, its halves may not have.
    [[nodiscard]] bool far_holds(const Cover& cover, const Pair& pair) {
        if (moved_less(cover, pair)) return true;
        const auto [a, b, room_m] = pair;
        const auto& mine = clearance_.sides_[cover.sides.first].regions->nodes()[a];
        const auto& theirs = clearance_.sides_[cover.sides.second].regions->nodes()[b];
        if (mine.is_leaf() && theirs.is_leaf()) return turned_back_moved_less(cover, pair);
        const auto half = [&](std::size_t c, std::size_t d) {
            return far_holds(cover, {c, d, room(clearance_.gap(cover, c, d), clearance_.reach_m_)});
        };
        return clearance_.halve_first(cover, a, b) ? half(mine.left, b) && half(mine.right, b)
                                                   : half(a, theirs.left) && half(a, theirs.right);
    }

    /// Undoes the rotation of the first leaf for both: what remains is the deviation of each from a rigid motion, and
    /// the difference of the two motions at the second.
    [[nodiscard]] bool turned_back_moved_less(const Cover& cover, const Pair& pair) {
        const Turned& first = turned(cover.sides.first, pair.first);
        const Turned& second = turned(cover.sides.second, pair.second);
        const Ball& mine = clearance_.sides_[cover.sides.first].balls[pair.first];
        const Ball& theirs = clearance_.sides_[cover.sides.second].balls[pair.second];
        const double turn_m = (second.rotation - first.rotation).norm() * theirs.radius_m;
        const Eigen::Vector3d carried = first.rotation * (theirs.centre - mine.centre);
        for (std::size_t end = 0; end < 2; ++end) {
            const double shift_m = (second.to[end] - first.to[end] - carried).norm();
            if (!(first.off_m[end] + second.off_m[end] + turn_m + shift_m <= pair.room_m)) return false;
        }
        return true;
    }

    /// The rigid motion of a leaf, computed on demand: only few are needed if the body rotates little.
    const Turned& turned(std::size_t side, std::size_t leaf) {
        const Reference& reference = clearance_.sides_[side];
        Motion& motion = motions_[side];
        if (motion.place.empty()) motion.place.assign(reference.regions->nodes().size(), -1);
        int& place = motion.place[leaf];
        if (place < 0) {
            place = static_cast<int>(motion.turned.size());
            motion.turned.push_back(turned_leaf(reference, leaf));
        }
        return motion.turned[static_cast<std::size_t>(place)];
    }

    [[nodiscard]] Turned turned_leaf(const Reference& side, std::size_t leaf) const {
        const Points points = side.regions->points_of(side.regions->nodes()[leaf]);
        const Eigen::Vector3d from = side.balls[leaf].centre, start = mean(points, x_);
        const Eigen::Vector3d moved = dx_.empty() ? Eigen::Vector3d::Zero() : mean(points, dx_);
        Turned turned{rotation(side, leaf), {start, start + moved}, {}};
        for (const int p : points) {
            const Eigen::Vector3d off =
                linalg::view(x_, p) - turned.rotation * (linalg::view(clearance_.x_, p) - from) - start;
            turned.off_m[0] = std::max(turned.off_m[0], off.norm());
            if (!dx_.empty()) turned.off_m[1] = std::max(turned.off_m[1], (off + linalg::view(dx_, p) - moved).norm());
        }
        return turned;
    }

    /// Half of the rotation, so that neither end is far from it.
    [[nodiscard]] Eigen::Matrix3d rotation(const Reference& side, std::size_t leaf) const {
        const auto corners = side.regions->corners(leaf);
        if (!corners) return Eigen::Matrix3d::Identity();
        std::array<Eigen::Vector3d, 3> before, now;
        for (std::size_t k = 0; k < 3; ++k) {
            before[k] = linalg::view(clearance_.x_, (*corners)[k]);
            now[k] = linalg::view(x_, (*corners)[k]);
            if (!dx_.empty()) now[k] += 0.5 * linalg::view(dx_, (*corners)[k]);
        }
        return axes(now) * axes(before).transpose();
    }

    const Clearance& clearance_;
    State x_, dx_;
    std::vector<Motion> motions_;
};

bool Clearance::holds(State x, State dx) const {
    Look look(*this, x, dx);
    return std::all_of(covers_.begin(), covers_.end(), [&](const Cover& cover) { return look.holds(cover); });
}

}  // namespace pliant::sim::contact
