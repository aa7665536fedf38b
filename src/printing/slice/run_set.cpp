#include "printing/slice/run_set.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pliant::slice {
namespace {

/// Sorts spans and merges adjacent ones.
void merge(std::vector<PixelSpan>& spans) {
    std::sort(spans.begin(), spans.end(), [](const PixelSpan& l, const PixelSpan& r) { return l.begin < r.begin; });
    std::size_t count = 0;
    for (const PixelSpan& s : spans) {
        if (count > 0 && s.begin <= spans[count - 1].end) {
            spans[count - 1].end = std::max(spans[count - 1].end, s.end);
        } else {
            spans[count++] = s;
        }
    }
    spans.resize(count);
}

std::vector<PixelSpan> common_row(std::span<const PixelSpan> a, std::span<const PixelSpan> b) {
    std::vector<PixelSpan> result;
    for (auto i = a.begin(), j = b.begin(); i != a.end() && j != b.end();) {
        const PixelSpan both{std::max(i->begin, j->begin), std::min(i->end, j->end)};
        if (both.begin < both.end) result.push_back(both);
        if (i->end < j->end) {
            ++i;
        } else {
            ++j;
        }
    }
    return result;
}

std::vector<PixelSpan> without_row(std::span<const PixelSpan> a, std::span<const PixelSpan> b) {
    std::vector<PixelSpan> result;
    auto j = b.begin();
    for (PixelSpan s : a) {
        while (j != b.end() && j->end <= s.begin) ++j;
        for (auto hole = j; hole != b.end() && hole->begin < s.end; ++hole) {
            if (s.begin < hole->begin) result.push_back({s.begin, hole->begin});
            s.begin = std::max(s.begin, std::min(hole->end, s.end));
        }
        if (s.begin < s.end) result.push_back(s);
    }
    return result;
}

/// Dilates by `brush`: entry i is `i - above` rows below a pixel and extends from -left to +right.
struct Brush {
    struct Row {
        int left, right;
    };
    int above = 0;
    std::vector<Row> rows;
};

RunSet painted(const RunSet& set, const Brush& brush) {
    RunSet result(set.width_px(), set.height_px());
    const int below = static_cast<int>(brush.rows.size()) - 1 - brush.above;
    const int first = std::max(0, set.first_row() - brush.above);
    const int end = std::min(set.height_px(), set.end_row() + below);
    for (int row = first; row < end; ++row) {
        std::vector<PixelSpan> spans;
        const int from = std::max(0, row + brush.above - (set.end_row() - 1));
        const int to = std::min(static_cast<int>(brush.rows.size()), row + brush.above - set.first_row() + 1);
        for (int i = from; i < to; ++i) {
            const auto [left, right] = brush.rows[static_cast<std::size_t>(i)];
            for (const PixelSpan& s : set.row(row - i + brush.above))
                spans.push_back({std::max(0, s.begin - left), std::min(set.width_px(), s.end + right)});
        }
        merge(spans);
        result.append_row(row, std::move(spans));
    }
    return result;
}

}  // namespace

RunSet RunSet::lit(const RunImage& image) {
    RunSet set(image.width_px(), image.height_px());
    for (int row = image.first_row(); row < image.end_row(); ++row) {
        std::vector<PixelSpan> spans;
        for (const Run& run : image.row(row)) spans.push_back({run.begin, run.end});
        merge(spans);
        set.append_row(row, std::move(spans));
    }
    return set;
}

std::span<const PixelSpan> RunSet::row(int row) const {
    if (row < first_row_ || row >= end_row()) return {};
    return rows_[static_cast<std::size_t>(row - first_row_)];
}

std::int64_t RunSet::pixels() const {
    std::int64_t sum = 0;
    for (const auto& row : rows_) {
        for (const PixelSpan& s : row) sum += s.end - s.begin;
    }
    return sum;
}

void RunSet::append_row(int row, std::vector<PixelSpan> spans) {
    if (spans.empty()) return;
    if (rows_.empty()) first_row_ = row;
    rows_.resize(static_cast<std::size_t>(row - first_row_) + 1);
    rows_.back() = std::move(spans);
}

RunSet united(const RunSet& a, const RunSet& b) {
    if (a.first_row() == a.end_row()) return b;
    if (b.first_row() == b.end_row()) return a;
    RunSet result(a.width_px(), a.height_px());
    for (int row = std::min(a.first_row(), b.first_row()); row < std::max(a.end_row(), b.end_row()); ++row) {
        std::vector<PixelSpan> spans(a.row(row).begin(), a.row(row).end());
        spans.insert(spans.end(), b.row(row).begin(), b.row(row).end());
        merge(spans);
        result.append_row(row, std::move(spans));
    }
    return result;
}

RunSet common(const RunSet& a, const RunSet& b) {
    RunSet result(a.width_px(), a.height_px());
    for (int row = a.first_row(); row < a.end_row(); ++row) result.append_row(row, common_row(a.row(row), b.row(row)));
    return result;
}

RunSet without(const RunSet& a, const RunSet& b) {
    RunSet result(a.width_px(), a.height_px());
    for (int row = a.first_row(); row < a.end_row(); ++row) result.append_row(row, without_row(a.row(row), b.row(row)));
    return result;
}

RunSet complement(const RunSet& set) {
    RunSet result(set.width_px(), set.height_px());
    const PixelSpan all{0, set.width_px()};
    for (int row = 0; row < set.height_px(); ++row)
        result.append_row(row, without_row(std::span(&all, 1), set.row(row)));
    return result;
}

RunSet grown(const RunSet& set, int radius_px) {
    if (radius_px <= 0) return set;
    Brush disc{radius_px, {}};
    const double square = static_cast<double>(radius_px) * radius_px;
    for (int dy = -radius_px; dy <= radius_px; ++dy) {
        const int half = static_cast<int>(std::sqrt(square - static_cast<double>(dy) * dy));
        disc.rows.push_back({half, half});
    }
    return painted(set, disc);
}

RunSet shrunk(const RunSet& set, int radius_px) {
    return radius_px <= 0 ? set : without(set, grown(complement(set), radius_px));
}

RunSet reaching(const RunSet& set, const Reach& reach) {
    // A pixel with the set to its left is to the right of the set, so the brush is the reach mirrored.
    const auto rows = static_cast<std::size_t>(reach.up + reach.down + 1);
    return painted(set, {reach.down, std::vector<Brush::Row>(rows, {reach.right, reach.left})});
}

}  // namespace pliant::slice
