// pliant calibrate: material constants from tests. `tensile` fits a measured curve, `elongation` evaluates a bar of two
// materials, `ratio` simulates that bar.
#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <optional>
#include <vector>

#include "../usage.hpp"
#include "base/core/files.hpp"
#include "base/core/part_of_work.hpp"
#include "base/core/units.hpp"
#include "command.hpp"
#include "output_option.hpp"
#include "presentation/draw/plot.hpp"
#include "simulation/calibrate/elongation.hpp"
#include "simulation/calibrate/fit.hpp"
#include "simulation/calibrate/ratio.hpp"

namespace pliant::app {
namespace {

namespace fs = std::filesystem;

struct Files {
    std::string folder;  ///< empty: no output is written
    Output output;
};

/// Before the work, so that it is not in vain. `test`: file of measurements, if any.
Status check_place(const Files& files, const std::string& test = "") {
    if (files.folder.empty()) return {};
    if (Status outside = check_outside(test, files.folder); !outside) return outside;
    return check_folder_place(files.folder, "calibration.json");
}

Status write_fit(const Files& files, const std::string& json, const std::string& csv, const report::Plot& plot) {
    if (files.folder.empty()) return {};
    const Result<std::string> png = report::plot_png(plot);
    if (!png) return tl::unexpected(png.error());
    return write_folder(files.folder, "calibration.json", [&](const fs::path& folder) -> Status {
        if (Status status = write_file(folder / "calibration.json", json); !status) return status;
        if (Status status = write_file(folder / "calibration.csv", csv); !status) return status;
        return write_file(folder / "calibration.png", *png);
    });
}

void print_fit(const Files& files, const std::string& text, const std::string& json) {
    if (files.output.json)
        fmt::print("{}\n", json);
    else if (!files.output.quiet)
        fmt::print("{}", text);
}

struct RatioCommand : Files {
    calibrate::RatioOptions options;
    std::vector<int> cells = {48, 5, 5};
    std::vector<double> interfaces = {0.5};
};

using RatioRuns = std::vector<std::pair<calibrate::RatioOptions, calibrate::RatioResult>>;

/// The points of every interface and the two formulas; for a single interface its fitted curve too.
report::Plot ratio_plot(const RatioRuns& runs) {
    report::Plot plot{"Shape parameter of the soft part", "material ratio R_m", "R_omega", {}};
    double most = 1;
    for (const auto& [options, result] : runs) {
        report::Series found{fmt::format("interface at {:g}", options.interface), {}, true};
        for (const auto& row : result.rows) {
            found.points.push_back({row.material_ratio, row.shape_parameter});
            most = std::max(most, row.material_ratio);
        }
        plot.series.push_back(std::move(found));
    }
    report::Series curve{"quadratic through them", {}, false};
    report::Series thesis{"T3.8", {}, false};
    report::Series small{"small strains, (3 R_m - 1) / 2", {}, false};
    const auto& c = runs.front().second.curve;
    for (int i = 0; i <= 100; ++i) {
        const double R = 1 + (most - 1) * i / 100;
        if (c) curve.points.push_back({R, ((*c)[0] * R + (*c)[1]) * R + (*c)[2]});
        thesis.points.push_back({R, material::shape_parameter_of_thesis(R)});
        small.points.push_back({R, material::shape_parameter_small_strain(R)});
    }
    if (runs.size() == 1 && c) plot.series.push_back(curve);
    plot.series.push_back(thesis);
    plot.series.push_back(small);
    return plot;
}

/// The text of one run as it is; for several runs all texts, each with its interface.
std::string ratio_texts(const RatioRuns& runs) {
    if (runs.size() == 1) return calibrate::ratio_text(runs.front().second);
    std::string text;
    for (const auto& [options, result] : runs)
        text += fmt::format("interface at {:g} of the length\n{}", options.interface, calibrate::ratio_text(result));
    return text;
}

std::string ratio_jsons(const RatioRuns& runs) {
    if (runs.size() == 1) return calibrate::ratio_json(runs.front().second, runs.front().first);
    std::string text;
    for (const auto& [options, result] : runs)
        text += (text.empty() ? "[" : ",\n") + calibrate::ratio_json(result, options);
    return text + "]";
}

/// For several runs with a leading column for the interface.
std::string ratio_csvs(const RatioRuns& runs) {
    if (runs.size() == 1) return calibrate::ratio_csv(runs.front().second);
    std::string text;
    for (const auto& [options, result] : runs) {
        const std::string table = calibrate::ratio_csv(result);
        for (std::size_t at = 0; at < table.size();) {
            const std::size_t end = table.find('\n', at) + 1;
            const std::string line = table.substr(at, end - at);
            if (at > 0) text += fmt::format("{:g},{}", options.interface, line);
            if (at == 0 && text.empty()) text = "interface," + line;
            at = end;
        }
    }
    return text;
}

Status run_ratio(RatioCommand& command) {
    if (Status place = check_place(command); !place) return place;
    std::copy(command.cells.begin(), command.cells.end(), command.options.cells.begin());
    const auto progress = terminal_progress(command.output);
    RatioRuns runs;
    for (std::size_t i = 0; i < command.interfaces.size(); ++i) {
        command.options.interface = command.interfaces[i];
        auto part = equal_part(*progress, "ratio", i, command.interfaces.size());
        auto result = calibrate::calibrate_ratio(command.options, part);
        if (!result) return tl::unexpected(result.error());
        runs.emplace_back(command.options, std::move(*result));
    }
    const std::string json = ratio_jsons(runs);
    print_fit(command, ratio_texts(runs), json);
    return write_fit(command, json, ratio_csvs(runs), ratio_plot(runs));
}

struct TensileCommand : Files {
    std::string file;
    std::string name;
    std::string law = "neo-hookean";
    calibrate::FitOptions options;
    std::optional<int> terms;
    double most_stretch = 0;
};

/// Rows up to a maximum stretch: a law with few constants cannot fit rubber at large stretches.
calibrate::TensileTest up_to(const calibrate::TensileTest& test, double most_stretch) {
    if (most_stretch == 0) return test;
    calibrate::TensileTest part;
    for (std::size_t i = 0; i < test.stretch.size(); ++i) {
        if (test.stretch[i] > most_stretch) continue;
        part.stretch.push_back(test.stretch[i]);
        part.stress_Pa.push_back(test.stress_Pa[i]);
    }
    return part;
}

report::Plot tensile_plot(const TensileCommand& command, const calibrate::TensileTest& test,
                          const calibrate::Fit& fit) {
    report::Series measured{"measured", {}, true};
    report::Series fitted{std::string(material::name(fit.law)), {}, false};
    double low = 1;
    double high = 1;
    for (std::size_t i = 0; i < test.stretch.size(); ++i) {
        measured.points.push_back({test.stretch[i], test.stress_Pa[i] / 1e6});
        low = std::min(low, test.stretch[i]);
        high = std::max(high, test.stretch[i]);
    }
    for (int i = 0; i <= 200; ++i) {
        const double l = low + (high - low) * i / 200;
        fitted.points.push_back({l, calibrate::uniaxial_stress_Pa(fit.law, l) / 1e6});
    }
    return {command.name, "stretch", "nominal stress (MPa)", {measured, fitted}};
}

std::string tensile_csv(const calibrate::TensileTest& test, const calibrate::Fit& fit) {
    std::string text = "stretch,stress (Pa),fitted stress (Pa)\n";
    for (std::size_t i = 0; i < test.stretch.size(); ++i)
        text += fmt::format("{:.9g},{:.9g},{:.9g}\n", test.stretch[i], test.stress_Pa[i], fit.stress_Pa[i]);
    return text;
}

Status run_tensile(TensileCommand& command) {
    using calibrate::FitLaw;
    const std::map<std::string, FitLaw> laws = {{"neo-hookean", FitLaw::neo_hookean},
                                                {"mooney-rivlin", FitLaw::mooney_rivlin},
                                                {"yeoh", FitLaw::yeoh},
                                                {"ogden", FitLaw::ogden}};
    command.options.law = laws.at(command.law);
    if (command.terms && command.options.law != FitLaw::ogden)
        return input_error("--terms {}: is the number of terms of Ogden's law; add --law ogden", *command.terms);
    command.options.terms = command.terms.value_or(command.options.terms);
    if (Status place = check_place(command, command.file); !place) return place;
    const Result<std::string> text = read_file(command.file);
    if (!text) return tl::unexpected(text.error());
    const auto all = calibrate::parse_tensile_csv(*text, command.file);
    if (!all) return tl::unexpected(all.error());
    const calibrate::TensileTest test = up_to(*all, command.most_stretch);
    const auto fit = calibrate::fit(test, command.options);
    if (!fit) return tl::unexpected(Error{fit.error().cause, command.file + ": " + fit.error().message});
    const std::string json = calibrate::fit_json(*fit, test);
    print_fit(command, calibrate::fit_text(*fit) + "\n" + calibrate::material_toml(*fit, command.name), json);
    return write_fit(command, json, tensile_csv(test, *fit), tensile_plot(command, test, *fit));
}

struct ElongationCommand : Files {
    std::string file;
    std::string length, interface, elongation, joint;  ///< of one test, with units
    bool match = false;

