#include "printing/slice/mask.hpp"

#include <algorithm>

namespace pliant::slice {
namespace {

RunImage part(const RunImage& image, const RunSet& set, bool wanted) {
    RunImage result(image.width_px(), image.height_px());
    for (int row = image.first_row(); row < image.end_row(); ++row) {
        const auto spans = set.row(row);
        auto span = spans.begin();
        for (const Run& run : image.row(row)) {
            for (int at = run.begin; at < run.end;) {
                while (span != spans.end() && span->end <= at) ++span;
                const bool in = span != spans.end() && span->begin <= at;
                const int change = span == spans.end() ? run.end : in ? span->end : span->begin;
                const int end = std::min<int>(run.end, change);
                if (in == wanted) result.append(row, at, end, run.value);
                at = end;
            }
        }
    }
    return result;
}

}  // namespace

RunImage inside(const RunImage& image, const RunSet& set) {
    return part(image, set, true);
}

RunImage outside(const RunImage& image, const RunSet& set) {
    return part(image, set, false);
}

RunImage lesser(const RunImage& a, const RunImage& b) {
    RunImage result(a.width_px(), a.height_px());
    for (int row = std::max(a.first_row(), b.first_row()); row < std::min(a.end_row(), b.end_row()); ++row) {
        const auto left = a.row(row), right = b.row(row);
        for (auto i = left.begin(), j = right.begin(); i != left.end() && j != right.end();) {
            const int begin = std::max(i->begin, j->begin), end = std::min(i->end, j->end);
            if (begin < end) result.append(row, begin, end, std::min(i->value, j->value));
            (i->end < j->end ? i : j)++;
        }
    }
    return result;
}

RunImage together(const RunImage& a, const RunImage& b) {
    if (a.blank()) return b;
    if (b.blank()) return a;
    RunImage result(a.width_px(), a.height_px());
    const int end = std::max(a.end_row(), b.end_row());
    for (int row = std::min(a.first_row(), b.first_row()); row < end; ++row) {
        const auto left = a.row(row), right = b.row(row);
        for (auto i = left.begin(), j = right.begin(); i != left.end() || j != right.end();) {
            const bool from_a = j == right.end() || (i != left.end() && i->begin < j->begin);
            const Run& run = from_a ? *i++ : *j++;
            result.append(row, run.begin, run.end, run.value);
        }
    }
    return result;
}

}  // namespace pliant::slice
