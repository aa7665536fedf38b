#include "base/linalg/coarse_space.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/core/parallel.hpp"
#include "base/linalg/rigid_motions.hpp"

namespace pliant::linalg {
namespace {

constexpr int modes = RigidMotions::count;
constexpr std::size_t coarsening_grain = 512;  // nodes, or groups, per parallel piece
constexpr std::size_t restricting_pieces = 8;
constexpr std::size_t least_multiplied = 16, multiplying_pieces = 64;  // each has work space for all nodes

using Block36 = Eigen::Matrix<float, 3, modes>;
using Block33 = Eigen::Matrix3f;

Eigen::Map<Block36> block36(const AlignedArray<float>& values, std::size_t entry) {
    return Eigen::Map<Block36>(values.data() + 18 * entry);
}

/// A set of indices below `count` that is emptied in constant time.
class Seen {
public:
    explicit Seen(int count) : mark_(static_cast<std::size_t>(count), -1) {}
    /// True at the first call with `index` in a given `round`.
    bool is_new(int index, int round) { return std::exchange(mark_[index], round) != round; }

private:
    std::vector<int> mark_;
};

}  // namespace

CoarseSpace::CoarseSpace(const SymmetricBlocks& matrix) : CoarseSpace(matrix, matrix.neighbours()) {}

CoarseSpace::CoarseSpace(const SymmetricBlocks& matrix, const Lists& neighbours)
    : groups_(aggregate({neighbours.start, neighbours.item})), members_(members_of(groups_.of_node, groups_.count)) {
    find_groups(neighbours);
    find_pattern(matrix);
    const auto nodes = static_cast<std::size_t>(matrix.nodes());
    rigid_.resize(18 * nodes);
    prolongation_.resize(18 * moving_.item.size());
    dropped_.resize(static_cast<std::size_t>(groups_.count) * modes);
}

void CoarseSpace::find_groups(const Lists& neighbours) {
    moving_ = make_lists(neighbours.count(), [&] {
        return [&, seen = Seen(groups_.count)](int i, std::vector<int>& row) mutable {
            const auto begin = static_cast<std::ptrdiff_t>(row.size());
            for (const int j : neighbours[static_cast<std::size_t>(i)]) {
                const int group = groups_.of_node[j];
                if (seen.is_new(group, i)) row.push_back(group);
            }
            std::sort(row.begin() + begin, row.end());
        };
    });
    use_start_ = members_of(moving_.item, groups_.count).start;
    use_.resize(moving_.item.size());
    std::vector<int> next(use_start_.begin(), use_start_.end() - 1);
    for (int i = 0; i < neighbours.count(); ++i) {
        for (int e = moving_.start[i]; e < moving_.start[i + 1]; ++e) use_[next[moving_.item[e]]++] = {i, e};
    }
}

std::span<const MotionUse> CoarseSpace::uses(std::size_t group) const {
    return std::span(use_).subspan(static_cast<std::size_t>(use_start_[group]),
                                   static_cast<std::size_t>(use_start_[group + 1] - use_start_[group]));
}

void CoarseSpace::find_pattern(const SymmetricBlocks& matrix) {
    // For each group, the later ones that move a node on which it exerts a force.
    const Lists later = make_lists(groups_.count, [&] {
        return [&, seen = Seen(groups_.count), reached = Seen(matrix.nodes())](int g, std::vector<int>& row) mutable {
            const auto begin = static_cast<std::ptrdiff_t>(row.size());
            visit_reached(matrix, static_cast<std::size_t>(g), [&](int j) {
                if (!reached.is_new(j, g)) return;
                for (const int h : moving_[static_cast<std::size_t>(j)]) {
                    if (h > g && seen.is_new(h, g)) row.push_back(h);
                }
            });
            std::sort(row.begin() + begin, row.end());
        };
    });
    pattern_.block = 3;
    pattern_.nodes = 2 * groups_.count;
    pattern_.node_start.assign(1, 0);
    for (int g = 0; g < groups_.count; ++g) {
        for (const int half : {0, 1}) {
            if (half == 0) pattern_.node_row.push_back(2 * g);
            pattern_.node_row.push_back(2 * g + 1);
            for (const int h : later[static_cast<std::size_t>(g)])
                pattern_.node_row.insert(pattern_.node_row.end(), {2 * h, 2 * h + 1});
            pattern_.node_start.push_back(static_cast<int>(pattern_.node_row.size()));
        }
    }
    coarse_.resize(pattern_.entries());
}

void CoarseSpace::set(const Fine& fine) {
    positions_.assign(fine.positions.begin(), fine.positions.end());
    (void)turn_back();
    set_rigid_motions(fine.positions);
    smooth(fine.matrix, fine.inverse_diagonal, fine.damping);
    multiply(fine.matrix);
}

/// Translations, and rotations about the centre of each group, orthonormalised.
void CoarseSpace::set_rigid_motions(std::span<const double> positions) {
    parallel_for(static_cast<std::size_t>(groups_.count), coarsening_grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t g = begin; g < end; ++g) {
            const RigidMotions motions(members_[g], positions);
            for (int c = 0; c < modes; ++c) dropped_[g * modes + c] = motions.dropped(c) ? 1 : 0;
            for (const int i : members_[g])
                block36(rigid_, static_cast<std::size_t>(i)) = motions.at(positions, i).cast<float>();
        }
    });
}

