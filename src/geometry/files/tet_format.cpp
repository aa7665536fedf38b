#include "geometry/files/tet_format.hpp"

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <string>
#include <vector>

#include "base/core/letters.hpp"
#include "geometry/files/text_scanner.hpp"

namespace pliant::mesh {
namespace {

/// Enough for any title, comment or preface.
constexpr std::size_t head_bytes = 65536;

/// Words of the first line that is neither blank nor a comment. `comment`: what begins a comment.
std::vector<std::string_view> first_words(std::string_view head, std::string_view comment) {
    TextScanner scan(head, "");
    while (!scan.at_end()) {
        std::vector<std::string_view> words;
        for (std::string_view word = scan.word_of_line(); !word.empty(); word = scan.word_of_line()) {
            if (word.starts_with(comment)) break;
            words.push_back(word);
        }
        scan.rest_of_line();
        if (!words.empty()) return words;
    }
    return {};
}

/// The first line of TetGen's files: a count, then 3 (dimensions) or 4 or 10 (nodes of a tet), then one or two flags.
std::optional<TetFormat> tetgen_part(const std::vector<std::string_view>& words) {
    if (words.size() < 2 || words.size() > 4) return std::nullopt;
    std::vector<std::int64_t> numbers;
    for (const std::string_view word : words) {
        std::int64_t number = 0;
        const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), number);
        if (code != std::errc() || end != word.data() + word.size()) return std::nullopt;
        numbers.push_back(number);
    }
    if (numbers[0] < 1) return std::nullopt;
    if (numbers[1] == 3) return TetFormat::tetgen_nodes;
    if (words.size() < 4 && (numbers[1] == 4 || numbers[1] == 10)) return TetFormat::tetgen_tets;
    return std::nullopt;
}

/// A keyword line comes first, `*HEADING` or `*NODE`; comments begin with two stars.
bool looks_like_inp(std::string_view head) {
    const auto words = first_words(head, "**");
    if (words.empty() || words.front().size() < 4 || words.front().front() != '*') return false;
    return is_letter(words.front()[1]);
}

std::optional<TetFormat> text_format(std::string_view head) {
    if (looks_like_inp(head)) return TetFormat::inp;
    const auto words = first_words(head, "#");
    if (words.empty()) return std::nullopt;
    const std::string first = lower_case(words.front());
    if (first.starts_with("meshversion")) return TetFormat::medit;
    if (first == "mesh" && words.size() > 1) return TetFormat::gid;
    return tetgen_part(words);
}

}  // namespace

std::optional<TetFormat> tet_format(std::string_view bytes) {
    bytes = without_mark(bytes);
    if (bytes.starts_with("# vtk")) return TetFormat::vtk;
    const std::string_view head = bytes.substr(0, head_bytes);
    if (head.substr(0, 4096).find("<VTKFile") != std::string_view::npos) return TetFormat::vtu;
    if (bytes.starts_with("$MeshFormat") || bytes.starts_with("$Comments")) return TetFormat::msh;
    if (head.find('\0') != std::string_view::npos) return std::nullopt;
    return text_format(head);
}

}  // namespace pliant::mesh
