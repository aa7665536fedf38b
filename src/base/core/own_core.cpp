#include "base/core/own_core.hpp"

#include <sched.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace pliant {

void on_own_core(const std::function<void()>& work) {
    tbb::task_arena alone(1);
    alone.execute(work);
}

int core_count() {
    cpu_set_t allowed;
    CPU_ZERO(&allowed);
    if (sched_getaffinity(0, sizeof allowed, &allowed) != 0) return 1;
    return std::max(1, CPU_COUNT(&allowed));
}

}  // namespace pliant
