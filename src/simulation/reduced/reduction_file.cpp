#include "simulation/reduced/reduction_file.hpp"

#include <cstdint>
#include <limits>
#include <utility>

#include "simulation/stepper/cbor_numbers.hpp"

namespace pliant::sim::reduced {
namespace {

using cbor::Json;
using cbor::packed;
using cbor::Reader;

constexpr const char* format_name = "pliant reduced model";
constexpr int most = std::numeric_limits<int>::max();

template <class T>
Json packed(const std::vector<T>& numbers) {
    return cbor::packed(std::span<const T>(numbers));
}

Json json_of(const Sample& sample) {
    std::vector<int> kinds;
    std::vector<double> values;
    for (const Drive& drive : sample.inputs.drives) {
        kinds.push_back(static_cast<int>(drive.kind));
        values.push_back(drive.value);
    }
    return {{"time", sample.inputs.time},
            {"kinds", packed(kinds)},
            {"values", packed(values)},
            {"x", cbor::packed(sample.state.x)},
            {"multipliers", cbor::packed(sample.state.multiplier)},
            {"amplitudes", cbor::packed(sample.amplitudes)}};
}

/// Sizes of the lists of numbers.
struct Sizes {
    Eigen::Index coordinates = 0, actuators = 0, modes = 0;
    std::size_t drives = 0, tets = 0;
};

Sample read_sample(Reader& outer, const Json& map, const Sizes& sizes) {
    Reader in(map);
    Sample sample;
    sample.inputs.time = in.number("time");
    const std::vector<int> kinds = in.numbers<int>("kinds");
    const Eigen::VectorXd values = in.vector("values", static_cast<Eigen::Index>(sizes.drives));
    sample.state = {in.vector("x", sizes.coordinates), in.vector("multipliers", sizes.actuators)};
    sample.amplitudes = in.vector("amplitudes", sizes.modes);
    if (kinds.size() != sizes.drives) in.fail("kinds of drives are missing");
    for (std::size_t a = 0; in.status() && a < kinds.size(); ++a) {
        if (kinds[a] < 0 || kinds[a] > static_cast<int>(Drive::Kind::gas)) in.fail("a drive of no kind");
        sample.inputs.drives.push_back({static_cast<Drive::Kind>(kinds[a]), values[static_cast<Eigen::Index>(a)]});
    }
    if (!in.status()) outer.fail("a sample: " + in.status().error().message);
    return sample;
}

Json json_of(const std::vector<Weight>& tets) {
    std::vector<std::uint64_t> columns;
    std::vector<double> weights;
    for (const Weight& tet : tets) {
        columns.push_back(tet.column);
        weights.push_back(tet.weight);
    }
    return {{"index", packed(columns)}, {"weight", packed(weights)}};
}

std::vector<Weight> read_tets(Reader& outer, const char* key, const Sizes& sizes) {
    const Json& map = outer.at(key);
    Reader in(map);
    const std::vector<std::uint64_t> columns = in.numbers<std::uint64_t>("index");
    const Eigen::VectorXd weights = in.vector("weight", static_cast<Eigen::Index>(columns.size()));
    std::vector<Weight> tets;
    for (std::size_t k = 0; in.status() && k < columns.size(); ++k) {
        const Weight tet{static_cast<std::size_t>(columns[k]), weights[static_cast<Eigen::Index>(k)]};
        if (tet.column >= sizes.tets || !(tet.weight > 0)) in.fail("a tet that is not there, or of no weight");
        if (k > 0 && columns[k] <= columns[k - 1]) in.fail("tets are not in order");
        tets.push_back(tet);
    }
    if (tets.empty()) in.fail("no tets");
    if (!in.status()) outer.fail("tets: " + in.status().error().message);
    return tets;
}

Sizes sizes_of(const Model& model) {
    const Description& d = model.description();
    const std::size_t drives = d.steered_count();
    return {3 * static_cast<Eigen::Index>(model.node_count()), static_cast<Eigen::Index>(drives + d.pressures.size()),
            0, drives, model.mesh().tet_count()};
}

}  // namespace

std::string reduction_bytes(const Reduction& reduction, const std::string& origin) {
    const auto entries = static_cast<std::size_t>(reduction.modes.size());
    Json map{{"format", format_name},
             {"version", reduction_version},
             {"origin", origin},
             {"mode_count", reduction.modes.cols()},
             {"used", reduction.used},
             {"modes", cbor::packed(std::span<const double>(reduction.modes.data(), entries))},
             {"tets", json_of(reduction.tets)},
             {"check_tets", json_of(reduction.check_tets)},
             {"force_error", reduction.force_error},
             {"not_found", reduction.not_found},
             {"touching", reduction.touching},
             {"samples", Json::array()}};
    for (const Sample& sample : reduction.samples) map["samples"].push_back(json_of(sample));
    return cbor::sealed(map);
}

Result<Reduction> reduction_from_bytes(const Model& model, std::string_view bytes, const std::string& origin) {
    const Result<std::string_view> content = cbor::unsealed(bytes);
    const Json map = content ? cbor::parsed(*content) : Json();
    if (!map.is_object() || !map.contains("format") || map["format"] != format_name)
        return input_error("not a reduced model, or damaged");
    Reader in(map);
    if (in.integer("version", 0, most) != reduction_version)
        return input_error("written by another version of Pliant; make it again with pliant reduce");
    if (in.text("origin") != origin)
        return input_error("made for another robot, or for other settings; make it again with pliant reduce");
    Sizes sizes = sizes_of(model);
    sizes.modes = in.integer("mode_count", 1, static_cast<int>(std::min<Eigen::Index>(sizes.coordinates, 10000)));
    Reduction reduction;
    const Eigen::Index all = sizes.modes;
    const Json& packed_modes = in.at("modes");
    const auto claimed = sizeof(double) * static_cast<std::size_t>(sizes.coordinates * all);
    if (!packed_modes.is_binary() || packed_modes.get_binary().size() != claimed)
        in.fail("modes are not as many as mode_count says");
    if (!in.status()) return tl::unexpected(in.status().error());  // before anything of that size is allocated
    const Eigen::VectorXd modes = in.vector("modes", sizes.coordinates * all);
    reduction.modes = Eigen::Map<const Eigen::MatrixXd>(modes.data(), sizes.coordinates, all);
    reduction.used = sizes.modes = in.integer("used", 1, static_cast<int>(all));
    reduction.tets = read_tets(in, "tets", sizes);
    reduction.check_tets = read_tets(in, "check_tets", sizes);
    reduction.force_error = in.number("force_error");
    reduction.not_found = in.integer("not_found", 0, most);
    reduction.touching = in.integer("touching", 0, most);
    const Json& samples = in.at("samples");
    if (!samples.is_array() || samples.empty()) in.fail("no samples");
    for (std::size_t k = 0; in.status() && k < samples.size(); ++k)
        reduction.samples.push_back(read_sample(in, samples[k], sizes));
    if (!in.status()) return tl::unexpected(in.status().error());
    return reduction;
}

}  // namespace pliant::sim::reduced
