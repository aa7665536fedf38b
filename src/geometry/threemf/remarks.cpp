#include "geometry/threemf/remarks.hpp"

#include <algorithm>
#include <map>
#include <set>

namespace pliant::threemf {
namespace {

constexpr std::size_t most_remarks = 50;
constexpr std::string_view instance_address = "http://www.w3.org/2001/XMLSchema-instance";

/// Elements of the core specification and their attributes. "printable" of an item is PrusaSlicer's.
const std::map<std::string_view, std::vector<std::string_view>>& core_elements() {
    static const std::map<std::string_view, std::vector<std::string_view>> elements{
        {"model", {"unit", "requiredextensions", "recommendedextensions"}},
        {"metadata", {"name", "preserve", "type"}},
        {"metadatagroup", {}},
        {"resources", {}},
        {"basematerials", {"id"}},
        {"base", {"name", "displaycolor"}},
        {"object", {"id", "type", "thumbnail", "partnumber", "name", "pid", "pindex"}},
        {"mesh", {}},
        {"vertices", {}},
        {"vertex", {"x", "y", "z"}},
        {"triangles", {}},
        {"triangle", {"v1", "v2", "v3", "p1", "p2", "p3", "pid"}},
        {"components", {}},
        {"component", {"objectid", "transform"}},
        {"build", {}},
        {"item", {"objectid", "transform", "partnumber", "printable"}}};
    return elements;
}

bool one_of(std::string_view word, const std::vector<std::string_view>& words) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

class Remarks {
public:
    explicit Remarks(const XmlPart& part) : part_(part) {}

    std::vector<std::string> all() {
        look_at(part_.root());
        return std::move(remarks_);
    }

private:
    void look_at(const pugi::xml_node& top) {
        for (pugi::xml_node node = top; node && remarks_.size() < most_remarks; node = next_in_document(node)) {
            if (node.type() != pugi::node_element) continue;
            const auto [prefix, name] = split_name(node.name());
            if (!part_.is(node, Space::core, name)) continue;
            const auto known = core_elements().find(name);
            if (known == core_elements().end()) {
                once(node, "", "the core specification knows no such element; it was passed over");
                continue;
            }
            look_at_attributes(node, known->second);
            if (name == "metadata") look_at_metadata(node);
        }
    }

    void look_at_attributes(const pugi::xml_node& node, const std::vector<std::string_view>& known) {
        for (const pugi::xml_attribute& attribute : node.attributes()) {
            const auto [prefix, name] = split_name(attribute.name());
            const bool foreign = (prefix == "xml" && name != "lang") ||
                                 (!prefix.empty() && part_.address_of_prefix(prefix) == instance_address);
            const bool unknown = prefix.empty() && name != "xmlns" && !one_of(name, known);
            if (foreign || unknown)
                once(node, attribute.name(),
                     fmt::format("the core specification knows no attribute "
                                 "{} here (its section {}); it was passed over",
                                 attribute.name(), foreign ? "2.3" : "3"));
        }
    }

    void look_at_metadata(const pugi::xml_node& node) {
        static const std::vector<std::string_view> known{"Title",        "Designer",         "Description",
                                                         "Copyright",    "LicenseTerms",     "Rating",
                                                         "CreationDate", "ModificationDate", "Application"};
        const std::string_view name = node.attribute("name").value();
        const auto [prefix, local] = split_name(name);
        if (prefix.empty() && !one_of(local, known))
            note(node, fmt::format("name=\"{}\" is none that the core specification knows (its section 3.4.1)", name));
        if (!prefix.empty() && part_.address_of_prefix(prefix).empty())
            note(node,
                 fmt::format("name=\"{}\": the prefix has no namespace (core specification, section 3.4.1)", name));
        if (!metadata_.insert({node.parent(), std::string(name)}).second)
            note(node, fmt::format("name=\"{}\" is given twice (core specification, section 3.4.1)", name));
    }

    void once(const pugi::xml_node& node, std::string_view what, const std::string& text) {
        if (seen_.insert(fmt::format("{} {}", node.name(), what)).second) note(node, text);
    }
    void note(const pugi::xml_node& node, const std::string& text) { remarks_.push_back(part_.at(node, text)); }

    const XmlPart& part_;
    std::set<std::string> seen_;                                 ///< kinds already reported
    std::set<std::pair<pugi::xml_node, std::string>> metadata_;  ///< by parent element
    std::vector<std::string> remarks_;
};

}  // namespace

std::vector<std::string> remarks_on(const XmlPart& part) {
    return Remarks(part).all();
}

}  // namespace pliant::threemf
