#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <type_traits>

#include "sim/calculix.hpp"

namespace pliant::sim::calculix {
namespace {

constexpr double mm_per_m = 1e3;
constexpr double uN_per_N = 1e6;
/// Of the ramped springs: far more than a cable can stretch or shrink, so that ccx never extrapolates.
constexpr double spring_range_mm = 1e5;

/// For the terms (J - 1)^(2i) / D_i that our laws do not have. Zeros do not switch them off: they made a bar 2 %
/// stiffer.
constexpr double no_more_D = 1e20;

/// CalculiX' number of the face opposite to a corner: its faces are 1-2-3, 1-4-2, 2-4-3, 3-4-1.
constexpr std::array<int, 4> face_opposite_to = {3, 4, 2, 1};

using Out = std::back_insert_iterator<std::string>;

/// 2/K, as CalculiX wants it.
double d1(double bulk_Pa) {
    return 2 / (bulk_Pa);
}

/// mu and alpha of every term, D1, and the higher D without effect; at most eight numbers a line.
Status write_ogden(Out out, const material::Ogden& law) {
    if (law.terms > 4) return input_error("CalculiX: an Ogden law of at most 4 terms, not {}", law.terms);
    std::vector<double> numbers;
    for (std::size_t k = 0; k < static_cast<std::size_t>(law.terms); ++k)
        numbers.insert(numbers.end(), {law.mu_Pa[k], law.alpha[k]});
    numbers.push_back(d1(law.bulk_Pa));
    numbers.resize(3 * static_cast<std::size_t>(law.terms), no_more_D);
    fmt::format_to(out, "*HYPERELASTIC,OGDEN,N={}", law.terms);
    for (std::size_t k = 0; k < numbers.size(); ++k)
        fmt::format_to(out, "{}{:.10g}", k % 8 == 0 ? "\n" : ",", numbers[k]);
    fmt::format_to(out, "\n");
    return {};
}

Status write_law(Out out, const material::Law& any) {
    return std::visit(
        [&](const auto& law) -> Status {
            using L = std::decay_t<decltype(law)>;
            if constexpr (std::is_same_v<L, material::NeoHookean>) {
                fmt::format_to(out, "*HYPERELASTIC,NEO HOOKE\n{:.10g},{:.10g}\n", law.shear_Pa / 2, d1(law.bulk_Pa));
            } else if constexpr (std::is_same_v<L, material::MooneyRivlin>) {
                fmt::format_to(out, "*HYPERELASTIC,MOONEY-RIVLIN\n{:.10g},{:.10g},{:.10g}\n", law.c10_Pa, law.c01_Pa,
                               d1(law.bulk_Pa));
            } else if constexpr (std::is_same_v<L, material::Yeoh>) {
                fmt::format_to(out, "*HYPERELASTIC,YEOH\n{:.10g},{:.10g},{:.10g},{:.10g},{:.10g},{:.10g}\n", law.c10_Pa,
                               law.c20_Pa, law.c30_Pa, d1(law.bulk_Pa), no_more_D, no_more_D);
            } else if constexpr (std::is_same_v<L, material::Ogden>) {
                return write_ogden(out, law);
            } else if constexpr (std::is_same_v<L, material::StVenantKirchhoff>) {
                const material::Moduli m = material::moduli(any);
                fmt::format_to(out, "*ELASTIC\n{:.10g},{:.10g}\n", material::youngs_modulus(m),
                               material::poisson_ratio(m));
            } else {
                return input_error("CalculiX has no counterpart of the law {}", material::name(any));
            }
            return {};
        },
        any);
}

class DeckWriter {
public:
    DeckWriter(const Description& description, const Effort& effort) : d_(description), effort_(effort) {}

    Result<std::string> write() {
        for (const auto part : {&DeckWriter::check, &DeckWriter::mesh, &DeckWriter::materials, &DeckWriter::springs,
                                &DeckWriter::step, &DeckWriter::pressures}) {
            if (Status done = (this->*part)(); !done) return tl::unexpected(done.error());
        }
        line("*NODE PRINT,NSET=ALL,FREQUENCY=100000\nU,RF\n*END STEP");
        return std::move(text_);
    }

private:
    template <class... Args>
    void line(fmt::format_string<Args...> text, Args&&... args) {
        fmt::format_to(out_, text, std::forward<Args>(args)...);
        text_ += '\n';
    }

