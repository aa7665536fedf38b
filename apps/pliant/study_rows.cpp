#include "study_rows.hpp"

#include <fcntl.h>
#include <unistd.h>

#include "base/core/file_handle.hpp"
#include "base/core/own_core.hpp"
#include "geometry/mesher/mesh_worker.hpp"
#include "loop/study/worker.hpp"
#include "program.hpp"

namespace pliant::app {

int serve_study_rows(const std::vector<std::string>& words) {
    // A command that reads its standard input must not get the socket.
    const FileHandle socket(::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3));
    const FileHandle nothing(::open("/dev/null", O_RDONLY | O_CLOEXEC));
    ::dup2(nothing.number(), STDIN_FILENO);
    constexpr std::size_t room = std::size_t{256} << 20;
    mesh::remember_answers(room);  // many studies change only materials and actuators, so meshes can be reused
    const bool one_core = words.size() > 1 && words[1] == "one-core";
    return study::serve_rows(socket.number(), [one_core](const std::vector<std::string>& row) {
        return study::captured([&] {
            int status = 0;
            const auto work = [&] { status = run_program(row); };
            if (one_core)
                on_own_core(work);
            else
                work();
            return status;
        });
    });
}

}  // namespace pliant::app
