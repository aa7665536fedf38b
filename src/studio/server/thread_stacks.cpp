// Debian's civetweb creates its threads with stacks of 100 kB. Thread-local variables are allocated on a thread's
// stack, and those of CGAL and METIS take 95 kB: the first call would crash. The size cannot be configured, so the
// function that sets it is replaced here by one with a lower bound, for the whole program.
#include <dlfcn.h>
#include <pthread.h>

#include <algorithm>
#include <cstddef>

extern "C" int pthread_attr_setstacksize(pthread_attr_t* attributes, std::size_t bytes) noexcept {
    constexpr std::size_t least_bytes = std::size_t{2} << 20;
    using Function = int (*)(pthread_attr_t*, std::size_t);
    static const auto original = reinterpret_cast<Function>(dlsym(RTLD_NEXT, "pthread_attr_setstacksize"));
    return original(attributes, std::max(bytes, least_bytes));
}

namespace pliant::studio {

/// Makes the linker include this file.
void use_large_thread_stacks() {}

}  // namespace pliant::studio
