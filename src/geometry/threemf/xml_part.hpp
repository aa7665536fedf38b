// An XML part of a 3MF package: parsed, checked for errors that the parser accepts, and read with line numbers in
// errors.
#pragma once

#include <map>
#include <memory>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/core/error.hpp"

namespace pliant::threemf {

/// The first problem found, as one line. After it, readers return harmless values and stop.
class Problem {
public:
    [[nodiscard]] bool found() const { return !text_.empty(); }
    void note(std::string text) {
        if (text_.empty()) text_ = std::move(text);
    }
    [[nodiscard]] const std::string& text() const { return text_; }

private:
    std::string text_;
};

/// Namespaces that parts may use; elements are looked up by these, whatever their prefix in the file.
enum class Space { none, core, material, production, slice };

class XmlPart {
public:
    /// `name`: file and part, for messages. Refuses XML that is not well-formed, also several roots and undeclared
    /// prefixes, which pugixml accepts; a document type; and encodings other than UTF-8 or UTF-16.
    [[nodiscard]] static Result<XmlPart> parse(std::string text, std::string name);

    [[nodiscard]] pugi::xml_node root() const { return document_->document_element(); }
    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] bool is(const pugi::xml_node& node, Space space, std::string_view local) const;
    /// The first child of that kind, or none.
    [[nodiscard]] pugi::xml_node child(const pugi::xml_node& node, Space space, std::string_view local) const;
    [[nodiscard]] std::vector<pugi::xml_node> children(const pugi::xml_node& node, Space space,
                                                       std::string_view local) const;
    /// An attribute with a namespace; "" if it is missing.
    [[nodiscard]] std::string_view attribute(const pugi::xml_node& node, Space space, std::string_view local) const;
    /// The namespace URI of a prefix, or "".
    [[nodiscard]] std::string_view address_of_prefix(std::string_view prefix) const;

    /// "FILE: PART:12: <object>: text".
    [[nodiscard]] std::string at(const pugi::xml_node& node, std::string_view text) const;

    /// A required attribute without namespace; "" and a problem if missing or empty.
    std::string_view needed(const pugi::xml_node& node, const char* key, Problem& problem) const;
    /// A finite number; otherwise 0 and a problem.
    double number(const pugi::xml_node& node, const char* key, Problem& problem) const;
    /// An integer from 0 to 2^31 - 1; `missing` if there is no such attribute.
    int index(const pugi::xml_node& node, const char* key, Problem& problem) const;
    int index_or(const pugi::xml_node& node, const char* key, int missing, Problem& problem) const;

private:
    XmlPart() = default;
    [[nodiscard]] Space space_of(std::string_view prefix) const;
    [[nodiscard]] int line_of(const pugi::xml_node& node) const;
    Status check_names() const;

    std::string name_, text_;
    std::unique_ptr<pugi::xml_document> document_;
    std::map<std::string, std::string, std::less<>> addresses_;  ///< namespace URIs by prefix, as declared at the root
};

/// The next node of the document in preorder; none after the last.
[[nodiscard]] pugi::xml_node next_in_document(pugi::xml_node node);

/// "m" and "color" of "m:color"; the prefix is "" if there is none.
[[nodiscard]] std::pair<std::string_view, std::string_view> split_name(std::string_view name);

/// Splits "a b  c" at blanks.
[[nodiscard]] std::vector<std::string_view> words(std::string_view text);

}  // namespace pliant::threemf