/// P = (1 - damping D^-1 A) rigid motions.
void CoarseSpace::smooth(const SymmetricBlocks& matrix, const float* inverse_diagonal, float damping) {
    const auto nodes = static_cast<std::size_t>(matrix.nodes());
    const LowerTriangle m = matrix.triangle();
    const auto block = [&](int pair) {
        return Eigen::Map<const Block33>(m.value + 9 * static_cast<std::size_t>(pair));
    };
    parallel_for(nodes, coarsening_grain, [&](std::size_t begin, std::size_t end) {
        std::vector<int> slot(static_cast<std::size_t>(groups_.count));
        for (std::size_t i = begin; i < end; ++i) {
            for (int e = moving_.start[i]; e < moving_.start[i + 1]; ++e) {
                slot[moving_.item[e]] = e;
                block36(prolongation_, static_cast<std::size_t>(e)).setZero();
            }
            const auto sum = [&](int j) {
                return block36(prolongation_, static_cast<std::size_t>(slot[groups_.of_node[j]]));
            };
            for (int e = m.left_start[i]; e < m.left_start[i + 1]; ++e) {
                const int j = m.left_column[e];
                sum(j).noalias() += block(m.left_pair[e]) * block36(rigid_, static_cast<std::size_t>(j));
            }
            for (int k = m.start[i]; k < m.start[i + 1]; ++k) {
                const int j = m.row[k];
                sum(j).noalias() += block(k).transpose() * block36(rigid_, static_cast<std::size_t>(j));
            }
            const Block33 step = -damping * Eigen::Map<const Block33>(inverse_diagonal + 9 * i);
            for (int e = moving_.start[i]; e < moving_.start[i + 1]; ++e) {
                auto motions = block36(prolongation_, static_cast<std::size_t>(e));
                motions = (step * motions).eval();
                if (moving_.item[e] == groups_.of_node[i]) motions += block36(rigid_, i);
            }
        }
    });
}

/// P^T A P: for each group A times its motions, a force on every node in reach, and the work of these forces on the
/// motions of this group and the later ones.
void CoarseSpace::multiply(const SymmetricBlocks& matrix) {
    const auto groups = static_cast<std::size_t>(groups_.count);
    const GroupMotions motions{moving_.start.data(), moving_.item.data(), prolongation_.data()};
    const std::size_t groups_at_once =
        std::max(least_multiplied, (groups + multiplying_pieces - 1) / multiplying_pieces);
    parallel_for(groups, groups_at_once, [&](std::size_t begin, std::size_t end) {
        std::vector<int> place_of_group(groups), place_of_node(groups_.of_node.size(), -1), reached;
        std::vector<double> forces, sums;
        for (std::size_t g = begin; g < end; ++g) {
            visit_reached(matrix, g, [&](int j) {
                int& place = place_of_node[static_cast<std::size_t>(j)];
                if (place >= 0) return;
                place = static_cast<int>(reached.size());
                reached.push_back(j);
            });
            forces.assign(3 * modes_stored * reached.size(), 0);
            add_forces_of_group(matrix.triangle(), motions, uses(g), place_of_node.data(), forces.data());
            const int first = pattern_.node_start[2 * g];
            const int partners = (pattern_.node_start[2 * g + 1] - first) / 2;  // itself and later ones
            for (int p = 0; p < partners; ++p) place_of_group[pattern_.node_row[first + 2 * p] / 2] = p;
            sums.assign(modes * modes_stored * static_cast<std::size_t>(partners), 0);
            add_products_with_groups(motions, reached, forces.data(), static_cast<int>(g), place_of_group.data(),
                                     sums.data());
            for (int m = 0; m < modes; ++m) {
                if (dropped_[g * modes + m]) sums[modes_stored * m + m] = 1;
            }
            put(g, sums);
            for (const int j : reached) place_of_node[static_cast<std::size_t>(j)] = -1;
            reached.clear();
        }
    });
}

