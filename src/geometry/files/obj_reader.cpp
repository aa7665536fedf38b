// Wavefront OBJ: the lines "v x y z" and "f a b c ...", where a corner is a number, or number/texture/normal. A
// backslash at the end of a line joins the next one to it, except in comments and in names (which may end in one).
#include <charconv>

#include "geometry/files/surface_file.hpp"
#include "geometry/files/text_scanner.hpp"
#include "geometry/mesh/point_welder.hpp"

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
                status = read_vertex();
            else if (keyword == "f")
                status = read_face();
            scan_.join_lines_at_backslash(false);
            if (!status) return tl::unexpected(status.error());
            scan_.rest_of_line();
        }
        if (file_.mesh.triangles.empty()) return scan_.error("holds no faces");
        file_.mesh.points = welder_.take();
        return std::move(file_);
    }

private:
    Status read_vertex() {
        Vec3 p;
        for (std::size_t k = 0; k < 3; ++k) {
            const Result<double> one = scan_.number();
            if (!one) return tl::unexpected(one.error());
            file_.printed.see(scan_.last_word());
            p[k] = *one;
        }
        place_.push_back(welder_.add(p));
        return {};
    }

    /// Numbers count from 1, or back from the last vertex so far if negative.
    Result<int> corner(std::string_view word) const {
        const std::string_view digits = word.substr(0, word.find('/'));
        std::int64_t number = 0;
        const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
        const auto count = static_cast<std::int64_t>(place_.size());
        if (code != std::errc() || end != digits.data() + digits.size())
            return scan_.error(fmt::format("\"{}\" is no corner of a face", word.substr(0, 40)));
        const std::int64_t index = number < 0 ? count + number : number - 1;
        if (number == 0 || index < 0 || index >= count)
            return scan_.error(fmt::format("a face names vertex {}, there are {} so far", number, count));
        return place_[static_cast<std::size_t>(index)];
    }

    Status read_face() {
        int first = -1;
        int before = -1;
        int corners = 0;
        for (std::string_view word = scan_.word_of_line(); !word.empty() && !word.starts_with('#');
             word = scan_.word_of_line()) {
            const Result<int> point = corner(word);
            if (!point) return tl::unexpected(point.error());
            if (++corners == 1) first = *point;
            if (corners > 2) file_.mesh.triangles.push_back({first, before, *point});
            before = *point;
        }
        if (corners < 3) return scan_.error(fmt::format("a face has {} corners, three are needed", corners));
        return {};
    }

    TextScanner scan_;
    PointWelder welder_;
    std::vector<int> place_;  ///< welded index of each vertex of the file
    SurfaceFile file_;
};

}  // namespace

Result<SurfaceFile> parse_obj(std::string_view bytes, const std::string& name) {
    return ObjReader(bytes, name).read();
}

}  // namespace pliant::mesh