    [[nodiscard]] bool one_test() const {
        return !(length.empty() && interface.empty() && elongation.empty() && joint.empty());
    }
};

Result<std::vector<calibrate::ElongationRow>> one_test(const ElongationCommand& command) {
    calibrate::ElongationTest test;
    const std::pair<const char*, std::pair<const std::string*, double*>> options[] = {
        {"--length", {&command.length, &test.length_m}},
        {"--interface", {&command.interface, &test.interface_m}},
        {"--elongation", {&command.elongation, &test.elongation_m}},
        {"--joint", {&command.joint, &test.joint_m}}};
    for (const auto& [name, option] : options) {
        if (option.first->empty())
            return input_error("{} is missing; a test needs --length, --interface, --elongation and --joint", name);
        const Result<double> value = parse_quantity(*option.first, Dimension::length);
        if (!value) return input_error("{}: {}", name, value.error().message);
        *option.second = *value;
    }
    const auto row = calibrate::evaluate(test);
    if (!row) return input_error("--{}", row.error().message);
    return std::vector<calibrate::ElongationRow>{*row};
}

Result<std::vector<calibrate::ElongationRow>> read_tests(const ElongationCommand& command) {
    if (command.one_test() == !command.file.empty())
        return input_error("give a table of tests, or --length, --interface, --elongation and --joint of one");
    if (command.one_test()) return one_test(command);
    const Result<std::string> text = read_file(command.file);
    if (!text) return tl::unexpected(text.error());
    return calibrate::parse_elongation_csv(*text, command.file);
}

report::Plot elongation_plot(const std::vector<calibrate::ElongationRow>& rows) {
    report::Plot plot{"Ratio of moduli from elongation tests", "strain (%)", "R_m = E_A / E_B", {}};
    report::Series linear{"T3.7: linear springs", {}, true}, true_one{"neo-Hookean parts", {}, true};
    for (const calibrate::ElongationRow& row : rows) {
        linear.points.push_back({100 * row.strain(), row.linear});
        true_one.points.push_back({100 * row.strain(), row.neo_hookean});
    }
    plot.series = {linear, true_one};
    return plot;
}

Status run_elongation(const ElongationCommand& command) {
    if (Status place = check_place(command, command.file); !place) return place;
    auto rows = read_tests(command);
    if (!rows) return tl::unexpected(rows.error());
    const auto progress = terminal_progress(command.output);
    for (std::size_t i = 0; command.match && i < rows->size(); ++i) {
        auto part = equal_part(*progress, "match", i, rows->size());
        const Result<double> match = calibrate::match_shape_parameter((*rows)[i].test, part);
        if (!match) return tl::unexpected(match.error());
        (*rows)[i].shape_parameter = *match;
    }
    const std::string json = calibrate::elongation_json(*rows);
    print_fit(command, calibrate::elongation_text(*rows), json);
    return write_fit(command, json, calibrate::elongation_csv(*rows), elongation_plot(*rows));
}

void add_files(CLI::App& command, Files& files) {
    add_output_path(command, files.folder, "folder for calibration.json, .csv and .png");
    add_output_options(command, files.output, true);
}

void add_ratio(CLI::App& parent, int& status) {
    auto c = std::make_shared<RatioCommand>();
    CLI::App* command = parent.add_subcommand("ratio", "the thesis' shape parameter for a ratio of materials");
    command->add_option("--ratios", c->options.ratios, "material ratios, stiff over soft")->delimiter(',')->required();
    command->add_option("--strain", c->options.strain, "strain of the whole bar")->capture_default_str();
    command->add_option("--poisson", c->options.poisson_ratio, "Poisson ratio of the neo-Hookean reference")
        ->capture_default_str();
    command
        ->add_option("--interface", c->interfaces,
                     "share of the length at which the stiff part ends, 0 to 1; several are compared")
        ->delimiter(',')
        ->capture_default_str();
    command->add_option("--cells", c->cells, "cells along x, y and z of the 100 x 10 x 10 mm bar, six tets each")
        ->delimiter(',')
        ->expected(3)
        ->capture_default_str();
    add_files(*command, *c);
    command->footer("Example: pliant calibrate ratio --ratios 1,2,3.75,6,8 -o ratio");
    on_call(*command, status, [c] { return run_ratio(*c); });
}

void add_elongation(CLI::App& parent, int& status) {
    auto c = std::make_shared<ElongationCommand>();
    CLI::App* command = parent.add_subcommand("elongation", "ratio of two moduli from a bar of two materials (T3.7)");
    command->add_option("data", c->file, "CSV: length, interface, elongation and joint, each with its unit");
    command->add_option("--length", c->length, "length of the bar at rest, as in \"100 mm\"");
    command->add_option("--interface", c->interface, "distance from the held end to the joint at rest");
    command->add_option("--elongation", c->elongation, "elongation of the bar");
    command->add_option("--joint", c->joint, "displacement of the joint");
    command->add_flag("--match", c->match,
                      "also find the shape parameter with which a simulated bar gives the same displacement");
    add_files(*command, *c);
    command->footer(
        "Example: pliant calibrate elongation --length 100mm --interface 50mm --elongation 30mm --joint 5.14mm");
    on_call(*command, status, [c] { return run_elongation(*c); });
}

void add_tensile(CLI::App& parent, int& status) {
    auto c = std::make_shared<TensileCommand>();
    CLI::App* command = parent.add_subcommand("tensile", "fit the constants of a law to a tensile test");
    command->add_option("data", c->file, "CSV: stretch or strain, and nominal stress with its unit")->required();
    command->add_option("--law", c->law, "elastic law")
        ->check(CLI::IsMember({"neo-hookean", "mooney-rivlin", "yeoh", "ogden"}))
        ->capture_default_str();
    command->add_option("--terms", c->terms, "number of terms of Ogden's law, with --law ogden (default 1)")
        ->check(between(1, 3));
    command->add_option("--max-stretch", c->most_stretch, "ignore rows beyond this stretch")
        ->check(between(1.0, 100.0));
    command
        ->add_option("--poisson", c->options.poisson_ratio,
                     "Poisson ratio for the robot file; the fit is incompressible")
        ->check(between(0.0, 0.4999))
        ->capture_default_str();
    command->add_option("--name", c->name, "name of the material (default: that of the file)");
    add_files(*command, *c);
    command->footer("Example: pliant calibrate tensile pull.csv --law yeoh --max-stretch 3 -o fit");
    on_call(*command, status, [c] {
        if (c->name.empty()) c->name = fs::path(c->file).stem().string();
        return run_tensile(*c);
    });
}

}  // namespace

void add_calibrate(CLI::App& app, int& status) {
    CLI::App* command = app.add_subcommand("calibrate", "fit constants of materials to tests");
    command->require_subcommand(1);
    command->footer("Example: pliant calibrate tensile pull.csv --law yeoh");
    add_elongation(*command, status);
    add_ratio(*command, status);
    add_tensile(*command, status);
}

}  // namespace pliant::app
