#include "simulation/calibrate/ratio.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/core/json.hpp"
#include "base/core/part_of_work.hpp"
#include "base/linalg/dense.hpp"
#include "simulation/peers/reference_problems.hpp"
#include "simulation/run/simulate.hpp"

namespace pliant::calibrate {
namespace {

constexpr double length_m = 0.1;
constexpr double width_m = 0.01;
constexpr double soft_Pa = 12e6;  // only the ratio matters: no force is prescribed
constexpr int tets_of_cell = 6;
constexpr int most_tets = 1000000;  // quadratic ones, which take several GB

/// The interior cell boundary nearest to the interface, as a share of the length.
double interface_of_cells(const RatioOptions& options) {
    const int cells = options.cells[0];
    return std::clamp(static_cast<int>(std::lround(options.interface * cells)), 1, cells - 1) /
           static_cast<double>(cells);
}

/// Stretches the cells of both parts of the bar so that a cell boundary is the interface.
void move_interface(mesh::TetMesh& mesh, const RatioOptions& options) {
    const double from = interface_of_cells(options), to = options.interface;
    if (std::fabs(from - to) < 1e-9) return;
    for (Vec3& p : mesh.points) {
        const double x = p.x / length_m;
        p.x = length_m * (x <= from + 1e-9 ? x * to / from : 1 - (1 - x) * (1 - to) / (1 - from));
    }
}

sim::Description bar(const RatioOptions& options, int order, material::Law stiff, material::Law soft) {
    const double interface = options.interface * length_m;
    const double boundary = interface_of_cells(options) * length_m;
    sim::Description d;
    d.mesh = sim::reference::kuhn_box({length_m, width_m, width_m}, options.cells[0], options.cells[1],
                                      options.cells[2], [&](Vec3 c) { return c.x < boundary ? 0 : 1; });
    move_interface(d.mesh, options);
    if (order == 2) d.mesh = mesh::to_quadratic(d.mesh);
    d.materials = {{"stiff", stiff, 0}, {"soft", soft, 0}};
    d.material_of_region = {0, 1};
    const auto at = [&](double x) {
        return sim::reference::nodes_where(d.mesh, [x](Vec3 p) { return std::fabs(p.x - x) < 1e-9; });
    };
    d.supports = {{"left", at(0), {}}, {"right", at(length_m), {options.strain * length_m, 0, 0}}};
    d.markers = {{"interface", sim::reference::mean_of(at(interface))}};
    return d;
}

Result<double> interface_mm(const RatioOptions& options, int order, material::Law stiff, material::Law soft,
                            Progress& progress) {
    if (progress.cancelled()) return cancelled();
    auto model = sim::Model::create(bar(options, order, std::move(stiff), std::move(soft)));
    if (!model) return tl::unexpected(model.error());
    sim::Program program;
    program.steps = 5;
    program.tolerance = 1e-5;
    const sim::Trajectory result = sim::run(*model, program, progress);
    if (!result.converged && progress.cancelled()) return cancelled();
    if (!result.converged) return failure("the bar: {}", result.message);
    return (result.steps.back().markers[0].position_m.x - options.interface * length_m) * 1e3;
}

Status check_cells(const std::array<int, 3>& cells) {
    if (std::any_of(cells.begin(), cells.end(), [](int n) { return n < 1 || n > 200; }) || cells[0] < 2)
        return input_error("--cells: each number is between 1 and 200, the first above 1");
    const int tets = tets_of_cell * cells[0] * cells[1] * cells[2];
    if (tets <= most_tets) return {};
    const double smaller = std::cbrt(static_cast<double>(most_tets) / tets);
    const auto fewer = [&](int n) { return std::max(1, static_cast<int>(smaller * n)); };
    return input_error("--cells: {},{},{} makes {} tets, more than {}; {},{},{} is possible", cells[0], cells[1],
                       cells[2], tets, most_tets, fewer(cells[0]), fewer(cells[1]), fewer(cells[2]));
}

Status check(const RatioOptions& o) {
    if (o.ratios.empty()) return input_error("--ratios: name at least one material ratio");
    for (const double ratio : o.ratios) {
        if (!(ratio >= 1 && ratio <= 100))
            return input_error("--ratios: {} is not possible; a ratio is stiff over soft, 1 to 100", ratio);
    }
    return check_bar(o);
}

std::optional<std::array<double, 3>> quadratic(const std::vector<RatioRow>& rows) {
    if (rows.size() < 3) return std::nullopt;
    Eigen::MatrixXd A(static_cast<Eigen::Index>(rows.size()), 3);
    Eigen::VectorXd b(A.rows());
    for (Eigen::Index i = 0; i < A.rows(); ++i) {
        const RatioRow& row = rows[static_cast<std::size_t>(i)];
        A.row(i) << row.material_ratio * row.material_ratio, row.material_ratio, 1;
        b[i] = row.shape_parameter;
    }
    const auto c = linalg::unique_least_squares(A, b);
    if (!c) return std::nullopt;
    return std::array<double, 3>{(*c)[0], (*c)[1], (*c)[2]};
}

}  // namespace

Status check_bar(const RatioOptions& o) {
    if (!(o.strain >= 1e-3 && o.strain <= 1)) return input_error("--strain: {} is not between 0.001 and 1", o.strain);
    if (!(o.poisson_ratio >= 0 && o.poisson_ratio <= 0.495))
        return input_error("--poisson: {} is not between 0 and 0.495", o.poisson_ratio);
    if (Status status = check_cells(o.cells); !status) return status;
    if (!(o.interface >= 0.02 && o.interface <= 0.98))
        return input_error("--interface: {} is not between 0.02 and 0.98", o.interface);
    return {};
}

Result<double> reference_displacement_mm(const RatioOptions& options, double material_ratio, Progress& progress) {
    return interface_mm(options, 2, material::neo_hookean(soft_Pa * material_ratio, options.poisson_ratio),
                        material::neo_hookean(soft_Pa, options.poisson_ratio), progress);
}

Result<double> blend_displacement_mm(const RatioOptions& options, double shape_parameter, Progress& progress) {
    return interface_mm(options, 1, material::ShapeBlend{soft_Pa, 1},
                        material::ShapeBlend{soft_Pa, 1 / shape_parameter}, progress);
}

Result<double> match_shape_parameter(const RatioOptions& options, double interface_mm, double guess,
                                     Progress& progress) {
    // The softer the other part is, the less the stiff part stretches: the displacement decreases with R_omega, nearly
    // as a power law. So the secant method works in logarithms, with brackets that only shrink.
    constexpr double most = 1000;
    double low = 0;
    double high = std::log(most);
    double x = std::clamp(std::log(guess), low, high);
    std::optional<std::array<double, 2>> before;
    double left = 1;  // nobody knows how many bars it takes: each counts for half of what is left
    for (int i = 0; i < 40; ++i) {
        PartOfWork part(progress, "match", 1 - left, 1 - 0.5 * left);
        left *= 0.5;
        const Result<double> u = blend_displacement_mm(options, std::exp(x), part);
        if (!u) return tl::unexpected(u.error());
        const double error = std::log(*u / interface_mm);
        if (std::fabs(error) < 1e-5) return std::exp(x);
        (error > 0 ? low : high) = x;
        if (high - low < 1e-9) break;
        const double slope = before && x != (*before)[0] ? (error - (*before)[1]) / (x - (*before)[0]) : -0.9;
        before = {x, error};
        const double next = x - error / slope;
        x = next > low && next < high ? next : (next <= low && low == 0 ? low : 0.5 * (low + high));
    }
    return failure("no shape parameter between 1 and {} moves the interface by {:.5g} mm", most, interface_mm);
}

Result<RatioResult> calibrate_ratio(const RatioOptions& options, Progress& progress) {
    if (Status status = check(options); !status) return tl::unexpected(status.error());
    RatioResult result;
    for (std::size_t i = 0; i < options.ratios.size(); ++i) {
        const double R = options.ratios[i];
        PartOfWork ratio = equal_part(progress, "ratio", i, options.ratios.size());
        // The reference has quadratic tets, and takes about as long as all bars of the match.
        PartOfWork reference(ratio, "reference", 0, 0.5), matching(ratio, "match", 0.5, 1);
        const Result<double> u = reference_displacement_mm(options, R, reference);
        if (!u) return tl::unexpected(u.error());
        const double guess = std::max(1.0, material::shape_parameter_of_thesis(R));
        const Result<double> match = match_shape_parameter(options, *u, guess, matching);
        if (!match && match.error().cause == Cause::cancelled) return tl::unexpected(match.error());
        if (!match) return failure("material ratio {}: {}", R, match.error().message);
        result.rows.push_back(
            {R, *u, *match, material::shape_parameter_of_thesis(R), material::shape_parameter_small_strain(R)});
    }
    result.curve = quadratic(result.rows);
    return result;
}

std::string ratio_text(const RatioResult& result) {
    std::string text =
        fmt::format("{:>8} {:>14} {:>9} {:>8} {:>14}\n", "R_m", "interface mm", "R_omega", "T3.8", "(3 R_m - 1)/2");
    for (const RatioRow& row : result.rows) {
        text += fmt::format("{:>8.4g} {:>14.4f} {:>9.3f} {:>8.3f} {:>14.3f}\n", row.material_ratio, row.interface_mm,
                            row.shape_parameter, row.thesis, row.small_strain);
    }
    if (result.curve) {
        const auto& c = *result.curve;
        text += fmt::format("R_omega = {:.4g} R_m^2 {:+.4g} R_m {:+.4g}    (T3.8: 0.114 R_m^2 + 1.665 R_m - 0.766)\n",
                            c[0], c[1], c[2]);
    }
    return text;
}

std::string ratio_csv(const RatioResult& result) {
    std::string text = "material_ratio,interface_mm,shape_parameter,thesis,small_strain\n";
    for (const RatioRow& row : result.rows) {
        text += fmt::format("{},{:.6f},{:.6f},{:.6f},{:.6f}\n", row.material_ratio, row.interface_mm,
                            row.shape_parameter, row.thesis, row.small_strain);
    }
    return text;
}

std::string ratio_json(const RatioResult& result, const RatioOptions& options) {
    nlohmann::ordered_json json = {{"strain", options.strain},
                                   {"poisson_ratio", options.poisson_ratio},
                                   {"interface", options.interface},
                                   {"cells", options.cells},
                                   {"rows", nlohmann::ordered_json::array()}};
    for (const RatioRow& row : result.rows) {
        json["rows"].push_back({{"material_ratio", row.material_ratio},
                                {"interface_mm", row.interface_mm},
                                {"shape_parameter", row.shape_parameter},
                                {"thesis", row.thesis},
                                {"small_strain", row.small_strain}});
    }
    json["curve"] = nullptr;
    if (result.curve) json["curve"] = *result.curve;
    return json_text(json, 2);
}

}  // namespace pliant::calibrate
