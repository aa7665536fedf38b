#include "studio/requests/json_keys.hpp"

#include "base/core/json.hpp"

namespace pliant::studio {
namespace {

/// A parsed value is copied and freed recursively: the nesting depth is checked first.
bool nested_too_deep(std::string_view text) {
    constexpr int deepest = 8;
    int depth = 0;
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quoted && c == '\\') {
            ++i;
        } else if (c == '"') {
            quoted = !quoted;
        } else if (!quoted && (c == '[' || c == '{')) {
            if (++depth > deepest) return true;
        } else if (!quoted && (c == ']' || c == '}')) {
            --depth;
        }
    }
    return false;
}

}  // namespace

bool is_object(std::string_view text) {
    return !nested_too_deep(text) && parse_json(text).is_object();
}

Result<nlohmann::json> parse_object(const char* what, std::string_view text, std::size_t longest) {
    if (text.size() > longest) return input_error("{}: over {} bytes", what, longest);
    if (nested_too_deep(text)) return input_error("{}: nested too deep", what);
    nlohmann::json json = parse_json(text);
    if (!json.is_object()) return input_error("{}: a JSON object is needed", what);
    return json;
}

}  // namespace pliant::studio
