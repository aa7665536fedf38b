#include "geometry/meshing/mesh_service.hpp"

#include <chrono>
#include <exception>
#include <new>

#include "geometry/mesher/packing.hpp"
#include "geometry/meshing/gmsh_kernel.hpp"
#include "geometry/meshing/mesh_bodies.hpp"
#include "geometry/meshing/notches.hpp"

namespace pliant::mesh {
namespace {

/// Reports progress to the client a few times a second. To cancel, the client kills this process.
class ToldProgress : public Progress {
public:
    explicit ToldProgress(const MessagePipe& pipe) : pipe_(&pipe) {}
    void advance(std::string_view stage, double fraction) override {
        const auto now = std::chrono::steady_clock::now();
        if (stage == stage_ && now - told_ < std::chrono::milliseconds(50)) return;
        stage_ = stage;
        told_ = now;
        Packer out;
        out.text(stage);
        out.number(fraction);
        (void)pipe_->send(MessageKind::progress, out.take());
    }

private:
    const MessagePipe* pipe_;
    std::string stage_;
    std::chrono::steady_clock::time_point told_;
};

template <class T>
Result<std::string> packed(const Result<T>& value) {
    if (!value) return tl::unexpected(value.error());
    Packer out;
    pack(out, *value);
    return out.take();
}

/// The first way to build solids (build_solid.hpp), as asked for.
int first_way(Unpacker& in) {
    const auto way = in.number<std::uint8_t>();
    if (way >= seam_ways) in.fail();
    return way;
}

tl::unexpected<Error> unreadable() {
    return failure("pliant-mesh cannot read what it was asked; it must be of the same version as the program");
}

Result<std::string> mesh(Unpacker& in, Progress& progress) {
    std::vector<BodyGeometry> bodies;
    MeshSettings settings;
    unpack(in, bodies);
    unpack(in, settings);
    const int way = first_way(in);
    if (!in.finished()) return unreadable();
    return packed(kernel::mesh_bodies(bodies, settings, progress, way));
}

Result<std::string> tessellate_solid(Unpacker& in) {
    Solid solid;
    unpack(in, solid);
    const auto tolerance = in.number<double>();
    const int way = first_way(in);
    if (!in.finished() || !(tolerance > 0)) return unreadable();
    return packed(kernel::tessellate(solid, tolerance, way));
}

Result<std::string> measure(Unpacker& in) {
    Solid solid;
    unpack(in, solid);
    const int way = first_way(in);
    if (!in.finished()) return unreadable();
    return packed(kernel::solid_volume(solid, way));
}

Result<std::string> read_shapes(Unpacker& in) {
    const std::string file = in.text();
    const auto scale = in.number<double>();
    if (!in.finished() || !(scale > 0)) return unreadable();
    return packed(kernel::read_step(file, scale));
}

Result<std::string> find_notches(Unpacker& in) {
    TriMesh surface;
    unpack(in, surface);
    const std::vector<Vec3> path = in.list<Vec3>();
    if (!in.finished()) return unreadable();
    return packed(Result<std::vector<Notch>>(kernel::crossed_notches(surface, path)));
}

Result<std::string> work_on(const Message& request, Progress& progress) {
    Unpacker in(request.bytes);
    switch (request.kind) {
        case MessageKind::mesh_bodies:
            return mesh(in, progress);
        case MessageKind::tessellate:
            return tessellate_solid(in);
        case MessageKind::volume:
            return measure(in);
        case MessageKind::read_step:
            return read_shapes(in);
        case MessageKind::notches:
            return find_notches(in);
        default:
            return unreadable();
    }
}

Result<std::string> guarded(const Message& request, Progress& progress) {
    try {
        return work_on(request, progress);
    } catch (const std::bad_alloc&) {
        return failure(
            "meshing needs more memory than there is; take a larger mesh size, or allow more (PLIANT_MESH_GIGABYTES)");
    } catch (const std::exception& error) {
        return failure("the mesher gave up: {}", error.what());
    }
}

}  // namespace

Message answer_request(const Message& request, const MessagePipe& pipe) {
    ToldProgress progress(pipe);
    Result<std::string> answer = guarded(request, progress);
    if (answer) return {MessageKind::answer, std::move(*answer)};
    Packer out;
    pack(out, answer.error());
    return {MessageKind::error, out.take()};
}

void serve_meshes(MessagePipe pipe) {
    if (!pipe.send(MessageKind::greeting, mesher_greeting)) return;
    Message request;
    while (pipe.receive(request, -1) == Received::message) {
        const Message answer = answer_request(request, pipe);
        if (!pipe.send(answer.kind, answer.bytes)) return;
    }
}

}  // namespace pliant::mesh
