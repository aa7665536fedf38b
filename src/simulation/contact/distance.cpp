#include "simulation/contact/distance.hpp"

#include <algorithm>

#include "base/linalg/vectors.hpp"

namespace pliant::sim::contact {

namespace {

constexpr double parallel_sine_squared = 1e-16;

double squared_norm(const Vec3& a) {
    return dot(a, a);
}

/// Point `p` of the stencil, with weight `sign`, against the segment from point a to point b.
Nearest point_segment(const Stencil& x, int p, int a, int b, double sign) {
    const Vec3 edge = x[b] - x[a];
    const double along = dot(x[p] - x[a], edge);
    const double length2 = squared_norm(edge);
    Nearest n;
    n.weights[p] = sign;
    if (along <= 0 || length2 == 0) {
        n.weights[a] = -sign;
    } else if (along >= length2) {
        n.weights[b] = -sign;
    } else {
        const double u = along / length2;
        n.weights[a] = -sign * (1 - u);
        n.weights[b] = -sign * u;
        n.slopes[0][a] = sign;
        n.slopes[0][b] = -sign;
        n.free = 1;
    }
    return n;
}

const Nearest& nearer(const Nearest& a, const Nearest& b, const Stencil& x) {
    return squared_distance(b, x) < squared_distance(a, x) ? b : a;
}

/// The part of M that belongs to parameter k.
Vector12 mixed_derivative(const Nearest& n, const Vec3& r, const Vec3& slope, int k) {
    Vector12 m;
    for (int i = 0; i < 4; ++i) m.segment<3>(3 * i) = 2 * linalg::vector(n.weights[i] * slope + n.slopes[k][i] * r);
    return m;
}

}  // namespace

Nearest nearest_point_triangle(const Stencil& x) {
    const Vec3 u = x[2] - x[1], v = x[3] - x[1], p = x[0] - x[1];
    const Vec3 normal = cross(u, v);
    const double area2 = squared_norm(normal);
    if (area2 > 0) {
        // Barycentric coordinates of the foot of the perpendicular.
        const double s = dot(cross(p, v), normal) / area2, t = dot(cross(u, p), normal) / area2;
        if (s > 0 && t > 0 && s + t < 1) {
            Nearest n;
            n.weights = {1, -(1 - s - t), -s, -t};
            n.slopes = {{{0, 1, -1, 0}, {0, 1, 0, -1}}};
            n.free = 2;
            return n;
        }
    }
    const Nearest a = point_segment(x, 0, 1, 2, 1), b = point_segment(x, 0, 2, 3, 1), c = point_segment(x, 0, 3, 1, 1);
    return nearer(nearer(a, b, x), c, x);
}

Nearest nearest_edges(const Stencil& x) {
    const Vec3 u = x[1] - x[0], v = x[3] - x[2], w = x[2] - x[0];
    const Vec3 normal = cross(u, v);
    const double area2 = squared_norm(normal);
    if (area2 > parallel_sine_squared * squared_norm(u) * squared_norm(v)) {
        const double s = dot(cross(w, v), normal) / area2, t = dot(cross(w, u), normal) / area2;
        if (s > 0 && s < 1 && t > 0 && t < 1) {
            Nearest n;
            n.weights = {1 - s, s, -(1 - t), -t};
            n.slopes = {{{-1, 1, 0, 0}, {0, 0, 1, -1}}};
            n.free = 2;
            return n;
        }
    }
    // Parameter domain and squared distance are convex: if the optimum is outside, the minimum is on the boundary.
    const Nearest a = point_segment(x, 0, 2, 3, 1), b = point_segment(x, 1, 2, 3, 1);
    const Nearest c = point_segment(x, 2, 0, 1, -1), d = point_segment(x, 3, 0, 1, -1);
    return nearer(nearer(a, b, x), nearer(c, d, x), x);
}

double distance_bound(Features features, const Stencil& x) {
    const bool edges = features == Features::edge_edge;
    const Vec3 centre = edges ? 0.5 * (x[0] + x[1]) : x[0];
    const Vec3 other = edges ? 0.5 * (x[2] + x[3]) : (1.0 / 3) * (x[1] + x[2] + x[3]);
    const Vec3 line = other - centre;
    const double size = norm(line);
    if (size == 0) return 0;
    const double first = edges ? std::max(dot(line, x[0]), dot(line, x[1])) : dot(line, x[0]);
    const double last = std::min(dot(line, x[2]), dot(line, x[3]));
    const double second = edges ? last : std::min(last, dot(line, x[1]));
    return std::max(0.0, second - first) / size;
}

double squared_distance(const Nearest& n, const Stencil& x) {
    return squared_norm(separation(n, x));
}

Vector12 squared_distance_gradient(const Nearest& n, const Stencil& x) {
    const Eigen::Vector3d r = linalg::vector(separation(n, x));
    Vector12 gradient;
    for (int i = 0; i < 4; ++i) gradient.segment<3>(3 * i) = 2 * n.weights[i] * r;
    return gradient;
}

Matrix12 squared_distance_hessian(const Nearest& n, const Stencil& x) {
    Matrix12 H = Matrix12::Zero();
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) H.block<3, 3>(3 * i, 3 * j).diagonal().setConstant(2 * n.weights[i] * n.weights[j]);
    if (n.free == 0) return H;
    const Vec3 r = separation(n, x);
    std::array<Vec3, 2> slope;
    std::array<Vector12, 2> m;
    for (int k = 0; k < n.free; ++k) {
        for (int i = 0; i < 4; ++i) slope[k] += n.slopes[k][i] * x[i];
        m[k] = mixed_derivative(n, r, slope[k], k);
    }
    const double a00 = 2 * squared_norm(slope[0]);
    if (n.free == 1) return H - m[0] * m[0].transpose() / a00;
    const double a01 = 2 * dot(slope[0], slope[1]), a11 = 2 * squared_norm(slope[1]);
    // The determinant as a cross product: no cancellation where the edges are nearly parallel.
    const double determinant = 4 * squared_norm(cross(slope[0], slope[1]));
    const Vector12 n0 = (a11 * m[0] - a01 * m[1]) / determinant, n1 = (a00 * m[1] - a01 * m[0]) / determinant;
    return H - m[0] * n0.transpose() - m[1] * n1.transpose();
}

