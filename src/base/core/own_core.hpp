// Running work on a single core, beside other work of the same kind.
#pragma once

#include <cstddef>
#include <functional>

namespace pliant {

/// Calls `work`; parallel loops inside it (parallel.hpp) run on this thread alone.
void on_own_core(const std::function<void()>& work);

/// Cores that this process may use, at least 1.
[[nodiscard]] int core_count();

}  // namespace pliant
