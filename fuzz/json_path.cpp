// A path in the first line, followed by JSON.
#include "loop/study/json_path.hpp"

#include <nlohmann/json.hpp>

#include "input.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text = as_text(data, size);
    const std::size_t end = std::min(text.find('\n'), text.size());
    const auto path = pliant::study::JsonPath::parse(text.substr(0, end));
    const auto json = nlohmann::json::parse(text.substr(std::min(end + 1, text.size())), nullptr, false);
    if (path && !json.is_discarded()) (void)path->number_in(json);
    return 0;
}
