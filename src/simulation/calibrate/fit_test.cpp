#include "simulation/calibrate/fit.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "base/core/near.hpp"

using namespace pliant;
using namespace pliant::calibrate;

namespace {

/// Rows of a law's closed form, at 40 stretches, with normal noise.
template <class Stress>
TensileTest made_test(Stress stress, double noise_Pa, unsigned seed = 1) {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0, 1);
    TensileTest test;
    for (int i = 1; i <= 40; ++i) {
        test.stretch.push_back(1 + 0.05 * i);
        test.stress_Pa.push_back(stress(test.stretch.back()) + noise_Pa * noise(random));
    }
    return test;
}

double mooney(double l) {
    return 2 * (l - 1 / (l * l)) * (0.2e6 + 0.05e6 / l);
}
double yeoh(double l) {
    const double x = l * l + 2 / l - 3;
    return 2 * (l - 1 / (l * l)) * (0.11e6 - 2 * 0.01e6 * x + 3 * 0.003e6 * x * x);
}
double ogden(double l) {
    return 2 * 0.3e6 / 1.3 * (std::pow(l, 0.3) - std::pow(l, -1.65)) +
           2 * 0.01e6 / 5 * (std::pow(l, 4) - std::pow(l, -3.5));
}

Fit fit_of(const TensileTest& test, FitLaw law, int terms = 1) {
    const Result<Fit> result = fit(test, {law, terms, 0.49});
    REQUIRE_MESSAGE(result, (result ? "" : result.error().message));
    return *result;
}

}  // namespace

TEST_CASE("exact data give the exact constants") {
    const Fit neo = fit_of(made_test([](double l) { return 0.4e6 * (l - 1 / (l * l)); }, 0), FitLaw::neo_hookean);
    CHECK(neo.constants[0].value == near(1.2e6, {.relative = 1e-12}));  // E = 3 mu
    CHECK(neo.r_squared == near(1, {.relative = 1e-12}));
    CHECK(std::get<material::NeoHookean>(neo.law).shear_Pa == near(0.4e6, {.relative = 1e-12}));

    const Fit mr = fit_of(made_test(mooney, 0), FitLaw::mooney_rivlin);
    CHECK(mr.constants[0].value == near(0.2e6, {.relative = 1e-12}));
    CHECK(mr.constants[1].value == near(0.05e6, {.relative = 1e-12}));
    CHECK(mr.warnings.empty());

    const Fit y = fit_of(made_test(yeoh, 0), FitLaw::yeoh);
    CHECK(y.constants[1].value == near(-0.01e6, {.relative = 1e-12}));
    CHECK(y.constants[2].value == near(0.003e6, {.relative = 1e-12}));

    const Fit o = fit_of(made_test(ogden, 0), FitLaw::ogden, 2);
    CHECK(o.rms_error_Pa < 1);
    const auto law = std::get<material::Ogden>(o.law);
    const int small = law.alpha[0] < law.alpha[1] ? 0 : 1;
    CHECK(law.alpha[small] == near(1.3, {.relative = 1e-12}));
    CHECK(law.alpha[1 - small] == near(5, {.relative = 1e-12}));
    CHECK(law.mu_Pa[small] == near(0.3e6, {.relative = 1e-12}));
}

TEST_CASE("the 95 % interval holds the true constant in about 95 of 100 noisy tests") {
    // 400 tests: the count of hits has a standard deviation of 4.4 about 380.
    const auto hits = [](auto stress, FitLaw law, std::size_t which, double truth) {
        int count = 0;
        for (unsigned seed = 0; seed < 400; ++seed) {
            const Constant c = fit_of(made_test(stress, 2e4, seed), law).constants[which];
            if (std::fabs(c.value - truth) <= c.half_width) ++count;
        }
        return count;
    };
    const int mr = hits(mooney, FitLaw::mooney_rivlin, 1, 0.05e6);
    CHECK(mr > 362);
    CHECK(mr < 397);
    const auto one_term = [](double l) { return 2 * 0.3e6 / 3 * (std::pow(l, 2) - std::pow(l, -2.5)); };
    const int og = hits(one_term, FitLaw::ogden, 1, 3.0);
    CHECK(og > 362);
    CHECK(og < 397);
}

TEST_CASE("Student's t against the tables") {
    // Pearson and Hartley, Biometrika Tables for Statisticians, table 12.
    for (const auto& [n, t] : {std::pair(1, 12.706), std::pair(2, 4.303), std::pair(3, 3.182), std::pair(4, 2.776),
                               std::pair(5, 2.571), std::pair(10, 2.228), std::pair(30, 2.042), std::pair(120, 1.980)})
        CHECK(student_t_95(n) == near(t, {.relative = 2e-3}));
}

TEST_CASE("a law that loses stability within the data is reported, a stable one is not") {
    CHECK(unstable_ranges(material::MooneyRivlin{0.2e6, 0.05e6, 1e7}, 0.5, 3).empty());
    CHECK(unstable_ranges(material::Yeoh{0.11e6, 0.02e6, 0, 1e7}, 0.5, 3).empty());
    // Negative c20: the true stress of a pulled bar stops growing where d(l P)/d(ln l) = 0.
    const material::Law soft = material::Yeoh{0.1e6, -0.01e6, 0, 1e7};
    const auto found = unstable_ranges(soft, 1, 3);
    REQUIRE(found.size() == 3);
    CHECK(found[0].find("pull or push") != std::string::npos);
    CHECK(unstable_ranges(soft, 1, 1.2).empty());
    // Negative c01: stable in uniaxial tension, unstable in equibiaxial tension.
    const auto balloon = unstable_ranges(material::MooneyRivlin{0.2e6, -0.02e6, 1e7}, 1, 3.5);
    CHECK(std::any_of(balloon.begin(), balloon.end(),
                      [](const std::string& text) { return text.find("balloon") != std::string::npos; }));
}

