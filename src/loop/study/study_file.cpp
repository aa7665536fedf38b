#include "loop/study/study_file.hpp"

#include <algorithm>
#include <fstream>
#include <optional>

#include "base/core/config.hpp"
#include "base/core/csv.hpp"
#include "base/core/digest.hpp"
#include "base/core/files.hpp"
#include "base/core/text.hpp"
#include "loop/study/clashes.hpp"
#include "loop/study/command_files.hpp"
#include "loop/study/design.hpp"
#include "loop/study/json_path.hpp"
#include "loop/study/sobol.hpp"
#include "loop/study/values.hpp"

namespace pliant::study {
namespace {

namespace fs = std::filesystem;
using config::Reader;

struct KeyChoice {
    Key key;
    Choice choice;
};

bool mentions(const std::vector<std::string>& words, const std::string& what) {
    return std::any_of(words.begin(), words.end(),
                       [&](const std::string& word) { return word.find(what) != std::string::npos; });
}

/// Every row would write over what the one before has written.
void check_output(Reader& root, const std::vector<std::string>& words) {
    for (std::size_t k = 1; k < words.size(); ++k) {
        const std::string& word = words[k];
        const bool apart = word == "-o" || word == "--output", is_short = word.starts_with("-o");
        if (!apart && !is_short && !word.starts_with("--output=")) continue;
        const std::string value = !apart                 ? word.substr(is_short ? 2 : word.find('=') + 1)
                                  : k + 1 < words.size() ? words[k + 1]
                                                         : "";
        if (value.empty() || value.find('{') != std::string::npos) continue;
        root.problem("command", fmt::format("all rows would write \"{}\", one over the other; {{row}} in it stands for "
                                            "a folder of the row's own, as in \"{}\", \"{{row}}/out\"",
                                            value, is_short ? "-o" : "--output"));
    }
}

std::vector<std::string> read_command(Reader& root, const StudyContext& context) {
    std::vector<std::string> words = root.texts("command");
    if (words.empty()) {
        root.problem("command", fmt::format("is {}; write its words, as in [\"simulate\", \"finger.toml\"]",
                                            root.has("command") ? "empty" : "missing"));
        return words;
    }
    if (std::find(context.commands.begin(), context.commands.end(), words[0]) == context.commands.end()) {
        const std::string near = nearest_name(words[0], context.commands);
        root.problem("command", fmt::format("a study cannot run \"{}\"{}; it runs {}", words[0],
                                            near.empty() ? "" : fmt::format(", did you mean \"{}\"?", near),
                                            join_names(context.commands)));
    }
    check_output(root, words);
    return words;
}

/// Requires exactly one of `set`, `option`, or a word {NAME} in the command.
Key read_key(const std::string& name, Reader& table, const std::vector<std::string>& command) {
    Key key{name, table.text("set", ""), table.text("option", ""), "", true};
    if (name == "row") table.problem("", "{row} stands for the row's folder; another name is needed");
    const bool in_words = mentions(command, "{" + name + "}");
    const int ways = (key.set.empty() ? 0 : 1) + (key.option.empty() ? 0 : 1) + (in_words ? 1 : 0);
    if (ways == 0)
        table.problem("", fmt::format("says nothing to the command: give it set = \"a.key.of.the.file\" or option = "
                                      "\"--option\", or write {{{}}} into a word of the command",
                                      name));
    else if (ways > 1)
        table.problem(
            "", fmt::format("set, option and {{{}}} in the command are three ways of saying the same; keep one", name));
    if (!key.option.empty() && (!key.option.starts_with("--") || key.option.find('=') != std::string::npos))
        table.problem("option", fmt::format("\"{}\" must begin with two dashes, as in \"--layer\"", key.option));
    return key;
}

std::vector<KeyChoice> read_keys(Reader& root, const std::vector<std::string>& command) {
    std::vector<KeyChoice> keys;
    for (auto& [name, table] : root.named_tables("key")) {
        KeyChoice key{read_key(name, table, command), read_choice(table)};
        key.key.unit = key.choice.unit;
        key.key.numeric = key.choice.numeric;
        key.key.gap = key.choice.gap;
        table.finish();
        keys.push_back(std::move(key));
    }
    if (keys.size() > most_keys)
        root.problem("key", fmt::format("{} keys; at most {} are possible", keys.size(), most_keys));
    return keys;
}

std::vector<Wanted> read_results(Reader& root) {
    std::vector<Wanted> results;
    Reader table = root.table("result");
    for (const std::string& name : table.keys()) {
        const std::string path = table.text(name);
        if (path.empty()) continue;
        if (const auto parsed = JsonPath::parse(path); !parsed) table.problem(name, parsed.error().message);
        results.push_back({name, path, table.line_of(name)});
    }
    if (results.empty() && root.has("result"))
        root.problem("result", "names nothing; write NAME = \"path\", as in tension = \"cables.flexor.tension_N\"");
    return results;
}

SlurmOptions read_slurm(Reader table, std::size_t& rows_per_task) {
    SlurmOptions slurm;
    slurm.partition = table.text("partition", "");
    slurm.account = table.text("account", "");
    slurm.time = table.text("time", "");
    slurm.memory = table.text("memory", "");
    const auto cpus = table.integer("cpus_per_task", 1);
    if (cpus < 1 || cpus > 1024) table.problem("cpus_per_task", "must be from 1 to 1024");
    slurm.cpus_per_task = static_cast<int>(std::clamp<std::int64_t>(cpus, 1, 1024));
    if (table.has("options")) slurm.options = table.texts("options");
    const auto rows = table.integer("rows_per_task", 0);
    if (table.has("rows_per_task") && (rows < 1 || rows > static_cast<std::int64_t>(most_rows)))
        table.problem("rows_per_task", "must be from 1 to 1000000");
    rows_per_task = rows < 1 ? 0 : static_cast<std::size_t>(rows);
    table.finish();
    return slurm;
}

/// The content of a study file before rows are made.
struct Draft {
    Plan plan;
    std::vector<KeyChoice> keys;
    std::size_t samples = 0;
    std::uint64_t seed = 1;
    std::string table;
};

constexpr std::string_view grid_too_big =
    "the grid has over {} rows; take fewer levels, or plan = \"sobol\" with samples";

std::vector<std::vector<std::string>> grid_rows(const std::vector<KeyChoice>& keys, Reader& root) {
    std::vector<std::vector<std::string>> rows(1);
    for (const KeyChoice& key : keys) {
        const auto levels = levels_of(key.choice);
        if (levels.empty()) {
            root.problem("key." + key.key.name, "a grid needs its levels, as in levels = 5, or a list of values");
            return {};
        }
        if (rows.size() * levels.size() > most_rows) {
            root.problem("plan", fmt::format(fmt::runtime(grid_too_big), most_rows));
            return {};
        }
        std::vector<std::vector<std::string>> more;
        more.reserve(rows.size() * levels.size());
        for (const auto& row : rows) {
            for (const std::string& level : levels) {
                more.push_back(row);
                more.back().push_back(level);
            }
        }
        rows = std::move(more);
    }
    return rows;
}

std::vector<std::vector<std::string>> rows_of(const std::vector<double>& points, const std::vector<KeyChoice>& keys) {
    std::vector<std::vector<std::string>> rows(points.size() / keys.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        for (std::size_t k = 0; k < keys.size(); ++k)
            rows[i].push_back(value_at(keys[k].choice, points[i * keys.size() + k]));
    }
    return rows;
}

std::vector<std::vector<std::string>> sampled_rows(const Draft& draft, Reader& root) {
    const auto count = static_cast<int>(draft.keys.size());
    const bool sensitivity = draft.plan.design == Design::sensitivity;
    const std::size_t rows = draft.samples * (sensitivity ? draft.keys.size() + 2 : 1);
    if (rows > most_rows) {
        root.problem("samples", fmt::format("{} rows; at most {} are possible", rows, most_rows));
        return {};
    }
    if (sensitivity && 2 * count > most_sobol_dimensions) {
        root.problem("key", fmt::format("{} keys; a sensitivity takes at most {}", count, most_sobol_dimensions / 2));
        return {};
    }
    if (draft.plan.design == Design::latin_hypercube)
        return rows_of(latin_hypercube(draft.samples, count, draft.seed), draft.keys);
    if (sensitivity) return rows_of(saltelli_points(draft.samples, count, draft.seed), draft.keys);
    return rows_of(sobol_points(draft.samples, count, draft.seed), draft.keys);
}

/// The key of each column: one of the study file by name, or else a key of the file that the command reads.
Result<Key> key_of_column(const std::string& column, const Draft& draft, const std::string& place) {
    const std::string name(without_csv_unit(column)), unit(csv_unit(column));
    if (name.empty()) return input_error("{}: a column has no name", place);
    const auto known =
        std::find_if(draft.keys.begin(), draft.keys.end(), [&](const KeyChoice& k) { return k.key.name == name; });
    if (known != draft.keys.end()) {
        Key key = known->key;
        key.unit = unit;
        return key;
    }
    if (mentions(draft.plan.command, "{" + name + "}")) return Key{name, "", "", unit, true};
    return Key{name, name, "", unit, true};
}

Status read_table_rows(const CsvTable& table, Plan& plan) {
    for (const CsvRow& row : table.rows) {
        std::vector<std::string> values;
        for (std::size_t k = 0; k < plan.keys.size(); ++k) {
            const bool there = k < row.cells.size() && !row.cells[k].empty();
            if (!there)
                return input_error_at(table.file, row.line,
                                      "has no value of \"{}\"; every row needs one for each column", plan.keys[k].name);
            values.push_back(row.cells[k]);
            const auto measure = read_measure(row.cells[k]);
            const bool number = measure && measure->unit.empty();
            if (!number && !plan.keys[k].unit.empty())
                return input_error_at(table.file, row.line, "\"{}\" is not a number, but the column \"{}\" has a unit",
                                      row.cells[k], plan.keys[k].name);
            plan.keys[k].numeric = plan.keys[k].numeric && number;
        }
        plan.rows.push_back(std::move(values));
    }
    return {};
}

Status take_table(const std::string& text, const std::string& file, Draft& draft) {
    const auto table = parse_csv(text, file, "modulus (MPa),cable.flexor.target.length_ratio");
    if (!table) return tl::unexpected(table.error());
    Plan& plan = draft.plan;
    if (table->rows.size() > most_rows || table->columns.size() > most_keys)
        return input_error("{}: {} rows of {} columns; at most {} of {} are possible", file, table->rows.size(),
                           table->columns.size(), most_rows, most_keys);
    for (const std::string& column : table->columns) {
        auto key = key_of_column(column, draft, table->place(table->header_line));
        if (!key) return tl::unexpected(key.error());
        for (const Key& other : plan.keys) {
            if (other.name == key->name)
                return input_error_at(table->file, table->header_line, "two columns are named \"{}\"", key->name);
        }
        plan.keys.push_back(std::move(*key));
    }
    for (const KeyChoice& key : draft.keys) {
        if (std::none_of(plan.keys.begin(), plan.keys.end(), [&](const Key& k) { return k.name == key.key.name; }))
            return input_error_at(table->file, table->header_line, "has no column \"{}\", which is a key of the study",
                                  key.key.name);
    }
    return read_table_rows(*table, plan);
}

/// The keys of a table plan: how a column is passed to the command; the values are in the table.
std::vector<KeyChoice> read_table_keys(Reader& root, const std::vector<std::string>& command) {
    std::vector<KeyChoice> keys;
    for (auto& [name, table] : root.named_tables("key")) {
        keys.push_back({read_key(name, table, command), {}});
        table.finish();
    }
    return keys;
}

Draft read_draft(Reader& root, const StudyContext& context, const fs::path& file) {
    Draft draft;
    Plan& plan = draft.plan;
    plan.study = root.text("name", file.stem().string());
    plan.command = read_command(root, context);
    const std::vector<std::string> designs{"grid", "latin-hypercube", "sobol", "sensitivity", "table"};
    const std::string design = root.choice("plan", designs, "");
    plan.design = static_cast<Design>(std::find(designs.begin(), designs.end(), design) - designs.begin());
    const bool by_table = plan.design == Design::table;
    draft.keys = by_table ? read_table_keys(root, plan.command) : read_keys(root, plan.command);
    if (by_table) draft.table = root.text("table");
    if (!by_table && draft.keys.empty()) root.problem("key", "nothing varies; write [key.NAME] with set and range");
    if (!by_table && plan.design != Design::grid) {
        const auto samples = root.integer("samples");
        const auto seed = root.integer("seed", 1);
        if (samples < 1 || samples > static_cast<std::int64_t>(most_rows))
            root.problem("samples", "must be from 1 to 1000000");
        if (seed < 0) root.problem("seed", "must not be negative");
        draft.samples =
            static_cast<std::size_t>(std::clamp<std::int64_t>(samples, 1, static_cast<std::int64_t>(most_rows)));
        draft.seed = static_cast<std::uint64_t>(std::max<std::int64_t>(seed, 0));
    } else {
        for (const char* key : {"samples", "seed"})
            if (root.raw(key) != nullptr)
                root.problem(key,
                             "goes with sobol, latin-hypercube and sensitivity; a grid or table has rows of its own");
    }
    plan.results = read_results(root);
    plan.row_limit_s = root.quantity("row_limit", Dimension::time, 0.0);
    if (root.has("row_limit") && !(plan.row_limit_s > 0))
        root.problem("row_limit", "must be above zero, as in \"10 min\"");
    std::size_t rows_per_task = 0;
    plan.slurm = read_slurm(root.table("slurm", false), rows_per_task);
    plan.rows_per_chunk = rows_per_task;
    root.finish();
    return draft;
}

/// Piece by piece: a mesh may be larger than what one wants to hold. What cannot be read the command tells.
void add_file(const fs::path& path, Digest& digest) {
    std::error_code error;
    const std::string size = fmt::format("{}:", fs::file_size(path, error));
    if (error) return;
    digest.add(size.data(), size.size());
    std::ifstream in(path, std::ios::binary);
    std::vector<char> piece(std::size_t{1} << 20);
    while (in.read(piece.data(), static_cast<std::streamsize>(piece.size())) || in.gcount() > 0)
        digest.add(piece.data(), static_cast<std::size_t>(in.gcount()));
}

/// Rows depend on these bytes: any change makes a different study.
std::string fingerprint_of(std::string_view text, std::string_view table, const Plan& plan) {
    Digest digest;
    const auto add = [&digest](std::string_view bytes) {
        const std::string size = fmt::format("{}:", bytes.size());
        digest.add(size.data(), size.size());
        digest.add(bytes.data(), bytes.size());
    };
    add(plan.version);
    add(text);
    add(table);
    for (const fs::path& path : files_of(plan)) add_file(path, digest);
    return digest.text();
}

Status add_rows(Draft& draft, Reader& root, const std::string& table_text) {
    Plan& plan = draft.plan;
    if (plan.design == Design::table) return take_table(table_text, draft.table, draft);
    plan.rows = plan.design == Design::grid ? grid_rows(draft.keys, root) : sampled_rows(draft, root);
    for (const KeyChoice& key : draft.keys) plan.keys.push_back(key.key);
    if (plan.design == Design::sensitivity) plan.samples = draft.samples;
    return {};
}

/// A table's column has no place in the study file.
void report_clashes(const Plan& plan, Reader& root) {
    const bool by_table = plan.design == Design::table;
    for (const Clash& clash : clashes(plan)) {
        Reader owner = root.table(clash.where.substr(0, clash.where.find('.')), false);
        const std::string name = clash.where.substr(clash.where.find('.') + 1);
        if (!by_table || owner.has(name))
            owner.problem(name, clash.message);
        else
            root.problem("table", fmt::format("column \"{}\" {}", name, clash.message));
    }
}

}  // namespace

Result<Plan> parse_study(std::string_view text, const fs::path& file, const StudyContext& context) {
    const Result<config::Document> document = config::parse(text, file);
    if (!document) return tl::unexpected(document.error());
    config::Problems problems(file.string());
    Reader root(document->root, problems);
    Draft draft = read_draft(root, context, file);
    if (Status status = problems.status(); !status) return tl::unexpected(status.error());
    Plan& plan = draft.plan;
    plan.study_file = file.string();
    plan.version = context.version;
    std::error_code error;
    plan.folder = fs::absolute(file, error).parent_path();
    std::string table_text;
    if (plan.design == Design::table) {
        draft.table = (file.parent_path() / draft.table).string();
        auto read = read_file(draft.table, std::uintmax_t{64} << 20);
        if (!read) return tl::unexpected(read.error());
        table_text = std::move(*read);
    }
    if (Status status = add_rows(draft, root, table_text); !status) return tl::unexpected(status.error());
    report_clashes(plan, root);
    if (Status status = problems.status(); !status) return tl::unexpected(status.error());
    plan.fingerprint = fingerprint_of(text, table_text, plan);
    const std::size_t usual = usual_rows_per_chunk(plan.rows.size());
    plan.rows_per_chunk =
        plan.rows_per_chunk == 0 ? usual : std::max(plan.rows_per_chunk, (plan.rows.size() + 999) / 1000);
    return std::move(plan);
}

Result<Plan> load_study(const fs::path& file, const StudyContext& context) {
    constexpr std::uintmax_t largest = std::uintmax_t{16} << 20;
    const Result<std::string> text = read_file(file, largest);
    if (!text) return tl::unexpected(text.error());
    return parse_study(*text, file, context);
}

}  // namespace pliant::study
