#include "geometry/threemf/xml_part.hpp"

#include <algorithm>
#include <charconv>
#include <climits>
#include <cmath>
#include <memory>

#include "base/core/letters.hpp"

namespace pliant::threemf {
namespace {

Space space_at(std::string_view address) {
    if (address == "http://schemas.microsoft.com/3dmanufacturing/core/2015/02") return Space::core;
    if (address == "http://schemas.microsoft.com/3dmanufacturing/material/2015/02") return Space::material;
    if (address == "http://schemas.microsoft.com/3dmanufacturing/production/2015/06") return Space::production;
    if (address == "http://schemas.microsoft.com/3dmanufacturing/slice/2015/07") return Space::slice;
    return Space::none;
}

int line_at(std::string_view text, std::size_t offset) {
    return 1 + static_cast<int>(std::count(text.begin(), text.begin() + std::min(offset, text.size()), '\n'));
}

bool declared(pugi::xml_node node, std::string_view prefix) {
    if (prefix.empty() || prefix == "xml" || prefix == "xmlns") return true;
    for (; node; node = node.parent()) {
        for (const pugi::xml_attribute& a : node.attributes()) {
            const auto [space, local] = split_name(a.name());
            if (space == "xmlns" && local == prefix) return true;
        }
    }
    return false;
}

/// The encoding that a text declares, in lower case; "" if none.
std::string declared_encoding(std::string_view text) {
    const std::string_view head = text.substr(0, text.substr(0, 1024).find("?>"));
    const std::size_t declaration = head.find("<?xml");
    const std::size_t key = head.find("encoding");
    if (declaration == std::string_view::npos || declaration > 3 || key == std::string_view::npos) return {};
    const std::size_t begin = head.find_first_of("\"'", key);
    if (begin == std::string_view::npos) return {};
    const std::size_t end = head.find(head[begin], begin + 1);
    return end == std::string_view::npos ? std::string() : lower_case(head.substr(begin + 1, end - begin - 1));
}

}  // namespace

std::pair<std::string_view, std::string_view> split_name(std::string_view name) {
    const std::size_t colon = name.find(':');
    if (colon == std::string_view::npos) return {"", name};
    return {name.substr(0, colon), name.substr(colon + 1)};
}

pugi::xml_node next_in_document(pugi::xml_node node) {
    if (node.first_child()) return node.first_child();
    while (node && !node.next_sibling()) node = node.parent();
    return node.next_sibling();
}

Result<XmlPart> XmlPart::parse(std::string text, std::string name) {
    XmlPart part;
    part.name_ = std::move(name);
    part.text_ = std::move(text);
    if (const std::string encoding = declared_encoding(part.text_);
        !encoding.empty() && encoding != "utf-8" && encoding != "utf-16")
        return input_error("{}: is encoded as \"{}\"; 3MF allows UTF-8 and UTF-16 only", part.name_, encoding);
    part.document_ = std::make_unique<pugi::xml_document>();
    const auto result =
        part.document_->load_buffer(part.text_.data(), part.text_.size(), pugi::parse_default | pugi::parse_doctype);
    if (!result)
        return input_error_at(part.name_,
                              line_at(part.text_, static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, result.offset))),
                              "is not well-formed XML: {}", result.description());
    int roots = 0;
    for (const pugi::xml_node& node : part.document_->children()) {
        if (node.type() == pugi::node_doctype)
            return input_error("{}: holds a document type definition, which 3MF forbids", part.name_);
        if (node.type() == pugi::node_element && ++roots > 1)
            return input_error_at(part.name_, part.line_of(node), "a second root element <{}>, one is allowed",
                                  node.name());
    }
    for (const pugi::xml_attribute& a : part.root().attributes()) {
        const auto [space, local] = split_name(a.name());
        if (space == "xmlns") part.addresses_[std::string(local)] = a.value();
        if (space.empty() && local == "xmlns") part.addresses_[""] = a.value();
    }
    if (auto status = part.check_names(); !status) return tl::unexpected(status.error());
    return part;
}

