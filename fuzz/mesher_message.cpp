// Messages between the mesher and its clients: arbitrary bytes as any kind of message.
#include <sys/socket.h>
#include <unistd.h>

#include <array>

#include "geometry/mesher/message_pipe.hpp"
#include "geometry/mesher/packing.hpp"
#include "input.hpp"

namespace {

using namespace pliant;

template <class T>
void read_as(std::string_view bytes) {
    mesh::Unpacker in(bytes);
    T value{};
    unpack(in, value);
    if (!in.finished()) return;
    mesh::Packer out;  // what was read must be written back unchanged
    pack(out, value);
    if (out.take() != bytes) __builtin_trap();
}

void receive(std::string_view bytes) {
    std::array<int, 2> ends{};
    if (::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()) != 0) __builtin_trap();
    mesh::MessagePipe here(ends[0]);
    (void)::send(ends[1], bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    ::close(ends[1]);
    mesh::Message message;
    while (here.receive(message, 1000) == mesh::Received::message) {
    }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const std::string_view bytes = as_text(data + 1, size - 1);
    switch (data[0] % 6) {
        case 0:
            return receive(bytes), 0;
        case 1:
            return read_as<std::vector<mesh::BodyGeometry>>(bytes), 0;
        case 2:
            return read_as<mesh::MeshSettings>(bytes), 0;
        case 3:
            return read_as<mesh::TetMesh>(bytes), 0;
        case 4:
            return read_as<mesh::StepContent>(bytes), 0;
        default:
            return read_as<std::vector<mesh::Notch>>(bytes), 0;
    }
}
