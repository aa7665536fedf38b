// Study files: any text to a plan, and the same plan back from its JSON.
#include <cstdlib>

#include "input.hpp"
#include "loop/study/study_file.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace pliant::study;
    static const std::vector<std::string> commands{"simulate", "slice"};
    const auto plan = parse_study(as_text(data, size), "fuzz.toml", {commands, "1"});
    if (!plan || plan->rows.size() > 1000) return 0;
    const std::string json = plan_json(*plan);
    const auto back = parse_plan(json, "plan.json");
    if (!back || plan_json(*back) != json) std::abort();
    (void)row_words(*plan, plan->rows.size() - 1, "/row");
    return 0;
}
