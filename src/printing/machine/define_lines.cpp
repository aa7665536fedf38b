#include "printing/machine/define_lines.hpp"

#include <algorithm>

namespace pliant::machine {
namespace {

bool is_blank(char c) {
    return c == ' ' || c == '\t';
}

bool is_name(char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
}

std::size_t skip_blanks(std::string_view line, std::size_t at) {
    while (at < line.size() && is_blank(line[at])) ++at;
    return at;
}

std::string_view without_blanks(std::string_view text) {
    text.remove_prefix(skip_blanks(text, 0));
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
}

bool goes_on(std::string_view line) {
    line = without_blanks(line);
    return !line.empty() && line.back() == '\\';
}

/// The start of a comment, `//` or `/*`, outside strings and character literals; the line's size if there is none.
std::size_t comment_at(std::string_view line, std::size_t at) {
    char quote = 0;
    for (; at < line.size(); ++at) {
        if (quote != 0) {
            if (line[at] == '\\')
                ++at;
            else if (line[at] == quote)
                quote = 0;
        } else if (line[at] == '"' || line[at] == '\'') {
            quote = line[at];
        } else if (line[at] == '/' && at + 1 < line.size() && (line[at + 1] == '/' || line[at + 1] == '*')) {
            return at;
        }
    }
    return line.size();
}

/// Whether a block comment is open at the end of `line`, given whether one was at its beginning.
bool stays_in_comment(std::string_view line, bool inside) {
    std::size_t at = 0;
    for (;;) {
        if (inside) {
            at = line.find("*/", at);
            if (at == std::string_view::npos) return true;
            at += 2;
        }
        at = comment_at(line, at);
        if (at >= line.size() || line[at + 1] == '/') return false;
        at += 2;
        inside = true;
    }
}

/// The parts of the first line of a #define, as offsets.
struct Parts {
    std::size_t slashes = 0;          ///< offset of `//`, or equal to `hash`
    std::size_t hash = 0;             ///< offset of `#define`
    std::size_t name = 0, value = 0;  ///< where they begin; the value without leading blanks
    std::size_t name_end = 0;
    std::size_t value_end = 0;  ///< without trailing blanks
    std::size_t comment = 0;    ///< the line's size if there is no comment
};

bool split(std::string_view line, Parts& p) {
    constexpr std::string_view define = "#define";
    p.slashes = p.hash = skip_blanks(line, 0);
    if (line.substr(p.hash, 2) == "//") {
        p.hash += 2;
        while (p.hash < line.size() && line[p.hash] == '/') ++p.hash;
        p.hash = skip_blanks(line, p.hash);
    }
    if (line.substr(p.hash, define.size()) != define) return false;
    p.name = skip_blanks(line, p.hash + define.size());
    if (p.name == p.hash + define.size()) return false;
    p.name_end = p.name;
    while (p.name_end < line.size() && is_name(line[p.name_end])) ++p.name_end;
    if (p.name_end == p.name || (p.name_end < line.size() && line[p.name_end] == '(')) return false;
    p.value = skip_blanks(line, p.name_end);
    p.comment = comment_at(line, p.value);
    p.value_end = p.comment;
    while (p.value_end > p.value && is_blank(line[p.value_end - 1])) --p.value_end;
    return true;
}

std::string without_comment(std::string_view line) {
    line = without_blanks(line.substr(0, comment_at(line, 0)));
    if (!line.empty() && line.back() == '\\') line.remove_suffix(1);
    return std::string(without_blanks(line));
}

/// Removes `//` from the beginning of a line.
void uncomment(std::string& line) {
    const std::size_t at = skip_blanks(line, 0);
    std::size_t end = at;
    while (end < line.size() && line[end] == '/') ++end;
    if (end >= at + 2) line.erase(at, end - at);
}

}  // namespace

DefineLines::DefineLines(std::string_view text) {
    while (!text.empty()) {
        const std::size_t at = text.find('\n');
        const std::size_t next = at == std::string_view::npos ? text.size() : at + 1;
        std::size_t end = std::min(at, text.size());
        if (end < next && end > 0 && text[end - 1] == '\r') --end;
        lines_.push_back({std::string(text.substr(0, end)), std::string(text.substr(end, next - end))});
        text.remove_prefix(next);
    }
    scan();
}

void DefineLines::scan() {
    defines_.clear();
    bool in_comment = false;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
        Parts p;
        if (!in_comment && split(lines_[i].text, p)) {
            DefineLine d;
            d.name = lines_[i].text.substr(p.name, p.name_end - p.name);
            d.active = p.slashes == p.hash;
            d.first_line = i;
            d.value = without_comment(std::string_view(lines_[i].text).substr(p.value));
            while (goes_on(lines_[i].text) && i + 1 < lines_.size()) {
                std::string more = lines_[++i].text;
                if (!d.active) uncomment(more);
                d.value += " " + without_comment(more);
                ++d.lines;
            }
            in_comment = d.active && stays_in_comment(lines_[i].text, false);
            defines_.push_back(std::move(d));
            continue;
        }
        in_comment = stays_in_comment(lines_[i].text, in_comment);
    }
}

std::vector<DefineLine> DefineLines::find(std::string_view name) const {
    std::vector<DefineLine> found;
    std::copy_if(defines_.begin(), defines_.end(), std::back_inserter(found),
                 [&](const DefineLine& d) { return d.name == name; });
    return found;
}

void DefineLines::set(std::string_view name, std::string_view value) {
    std::vector<DefineLine> places = find(name);
    std::reverse(places.begin(), places.end());  // from the end, because removing a line shifts only those after it
    for (const DefineLine& d : places) {
        const auto first = lines_.begin() + static_cast<std::ptrdiff_t>(d.first_line);
        const auto end = first + static_cast<std::ptrdiff_t>(d.lines);
        if (value == "on" || value == "off") {
            if (d.active == (value == "on")) continue;
            std::for_each(first, end, [&](Line& line) {
                if (value == "on")
                    uncomment(line.text);
                else
                    line.text.insert(skip_blanks(line.text, 0), "//");
            });
            continue;
        }
        lines_.erase(first + 1, end);
        std::string& line = lines_[d.first_line].text;
        if (!d.active) uncomment(line);
        Parts p;
        split(line, p);
        const std::string comment = line.substr(p.comment);
        const std::string before = line.substr(p.value_end, p.comment - p.value_end);
        line.erase(p.value);
        if (p.value == p.name_end) line += ' ';
        line += value;
        if (!comment.empty()) line += (before.empty() ? " " : before) + comment;
    }
    scan();
}

void DefineLines::append(std::string_view line) {
    const std::string end = lines_.empty() || lines_.front().end.empty() ? "\n" : lines_.front().end;
    if (!lines_.empty()) lines_.back().end = end;
    lines_.push_back({std::string(line), end});
    scan();
}

std::string DefineLines::text() const {
    std::string text;
    for (const Line& line : lines_) text += line.text + line.end;
    return text;
}

}  // namespace pliant::machine
