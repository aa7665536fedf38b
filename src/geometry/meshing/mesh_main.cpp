// pliant-mesh: the mesher process of pliant, which starts it and talks to it over a socket as its standard input.
//
//     pliant-mesh GIGABYTES      limit of its memory
//     pliant-mesh --version
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <charconv>
#include <string_view>
#include <thread>

#include "geometry/meshing/mesh_service.hpp"

namespace {

/// Sanitizers map far more memory than they use.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool can_limit_memory = false;
#else
constexpr bool can_limit_memory = true;
#endif

void limit_memory(double gigabytes) {
    if (!can_limit_memory || !(gigabytes > 0)) return;
    const auto bytes = static_cast<rlim_t>(gigabytes * 1e9);
    const rlimit limit{bytes, bytes};
    (void)::setrlimit(RLIMIT_AS, &limit);
    const rlimit no_core{0, 0};  // the client reports a crash; a core file of gigabytes is of no use
    (void)::setrlimit(RLIMIT_CORE, &no_core);
}

/// The client may be killed while Gmsh works for an hour: this process then ends, too.
void end_with(int socket) {
    std::thread([socket] {
        pollfd other{socket, POLLRDHUP, 0};
        while (::poll(&other, 1, -1) < 0) {
        }
        ::_exit(0);
    }).detach();
}

}  // namespace

int main(int argc, char** argv) {
    const std::string_view word = argc == 2 ? argv[1] : "";
    if (word == "--version") {
        fmt::print("{}\n", pliant::mesh::mesher_greeting);
        return 0;
    }
    double gigabytes = -1;
    const auto read = std::from_chars(word.data(), word.data() + word.size(), gigabytes);
    struct stat input {};
    if (read.ec != std::errc{} || gigabytes < 0 || ::fstat(STDIN_FILENO, &input) != 0 || !S_ISSOCK(input.st_mode)) {
        fmt::print(stderr,
                   "pliant-mesh: is started by pliant, which asks it for meshes; there is nothing to type here\n");
        return 2;
    }
    limit_memory(gigabytes);
    end_with(STDIN_FILENO);
    pliant::mesh::serve_meshes(pliant::mesh::MessagePipe(STDIN_FILENO));
}
