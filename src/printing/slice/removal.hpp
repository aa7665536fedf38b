// What is removed from the inside of a part, layer by layer.
#pragma once

#include "printing/slice/run_set.hpp"

namespace pliant::slice {

/// Pixels that stay dark whatever the bodies say. Immutable; thread-safe.
class Removal {
public:
    virtual ~Removal() = default;
    [[nodiscard]] virtual RunSet at(int layer) const = 0;
};

}  // namespace pliant::slice
