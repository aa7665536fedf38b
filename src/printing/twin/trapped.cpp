#include "printing/twin/trapped.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace pliant::twin {
namespace {

constexpr int half_cured = 128;

/// Union-find over numbers.
class Groups {
public:
    int add() {
        parent_.push_back(static_cast<int>(parent_.size()));
        return parent_.back();
    }
    int find(int i) {
        while (parent_[at(i)] != i) i = parent_[at(i)] = parent_[at(parent_[at(i)])];
        return i;
    }
    void join(int a, int b) { parent_[at(find(a))] = find(b); }
    [[nodiscard]] int size() const { return static_cast<int>(parent_.size()); }

private:
    static std::size_t at(int i) { return static_cast<std::size_t>(i); }
    std::vector<int> parent_;
};

/// Liquid pixels [begin, end) of a row.
struct Gap {
    int row = 0, begin = 0, end = 0;
    int group = 0;  ///< in its layer
    bool drains = false;
    int space = -1;  ///< space of a gap that does not drain
};

/// Solid pixels of all resins together.
Runs solid_of(const CuredLayer& layer, int width_px) {
    std::vector<Runs> parts;
    for (const VatLayer& vat : layer.vats) parts.push_back(vat.runs);
    Runs solid = parts.empty() ? Runs{} : sum_of(parts, width_px);
    std::erase_if(solid, [](const Run& run) { return run.value < half_cured; });
    return solid;
}

/// All gaps of a frame, row by row.
std::vector<Gap> gaps_of(const Runs& solid, int width_px, int height_px) {
    std::vector<Gap> gaps;
    std::size_t at = 0;
    for (int row = 0; row < height_px; ++row) {
        int begin = 0;
        for (; at < solid.size() && solid[at].row == row; ++at) {
            if (solid[at].begin > begin) gaps.push_back({row, begin, solid[at].begin});
            begin = solid[at].end;
        }
        if (begin < width_px) gaps.push_back({row, begin, width_px});
    }
    return gaps;
}

/// Calls `each(i, k)` for all pairs of gaps, of `a` in row r and of `b` in row r + `down`, with a common column.
template <class Each>
void overlapping(const std::vector<Gap>& a, const std::vector<Gap>& b, int down, Each each) {
    std::size_t first = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const int row = a[i].row + down;
        const auto before = [&](const Gap& g) { return g.row < row || (g.row == row && g.end <= a[i].begin); };
        while (first < b.size() && before(b[first])) ++first;
        for (std::size_t k = first; k < b.size() && b[k].row == row && b[k].begin < a[i].end; ++k) each(i, k);
    }
}

/// Finds the spaces that hold liquid, layer by layer from the lowest up.
class Finder {
public:
    Finder(int width_px, int height_px, double pixel_um)
        : width_(width_px), height_(height_px), pixel_mm2_(pixel_um * pixel_um / 1e6) {}

    void add(const CuredLayer& layer) {
        std::vector<Gap> gaps = gaps_of(solid_of(layer, width_), width_, height_);
        const std::vector<bool> drains = draining(gaps);
        for (Gap& gap : gaps) gap.drains = drains[static_cast<std::size_t>(gap.group)];
        join_spaces(gaps, layer);
        below_ = std::move(gaps);
        lowest_ = false;
    }

    std::vector<Trapped> result() {
        std::vector<Trapped> all;
        for (int i = 0; i < groups_.size(); ++i) {
            Trapped& whole = spaces_[static_cast<std::size_t>(groups_.find(i))];
            if (groups_.find(i) != i) merge(whole, spaces_[static_cast<std::size_t>(i)]);
        }
        for (int i = 0; i < groups_.size(); ++i) {
            if (groups_.find(i) == i) all.push_back(spaces_[static_cast<std::size_t>(i)]);
        }
        std::sort(all.begin(), all.end(), [](const Trapped& a, const Trapped& b) { return a.ml > b.ml; });
        return all;
    }

private:
    /// By group: whether it reaches the frame's border or is above one that drains.
    std::vector<bool> draining(std::vector<Gap>& gaps) const {
        Groups groups;
        for (std::size_t i = 0; i < gaps.size(); ++i) groups.add();
        overlapping(gaps, gaps, 1,
                    [&](std::size_t i, std::size_t k) { groups.join(static_cast<int>(i), static_cast<int>(k)); });
        std::vector<bool> drains(gaps.size());
        for (std::size_t i = 0; i < gaps.size(); ++i) {
            Gap& gap = gaps[i];
            gap.group = groups.find(static_cast<int>(i));
            const bool border = gap.row == 0 || gap.row == height_ - 1 || gap.begin == 0 || gap.end == width_;
            if (border || lowest_) drains[static_cast<std::size_t>(gap.group)] = true;
        }
        overlapping(gaps, below_, 0, [&](std::size_t i, std::size_t k) {
            if (below_[k].drains) drains[static_cast<std::size_t>(gaps[i].group)] = true;
        });
        return drains;
    }

    void join_spaces(std::vector<Gap>& gaps, const CuredLayer& layer) {
        std::vector<int> space_of(gaps.size(), -1);
        for (Gap& gap : gaps) {
            if (gap.drains) continue;
            int& space = space_of[static_cast<std::size_t>(gap.group)];
            if (space < 0) {
                space = groups_.add();
                spaces_.push_back({true, 0, layer.top_um - layer.thickness_um, layer.top_um, width_, 0, height_, 0});
            }
            gap.space = space;
            merge(spaces_[static_cast<std::size_t>(space)],
                  {true, (gap.end - gap.begin) * pixel_mm2_ * layer.thickness_um / 1e6,
                   layer.top_um - layer.thickness_um, layer.top_um, gap.begin, gap.end, gap.row, gap.row + 1});
        }
        overlapping(gaps, below_, 0, [&](std::size_t i, std::size_t k) {
            if (below_[k].drains) return;
            if (gaps[i].drains)
                spaces_[static_cast<std::size_t>(below_[k].space)].closed = false;
            else
                groups_.join(gaps[i].space, below_[k].space);
        });
    }

    static void merge(Trapped& whole, const Trapped& part) {
        whole.closed = whole.closed && part.closed;
        whole.ml += part.ml;
        whole.z_begin_um = std::min(whole.z_begin_um, part.z_begin_um);
        whole.z_end_um = std::max(whole.z_end_um, part.z_end_um);
        whole.x_begin_px = std::min(whole.x_begin_px, part.x_begin_px);
        whole.x_end_px = std::max(whole.x_end_px, part.x_end_px);
        whole.y_begin_px = std::min(whole.y_begin_px, part.y_begin_px);
        whole.y_end_px = std::max(whole.y_end_px, part.y_end_px);
    }

    int width_, height_;
    double pixel_mm2_;
    bool lowest_ = true;
    std::vector<Gap> below_;  ///< of the previous layer
    Groups groups_;           ///< of spaces
    std::vector<Trapped> spaces_;
};

}  // namespace

std::vector<Trapped> trapped_resin(const std::vector<CuredLayer>& layers, int width_px, int height_px,
                                   double pixel_um) {
    std::vector<const CuredLayer*> from_below;
    from_below.reserve(layers.size());
    for (const CuredLayer& layer : layers) from_below.push_back(&layer);
    std::sort(from_below.begin(), from_below.end(), [](auto* a, auto* b) { return a->top_um > b->top_um; });
    Finder finder(width_px, height_px, pixel_um);
    for (const CuredLayer* layer : from_below) finder.add(*layer);
    return finder.result();
}

}  // namespace pliant::twin
