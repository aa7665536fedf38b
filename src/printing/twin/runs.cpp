#include "printing/twin/runs.hpp"

#include <algorithm>
#include <cstring>

namespace pliant::twin {
namespace {

constexpr int most_value = 65535;

/// The first lit pixel at or after `at`, else `width`; skips eight dark ones at a time.
int next_lit(const std::uint8_t* row, int at, int width) {
    while (at + 8 <= width) {
        std::uint64_t eight = 0;
        std::memcpy(&eight, row + at, 8);
        if (eight != 0) break;
        at += 8;
    }
    while (at < width && row[at] == 0) ++at;
    return at;
}

/// How many pixels of `a` come to lie on pixels of `b` when they are moved.
long long pixels_on(const Runs& a, const Runs& b, int rows, int columns) {
    long long count = 0;
    std::size_t first = 0;
    for (const Run& run : a) {
        const int row = run.row + rows, begin = run.begin + columns, end = run.end + columns;
        while (first < b.size() && (b[first].row < row || (b[first].row == row && b[first].end <= begin))) ++first;
        for (std::size_t k = first; k < b.size() && b[k].row == row && b[k].begin < end; ++k)
            count += std::min(end, b[k].end) - std::max(begin, b[k].begin);
    }
    return count;
}

void append_row(Runs& runs, int row, const std::vector<int>& values, int begin, int end) {
    for (int at = begin; at < end;) {
        int next = at + 1;
        const int value = values[static_cast<std::size_t>(at)];
        while (next < end && values[static_cast<std::size_t>(next)] == value) ++next;
        if (value > 0) runs.push_back({row, at, next, static_cast<std::uint16_t>(std::min(most_value, value))});
        at = next;
    }
}

}  // namespace

Runs runs_of(const job::Image& image) {
    Runs runs;
    const int width = image.width_px;
    for (int row = 0; row < image.height_px; ++row) {
        const std::uint8_t* line =
            image.pixels.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(width);
        for (int begin = next_lit(line, 0, width); begin < width;) {
            int end = begin + 1;
            while (end < width && line[end] == line[begin]) ++end;
            runs.push_back({row, begin, end, line[begin]});
            begin = next_lit(line, end, width);
        }
    }
    return runs;
}

Runs sum_of(const std::vector<Runs>& parts, int width) {
    if (parts.size() == 1) return parts.front();
    Runs sum;
    std::vector<std::size_t> at(parts.size());
    std::vector<int> values(static_cast<std::size_t>(width));
    for (;;) {
        int row = -1;
        for (std::size_t p = 0; p < parts.size(); ++p) {
            if (at[p] < parts[p].size() && (row < 0 || parts[p][at[p]].row < row)) row = parts[p][at[p]].row;
        }
        if (row < 0) return sum;
        int begin = width, end = 0;
        for (std::size_t p = 0; p < parts.size(); ++p) {
            for (; at[p] < parts[p].size() && parts[p][at[p]].row == row; ++at[p]) {
                const Run& run = parts[p][at[p]];
                for (int x = run.begin; x < run.end; ++x) values[static_cast<std::size_t>(x)] += run.value;
                begin = std::min(begin, run.begin);
                end = std::max(end, run.end);
            }
        }
        append_row(sum, row, values, begin, end);
        std::fill(values.begin() + begin, values.begin() + end, 0);
    }
}

long long common_sides(const Runs& a, const Runs& b) {
    return pixels_on(a, b, 0, 1) + pixels_on(a, b, 0, -1) + pixels_on(a, b, 1, 0) + pixels_on(a, b, -1, 0);
}

long long light_of(const Runs& runs) {
    long long light = 0;
    for (const Run& run : runs) light += static_cast<long long>(run.value) * (run.end - run.begin);
    return light;
}

}  // namespace pliant::twin
