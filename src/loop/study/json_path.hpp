// Where a number stands in a command's JSON: steps[-1].cables.flexor.tension_N.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/core/error.hpp"

namespace pliant::study {

/// Keys and places of arrays, in order; a negative place counts from the end.
class JsonPath {
public:
    /// Keys are joined by dots, places stand in brackets; a key with other letters than those of a word stands in
    /// quotes in brackets, as in cables["left flexor"]. Errors say where the text is wrong.
    [[nodiscard]] static Result<JsonPath> parse(std::string_view text);

    /// The number there; true is 1, false 0, null is not a number (NaN). A path whose first key is none of the whole is
    /// looked for in the last of its `steps`. Errors name how far the path goes and what there is.
    [[nodiscard]] Result<double> number_in(const nlohmann::json& json) const;

private:
    using Part = std::variant<std::string, long>;
    std::vector<Part> parts_;
};

}  // namespace pliant::study