    Status check() {
        if (d_.contact || !d_.growths.empty() || !d_.plates.empty() || norm(d_.gravity_m_s2) > 0)
            return input_error("the CalculiX deck has no contact, growth, rigid plates or gravity");
        for (const Support& support : d_.supports) {
            if (support.turn.angle_rad != 0) return input_error("CalculiX: support {} must not turn", support.name);
        }
        for (const Cable& cable : d_.cables) {
            if (cable.target.kind != CableTarget::Kind::tension_N)
                return input_error("CalculiX: cable {} must be driven by its tension", cable.name);
            if (cable.friction != 0) return input_error("CalculiX: cable {} must be without friction", cable.name);
        }
        for (const Chamber& chamber : d_.chambers) {
            if (chamber.target.kind != ChamberTarget::Kind::pressure_Pa)
                return input_error("CalculiX: chamber {} must be driven by its pressure", chamber.name);
        }
        return {};
    }

    void node(const Vec3& p) {
        ++nodes_;
        line("{},{:.12g},{:.12g},{:.12g}", nodes_, p.x * mm_per_m, p.y * mm_per_m, p.z * mm_per_m);
    }

    Status mesh() {
        line("*NODE,NSET=ALL");
        for (const Vec3& p : d_.mesh.points) node(p);
        for (std::size_t r = 0; r < d_.material_of_region.size(); ++r) {
            line("*ELEMENT,TYPE={},ELSET=R{}", d_.mesh.order == 2 ? "C3D10" : "C3D4", r);
            for (std::size_t t = 0; t < d_.mesh.tet_count(); ++t) {
                if (d_.mesh.region[t] != static_cast<int>(r)) continue;
                fmt::format_to(out_, "{}", t + 1);
                for (const int n : d_.mesh.tet(t)) fmt::format_to(out_, ",{}", n + 1);
                text_ += '\n';
            }
        }
        return {};
    }

    Status materials() {
        for (std::size_t m = 0; m < d_.materials.size(); ++m) {
            line("*MATERIAL,NAME=M{}", m);
            if (Status done = write_law(out_, d_.materials[m].law); !done) return done;
        }
        for (std::size_t r = 0; r < d_.material_of_region.size(); ++r)
            line("*SOLID SECTION,ELSET=R{},MATERIAL=M{}", r, d_.material_of_region[r]);
        return {};
    }

    /// Node of a cable's point, 1-based; points that are fixed in space get a node of their own.
    Result<int> cable_node(const Cable& cable, const Attachment& point) {
        if (point.nodes.size() == 1) return point.nodes[0] + 1;
        if (!point.nodes.empty()) return input_error("CalculiX: a point of cable {} is not a node", cable.name);
        line("*NODE");
        node(point.fixed);
        anchors_.push_back(nodes_);
        return nodes_;
    }

    /// A segment that pulls with the same force at any length; the force grows with the temperature, from 0 to 1.
    Status springs() {
        int element = static_cast<int>(d_.mesh.tet_count());
        for (std::size_t c = 0; c < d_.cables.size(); ++c) {
            std::vector<int> path;
            for (const Attachment& point : d_.cables[c].points) {
                const Result<int> at = cable_node(d_.cables[c], point);
                if (!at) return tl::unexpected(at.error());
                path.push_back(*at);
                sprung_.push_back(*at);
            }
            line("*ELEMENT,TYPE=SPRINGA,ELSET=C{}", c);
            for (std::size_t s = 1; s < path.size(); ++s) line("{},{},{}", ++element, path[s - 1], path[s]);
            const double tension = uN_per_N * d_.cables[c].target.at(1);
            line("*SPRING,NONLINEAR,ELSET=C{}", c);
            for (const double share : {0.0, 1.0}) {
                for (const double elongation : {-spring_range_mm, spring_range_mm})
                    line("{:#.10g},{:#.10g},{:#.10g}", share * tension, elongation, share);
            }
        }
        if (sprung_.empty()) return {};
        line("*INITIAL CONDITIONS,TYPE=TEMPERATURE");
        for (const int n : sprung_) line("{},0.", n);
        return {};
    }