TEST_CASE("too little data is an error") {
    const auto few = fit({{1.0, 1.1, 1.2}, {0, 1e5, 2e5}}, {FitLaw::yeoh, 1, 0.49});
    REQUIRE_FALSE(few);
    CHECK(few.error().message.find("2 rows with a stretch other than 1 are too few for 3 constants") !=
          std::string::npos);
    CHECK_FALSE(fit({{1.1, 1.2, 1.3}, {0, 0, 0}}, {FitLaw::neo_hookean, 1, 0.49}));
}

TEST_CASE("a constant that the data do not determine is named") {
    const Fit result = fit_of(made_test([](double l) { return 0.4e6 * (l - 1 / (l * l)); }, 3e4), FitLaw::yeoh);
    bool named = false;
    for (const std::string& warning : result.warnings) named = named || warning.find("cannot be told from zero") == 4;
    CHECK(named);
}

TEST_CASE("terms of an Ogden law that are one and the same are named, and have no interval") {
    const TensileTest test = made_test([](double l) { return 0.1e6 * (l - 1 / (l * l)); }, 1e-3);
    const Fit result = fit_of(test, FitLaw::ogden, 3);
    REQUIRE_FALSE(result.warnings.empty());
    CHECK(result.warnings[0].find("the data cannot tell ") == 0);
    CHECK(result.warnings[0].find(" apart") != std::string::npos);
    CHECK(std::ranges::any_of(result.constants, [](const Constant& c) { return std::isinf(c.half_width); }));
    CHECK(fit_text(result).find("(no interval)") != std::string::npos);
    CHECK(fit_json(result, test).find("\"confidence_95\": null") != std::string::npos);
    const Fit apart = fit_of(made_test(ogden, 1e-3), FitLaw::ogden, 2);
    CHECK(std::ranges::all_of(apart.constants, [](const Constant& c) { return std::isfinite(c.half_width); }));
}

TEST_CASE("the two moduli of a neo-Hookean fit are told apart") {
    const TensileTest test = made_test([](double l) { return 0.1e6 * (l - 1 / (l * l)); }, 0);
    const Fit result = fit_of(test, FitLaw::neo_hookean);
    CHECK(fit_text(result).find("3 mu; the material below has 2 mu (1 + poisson_ratio), 0.298 MPa") !=
          std::string::npos);
    CHECK(fit_json(result, test).find("\"youngs_modulus_Pa\": 298") != std::string::npos);
}

TEST_CASE("the fitted law is written as a material for the robot file") {
    const Fit y = fit_of(made_test(yeoh, 0), FitLaw::yeoh);
    CHECK(material_toml(y, "cast") ==
          "[material.cast]\nlaw = \"yeoh\"\nc10 = \"0.11 MPa\"\nc20 = \"-10 kPa\"\nc30 = \"3 kPa\"\npoisson_ratio = "
          "0.49\n");
    const Fit neo = fit_of(made_test([](double l) { return 0.4e6 * (l - 1 / (l * l)); }, 0), FitLaw::neo_hookean);
    CHECK(material_toml(neo, "cast").find("youngs_modulus = \"1.192 MPa\"") != std::string::npos);  // 2 mu (1 + nu)
    CHECK(material_toml(y, "Skin 20 \"M\"").find("[material.\"Skin 20 \\\"M\\\"\"]") == 0);
    CHECK(material_toml(y, "a\nb").find("[material.\"a\\u000ab\"]") == 0);
    CHECK(fit_json(y, made_test(yeoh, 0)).find("\"confidence_95\"") != std::string::npos);
}

TEST_CASE("the material has the Poisson's ratio that was asked for, without rounding") {
    const TensileTest test = made_test([](double l) { return 0.1e6 * (l - 1 / (l * l)); }, 0);
    for (const double nu : {0.0, 0.1, 0.3}) {
        const Result<Fit> found = fit(test, {.law = FitLaw::neo_hookean, .poisson_ratio = nu});
        REQUIRE(found);
        CHECK(material_toml(*found, "cast").ends_with(fmt::format("\npoisson_ratio = {:g}\n", nu)));
        CHECK(fit_json(*found, test).find(fmt::format("\"poisson_ratio\": {:.1f}", nu)) != std::string::npos);
    }
}

TEST_CASE("rows at stretch 1, which tell nothing, do not narrow the interval") {
    TensileTest test{{1.1, 1.2, 1.3, 1.4}, {93060.1, 179980, 237106, 296240}};
    const Constant alone = fit_of(test, FitLaw::neo_hookean).constants[0];
    test.stretch.insert(test.stretch.begin(), 20, 1.0);
    test.stress_Pa.insert(test.stress_Pa.begin(), 20, 0.0);
    const Constant with = fit_of(test, FitLaw::neo_hookean).constants[0];
    CHECK(with.value == near(alone.value, {.relative = 1e-12}));
    CHECK(with.half_width == near(alone.half_width, {.relative = 1e-9}));
}
