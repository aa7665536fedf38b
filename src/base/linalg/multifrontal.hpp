// Memory layout of a multifrontal factorisation, and which parts of it are independent.
#pragma once

#include <cstddef>
#include <vector>

#include "base/linalg/elimination.hpp"

namespace pliant::linalg {

/// Supernode s: its panel begins at panel[s] of the factor; its update (passed to its parent) at update[s] of the work
/// space or, inside a branch, of that branch's own work space. Branches are whole subtrees that may be processed in
/// parallel; the trunk is everything else, in order. The division depends on the pattern alone.
struct FrontLayout {
    std::vector<std::size_t> panel;   ///< (supernodes + 1)
    std::vector<std::size_t> update;  ///< (supernodes)
    std::size_t work_space = 0;
    std::size_t branch_space = 0;  ///< work space that is enough for any branch
    struct Branch {
        int first, last;  ///< supernodes first .. last - 1; the update of the last one is in the work space
    };
    std::vector<Branch> branches;
    std::vector<int> trunk;
    double work = 0;  ///< multiply-adds
};

/// Sizes and offsets are in entries, in whole packets of `packet` rows.
[[nodiscard]] FrontLayout lay_out(const Elimination& elimination, int block, int packet);

}  // namespace pliant::linalg
