// Medit mesh files as text. Format: P. Frey, "MEDIT: An interactive mesh visualization software", INRIA technical
// report 0253, 2001. Region names, which the format lacks, are in comments of our own: # region 1 "root".
#include <utility>

#include "base/core/letters.hpp"
#include "geometry/files/tet_file.hpp"
#include "geometry/files/text_tets.hpp"

namespace pliant::mesh {
namespace {

class MeditReader {
public:
    MeditReader(std::string_view text, std::string name) : scan_(text, name), name_(std::move(name)) {}

    Result<TetMesh> read() {
        for (std::string_view word = scan_.word(); !word.empty(); word = scan_.word()) {
            if (Status status = read_section(lower_case(word)); !status) return tl::unexpected(status.error());
        }
        return finish(std::move(found_), name_);
    }

private:
    Status read_section(const std::string& keyword) {
        if (keyword.starts_with('#')) return read_comment(keyword);
        const bool complete = std::exchange(complete_, false);
        if (keyword == "dimension") return read_dimension();
        if (keyword == "vertices") return read_vertices();
        if (keyword == "tetrahedra") return read_tets(4);
        if (keyword == "tetrahedrap2") return read_tets(10);
        const char first = keyword.front();
        if (is_letter(first)) return {};
        if (complete) return scan_.error("there is more in the list than its count announces");
        if (is_digit(first) || first == '-' || first == '+' || first == '.') return {};
        return scan_.error(fmt::format("\"{}\" is neither a keyword nor a number", keyword.substr(0, 40)));
    }

    /// `# region 1 "root"`, or any other comment.
    Status read_comment(const std::string& mark) {
        if (mark != "#" || scan_.word_of_line() != "region") {
            scan_.rest_of_line();
            return {};
        }
        const std::string_view rest = scan_.rest_of_line();
        const std::size_t quote = rest.find('"');
        if (quote == std::string_view::npos || rest.size() < quote + 2 || rest.back() != '"') return {};
        TextScanner number(rest.substr(0, quote), name_);
        if (const Result<std::int64_t> region = number.integer())
            found_.names[*region] = std::string(rest.substr(quote + 1, rest.size() - quote - 2));
        return {};
    }

    Status read_dimension() {
        const Result<std::int64_t> dimension = scan_.integer();
        if (!dimension) return tl::unexpected(dimension.error());
        if (*dimension != 3) return scan_.error(fmt::format("dimension {}: tetrahedra need three", *dimension));
        return {};
    }

    Status read_vertices() {
        const Result<std::size_t> count = scan_.count(8);
        if (!count) return tl::unexpected(count.error());
        found_.points.reserve(*count);
        for (std::size_t i = 0; i < *count; ++i) {
            const Result<Vec3> p = read_point(scan_);
            if (!p) return tl::unexpected(p.error());
            if (const Result<double> reference = scan_.number(); !reference) return tl::unexpected(reference.error());
            if (!found_.points.add(static_cast<std::int64_t>(i) + 1, *p)) return scan_.error("Vertices come twice");
        }
        complete_ = true;
        return {};
    }

    Status read_tets(std::size_t width) {
        const Result<std::size_t> count = scan_.count(2 * width + 2);
        if (!count) return tl::unexpected(count.error());
        if (width == 4 && words_ahead() == 11) width = 10;  // Gmsh 4.8 writes quadratic tets this way
        for (std::size_t i = 0; i < *count; ++i) {
            const Result<TenNodes> nodes = read_tet_nodes(scan_, found_.points, width);
            if (!nodes) return tl::unexpected(nodes.error());
            const Result<std::int64_t> reference = scan_.integer();
            if (!reference) return tl::unexpected(reference.error());
            found_.tets.push_back(*nodes);
            found_.regions.push_back(*reference);
        }
        complete_ = true;
        return {};
    }

    /// Number of words on the next non-blank line; 12 if there are more.
    int words_ahead() const {
        TextScanner ahead = scan_;
        if (ahead.word().empty()) return 0;
        int words = 1;
        while (words < 12 && !ahead.word_of_line().empty()) ++words;
        return words;
    }

    TextScanner scan_;
    std::string name_;
    TextTets found_;
    bool complete_ = false;  ///< a list that is read has just ended: no number may follow
};

}  // namespace

Result<TetMesh> parse_medit(std::string_view bytes, const std::string& name) {
    return MeditReader(bytes, name).read();
}

}  // namespace pliant::mesh
