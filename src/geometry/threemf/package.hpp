// The zip file around a 3MF model: finds the model part and reads parts.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/zip/zip_file.hpp"
#include "geometry/threemf/xml_part.hpp"

namespace pliant::threemf {

class Package {
public:
    /// Errors: not a zip file; no start part, several, or one outside the file; relationships that the specification
    /// forbids.
    [[nodiscard]] static Result<Package> open(const std::filesystem::path& path);

    [[nodiscard]] const std::string& name() const { return name_; }
    /// Path of the start part, as in "/3D/3dmodel.model".
    [[nodiscard]] const std::string& model() const { return model_; }
    /// Relationships to missing parts that no body needs.
    [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
    /// A part by its path from the root of the package. Errors: missing, over 1 GB, not well-formed XML.
    [[nodiscard]] Result<XmlPart> part(std::string_view path) const;

private:
    Package(ZipReader zip, std::string name) : zip_(std::move(zip)), name_(std::move(name)) {}
    Status find_model();
    Status check_relationships_of_model();
    void check_targets(const XmlPart& relationships, const std::string& folder);

    ZipReader zip_;
    std::string name_, model_;
    std::vector<std::string> warnings_;
};

}  // namespace pliant::threemf
