#include "simulation/distributed/file_order.hpp"

#include <petscis.h>

namespace pliant::sim::distributed {

FileOrder::FileOrder(const Ranks& ranks, std::span<const int> numbers, int total)
    : ranks_(ranks), numbers_(numbers.begin(), numbers.end()), total_(total) {
    const auto begin = [&](int rank) { return static_cast<int>(static_cast<long long>(total) * rank / ranks.count()); };
    first_ = begin(ranks.own());
    rows_ = begin(ranks.own() + 1) - first_;
}

std::vector<double> FileOrder::sorted(std::span<const double> own, int width) const {
    return moved(own, width, false);
}

std::vector<double> FileOrder::given_back(std::span<const double> sorted, int width) const {
    return moved(sorted, width, true);
}

std::vector<double> FileOrder::moved(std::span<const double> from, int width, bool back) const {
    const auto own = static_cast<PetscInt>(numbers_.size()) * width;
    const PetscInt there = rows_ * width;
    std::vector<double> to(static_cast<std::size_t>(back ? own : there), 0.0);
    Owned<Vec, VecDestroy> at_home, in_file;
    must(
        VecCreateMPIWithArray(ranks_.comm(), width, own, PETSC_DECIDE, back ? to.data() : from.data(), at_home.fill()));
    must(VecCreateMPIWithArray(ranks_.comm(), width, there, PETSC_DECIDE, back ? from.data() : to.data(),
                               in_file.fill()));
    PetscInt begin = 0;
    must(VecGetOwnershipRange(at_home.get(), &begin, nullptr));
    Owned<IS, ISDestroy> from_home, to_file;
    must(ISCreateStride(ranks_.comm(), own, begin, 1, from_home.fill()));
    must(ISCreateBlock(ranks_.comm(), width, static_cast<PetscInt>(numbers_.size()), numbers_.data(), PETSC_COPY_VALUES,
                       to_file.fill()));
    Owned<VecScatter, VecScatterDestroy> way;
    must(VecScatterCreate(at_home.get(), from_home.get(), in_file.get(), to_file.get(), way.fill()));
    const Vec first = back ? in_file.get() : at_home.get(), last = back ? at_home.get() : in_file.get();
    const ScatterMode mode = back ? SCATTER_REVERSE : SCATTER_FORWARD;
    must(VecScatterBegin(way.get(), first, last, INSERT_VALUES, mode));
    must(VecScatterEnd(way.get(), first, last, INSERT_VALUES, mode));
    return to;
}

}  // namespace pliant::sim::distributed