/// Stores the columns of a group in the pattern, which has two nodes for each. sums (partners, 6 of the partner,
/// modes_stored of the group).
void CoarseSpace::put(std::size_t group, std::span<const double> sums) {
    using Sum = Eigen::Matrix<double, modes, modes_stored, Eigen::RowMajor>;
    for (std::size_t p = 0; p < sums.size() / Sum::SizeAtCompileTime; ++p) {
        const Eigen::Map<const Sum> sum(sums.data() + p * Sum::SizeAtCompileTime);
        for (const int half : {0, 1}) {
            for (const int row : {0, 1}) {
                if (p == 0 && row < half) continue;
                // The second node of a group begins with its own diagonal, so it has one pair less than the first.
                const std::size_t pair =
                    static_cast<std::size_t>(pattern_.node_start[2 * group + half]) + 2 * p + row - half;
                Eigen::Map<Eigen::Matrix3d>(coarse_.data() + 9 * pair) = sum.block<3, 3>(3 * row, 3 * half);
            }
        }
    }
}

bool CoarseSpace::turn(std::span<const double> positions) {
    parallel_for(turns_.size(), coarsening_grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t g = begin; g < end; ++g)
            turns_[g] = rotation_between(members_[g], positions_, positions).cast<float>();
    });
    return true;
}

bool CoarseSpace::turn_back() {
    turns_.assign(static_cast<std::size_t>(groups_.count), Block33::Identity());
    return true;
}

/// Node by node, the order of P in memory. Each piece of the nodes has its own sums, which are then added in order.
void CoarseSpace::restrict(const float* fine, double* coarse) {
    const std::size_t nodes = groups_.of_node.size(), size = modes * static_cast<std::size_t>(groups_.count);
    const std::size_t piece = (nodes + restricting_pieces - 1) / restricting_pieces;
    sums_.assign(restricting_pieces * size, 0.0F);
    parallel_for(nodes, piece, [&](std::size_t begin, std::size_t end) {
        float* sums = sums_.data() + begin / piece * size;
        for (std::size_t i = begin; i < end; ++i) {
            const Eigen::Vector3f turned_back = turns_[static_cast<std::size_t>(groups_.of_node[i])].transpose() *
                                                Eigen::Map<const Eigen::Vector3f>(fine + 3 * i);
            for (int e = moving_.start[i]; e < moving_.start[i + 1]; ++e)
                Eigen::Map<Eigen::Matrix<float, modes, 1>>(sums + modes * static_cast<std::size_t>(moving_.item[e]))
                    .noalias() += block36(prolongation_, static_cast<std::size_t>(e)).transpose() * turned_back;
        }
    });
    parallel_for(size, 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            coarse[k] = 0;
            for (std::size_t p = 0; p < restricting_pieces; ++p) coarse[k] += sums_[p * size + k];
        }
    });
}

void CoarseSpace::add_prolonged(const double* coarse, float* fine) const {
    using Motions = Eigen::Map<const Eigen::Matrix<double, modes, 1>>;
    parallel_for(groups_.of_node.size(), coarsening_grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            Eigen::Vector3f motion = Eigen::Vector3f::Zero();
            for (int e = moving_.start[i]; e < moving_.start[i + 1]; ++e)
                motion.noalias() += block36(prolongation_, static_cast<std::size_t>(e)) *
                                    Motions(coarse + modes * static_cast<std::size_t>(moving_.item[e])).cast<float>();
            Eigen::Map<Eigen::Vector3f>(fine + 3 * i).noalias() +=
                turns_[static_cast<std::size_t>(groups_.of_node[i])] * motion;
        }
    });
}

}  // namespace pliant::linalg