    Status step() {
        for (const int n : anchors_) line("*BOUNDARY\n{},1,3", n);
        line("*STEP,NLGEOM,INC=1000\n*STATIC\n{:.10g},1.", effort_.first_increment);
        // Both residual limits: ccx takes the second, 2 % if nothing is said, once it has tried a number of times. It
        // has no stiffness of following pressures and then needs many more iterations than it allows itself.
        line("*CONTROLS,PARAMETERS=TIME INCREMENTATION\n20,40,60,60,30,10,,5");
        line("*CONTROLS,PARAMETERS=FIELD\n{0:.3g},{0:.3g},,,{0:.3g},,,", effort_.tolerance);
        if (!d_.supports.empty()) line("*BOUNDARY");
        for (const Support& support : d_.supports) {
            const Vec3 move = support.share.at(1) * mm_per_m * support.move_m;
            for (const int n : support.nodes)
                line("{0},1,1,{1:.12g}\n{0},2,2,{2:.12g}\n{0},3,3,{3:.12g}", n + 1, move.x, move.y, move.z);
        }
        if (!d_.loads.empty()) line("*CLOAD");
        for (const Load& load : d_.loads) {
            for (std::size_t k = 0; k < load.nodes.size(); ++k) {
                const Vec3 f = load.share.at(1) * load.shares[k] * uN_per_N * load.force_N;
                line("{0},1,{1:.12g}\n{0},2,{2:.12g}\n{0},3,{3:.12g}", load.nodes[k] + 1, f.x, f.y, f.z);
            }
        }
        if (!sprung_.empty()) line("*TEMPERATURE");
        for (const int n : sprung_) line("{},1.", n);
        return {};
    }

    Status pressures() {
        if (d_.chambers.empty() && d_.pressures.empty()) return {};
        for (const mesh::Face& face : mesh::boundary_faces(d_.mesh)) {
            std::array<int, 3> corners = {face.nodes[0], face.nodes[1], face.nodes[2]};
            std::sort(corners.begin(), corners.end());
            const auto tet = d_.mesh.tet(static_cast<std::size_t>(face.tet));
            std::size_t opposite = 0;
            while (std::find(corners.begin(), corners.end(), tet[opposite]) != corners.end()) ++opposite;
            outer_[corners] = {face.tet, face_opposite_to[opposite]};
        }
        line("*DLOAD");
        for (const Chamber& chamber : d_.chambers) {
            if (Status done = press(chamber.name, chamber.wall, chamber.target.at(1)); !done) return done;
        }
        for (const PressureLoad& load : d_.pressures) {
            if (Status done = press(load.name, load.wall, load.pressure_Pa * load.share.at(1)); !done) return done;
        }
        return {};
    }

    Status press(const std::string& name, const Wall& wall, double pressure_Pa) {
        for (const WallFace& face : wall.faces) {
            std::array<int, 3> corners{};
            for (std::size_t k = 0; k < 3; ++k) {
                const Attachment& point = wall.points[static_cast<std::size_t>(face[k])];
                corners[k] = point.nodes.size() == 1 ? point.nodes[0] : -1;
            }
            std::sort(corners.begin(), corners.end());
            const auto found = outer_.find(corners);
            if (found == outer_.end())
                return input_error("CalculiX: the wall of {} does not lie on faces of the mesh", name);
            line("{},P{},{:.12g}", found->second[0] + 1, found->second[1], pressure_Pa);
        }
        return {};
    }

    const Description& d_;
    const Effort& effort_;
    std::string text_;
    Out out_ = std::back_inserter(text_);
    int nodes_ = 0;
    std::vector<int> anchors_;
    std::vector<int> sprung_;
    std::map<std::array<int, 3>, std::array<int, 2>> outer_;  ///< corners of a face: its tet and CalculiX' number of it
};

}  // namespace

Result<std::string> deck(const Description& description, const Effort& effort) {
    return DeckWriter(description, effort).write();
}

}  // namespace pliant::sim::calculix
