#include "base/linalg/multifrontal.hpp"

#include <algorithm>
#include <map>

namespace pliant::linalg {
namespace {

/// Subtrees are split until none exceeds this fraction of the work.
constexpr double branch_share = 1.0 / 24;

/// Allocates pieces of a work space; first fit.
class Shelf {
public:
    [[nodiscard]] std::size_t take(std::size_t size) {
        for (auto it = free_.begin(); it != free_.end(); ++it) {
            if (it->second < size) continue;
            const auto [at, room] = *it;
            free_.erase(it);
            if (room > size) free_[at + size] = room - size;
            return at;
        }
        // The last free piece may reach the end: then it can grow.
        if (!free_.empty()) {
            const auto last = std::prev(free_.end());
            if (last->first + last->second == end_) {
                const std::size_t at = last->first;
                free_.erase(last);
                return extend(at, size);
            }
        }
        return extend(end_, size);
    }
    void give_back(std::size_t at, std::size_t size) {
        if (size == 0) return;
        auto it = free_.emplace(at, size).first;
        if (const auto next = std::next(it); next != free_.end() && it->first + it->second == next->first) {
            it->second += next->second;
            free_.erase(next);
        }
        if (it == free_.begin()) return;
        if (const auto before = std::prev(it); before->first + before->second == it->first) {
            before->second += it->second;
            free_.erase(it);
        }
    }
    /// One past the last entry ever allocated.
    [[nodiscard]] std::size_t top() const { return top_; }

private:
    std::size_t extend(std::size_t at, std::size_t size) {
        end_ = at + size;
        top_ = std::max(top_, end_);
        return at;
    }
    std::map<std::size_t, std::size_t> free_;
    std::size_t end_ = 0;
    std::size_t top_ = 0;
};

class Layout {
public:
    Layout(const Elimination& e, int block, int packet) : e_(e), block_(block), packet_(packet) {
        first_child_.assign(e.supernodes(), 0);
        for (int s = 0; s < e.supernodes(); ++s) first_child_[s] = s;
        for (int s = 0; s < e.supernodes(); ++s) {
            if (e.parent[s] >= 0) first_child_[e.parent[s]] = std::min(first_child_[e.parent[s]], first_child_[s]);
        }
    }

    FrontLayout make() {
        place_panels();
        cut();
        place_updates();
        return std::move(layout_);
    }

private:
    [[nodiscard]] std::size_t padded(int nodes) const {
        return static_cast<std::size_t>((nodes * block_ + packet_ - 1) / packet_ * packet_);
    }
    [[nodiscard]] std::size_t update_size(int s) const {
        return padded(e_.rows_below(s)) * static_cast<std::size_t>(e_.rows_below(s) * block_);
    }

    void place_panels() {
        layout_.panel.assign(1, 0);
        work_.assign(e_.supernodes(), 0);
        for (int s = 0; s < e_.supernodes(); ++s) {
            const double columns = e_.columns(s) * block_;
            const double below = e_.rows_below(s) * block_;
            layout_.panel.push_back(layout_.panel.back() + (padded(e_.columns(s)) + padded(e_.rows_below(s))) *
                                                               static_cast<std::size_t>(columns));
            const double own = columns * (columns * columns / 6 + columns * below / 2 + below * below / 2);
            layout_.work += own;
            work_[s] += own;
            if (e_.parent[s] >= 0) work_[e_.parent[s]] += work_[s];
        }
    }

    /// first_child_[s] is the first supernode of the subtree of s, whose last one is s.
    void cut() {
        for (int s = e_.supernodes() - 1; s >= 0; --s) {
            if (work_[s] > branch_share * layout_.work) {
                layout_.trunk.push_back(s);
            } else {
                layout_.branches.push_back({first_child_[s], s + 1});
                s = first_child_[s];
            }
        }
        std::reverse(layout_.trunk.begin(), layout_.trunk.end());
        std::reverse(layout_.branches.begin(), layout_.branches.end());
    }

    /// An update is freed once its parent has used it.
    void place_updates() {
        layout_.update.assign(e_.supernodes(), 0);
        std::vector<std::vector<int>> children(e_.supernodes());
        for (int s = 0; s < e_.supernodes(); ++s) {
            if (e_.parent[s] >= 0) children[e_.parent[s]].push_back(s);
        }
        const auto place = [&](int s, Shelf& own, Shelf& of_children) {
            layout_.update[s] = own.take(update_size(s));
            for (const int child : children[s]) of_children.give_back(layout_.update[child], update_size(child));
        };
        Shelf whole;
        for (const auto& branch : layout_.branches) {
            Shelf inside;
            for (int s = branch.first; s + 1 < branch.last; ++s) place(s, inside, inside);
            place(branch.last - 1, whole, inside);
            layout_.branch_space = std::max(layout_.branch_space, inside.top());
        }
        for (const int s : layout_.trunk) place(s, whole, whole);
        layout_.work_space = whole.top();
    }

    const Elimination& e_;
    int block_, packet_;
    std::vector<int> first_child_;
    std::vector<double> work_;
    FrontLayout layout_;
};

}  // namespace

FrontLayout lay_out(const Elimination& elimination, int block, int packet) {
    return Layout(elimination, block, packet).make();
}

}  // namespace pliant::linalg
