#include "geometry/threemf/read_3mf.hpp"

#include "geometry/threemf/build.hpp"
#include "geometry/threemf/model_part.hpp"
#include "geometry/threemf/package.hpp"

namespace pliant::threemf {
namespace {

Result<ThreeMf> assemble(const XmlPart& xml, const Package* package, const std::string& file) {
    auto start = read_model_part(xml);
    if (!start) return tl::unexpected(start.error());
    if (package != nullptr)
        start->warnings.insert(start->warnings.end(), package->warnings().begin(), package->warnings().end());
    return Build(package, file).assemble(std::move(*start));
}

}  // namespace

Result<ThreeMf> read_3mf(const std::filesystem::path& path) {
    const auto package = Package::open(path);
    if (!package) return tl::unexpected(package.error());
    const auto xml = package->part(package->model());
    if (!xml) return tl::unexpected(xml.error());
    return assemble(*xml, &*package, package->name());
}

Result<ThreeMf> parse_3mf_model(std::string text, const std::string& name) {
    const auto xml = XmlPart::parse(std::move(text), name);
    if (!xml) return tl::unexpected(xml.error());
    return assemble(*xml, nullptr, name);
}

bool looks_like_zip(std::string_view bytes) {
    return bytes.starts_with("PK\x03\x04");
}

}  // namespace pliant::threemf
