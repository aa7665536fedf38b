#include "simulation/contact/pairs.hpp"

#include <Eigen/Eigenvalues>

#include "simulation/contact/barrier.hpp"

namespace pliant::sim::contact {

namespace {

/// Of a sphere D = (√S − R)², with S the squared distance of its centre: its derivatives with respect to S.
Curve of_sphere(double radius_m, double S) {
    const double s = std::sqrt(S), gap = s - radius_m;
    if (!(gap > 0)) return {0, 0, 0};
    return {gap * gap, gap / s, radius_m / (2 * S * s)};
}

/// D, its gradient and Hessian, for all kinds.
double squared(const Pair& pair, const Nearest& n, const Stencil& x) {
    switch (pair.kind) {
        case PairKind::point_triangle:
        case PairKind::edge_edge:
            return squared_distance(n, x);
        case PairKind::sphere_triangle:
            return of_sphere(pair.radius_m, squared_distance(n, x)).value;
        case PairKind::point_plane:
            break;
    }
    const double h = dot(pair.normal, x[0] - x[1]);
    return h > 0 ? h * h : 0;
}

Eigen::Matrix<double, 12, 1> plane_direction(const Pair& pair) {
    const Eigen::Vector3d n(pair.normal.x, pair.normal.y, pair.normal.z);
    Vector12 direction = Vector12::Zero();
    direction.head<6>() << n, -n;
    return direction;
}

Vector12 squared_gradient(const Pair& pair, const Nearest& n, const Stencil& x) {
    if (pair.kind == PairKind::sphere_triangle)
        return of_sphere(pair.radius_m, squared_distance(n, x)).slope * squared_distance_gradient(n, x);
    if (pair.kind != PairKind::point_plane) return squared_distance_gradient(n, x);
    return 2 * dot(pair.normal, x[0] - x[1]) * plane_direction(pair);
}

Matrix12 squared_hessian(const Pair& pair, const Nearest& n, const Stencil& x) {
    if (pair.kind == PairKind::sphere_triangle) {
        const Curve D = of_sphere(pair.radius_m, squared_distance(n, x));
        const Vector12 dS = squared_distance_gradient(n, x);
        return D.slope * squared_distance_hessian(n, x) + D.curvature * dS * dS.transpose();
    }
    if (pair.kind != PairKind::point_plane) return squared_distance_hessian(n, x);
    const Vector12 direction = plane_direction(pair);
    return 2 * direction * direction.transpose();
}

Curve mollifier_of(const Pair& pair, const Stencil& x) {
    if (pair.kind != PairKind::edge_edge) return {1, 0, 0};
    return mollifier(squared_cross(x), pair.parallel_m4);
}

double scale(const Pair& pair, double stiffness_Pa) {
    return stiffness_Pa * pair.area_m2 * pair.reach_m;
}

Curve barrier_of(const Pair& pair, double squared) {
    return barrier(squared, pair.reach_m * pair.reach_m);
}

}  // namespace

Nearest nearest(const Pair& pair, const Stencil& x) {
    switch (pair.kind) {
        case PairKind::point_triangle:
        case PairKind::sphere_triangle:
            return nearest_point_triangle(x);
        case PairKind::edge_edge:
            return nearest_edges(x);
        case PairKind::point_plane:
            break;
    }
    Nearest n;
    n.weights = {1, -1, 0, 0};
    return n;
}

Vec3 separation(const Pair& pair, const Nearest& n, const Stencil& x) {
    const Vec3 r = separation(n, x);
    if (pair.kind == PairKind::sphere_triangle) return (1 - pair.radius_m / norm(r)) * r;
    return pair.kind == PairKind::point_plane ? dot(pair.normal, r) * pair.normal : r;
}

double distance(const Pair& pair, const Stencil& x) {
    if (pair.kind == PairKind::point_plane) return dot(pair.normal, x[0] - x[1]);
    const double between = norm(separation(nearest(pair, x), x));
    return pair.kind == PairKind::sphere_triangle ? between - pair.radius_m : between;
}

double potential(const Pair& pair, double stiffness_Pa, const Stencil& x) {
    const double b = barrier_of(pair, squared(pair, nearest(pair, x), x)).value;
    return b == 0 ? 0 : scale(pair, stiffness_Pa) * mollifier_of(pair, x).value * b;
}

Vector12 potential_gradient(const Pair& pair, double stiffness_Pa, const Stencil& x) {
    const Nearest n = nearest(pair, x);
    const Curve b = barrier_of(pair, squared(pair, n, x)), m = mollifier_of(pair, x);
    Vector12 gradient = m.value * b.slope * squared_gradient(pair, n, x);
    if (m.slope != 0) gradient += m.slope * b.value * squared_cross_gradient(x);
    return scale(pair, stiffness_Pa) * gradient;
}

Matrix12 potential_hessian(const Pair& pair, double stiffness_Pa, const Stencil& x) {
    const Nearest n = nearest(pair, x);
    const Curve b = barrier_of(pair, squared(pair, n, x)), m = mollifier_of(pair, x);
    const Vector12 dD = squared_gradient(pair, n, x);
    Matrix12 H = m.value * (b.curvature * dD * dD.transpose() + b.slope * squared_hessian(pair, n, x));
    if (m.slope != 0) {
        const Vector12 dc = squared_cross_gradient(x);
        H += b.value * (m.curvature * dc * dc.transpose() + m.slope * squared_cross_hessian(x));
        H += m.slope * b.slope * (dc * dD.transpose() + dD * dc.transpose());
    }
    return scale(pair, stiffness_Pa) * H;
}

double normal_force(const Pair& pair, double stiffness_Pa, const Stencil& x) {
    const double D = squared(pair, nearest(pair, x), x);
    return -scale(pair, stiffness_Pa) * mollifier_of(pair, x).value * barrier_of(pair, D).slope * 2 * std::sqrt(D);
}

Vector12 normal_force_gradient(const Pair& pair, double stiffness_Pa, const Stencil& x) {
    const Nearest n = nearest(pair, x);
    const double D = squared(pair, n, x);
    const Curve b = barrier_of(pair, D), m = mollifier_of(pair, x);
    if (!(D > 0) || b.slope == 0) return Vector12::Zero();
    const double d = std::sqrt(D);
    Vector12 gradient = m.value * (2 * d * b.curvature + b.slope / d) * squared_gradient(pair, n, x);
    if (m.slope != 0) gradient += m.slope * b.slope * 2 * d * squared_cross_gradient(x);
    return -scale(pair, stiffness_Pa) * gradient;
}

Matrix12 project_to_positive(const Matrix12& H, int nodes) {
    using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 12, 12>;
    const int size = 3 * nodes;
    const Small part = H.topLeftCorner(size, size);
    const Eigen::SelfAdjointEigenSolver<Small> eigen(part);
    Matrix12 projected = Matrix12::Zero();
    if (eigen.eigenvalues()[0] >= 0) {
        projected.topLeftCorner(size, size) = part;
        return projected;
    }
    const auto positive = eigen.eigenvalues().cwiseMax(0).eval();
    const auto& V = eigen.eigenvectors();
    projected.topLeftCorner(size, size) = V * positive.asDiagonal() * V.transpose();
    return projected;
}

}  // namespace pliant::sim::contact
