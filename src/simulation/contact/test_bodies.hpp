// A soft box of springs over a grid of nodes, and a minimiser with contact: just enough statics for the contact tests.
#pragma once

#include <Eigen/Cholesky>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "simulation/contact/contact.hpp"

namespace pliant::sim::contact {

struct Spring {
    int a, b;
    double length_m;
};

/// Nodes, springs between all nodes of each cell, and the outer triangles.
struct SpringBody {
    std::vector<double> rest;  ///< (3n)
    std::vector<Spring> springs;
    std::vector<std::array<int, 3>> triangles;

    void add(const SpringBody& other) {
        const int first = static_cast<int>(rest.size() / 3);
        rest.insert(rest.end(), other.rest.begin(), other.rest.end());
        for (const Spring& s : other.springs) springs.push_back({s.a + first, s.b + first, s.length_m});
        for (const auto& t : other.triangles) triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
    [[nodiscard]] std::size_t node_count() const { return rest.size() / 3; }
};

/// `cells` per axis; `jitter` shifts the inner points of faces a little, so that no two edges are exactly parallel.
inline SpringBody spring_box(const Vec3& corner, const Vec3& size, std::array<int, 3> cells, double jitter = 0) {
    SpringBody body;
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(-jitter, jitter);
    const auto index = [&](int i, int j, int k) { return (k * (cells[1] + 1) + j) * (cells[0] + 1) + i; };
    for (int k = 0; k <= cells[2]; ++k)
        for (int j = 0; j <= cells[1]; ++j)
            for (int i = 0; i <= cells[0]; ++i) {
                const std::array<int, 3> at{i, j, k};
                for (std::size_t c = 0; c < 3; ++c) {
                    const bool inner = at[c] > 0 && at[c] < cells[c];
                    body.rest.push_back(corner[c] + size[c] * (at[c] + (inner ? uniform(random) : 0)) / cells[c]);
                }
            }
    for (int k = 0; k < cells[2]; ++k)
        for (int j = 0; j < cells[1]; ++j)
            for (int i = 0; i < cells[0]; ++i)
                for (int a = 0; a < 8; ++a)
                    for (int b = a + 1; b < 8; ++b) {
                        const int p = index(i + (a & 1), j + (a >> 1 & 1), k + (a >> 2));
                        const int q = index(i + (b & 1), j + (b >> 1 & 1), k + (b >> 2));
                        body.springs.push_back({p, q, norm(node_at(body.rest, p) - node_at(body.rest, q))});
                    }
    // The six sides: axis `c`, low and high, two triangles per cell, counter-clockwise from outside.
    for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t u = (c + 1) % 3, v = (c + 2) % 3;
        for (int side = 0; side < 2; ++side)
            for (int i = 0; i < cells[u]; ++i)
                for (int j = 0; j < cells[v]; ++j) {
                    const auto node = [&](int du, int dv) {
                        std::array<int, 3> at{};
                        at[c] = side * cells[c];
                        at[u] = i + du;
                        at[v] = j + dv;
                        return index(at[0], at[1], at[2]);
                    };
                    const int n00 = node(0, 0), n10 = node(1, 0), n01 = node(0, 1), n11 = node(1, 1);
                    body.triangles.push_back(side == 1 ? std::array{n00, n10, n11} : std::array{n00, n11, n10});
                    body.triangles.push_back(side == 1 ? std::array{n00, n11, n01} : std::array{n00, n01, n11});
                }
    }
    return body;
}

/// What is minimised: springs, dead loads, inertia about a predicted place, contact and friction.
struct Statics {
    const SpringBody* body;
    double spring_N_per_m;          ///< energy ½ k (l − l₀)²
    const Contact* contact;         ///< may be null
    std::vector<double> load;       ///< (3n) N
    std::vector<double> mass;       ///< (n) of ½ m |x − predicted|²; J/m²
    std::vector<double> predicted;  ///< (3n)
    std::vector<bool> held;         ///< (nodes of x), held where they are

