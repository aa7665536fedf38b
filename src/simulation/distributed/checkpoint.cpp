#include "simulation/distributed/checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "base/core/digest.hpp"
#include "base/core/files.hpp"
#include "base/core/json.hpp"
#include "simulation/distributed/h5_file.hpp"
#include "simulation/run/step_record.hpp"

namespace pliant::sim::distributed {
namespace {

using Json = nlohmann::json;

constexpr const char* format_name = "pliant-mpi checkpoint";
constexpr int version = 2;

std::vector<double> numbers_of(const Eigen::VectorXd& v) {
    return {v.data(), v.data() + v.size()};
}

std::string digest_of(const std::string& run, const std::string& steps) {
    Digest digest;
    digest.add(run.data(), run.size());
    digest.add(steps.data(), steps.size());
    return digest.text();
}

/// A checksum of rows of three numbers that does not depend on how they are distributed: the sum, over all rows, of a
/// digest of each with its place, in pieces that are whole numbers exactly.
std::vector<double> checksum_of(const Ranks& ranks, const Rows& rows, const std::vector<double>& values) {
    constexpr int pieces = 4, bits = 16;
    std::vector<double> sums(pieces, 0.0);
    for (std::size_t row = 0; 3 * row + 2 < values.size(); ++row) {
        const std::uint64_t place = static_cast<std::uint64_t>(rows.first) + row;
        Digest digest;
        digest.add(&place, sizeof place);
        digest.add(&values[3 * row], 3 * sizeof(double));
        for (std::size_t k = 0; k < pieces; ++k)
            sums[k] += static_cast<double>(digest.number() >> (bits * k) & 0xffffU);
    }
    ranks.add_up(sums);
    return sums;
}

/// Records in sequence, each preceded by its length.
std::string bytes_of(const Trajectory& all) {
    std::string bytes;
    std::size_t first = 0;
    for (const Step& step : all.steps) {
        std::size_t end = first;
        while (end < all.iterations.size() && all.iterations[end].step <= step.index) ++end;
        const std::string record = step_bytes(step, std::span(all.iterations).subspan(first, end - first));
        const std::uint64_t size = record.size();
        bytes.append(reinterpret_cast<const char*>(&size), sizeof size);
        bytes += record;
        first = end;
    }
    return bytes;
}

Status read_steps(const std::string& bytes, Trajectory& into) {
    for (std::size_t at = 0; at < bytes.size();) {
        std::uint64_t size = 0;
        if (bytes.size() - at < sizeof size) return input_error("its steps are damaged");
        std::memcpy(&size, bytes.data() + at, sizeof size);
        at += sizeof size;
        if (bytes.size() - at < size) return input_error("its steps are damaged");
        Result<StepRecord> record = step_from_bytes(std::string_view(bytes).substr(at, size), 0);
        if (!record) return tl::unexpected(record.error());
        into.steps.push_back(std::move(record->step));
        into.iterations.insert(into.iterations.end(), record->iterations.begin(), record->iterations.end());
        at += size;
    }
    return {};
}

/// Reads a moment except its positions.
Status take(const Json& json, std::size_t actuators, Moment& moment) {
    const Json along = json.value("along", Json()), list = json.value("multiplier", Json());
    const bool good = along.is_number() && list.is_array() && list.size() == actuators &&
                      std::ranges::all_of(list, [](const Json& value) { return value.is_number(); });
    if (!good) return input_error("its states are damaged");
    const auto values = list.get<std::vector<double>>();
    moment.along = along.get<double>();
    moment.state.multiplier = Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(actuators));
    return {};
}

/// Reads a run except the positions.
Status take(const Json& json, const std::string& steps, const std::string& origin, const Program& program,
            std::size_t actuators, RunState& run) {
    if (!json.is_object() || json.value("format", Json()) != format_name)
        return input_error("not a checkpoint of pliant-mpi, or damaged");
    if (json.value("version", Json()) != version)
        return input_error("a checkpoint of another version; this Pliant reads version {}", version);
    if (json.value("origin", Json()) != origin)
        return input_error(
            "the checkpoint belongs to another robot file, mesh, --set or --steps; run without --resume to start anew");
    for (const char* key : {"step", "setup_s", "solve_s"})
        if (!json.value(key, Json()).is_number()) return input_error("its {} is damaged", key);
    run.step = json["step"].get<int>();
    if (run.step < 0 || run.step > program.steps) return input_error("its step is damaged");
    run.so_far.solver = name(Solver::newton);
    run.so_far.setup_s = json["setup_s"].get<double>();
    run.so_far.solve_s = json["solve_s"].get<double>();
    if (Status status = take(json, actuators, run.now); !status) return status;
    for (const Json& before : json.value("past", Json::array()))
        if (Status status = take(before, actuators, run.past.emplace_back()); !status) return status;
    if (Status status = read_steps(steps, run.so_far); !status) return status;
    return run.so_far.steps.size() == static_cast<std::size_t>(run.step) + 1 ? Status{}
                                                                             : input_error("its steps are damaged");
}

}  // namespace

