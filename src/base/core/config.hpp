// Robot and printer files: a TOML document as a plain tree with line numbers, and a reader that reports every unknown
// key.
//
//     Problems problems("finger.toml");
//     Reader root(document.root, problems);
//     const std::string name = root.text("name");                    // required
//     const double size = root.quantity("size", Dimension::length, 2.5e-3);  // with a default
//     root.finish();                                                 // unread keys become problems
//     if (auto status = problems.status(); !status) return tl::unexpected(status.error());
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "base/core/error.hpp"
#include "base/core/units.hpp"
#include "base/core/vec3.hpp"

namespace pliant::config {

struct Value;
using Array = std::vector<Value>;
using Entry = std::pair<std::string, Value>;
using Table = std::vector<Entry>;  ///< in the order of the file

struct Value {
    std::variant<bool, std::int64_t, double, std::string, Array, Table> data = Table{};
    int line = 0;  ///< 1-based; of values that `--set` brought in, that of the value they replace, or 0
};

struct Document {
    std::filesystem::path file;  ///< relative paths in the document are resolved against its folder
    Value root;                  ///< always a Table
};

/// Parses TOML; an error names file and line. Text over 16 MB or nested deeper than 32 levels is refused.
[[nodiscard]] Result<Document> parse(std::string_view text, const std::filesystem::path& file);
[[nodiscard]] Result<Document> load(const std::filesystem::path& file);

/// `KEY=VALUE` of the command line: KEY is a dotted path (`cable.flexor.target.length_ratio`; entries of an array of
/// tables are found by `name` or by index from 0; names with dots are put in quotes), VALUE is TOML or, failing that,
/// plain text. Missing tables and keys are added.
[[nodiscard]] Status set(Document& document, std::string_view assignment);
/// The VALUE of `KEY=VALUE` as set() reads it; the whole text if it has no '='.
[[nodiscard]] Value assigned_value(std::string_view assignment);

/// Where `--set` brings the value of a path: equal for all spellings of one place, such as cable.flexor and cable[0].
struct Place {
    const Value* value = nullptr;   ///< the last on the way that the document has
    std::vector<std::string> rest;  ///< the parts of the path behind it
    auto operator<=>(const Place&) const = default;
};
[[nodiscard]] Place place_of(const Document& document, std::string_view path);

/// Evaluates `[parameters]` in order (numbers, or text "= formula" over earlier ones), removes that table, and replaces
/// every text of the form "= formula" in the document by its value.
[[nodiscard]] Status resolve_parameters(Document& document);

/// Collects the problems of one file: `FILE:LINE: key: text`, one line each, in the order of the file, at most a dozen.
class Problems {
public:
    explicit Problems(std::string file) : file_(std::move(file)) {}
    void add(int line, std::string_view key, std::string_view text);
    [[nodiscard]] bool empty() const { return found_.empty(); }
    [[nodiscard]] Status status() const;

private:
    std::string file_;
    std::vector<Diagnostic> found_;
};

/// A table being read. Every accessor marks its key as read; a wrong type or a missing required key becomes a problem,
/// and the accessor returns a harmless value, so that reading code needs no branches: what that code then says against
/// the harmless value is left out. Copies share the record of read keys.
class Reader {
public:
    Reader(const Value& table, Problems& problems, std::string path = "");

    [[nodiscard]] bool has(std::string_view key) const;
    [[nodiscard]] int line() const { return table_->line; }
    [[nodiscard]] int line_of(std::string_view key) const;
    [[nodiscard]] const std::string& path() const { return path_; }
    [[nodiscard]] std::vector<std::string> keys() const;

    [[nodiscard]] std::string text(std::string_view key);
    [[nodiscard]] std::string text(std::string_view key, std::string_view fallback);
    [[nodiscard]] double number(std::string_view key);
    [[nodiscard]] double number(std::string_view key, double fallback);
    [[nodiscard]] std::int64_t integer(std::string_view key);
    [[nodiscard]] std::int64_t integer(std::string_view key, std::int64_t fallback);
    /// A whole number from `low` to `high`; one outside is a problem, and the nearest of them is returned.
    [[nodiscard]] int whole(std::string_view key, int low, int high);
    [[nodiscard]] int whole(std::string_view key, int low, int high, int fallback);
    [[nodiscard]] bool boolean(std::string_view key, bool fallback);
    /// A text with a unit, converted to SI; a bare number is a problem, whose message names the units.
    [[nodiscard]] double quantity(std::string_view key, Dimension dimension);
    [[nodiscard]] double quantity(std::string_view key, Dimension dimension, double fallback);
    [[nodiscard]] std::vector<double> quantities(std::string_view key, Dimension dimension, std::size_t count);
    /// `count` numbers; 0: any.
    [[nodiscard]] std::vector<double> numbers(std::string_view key, std::size_t count = 0);
    [[nodiscard]] std::vector<std::string> texts(std::string_view key);
    [[nodiscard]] Vec3 vector(std::string_view key);
    [[nodiscard]] Vec3 vector(std::string_view key, const Vec3& fallback);
    [[nodiscard]] std::vector<Vec3> vectors(std::string_view key);  ///< `[[x, y, z], ...]`
    /// One of `choices`, required unless `fallback` is one of them.
    [[nodiscard]] std::string choice(std::string_view key, const std::vector<std::string>& choices,
                                     std::string_view fallback = "");

    /// The table under `key`; if it is missing, an empty one and, if required, a problem.
    [[nodiscard]] Reader table(std::string_view key, bool required = true);
    /// The entries of `[[key]]`.
    [[nodiscard]] std::vector<Reader> tables(std::string_view key);
    /// The entries of a table of tables, `[material.soft]` and so on, by name.
    [[nodiscard]] std::vector<std::pair<std::string, Reader>> named_tables(std::string_view key);
    /// The raw value, for structures that Reader has no accessor for; marks the key as read.
    [[nodiscard]] const Value* raw(std::string_view key);

    /// Reports what is wrong with the value of `key`, and marks it as read; left out if the value is unreadable().
    void problem(std::string_view key, std::string_view text);
    /// True if an accessor could not read the value of `key`, or of a key in that table, or found a required one
    /// missing: a harmless value stands for it, from which nothing follows.
    [[nodiscard]] bool unreadable(std::string_view key) const;
    /// Reports every key that was not read, with the nearest known key.
    void finish();

private:
    const Value* find(std::string_view key);
    const Value* find_required(std::string_view key, std::string_view what);
    void refuse(std::string_view key, std::string_view text);
    void add(std::string_view key, std::string_view text);
    void mark_unreadable(std::string_view key);
    [[nodiscard]] std::string key_path(std::string_view key) const;

    struct Marks {
        std::vector<std::string> asked;       ///< every key that an accessor asked for, present or not
        std::vector<std::string> unreadable;  ///< see unreadable()
        std::shared_ptr<Marks> above;  ///< of the table in which this one stands under `key`, if it was read there
        std::string key;
    };
    const Value* table_;
    Problems* problems_;
    std::string path_;
    bool missing_ = false;  ///< stands for a table that is missing or none, which is reported once; its keys are not
    std::shared_ptr<Marks> marks_;
};

}  // namespace pliant::config
