#include "standard_streams.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <initializer_list>

namespace pliant::app {
namespace {

ssize_t write_or_lose(int descriptor, const char* bytes, size_t size) {
    for (size_t done = 0; done < size;) {
        const ssize_t written = ::write(descriptor, bytes + done, size - done);
        if (written > 0)
            done += static_cast<size_t>(written);
        else if (errno != EINTR)
            break;
    }
    return static_cast<ssize_t>(size);
}

ssize_t to_output(void*, const char* bytes, size_t size) {
    return write_or_lose(STDOUT_FILENO, bytes, size);
}

ssize_t to_error(void*, const char* bytes, size_t size) {
    return write_or_lose(STDERR_FILENO, bytes, size);
}

/// fmt::print throws where a stream does not take its text.
FILE* lossy(cookie_write_function_t* write, int buffering) {
    FILE* stream = ::fopencookie(nullptr, "w", {nullptr, write, nullptr, nullptr});
    if (stream != nullptr) (void)std::setvbuf(stream, nullptr, buffering, BUFSIZ);
    return stream;
}

}  // namespace

void secure_standard_streams() {
    for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (::fcntl(descriptor, F_GETFD) >= 0) continue;
        // The lowest free one. Read-only: that nothing can be printed remains an error.
        (void)::open("/dev/null", O_RDONLY);
    }
    std::signal(SIGXFSZ, SIG_IGN);
    if (FILE* stream = lossy(to_error, _IONBF)) stderr = stream;
}

void outlive_readers() {
    std::signal(SIGPIPE, SIG_IGN);
    std::fflush(stdout);
    if (FILE* stream = lossy(to_output, ::isatty(STDOUT_FILENO) == 1 ? _IOLBF : _IOFBF)) stdout = stream;
}

}  // namespace pliant::app
