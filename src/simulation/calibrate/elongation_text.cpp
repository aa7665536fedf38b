// Output of an elongation test: text, CSV and JSON.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/core/json.hpp"
#include "robot/description/law.hpp"
#include "simulation/calibrate/elongation.hpp"
#include "simulation/calibrate/fit.hpp"

namespace pliant::calibrate {
namespace {

struct Mean {
    double value = 0;
    double half_width = 0;  ///< of the 95 % interval; 0 for a single test
};

template <class Of>
Mean mean(const std::vector<ElongationRow>& rows, Of of) {
    Mean m;
    const auto n = static_cast<double>(rows.size());
    for (const ElongationRow& row : rows) m.value += of(row) / n;
    if (rows.size() < 2) return m;
    double squares = 0;
    for (const ElongationRow& row : rows) squares += (of(row) - m.value) * (of(row) - m.value);
    const int freedom = static_cast<int>(rows.size()) - 1;
    m.half_width = student_t_95(freedom) * std::sqrt(squares / freedom / n);
    return m;
}

std::string text_of(const Mean& m) {
    return m.half_width == 0 ? fmt::format("{:.4g}", m.value)
                             : fmt::format("{:.4g} +- {:.2g} (95 %)", m.value, m.half_width);
}

/// The ratio or its inverse, whichever is above 1.
double above_one(double ratio) {
    return std::max(ratio, 1 / ratio);
}

}  // namespace

std::string elongation_text(const std::vector<ElongationRow>& rows) {
    std::string text = fmt::format("{:>8} {:>8} {:>9} {:>10} {:>10} {:>9}\n", "L1 / L", "strain", "joint mm",
                                   "R_m, T3.7", "R_m", "T3.7 errs");
    for (const ElongationRow& row : rows) {
        text += fmt::format("{:>8.3f} {:>6.1f} % {:>9.3f} {:>10.3f} {:>10.3f} {:>+7.1f} %",
                            row.test.interface_m / row.test.length_m, 100 * row.strain(), row.test.joint_m * 1e3,
                            row.linear, row.neo_hookean, 100 * row.error());
        if (row.shape_parameter) text += fmt::format("   R_omega {:.3f} matches", *row.shape_parameter);
        text += "\n";
    }
    const Mean linear = mean(rows, [](const ElongationRow& r) { return r.linear; });
    const Mean true_one = mean(rows, [](const ElongationRow& r) { return r.neo_hookean; });
    text +=
        fmt::format("E_A / E_B (A is held): {} by T3.7, {} as neo-Hookean parts\n", text_of(linear), text_of(true_one));
    const double ratio = above_one(true_one.value);
    text += fmt::format(
        "R_omega of the softer, {}: {:.3f} by T3.8 (\"thesis\"), {:.3f} for small strains "
        "(\"small-strain\")\n",
        true_one.value >= 1 ? "B" : "A", material::shape_parameter_of_thesis(ratio),
        material::shape_parameter_small_strain(ratio));
    return text;
}

std::string elongation_csv(const std::vector<ElongationRow>& rows) {
    std::string text =
        "length (mm),interface (mm),elongation (mm),joint (mm),ratio_linear,ratio_neo_hookean,"
        "error_linear,shape_parameter\n";
    for (const ElongationRow& row : rows) {
        text += fmt::format("{:.9g},{:.9g},{:.9g},{:.9g},{:.6g},{:.6g},{:.6g},", row.test.length_m * 1e3,
                            row.test.interface_m * 1e3, row.test.elongation_m * 1e3, row.test.joint_m * 1e3, row.linear,
                            row.neo_hookean, row.error());
        text += row.shape_parameter ? fmt::format("{:.6g}\n", *row.shape_parameter) : "\n";
    }
    return text;
}

std::string elongation_json(const std::vector<ElongationRow>& rows) {
    nlohmann::ordered_json json = {{"rows", nlohmann::ordered_json::array()}};
    for (const ElongationRow& row : rows) {
        nlohmann::ordered_json entry = {{"length_mm", row.test.length_m * 1e3},
                                        {"interface_mm", row.test.interface_m * 1e3},
                                        {"elongation_mm", row.test.elongation_m * 1e3},
                                        {"joint_mm", row.test.joint_m * 1e3},
                                        {"ratio_linear", row.linear},
                                        {"ratio_neo_hookean", row.neo_hookean},
                                        {"error_linear", row.error()},
                                        {"shape_parameter", nullptr}};
        if (row.shape_parameter) entry["shape_parameter"] = *row.shape_parameter;
        json["rows"].push_back(std::move(entry));
    }
    const Mean ratio = mean(rows, [](const ElongationRow& r) { return r.neo_hookean; });
    json["material_ratio"] = ratio.value;
    json["half_width_95"] = ratio.half_width;
    json["shape_parameter_thesis"] = material::shape_parameter_of_thesis(above_one(ratio.value));
    json["shape_parameter_small_strain"] = material::shape_parameter_small_strain(above_one(ratio.value));
    return json_text(json, 2);
}

}  // namespace pliant::calibrate
