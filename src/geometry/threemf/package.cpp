#include "geometry/threemf/package.hpp"

namespace pliant::threemf {
namespace {

constexpr std::uint64_t max_part_bytes = std::uint64_t{1} << 30;
constexpr std::string_view model_type = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
constexpr std::string_view ticket_type = "http://schemas.microsoft.com/3dmanufacturing/2013/01/printticket";

/// "3D/x.model" of "/3D/x.model".
std::string entry_of(std::string_view path) {
    while (path.starts_with('/')) path.remove_prefix(1);
    return std::string(path);
}

std::vector<pugi::xml_node> relationships(const XmlPart& part, std::string_view type) {
    std::vector<pugi::xml_node> found;
    for (const pugi::xml_node& node : part.root().children("Relationship")) {
        if (type == node.attribute("Type").value()) found.push_back(node);
    }
    return found;
}

}  // namespace

Result<Package> Package::open(const std::filesystem::path& path) {
    auto zip = ZipReader::open(path);
    if (!zip) return tl::unexpected(zip.error());
    Package package(std::move(*zip), path.string());
    if (auto status = package.find_model(); !status) return tl::unexpected(status.error());
    if (auto status = package.check_relationships_of_model(); !status) return tl::unexpected(status.error());
    return package;
}

Result<XmlPart> Package::part(std::string_view path) const {
    const std::string entry = entry_of(path);
    auto text = zip_.read(entry, max_part_bytes);
    if (!text) return tl::unexpected(text.error());
    return XmlPart::parse(std::move(*text), name_ + ": " + entry);
}

Status Package::find_model() {
    if (!zip_.has("_rels/.rels"))
        return input_error("{}: is no 3MF file: it has no _rels/.rels, which names its model", name_);
    const auto part = this->part("_rels/.rels");
    if (!part) return tl::unexpected(part.error());
    const auto models = relationships(*part, model_type);
    if (models.size() != 1)
        return input_error("{}: {} start parts of type 3dmodel in _rels/.rels, one is needed", name_, models.size());
    if (std::string_view(models[0].attribute("TargetMode").value()) == "External")
        return input_error("{}: the model lies outside of the file ({}), which is never followed", name_,
                           models[0].attribute("Target").value());
    model_ = models[0].attribute("Target").value();
    if (!model_.starts_with('/')) model_ = "/" + model_;
    if (!zip_.has(entry_of(model_)))
        return input_error("{}: _rels/.rels names the model {}, which is not in the file", name_, model_);
    check_targets(*part, "/");
    return {};
}

/// `folder`: of the part that the relationships belong to, for relative targets.
void Package::check_targets(const XmlPart& relationships, const std::string& folder) {
    constexpr std::size_t most = 20;
    for (const pugi::xml_node& node : relationships.root().children("Relationship")) {
        const std::string target = node.attribute("Target").value();
        const bool outside = std::string_view(node.attribute("TargetMode").value()) == "External";
        if (outside || target.empty() || target.find('%') != std::string::npos || warnings_.size() >= most) continue;
        const std::filesystem::path path = target.front() == '/' ? target : folder + target;
        if (!zip_.has(entry_of(path.lexically_normal().generic_string())))
            warnings_.push_back(relationships.at(
                node,
                fmt::format("names the part {}, which is not in the file (core specification, section 2.1)", target)));
    }
}

Status Package::check_relationships_of_model() {
    const std::string entry = entry_of(model_);
    const std::size_t slash = entry.rfind('/') == std::string::npos ? 0 : entry.rfind('/') + 1;
    const std::string rels = entry.substr(0, slash) + "_rels/" + entry.substr(slash) + ".rels";
    if (!zip_.has(rels)) return {};
    const auto part = this->part(rels);
    if (!part) return tl::unexpected(part.error());
    if (const auto tickets = relationships(*part, ticket_type); tickets.size() > 1)
        return input_error("{}: {} print tickets in {}, at most one is allowed", name_, tickets.size(), rels);
    check_targets(*part, "/" + entry.substr(0, slash));
    return {};
}

}  // namespace pliant::threemf
