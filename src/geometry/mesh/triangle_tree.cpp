#include "geometry/mesh/triangle_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "base/core/boxes.hpp"

namespace pliant::mesh {
namespace {

constexpr int leaf_size = 8;
/// A node is treated as a dipole from this multiple of its reach on.
constexpr double far_enough = 3;

/// Sums angles given as complex numbers. Angles below a quarter turn are multiplied while their sum stays below one, so
/// that few arc tangents are needed: these took over half of the time.
class AngleSum {
public:
    void add(double re, double im) {
        if (!(re > 0)) {
            sum_ += std::atan2(im, re);
            return;
        }
        const double new_re = re_ * re - im_ * im;
        const double new_im = re_ * im + im_ * re;
        constexpr double large = 1e100;
        re_ = new_re;
        im_ = new_im;
        if (!(re_ > 1 / large && re_ < large && std::fabs(im_) < large)) flush();
    }
    double total() {
        flush();
        return sum_;
    }

private:
    void flush() {
        sum_ += std::atan2(im_, re_);
        re_ = 1;
        im_ = 0;
    }

    double re_ = 1, im_ = 0, sum_ = 0;
};

/// Solid angle of a triangle (van Oosterom and Strackee 1983), halved.
void add_half_solid_angle(const std::array<Vec3, 3>& t, const Vec3& point, AngleSum& sum) {
    const Vec3 a = t[0] - point;
    const Vec3 b = t[1] - point;
    const Vec3 c = t[2] - point;
    const double la = norm(a);
    const double lb = norm(b);
    const double lc = norm(c);
    sum.add(la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb, dot(a, cross(b, c)));
}

bool ray_meets_box(const Vec3& origin, const Vec3& direction, const Box3& box, double nearest) {
    double low = 0;
    double high = nearest;
    for (std::size_t k = 0; k < 3; ++k) {
        if (direction[k] == 0) {
            if (origin[k] < box.low[k] || origin[k] > box.high[k]) return false;
            continue;
        }
        const double a = (box.low[k] - origin[k]) / direction[k];
        const double b = (box.high[k] - origin[k]) / direction[k];
        low = std::max(low, std::min(a, b));
        high = std::min(high, std::max(a, b));
    }
    return low <= high * (1 + 1e-12) + 1e-300;
}

/// Moeller and Trumbore 1997; hits on edges count.
std::optional<double> ray_meets_triangle(const Vec3& origin, const Vec3& direction, const std::array<Vec3, 3>& t) {
    const Vec3 e1 = t[1] - t[0];
    const Vec3 e2 = t[2] - t[0];
    const Vec3 h = cross(direction, e2);
    const double determinant = dot(e1, h);
    if (std::fabs(determinant) < 1e-12 * norm(direction) * norm(e1) * norm(e2)) return std::nullopt;
    const Vec3 s = origin - t[0];
    const double u = dot(s, h) / determinant;
    const Vec3 q = cross(s, e1);
    const double v = dot(direction, q) / determinant;
    if (u < -1e-9 || v < -1e-9 || u + v > 1 + 1e-9) return std::nullopt;
    return dot(e2, q) / determinant;
}

}  // namespace

TriangleTree::TriangleTree(TriMesh surface) : surface_(std::move(surface)), order_(surface_.triangles.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    if (!order_.empty()) build(0, static_cast<int>(order_.size()));
}

std::array<Vec3, 3> TriangleTree::corners(int triangle) const {
    const auto& [a, b, c] = surface_.triangles[static_cast<std::size_t>(triangle)];
    const auto& p = surface_.points;
    return {p[static_cast<std::size_t>(a)], p[static_cast<std::size_t>(b)], p[static_cast<std::size_t>(c)]};
}

int TriangleTree::build(int begin, int end) {
    Node node{{}, {}, {}, 0, begin, end};
    double area = 0;
    Box3 middles;
    for (int i = begin; i < end; ++i) {
        const auto t = corners(order_[static_cast<std::size_t>(i)]);
        const Vec3 normal = 0.5 * cross(t[1] - t[0], t[2] - t[0]);
        const Vec3 middle = (t[0] + t[1] + t[2]) / 3;
        node.dipole += normal;
        node.centre += norm(normal) * middle;
        area += norm(normal);
        middles.add(middle);
        for (const Vec3& p : t) node.box.add(p);
    }
    node.centre = area > 0 ? node.centre / area : 0.5 * (node.box.low + node.box.high);
    for (int i = begin; i < end; ++i) {
        for (const Vec3& p : corners(order_[static_cast<std::size_t>(i)]))
            node.reach = std::max(node.reach, norm(p - node.centre));
    }
    const int index = static_cast<int>(nodes_.size());
    nodes_.push_back(node);
    if (end - begin <= leaf_size) return index;
    const std::size_t axis = longest_axis(middles);
    const int half = begin + (end - begin) / 2;
    const auto items =
        std::span(order_).subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(end - begin));
    halve(items, static_cast<std::size_t>(half - begin), [&](int triangle) {
        const auto t = corners(triangle);
        return t[0][axis] + t[1][axis] + t[2][axis];
    });
    const int left = build(begin, half);
    const int right = build(half, end);
    nodes_[static_cast<std::size_t>(index)].left = left;
    nodes_[static_cast<std::size_t>(index)].right = right;
    return index;
}

double TriangleTree::winding_number(const Vec3& point) const {
    if (nodes_.empty()) return 0;
    double halves = 0;
    AngleSum near;
    std::array<int, 64> open{};
    std::size_t count = 1;
    while (count > 0) {
        const Node& node = nodes_[static_cast<std::size_t>(open[--count])];
        const Vec3 away = node.centre - point;
        const double distance = norm(away);
        if (distance > far_enough * node.reach) {
            halves += dot(away, node.dipole) / (2 * distance * distance * distance);
        } else if (node.left < 0) {
            for (int i = node.begin; i < node.end; ++i)
                add_half_solid_angle(corners(order_[static_cast<std::size_t>(i)]), point, near);
        } else {
            open[count++] = node.left;
            open[count++] = node.right;
        }
    }
    return (halves + near.total()) / (2 * std::numbers::pi);
}

std::optional<TriangleTree::Hit> TriangleTree::first_hit(const Vec3& origin, const Vec3& direction, double from) const {
    if (nodes_.empty()) return std::nullopt;
    Hit best{std::numeric_limits<double>::infinity(), -1};
    std::array<int, 64> open{};
    std::size_t count = 1;
    while (count > 0) {
        const Node& node = nodes_[static_cast<std::size_t>(open[--count])];
        if (!ray_meets_box(origin, direction, node.box, best.distance)) continue;
        if (node.left >= 0) {
            open[count++] = node.left;
            open[count++] = node.right;
            continue;
        }
        for (int i = node.begin; i < node.end; ++i) {
            const int triangle = order_[static_cast<std::size_t>(i)];
            const auto at = ray_meets_triangle(origin, direction, corners(triangle));
            if (at && *at > from && *at < best.distance) best = {*at, triangle};
        }
    }
    if (best.triangle < 0) return std::nullopt;
    return best;
}

}  // namespace pliant::mesh
