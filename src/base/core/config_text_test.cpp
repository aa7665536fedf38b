#include "base/core/config_text.hpp"

#include <doctest/doctest.h>

using namespace pliant;
using namespace pliant::config;

namespace {

bool same(const Value& a, const Value& b) {
    if (a.data.index() != b.data.index()) return false;
    if (const auto* list = std::get_if<Array>(&a.data)) {
        const auto& other = std::get<Array>(b.data);
        if (list->size() != other.size()) return false;
        for (std::size_t k = 0; k < list->size(); ++k) {
            if (!same((*list)[k], other[k])) return false;
        }
        return true;
    }
    if (const auto* table = std::get_if<Table>(&a.data)) {
        const auto& other = std::get<Table>(b.data);
        if (table->size() != other.size()) return false;
        for (const auto& [key, value] : *table) {
            bool found = false;
            for (const auto& [name, entry] : other) found = found || (name == key && same(value, entry));
            if (!found) return false;
        }
        return true;
    }
    if (const auto* x = std::get_if<bool>(&a.data)) return *x == std::get<bool>(b.data);
    if (const auto* x = std::get_if<std::int64_t>(&a.data)) return *x == std::get<std::int64_t>(b.data);
    if (const auto* x = std::get_if<std::string>(&a.data)) return *x == std::get<std::string>(b.data);
    return std::get<double>(a.data) == std::get<double>(b.data);
}

}  // namespace

TEST_CASE("a document written as text is read back the same") {
    const auto document = parse(R"(
        name = "a \"robot\" \\ with\nlines, µ and \u0001"
        length_unit = "mm"
        list = [1, 2.0, 1e300, -0.1, true, [], {}]
        "odd key" = 3.0
        material.soft = { youngs_modulus = "= 2 * E", "a.b" = 1 }
        [parameters]
        E = 12
        [[body]]
        name = "one"
        geometry = { difference = [{ box = [[0, 0, 0], [1, 2.5, 3]] }, { sphere = { center = [0, 0, 0], radius = 1 } }] }
        [[body]]
        name = "two"
        [[program.key]]
        time = "1 s"
    )",
                                "a.toml");
    REQUIRE_MESSAGE(document, (document ? "" : document.error().message));
    const std::string text = toml_text(document->root);
    const auto again = parse(text, "b.toml");
    REQUIRE_MESSAGE(again, (again ? text : again.error().message + "\n" + text));
    CHECK(same(document->root, again->root));
    CHECK(toml_text(again->root) == text);
}

TEST_CASE("a key is bare where it can be, and keeps its control characters where it cannot") {
    CHECK(key_text("soft-1_b") == "soft-1_b");
    CHECK(key_text("") == "\"\"");
    CHECK(key_text("soft \"1\"\\") == "\"soft \\\"1\\\"\\\\\"");
    CHECK(key_text("a\nb\x7f") == "\"a\\u000ab\\u007f\"");
    CHECK(key_text("größe") == "\"größe\"");
}
