#include "simulation/inverse/workspace_record.hpp"

#include <limits>

#include "simulation/stepper/cbor_numbers.hpp"

namespace pliant::sim::inverse {
namespace {

using cbor::Json;

template <class T>
Json packed(const std::vector<T>& numbers) {
    return cbor::packed(std::span<const T>(numbers));
}

WorkspaceSample read_sample(cbor::Reader& outer, const Json& map) {
    WorkspaceSample sample;
    cbor::Reader reader(map);
    sample.values = reader.numbers<double>("values");
    sample.found = reader.boolean("found");
    sample.markers = reader.numbers<Vec3>("markers");
    sample.tensions_N = reader.numbers<double>("tensions");
    sample.pressures_Pa = reader.numbers<double>("pressures");
    if (!reader.status()) outer.fail("a sample");
    return sample;
}

}  // namespace

std::string piece_bytes(const WorkspacePiece& piece, const std::string& identity) {
    Json map = {{"of", identity},
                {"rows", piece.rows},
                {"columns", piece.columns},
                {"reason", piece.reason},
                {"samples", Json::array()}};
    for (const WorkspaceSample& sample : piece.samples) {
        map["samples"].push_back({{"values", packed(sample.values)},
                                  {"found", sample.found},
                                  {"markers", packed(sample.markers)},
                                  {"tensions", packed(sample.tensions_N)},
                                  {"pressures", packed(sample.pressures_Pa)}});
    }
    return cbor::sealed(map);
}

Result<WorkspacePiece> piece_from_bytes(std::string_view bytes, const std::string& identity) {
    const Result<std::string_view> content = cbor::unsealed(bytes);
    if (!content) return tl::unexpected(content.error());
    const Json map = cbor::parsed(*content);
    cbor::Reader reader(map);
    if (reader.text("of") != identity) reader.fail("a piece of another search");
    constexpr int most = std::numeric_limits<int>::max();
    WorkspacePiece piece{
        reader.integer("rows", 0, most), reader.integer("columns", 0, most), {}, reader.text("reason")};
    const Json& samples = reader.at("samples");
    if (!samples.is_array()) reader.fail("no samples");
    for (std::size_t k = 0; reader.status() && k < samples.size(); ++k)
        piece.samples.push_back(read_sample(reader, samples[k]));
    if (!reader.status()) return tl::unexpected(reader.status().error());
    return piece;
}

}  // namespace pliant::sim::inverse
