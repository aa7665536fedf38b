#include "simulation/actuators/actuator.hpp"

#include <utility>

namespace pliant::sim {

Actuator::Actuator(CablePath path, std::span<const double> rest, std::optional<GapElements> gaps)
    : geometry_(std::move(path)), gaps_(std::move(gaps)), rest_measure_(measure(rest)) {}

Actuator::Actuator(ChamberSurface surface, std::span<const double> rest)
    : geometry_(std::move(surface)), rest_measure_(measure(rest)) {}

double Actuator::measure(std::span<const double> x, std::span<const double> shares) const {
    if (const auto* path = std::get_if<CablePath>(&geometry_)) return path->length(x, shares);
    return std::get<ChamberSurface>(geometry_).volume(x);
}

void Actuator::add_gradient(std::span<const double> x, double factor, std::span<double> forces,
                            std::span<const double> shares) const {
    if (gaps_) return gaps_->add_pull(x, factor, forces);
    if (const auto* surface = std::get_if<ChamberSurface>(&geometry_)) return surface->add_force(x, factor, forces);
    add_measure_gradient(x, factor, forces, shares);
}

void Actuator::add_measure_gradient(std::span<const double> x, double factor, std::span<double> forces,
                                    std::span<const double> shares) const {
    if (const auto* path = std::get_if<CablePath>(&geometry_))
        path->add_gradient(x, factor, forces, shares);
    else
        std::get<ChamberSurface>(geometry_).add_gradient(x, factor, forces);
}

void Actuator::add_hessian(std::span<const double> x, double factor, const std::vector<int>& free_index,
                           const linalg::SymmetricPattern& pattern, std::span<double> values, bool project,
                           std::span<const double> shares) const {
    if (gaps_)
        gaps_->add_hessian(x, factor, free_index, pattern, values, project);
    else if (const auto* path = std::get_if<CablePath>(&geometry_))
        path->add_hessian(x, factor, free_index, pattern, values, shares);
    else
        std::get<ChamberSurface>(geometry_).add_hessian(x, factor, free_index, pattern, values, project);
}

void Actuator::apply_skew(std::span<const double> x, double factor, std::span<const double> v,
                          std::span<double> result) const {
    if (const auto* wall = std::get_if<ChamberSurface>(&geometry_)) wall->apply_skew(x, factor, v, result);
}

void Actuator::add_skew(std::span<const double> x, double factor, const std::vector<int>& index,
                        const linalg::SymmetricPattern& pattern, std::span<double> values) const {
    if (const auto* wall = std::get_if<ChamberSurface>(&geometry_)) wall->add_skew(x, factor, index, pattern, values);
}

void Actuator::append_cliques(const std::vector<int>& free_index, linalg::Lists& cliques) const {
    std::visit([&](const auto& geometry) { geometry.append_cliques(free_index, cliques); }, geometry_);
}

}  // namespace pliant::sim
