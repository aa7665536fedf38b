#include "printing/slice/coverage.hpp"

#include <algorithm>
#include <cmath>

#include "printing/slice/raster_frame.hpp"

namespace pliant::slice {
namespace {

constexpr double steps = static_cast<double>(full_coverage);

std::int64_t to_steps(double amount) {
    return static_cast<std::int64_t>(amount < 0 ? amount - 0.5 : amount + 0.5);
}

constexpr auto by_key = [](const Cell& l, const Cell& r) { return l.key < r.key; };

/// For rows with only a few cells, nearly sorted.
void sort_row(Cell* begin, Cell* end) {
    for (Cell* i = begin + 1; i < end; ++i) {
        const Cell cell = *i;
        Cell* j = i;
        for (; j > begin && by_key(cell, j[-1]); --j) *j = j[-1];
        *j = cell;
    }
}

struct Range {
    int first;
    std::size_t count;
};

template <class Number>
Range range_of(const std::vector<Cell>& cells, const Number& number) {
    const auto [low, high] = std::minmax_element(cells.begin(), cells.end(),
                                                 [&](const Cell& l, const Cell& r) { return number(l) < number(r); });
    return {number(*low), static_cast<std::size_t>(number(*high) - number(*low)) + 1};
}

/// Counting sort of `from` into `to`, which keeps the order of cells with the same number. The ends of each number's
/// cells, from the lowest number on.
template <class Number>
std::vector<std::uint32_t> counted(const std::vector<Cell>& from, std::vector<Cell>& to, const Number& number) {
    const auto [first, count] = range_of(from, number);
    const auto place = [&, first = first](const Cell& c) { return static_cast<std::size_t>(number(c) - first); };
    std::vector<std::uint32_t> ends(count + 1, 0);
    for (const Cell& c : from) ++ends[place(c) + 1];
    for (std::size_t i = 1; i < ends.size(); ++i) ends[i] += ends[i - 1];
    for (const Cell& c : from) to[ends[place(c)]++] = c;
    ends.pop_back();
    return ends;
}

}  // namespace

std::vector<Segment> in_image(const std::vector<Segment>& segments, const Raster& raster, Beyond beyond) {
    const RasterFrame frame(raster, 1.0 / grid_per_um);
    const double width = raster.width_px, height = raster.height_px;
    const auto within = [&](double value, double most) {
        return beyond == Beyond::kept ? value : std::clamp(value, 0.0, most);
    };
    std::vector<Segment> lines;
    lines.reserve(segments.size());
    for (const Segment& s : segments) {
        const double u0 = within(frame.column(s.x0, s.y0), width);
        const double v0 = within(frame.row(s.x0, s.y0), height);
        const double u1 = within(frame.column(s.x1, s.y1), width);
        const double v1 = within(frame.row(s.x1, s.y1), height);
        lines.push_back(frame.mirrored() ? Segment{u1, v1, u0, v0} : Segment{u0, v0, u1, v1});
    }
    return lines;
}

void CellBuffer::add(int body, const std::vector<Segment>& lines) {
    body_ = static_cast<std::uint64_t>(body);
    for (const auto& [u0, v0, u1, v1] : lines) add_line(u0, v0, u1, v1);
}

/// Splits a line at row boundaries. Heights are whole steps from here on, so that they add up exactly.
void CellBuffer::add_line(double u0, double v0, double u1, double v1) {
    const std::int64_t from = to_steps(v0 * steps), to = to_steps(v1 * steps);
    if (from == to) return;
    const double slope = (u1 - u0) / static_cast<double>(to - from);
    const double low_u = std::min(u0, u1), high_u = std::max(u0, u1);
    const bool down = to > from;
    const std::int64_t first = down ? from : from - 1, last = down ? to - 1 : to;
    int row = static_cast<int>(first >> coverage_bits);
    const int last_row = static_cast<int>(last >> coverage_bits);
    double u = u0;
    std::int64_t v = from;
    for (; row != last_row; row += down ? 1 : -1) {
        const std::int64_t border = static_cast<std::int64_t>(down ? row + 1 : row) << coverage_bits;
        const double u_next = std::clamp(u0 + static_cast<double>(border - from) * slope, low_u, high_u);
        add_in_row(row, u, u_next, border - v);
        u = u_next;
        v = border;
    }
    add_in_row(row, u, u1, to - v);
}

/// Splits a piece inside one row of pixels at column boundaries.
void CellBuffer::add_in_row(int row, double u0, double u1, std::int64_t height) {
    const double low_u = std::min(u0, u1), high_u = std::max(u0, u1);
    const int first = static_cast<int>(low_u);
    const int last = static_cast<int>(std::ceil(high_u)) - 1;
    // Seen from above the solid is to the left of an outline, so in the image it is to the right of one that runs down.
    if (last <= first) return add_cell(row, first, height, (u0 + u1) / 2 - first);
    const double per_column = static_cast<double>(height) / (high_u - low_u);
    double left = low_u;
    std::int64_t done = 0;  // rounds the running sum, so that rounding errors do not accumulate
    for (int column = first; column < last; ++column) {
        const double right = column + 1;
        const std::int64_t so_far = to_steps((right - low_u) * per_column);
        add_cell(row, column, so_far - done, (left + right) / 2 - column);
        done = so_far;
        left = right;
    }
    add_cell(row, last, height - done, (left + high_u) / 2 - last);
}

/// `middle`: mean position of the piece in the pixel, 0 to 1 from its left side.
void CellBuffer::add_cell(int row, int column, std::int64_t cover, double middle) {
    const std::uint64_t key =
        (static_cast<std::uint64_t>(row) << 48) | (static_cast<std::uint64_t>(column) << 31) | body_;
    const std::int64_t area = to_steps(static_cast<double>(cover) * (1 - middle));
    if (!cells_.empty() && cells_.back().key == key) {
        cells_.back().cover += cover;
        cells_.back().area += area;
    } else {
        cells_.push_back({key, cover, area});
    }
}

const std::vector<Cell>& CellBuffer::sorted() {
    sorted_.resize(cells_.size());
    if (cells_.empty()) return sorted_;
    const auto row = [](const Cell& c) { return c.row(); };
    const auto column = [](const Cell& c) { return c.column(); };
    constexpr std::size_t few = 16;
    if (cells_.size() > few * range_of(cells_, row).count) {
        by_column_.resize(cells_.size());
        counted(cells_, by_column_, column);
        counted(by_column_, sorted_, row);  // of one row and column they are in the order of the bodies, as they came
        return sorted_;
    }
    std::uint32_t begin = 0;
    for (const std::uint32_t end : counted(cells_, sorted_, row)) {
        sort_row(sorted_.data() + begin, sorted_.data() + end);
        begin = end;
    }
    return sorted_;
}

}  // namespace pliant::slice
