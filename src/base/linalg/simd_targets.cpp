// The two functions by which Highway chooses the instruction set of kernels. Its library has them, too, but measures
// the clock for some milliseconds whenever a program starts that is linked with it, so only its headers are used.
#include <hwy/targets.h>

namespace hwy {
namespace {

std::int64_t supported_targets() {
    std::int64_t targets = HWY_STATIC_TARGET;
#if HWY_ARCH_X86
    // No processor with these four lacks the others (LZCNT, F16C) that Highway's AVX2 includes.
    const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                      __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("aes");
    const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
                        __builtin_cpu_supports("avx512cd");
    if (avx2) targets |= HWY_AVX2;
    if (avx2 && avx512) targets |= HWY_AVX3;
#endif
    return targets;
}

}  // namespace

std::int64_t SupportedTargets() {
    static const std::int64_t targets = supported_targets();
    return targets;
}

ChosenTarget& GetChosenTarget() {
    static ChosenTarget chosen;
    return chosen;
}

}  // namespace hwy
