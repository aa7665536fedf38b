// Layer images: the size in the header cannot be trusted; the decoder gets the size from the manifest.
#include "printing/job/png.hpp"

#include "input.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view bytes = as_text(data, size);
    (void)pliant::job::png_size(bytes, "fuzz.png");
    (void)pliant::job::decode_png(bytes, {64, 48}, "fuzz.png");
    return 0;
}
