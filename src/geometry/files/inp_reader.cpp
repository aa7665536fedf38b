// Abaqus and CalculiX input decks: *NODE, *ELEMENT with all variants of C3D4 and C3D10, and element sets. All else in a
// deck (other elements, materials, steps) is ignored. Format: Abaqus keywords reference guide, *NODE, *ELEMENT, *ELSET,
// *SOLID SECTION; CalculiX CrunchiX user's manual 2.20, chapter 7. Keywords and set names are case-insensitive.
//
// The region of a tet is the element set that a *SOLID SECTION names for it; else the set of its *ELEMENT card; else
// the smallest *ELSET that contains it. A comment of our own keeps names that are not valid labels: ** region R1 "left
// half".
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>

#include "base/core/letters.hpp"
#include "geometry/files/tet_file.hpp"
#include "geometry/files/text_tets.hpp"

namespace pliant::mesh {
namespace {

constexpr int no_set = -1;

/// A keyword line without its star: "ELEMENT, TYPE=C3D4, ELSET=left".
struct Card {
    std::string keyword;                                          ///< lower case
    std::vector<std::pair<std::string, std::string>> parameters;  ///< name in lower case, value as written

    [[nodiscard]] std::string value(std::string_view name) const {
        for (const auto& [key, value] : parameters) {
            if (key == name) return value;
        }
        return "";
    }
    [[nodiscard]] bool has(std::string_view name) const {
        return std::any_of(parameters.begin(), parameters.end(), [&](const auto& p) { return p.first == name; });
    }
};

std::vector<std::string_view> fields(std::string_view line) {
    std::vector<std::string_view> out;
    while (true) {
        const std::size_t comma = std::min(line.find(','), line.size());
        out.push_back(trimmed(line.substr(0, comma)));
        if (comma == line.size()) break;
        line.remove_prefix(comma + 1);
    }
    if (out.back().empty()) out.pop_back();  // a comma at the end
    return out;
}

std::string_view without_quotes(std::string_view text) {
    const bool quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
    return quoted ? text.substr(1, text.size() - 2) : text;
}

Card parse_card(std::string_view line) {
    Card card;
    for (const std::string_view field : fields(line.substr(1))) {
        const std::size_t equals = field.find('=');
        if (card.keyword.empty())
            card.keyword = lower_case(field);
        else if (equals == std::string_view::npos)
            card.parameters.emplace_back(lower_case(field), "");
        else
            card.parameters.emplace_back(lower_case(trimmed(field.substr(0, equals))),
                                         std::string(without_quotes(trimmed(field.substr(equals + 1)))));
    }
    return card;
}

template <class Number>
std::optional<Number> parsed(std::string_view text) {
    if (text.starts_with('+')) text.remove_prefix(1);
    Number value{};
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (code != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

/// "1.5D-3" is Fortran notation.
std::optional<double> parsed_real(std::string_view text) {
    constexpr std::size_t longest = 64;
    if (text.empty()) return 0.0;
    if (text.size() > longest) return std::nullopt;
    std::string plain(text);
    for (char& c : plain) c = c == 'D' || c == 'd' ? 'e' : c;
    const auto value = parsed<double>(plain);
    return value && std::isfinite(*value) ? value : std::nullopt;
}

/// Nodes of a tetrahedral element type; 0 for any other type.
std::size_t tet_width(const std::string& type) {
    const std::string lower = lower_case(type);
    if (lower.starts_with("c3d10") || lower.starts_with("dc3d10")) return 10;
    if (lower.starts_with("c3d4") || lower.starts_with("dc3d4")) return 4;
    return 0;
}

class InpReader {
public:
    InpReader(std::string_view text, std::string name) : scan_(text, name), name_(std::move(name)) {}

    Result<TetMesh> read() {
        while (!scan_.at_end()) {
            line_ = scan_.line();
            const std::string_view line = scan_.rest_of_line();
            Status status;
            if (line.starts_with("**"))
                keep_name(line.substr(2));
            else if (line.starts_with('*'))
                status = begin_card(parse_card(with_continuations(line)));
            else if (!line.empty())
                status = read_data(line);
            if (!status) return tl::unexpected(status.error());
        }
        if (!wanted_.empty()) return error("the file ends in the middle of an element");
        assign_regions();
        if (visits_ > most_visits) return error("its element sets contain one another too often to tell regions apart");
        return finish(std::move(found_), name_);
    }

private:
    enum class Data { none, nodes, tets, set };

    [[nodiscard]] tl::unexpected<Error> error(std::string_view text) const {
        return input_error_at(name_, line_, "{}", text);
    }

    /// A keyword's line that ends with a comma goes on in the next one.
    std::string with_continuations(std::string_view line) {
        std::string whole(line);
        while (trimmed(whole).ends_with(',') && !scan_.at_end()) whole += scan_.rest_of_line();
        return whole;
    }

    /// `** region LABEL "name"`.
    void keep_name(std::string_view comment) {
        TextScanner words(comment, name_);
        if (words.word() != "region") return;
        const std::string label = lower_case(words.word());
        const std::string_view rest = words.rest_of_line();
        if (rest.size() > 2 && rest.front() == '"' && rest.back() == '"')
            written_names_[label] = std::string(rest.substr(1, rest.size() - 2));
    }

    Status begin_card(Card card) {
        if (!wanted_.empty()) return error("the nodes of an element are missing before this keyword");
        card_ = std::move(card);
        data_ = Data::none;
        if (card_.keyword == "include") return error("*INCLUDE is not followed; put the included lines in its place");
        if (card_.has("input") && is_read())
            return error("*" + card_.keyword + " with INPUT=FILE is not followed; put the lines of the file below it");
        constexpr std::array<std::string_view, 7> generators = {"elgen", "ngen",   "elcopy", "ncopy",
                                                                "nfill", "elfill", "nmap"};
        if (std::ranges::find(generators, card_.keyword) != generators.end())
            return error("*" + card_.keyword + " makes nodes or elements that the file does not list; write them out");
        const std::string system = card_.keyword == "node" ? lower_case(card_.value("system")) : "";
        if (card_.keyword == "system" || (!system.empty() && system != "r"))
            return error("nodes in another system of coordinates are not read; write them in x, y and z");
        if (card_.keyword == "instance") return begin_instance();
        if (card_.keyword == "node") data_ = Data::nodes;
        if (card_.keyword == "element") begin_elements();
        if (card_.keyword == "elset") {
            data_ = Data::set;
            set_ = set_number(card_.value("elset"));
        }
        if (card_.keyword == "solid section" && card_.has("elset")) {
            const int set = set_number(card_.value("elset"));
            if (set >= 0) sets_[static_cast<std::size_t>(set)].section = true;
        }
        return {};
    }

    /// Cards whose lines make up the mesh.
    [[nodiscard]] bool is_read() const {
        return card_.keyword == "node" || card_.keyword == "elset" ||
               (card_.keyword == "element" && tet_width(card_.value("type")) > 0);
    }

    /// Parts keep their coordinates; assemblies of several parts, or of a moved one, are not supported.
    Status begin_instance() {
        if (++instances_ > 1) return error("an assembly of several instances is not read; write it as one part");
        return {};
    }

    void begin_elements() {
        width_ = tet_width(card_.value("type"));
        data_ = width_ > 0 ? Data::tets : Data::none;
        set_ = card_.has("elset") ? set_number(card_.value("elset")) : no_set;
    }

    Status read_data(std::string_view line) {
        switch (data_) {
            case Data::nodes:
                return read_node(line);
            case Data::tets:
                return read_element(line);
            case Data::set:
                return read_set(line);
            case Data::none:
                break;
        }
        if (card_.keyword == "instance") return error("an instance that is moved or turned is not read");
        return {};
    }

    Status read_node(std::string_view line) {
        const auto words = fields(line);
        const auto number = words.empty() ? std::nullopt : parsed<std::int64_t>(words.front());
        if (!number) return error("a node begins with its number");
        Vec3 p;
        for (std::size_t k = 0; k < 3 && k + 1 < words.size(); ++k) {
            const auto value = parsed_real(words[k + 1]);
            if (!value) return error(fmt::format("\"{}\" is not a finite number", words[k + 1].substr(0, 40)));
            p[k] = *value;
        }
        if (!found_.points.add(*number, p)) return error(fmt::format("node {} comes twice", *number));
        return {};
    }

    /// Number and nodes; a line that ends with a comma continues on the next.
    Status read_element(std::string_view line) {
        for (const std::string_view word : fields(line)) {
            const auto number = parsed<std::int64_t>(word);
            if (!number) return error(fmt::format("\"{}\" is not a whole number", word.substr(0, 40)));
            wanted_.push_back(*number);
        }
        if (wanted_.size() <= width_) {
            if (line.ends_with(',')) return {};
            return error(fmt::format("an element of {} nodes has {}", width_, wanted_.size() - 1));
        }
        if (wanted_.size() > width_ + 1)
            return error(fmt::format("an element of {} nodes has {}", width_, wanted_.size() - 1));
        TenNodes nodes;
        nodes.fill(-1);
        for (std::size_t a = 0; a < width_; ++a) {
            nodes[a] = found_.points.find(wanted_[a + 1]);
            if (nodes[a] < 0)
                return error(
                    fmt::format("element {} refers to node {}, which does not exist", wanted_[0], wanted_[a + 1]));
        }
        by_number_.emplace_back(wanted_[0], found_.tets.size());
        if (set_ >= 0) sets_[static_cast<std::size_t>(set_)].tets.push_back(found_.tets.size());
        found_.tets.push_back(nodes);
        wanted_.clear();
        return {};
    }

    struct Set {
        std::string name;
        std::vector<std::int64_t> elements;
        std::vector<std::array<std::int64_t, 3>> ranges;  ///< first, last, step of GENERATE
        std::vector<int> sets;                            ///< sets that it contains
        std::vector<std::size_t> tets;                    ///< of its *ELEMENT cards
        bool section = false;
    };

    int set_number(const std::string& name) {
        if (name.empty()) return no_set;
        const auto [entry, fresh] = set_of_name_.try_emplace(lower_case(name), static_cast<int>(sets_.size()));
        if (fresh) sets_.push_back({name, {}, {}, {}, {}, false});
        return entry->second;
    }

    Status read_set(std::string_view line) {
        if (set_ < 0) return error("*ELSET needs ELSET=NAME");
        const auto words = fields(line);
        if (card_.has("generate")) return read_range(words);
        for (const std::string_view word : words) {
            const auto number = parsed<std::int64_t>(word);
            if (number) {
                sets_[static_cast<std::size_t>(set_)].elements.push_back(*number);
            } else if (!word.empty()) {
                const int inner = set_number(std::string(word));
                sets_[static_cast<std::size_t>(set_)].sets.push_back(inner);
            }
        }
        return {};
    }

    Status read_range(const std::vector<std::string_view>& words) {
        std::array<std::int64_t, 3> range = {0, 0, 1};
        for (std::size_t i = 0; i < std::min<std::size_t>(3, words.size()); ++i) {
            const auto number = parsed<std::int64_t>(words[i]);
            if (!number) return error(fmt::format("\"{}\" is not a whole number", words[i].substr(0, 40)));
            range[i] = *number;
        }
        if (words.size() < 2 || range[2] < 1) return error("GENERATE needs first, last and a step above zero");
        sets_[static_cast<std::size_t>(set_)].ranges.push_back(range);
        return {};
    }

    /// Calls `use` with every tet of a set, but not of the sets that were seen; nested sets are followed once each.
    template <class Use>
    void each_tet(std::size_t set, std::vector<bool>& seen, const Use& use) {
        for (std::vector<std::size_t> open = {set}; !open.empty() && visits_ <= most_visits;) {
            const std::size_t s = open.back();
            open.pop_back();
            if (seen[s]) continue;
            seen[s] = true;
            visits_ += 1 + sets_[s].sets.size() + sets_[s].tets.size();
            for (const std::int64_t element : sets_[s].elements) each_in_range({element, element, 1}, use);
            for (const auto& range : sets_[s].ranges) each_in_range(range, use);
            for (const std::size_t t : sets_[s].tets) use(t);
            for (const int inner : sets_[s].sets) open.push_back(static_cast<std::size_t>(inner));
        }
    }

    template <class Use>
    void each_in_range(const std::array<std::int64_t, 3>& range, const Use& use) {
        const auto& [first, last, step] = range;
        auto at = std::lower_bound(by_number_.begin(), by_number_.end(), std::pair(first, std::size_t{0}));
        for (; at != by_number_.end() && at->first <= last && ++visits_ <= most_visits; ++at) {
            const std::uint64_t away = static_cast<std::uint64_t>(at->first) - static_cast<std::uint64_t>(first);
            if (away % static_cast<std::uint64_t>(step) == 0) use(at->second);
        }
    }

    /// Assigns the set to its tets that have no region yet. All tets of a set that another one has claimed have one.
    void claim(std::size_t set) {
        each_tet(set, claimed_, [&](std::size_t t) {
            if (found_.regions[t] == no_set) found_.regions[t] = static_cast<std::int64_t>(set);
        });
    }

    void assign_regions() {
        std::sort(by_number_.begin(), by_number_.end());
        found_.regions.assign(found_.tets.size(), no_set);
        claimed_.assign(sets_.size(), false);
        for (std::size_t s = 0; s < sets_.size(); ++s) {
            if (sets_[s].section) claim(s);
        }
        for (std::size_t s = 0; s < sets_.size(); ++s) {
            for (const std::size_t t : sets_[s].tets) {
                if (found_.regions[t] == no_set) found_.regions[t] = static_cast<std::int64_t>(s);
            }
        }
        if (std::count(found_.regions.begin(), found_.regions.end(), no_set) > 0) claim_by_size();
        for (std::int64_t& region : found_.regions) region = std::max<std::int64_t>(region, no_set) + 1;
        for (std::size_t s = 0; s < sets_.size(); ++s) {
            const auto written = written_names_.find(lower_case(sets_[s].name));
            found_.names[static_cast<std::int64_t>(s) + 1] =
                written == written_names_.end() ? sets_[s].name : written->second;
        }
    }

    void claim_by_size() {
        std::vector<std::pair<std::size_t, std::size_t>> by_size;  // (tets, set)
        for (std::size_t s = 0; s < std::min<std::size_t>(sets_.size(), most_sets); ++s) {
            std::size_t size = 0;
            std::vector<bool> seen(sets_.size());
            each_tet(s, seen, [&](std::size_t) { ++size; });
            by_size.emplace_back(size, s);
        }
        std::sort(by_size.begin(), by_size.end());
        for (const auto& [size, set] : by_size) claim(set);
    }

    /// Maximum number of sets that can become regions by size alone: every one may contain every tet.
    static constexpr std::size_t most_sets = 1000;
    /// Bounds the time that sets within sets can take: some seconds.
    static constexpr std::uint64_t most_visits = 2'000'000'000;

    TextScanner scan_;
    std::string name_;
    int line_ = 1;
    Card card_;
    Data data_ = Data::none;
    std::size_t width_ = 0;
    int set_ = no_set;
    int instances_ = 0;
    std::vector<std::int64_t> wanted_;  ///< number and nodes of the element being read
    TextTets found_;
    std::vector<std::pair<std::int64_t, std::size_t>> by_number_;  ///< (number of the element, tet)
    std::vector<Set> sets_;
    std::vector<bool> claimed_;               ///< (sets)
    std::uint64_t visits_ = 0;                ///< of sets and tets
    std::map<std::string, int> set_of_name_;  ///< by lower case
    std::map<std::string, std::string> written_names_;
};

}  // namespace

Result<TetMesh> parse_inp(std::string_view bytes, const std::string& name) {
    return InpReader(bytes, name).read();
}

}  // namespace pliant::mesh
