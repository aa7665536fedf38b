#include "document.hpp"

#include <algorithm>
#include <cmath>
#include <regex>
#include <sstream>

namespace pliant::app {
namespace {

using Lines = std::vector<std::string>;

Lines lines_of(std::string_view text) {
    Lines lines;
    std::istringstream in{std::string(text)};
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    return lines;
}

std::string joined(const Lines& lines) {
    std::string text;
    for (const std::string& line : lines) text += line + "\n";
    return text;
}

bool is_gap(const std::string& line) {
    const std::size_t first = line.find_first_not_of(' ');
    return first != std::string::npos && line.substr(first) == "...";
}

bool is_fence(const std::string& line) {
    return line.starts_with("```");
}

/// Reads a document and collects its steps; comments apply to the next block or command.
class Reader {
public:
    explicit Reader(std::string_view text) : lines_(lines_of(text)) {}

    Result<std::vector<DocumentStep>> steps() {
        for (at_ = 0; at_ < lines_.size(); ++at_) {
            Status status;
            if (is_fence(lines_[at_]))
                status = fenced();
            else if (lines_[at_].starts_with("<!-- run: "))
                status = comment();
            else
                in_text();
            if (!status) return tl::unexpected(status.error());
        }
        if (pending_) return error("nothing follows that it could be for");
        return std::move(steps_);
    }

private:
    tl::unexpected<Error> error(std::string_view text) const {
        return input_error("line {}: {}", pending_ ? next_.line : static_cast<int>(at_) + 1, text);
    }

    Status comment() {
        static const std::regex form(R"(<!-- run: (\S+) ?(.*) -->)");
        std::smatch match;
        if (!std::regex_match(lines_[at_], match, form)) return error("a comment `run:` must end on its line");
        const std::string what = match[1], rest = match[2];
        if (what == "first") {
            steps_.push_back({DocumentStep::Kind::shell, line(), rest, {}, {}, false, {}, {}, 0, {}, {}});
            return {};
        }
        pending_ = true;
        next_.line = line();
        if (what == "save") return file_step(DocumentStep::Kind::save, rest, "");
        if (what == "insert") return file_step(DocumentStep::Kind::insert, rest, "before ");
        if (what == "replace") return file_step(DocumentStep::Kind::replace, rest, "");
        if (what == "with") return next_.options = " " + rest, Status{};
        if (what == "not") return next_.reason = rest, Status{};
        if (what == "Ctrl-C") return next_.interrupt_s = std::atoi(rest.substr(rest.rfind(' ') + 1).c_str()), Status{};
        if (what == "any") {
            std::istringstream in(rest);
            for (int number = 0; in >> number;) next_.any.insert(number);
            return {};
        }
        return error("there is no `run: " + what + "`");
    }

    /// "FILE", "before LINE in FILE" or "LINE; LINE in FILE".
    Status file_step(DocumentStep::Kind kind, std::string rest, std::string_view begin) {
        next_.kind = kind;
        if (kind == DocumentStep::Kind::save) return next_.file = rest, Status{};
        const std::size_t in = rest.rfind(" in ");
        if (!rest.starts_with(begin) || in == std::string::npos) return error("say which line, and `in FILE`");
        next_.file = rest.substr(in + 4);
        std::istringstream places(rest.substr(begin.size(), in - begin.size()));
        for (std::string place; std::getline(places >> std::ws, place, ';');) next_.places.push_back(place);
        return {};
    }

    Status fenced() {
        Lines block;
        const std::size_t first = at_ + 1;
        for (++at_; at_ < lines_.size() && !is_fence(lines_[at_]); ++at_) block.push_back(lines_[at_]);
        if (!next_.file.empty()) {
            next_.text = joined(block);
            take(next_.text);
            return {};
        }
        const std::string reason = next_.reason;  // applies to all commands of the block
        for (std::size_t i = 0; i < block.size();) {
            if (!block[i].starts_with("$ ")) {
                ++i;
                continue;
            }
            std::size_t end = i + 1;
            while (end < block.size() && !block[end].starts_with("$ ")) ++end;
            next_.line = static_cast<int>(first + i) + 1;
            next_.shows_output = true;
            next_.reason = reason;
            next_.output.assign(block.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                                block.begin() + static_cast<std::ptrdiff_t>(end));
            while (!next_.output.empty() && next_.output.back().empty()) next_.output.pop_back();
            take(block[i].substr(2));
            i = end;
        }
        return {};
    }

    void in_text() {
        static const std::regex indented(R"(    (pliant .*))"), quoted(R"(`(pliant .*)`)");
        static const std::regex placeholder(R"(\[|\||\.\.\.|(^| |=)[A-Z]+([ .]|$))");
        std::smatch match;
        const std::string& text = lines_[at_];
        if (!std::regex_match(text, match, indented) && !std::regex_match(text, match, quoted)) return;
        const std::string command = match[1];
        if (std::regex_search(command, placeholder)) return;
        next_.line = line();
        take(command);
    }

    void take(const std::string& text) {
        next_.text = text;
        if (!next_.reason.empty()) next_.kind = DocumentStep::Kind::skipped;
        steps_.push_back(std::move(next_));
        next_ = {};
        pending_ = false;
    }

    [[nodiscard]] int line() const { return static_cast<int>(at_) + 1; }

