#include "simulation/solver/factor_without_contact.hpp"

#include "base/core/parallel.hpp"
#include "simulation/solver/object_holds.hpp"

namespace pliant::sim {

const linalg::Cholesky* FactorWithoutContact::at(const std::shared_ptr<const SolverMemory::Tangent>& tangent) {
    if (!tangent || !is_quick()) return nullptr;
    if (of_ != tangent) {
        of_ = tangent;
        usable_ = factorise(*tangent, false) || factorise(*tangent, true);
    }
    return usable_ ? &*factor_ : nullptr;
}

bool FactorWithoutContact::is_quick() const {
    // Multiply-adds for each pair of nodes; an iteration on levels takes as long as some 6000 of them. The limit of
    // nodes is one of memory: a slender body of any size has a factor that is quickly made.
    constexpr double most_for_a_pair = 60000;
    constexpr int most_nodes = 30000;
    const linalg::SymmetricPattern& pattern = laplacian_->tangent_layout()->pattern;
    return pattern.nodes <= most_nodes &&
           27 * laplacian_->work() < most_for_a_pair * static_cast<double>(pattern.node_row.size());
}

/// Contact couples no nodes here, so the pattern, and with it the order of elimination, is that of the Laplacian. In
/// double precision: a light object that nothing holds moves far more easily than a surface yields.
bool FactorWithoutContact::factorise(const SolverMemory::Tangent& tangent, bool project) {
    const TangentLayout& layout = *laplacian_->tangent_layout();
    values_.resize(layout.pattern.entries());
    parallel_clear(values_.span());
    system_->add_tangent(tangent.state, tangent.controls, layout, values_.span(), project,
                         TangentParts::without_contact);
    add_object_holds(*system_, tangent.state, tangent.controls, layout, values_.span());
    if (!factor_) factor_.emplace(laplacian_->analysis(), 3, linalg::Precision::double_);
    return factor_->factorise(values_.span());
}

}  // namespace pliant::sim