double squared_cross(const Stencil& x) {
    return squared_norm(cross(x[1] - x[0], x[3] - x[2]));
}

Vector12 squared_cross_gradient(const Stencil& x) {
    const Vec3 u = x[1] - x[0], v = x[3] - x[2], n = cross(u, v);
    const Eigen::Vector3d du = 2 * linalg::vector(cross(v, n)), dv = 2 * linalg::vector(cross(n, u));
    Vector12 gradient;
    gradient << -du, du, -dv, dv;
    return gradient;
}

Matrix12 squared_cross_hessian(const Stencil& x) {
    using Matrix3 = Eigen::Matrix3d;
    const Eigen::Vector3d u = linalg::vector(x[1] - x[0]), v = linalg::vector(x[3] - x[2]);
    const Matrix3 identity = Matrix3::Identity();
    const Matrix3 uu = 2 * (v.dot(v) * identity - v * v.transpose());
    const Matrix3 vv = 2 * (u.dot(u) * identity - u * u.transpose());
    const Matrix3 uv = 2 * (2 * u * v.transpose() - u.dot(v) * identity - v * u.transpose());
    Eigen::Matrix<double, 6, 6> edges;
    edges << uu, uv, uv.transpose(), vv;
    Eigen::Matrix<double, 6, 12> difference = Eigen::Matrix<double, 6, 12>::Zero();
    difference.block<3, 3>(0, 0) = difference.block<3, 3>(3, 6) = -identity;
    difference.block<3, 3>(0, 3) = difference.block<3, 3>(3, 9) = identity;
    return difference.transpose() * edges * difference;
}

}  // namespace pliant::sim::contact
