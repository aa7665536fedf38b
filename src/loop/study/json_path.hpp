// The path of a number in a command's JSON: steps[-1].cables.flexor.tension_N.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/core/error.hpp"

namespace pliant::study {

/// Keys and array indices, in order; a negative index counts from the end.
class JsonPath {
public:
    /// Keys are separated by dots, indices are in brackets; a key with characters other than letters, digits and
    /// underscores is quoted in brackets, as in cables["left flexor"]. Errors say where the text is wrong.
    [[nodiscard]] static Result<JsonPath> parse(std::string_view text);

    /// The number there; true is 1, false 0, null NaN. A path whose first key is not at the top level is looked up in
    /// the last of the `steps`. Errors name the part of the path that exists and what is there.
    [[nodiscard]] Result<double> number_in(const nlohmann::json& json) const;

private:
    using Part = std::variant<std::string, long>;
    std::vector<Part> parts_;
};

}  // namespace pliant::study
