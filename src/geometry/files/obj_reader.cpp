// Wavefront OBJ: the lines "v x y z" and "f a b c ...", where a corner is a number, or number/texture/normal. A
// backslash at the end of a line joins the next one to it, except in comments and in names (which may end in one).
#include <charconv>

#include "geometry/files/surface_collector.hpp"

namespace pliant::mesh {
namespace {

class ObjReader {
public:
    ObjReader(std::string_view text, std::string name) : scan_(text, std::move(name)) {}

    Result<SurfaceFile> read() {
        while (!scan_.at_end()) {
            const std::string_view keyword = scan_.word_of_line();
            Status status;
            scan_.join_lines_at_backslash(keyword == "v" || keyword == "f");
            if (keyword == "v")
                status = surface_.read_vertex(scan_);
            else if (keyword == "f")
                status = read_face();
            scan_.join_lines_at_backslash(false);
            if (!status) return tl::unexpected(status.error());
            scan_.rest_of_line();
        }
        if (surface_.file().mesh.triangles.empty()) return scan_.error("holds no faces");
        return surface_.take();
    }

private:
    /// The number of a vertex, from 0. Numbers in the file count from 1 or, if negative, back from the last vertex so
    /// far.
    Result<std::size_t> corner(std::string_view word) const {
        const std::string_view digits = word.substr(0, word.find('/'));
        std::int64_t number = 0;
        const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
        const auto count = static_cast<std::int64_t>(surface_.vertex_count());
        if (code != std::errc() || end != digits.data() + digits.size())
            return scan_.error(fmt::format("\"{}\" is not a corner of a face", word.substr(0, 40)));
        const std::int64_t index = number < 0 ? count + number : number - 1;
        if (number == 0 || index < 0 || index >= count)
            return scan_.error(fmt::format("a face names vertex {}, there are {} so far", number, count));
        return static_cast<std::size_t>(index);
    }

    Status read_face() {
        surface_.begin_face();
        for (std::string_view word = scan_.word_of_line(); !word.empty() && !word.starts_with('#');
             word = scan_.word_of_line()) {
            const Result<std::size_t> vertex = corner(word);
            if (!vertex) return tl::unexpected(vertex.error());
            surface_.add_corner(*vertex);
        }
        const std::size_t corners = surface_.corner_count();
        if (corners < 3) return scan_.error(fmt::format("a face has {} corners, three are needed", corners));
        return {};
    }

    TextScanner scan_;
    SurfaceCollector surface_;
};

}  // namespace

Result<SurfaceFile> parse_obj(std::string_view bytes, const std::string& name) {
    return ObjReader(bytes, name).read();
}

}  // namespace pliant::mesh