Status XmlPart::check_names() const {
    for (pugi::xml_node node = root(); node; node = next_in_document(node)) {
        if (node.type() != pugi::node_element) continue;
        const auto check = [&](std::string_view name) {
            const std::string_view prefix = split_name(name).first;
            return prefix.empty() || addresses_.contains(prefix) || declared(node, prefix);
        };
        if (!check(node.name()))
            return input_error("{}", at(node, "is not well-formed XML: the prefix has no namespace"));
        for (const pugi::xml_attribute& a : node.attributes()) {
            if (!check(a.name()))
                return input_error(
                    "{}", at(node, fmt::format("is not well-formed XML: the prefix of {} has no namespace", a.name())));
        }
    }
    return {};
}

Space XmlPart::space_of(std::string_view prefix) const {
    return space_at(address_of_prefix(prefix));
}

std::string_view XmlPart::address_of_prefix(std::string_view prefix) const {
    const auto found = addresses_.find(prefix);
    return found == addresses_.end() ? std::string_view() : std::string_view(found->second);
}

bool XmlPart::is(const pugi::xml_node& node, Space space, std::string_view local) const {
    const auto [prefix, name] = split_name(node.name());
    return name == local && node.type() == pugi::node_element && space_of(prefix) == space;
}

pugi::xml_node XmlPart::child(const pugi::xml_node& node, Space space, std::string_view local) const {
    for (const pugi::xml_node& c : node.children()) {
        if (is(c, space, local)) return c;
    }
    return {};
}

std::vector<pugi::xml_node> XmlPart::children(const pugi::xml_node& node, Space space, std::string_view local) const {
    std::vector<pugi::xml_node> found;
    for (const pugi::xml_node& c : node.children()) {
        if (is(c, space, local)) found.push_back(c);
    }
    return found;
}

std::string_view XmlPart::attribute(const pugi::xml_node& node, Space space, std::string_view local) const {
    for (const pugi::xml_attribute& a : node.attributes()) {
        const auto [prefix, name] = split_name(a.name());
        if (!prefix.empty() && name == local && space_of(prefix) == space) return a.value();
    }
    return {};
}

int XmlPart::line_of(const pugi::xml_node& node) const {
    return line_at(text_, static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, node.offset_debug())));
}

std::string XmlPart::at(const pugi::xml_node& node, std::string_view text) const {
    return fmt::format("{}:{}: <{}>: {}", name_, line_of(node), node.name(), text);
}

std::string_view XmlPart::needed(const pugi::xml_node& node, const char* key, Problem& problem) const {
    const std::string_view value = node.attribute(key).value();
    if (value.empty()) problem.note(at(node, fmt::format("needs an attribute {}", key)));
    return value;
}

double XmlPart::number(const pugi::xml_node& node, const char* key, Problem& problem) const {
    std::string_view text = needed(node, key, problem);
    while (!text.empty() && (text.front() == ' ' || text.front() == '+')) text.remove_prefix(1);
    while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
    double value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (code == std::errc() && end == text.data() + text.size() && std::isfinite(value)) return value;
    problem.note(at(node, fmt::format("{}=\"{}\" is not a finite number", key, text)));
    return 0;
}

int XmlPart::index(const pugi::xml_node& node, const char* key, Problem& problem) const {
    (void)needed(node, key, problem);
    return index_or(node, key, 0, problem);
}

int XmlPart::index_or(const pugi::xml_node& node, const char* key, int missing, Problem& problem) const {
    const pugi::xml_attribute found = node.attribute(key);
    if (!found) return missing;
    const std::string_view text = found.value();
    int value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (code == std::errc() && end == text.data() + text.size() && value >= 0) return value;
    problem.note(at(node, fmt::format("{}=\"{}\" must be a whole number of at least 0", key, text)));
    return missing;
}

std::vector<std::string_view> words(std::string_view text) {
    std::vector<std::string_view> found;
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t begin = text.find_first_not_of(" \t\r\n", i);
        if (begin == std::string_view::npos) break;
        i = std::min(text.find_first_of(" \t\r\n", begin), text.size());
        found.push_back(text.substr(begin, i - begin));
    }
    return found;
}

}  // namespace pliant::threemf
