// Requests from a page for slicing and searches.
#include "input.hpp"
#include "studio/requests/search_order.hpp"
#include "studio/requests/slice_order.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text = as_text(data, size);
    (void)pliant::studio::read_slice_order(text);
    (void)pliant::studio::printer_name_of(text);
    (void)pliant::studio::parse_goal_order(text);
    (void)pliant::studio::parse_identify_order(text);
    (void)pliant::studio::parse_workspace_order(text);
    (void)pliant::studio::parse_sweep_order(text);
    return 0;
}
