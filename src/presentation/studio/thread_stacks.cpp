// Debian's civetweb gives its threads stacks of 100 kB. What a program has as thread-local variables comes out of a
// thread's stack, and CGAL's and METIS' take 95 kB of it: the first call would end the program. The size cannot be set
// from outside, so the function that sets it is given a lower bound here, for the whole program.
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

/// Makes the linker take this file along.
void use_large_thread_stacks() {}

}  // namespace pliant::studio
