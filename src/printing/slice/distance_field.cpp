#include "printing/slice/distance_field.hpp"

#include <algorithm>

#include "base/core/parallel.hpp"

namespace pliant::slice {
namespace {

constexpr float far_away = 1e20F;

/// The lower envelope of parabolas over one line of cells: g(i) = min over j of f(j) + (step (i - j))^2, with f = 0 one
/// cell before the line and one after it.
class Line {
public:
    explicit Line(int count, double step)
        : count_(count),
          square_(step * step),
          f_(static_cast<std::size_t>(count) + 2),
          vertex_(f_.size()),
          border_(f_.size() + 1) {}

    template <class Get, class Set>
    void transform(const Get& get, const Set& set) {
        const int n = count_ + 2;
        f_.front() = f_.back() = 0;
        for (int i = 0; i < count_; ++i) f_[static_cast<std::size_t>(i) + 1] = get(i);
        int k = 0;
        vertex_[0] = 0;
        border_[0] = -1e30;
        border_[1] = 1e30;
        for (int q = 1; q < n; ++q) {
            double s = meet(q, vertex_[static_cast<std::size_t>(k)]);
            while (s <= border_[static_cast<std::size_t>(k)]) s = meet(q, vertex_[static_cast<std::size_t>(--k)]);
            ++k;
            vertex_[static_cast<std::size_t>(k)] = q;
            border_[static_cast<std::size_t>(k)] = s;
            border_[static_cast<std::size_t>(k) + 1] = 1e30;
        }
        k = 0;
        for (int q = 1; q + 1 < n; ++q) {
            while (border_[static_cast<std::size_t>(k) + 1] < q) ++k;
            const int v = vertex_[static_cast<std::size_t>(k)];
            const double way = q - v;
            set(q - 1, static_cast<float>(square_ * way * way + f_[static_cast<std::size_t>(v)]));
        }
    }

private:
    /// The intersection of the parabolas of two cells.
    [[nodiscard]] double meet(int q, int v) const {
        const double fq = f_[static_cast<std::size_t>(q)], fv = f_[static_cast<std::size_t>(v)];
        return ((fq + square_ * q * q) - (fv + square_ * v * v)) / (2 * square_ * (q - v));
    }

    int count_;
    double square_;
    std::vector<double> f_;
    std::vector<int> vertex_;
    std::vector<double> border_;
};

/// Of `count` cells, `step` apart from the first at `from`: keeps those that are marked, as both of their neighbours
/// are.
void keep_surrounded(std::vector<std::uint8_t>& cells, std::size_t from, std::size_t step, int count) {
    std::uint8_t before = 0;
    for (int i = 0; i < count; ++i, from += step) {
        const std::uint8_t here = cells[from], after = i + 1 < count ? cells[from + step] : 0;
        cells[from] = before != 0 && here != 0 && after != 0 ? 1 : 0;
        before = here;
    }
}

}  // namespace

std::vector<std::uint8_t> surrounded(const CellGrid& grid, std::vector<std::uint8_t> solid) {
    const std::size_t row = static_cast<std::size_t>(grid.nx), slab = row * static_cast<std::size_t>(grid.ny);
    for (int z = 0; z < grid.nz; ++z) {
        for (int y = 0; y < grid.ny; ++y) keep_surrounded(solid, grid.at(0, y, z), 1, grid.nx);
        for (int x = 0; x < grid.nx; ++x) keep_surrounded(solid, grid.at(x, 0, z), row, grid.ny);
    }
    for (int y = 0; y < grid.ny; ++y) {
        for (int x = 0; x < grid.nx; ++x) keep_surrounded(solid, grid.at(x, y, 0), slab, grid.nz);
    }
    return solid;
}

std::vector<float> squared_distances(const CellGrid& grid, const std::vector<std::uint8_t>& solid, double height) {
    std::vector<float> d(grid.size());
    for (std::size_t i = 0; i < d.size(); ++i) d[i] = solid[i] != 0 ? far_away : 0;
    const auto lines = [&](int outer, int inner, int count, double step, const auto& index) {
        parallel_for(static_cast<std::size_t>(outer), 1, [&](std::size_t begin, std::size_t end) {
            Line line(count, step);
            for (std::size_t o = begin; o < end; ++o) {
                for (int i = 0; i < inner; ++i)
                    line.transform([&](int c) { return d[index(static_cast<int>(o), i, c)]; },
                                   [&](int c, float value) { d[index(static_cast<int>(o), i, c)] = value; });
            }
        });
    };
    lines(grid.nz, grid.ny, grid.nx, 1, [&](int z, int y, int x) { return grid.at(x, y, z); });
    lines(grid.nz, grid.nx, grid.ny, 1, [&](int z, int x, int y) { return grid.at(x, y, z); });
    lines(grid.ny, grid.nx, grid.nz, height, [&](int y, int x, int z) { return grid.at(x, y, z); });
    return d;
}

}  // namespace pliant::slice
