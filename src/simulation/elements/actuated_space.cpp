#include "simulation/elements/actuated_space.hpp"

#include <algorithm>
#include <cmath>

#include "simulation/elements/elements.hpp"

namespace pliant::sim {
namespace {

constexpr double least_length = 1e-9;  // length of a gap element relative to its own: no division by zero; inverted
                                       // elements are never evaluated

}  // namespace

material::NeoHookean air_law(double softest_Pa, double weight) {
    return {space_shape_share * softest_Pa, weight * softest_Pa};
}

material::NeoHookean gap_law(double softest_Pa) {
    return {space_shape_share * softest_Pa, space_shape_share * softest_Pa};
}

GapElements::GapElements(const Elements& elements, std::span<const Gap> gaps) : width_(elements.nodes_per_tet()) {
    double volume = 0;
    std::vector<double> volume_of_gap;
    for (const Gap& gap : gaps) {
        double sum = 0;
        for (const std::size_t tet : gap.tets) {
            for (int q = 0; q < elements.points_per_tet(); ++q) sum += elements.point_volume(tet, q);
        }
        volume_of_gap.push_back(sum);
        volume += sum;
        length_m_ += gap.length_m;
    }
    // The tension is constant along the cable: what a wide gap has more in area it has less in stress.
    const double area = volume / length_m_;
    for (std::size_t g = 0; g < gaps.size(); ++g) {
        const Gap& gap = gaps[g];
        directions_.push_back(gap.direction);
        gap_weights_Pa_.push_back(gap.weight_Pa);
        numbers_.push_back(gap.number);
        const double stiffness_Pa = gap.weight_Pa * area * gap.length_m / volume_of_gap[g];
        for (const std::size_t tet : gap.tets) {
            for (int q = 0; q < elements.points_per_tet(); ++q) {
                for (std::size_t a = 0; a < width_; ++a) {
                    nodes_.push_back(elements.node_of(tet, static_cast<int>(a)));
                    weights_.push_back(dot(elements.shape_gradient(tet, q, static_cast<int>(a)), gap.direction));
                }
                points_.push_back({tet, q, g});
                stiffness_J_.push_back(stiffness_Pa * elements.point_volume(tet, q));
                stiffness_N_ += stiffness_J_.back();
            }
        }
    }
    stiffness_N_ /= length_m_;
}

GapElements::Along GapElements::along(std::size_t point, std::span<const double> x) const {
    Along result;
    for (std::size_t k = point * width_; k < (point + 1) * width_; ++k) {
        const double* p = x.data() + 3 * static_cast<std::size_t>(nodes_[k]);
        result.vector += weights_[k] * Vec3{p[0], p[1], p[2]};
    }
    result.length = std::max(norm(result.vector), least_length);
    return result;
}

double GapElements::energy(std::span<const double> x) const {
    double sum = 0;
    for (std::size_t point = 0; point < count(); ++point) {
        const double change = along(point, x).length - 1;
        sum += 0.5 * stiffness_J_[point] * change * change;
    }
    return sum;
}

template <class FactorOf>
void GapElements::add_along(std::span<const double> x, std::span<double> forces, const FactorOf& factor_of) const {
    for (std::size_t point = 0; point < count(); ++point) {
        const Along now = along(point, x);
        const Vec3 pull = (factor_of(now.length) * stiffness_J_[point] / now.length) * now.vector;
        for (std::size_t k = point * width_; k < (point + 1) * width_; ++k) {
            double* f = forces.data() + 3 * static_cast<std::size_t>(nodes_[k]);
            for (std::size_t i = 0; i < 3; ++i) f[i] += weights_[k] * pull[i];
        }
    }
}

void GapElements::add_gradient(std::span<const double> x, std::span<double> forces) const {
    add_along(x, forces, [](double length) { return length - 1; });
}

void GapElements::add_pull(std::span<const double> x, double factor, std::span<double> forces) const {
    add_along(x, forces, [&](double) { return factor / stiffness_N_; });
}

void GapElements::add_hessian(std::span<const double> x, double m, const std::vector<int>& free_index,
                              const linalg::SymmetricPattern& pattern, std::span<double> values, bool project) const {
    const double s = scale(m);
    for (std::size_t point = 0; point < count(); ++point) {
        const Along now = along(point, x);
        const Vec3 n = now.vector / now.length;
        double across = 1 - s / now.length;
        if (project) across = std::max(across, 0.0);
        for (std::size_t b = point * width_; b < (point + 1) * width_; ++b) {
            const int j = free_index[static_cast<std::size_t>(nodes_[b])];
            for (std::size_t a = point * width_; j >= 0 && a < (point + 1) * width_; ++a) {
                const int i = free_index[static_cast<std::size_t>(nodes_[a])];
                if (i < j) continue;
                const double k = stiffness_J_[point] * weights_[a] * weights_[b];
                pattern.add_block(values, i, j, [&](int r, int c) {
                    const double lengthwise = n[static_cast<std::size_t>(r)] * n[static_cast<std::size_t>(c)];
                    return k * ((1 - across) * lengthwise + (r == c ? across : 0));
                });
            }
        }
    }
}

void GapElements::add_laplacian(const std::vector<int>& free_index, const linalg::SymmetricPattern& pattern,
                                std::span<double> values) const {
    for (std::size_t point = 0; point < count(); ++point) {
        for (std::size_t b = point * width_; b < (point + 1) * width_; ++b) {
            const int j = free_index[static_cast<std::size_t>(nodes_[b])];
            for (std::size_t a = point * width_; j >= 0 && a < (point + 1) * width_; ++a) {
                const int i = free_index[static_cast<std::size_t>(nodes_[a])];
                const double k = stiffness_J_[point] * weights_[a] * weights_[b];
                if (i >= j) pattern.add_block(values, i, j, [&](int, int) { return k; });
            }
        }
    }
}

double GapElements::tension(std::span<const double> x, double m) const {
    double sum = 0;
    for (std::size_t point = 0; point < count(); ++point) sum += stiffness_J_[point] * along(point, x).length;
    return sum / length_m_ - stiffness_N_ * scale(m);
}

}  // namespace pliant::sim
