// For tests: kernels in SIMD are checked with every instruction set that this processor has, not only with its best.
#pragma once

#include <hwy/targets.h>

#include <cstdint>

namespace pliant::linalg {

/// Calls check(name) once for each instruction set, with which all kernels run meanwhile. Not while others compute.
template <class Check>
void on_each_simd_target(const Check& check) {
    for (std::int64_t left = hwy::SupportedTargets(); left != 0; left &= left - 1) {
        const std::int64_t target = left & -left;
        hwy::GetChosenTarget().Update(target);
        check(hwy::TargetName(target));
    }
    hwy::GetChosenTarget().DeInit();  // the next call chooses the best again
}

}  // namespace pliant::linalg