    using Vector = Eigen::VectorXd;
    static std::span<const double> span(const Vector& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

    [[nodiscard]] double energy(const Vector& x, const Friction* friction) const {
        double sum = 0;
        for (const Spring& s : body->springs) {
            const double stretch = norm(node_at(span(x), s.a) - node_at(span(x), s.b)) - s.length_m;
            sum += 0.5 * spring_N_per_m * stretch * stretch;
        }
        for (std::size_t k = 0; k < load.size(); ++k) {
            const double off = x[k] - predicted[k];
            sum += 0.5 * mass[k / 3] * off * off - load[k] * x[k];
        }
        if (contact != nullptr) sum += contact->energy(contact->find(span(x)), span(x));
        if (friction != nullptr) sum += friction->energy(span(x));
        return sum;
    }

    void fill(const Vector& x, const Friction* friction, Vector& g, Eigen::MatrixXd& H) const {
        g = Vector::Zero(x.size());
        H = Eigen::MatrixXd::Zero(x.size(), x.size());
        const auto add = [&](int i, int j, const linalg::Matrix3& b) { H.block<3, 3>(3 * i, 3 * j) += b; };
        for (const Spring& s : body->springs) {
            const Eigen::Vector3d d = x.segment<3>(3 * s.a) - x.segment<3>(3 * s.b);
            const double length = d.norm(), share = std::fmax(0, 1 - s.length_m / length);
            const Eigen::Vector3d t = d / length, force = spring_N_per_m * (length - s.length_m) * t;
            g.segment<3>(3 * s.a) += force;
            g.segment<3>(3 * s.b) -= force;
            const linalg::Matrix3 tt = t * t.transpose();
            const linalg::Matrix3 block = spring_N_per_m * (tt + share * (linalg::Matrix3::Identity() - tt));
            add(s.a, s.a, block), add(s.b, s.b, block), add(s.a, s.b, -block), add(s.b, s.a, -block);
        }
        for (std::size_t k = 0; k < load.size(); ++k) {
            g[k] += mass[k / 3] * (x[k] - predicted[k]) - load[k];
            H(k, k) += mass[k / 3];
        }
        const std::span<double> out{g.data(), static_cast<std::size_t>(g.size())};
        if (contact != nullptr) {
            const Pairs pairs = contact->find(span(x));
            contact->add_gradient(pairs, span(x), out);
            contact->visit_hessian(pairs, span(x), true, add);
        }
        if (friction != nullptr) {
            friction->add_gradient(span(x), out);
            friction->visit_hessian(span(x), add);
        }
        for (std::size_t i = 0; i < held.size(); ++i) {
            if (!held[i]) continue;
            g.segment<3>(3 * i).setZero();
            H.middleRows<3>(3 * i).setZero();
            H.middleCols<3>(3 * i).setZero();
            H.block<3, 3>(3 * i, 3 * i).setIdentity();
        }
    }

    /// Projected Newton with a line search that never passes through a surface. The number of iterations, or -1 if
    /// the gradient did not fall below `tolerance_N`. `look` sees every accepted state.
    int minimise(Vector& x, const Friction* friction, double tolerance_N,
                 const std::function<void(const Vector&)>& look = {}) const {
        Vector g;
        Eigen::MatrixXd H;
        double best = energy(x, friction);
        for (int iteration = 0; iteration < 300; ++iteration) {
            fill(x, friction, g, H);
            if (g.norm() < tolerance_N) return iteration;
            H.diagonal().array() += 1e-9 * H.diagonal().mean();
            const Vector dx = -H.ldlt().solve(g);
            double step = contact != nullptr ? contact->largest_step(span(x), span(dx)) : 1;
            for (int halving = 0; halving < 60; ++halving, step /= 2) {
                const Vector trial = x + step * dx;
                const double value = energy(trial, friction);
                if (value > best + 1e-13 * std::fabs(best)) continue;
                x = trial;
                best = value;
                if (look) look(x);
                break;
            }
        }
        return -1;
    }
};

}  // namespace pliant::sim::contact
