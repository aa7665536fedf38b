// PNG images of any kind, as in image stacks of other programs.
#include "input.hpp"
#include "printing/job/png.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto found = pliant::job::any_png_size(as_text(data, size), "fuzz.png");
    // As large as a stack's first image may be, but limited by the fuzzer's memory.
    if (found && static_cast<long long>(found->width_px) * found->height_px < (1 << 22))
        (void)pliant::job::decode_any_png(as_text(data, size), *found, "fuzz.png");
    return 0;
}