    Lines lines_;
    std::size_t at_ = 0;
    DocumentStep next_;
    bool pending_ = false;
    std::vector<DocumentStep> steps_;
};

struct Number {
    double value = 0;
    double last_digit = 1;
    std::string before;  ///< text since the last number, with runs of spaces as one
};

/// A line as numbers, each with the words before it; the last entry has the remaining words and no value.
std::vector<Number> numbers_of(const std::string& line) {
    static const std::regex form(R"((\d+):(\d\d):(\d\d)|[-+]?\d+(\.\d+)?([eE][-+]?\d+)?)");
    static const std::regex spaces(R"(\s+)");
    std::vector<Number> numbers;
    auto at = line.cbegin();
    const auto words = [&](std::string::const_iterator end) {
        return std::regex_replace(std::string(at, end), spaces, " ");
    };
    for (std::sregex_iterator it(line.begin(), line.end(), form), end; it != end; ++it) {
        const std::smatch& m = *it;
        Number number;
        number.before = words(m[0].first);
        at = m[0].second;
        if (m[1].matched) {
            number.value = std::stod(m[1]) * 3600 + std::stod(m[2]) * 60 + std::stod(m[3]);
        } else {
            number.value = std::strtod(m[0].str().c_str(), nullptr);
            const double decimals = m[4].matched ? static_cast<double>(m[4].length() - 1) : 0;
            const double exponent = m[5].matched ? std::strtod(m[5].str().c_str() + 1, nullptr) : 0;
            number.last_digit = std::pow(10, exponent - decimals);
        }
        numbers.push_back(number);
    }
    numbers.push_back({0, 0, words(line.cend())});
    return numbers;
}

bool same_number(const Number& shown, const Number& printed) {
    for (const char* free : {"step in ", "steps in ", "residual "}) {
        if (shown.before.ends_with(free)) return true;
    }
    constexpr double share = 5e-3, digits = 2.001;
    return std::fabs(shown.value - printed.value) <=
           std::max(share * std::fabs(shown.value), digits * std::max(shown.last_digit, printed.last_digit));
}

bool same_line(const std::string& shown, const std::string& printed, const std::set<int>& any) {
    const std::vector<Number> a = numbers_of(shown), b = numbers_of(printed);
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (a[i].before != b[i].before) return false;
        if (i + 1 < a.size() && !any.contains(static_cast<int>(i) + 1) && !same_number(a[i], b[i])) return false;
    }
    return true;
}

/// Number of lines that a place covers: for a table all up to the next comment or header.
std::size_t extent(const Lines& lines, std::size_t at) {
    if (!lines[at].starts_with("[")) return 1;
    std::size_t end = at + 1;
    while (end < lines.size() && !lines[end].starts_with("[")) ++end;
    return end - at;
}

}  // namespace

Result<std::vector<DocumentStep>> document_steps(std::string_view text) {
    return Reader(text).steps();
}

Result<std::string> edited(std::string_view file, const DocumentStep& step) {
    if (step.kind == DocumentStep::Kind::save) return step.text;
    const Lines lines = lines_of(file);
    std::vector<bool> stays(lines.size(), true);
    std::size_t at = lines.size();
    for (const std::string& place : step.places) {
        const auto found =
            std::find_if(lines.begin(), lines.end(), [&](const std::string& line) { return line.starts_with(place); });
        if (found == lines.end())
            return input_error("line {}: no line of {} begins with {}", step.line, step.file, place);
        const auto first = static_cast<std::size_t>(found - lines.begin());
        at = std::min(at, first);
        if (step.kind != DocumentStep::Kind::replace) continue;
        for (std::size_t i = first; i < first + extent(lines, first); ++i) stays[i] = false;
    }
    std::string text;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        if (i == at) text += step.text + (lines[i].starts_with("[") ? "\n" : "");
        if (stays[i]) text += lines[i] + "\n";
    }
    return text;
}

std::string difference(const DocumentStep& step, const std::vector<std::string>& printed) {
    if (!step.shows_output) return "";
    std::size_t at = 0;
    bool skipping = false;
    for (const std::string& shown : step.output) {
        if (is_gap(shown)) {
            skipping = true;
            continue;
        }
        while (skipping && at < printed.size() && !same_line(shown, printed[at], step.any)) ++at;
        if (at == printed.size()) return fmt::format("shown:   {}\nprinted: nothing more", shown);
        if (!same_line(shown, printed[at], step.any))
            return fmt::format("shown:   {}\nprinted: {}", shown, printed[at]);
        ++at;
        skipping = false;
    }
    if (skipping || step.interrupt_s > 0 || at == printed.size()) return "";
    return fmt::format("shown:   nothing more\nprinted: {}", printed[at]);
}

std::string updated(std::string_view text, const std::vector<DocumentStep>& steps,
                    const std::vector<std::vector<std::string>>& printed) {
    Lines lines = lines_of(text);
    for (std::size_t i = steps.size(); i-- > 0;) {
        const DocumentStep& step = steps[i];
        const bool has_gap = std::any_of(step.output.begin(), step.output.end(), is_gap);
        if (step.kind != DocumentStep::Kind::command || !step.shows_output || has_gap || step.interrupt_s > 0) continue;
        const auto first = lines.begin() + step.line;
        const auto at = lines.erase(first, first + static_cast<std::ptrdiff_t>(step.output.size()));
        lines.insert(at, printed[i].begin(), printed[i].end());
    }
    return joined(lines);
}

}  // namespace pliant::app
