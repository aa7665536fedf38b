#include "simulation/distributed/node_exchange.hpp"

#include <petscis.h>

#include <cmath>

namespace pliant::sim::distributed {
namespace {

/// Lends an array to a PETSc vector during its own lifetime.
class Lent {
public:
    Lent(Vec vector, const double* array) : vector_(vector) { must(VecPlaceArray(vector, array)); }
    Lent(const Lent&) = delete;
    Lent& operator=(const Lent&) = delete;
    ~Lent() { VecResetArray(vector_); }

private:
    Vec vector_;
};

}  // namespace

NodeExchange::NodeExchange(const Ranks& ranks, const Share& share)
    : ranks_(ranks), local_(static_cast<Eigen::Index>(share.number.size())), owned_(share.owned) {
    must(VecCreateMPIWithArray(ranks.comm(), 3, static_cast<PetscInt>(owned()), PETSC_DECIDE, nullptr, on_all_.fill()));
    must(VecCreateSeqWithArray(PETSC_COMM_SELF, 3, static_cast<PetscInt>(local()), nullptr, on_own_.fill()));
    Owned<IS, ISDestroy> numbers;
    must(ISCreateBlock(ranks.comm(), 3, static_cast<PetscInt>(local_), share.number.data(), PETSC_COPY_VALUES,
                       numbers.fill()));
    must(VecScatterCreate(on_all_.get(), numbers.get(), on_own_.get(), nullptr, way_.fill()));
}

Eigen::VectorXd NodeExchange::add_up(const Eigen::VectorXd& local) const {
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(owned());
    const Lent from(on_own_.get(), local.data());
    const Lent to(on_all_.get(), sums.data());
    must(VecScatterBegin(way_.get(), on_own_.get(), on_all_.get(), ADD_VALUES, SCATTER_REVERSE));
    must(VecScatterEnd(way_.get(), on_own_.get(), on_all_.get(), ADD_VALUES, SCATTER_REVERSE));
    return sums;
}

Eigen::VectorXd NodeExchange::with_ghosts(const Eigen::VectorXd& owned) const {
    Eigen::VectorXd local(this->local());
    const Lent from(on_all_.get(), owned.data());
    const Lent to(on_own_.get(), local.data());
    must(VecScatterBegin(way_.get(), on_all_.get(), on_own_.get(), INSERT_VALUES, SCATTER_FORWARD));
    must(VecScatterEnd(way_.get(), on_all_.get(), on_own_.get(), INSERT_VALUES, SCATTER_FORWARD));
    return local;
}

double NodeExchange::dot(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const {
    return ranks_.sum(a.dot(b));
}

double NodeExchange::norm(const Eigen::VectorXd& a) const {
    return std::sqrt(dot(a, a));
}

}  // namespace pliant::sim::distributed
