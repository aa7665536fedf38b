// Work that keeps to one core, beside other work of its kind.
#pragma once

#include <cstddef>
#include <functional>

namespace pliant {

/// Calls `work`; the parallel loops in it (parallel.hpp) take place on this thread alone.
void on_own_core(const std::function<void()>& work);

/// Cores that this process may use, at least 1.
[[nodiscard]] int core_count();

}  // namespace pliant
