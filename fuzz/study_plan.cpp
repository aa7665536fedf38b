// Plans as stored in a study's folder.
#include "input.hpp"
#include "loop/study/plan.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace pliant::study;
    const auto plan = parse_plan(as_text(data, size), "plan.json");
    if (!plan) return 0;
    for (std::size_t chunk = 0; chunk < plan->chunk_count() && chunk < 10; ++chunk) (void)plan->chunk_end(chunk);
    (void)row_words(*plan, plan->rows.size() - 1, "/row");
    return 0;
}
