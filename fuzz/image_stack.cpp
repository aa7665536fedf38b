// Layer images of other programs in a zip file: .sl1, .cws and similar.
#include "printing/job/image_stack.hpp"

#include "file.hpp"
#include "input.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const TemporaryFile file(as_text(data, size), ".sl1");
    (void)pliant::job::is_image_stack(file.path());
    const auto stack = pliant::job::ImageStack::open(file.path());
    // As large as a stack's first image may be, but limited by the fuzzer's memory.
    if (!stack || static_cast<long long>(stack->width_px()) * stack->height_px() > (1 << 22)) return 0;
    for (int layer = 0; layer < stack->layer_count(); ++layer) {
        const auto image = stack->image(layer);
        if (image && (image->width_px != stack->width_px() || image->height_px != stack->height_px())) __builtin_trap();
    }
    return 0;
}
