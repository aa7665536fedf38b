// OFF, Geomview's object file format, as text: a keyword, the counts of vertices, faces and edges, then one line per
// vertex and face. The keyword's prefixes say what follows a vertex's coordinates on its line: ST a texture, C a
// colour, N a normal. These are ignored, and so is a face's colour.
#include <optional>

#include "geometry/files/surface_collector.hpp"

namespace pliant::mesh {
namespace {

/// Prefixes of the keyword, or nothing if it is not the keyword.
struct Prefixes {
    bool four = false;  ///< four coordinates each
    bool any = false;   ///< the file gives the number of coordinates
};

std::optional<Prefixes> prefixes_of(std::string_view keyword) {
    const auto take = [&](std::string_view prefix) {
        const bool there = keyword.starts_with(prefix);
        if (there) keyword.remove_prefix(prefix.size());
        return there;
    };
    (void)take("ST");
    (void)take("C");
    (void)take("N");
    Prefixes found;
    found.four = take("4");
    found.any = take("n");
    return keyword == "OFF" ? std::optional(found) : std::nullopt;
}

class OffReader {
public:
    OffReader(std::string_view text, std::string name) : scan_(text, std::move(name)) {}

    Result<SurfaceFile> read() {
        if (Status status = read_head(); !status) return tl::unexpected(status.error());
        for (std::size_t i = 0; i < vertices_; ++i) {
            if (Status status = read_vertex(); !status) return tl::unexpected(status.error());
        }
        for (std::size_t i = 0; i < faces_; ++i) {
            if (Status status = read_face(); !status) return tl::unexpected(status.error());
        }
        if (surface_.file().mesh.triangles.empty()) return scan_.error("holds no faces of three corners or more");
        if (thin_faces_ > 0)
            surface_.file().warnings.push_back(
                fmt::format("{}: {} face(s) of fewer than three corners were passed over", name(), thin_faces_));
        return surface_.take();
    }

private:
    [[nodiscard]] const std::string& name() const { return scan_.name(); }

    Status read_head() {
        scan_.skip_comments('#');
        const std::optional<Prefixes> prefixes = prefixes_of(scan_.word());
        if (!prefixes) return scan_.error("an OFF file begins with OFF");
        if (prefixes->four || prefixes->any)
            return scan_.error("its points are not in three dimensions; OFF, COFF, NOFF and STOFF can be read");
        scan_.skip_comments('#');
        for (std::size_t* count : {&vertices_, &faces_}) {
            const Result<std::size_t> read = scan_.count(2);  // at least a digit and a separator
            if (scan_.last_word() == "BINARY") return scan_.error("is a binary OFF file; write it as text");
            if (!read) return tl::unexpected(read.error());
            *count = *read;
        }
        scan_.rest_of_line();  // the number of edges, which is not used
        return {};
    }

    Status read_vertex() {
        scan_.skip_comments('#');
        const Status status = surface_.read_vertex(scan_);
        scan_.rest_of_line();
        return status;
    }

    Status read_face() {
        scan_.skip_comments('#');
        const Result<std::size_t> corners = scan_.count(2);
        if (!corners) return tl::unexpected(corners.error());
        surface_.begin_face();
        for (std::size_t k = 0; k < *corners; ++k) {
            const Result<std::int64_t> number = scan_.integer();
            if (!number) return tl::unexpected(number.error());
            const std::size_t there = surface_.vertex_count();
            if (*number < 0 || *number >= static_cast<std::int64_t>(there))
                return scan_.error(
                    fmt::format("a face names vertex {}, there are {} (the first is 0)", *number, there));
            surface_.add_corner(static_cast<std::size_t>(*number));
        }
        thin_faces_ += *corners < 3 ? 1 : 0;
        scan_.rest_of_line();
        return {};
    }

    TextScanner scan_;
    std::size_t vertices_ = 0, faces_ = 0, thin_faces_ = 0;
    SurfaceCollector surface_;
};

}  // namespace

bool looks_like_off(std::string_view bytes) {
    TextScanner scan(bytes.substr(0, 65536), "");
    scan.skip_comments('#');
    return prefixes_of(scan.word()).has_value();
}

Result<SurfaceFile> parse_off(std::string_view bytes, const std::string& name) {
    return OffReader(bytes, name).read();
}

}  // namespace pliant::mesh