Checkpoint::Checkpoint(const DistributedEquilibrium& system, std::filesystem::path folder, std::string origin)
    : system_(system),
      folder_(std::move(folder)),
      origin_(std::move(origin)),
      nodes_(system.ranks(),
             std::span(system.share().node_in_file).first(static_cast<std::size_t>(system.share().owned)),
             system.share().whole.nodes) {}

std::vector<double> Checkpoint::sorted(const Eigen::VectorXd& x) const {
    return nodes_.sorted({x.data(), static_cast<std::size_t>(system_.nodes().owned())}, 3);
}

Status Checkpoint::keep(const RunState& run) const {
    Json json{{"format", format_name},
              {"version", version},
              {"origin", origin_},
              {"step", run.step},
              {"along", run.now.along},
              {"setup_s", run.so_far.setup_s},
              {"solve_s", run.so_far.solve_s},
              {"multiplier", numbers_of(run.now.state.multiplier)},
              {"past", Json::array()}};
    for (const Moment& before : run.past)
        json["past"].push_back({{"along", before.along}, {"multiplier", numbers_of(before.state.multiplier)}});
    const std::filesystem::path aside = aside_of(file());
    Result<H5File> out = H5File::create(&system_.ranks(), aside);
    if (!out) return tl::unexpected(out.error());
    const Rows rows{nodes_.total(), nodes_.first(), nodes_.rows()};
    const auto write = [&](const std::string& name, const Eigen::VectorXd& x) {
        const std::vector<double> values = sorted(x);
        out->write(name, rows, 3, values);
        json["checksums"][name] = checksum_of(system_.ranks(), rows, values);
    };
    write("x", run.now.state.x);
    for (std::size_t k = 0; k < run.past.size(); ++k) write(fmt::format("x_before_{}", k), run.past[k].state.x);
    const std::string text = json_text(json), steps = bytes_of(run.so_far);
    out->write_bytes("run", text);
    out->write_bytes("steps", steps);
    out->write_bytes("digest", digest_of(text, steps));
    if (Status status = out->close(); !status) return status;
    std::error_code code;
    if (system_.ranks().is_root()) std::filesystem::rename(aside, file(), code);
    return system_.ranks().agree(code ? Status(failure("{}: cannot be written: {}", file().string(), code.message()))
                                      : Status{});
}

Result<RunState> Checkpoint::read(const Program& program) const {
    std::error_code code;
    const Status there =
        std::filesystem::exists(file(), code) ? Status{} : input_error("{}: there is no checkpoint", folder_.string());
    if (Status status = system_.ranks().agree(there); !status) return tl::unexpected(status.error());
    Result<H5File> in = H5File::open(system_.ranks(), file());
    if (!in) return tl::unexpected(in.error());
    const Result<std::string> text = in->read_bytes("run");
    if (!text) return tl::unexpected(text.error());
    const Result<std::string> steps = in->read_bytes("steps");
    if (!steps) return tl::unexpected(steps.error());
    const Json json = parse_json(*text);
    const Json checksums = json.is_object() ? json.value("checksums", Json()) : Json();
    RunState run;
    Status status = take(json, *steps, origin_, program, system_.actuator_count(), run);
    if (status) {
        const Result<std::string> digest = in->read_bytes("digest");
        if (!digest || *digest != digest_of(*text, *steps) || !checksums.is_object()) status = input_error("damaged");
    }
    if (!status) status = input_error("{}: {}", file().string(), status.error().message);
    if (status = system_.ranks().agree(status); !status) return tl::unexpected(status.error());
    const Rows rows{nodes_.total(), nodes_.first(), nodes_.rows()};
    const auto place = [&](const std::string& name, State& state) -> Status {
        const Result<std::vector<double>> x = in->read(name, rows, 3);
        if (!x) return tl::unexpected(x.error());
        if (checksums.value(name, Json()) != checksum_of(system_.ranks(), rows, *x))
            return input_error("{}: damaged", file().string());
        const std::vector<double> own = nodes_.given_back(*x, 3);
        state.x = system_.nodes().with_ghosts(
            Eigen::Map<const Eigen::VectorXd>(own.data(), static_cast<Eigen::Index>(own.size())));
        return {};
    };
    status = place("x", run.now.state);
    for (std::size_t k = 0; status && k < run.past.size(); ++k)
        status = place(fmt::format("x_before_{}", k), run.past[k].state);
    if (!status) return tl::unexpected(status.error());
    return run;
}

}  // namespace pliant::sim::distributed
