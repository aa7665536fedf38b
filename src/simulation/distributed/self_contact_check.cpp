#include "simulation/distributed/self_contact_check.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "base/linalg/vectors.hpp"

namespace pliant::sim::distributed {

SelfContactCheck::SelfContactCheck(const DistributedEquilibrium& system, const std::optional<ContactRules>& rules)
    : system_(system) {
    const std::vector<int> nodes = gathered_numbers();
    const std::vector<double> rest = gathered(system.rest().x);
    if (rules && system.ranks().is_root()) make_surface(*rules, nodes, rest);
    looks_ = system.ranks().largest(surface_ != nullptr ? 1 : 0) > 0;
}

/// On root: indices in the whole mesh of the contact nodes, rank by rank.
std::vector<int> SelfContactCheck::gathered_numbers() {
    const Share& share = system_.share();
    std::vector<int> own;
    for (const int node : share.contact_nodes) own.push_back(share.node_in_file[static_cast<std::size_t>(node)]);
    const Ranks& ranks = system_.ranks();
    const auto count = static_cast<int>(own.size());
    counts_.resize(static_cast<std::size_t>(ranks.count()));
    must(MPI_Gather(&count, 1, MPI_INT, counts_.data(), 1, MPI_INT, 0, ranks.comm()));
    starts_.assign(counts_.size() + 1, 0);
    for (std::size_t r = 0; r < counts_.size(); ++r) starts_[r + 1] = starts_[r] + counts_[r];
    std::vector<int> all(ranks.is_root() ? static_cast<std::size_t>(starts_.back()) : 0);
    must(MPI_Gatherv(own.data(), count, MPI_INT, all.data(), counts_.data(), starts_.data(), MPI_INT, 0, ranks.comm()));
    for (int& n : counts_) n *= 3;
    for (int& n : starts_) n *= 3;
    return all;
}

/// The surface, with nodes in the order in which they are gathered.
void SelfContactCheck::make_surface(const ContactRules& rules, const std::vector<int>& nodes,
                                    const std::vector<double>& rest) {
    std::vector<std::pair<int, int>> place;  // (node, index when gathered)
    for (std::size_t k = 0; k < nodes.size(); ++k) place.emplace_back(nodes[k], static_cast<int>(k));
    std::ranges::sort(place);
    std::vector<std::array<int, 3>> triangles = rules.surface.triangles;
    for (auto& triangle : triangles)
        for (int& node : triangle) node = std::ranges::lower_bound(place, std::pair(node, -1))->second;
    contact::Settings settings = rules.settings;
    settings.self = true;
    auto made = contact::Contact::create(contact::make_surface(triangles), {}, settings, rest);
    if (!made) return;  // cannot happen: the settings come from the size of the robot
    crosses_at_rest_ = made->crossing_at_rest().has_value();
    if (!crosses_at_rest_) surface_ = std::make_unique<const contact::Contact>(std::move(*made));
}

std::vector<double> SelfContactCheck::gathered(const Eigen::VectorXd& x) const {
    std::vector<double> own;
    for (const int node : system_.share().contact_nodes)
        for (int c = 0; c < 3; ++c) own.push_back(x[3 * static_cast<Eigen::Index>(node) + c]);
    const Ranks& ranks = system_.ranks();
    std::vector<double> all(ranks.is_root() ? static_cast<std::size_t>(starts_.back()) : 0);
    must(MPI_Gatherv(own.data(), static_cast<int>(own.size()), MPI_DOUBLE, all.data(), counts_.data(), starts_.data(),
                     MPI_DOUBLE, 0, ranks.comm()));
    return all;
}

bool SelfContactCheck::meets(const Eigen::VectorXd& from, const Eigen::VectorXd& to) const {
    if (!looks_) return false;
    const std::vector<double> begin = gathered(from), end = gathered(to);
    int met = 0;
    if (surface_) {
        std::vector<double> motion(begin.size());
        for (std::size_t k = 0; k < begin.size(); ++k) motion[k] = end[k] - begin[k];
        met = surface_->meets(begin, motion) ? 1 : 0;
    }
    return system_.ranks().largest(met) > 0;
}

}  // namespace pliant::sim::distributed
