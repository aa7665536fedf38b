// Listings of the library: text and JSON.
#include <nlohmann/json.hpp>

#include "base/core/json.hpp"
#include "robot/file/material_library.hpp"

namespace pliant::robot {
namespace {

using Constants = std::vector<std::pair<std::string, double>>;

/// Names as in the robot file, in Pa; exponents are dimensionless.
struct ConstantsOf {
    const MaterialSpec& spec;
    Constants two_moduli() const {
        return {{"youngs_modulus", spec.youngs_modulus_Pa}, {"poisson_ratio", spec.poisson_ratio}};
    }
    Constants operator()(const material::NeoHookean&) const { return two_moduli(); }
    Constants operator()(const material::ShapeBlend&) const { return two_moduli(); }
    Constants operator()(const material::StVenantKirchhoff&) const { return two_moduli(); }
    Constants operator()(const material::Corotated&) const { return two_moduli(); }
    Constants operator()(const material::Linear&) const { return two_moduli(); }
    Constants operator()(const material::MooneyRivlin& l) const {
        return {{"c10", l.c10_Pa}, {"c01", l.c01_Pa}, {"bulk_modulus", l.bulk_Pa}};
    }
    Constants operator()(const material::Yeoh& l) const {
        return {{"c10", l.c10_Pa}, {"c20", l.c20_Pa}, {"c30", l.c30_Pa}, {"bulk_modulus", l.bulk_Pa}};
    }
    Constants operator()(const material::Ogden& l) const {
        Constants list;
        for (int k = 0; k < l.terms; ++k) {
            list.emplace_back(fmt::format("mu_{}", k + 1), l.mu_Pa[k]);
            list.emplace_back(fmt::format("alpha_{}", k + 1), l.alpha[k]);
        }
        list.emplace_back("bulk_modulus", l.bulk_Pa);
        return list;
    }
};

Constants constants_of(const MaterialSpec& spec) {
    return std::visit(ConstantsOf{spec}, spec.law);
}

bool is_pressure(const std::string& constant) {
    return constant != "poisson_ratio" && constant.substr(0, 5) != "alpha";
}

std::string line(const LibraryMaterial& m) {
    return fmt::format("{:<20} {:<14} {:>9.4g} {:>8.4g} {:>9.4g} {:>14}  {:.2f} to {:.2f}\n", m.spec.name,
                       material::name(m.spec.law), m.spec.youngs_modulus_Pa / 1e6, m.spec.poisson_ratio,
                       m.spec.density_kg_m3, m.hardness, m.stretch[0], m.stretch[1]);
}

}  // namespace

std::string library_text() {
    std::string text = fmt::format("{:<20} {:<14} {:>9} {:>8} {:>9} {:>14}  {}\n", "material", "law", "E0 MPa", "nu",
                                   "kg/m^3", "hardness", "stretch");
    for (const EmbeddedFile& file : library_files()) {
        if (const auto material = library_material(file.name)) text += line(*material);
    }
    return text;
}

std::string material_text(const LibraryMaterial& m) {
    std::string text = fmt::format("{}: {}\n  law           {}\n", m.spec.name, m.title, material::name(m.spec.law));
    for (const auto& [name, value] : constants_of(m.spec)) {
        text += is_pressure(name) ? fmt::format("  {:<13} {:.6g} MPa\n", name, value / 1e6)
                                  : fmt::format("  {:<13} {:.6g}\n", name, value);
    }
    text += fmt::format("  density       {:.4g} kg/m^3\n", m.spec.density_kg_m3);
    if (!m.hardness.empty()) text += fmt::format("  hardness      {}\n", m.hardness);
    text += fmt::format("  stretch       {:.2f} to {:.2f}\n", m.stretch[0], m.stretch[1]);
    return text + fmt::format("  source        {}\n  derivation    {}\n", m.source, m.derivation);
}

std::string library_json(const std::vector<LibraryMaterial>& materials) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const LibraryMaterial& m : materials) {
        nlohmann::ordered_json constants;
        for (const auto& [name, value] : constants_of(m.spec))
            constants[is_pressure(name) ? name + "_Pa" : name] = value;
        list.push_back({{"name", m.spec.name},
                        {"title", m.title},
                        {"law", material::name(m.spec.law)},
                        {"constants", constants},
                        {"youngs_modulus_Pa", m.spec.youngs_modulus_Pa},
                        {"poisson_ratio", m.spec.poisson_ratio},
                        {"density_kg_m3", m.spec.density_kg_m3},
                        {"hardness", m.hardness},
                        {"stretch", m.stretch},
                        {"source", m.source},
                        {"derivation", m.derivation}});
    }
    return json_text(list, 2);
}

}  // namespace pliant::robot
