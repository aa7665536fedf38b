#include "base/linalg/elimination.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <utility>

#include "base/linalg/dissection.hpp"
#include "base/linalg/graph.hpp"

namespace pliant::linalg {
namespace {

/// Neighbours of each node, without itself.
Graph graph_of_pattern(const SymmetricPattern& pattern) {
    return graph_of(pattern.nodes, [&](const auto& use) {
        for (int j = 0; j < pattern.nodes; ++j) {
            for (int k = pattern.node_start[j] + 1; k < pattern.node_start[j + 1]; ++k) {
                use(j, pattern.node_row[k]);
                use(pattern.node_row[k], j);
            }
        }
    });
}

/// The rows i < j of each column j in a new order; `position` gives the new place of each node.
Graph upper_part(const SymmetricPattern& pattern, const std::vector<int>& position) {
    return graph_of(pattern.nodes, [&](const auto& use) {
        for (int j = 0; j < pattern.nodes; ++j) {
            for (int k = pattern.node_start[j] + 1; k < pattern.node_start[j + 1]; ++k) {
                const auto [low, high] = std::minmax(position[j], position[pattern.node_row[k]]);
                use(high, low);
            }
        }
    });
}

/// Liu's elimination tree, with path compression.
std::vector<int> elimination_tree(const Graph& upper) {
    const int n = static_cast<int>(upper.start.size()) - 1;
    std::vector<int> parent(n, -1);
    std::vector<int> ancestor(n, -1);
    for (int j = 0; j < n; ++j) {
        for (int k = upper.start[j]; k < upper.start[j + 1]; ++k) {
            int i = upper.other[k];
            while (ancestor[i] != -1 && ancestor[i] != j) i = std::exchange(ancestor[i], j);
            if (ancestor[i] == -1) parent[i] = ancestor[i] = j;
        }
    }
    return parent;
}

/// A postorder: each node directly follows its descendants.
std::vector<int> post_order(const std::vector<int>& parent) {
    const int n = static_cast<int>(parent.size());
    std::vector<int> child(n, -1);
    std::vector<int> sibling(n, -1);
    for (int j = n - 1; j >= 0; --j) {
        if (parent[j] >= 0) sibling[j] = std::exchange(child[parent[j]], j);
    }
    std::vector<int> order;
    order.reserve(n);
    std::vector<int> stack;
    for (int root = 0; root < n; ++root) {
        if (parent[root] >= 0) continue;
        stack.push_back(root);
        while (!stack.empty()) {
            const int j = stack.back();
            if (child[j] >= 0) {
                stack.push_back(std::exchange(child[j], sibling[child[j]]));
            } else {
                order.push_back(j);
                stack.pop_back();
            }
        }
    }
    return order;
}

/// The rows i > j of each column j.
Graph transposed(const Graph& upper) {
    return graph_of(upper.nodes(), [&](const auto& use) {
        for (int i = 0; i < upper.nodes(); ++i) {
            for (int k = upper.start[i]; k < upper.start[i + 1]; ++k) use(upper.other[k], i);
        }
    });
}

/// The smallest descendant of each column, or itself. Precondition: children come before parents.
std::vector<int> first_descendants(const std::vector<int>& parent) {
    std::vector<int> first(parent.size());
    std::iota(first.begin(), first.end(), 0);
    for (std::size_t j = 0; j < parent.size(); ++j) {
        if (parent[j] >= 0) first[parent[j]] = std::min(first[parent[j]], first[j]);
    }
    return first;
}

/// For each column, its lowest ancestor that is not closed yet: where its path to the root meets that of the current
/// column.
class OpenAncestors {
public:
    explicit OpenAncestors(std::size_t columns) : up_(columns) { std::iota(up_.begin(), up_.end(), 0); }
    void close(int column, int parent) { up_[column] = parent; }
    /// Compresses the path.
    [[nodiscard]] int lowest(int column) {
        int top = column;
        while (up_[top] != top) top = up_[top];
        while (column != top) column = std::exchange(up_[column], top);
        return top;
    }

private:
    std::vector<int> up_;
};

/// Entries of each column of the factor, without the diagonal (Gilbert, Ng and Peyton 1994). Row i fills the subtree of
/// the columns in which it has an entry, up to i: 1 more from each leaf on, 1 less where two paths meet, and none from
/// i on. Precondition: descendants directly precede each column.
std::vector<int> column_counts(const Graph& upper, const std::vector<int>& parent) {
    const Graph lower = transposed(upper);
    const std::vector<int> first = first_descendants(parent);
    std::vector<int> count(parent.size(), 0);  // at first, the excess of each column over the sum of its children
    std::vector<int> last_leaf(parent.size(), -1);
    OpenAncestors ancestors(parent.size());
    for (int j = 0; j < lower.nodes(); ++j) {
        for (int k = lower.start[j]; k < lower.start[j + 1]; ++k) {
            int& leaf = last_leaf[lower.other[k]];
            if (leaf >= first[j]) continue;  // the path of that leaf includes j
            const int before = std::exchange(leaf, j);
            ++count[j];
            if (before >= 0) --count[ancestors.lowest(before)];
        }
        if (upper.degree(j) > 0) --count[j];
        if (parent[j] >= 0) ancestors.close(j, parent[j]);
    }
    for (std::size_t j = 0; j < parent.size(); ++j) {
        if (parent[j] >= 0) count[parent[j]] += count[j];
    }
    return count;
}

/// A range of columns stored together.
struct Run {
    int first, last;   ///< columns first .. last
    int below;         ///< rows below
    double zeros = 0;  ///< explicit zeros, in entries of the nodes' matrix
};

/// True if the fraction of zeros is below what its width allows; the overhead of narrow supernodes exceeds the cost of
/// zeros.
bool worth_merging(const Run& run, int block) {
    const double columns = run.last - run.first;
    const double stored = columns * (columns + 1) / 2 + columns * run.below;
    const double unknowns = columns * block;
    const double allowed = unknowns <= 24 ? 0.4 : unknowns <= 48 ? 0.2 : unknowns <= 96 ? 0.08 : 0.02;
    return run.zeros <= allowed * stored;
}

/// Chains of columns in the tree, merged from the leaves up.
std::vector<Run> supernodes(const std::vector<int>& parent, const std::vector<int>& count, int block) {
    std::vector<Run> runs;
    for (int j = 0; j < static_cast<int>(parent.size()); ++j) {
        Run run{j, j + 1, count[j]};
        while (!runs.empty() && parent[runs.back().last - 1] >= 0 && parent[runs.back().last - 1] < run.last) {
            const Run& child = runs.back();
            Run merged{child.first, run.last, run.below, child.zeros + run.zeros};
            merged.zeros +=
                static_cast<double>(child.last - child.first) * (run.last - run.first + run.below - child.below);
            if (!worth_merging(merged, block)) break;
            run = merged;
            runs.pop_back();
        }
        runs.push_back(run);
    }
    return runs;
}

/// Fills the rows below each supernode: those of its columns and of its children.
void fill_rows(const Graph& upper, const std::vector<int>& tree, Elimination& e) {
    const int count = static_cast<int>(e.first.size()) - 1;
    std::vector<int> supernode_of(tree.size());
    for (int s = 0; s < count; ++s) std::fill_n(supernode_of.begin() + e.first[s], e.columns(s), s);
    std::vector<std::vector<int>> rows(count);
    for (int i = 0; i < static_cast<int>(tree.size()); ++i) {
        for (int k = upper.start[i]; k < upper.start[i + 1]; ++k) {
            const int s = supernode_of[upper.other[k]];
            if (i >= e.first[s + 1] && (rows[s].empty() || rows[s].back() != i)) rows[s].push_back(i);
        }
    }
    e.parent.assign(count, -1);
    e.row_start.assign(1, 0);
    std::vector<int> together;
    for (int s = 0; s < count; ++s) {
        // Complete at this point, because all children came before.
        e.row.insert(e.row.end(), rows[s].begin(), rows[s].end());
        e.row_start.push_back(static_cast<int>(e.row.size()));
        if (rows[s].empty()) continue;
        const int p = e.parent[s] = supernode_of[rows[s].front()];
        const auto passed_on = std::lower_bound(rows[s].begin(), rows[s].end(), e.first[p + 1]);
        together.clear();
        std::set_union(rows[p].begin(), rows[p].end(), passed_on, rows[s].end(), std::back_inserter(together));
        rows[p].swap(together);
        std::vector<int>().swap(rows[s]);
    }
}

}  // namespace

Elimination eliminate(const SymmetricPattern& pattern) {
    Elimination e;
    e.position = dissect(graph_of_pattern(pattern), pattern.points);
    const std::vector<int> order = post_order(elimination_tree(upper_part(pattern, e.position)));
    std::vector<int> moved(order.size());
    for (std::size_t k = 0; k < order.size(); ++k) moved[order[k]] = static_cast<int>(k);
    for (int& p : e.position) p = moved[p];

    const Graph upper = upper_part(pattern, e.position);
    const std::vector<int> tree = elimination_tree(upper);
    e.first.push_back(0);
    for (const Run& run : supernodes(tree, column_counts(upper, tree), pattern.block)) e.first.push_back(run.last);
    fill_rows(upper, tree, e);
    return e;
}

}  // namespace pliant::linalg
