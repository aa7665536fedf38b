// Where everything lies in the memory of a multifrontal factorisation, and which parts of it are independent.
#pragma once

#include <cstddef>
#include <vector>

#include "base/linalg/elimination.hpp"

namespace pliant::linalg {

/// Supernode s: its panel begins at panel[s] of the factor, its update (what it hands to its parent) at update[s] of
/// the work space or, inside a branch, of the space that whoever works on the branch has for it. Branches are whole
/// subtrees that may be worked on at the same time; the trunk is everything else, in order. What is in which depends on
/// the pattern alone.
struct FrontLayout {
    std::vector<std::size_t> panel;   ///< (supernodes + 1)
    std::vector<std::size_t> update;  ///< (supernodes)
    std::size_t work_space = 0;
    std::size_t branch_space = 0;  ///< enough for any branch
    struct Branch {
        int first, last;  ///< supernodes first .. last - 1; the update of the last one is in the work space
    };
    std::vector<Branch> branches;
    std::vector<int> trunk;
    double work = 0;  ///< multiply-adds
};

/// Sizes and places are in entries, in whole packets of `packet` rows.
[[nodiscard]] FrontLayout lay_out(const Elimination& elimination, int block, int packet);

}  // namespace pliant::linalg
