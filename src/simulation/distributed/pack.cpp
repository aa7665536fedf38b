#include "simulation/distributed/pack.hpp"

#include <cassert>
#include <cstdint>
#include <cstring>
#include <optional>
#include <type_traits>

namespace pliant::sim::distributed {
namespace {

/// Plain data as bytes, everything else member by member with `members`.
class Writer {
public:
    template <class... T>
    void operator()(T&... values) {
        (put(values), ...);
    }
    std::string bytes;

private:
    template <class T>
    void put(T& value) {
        if constexpr (std::is_trivially_copyable_v<T>)
            raw(&value, sizeof value);
        else
            members(*this, value);
    }
    void put(std::string& text) { list(text); }
    template <class T>
    void put(std::vector<T>& values) {
        if constexpr (std::is_trivially_copyable_v<T>) return list(values);
        std::uint64_t count = values.size();
        put(count);
        for (T& value : values) put(value);
    }
    template <class T>
    void put(std::optional<T>& value) {
        bool there = value.has_value();
        put(there);
        if (there) put(*value);
    }
    template <class List>
    void list(List& values) {
        std::uint64_t count = values.size();
        put(count);
        raw(values.data(), count * sizeof(values[0]));
    }
    void raw(const void* from, std::size_t size) { bytes.append(static_cast<const char*>(from), size); }
};

class Reader {
public:
    explicit Reader(const std::string& bytes) : bytes_(bytes) {}
    template <class... T>
    void operator()(T&... values) {
        (take(values), ...);
    }

private:
    template <class T>
    void take(T& value) {
        if constexpr (std::is_trivially_copyable_v<T>)
            raw(&value, sizeof value);
        else
            members(*this, value);
    }
    void take(std::string& text) { list(text); }
    template <class T>
    void take(std::vector<T>& values) {
        if constexpr (std::is_trivially_copyable_v<T>) return list(values);
        std::uint64_t count = 0;
        take(count);
        values.resize(count);
        for (T& value : values) take(value);
    }
    template <class T>
    void take(std::optional<T>& value) {
        bool there = false;
        take(there);
        if (there) take(value.emplace());
    }
    template <class List>
    void list(List& values) {
        std::uint64_t count = 0;
        take(count);
        values.resize(count);
        raw(values.data(), count * sizeof(values[0]));
    }
    void raw(void* to, std::size_t size) {
        assert(at_ + size <= bytes_.size());
        if (size > 0) std::memcpy(to, bytes_.data() + at_, size);
        at_ += size;
    }

    const std::string& bytes_;
    std::size_t at_ = 0;
};

template <class Archive>
void members(Archive& a, Curve& v) {
    a(v.time, v.value);
}
template <class Archive>
void members(Archive& a, Attachment& v) {
    a(v.nodes, v.weights, v.fixed);
}
template <class Archive>
void members(Archive& a, Material& v) {
    a(v.name, v.law, v.density_kg_m3);
}
template <class Archive>
void members(Archive& a, Support& v) {
    a(v.name, v.nodes, v.move_m, v.share, v.turn, v.directions);
}
template <class Archive>
void members(Archive& a, Load& v) {
    a(v.name, v.nodes, v.shares, v.force_N, v.share);
}
template <class Archive>
void members(Archive& a, Wall& v) {
    a(v.points, v.faces, v.mouth_faces);
}
template <class Archive>
void members(Archive& a, PressureLoad& v) {
    a(v.name, v.wall, v.pressure_Pa, v.share);
}
template <class Archive>
void members(Archive& a, CableTarget& v) {
    a(v.kind, v.value, v.keys, v.offset);
}
template <class Archive>
void members(Archive& a, ChamberTarget& v) {
    a(v.kind, v.value, v.keys, v.offset);
}
template <class Archive>
void members(Archive& a, Cable& v) {
    a(v.name, v.points, v.target, v.friction, v.pulled_at_first);
}
template <class Archive>
void members(Archive& a, Chamber& v) {
    a(v.name, v.wall, v.target);
}
template <class Archive>
void members(Archive& a, PointMass& v) {
    a(v.name, v.point, v.mass_kg);
}
template <class Archive>
void members(Archive& a, Marker& v) {
    a(v.name, v.point);
}
template <class Archive>
void members(Archive& a, mesh::TetMesh& v) {
    a(v.order, v.points, v.nodes, v.region, v.region_names);
}
template <class Archive>
void members(Archive& a, Whole& v) {
    a(v.nodes, v.tets, v.volume_m3, v.farthest_m, v.stiffest_Pa, v.pressure_skews);
}
/// The parts of a description that a share has; the others are refused by check_able().
template <class Archive>
void members(Archive& a, Description& v) {
    a(v.mesh, v.materials, v.material_of_region, v.material_of_tet, v.supports, v.loads, v.pressures, v.cables,
      v.chambers, v.masses, v.markers, v.gravity_m_s2, v.gravity_share, v.ambient_pressure_Pa);
}
template <class Archive>
void members(Archive& a, Share& v) {
    a(v.whole, v.part, v.owned, v.number, v.node_in_file, v.tet_in_file, v.fixed, v.contact_nodes);
}

}  // namespace

std::string packed(const Share& share) {
    Writer writer;
    writer(const_cast<Share&>(share));  // NOLINT(cppcoreguidelines-pro-type-const-cast): only read, by the same members
    return std::move(writer.bytes);
}

Share unpacked(const std::string& bytes) {
    Reader reader(bytes);
    Share share;
    reader(share);
    return share;
}

}  // namespace pliant::sim::distributed
