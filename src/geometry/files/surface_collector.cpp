#include "geometry/files/surface_collector.hpp"

#include <utility>

namespace pliant::mesh {

Status SurfaceCollector::read_vertex(TextScanner& scan) {
    Vec3 p;
    for (std::size_t k = 0; k < 3; ++k) {
        const Result<double> one = scan.number();
        if (!one) return tl::unexpected(one.error());
        file_.printed.see(scan.last_word());
        p[k] = *one;
    }
    add_vertex(p);
    return {};
}

SurfaceFile SurfaceCollector::take() {
    file_.mesh.points = welder_.take();
    place_.clear();
    return std::exchange(file_, {});
}

}  // namespace pliant::mesh
